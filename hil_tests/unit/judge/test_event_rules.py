"""Single rules of the events, on records of a few telegrams."""

from __future__ import annotations

import json
from collections.abc import Iterable
from random import Random

import pytest

from hil_tests.support.disturbed import damaged
from hil_tests.support.paths import TEST_DATA
from hil_tests.support.told import told
from railhil.bus.frame import ERROR, EXTENDED, Frame
from railhil.bus.ident import PltIdent, Role
from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE, FLAG_TRUE, Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.controller_node.ato.guard import SPEED_MAX_01MMPS
from railhil.dbc import recorded_contract, wire_contract
from railhil.judge.events.event import RecordedEvent
from railhil.judge.events.summary import summary, why
from railhil.judge.events.telegrams import events_of
from railhil.record.trace import Trace, trace_of
from railhil.scenarios.load import load
from railhil.systems.ato.judge.events import SPEED_RANGE_01MMPS
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlCause, CtlMode, NotchCmd, PltStat, TrnPos, TrnSpeed, TrnWatch, WatchCause

TICK_NS = 10_000_000


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("lvshun_tieshan")


def frames_of(*telegrams: tuple[int, Telegram]) -> list[tuple[int, Frame]]:
    """A record of telegrams (tick, telegram), in their order."""
    sources: dict[str, TelegramSource] = {}
    found = []
    for tick, telegram in telegrams:
        source = sources.setdefault(telegram.PORT, TelegramSource(telegram.port(), False))
        found += [(tick * TICK_NS, frame) for frame in source.frames(telegram.encode())]
    return found


def events_in(scenario: Scenario, record: Iterable[tuple[int, Frame]]) -> list[RecordedEvent]:
    return list(events_of(scenario, trace_of(record, wire_contract())))


def speeds(*lives: int, **fields: int) -> list[tuple[int, Frame]]:
    return frames_of(*((tick, TrnSpeed(1000, life=life, **fields)) for tick, life in enumerate(lives)))


def test_life_signs_are_judged_as_the_receiver_does(scenario: Scenario) -> None:
    found = events_in(scenario, speeds(0, 1, 1, 1, 2, 14, 3))
    assert [(event.source, event.cause, event.count) for event in found] == [
        ("TRN_SPEED", "duplicate", 2), ("TRN_SPEED", "out_of_order", 1),
    ]  # fmt: skip


def test_a_gap_of_the_life_sign_is_no_refusal(scenario: Scenario) -> None:
    assert events_in(scenario, speeds(0, 1, 5, 6)) == []


def test_check_variable_and_range_are_judged_as_the_receiver_does(scenario: Scenario) -> None:
    (wrong,) = events_in(scenario, speeds(0, 1, check=CHECK_CORRECT + 1))
    assert (wrong.cause, wrong.count) == ("check_variable", 2)
    outside = frames_of((0, TrnSpeed(-1, life=0)), (1, TrnSpeed(SPEED_MAX_01MMPS + 1, life=1)))
    (wrong,) = events_in(scenario, [*outside, *frames_of((2, TrnPos(0, life=4)))])
    assert (wrong.source, wrong.cause, wrong.count) == ("TRN_SPEED", "out_of_range", 2)
    beyond = NotchCmd(7 * 256 + 1, CtlMode.RUNNING, life=3)
    assert told(events_in(scenario, frames_of((0, beyond)))) == [("NOTCH_CMD", "out_of_range", "")]


def test_of_a_position_only_its_own_check_variable_is_judged(scenario: Scenario) -> None:
    """The controller takes the odometer; the effort beside it has a check variable of its own."""
    assert events_in(scenario, frames_of((0, TrnPos(0, effort_check=CHECK_CORRECT + 1, life=0)))) == []
    (wrong,) = events_in(scenario, frames_of((0, TrnPos(0, check=CHECK_CORRECT + 1, life=0))))
    assert (wrong.source, wrong.cause) == ("TRN_POS", "check_variable")


def test_the_range_of_speeds_is_that_of_the_controller() -> None:
    assert SPEED_RANGE_01MMPS == (0, SPEED_MAX_01MMPS)


def test_refusals_far_apart_are_events_of_their_own(scenario: Scenario) -> None:
    (frame,) = [frame for _, frame in speeds(0)]
    record = [(tick * TICK_NS, damaged(frame)) for tick in (0, 1, 200, 500, 501)]
    found = [event for event in events_in(scenario, record) if event.kind == "refused"]
    assert [(event.time_s, event.until_s, event.count) for event in found] == [(0.0, 2.0, 3), (5.0, 5.01, 2)]


