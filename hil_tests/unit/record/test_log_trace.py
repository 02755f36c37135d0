"""A log read as whole telegrams gives the same trace as its frames one by one."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.changed_records import Recorded, changed_records, recorded
from hil_tests.support.other_frames import OTHERS
from railhil.bus.frame import ERROR, EXTENDED, REMOTE, Frame
from railhil.bus.mvb import TelegramSource
from railhil.dbc import wire_contract
from railhil.record.blf_writer import write_blf
from railhil.record.framelog import log_line, log_sha256, read_log, telegrams_sha256
from railhil.record.log_trace import trace_of_log
from railhil.record.senders import Senders
from railhil.record.trace import Trace, TraceReader, trace_of
from railhil.wire.ato import SimTruth

#: Lines of the record that is changed.
LINES = 120


def state_of(trace: Trace) -> dict[str, object]:
    """All that a trace has taken, with the order of what it keeps by name."""
    kept = {name: getattr(trace, name) for name in vars(trace) if name not in ("contract", "idents", "_words", "told")}
    return {name: list(value.items()) if isinstance(value, dict) else value for name, value in kept.items()}


def written(folder: Path, frames: Recorded) -> Path:
    log = folder / "frames.log"
    log.write_text("".join(log_line(*frame) for frame in frames), encoding="ascii")
    return log


def demand_the_same(folder: Path, frames: Recorded) -> None:
    log = written(folder, frames)
    assert state_of(trace_of_log(log, wire_contract())) == state_of(trace_of(read_log(log), wire_contract()))


def read_singly(patch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of frames that are read one by one from now on."""
    found, take = [], TraceReader.take

    def noted(reader: TraceReader, frames: object) -> None:
        every = list(frames)  # type: ignore[call-overload]
        found.append(len(every))
        take(reader, every)

    patch.setattr(TraceReader, "take", noted)
    return found


@pytest.mark.parametrize("part_bytes", [1 << 20, 4000, 700])
def test_a_run_is_read_as_whole_telegrams(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, part_bytes: int) -> None:
    """Wherever the parts of the file end."""
    frames = list(recorded())
    monkeypatch.setattr("railhil.record.framelog._PART_BYTES", part_bytes)
    demand_the_same(tmp_path, frames)
    singly = read_singly(monkeypatch)
    trace_of_log(written(tmp_path, frames), wire_contract())
    assert not singly


