"""The rules that hold in every run: each is kept by real runs and found broken in records made to break it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from hil_tests.unit.systems.ato.stories import SCENARIO, Story
from railhil.bus.ident import PltIdent, Role, make_ident
from railhil.dbc import wire_contract
from railhil.judge.events.telegrams import events_of
from railhil.judge.reception import shown, taken
from railhil.plant_sim.ato.command_watch import GOOD_AFTER_SERVICE_BRAKE as TRAIN_AFTER_BRAKE
from railhil.plant_sim.ato.command_watch import GOOD_AFTER_TRACTION_CUT as TRAIN_AFTER_CUT
from railhil.scenarios.load import load_any
from railhil.systems.ato.judge.events import received
from railhil.systems.ato.judge.invariants import GOOD_NEEDED, broken
from railhil.systems.ato.judge.score import score
from railhil.wire.ato import TrnSpeed, TrnWatch


def found(story: Story) -> list[str]:
    return broken(SCENARIO, story.trace())


@pytest.mark.parametrize("unheard", [None, (30, 1)])
def test_a_telegram_that_the_controller_could_not_hear_does_not_age_those_after_it(
    unheard: tuple[int, int] | None,
) -> None:
    """A hunt found this: the recorder has one telegram of an outage, and its sign makes later ones look old."""
    silent = {*range(30, 48)} - {35}
    story = Story(
        controller_level=lambda tick: 3 if 40 <= tick < 58 else 0,
        notch_256th=lambda tick: 0,
        speed_unseen=silent,
        unheard=unheard,
    )
    broken_rules = [said for said in found(story) if said.startswith("invariant 4")]
    assert bool(broken_rules) is (unheard is None), broken_rules


@pytest.mark.parametrize("unheard", [None, (30, 10)])
def test_telegrams_that_the_controller_could_not_hear_release_no_brake(unheard: tuple[int, int] | None) -> None:
    story = Story(
        controller_level=lambda tick: 3 if 30 <= tick < 40 else 0, notch_256th=lambda tick: 0, unheard=unheard
    )
    broken_rules = [said for said in found(story) if said.startswith("invariant 4")]
    assert bool(broken_rules) is (unheard is not None), broken_rules


def test_telegrams_kept_from_the_controller_still_show_the_train() -> None:
    trace = Story(unheard=(30, 3)).trace()
    (item,) = (one for one in received(SCENARIO) if one.port == TrnSpeed.PORT)
    assert set(range(100)) - {*taken(SCENARIO, trace, item).nonzero()[0].tolist()} == {30, 31, 32}
    assert shown(SCENARIO, trace, item).all()


def test_a_quiet_run_breaks_no_rule() -> None:
    assert found(Story(traction_20n=lambda tick: 500)) == []


@pytest.mark.parametrize(("level", "words"), [(5, ("ended", "")), (6, ("7", "CtlMode 7 is no value of NOTCH_CMD"))])
def test_a_mode_that_is_no_level_is_judged_and_shown(level: int, words: tuple[str, str]) -> None:
    """A foreign controller may send any value."""
    story = Story(controller_level=lambda tick: level if 40 <= tick < 60 else 0)
    assert found(story) == []
    (event,) = (event for event in events_of(SCENARIO, story.trace()) if event.source == "controller")
    assert (event.time_s, event.until_s, (event.cause, event.detail)) == (0.4, 0.6, words)


def test_a_level_that_the_watch_of_the_train_does_not_have_is_not_known() -> None:
    story = Story(train_level=lambda tick: 7 if 40 <= tick < 60 else 0, traction_20n=lambda tick: 500)
    assert found(story) == []
    assert "WatchLevel 7 is no value of TRN_WATCH" in {
        event.detail for event in events_of(SCENARIO, story.trace()) if event.source == "train"
    }


def test_the_numbers_are_those_of_the_watches() -> None:
    assert GOOD_NEEDED == {1: 1, 2: TRAIN_AFTER_CUT, 3: TRAIN_AFTER_BRAKE}


@pytest.mark.parametrize("level", [2, 3, 4])
def test_traction_at_a_level_that_cuts_it(level: int) -> None:
    at = {"train_level": lambda tick: level if 30 <= tick < 50 else 0, "controller_level": lambda tick: 0}
    if level < 4:
        assert found(Story(**at)) == []
    (said, *_) = found(Story(**at, traction_20n=lambda tick: 500 if tick == 40 else 0))
    assert said.startswith("invariant 2: the train applies 10.0 kN")
    assert "at 0.40 s" in said
    late = {"controller_level": lambda tick: level if tick >= 50 else 0}
    (said, *_) = found(Story(**late, notch_256th=lambda tick: 256 if tick <= 60 else 0))
    assert said.startswith("invariant 2: the controller commands notch 1.00")
    assert "at 0.50 s" in said


@pytest.mark.parametrize(("level", "rule_holds"), [(2, True), (3, True), (4, False)])
def test_a_drive_that_is_stuck_on_is_cut_by_the_main_breaker(level: int, rule_holds: bool) -> None:
    stuck = replace(SCENARIO, faults=("traction full @0.1s",))
    story = Story(train_level=lambda tick: level if tick >= 30 else 0, traction_20n=lambda tick: 500)
    assert (broken(stuck, story.trace()) == []) is rule_holds
    assert found(story) != []


def test_spinning_wheels_push_the_train_whatever_the_drive_does() -> None:
    """What the drive does is then seen by the notch in effect."""
    slippery = replace(SCENARIO, faults=("adhesion low 0.03 @0.1s",))
    story = Story(train_level=lambda tick: 4 if tick >= 30 else 0, traction_20n=lambda tick: 500)
    assert broken(slippery, story.trace()) == []
    assert broken(replace(SCENARIO, faults=("mass scale 1.2 @0.1s",)), story.trace()) != []
    story.notch_actual_16th = lambda tick: 40 if tick < 30 else 0
    assert broken(slippery, story.trace()) == []
    story.notch_actual_16th = lambda tick: 40 if tick <= 50 else 0
    (said,) = broken(slippery, story.trace())
    assert said == "invariant 2: the train has notch 2.50 in effect at EMERGENCY, at 0.32 s"
    repeated = replace(story, position_life=lambda tick: min(tick, 28) // 2)
    assert broken(slippery, repeated.trace()) == []
    forged = replace(slippery, faults=(*slippery.faults, "TRN_POS.NotchActual value 3 @0.1s"))
    assert broken(forged, story.trace()) == []


def test_a_level_of_the_same_instant_may_be_of_a_later_tick() -> None:
    """When the port that opens the ticks is lost, the record has the instants of the polls."""
    later = Story(train_level=lambda tick: 4 if tick >= 30 else 0, traction_20n=lambda tick: 500 if tick <= 30 else 0)
    assert found(later) == []


def test_a_level_that_was_entered_unseen_is_not_judged() -> None:
    """The record shows it two ticks late, with one good telegram less than it took."""
    level = {"train_level": lambda tick: 3 if 30 <= tick < 50 else 0}
    assert found(Story(**level)) == []
    assert found(Story(**level, watch_lost={30})) == []


def test_traction_on_the_way_out_is_none() -> None:
    """At the instant of the new level, and while the level is not in the record."""
    hold = Story(train_level=lambda tick: 1 if tick >= 30 else 0, traction_20n=lambda tick: 500)
    assert found(hold) == []
    cut = Story(train_level=lambda tick: 2 if tick >= 30 else 0, traction_20n=lambda tick: 500 if tick < 30 else 0)
    assert found(cut) == []
    unknown = Story(
        train_level=lambda tick: 2 if 30 <= tick < 36 else 0,
        traction_20n=lambda tick: 500 if not 30 <= tick < 36 else 0,
        watch_lost={36},
    )
    assert found(unknown) == [], "a level that may have changed unseen is not judged"


@pytest.mark.parametrize(("from_tick", "emergency_tick", "breaks"), [(20, 21, False), (20, 60, True), (90, 999, False)])
def test_beyond_the_margin_the_emergency_brake_is_applied(from_tick: int, emergency_tick: int, breaks: bool) -> None:
    """At the end of a record there is no time left to react."""
    most_01mmps = round((78 + 5) / 3.6 * 1e4)
    story = Story(
        train_level=lambda tick: 4 if tick >= emergency_tick else 0,
        notch_256th=lambda tick: -256,
        speed_01mmps=lambda tick: most_01mmps + (500 if tick >= from_tick else -500),
    )
    assert [text[:11] for text in found(story)] == (["invariant 3"] if breaks else [])


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("missing", [0, 1])
def test_the_train_leaves_a_level_after_good_commands(level: int, missing: int) -> None:
    """Commands come every second tick."""
    ticks = 2 * (GOOD_NEEDED[level] - missing)
    story = Story(
        train_level=lambda tick: level if 20 <= tick < 20 + max(ticks, 1) else 0, without={20} if not ticks else set()
    )
    said = found(story)
    assert bool(said) is bool(missing)
    assert all(text.startswith("invariant 4: the train left") for text in said)


@pytest.mark.parametrize(
    ("left_tick", "lost", "rule_holds"),
    [(38, set(), False), (39, set(), True), (38, {38}, False), (39, {39}, True), (39, {39, 40}, True)],
)
def test_what_came_first_is_told_by_the_order_of_the_record(left_tick: int, lost: set[int], rule_holds: bool) -> None:
    """The tenth command is that of tick 38; a report whose tick was not opened has its instant, and comes after it."""
    left = Story(train_level=lambda tick: 3 if 20 <= tick < left_tick else 0)
    assert (found(replace(left, speed_lost=lost)) == []) is rule_holds
    # A telegram that its receiver refuses opens no tick either.
    assert (found(replace(left, check=lambda tick: 0 if tick in lost else 1)) == []) is rule_holds


def test_two_reports_of_the_same_instant_are_two() -> None:
    """TRACTION CUT is left after two commands, and entered again in the next tick, which is not opened either."""
    story = Story(train_level=lambda tick: 2 * int(20 <= tick < 23 or tick >= 24), speed_lost={23, 24})
    assert found(story) == ["invariant 4: the train left TRACTION CUT at 0.22 s after 2 good telegrams, needed 5"]


def test_the_levels_of_a_controller_that_answers_late_are_not_counted() -> None:
    early = Story(controller_level=lambda tick: 3 if 20 <= tick < 24 else 0, notch_256th=lambda tick: -256)
    (said,) = found(early)
    assert said.startswith("invariant 4: the controller left SERVICE BRAKE")
    late = replace(SCENARIO, faults=("controller slow 300ms @0.1s",))
    assert broken(late, early.trace()) == []
    (said, *_) = broken(late, replace(early, notch_256th=lambda tick: 256).trace())
    assert said.startswith("invariant 2: the controller commands")


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("missing", [0, 1])
def test_the_controller_leaves_a_level_after_good_speeds(level: int, missing: int) -> None:
    """Speeds come every tick; those that a check refuses do not count. The level is told every second tick."""
    end = 40 + -(-GOOD_NEEDED[level] // 2) * 2
    surplus = end - 40 + 2 - GOOD_NEEDED[level]
    bad = set(range(39, 39 + surplus + missing))
    story = Story(
        controller_level=lambda tick: level if 40 <= tick < end else 0,
        notch_256th=lambda tick: 0,
        check=lambda tick: 0 if tick in bad else 1,
    )
    said = found(story)
    assert bool(said) is bool(missing)
    assert all(text.startswith("invariant 4: the controller left") for text in said)


def test_the_service_brake_is_left_at_a_standstill() -> None:
    def of(speed_01mmps: int) -> Story:
        return Story(
            train_level=lambda tick: 3 if 20 <= tick < 24 else 0,
            controller_level=lambda tick: 3 if 20 <= tick < 24 else 0,
            notch_256th=lambda tick: -256,
            speed_01mmps=lambda tick: speed_01mmps,
        )

    assert found(of(0)) == []
    assert [text[:11] for text in found(of(1000))] == ["invariant 4", "invariant 4"]


@pytest.mark.parametrize(("tick_of_zero", "is_refused", "rule_holds"), [
    (43, False, True), (41, False, True), (39, False, True), (37, False, False), (43, True, False), (45, False, False),
])  # fmt: skip
def test_a_standstill_between_two_polls_ends_the_controllers_service_brake(
    tick_of_zero: int, is_refused: bool, rule_holds: bool
) -> None:
    """A noisy sensor shows one standstill of a train that moves off; the poll has a level only each second tick. The
    speed must have been accepted, after the poll before the level and before the one without it."""
    story = Story(
        controller_level=lambda tick: 3 if 40 <= tick < 44 else 0,
        notch_256th=lambda tick: 0,
        speed_01mmps=lambda tick: 0 if tick == tick_of_zero else 28,
        check=lambda tick: 0 if is_refused and tick == tick_of_zero else 1,
    )
    said = found(story)
    assert [text[:38] for text in said] == ([] if rule_holds else ["invariant 4: the controller left SERVI"])


def test_a_level_left_in_a_gap_of_the_truth_is_unclear() -> None:
    """At a standstill it may be left at once; without SIM_TRUTH nobody knows whether the train stood."""
    story = Story(train_level=lambda tick: 3 if tick < 1 else 0, speed_01mmps=lambda tick: 100 * tick)
    assert found(story) == []
    (said,) = found(replace(story, truth_lost=set(range(10))))
    assert said == "record: the train left SERVICE BRAKE at 0.01 s, and no SIM_TRUTH shows whether the train stood"


@pytest.mark.parametrize(("lost", "unclear"), [({42}, False), ({42, 46}, True)])
def test_telegrams_that_only_the_recorder_has_missed_are_no_breach(lost: set[int], unclear: bool) -> None:
    """TRACTION CUT is left after four recorded commands; the fifth, or three more, may have come unseen."""
    level = (lambda tick: 2 if 40 <= tick < 48 else 0) if not unclear else (lambda tick: 2 if 40 <= tick < 50 else 0)
    story = Story(train_level=level, without=lost)
    assert [text[:31] for text in found(story)] == ["invariant 4: the train left TRA"]
    (said,) = found(replace(story, whole=False))
    if unclear:
        assert said.startswith("record: the train left TRACTION CUT at 0.50 s after 3 good NOTCH_CMD telegrams")
        assert score(SCENARIO, replace(story, whole=False).trace()).verdict == "INVALID"
    else:
        assert said.startswith("invariant 4: the train left TRACTION CUT at 0.48 s after 3 good telegrams")


@pytest.mark.parametrize(
    ("left_tick", "lost", "unclear"), [(46, 0, False), (46, 1, False), (48, 1, True), (48, 3, True)]
)
def test_speeds_that_only_the_recorder_has_missed_are_no_breach(left_tick: int, lost: int, unclear: bool) -> None:
    """At tick 48 ten speeds have come, with those that are not recorded."""
    story = Story(
        controller_level=lambda tick: 3 if 40 <= tick < left_tick else 0,
        notch_256th=lambda tick: 0,
        speed_unseen=set(range(44, 44 + lost)),
        whole=False,
    )
    (said,) = found(story)
    assert said.startswith("record: the controller left" if unclear else "invariant 4: the controller left")


@pytest.mark.parametrize(
    ("who", "port", "burst"),
    [
        ("train", "NOTCH_CMD", {"train_level": lambda tick: int(20 <= tick < 22), "report_late": {20}}),
        ("controller", "TRN_SPEED", {"controller_level": lambda tick: int(tick == 20), "command_late": {18, 20}}),
    ],
)
def test_after_a_burst_in_real_time_nobody_knows_what_was_taken_when(
    who: str, port: str, burst: dict[str, Any]
) -> None:
    """The record has the good telegram before the level that it ends: the node has taken it later. In lockstep each
    waits for the other, so that the record's order is theirs."""
    (said,) = found(Story(**burst))
    assert said.startswith(f"invariant 4: the {who} left HOLD at 0.22 s after 0 good telegrams, needed 1")
    story = Story(**burst, pace="realtime", whole=False)
    (said,) = found(story)
    assert said.startswith(
        f"record: the {who} left HOLD at 0.22 s after 0 good {port} telegrams, needed 1: in real time"
    )
    # Too few, in whatever order they were taken.
    left = {"controller_level": lambda tick: 0, "train_level": lambda tick: int(20 <= tick < 22)}
    bad = replace(story, notch_256th=lambda tick: 0x7FFF if tick >= 12 else 256, **left)
    assert found(bad) == ["invariant 4: the train left HOLD at 0.22 s after 0 good telegrams, needed 1"]


