"""What is recorded does not depend on whether frames come packed, nor on where the packets end."""

from __future__ import annotations

from errno import ENOSPC
from hashlib import sha256
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.changed_records import Recorded, changed_records, recorded, short_scenario
from railhil.bus.codes import Event
from railhil.bus.frame import ERROR, EXTENDED, REMOTE, Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.packing import CLASSIC_SIZE, pack_frame, unpack_frames
from railhil.bus.telegrams import RunEvent
from railhil.dbc import wire_contract
from railhil.record.framelog import FrameLog, LateLines, log_line
from railhil.record.packets import PACKED, Backlog, Packets
from railhil.record.session import Session, make_session
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import TrnSpeed

#: Faults of the port that opens the ticks, and of another one: the recorder then keeps another time.
FAULTS = ("TRN_SPEED loss @1s x3 combine", "TRN_SPEED corrupt @2s x2 combine", "TRN_POS loss @3s x3")
#: Since there is another answer of the supervisor to each of its polls, the record's own ones are left out.
OWN = {can_id for name in ("SUP_CMD", "SUP_IDENT") for can_id in wire_contract().port(name).can_ids}
GOOD = "(3.000001) mvb0 100#0102 R\n"
SUP_POLL = master_frame(1, wire_contract().port("SUP_CMD").address)
#: Frames that are looked at one by one.
_SINGLY = [wire_contract().port(name) for name in ("TIME_SYNC", "PLT_IDENT", "RUN_EVENT")]
SINGLY = [can_id for port in _SINGLY for can_id in port.can_ids]
#: Frames of each record that are taken.
LINES = 150


class Both:
    """The same frames, one by one and packed.

    :param begun: the recorders have seen the beginning of the record.
    """

    def __init__(self, *faults: str, begun: bool = True) -> None:
        scenario = short_scenario(*faults)
        self.lines: list[str] = []
        self.text: list[str] = []
        self.late = LateLines(self.text.append)
        self.one = make_session(scenario, self.lines.append, RunSpec())
        self.packed = make_session(scenario, self.late.write, RunSpec(), late=self.late)
        self.one_by_one: list[int] = []
        if begun:
            self.demand_the_same([frame for _, frame in recorded(*faults)[:60]], [])
        take = self.packed.take

        def noted(frames: list[Frame]) -> list[Frame]:
            self.one_by_one.append(len(frames))
            return take(frames)

        self.packed.take = noted  # type: ignore[method-assign]

    def demand_the_same(self, frames: list[Frame], ends: list[int], settled: bool = True) -> None:
        """:param ends: where packets end; ``settled``: what waits is written after each."""
        stream = b"".join(map(pack_frame, frames))
        answers, found = [], []
        for frame in unpack_frames(stream):
            answers += self.one.handle(frame)
        bounds = [0, *sorted(ends), len(frames)]
        for begin, end in pairwise(bounds):
            if packet := stream[begin * CLASSIC_SIZE : end * CLASSIC_SIZE]:
                found += self.packed.take_packed(packet)
            if settled:
                self.packed.settle()
                self.late.settle()
        self.packed.settle()
        self.late.settle()
        assert found == answers
        assert "".join(self.text) == "".join(self.lines)
        assert state_of(self.packed) == state_of(self.one)


def state_of(session: Session) -> dict[str, Any]:
    clock = session._clock
    return {
        "public": [session.frames, session.ended, session.ending, session.sim_time_s, session.recording, session.rate],
        "ticks": list(session.wall_ticks),
        "counted": [session.counters, {key: (one.count, one.first_ns) for key, one in session.foreign_frames.items()}],
        "clock": [getattr(clock, name) for name in type(clock).__slots__ if name not in ("counters", "_sync_life")],
        "truth": None if session._truth_clock is None else vars(session._truth_clock),
    }


def frames_of(records: Recorded) -> list[Frame]:
    return [frame for _, frame in records if frame.can_id not in OWN]


@pytest.mark.long_after(4)
@pytest.mark.parametrize("together", [1, 2, 5, 17, 86, 1000])
@pytest.mark.parametrize("faults", [(), FAULTS], ids=["healthy", "faults"])
def test_a_run_is_recorded_as_one_by_one(faults: tuple[str, ...], together: int) -> None:
    both = Both(*faults, begun=False)
    frames = frames_of(list(recorded(*faults)))
    both.demand_the_same(frames, list(range(together, len(frames), together)), settled=together % 2 == 0)
    assert both.one.ended is not None
    assert both.one.wall_ticks[-1] > 400
    assert len(both.packed.wall_ns) == len(both.packed.wall_ticks)