def test_one_strange_frame_has_its_part_read_singly_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = list(recorded())
    time_ns, frame = frames[len(frames) // 2]
    frames.insert(len(frames) // 2, (time_ns, Frame(frame.can_id, bytes(8))))
    monkeypatch.setattr("railhil.record.framelog._PART_BYTES", 4000)
    demand_the_same(tmp_path, frames)
    singly = read_singly(monkeypatch)
    trace_of_log(written(tmp_path, frames), wire_contract())
    assert len(singly) == 1
    assert singly[0] < 400


def test_a_blf_is_read_too(tmp_path: Path) -> None:
    log = written(tmp_path, list(recorded()))
    write_blf(log, tmp_path / "frames.blf")
    assert state_of(trace_of_log(tmp_path / "frames.blf", wire_contract())) == state_of(
        trace_of_log(log, wire_contract())
    )


def test_a_log_that_ends_inside_a_telegram_or_before_an_answer(tmp_path: Path) -> None:
    frames = list(recorded())
    for end in range(LINES, LINES + 60):
        demand_the_same(tmp_path, frames[:end])
        demand_the_same(tmp_path, frames[end - 40 : end])


@pytest.mark.slow
@settings(max_examples=100)
@given(frames=changed_records(recorded, LINES), part_bytes=st.sampled_from((100, 500, 2000, 1 << 20)))
def test_whatever_is_wrong_with_a_record_both_ways_find_the_same(frames: Recorded, part_bytes: int) -> None:
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr("railhil.record.framelog._PART_BYTES", part_bytes)
        demand_the_same(Path(folder), frames)


@pytest.mark.long_after(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    "strange",
    [
        Frame(0x1ABCDEF, b"\1", EXTENDED),
        Frame(0x80, bytes(8), ERROR),
        Frame(0x118, b"", REMOTE),
        Frame(0x7FF, bytes(8)),
    ],
)
@pytest.mark.parametrize("part_bytes", [300, 1 << 20])
def test_a_part_that_is_not_classic_between_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, strange: Frame, part_bytes: int
) -> None:
    """Wherever it stands in a telegram, and whatever of the telegram is in the part before."""
    monkeypatch.setattr("railhil.record.framelog._PART_BYTES", part_bytes)
    frames = list(recorded()[200:400])
    for at in range(60, 90):
        demand_the_same(tmp_path, [*frames[:at], (frames[at][0], strange), *frames[at:]])


def test_senders_see_every_frame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a part of columns, in one that is read frame by frame, and in a BLF."""
    monkeypatch.setattr("railhil.record.framelog._PART_BYTES", 2000)
    frames = list(recorded()[:400])
    frames.insert(200, (frames[200][0], Frame(0x1ABCDEF, b"\1", EXTENDED)))
    log = written(tmp_path, frames)
    write_blf(log, tmp_path / "frames.blf")
    every = Counter(frame.can_id for _, frame in frames if not frame.flags)
    for path in (log, tmp_path / "frames.blf"):
        # Without lists of what was sent it counts the frames of each identifier.
        senders = Senders(tmp_path, wire_contract(), complete=False)
        assert state_of(trace_of_log(path, wire_contract(), senders)) == state_of(trace_of(frames, wire_contract()))
        assert senders._answers == every


def test_frames_of_others_are_not_in_the_second_hash(tmp_path: Path) -> None:
    """Whatever they are; with them the log has another hash."""
    frames = list(recorded()[:400])
    alone = log_sha256(written(tmp_path, frames))
    assert telegrams_sha256(tmp_path / "frames.log", wire_contract()) == alone
    for place, other in enumerate(OTHERS):
        frames.insert(200 + 2 * place % 150, (frames[200][0], other))
    log = written(tmp_path, frames)
    assert trace_of_log(log, wire_contract()).foreign == len(OTHERS)
    assert telegrams_sha256(log, wire_contract()) == alone != log_sha256(log)


@pytest.mark.parametrize("late_ns", [4_999_000, 5_000_000, 5_001_000])
@pytest.mark.parametrize("first", [0, 1, 2])
def test_a_telegram_that_takes_longer_than_it_may(tmp_path: Path, late_ns: int, first: int) -> None:
    truth = TelegramSource(SimTruth.port()).frames(SimTruth(7, 5).encode())
    demand_the_same(tmp_path, [(0 if place < first else late_ns, frame) for place, frame in enumerate(truth)])


def test_a_block_twice_is_not_the_other_one_with_the_same_data(tmp_path: Path) -> None:
    block, same, trailer = TelegramSource(SimTruth.port()).frames(bytes(SimTruth.port().data_bytes))
    assert block.data == same.data
    demand_the_same(tmp_path, [(0, block), (0, block), (0, trailer)])


@pytest.mark.long
@pytest.mark.slow
def test_every_wrong_bit_and_every_exchange_of_a_cycle(tmp_path: Path) -> None:
    """Of 20 frames, among them telegrams of one frame and of several."""
    frames = list(recorded()[200:220])
    seen = {frame.can_id for _, frame in frames}
    assert {1, 3} <= {len(port.can_ids) for port in wire_contract().ports if seen.issuperset(port.can_ids)}
    for at, (time_ns, frame) in enumerate(frames):
        for bit in range(8 * len(frame.data)):
            data = (int.from_bytes(frame.data) ^ 1 << bit).to_bytes(len(frame.data))
            demand_the_same(tmp_path, [*frames[:at], (time_ns, Frame(frame.can_id, data)), *frames[at + 1 :]])
        for size in range(len(frame.data)):
            demand_the_same(
                tmp_path, [*frames[:at], (time_ns, Frame(frame.can_id, frame.data[:size])), *frames[at + 1 :]]
            )
        demand_the_same(tmp_path, [*frames[:at], *frames[at + 1 : at + 2], frames[at], *frames[at + 2 :]])