def test_emergency_is_never_left() -> None:
    story = Story(
        train_level=lambda tick: 4 if 20 <= tick < 70 else 0,
        controller_level=lambda tick: 4 if 20 <= tick < 70 else 0,
        notch_256th=lambda tick: -256,
    )
    assert found(story) == [
        "invariant 4: the controller left EMERGENCY at 0.70 s",
        "invariant 4: the train left EMERGENCY at 0.70 s",
    ]


def test_a_record_without_the_trains_watch_is_judged_by_the_rest() -> None:
    trace = Story(controller_level=lambda tick: 2, traction_20n=lambda tick: 500).trace()
    trace._times_ns.pop(TrnWatch.PORT)
    assert [text[:30] for text in broken(SCENARIO, trace)] == ["invariant 2: the controller co"]
    # On a bus there is one.
    trace.add(PltIdent.PORT, 0, make_ident(Role.PLANT, SCENARIO.sha256, contract=wire_contract()).encode())
    assert broken(SCENARIO, trace)[1] == "record: no TRN_WATCH, so the level of the train's watch is not known"


def test_an_unfinished_record_stays_invalid() -> None:
    assert score(SCENARIO, Story(notch_256th=lambda tick: 256).trace()).verdict == "INVALID"


def test_a_controller_that_starts_anew_has_left_no_level() -> None:
    story = Story(
        controller_level=lambda tick: 4 if tick < 50 else -1 if tick < 60 else 0,
        notch_256th=lambda tick: 0,
    )
    assert found(story) == []


@pytest.mark.parametrize(
    ("fault", "checked"),
    [
        ("TRN_SPEED stuck @1s", True), ("TRN_SPEED corrupt @1s", True), ("NOTCH_CMD stuck @1s", True),
        ("NOTCH_CMD loss x1 @1s", True), ("NOTCH_CMD delay 40ms @1s", True), ("NOTCH_CMD replay 200ms @1s", True),
        ("NOTCH_CMD.counter freeze @1s", True), ("NOTCH_CMD.checksum random @1s", True),
        ("notch value 3 @1s", False), ("NOTCH_CMD.NotchCmd value 3 @1s", False), ("NOTCH_CMD.CtlMode stuck @1s", False),
        ("NOTCH_CMD corrupt bits 9 @1s", False),
    ],
)  # fmt: skip
def test_what_a_fault_commands_is_not_the_controllers(fault: str, checked: bool) -> None:
    """A telegram that is lost, late or repeated hides no traction that the controller commands itself."""
    said = broken(load_any("lvshun_tieshan", (), (fault,)), Story(controller_level=lambda tick: 4).trace())
    assert [text[:38] for text in said] == (["invariant 2: the controller commands n"] if checked else [])