@pytest.mark.parametrize("faults", [(), FAULTS], ids=["healthy", "faults"])
def test_only_what_not_every_tick_brings_is_taken_one_by_one(faults: tuple[str, ...]) -> None:
    both = Both(*faults)
    frames = frames_of(list(recorded(*faults))[60:])
    polls = [at for at, frame in enumerate(frames) if frame == SUP_POLL]
    # As on pipes: a packet ends with a poll of the supervisor.
    ends = [poll + 1 for poll in polls[:20]]
    both.demand_the_same(frames[: polls[20] + 1], ends)
    # With the end of a RUN_EVENT the poll cannot wait; with the PLT_IDENT that is repeated it can.
    event_id = wire_contract().port("RUN_EVENT").can_ids[-1]
    events = sum(any(frame.can_id == event_id for frame in frames[begin:end]) for begin, end in pairwise([0, *ends]))
    singly = sum(frame.can_id in SINGLY for frame in frames[: polls[20]])
    assert events > 0
    assert 4 < singly < len(both.one_by_one) == singly + events < polls[20] / 20
    assert set(both.one_by_one) == {1}


@pytest.mark.parametrize("length", [9, 255])
@pytest.mark.parametrize("can_id", [0x120, 0x118])
def test_a_length_that_no_frame_has(can_id: int, length: int) -> None:
    both = Both()
    strange = bytearray(pack_frame(Frame(can_id, bytes(range(8)))))
    strange[4] = length
    poll = pack_frame(SUP_POLL)
    sync = pack_frame(Frame(0x100, bytes(8)))
    # What is no column is written between the lines of columns.
    extended = pack_frame(Frame(0x1ABCDEF, b"\1", EXTENDED))
    for packet in (bytes(strange), poll, bytes(strange) + extended + sync + bytes(strange), sync + extended + poll):
        both.one.take(unpack_frames(packet))
        both.packed.take_packed(packet)
    both.demand_the_same([], [])