def test_frames_of_the_bus_are_named_by_their_kind(scenario: Scenario) -> None:
    record = [
        (0, Frame(0, b"", ERROR)),
        (0, Frame(TrnSpeed.port().address, bytes(8), EXTENDED)),
        (0, Frame(wire_contract().poll_id, b"\1\2\3")),
        (0, Frame(0x7FF, bytes(8))),
        (0, Frame(TrnSpeed.port().address, bytes(7))),
    ]
    assert told(events_in(scenario, record)) == [
        ("TRN_SPEED", "wrong_length", ""), ("bus", "error_frame", ""), ("bus", "extended_id", ""),
        ("bus", "wrong_master_word", ""), ("bus 7FF", "unknown_id", ""),
    ]  # fmt: skip


def test_frames_of_other_systems_are_no_reason(scenario: Scenario) -> None:
    events = events_in(scenario, [(0, Frame(0x7FF, bytes(8)))])
    assert why(scenario, events) == ""
    assert why(scenario, events_in(scenario, [(0, Frame(0, b"", ERROR))])) == "1 bus refused (error_frame)"


def test_a_block_that_waits_for_its_trailer_is_not_refused(scenario: Scenario) -> None:
    (block, _), whole = (frames_of((0, TrnPos(5, life=0))), frames_of((1, TrnPos(5, life=1))))
    assert events_in(scenario, [block, *whole]) == []
    without = [*frames_of((0, TrnPos(5, life=0)))[1:], *whole]
    assert told(events_in(scenario, without)) == [("TRN_POS", "missing_block", "")]


def test_lost_telegrams_are_counted_once(scenario: Scenario) -> None:
    ticks = [tick for tick in range(60) if not 20 <= tick < 24]
    record = frames_of(*((tick, TrnSpeed(1000, life=tick & 0xF)) for tick in ticks))
    (lost,) = events_in(scenario, record)
    assert (lost.kind, lost.source, lost.count, lost.time_s, lost.until_s) == ("lost", "TRN_SPEED", 4, 0.2, 0.24)
    assert why(scenario, [lost]) == "4 TRN_SPEED lost (gap)"


