"""The record compared with what its nodes say that they have sent."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from railhil.bus.frame import EXTENDED, FD, REMOTE, Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import F_DEVICE_STATUS, TelegramSource, master_frame
from railhil.bus.packing import pack_frames
from railhil.bus.sent import SentFrames
from railhil.dbc import wire_contract
from railhil.record.framelog import CHANNEL, log_line
from railhil.record.log_columns import classic_columns
from railhil.record.senders import EqualFrames, Findings, Senders, read_sent, sent_file
from railhil.wire.ato import NotchCmd, PltStat, SimTruth, TrnSpeed

TICK_NS = 10_000_000
POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)


def frames_of(telegram: Telegram, fd: bool = False) -> list[Frame]:
    return TelegramSource(telegram.port(), fd).frames(telegram.encode())


def bench(ticks: int = 100, fd: bool = False) -> list[tuple[str, Frame]]:
    """Owner and frame in bus order, one telegram of each kind per tick; PLT_STAT repeats itself every 16 ticks."""
    found: list[tuple[str, Frame]] = []
    for tick in range(ticks):
        for telegram in (TrnSpeed(tick, life=tick % 16), PltStat(life=tick % 16), SimTruth(tick, 5)):
            found += [("plant", frame) for frame in frames_of(telegram, fd)]
        found.append(("plant", POLL))
        found += [("controller", frame) for frame in frames_of(NotchCmd(tick, life=tick % 16), fd)]
    return found


def compared(
    folder: Path,
    sent: Sequence[tuple[str, Frame]],
    recorded: Sequence[Frame],
    *,
    complete: bool = True,
    witnesses: Sequence[str] = ("plant", "controller"),
) -> Findings:
    """Each recorded frame is one tick later than the one before."""
    for node in witnesses:
        own = SentFrames(sent_file(folder, node), node)
        for owner, frame in sent:
            if owner == node:
                own.note([frame])
        own.write()
    senders, in_columns = (Senders(folder, wire_contract(), complete=complete) for _ in range(2))
    items = [(place * TICK_NS, frame) for place, frame in enumerate(recorded)]
    assert list(senders.passing(items)) == items
    text = "".join(log_line(*item) for item in items).encode()
    # What is not classic everywhere is not read in columns.
    columns = classic_columns(text, CHANNEL)
    found = senders.findings()
    if columns is not None:
        for first in range(0, len(items), 250):
            in_columns.pass_columns(columns.rows(first, first + 250))
        assert in_columns.findings() == found
    return found


@pytest.fixture(autouse=True)
def signals_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("railhil.bus.sent.ignore_ending_signals", lambda: None)


@pytest.mark.parametrize("fd", [False, True])
@pytest.mark.parametrize("complete", [False, True])
def test_a_record_of_what_was_sent_is_in_order(tmp_path: Path, fd: bool, complete: bool) -> None:
    """More frames than are sorted at once; the polls of the device status are not recorded."""
    sent = bench(1000, fd)
    scan = [("plant", master_frame(F_DEVICE_STATUS, 1))] * 3
    found = compared(tmp_path, scan + sent, [frame for _, frame in sent], complete=complete)
    assert found == Findings([], [])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("complete", [False, True])
@pytest.mark.parametrize(
    ("frames", "words"),
    [
        (frames_of(SimTruth(9, 5)), "3 frames on SIM_TRUTH that the plant did not send, first at 4.00 s"),
        (frames_of(TrnSpeed(3, life=3)), "1 frame on TRN_SPEED that the plant did not send, first at 4.00 s"),
        (frames_of(NotchCmd(99, life=3)), "1 frame on NOTCH_CMD that the controller did not send, first at 4.00 s"),
        (frames_of(SimTruth(9, 5), fd=True), "1 frame on SIM_TRUTH that the plant did not send, first at 4.00 s"),
        ([Frame(TrnSpeed.port().address, b"")], "1 frame on TRN_SPEED that the plant did not send, first at 4.00 s"),
    ],
)
def test_a_frame_that_its_owner_did_not_send_is_found(
    tmp_path: Path, frames: list[Frame], words: str, complete: bool
) -> None:
    sent = bench()
    record = [frame for _, frame in sent]
    found = compared(tmp_path, sent, [*record[:400], *frames, *record[400:]], complete=complete)
    assert found.said == [words]
    assert len(list(tmp_path.iterdir())) == 2, "the lists are evidence"


@pytest.mark.parametrize("complete", [False, True])
@pytest.mark.parametrize("again", [frames_of(PltStat(life=3)), [POLL]])
def test_a_frame_that_looks_like_one_sent_later_is_counted_all_the_same(
    tmp_path: Path, again: list[Frame], complete: bool
) -> None:
    sent = bench()
    record = [frame for _, frame in sent]
    found = compared(tmp_path, sent, [*record[:400], *again, *record[400:]], complete=complete)
    (said,) = found.said
    assert "that the plant did not send" in said
    assert not complete or said.startswith("1 frame on ")


def test_changed_and_missing_frames_are_found_where_none_can_be_lost(tmp_path: Path) -> None:
    sent = bench()
    record = [frame for _, frame in sent]
    speeds = [place for place, frame in enumerate(record) if frame.can_id == TrnSpeed.port().address]
    changed = list(record)
    (changed[speeds[50]],) = frames_of(TrnSpeed(7777, life=2))
    foreign = f"1 frame on TRN_SPEED that the plant did not send, first at {speeds[50] / 100:.2f} s"
    assert compared(tmp_path, sent, changed).said == [
        foreign,
        "1 frame on TRN_SPEED that the plant sent is missing",
    ]
    assert compared(tmp_path, sent, changed, complete=False).said == [foreign]
    holed = [frame for place, frame in enumerate(record) if place not in speeds[50:60] and place not in speeds[-1:]]
    assert compared(tmp_path, sent, holed).said == ["11 frames on TRN_SPEED that the plant sent are missing"]
    assert compared(tmp_path, sent, holed, complete=False).said == []


def test_a_controller_that_says_nothing_answers_at_most_each_poll(tmp_path: Path) -> None:
    """A board, or one that was killed."""
    sent = bench()
    record = [frame for _, frame in sent]
    names = ["NOTCH_CMD"]
    found = compared(tmp_path, sent, record, witnesses=("plant",))
    assert found == Findings([], names)
    record[400:400] = frames_of(NotchCmd(99, life=3)) * 2
    found = compared(tmp_path, sent, record, witnesses=("plant",))
    assert found == Findings(["2 frames on NOTCH_CMD more than the plant has polled"], names)


def test_without_any_list_nothing_is_said(tmp_path: Path) -> None:
    found = compared(tmp_path, [], [frame for _, frame in bench()], witnesses=())
    assert found == Findings([], ["NOTCH_CMD", "TRN_SPEED", "PLT_STAT", "SIM_TRUTH"])


def test_frames_that_are_no_telegrams_belong_to_nobody(tmp_path: Path) -> None:
    sent = bench()
    record = [frame for _, frame in sent]
    record[400:400] = [Frame(TrnSpeed.port().address, bytes(8), EXTENDED), Frame(0x7E0, b"x"), Frame(0x7E1, b"y", FD)]
    assert compared(tmp_path, sent, record).said == []


@pytest.mark.parametrize("complete", [False, True])
def test_what_faults_make_of_frames_was_sent_too(tmp_path: Path, complete: bool) -> None:
    """No answer, a truncated telegram, a remote frame, and a telegram under an identifier of the other node."""
    sent = bench()
    speed_id, notch_id = TrnSpeed.port().address, NotchCmd.port().address
    faulty = [
        ("controller", Frame(notch_id, b"")),
        ("plant", Frame(speed_id, b"\1\2")),
        ("plant", Frame(speed_id, bytes(8), REMOTE)),
        ("plant", Frame(notch_id, bytes(8))),
    ]
    sent = [*faulty, *sent[:400], *faulty, *sent[400:]]
    record = [frame for _, frame in sent]
    assert compared(tmp_path, sent, record, complete=complete) == Findings([], [])
    for _, frame in (faulty[0], faulty[1], faulty[3]):
        found = compared(tmp_path, sent, [*record[:600], frame, *record[600:]], complete=complete)
        assert len(found.said) == 1, frame
        assert found.said[0].startswith("1 frame on "), found


def test_a_list_that_cannot_be_written_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = SentFrames(tmp_path / "none" / "plant.sent", "plant")
    own.note([POLL])
    own.write()
    assert capsys.readouterr().err == "plant: list of sent frames is lost: no such file or directory\n"


@pytest.mark.parametrize("first", [0, 2])
def test_frames_that_a_fault_has_cut_emptied_or_made_remote_are_in_order_too(tmp_path: Path, first: int) -> None:
    sent = bench(30)
    for place, (owner, frame) in enumerate(sent):
        if place % 7 == first and owner == "controller":
            sent[place] = (owner, frame._replace(data=b""))
        elif place % 5 == first:
            sent[place] = (owner, frame._replace(data=frame.data[:3]))
        elif place == 11:
            sent[place] = (owner, frame._replace(flags=REMOTE))
    record = [frame for _, frame in sent]
    assert compared(tmp_path, sent, record) == Findings([], [])
    forged = Frame(NotchCmd.port().can_ids[-1], b"")
    found = compared(tmp_path, sent, [*record[:20], forged, *record[20:]])
    assert len(found.said) == 1
    assert "on NOTCH_CMD that the controller did not send" in found.said[0]


@pytest.mark.parametrize("is_packed", [False, True])
def test_a_long_list_is_put_together_in_parts_and_read_in_order(tmp_path: Path, is_packed: bool) -> None:
    """Frames of any length, more than are kept as they are; those that are no telegrams are left out."""
    own = SentFrames(tmp_path / "plant.sent", "plant")
    sent = [Frame(0x100 + k % 3, k.to_bytes(2) * (k % 4), REMOTE if k % 7 == 0 else 0) for k in range(9000)]
    for begin in range(0, len(sent), 5):
        if is_packed:
            own.note_packed(b"".join(pack_frames(sent[begin : begin + 5])))
        else:
            own.note(sent[begin : begin + 5])
    own.write()
    told = read_sent(tmp_path / "plant.sent")
    assert told is not None
    assert told.frames == {
        can_id: [frame.data for frame in sent if frame.can_id == can_id and not frame.flags]
        for can_id in (0x100, 0x101, 0x102)
    }


def test_frames_of_one_length_are_a_sequence() -> None:
    frames = EqualFrames(b"aabbcc", 2)
    assert list(frames) == [b"aa", b"bb", b"cc"]
    assert (len(frames), frames[1], frames[-1], frames[1:], frames.count(b"bb")) == (3, b"bb", b"cc", [b"bb", b"cc"], 1)
    for place in (3, -4):
        with pytest.raises(IndexError):
            frames[place]


HEADS = [
    b"", b"{}\n", b"[]\n", b"\xff\n",
    b'{"packed": 0, "frames": -1, "received": null}\n', b'{"packed": -1, "frames": 0, "received": null}\n',
]  # fmt: skip


@pytest.mark.parametrize("first", HEADS)
@pytest.mark.parametrize("key", [b"frames", b"packed"])
def test_a_damaged_list_is_none(tmp_path: Path, first: bytes, key: bytes) -> None:
    path = tmp_path / "plant.sent"
    own = SentFrames(path, "plant")
    if key == b"packed":
        own.note_packed(b"".join(pack_frames([POLL] * 7)))
    else:
        own.note([POLL] * 7)
    own.write()
    whole = path.read_bytes()
    assert read_sent(path) is not None
    for content in (
        whole[:-1],
        whole + b"x",
        first + whole.partition(b"\n")[2],
        whole.replace(b'"%s": 7' % key, b'"%s": 8' % key),
    ):
        path.write_bytes(content)
        assert read_sent(path) is None, content