@pytest.mark.slow
def test_healthy_frames_are_looked_at_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever packets end."""

    def looked(*_arguments: object) -> None:
        raise AssertionError("one by one")

    frames = frames_of(list(recorded())[60:])
    for step in (1, 2, 3, 86, 1000):
        both = Both()
        with monkeypatch.context() as patch:
            patch.setattr(Packets, "_look", looked)
            both.demand_the_same(frames, list(range(step, len(frames), step)))


def test_the_end_of_an_event_is_not_left_for_later() -> None:
    """It may come in another packet than its beginning, and decides whether the next poll is the last one."""
    both, event = Both(), TelegramSource(RunEvent.port()).frames(RunEvent(event=Event.ENDED_COMPLETE).encode())
    both.demand_the_same([*event, SUP_POLL], [len(event) - 1], settled=False)
    assert both.one.ended is Event.ENDED_COMPLETE


@pytest.mark.parametrize("lost", range(4))
def test_without_the_frames_from_one_of_the_clock_port_to_the_next(lost: int) -> None:
    """Only the life sign says that they are missing: the polls that would move the time are missing too."""
    both, frames = Both(), frames_of(list(recorded()[60:200]))
    clocks = [at for at, frame in enumerate(frames) if frame.can_id == wire_contract().clock_port.address]
    del frames[clocks[lost] : clocks[lost + 1]]
    both.demand_the_same(frames, list(range(1, len(frames))))


def test_packets_that_wait_come_with_the_places_of_polls_and_answers() -> None:
    backlog, plain, answer = Backlog(wire_contract(), waits=True), Frame(0x123, b"\1"), Frame(0x088, bytes(8))
    for _ in range(2):
        backlog.hold(pack_frame(plain) * 2 + pack_frame(SUP_POLL), [answer, answer])
        backlog.hold(pack_frame(SUP_POLL), [answer])
        packet, answered = backlog.release()
        assert unpack_frames(packet) == [plain, plain, SUP_POLL, answer, answer, SUP_POLL, answer]
        assert answered == [2, 3, 4, 5, 6]
    assert backlog.release() == (b"", [])


def test_a_classic_frame_with_the_identifier_of_an_fd_frame_moves_no_time() -> None:
    both, frames = Both(*FAULTS), frames_of(list(recorded(*FAULTS))[60:200])
    truth = wire_contract().port("SIM_TRUTH")
    at = next(at for at, frame in enumerate(frames) if frame.can_id == truth.can_ids[0])
    frames[at] = frames[at]._replace(can_id=truth.fd_id)
    both.demand_the_same(frames, [])


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(data=st.data(), faults=st.sampled_from([(), FAULTS]))
def test_whatever_is_wrong_with_the_frames_both_ways_record_the_same(
    data: st.DataObject, faults: tuple[str, ...]
) -> None:
    both = Both(*faults)
    frames = frames_of(data.draw(changed_records(lambda: recorded(*faults)[60:], LINES)))
    ends = data.draw(st.lists(st.integers(0, len(frames)), max_size=6))
    both.demand_the_same(frames, ends, settled=data.draw(st.booleans()))


@pytest.mark.long_after(8)
@pytest.mark.parametrize(
    "strange",
    [
        Frame(0x1ABCDEF, b"\1", EXTENDED),
        Frame(0x118, bytes(8), EXTENDED),
        Frame(0x80, bytes(8), ERROR),
        Frame(0x118, b"", REMOTE),
        Frame(0x118, b"\1\2\3\4\5"),
        Frame(0x158, b"\1\2\3"),
        Frame(0x080, b""),
        Frame(0x080, b"\x31\x38\xf3\x00"),
        Frame(0x080, b"\x31\x38\xf4"),
        master_frame(1, 0x7F0),
        master_frame(15, 3),
        Frame(0x088, b"\x10\x00\x03"),
        Frame(0x7FF, bytes(8)),
        Frame(0x000, b""),
        *(TelegramSource(wire_contract().port("SUP_CMD")).frames(bytes(4))),
        *(TelegramSource(TrnSpeed.port()).frames(TrnSpeed(5, life=3).encode())),
    ],
    ids=repr,
)
@pytest.mark.parametrize("faults", [(), FAULTS], ids=["healthy", "faults"])
def test_a_strange_frame_anywhere_in_a_packet(faults: tuple[str, ...], strange: Frame) -> None:
    frames = frames_of(list(recorded(*faults)[60:130]))
    for at in range(0, len(frames), 3):
        both = Both(*faults)
        both.demand_the_same([*frames[:at], strange, *frames[at:]], [len(frames) // 2])


def test_before_the_record_begins_nothing_is_kept() -> None:
    both = Both(begun=False)
    both.demand_the_same(frames_of(list(recorded()[200:260])), [20])
    assert not both.lines
    assert both.packed.frames == 0


@given(
    frames=st.lists(
        st.tuples(st.integers(0, 10**13).map(lambda us: us * 1000), st.integers(0, 0x7FF), st.binary(max_size=8)),
        min_size=1, max_size=40,
    ),
    breaks=st.lists(st.integers(0, 40)),
    single=st.lists(st.integers(0, 40)),
)  # fmt: skip
def test_late_lines_are_those_of_the_log(
    frames: list[tuple[int, int, bytes]], breaks: list[int], single: list[int]
) -> None:
    """Whatever the time, whatever is written between them, as columns or one by one."""
    text: list[str] = []
    late, wanted = LateLines(text.append), ""
    for at, (time_ns, can_id, data) in enumerate(frames):
        if at in breaks:
            late.write("(1.000000) other line\n")
            wanted += "(1.000000) other line\n"
        frame = Frame(can_id, data)
        if at in single:
            late.frame(time_ns, frame)
        else:
            late.add(np.frombuffer(pack_frame(frame), PACKED), [time_ns], [1])
        wanted += log_line(time_ns, frame)
    assert not text
    late.settle()
    late.settle()
    assert text == [wanted]


@pytest.mark.parametrize("flushes", [False, True])
def test_what_waits_is_in_the_log_when_it_is_flushed_or_closed(tmp_path: Path, flushes: bool) -> None:
    log, wanted = FrameLog(tmp_path), log_line(5_000_000, Frame(0x123, b"\1"))
    log.late.add(np.frombuffer(pack_frame(Frame(0x123, b"\1")), PACKED), [5_000_000], [1])
    assert log.path.read_text() == ""
    if flushes:
        log.flush()
        assert log.path.read_text() == wanted
    assert log.close() == sha256(wanted.encode()).hexdigest()


def test_a_full_disk_leaves_whole_lines_of_what_waited(tmp_path: Path) -> None:
    log = FrameLog(tmp_path)
    log.write(GOOD)
    log.flush()
    log.late.write(GOOD)
    log.late._write = no_room
    with pytest.raises(OSError, match="No space"):
        log.close()
    assert log._stream.closed
    assert log.path.read_text() == GOOD


@pytest.mark.parametrize(
    "strange", [Frame(0x800, b"\1", EXTENDED), Frame(0x123, b"\1\0", REMOTE), Frame(0x20, b"", ERROR)]
)
def test_a_frame_that_is_no_column_is_written_in_its_place(strange: Frame) -> None:
    both = Both()
    frames = frames_of(list(recorded()[60:100]))
    for frame in (*frames[:20], strange, *frames[20:]):
        both.one.handle(frame)
        both.packed.handle(frame)
    both.late.settle()
    assert "".join(both.text) == "".join(both.lines)
    assert state_of(both.packed) == state_of(both.one)


def no_room(text: str) -> None:
    raise OSError(ENOSPC, "No space left on device")


@pytest.mark.parametrize(
    ("name", "faults", "waits"),
    [
        ("yizhuang_stop", ("SPEED_RAW loss @5s x3",), True),
        ("jinan_xuzhou_emu3", (), True),
        # With faults the poll of SUP_CMD, every fourth tick, is the second time base of the supervisor's own clock.
        ("jinan_xuzhou_emu3", ("UNIT1_FB loss @20s x3",), False),
    ],
)
def test_a_poll_that_moves_a_time_does_not_wait(name: str, faults: tuple[str, ...], waits: bool) -> None:
    late = LateLines(lambda text: None)
    packets = make_session(load_any(name, (), faults), late.write, RunSpec(), late=late).packets
    assert packets is not None
    assert packets.backlog.may_wait(pack_frame(packets.backlog.command_poll)) is waits