def positions(*ticks: int) -> list[tuple[int, Telegram]]:
    """TRN_POS at these ticks; its life sign counts periods of two ticks."""
    return [(tick, TrnPos(0, life=tick // 2 & 0xF)) for tick in ticks]


def test_copies_hide_no_loss(scenario: Scenario) -> None:
    """50 telegrams came twice; then 10 are lost."""
    copied = [item for item in positions(*range(0, 100, 2)) for _ in range(2)]
    events = events_in(scenario, frames_of(*copied, *positions(*range(120, 200, 2))))
    (lost,) = (event for event in events if event.kind == "lost")
    assert (lost.source, lost.count, lost.time_s, lost.until_s) == ("TRN_POS", 10, 1.0, 1.2)


@pytest.mark.parametrize("missing", [1, 14, 15, 16, 17, 300])
def test_the_life_sign_may_go_round_in_an_outage(scenario: Scenario, missing: int) -> None:
    after = 200 + 2 * missing
    events = events_in(scenario, frames_of(*positions(*range(0, 200, 2), *range(after, after + 80, 2))))
    (lost,) = (event for event in events if event.kind == "lost")
    assert (lost.count, lost.time_s) == (missing, 2.0)


def test_an_outage_may_last_to_the_end_or_from_the_start(scenario: Scenario) -> None:
    opened = PltIdent(Role.PLANT)
    record = frames_of((0, opened), *positions(*range(50, 100, 2)), (300, TrnSpeed(0, life=3)))
    lost = {event.source: event for event in events_in(scenario, record) if event.kind == "lost"}
    # The last one was due at tick 98, and a tick is not over before the next begins.
    assert (lost["TRN_POS"].count, lost["TRN_POS"].time_s, lost["TRN_POS"].until_s) == (100, 1.0, 3.0)
    assert (lost["PLT_STAT"].count, lost["PLT_STAT"].time_s) == (19, 0.0)
    # A speed that only begins late; a channel that a scenario need not have; a balise that was not passed.
    assert (lost["TRN_SPEED"].count, lost["TRN_SPEED"].until_s) == (300, 3.0)
    assert not {"SPEED_SDT", "BALISE", "NOTCH_CMD"} & lost.keys()


def test_a_stuck_counter_loses_nothing(scenario: Scenario) -> None:
    stuck = [(tick, TrnPos(0, life=min(tick // 2, 20) & 0xF)) for tick in range(0, 200, 2)]
    events = events_in(scenario, frames_of(*stuck, *positions(*range(200, 240, 2))))
    assert [event for event in events if event.kind == "lost"] == []


def test_time_stamps_that_are_late_for_a_while_lose_nothing(scenario: Scenario) -> None:
    late = {20: 19, 21: 19, 22: 21, 23: 21, 24: 21}
    record = frames_of(*((late.get(tick, tick), TrnSpeed(1000, life=tick & 0xF)) for tick in range(80)))
    assert events_in(scenario, record) == []


def test_polls_without_an_answer(scenario: Scenario) -> None:
    port = NotchCmd.port()
    asked = master_frame(port.f_code, port.address)
    (answer,) = [frame for _, frame in frames_of((0, NotchCmd(0, CtlMode.RUNNING, life=1)))]
    record = [(0, asked), (2 * TICK_NS, asked), (2 * TICK_NS, damaged(answer)), (4 * TICK_NS, asked)]
    found = [event for event in events_in(scenario, [*record, (4 * TICK_NS, answer)]) if event.kind == "missed_poll"]
    assert [(event.cause, event.time_s) for event in found] == [("no_answer", 0.0), ("answer_refused", 0.02)]


def test_an_empty_frame_says_that_there_is_no_answer(scenario: Scenario) -> None:
    port = NotchCmd.port()
    asked, silence = master_frame(port.f_code, port.address), Frame(port.can_ids[-1], b"")
    record = [(0, asked), (0, silence), (2 * TICK_NS, asked), (2 * TICK_NS, silence)]
    (found,) = events_in(scenario, record)
    assert (found.kind, found.source, found.cause, found.count) == ("missed_poll", "NOTCH_CMD", "no_answer", 2)


def commands(*modes: tuple[CtlMode, CtlCause]) -> list[tuple[int, Frame]]:
    return frames_of(
        *((2 * step, NotchCmd(0, mode, cause, life=step & 0xF)) for step, (mode, cause) in enumerate(modes))
    )


def test_a_level_that_is_reached_again_is_counted(scenario: Scenario) -> None:
    running, cut = (CtlMode.RUNNING, CtlCause.NONE), (CtlMode.TRACTION_CUT, CtlCause.BAD_TELEGRAMS)
    held = (CtlMode.HOLD, CtlCause.BAD_TELEGRAMS)
    events = events_in(scenario, commands(running, held, cut, running, cut, cut, running))
    assert why(scenario, events) == "TRACTION CUT from 0.04 s (bad TRN_SPEED telegrams, 2 times)"


def test_another_cause_at_the_same_level_is_an_event_but_not_a_new_reaction(scenario: Scenario) -> None:
    running = (CtlMode.RUNNING, CtlCause.NONE)
    brakes = [(CtlMode.SERVICE_BRAKE, cause) for cause in (CtlCause.SPEED_AGE, CtlCause.POSITION_LOST)]
    events = events_in(scenario, commands(running, *brakes, running))
    assert [(event.cause, event.time_s, event.until_s) for event in events] == [
        ("speed_age", 0.02, 0.04), ("position_lost", 0.04, 0.06),
    ]  # fmt: skip
    assert why(scenario, events) == "SERVICE BRAKE from 0.02 s (TRN_SPEED older than 256 ms, for 0.04 s)"


def test_a_controller_that_initialises_again_has_started_again(scenario: Scenario) -> None:
    begun, running = (CtlMode.INITIALISING, CtlCause.NONE), (CtlMode.RUNNING, CtlCause.NONE)
    events = events_in(scenario, commands(begun, running, begun, running))
    assert told(events, "start") == [("controller", "initialising", "")] * 2
    assert why(scenario, events) == ""


def watched(*levels: tuple[int, WatchCause]) -> list[tuple[int, Frame]]:
    return frames_of(
        *((tick, TrnWatch(level, cause, 0, life=tick & 0xF)) for tick, (level, cause) in enumerate(levels))
    )


def test_a_train_that_never_gets_a_command_has_not_started(scenario: Scenario) -> None:
    events = events_in(scenario, watched((3, WatchCause.NO_COMMAND), (3, WatchCause.NO_COMMAND)))
    assert told(events) == [("train", "no_command", "service_brake")]
    assert why(scenario, events) == "train's SERVICE BRAKE from 0.00 s (no NOTCH_CMD yet, for 0.01 s)"


@pytest.mark.parametrize("cause", [*CtlCause][1:])
def test_every_cause_of_the_controller_has_words(scenario: Scenario, cause: CtlCause) -> None:
    events = events_in(scenario, commands((CtlMode.EMERGENCY, cause)))
    assert why(scenario, events).startswith("EMERGENCY from 0.00 s (")
    assert "_" not in events[0].detail.replace("TRN_SPEED", "").replace("TRK_INFO", "")


@pytest.mark.parametrize("cause", [*WatchCause][1:])
def test_every_cause_of_the_train_has_words(scenario: Scenario, cause: WatchCause) -> None:
    events = events_in(scenario, watched((4, cause)))
    assert why(scenario, events).startswith("train's EMERGENCY from 0.00 s (")
    assert "_" not in events[0].detail.replace("NOTCH_CMD", "")


def status(**fields: int) -> PltStat:
    true = {name: FLAG_TRUE for name, signal in PltStat.signals() if signal.check == "antivalent"}
    return PltStat(**{**true, **fields})


def test_an_interlock_is_an_event_from_its_change_to_its_return(scenario: Scenario) -> None:
    doors = {name: field for field, signal in PltStat.signals() if (name := signal.name) == "DoorsClosedLocked"}
    opened = {doors["DoorsClosedLocked"]: FLAG_FALSE}
    record = frames_of((0, status()), (16, status(**opened)), (32, status()), (48, status(**opened)))
    found = events_in(scenario, record)
    assert [(event.source, event.cause, event.time_s, event.until_s, event.detail) for event in found] == [
        ("PLT_STAT", "DoorsClosedLocked", 0.16, 0.32, "DoorsClosedLocked false"),
        ("PLT_STAT", "DoorsClosedLocked", 0.48, 0.48, "DoorsClosedLocked false"),
    ]


def test_events_of_another_source_are_merged_in_order(scenario: Scenario) -> None:
    fault = RecordedEvent(0.02, "TRN_SPEED", "fault", "loss")
    events = events_of(scenario, trace_of(speeds(0, 1, 1, 1, 2), wire_contract()), [fault])
    assert [event.kind for event in events] == ["fault", "refused"]


def test_a_level_without_a_recorded_cause_is_derived(scenario: Scenario) -> None:
    """As up to wire version 4: CtlMode has 8 bits, and there is no CtlCause."""
    kept = json.loads((TEST_DATA / "runs_0.1.0/lvshun_ipfc/certificate.json").read_text())
    trace = Trace(recorded_contract(TEST_DATA, kept["dbc_sha256"], wire_contract()))
    for tick, mode in enumerate((1, 1, 3, 3, 1)):
        trace.add(NotchCmd.PORT, tick * TICK_NS, bytes([0, 0, mode, 0x40 | tick]))
    trace.end_ns = 5 * TICK_NS
    events = events_of(scenario, trace)
    assert told(events) == [("controller", "", "traction_cut")]
    assert why(scenario, events) == "TRACTION CUT from 0.02 s (for 0.02 s)"


def test_no_content_of_frames_raises(scenario: Scenario) -> None:
    """Telegrams of every port with any content, whole and in parts, and frames of any identifier."""
    random = Random(12)
    ports = wire_contract().ports
    sources = [(port, TelegramSource(port, fd)) for port in ports for fd in (False, True)]
    record = []
    for tick in range(2000):
        port, source = random.choice(sources)
        frames = list(source.frames(random.randbytes(port.data_bytes)))
        frames = random.sample(frames, random.randint(1, len(frames)))
        frames.append(Frame(random.randrange(0x800), random.randbytes(random.randint(0, 8)), random.randrange(8)))
        polled = random.choice(ports)
        record += [(tick * TICK_NS, frame) for frame in (*frames, master_frame(polled.f_code, polled.address))]
    trace = trace_of(record, wire_contract())
    events = events_of(scenario, trace)
    assert len(events) > 500
    assert [event.time_s for event in events] == sorted(event.time_s for event in events)
    assert why(scenario, events)
    assert json.dumps(summary(scenario, events))
