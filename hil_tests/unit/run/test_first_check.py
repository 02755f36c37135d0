"""The first check of a controller: what it understands of a good one, and the line for each fault."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from hil_tests.support.administrator import FakeEndpoint, frames_of
from hil_tests.support.clock import SetClock
from railhil.bus.errors import BusOccupied, PeerSilent
from railhil.bus.frame import EXTENDED, Frame
from railhil.bus.ident import CtlIdent
from railhil.bus.mvb import check_sequence, device_status_frame, master_frame, master_tail
from railhil.common.exit_codes import FAIL, INVALID, PASS, exit_code_of
from railhil.controller_node.ato.node import ControllerNode
from railhil.dbc import wire_contract
from railhil.run.first_check import Checked, FirstCheck
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd

#: Changes the answer to a poll; the number counts the answers of its port from 0.
Change = Callable[[list[Frame], int], list[Frame]]
STATUS, NOTCH, STAT, IDENT = 0x088, 0x110, 0x138, 0x170
_ANSWER_NS = 200_000


def checked(
    scenario: Scenario,
    changed: int = 0,
    change: Change = lambda frames, number: frames,
    *,
    delay_ns: int = _ANSWER_NS,
    pace: str = "lockstep",
    sent_before: tuple[Frame, ...] = (),
    fd: bool = False,
) -> Checked:
    """A check of our own node, whose answers that begin with the identifier ``changed`` are changed."""
    node = ControllerNode(scenario, LawSpec(), fd=fd)
    wall, count = SetClock(), 0

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        nonlocal count
        frames = node.handle(frame)
        is_changed = bool(frames) and frames[0].can_id == changed
        if is_changed:
            frames = change(frames, count)
            count += 1
        return [(delay_ns if is_changed else _ANSWER_NS, one) for one in frames]

    endpoint = FakeEndpoint(wall, answer)
    endpoint.pending = [(1000, frame) for frame in sent_before]
    run = RunSpec(str(scenario.name), pace=pace, patience_s=1.0)
    return FirstCheck(endpoint, scenario, run, fd=fd, appear_s=1.0, wall=wall).check()


def test_a_good_controller_passes_and_is_understood(run_2m: Scenario) -> None:
    found = checked(run_2m)
    assert (found.faults, found.notes, found.exit_code, found.others) == ([], [], PASS, 0)
    assert found.stated == {"law": "ipfc", "arithmetic": "iq", "indexing": "time"}
    lives = found.lives["NOTCH_CMD"]
    assert [(life - lives[0]) % 16 for life in lives] == list(range(10))
    names = [answer.name for answer in found.answers]
    assert names[:4] == ["device status", "CTL_IDENT", "NOTCH_CMD", "CTL_STAT"]
    assert (names.count("NOTCH_CMD"), names.count("CTL_STAT")) == (10, 2)
    assert "CtlMode running, CtlCause none, NotchChk correct, EmergencyBrake false" in found.answers[2].values
    assert found.latencies_ms()["NOTCH_CMD"] == pytest.approx((0.2, 0.2, 0.2))


def octets(at: int, make: Callable[[bytes], bytes], frame: int = -1) -> Change:
    """Other octets from ``at`` on in one frame of the answer."""

    def change(frames: list[Frame], number: int) -> list[Frame]:
        can_id, data, flags = frames[frame]
        made = make(data)
        frames[frame] = Frame(can_id, data[:at] + made + data[at + len(made) :], flags)
        return frames

    return change


def telegram(kind: type[CtlIdent | CtlStat | NotchCmd], **values: int | Callable[[int, int], int]) -> Change:
    """Other values in a telegram: numbers, or functions of the right value and the number of the answer."""

    def change(frames: list[Frame], number: int) -> list[Frame]:
        data = b"".join(frame.data for frame in frames)[: kind.port().data_bytes]
        right = kind.decode(data)
        given = {
            name: value(getattr(right, name), number) if callable(value) else value for name, value in values.items()
        }
        return frames_of(replace(right, **given))

    return change


@pytest.mark.parametrize(
    ("changed", "change", "expected"),
    [
        (STATUS, octets(4, lambda data: bytes([check_sequence(data[:4])])),
         ["device status: check sequence ", "right 3E (that of 4 octets; it covers 2)"]),
        (STATUS, lambda frames, _: [Frame(STATUS, frames[0].data[:5])],
         ["device status: frame 088 has 5 octets, right 8"]),
        (STATUS, lambda frames, _: [device_status_frame(2, 0x1000)],
         ["device status: master word F002, right F001"]),
        (NOTCH, octets(4, lambda data: bytes([data[4] ^ 0xFF])),
         ["NOTCH_CMD: check sequence", "(not inverted) (10 times)"]),
        (NOTCH, octets(4, lambda data: bytes([data[4] ^ 1])),
         ["NOTCH_CMD: check sequence", "(wrong parity) (10 times)"]),
        (NOTCH, octets(7, lambda data: b"\0"),
         ["NOTCH_CMD: check sequence of the master word 00, right 9D (10 times)"]),
        (NOTCH, octets(5, lambda data: master_tail(1, 0x118)), ["NOTCH_CMD: master word 1118, right 1110 (10 times)"]),
        (NOTCH, lambda frames, _: [Frame(NOTCH, frames[0].data[:7])],
         ["NOTCH_CMD: frame 110 has 7 octets, right 8 (10 times)"]),
        (NOTCH, lambda frames, _: [Frame(NOTCH + 1, frames[0].data)],
         ["NOTCH_CMD: no answer within 1 s, but frames 111 (10 times)"]),
        (NOTCH, lambda frames, _: [Frame(0x118, frames[0].data)],
         ["NOTCH_CMD: frames 118, right 110, in this order (10 times)"]),
        (NOTCH, lambda frames, _: [Frame(NOTCH, frames[0].data, EXTENDED)],
         ["NOTCH_CMD: frame 110 is extended, right a classic data frame with a standard identifier (10 times)"]),
        (NOTCH, lambda frames, _: [], ["NOTCH_CMD: no answer within 1 s (10 times)"]),
        (NOTCH, lambda frames, _: frames * 2, ["frame 110, which nobody asked for: between two polls (10 times)"]),
        (NOTCH, telegram(NotchCmd, life=3), ["NOTCH_CMD: NotchLife stands: 3 after 3, right 4 (9 times)"]),
        (NOTCH, telegram(NotchCmd, life=lambda life, number: (life + 2 * (number > 4)) % 16), ["NotchLife skips"]),
        (NOTCH, telegram(NotchCmd, life=lambda life, number: -number % 16),
         ["NotchLife goes back: 15 after 0, right 1"]),
        (NOTCH, telegram(NotchCmd, check=0), ["NOTCH_CMD: NotchChk 00 (erroneous), right 01 (correct) (10 times)"]),
        (NOTCH, telegram(NotchCmd, emergency=3),
         ["EmergencyBrake 11 (undefined), right 01 (false) or 10 (true) (10 times)"]),
        (NOTCH, telegram(NotchCmd, mode=7), ["NOTCH_CMD: CtlMode 7, right 0 (initialising)", "(10 times)"]),
        (NOTCH, telegram(NotchCmd, cause=31), ["NOTCH_CMD: CtlCause 31, right 0 (none)", "17 (track_age) (10 times)"]),
        (STAT, telegram(CtlStat, ladder_level=9), ["CTL_STAT: LadderLevel 9, right 0 (normal)", "(2 times)"]),
        (IDENT, telegram(CtlIdent, arithmetic=15), ["CTL_IDENT: CtlArithmetic 15, right 0 (none), 1 (float64)"]),
        (IDENT, telegram(CtlIdent, indexing=3), ["CTL_IDENT: CtlIndexing 3, right 0 (none), 1 (time), 2 (distance)"]),
        (NOTCH, telegram(NotchCmd, notch_256th=2048), ["NOTCH_CMD: NotchCmd 8 notch, right -7 to 7 (10 times)"]),
        (STAT, lambda frames, _: frames[::-1],
         ["CTL_STAT: frames 13C 139 138, right 138 139 13C, in this order (2 times)"]),
        (STAT, lambda frames, _: [frames[0], frames[2]], ["CTL_STAT: frames 138 13C, right 138 139 13C"]),
        (STAT, octets(1, lambda data: bytes([data[1] ^ 0xFF])),
         ["CTL_STAT: check sequence of block 2", "(not inverted)"]),
        (STAT, octets(4, lambda data: b"\x03"), ["CTL_STAT: number of blocks 3 in octet 4, right 2 (2 times)"]),
        (STAT, telegram(CtlStat, check=2), ["CTL_STAT: CtlChk 10 (forced), right 01 (correct) (2 times)"]),
        (IDENT, telegram(CtlIdent, scenario_hash=7), ["scenario differs: plant ", ", controller 00000007"]),
        (IDENT, telegram(CtlIdent, wire_hash=7), ["DBC differs: plant 20c37552, controller 00000007"]),
        (IDENT, telegram(CtlIdent, role=2), ["CTL_IDENT has role 2, allowed 1"]),
    ],
)  # fmt: skip
def test_each_fault_is_one_line(run_2m: Scenario, changed: int, change: Change, expected: list[str]) -> None:
    found = checked(run_2m, changed, change)
    assert len(found.faults) == 1, found.faults
    assert [words for words in expected if words not in found.faults[0]] == [], found.faults
    assert found.exit_code == FAIL


@pytest.mark.parametrize(
    ("changed", "change", "note"),
    [
        (NOTCH, telegram(NotchCmd, emergency=2), "NOTCH_CMD: EmergencyBrake true in every answer, usual false"),
        (STAT, telegram(CtlStat, ready=1), "CTL_STAT: CtlReady false in every answer, usual true"),
    ],
)
def test_a_flag_that_is_never_as_usual_is_said_and_no_fault(
    run_2m: Scenario, changed: int, change: Change, note: str
) -> None:
    found = checked(run_2m, changed, change)
    assert (found.notes, found.faults) == ([note], [])


def test_the_seed_of_a_controller_is_not_compared(run_2m: Scenario) -> None:
    found = checked(run_2m, IDENT, telegram(CtlIdent, seed=77, perturbed=2))
    assert found.faults == []


def test_the_form_of_can_fd_is_checked_as_well(run_2m: Scenario) -> None:
    assert checked(run_2m, fd=True).faults == []
    notch, stat = NotchCmd.port().fd_id, CtlStat.port().fd_id
    inverted = octets(17, lambda data: bytes([data[17] ^ 0xFF]))
    (line,) = checked(run_2m, stat, inverted, fd=True).faults
    assert line.startswith("CTL_STAT: check sequence of block 2 ")
    assert line.endswith(" (not inverted) (2 times)")
    classic: Change = lambda frames, number: [Frame(notch, frames[0].data)]  # noqa: E731
    (line,) = checked(run_2m, notch, classic, fd=True).faults
    assert line == "NOTCH_CMD: frame 115 is a classic frame, right a CAN FD frame (10 times)"


def test_a_late_answer_is_a_fault_in_real_time_only(run_2m: Scenario) -> None:
    same: Change = lambda frames, number: frames  # noqa: E731
    assert checked(run_2m, NOTCH, same, delay_ns=7_000_000).faults == []
    found = checked(run_2m, NOTCH, same, delay_ns=7_000_000, pace="realtime")
    assert found.faults == ["NOTCH_CMD: answer after 7.0 ms, in real time within 5 ms (10 times)"]


def test_frames_before_the_first_poll_are_a_fault_and_others_are_counted(run_2m: Scenario) -> None:
    found = checked(run_2m, sent_before=(Frame(NOTCH, bytes(8)), Frame(0x7F0, b"")))
    assert found.faults == ["frame 110, which nobody asked for: before the first poll"]
    assert found.others == 1


def test_a_second_administrator_is_refused(run_2m: Scenario) -> None:
    with pytest.raises(BusOccupied):
        checked(run_2m, sent_before=(master_frame(15, 1),))


def test_without_an_answer_nothing_is_said_about_the_controller(run_2m: Scenario) -> None:
    with pytest.raises(
        PeerSilent, match=r"no controller answers the device status poll \(080#F001C8\) within 1 s"
    ) as no:
        checked(run_2m, STATUS, lambda frames, number: [])
    assert exit_code_of(no.value) == INVALID


def test_an_answer_under_another_identifier_is_named(run_2m: Scenario) -> None:
    with pytest.raises(PeerSilent, match=r"within 1 s, but frames 089 have come, right 088$"):
        checked(run_2m, STATUS, lambda frames, number: [Frame(STATUS + 1, frames[0].data)])


def test_the_node_learns_that_the_run_is_over(run_2m: Scenario) -> None:
    """It is told so also when the check is stopped."""
    node, wall = ControllerNode(run_2m, LawSpec()), SetClock()

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        if frame == master_frame(3, wire_contract().port("CTL_STAT").address):
            raise KeyboardInterrupt
        return [(_ANSWER_NS, one) for one in node.handle(frame)]

    endpoint = FakeEndpoint(wall, answer)
    run = RunSpec(str(run_2m.name), patience_s=1.0)
    with pytest.raises(KeyboardInterrupt):
        FirstCheck(endpoint, run_2m, run, appear_s=1.0, wall=wall).check()
    assert node.ended is not None
