"""What a record makes of a sentence: verdict, margin, instants, cases, what the end of the record leaves open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.unit.judge.requirements.records import REFUSED, REPEATED, judged, record_of
from railhil.bench import local_run
from railhil.bus.codes import Event, FaultOrder, SupCommand
from railhil.bus.telegrams import SupCmd
from railhil.judge.events.event import LEVEL
from railhil.judge.folder import write_folder
from railhil.judge.record import Record, checked_record
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.score import Score
from railhil.judge.stops import PlannedStop, ScoredStop, Standstill
from railhil.record.run_folder import write_inputs
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlMode

RUNNING, CUT, ENDED = int(CtlMode.RUNNING), int(CtlMode.TRACTION_CUT), int(CtlMode.ENDED)
LOSS = "whenever age(TRN_SPEED) > 20 ms, within 20 ms notch_command <= 0"


def lost(first: int, after: int, ticks: int = 30) -> list[int | None]:
    """1 m/s in each tick but some."""
    return [None if first <= tick < after else 1000 for tick in range(ticks)]


def notches(*steps: tuple[int, int], ticks: int = 30) -> list[tuple[int, int]]:
    """NOTCH_CMD: from a tick on a notch (1/256)."""
    return [([notch for since, notch in steps if since <= 2 * index][-1], RUNNING) for index in range(-(-ticks // 2))]


def test_a_reaction_in_time_is_kept_with_what_it_leaves_of_the_window() -> None:
    found = judged(record_of(lost(10, 16), notches((0, 512), (14, -128))), LOSS)
    assert (found.verdict, found.margin, found.unit, found.antecedent_met) == ("kept", 0.5, "notch", 1)
    # The last telegram is of tick 9: at tick 12 it is older than 20 ms, and at tick 14 the notch is there.
    assert (found.trigger_s, found.instant_s, found.slack, found.allowed_s) == (0.12, 0.14, 0.0, 0.02)


def test_a_reaction_that_comes_too_late_is_violated_by_the_best_of_its_window() -> None:
    found = judged(record_of(lost(10, 17), notches((0, 512), (14, 256), (16, -128))), LOSS)
    assert (found.verdict, found.margin, found.trigger_s, found.instant_s) == ("violated", -1.0, 0.12, 0.14)
    assert found.violated
    assert not found.kept


@pytest.mark.parametrize(("after", "verdict"), [(14, "open"), (15, "violated")])
def test_a_reaction_whose_window_reaches_beyond_the_end_is_open(after: int, verdict: str) -> None:
    found = judged(record_of(lost(10, after, after), notches((0, 512), ticks=after)), LOSS)
    assert found.verdict == verdict
    assert found.open_s == (0.12 if verdict == "open" else 0.13)


def test_an_antecedent_that_never_holds_says_nothing_but_how_near_it_was() -> None:
    found = judged(record_of(lost(10, 12), notches((0, 512))), LOSS)
    assert (found.verdict, found.margin, found.antecedent_met) == ("says nothing", None, 0)
    assert [(part.text, part.margin, part.unit) for part in found.parts] == [("age(TRN_SPEED) > 20 ms", 0.0, "ms")]


def test_until_ends_an_obligation() -> None:
    says = "whenever age(TRN_SPEED) > 20 ms, at once notch_command <= 0, until good(TRN_SPEED) >= {}"
    record = record_of(lost(10, 16), notches((0, 0), (20, 256)))
    assert judged(record, says.format(5)).verdict == "kept"
    assert judged(record, says.format(6)).verdict == "violated"


def test_a_level_that_is_none_is_not_judged() -> None:
    commands = [(0, RUNNING)] * 5 + [(0, CUT)] * 5 + [(0, ENDED)] * 5
    says = "whenever begin of controller_level >= traction_cut, at once controller_level >= traction_cut, until end"
    assert judged(record_of(lost(0, 0), commands), says).verdict == "kept"
    commands[9] = (0, RUNNING)
    found = judged(record_of(lost(0, 0), commands), says)
    assert (found.verdict, found.margin, found.unit) == ("violated", -2.0, "level")
    assert (found.trigger_s, found.instant_s) == (0.1, 0.18)


def test_a_condition_may_hold_for_as_long_as_a_sentence_allows() -> None:
    says = "never notch_command > 1 for longer than {} ms"
    record = record_of(lost(0, 0), notches((0, 0), (10, 512), (16, 0)))
    # It holds from 100 ms to 160 ms.
    kept, violated = judged(record, says.format(60)), judged(record, says.format(50))
    assert (kept.verdict, kept.slack, violated.verdict) == ("kept", 0.0, "violated")
    assert (violated.margin, violated.slack) == (-1.0, -0.01)


def test_a_reaction_may_have_to_last() -> None:
    says = "whenever begin of notch_command > 1, within 60 ms notch_command < 0 for {} ms"
    record = record_of(lost(0, 0), notches((0, 0), (4, 512), (8, -256), (14, 0)))
    assert judged(record, says.format(60)).verdict == "kept"
    assert judged(record, says.format(70)).verdict == "violated"


def test_something_has_to_come_in_time() -> None:
    record = record_of(lost(0, 0), notches((0, 0), (14, 512)))
    kept = judged(record, "eventually within 200 ms notch_command > 1")
    assert (kept.verdict, kept.margin, kept.instant_s, kept.slack) == ("kept", 1.0, 0.14, pytest.approx(0.06))
    assert judged(record, "eventually within 130 ms notch_command > 1").verdict == "violated"
    assert judged(record, "eventually within 400 ms notch_command > 2").verdict == "open"
    assert judged(record, "eventually notch_command > 2").verdict == "violated"


@pytest.mark.parametrize(
    "body",
    [
        "always measured_speed <= 3 m/s",
        "never measured_speed > 3 m/s for longer than 50 ms",
        "whenever measured_speed > 0 m/s, at once measured_speed < 3 m/s",
        "eventually measured_speed > 3 m/s",
    ],
)
def test_a_scope_that_ends_behind_the_record_is_not_seen_whole(body: str) -> None:
    speeds = [1000] * 10
    # The record has the ticks from 0 to 90 ms.
    assert judged(record_of(speeds), f"from 20 ms to 90 ms, {body}").verdict in ("kept", "violated")
    for scope in ("from 20 ms to 100 ms", "from 20 ms to emergency"):
        found = judged(record_of(speeds), f"{scope}, {body}")
        assert (found.verdict, found.open_s) == ("open", 0.02)
    assert judged(record_of(speeds), f"from 100 ms to 1 s, {body}").verdict == "says nothing"


def test_a_scope_ends_at_the_first_event_after_its_beginning() -> None:
    record = record_of([1000] * 5 + [4000] + [1000] * 4, events=[(0.02, Event.STOPPED), (0.08, Event.STOPPED)])
    found = judged(record, "from 40 ms to stopped, never measured_speed > 3 m/s")
    assert (found.verdict, found.instant_s) == ("violated", 0.05)
    assert judged(record, "from 60 ms to stopped, never measured_speed > 3 m/s").verdict == "kept"


@pytest.mark.parametrize(
    "says",
    [
        "eventually controller_level = emergency for 50 ms",
        "whenever measured_speed > 0 m/s, at once controller_level = emergency for 50 ms",
        "whenever measured_speed > 0 m/s, at once controller_level = emergency, until end",
    ],
)
def test_a_level_that_nobody_reports_shows_nothing(says: str) -> None:
    record = record_of([1000] * 30)
    assert not judged(record, says).kept


def test_only_the_scope_is_judged() -> None:
    record = record_of(
        lost(0, 0), notches((0, 0), (10, 512), (20, 0)),
        events=[(0.03, Event.DEPARTED), (0.0953, Event.STOPPED)],
    )  # fmt: skip
    assert judged(record, "never notch_command > 1").verdict == "violated"
    assert judged(record, "from start to 99 ms, never notch_command > 1").verdict == "kept"
    assert judged(record, "from 100 ms to 200 ms, always notch_command > 1").verdict == "violated"
    assert judged(record, "from 100 ms to 190 ms, always notch_command > 1").verdict == "kept"
    # An instant between two ticks counts from the next one on.
    assert judged(record, "between departed and stopped, never notch_command > 1").verdict == "violated"
    assert judged(record, "after stopped, always notch_command > 1").verdict == "violated"
    assert judged(record, "after emergency, always notch_command > 1").verdict == "says nothing"


def stopped(position_m: float) -> Record:
    """A train that stops at a place 0.0953 s after the start."""
    stop = ScoredStop(PlannedStop("stop", 250.0, 0.3, 0.1), Standstill(0.0953, position_m))
    score = Score("PASS", {}, {"stop_error_m": stop.error_m, "time_error_s": stop.late_s}, (), "", stops=(stop,))
    return record_of(lost(0, 0), events=[(0.0953, Event.STOPPED)], score=score)


@pytest.mark.parametrize(
    ("says", "verdict"),
    [
        ("abs(stop_error) <= 0.0531 m", "kept"),
        ("abs(stop_error) < 0.0531 m", "violated"),
        ("not abs(stop_error) > 0.0531 m", "kept"),
        ("abs(stop_error) <= 53.1 mm", "kept"),
        ("abs(stop_error) < 0.0532 m and stop_error < 0 m", "violated"),
    ],
)
@pytest.mark.parametrize("side", [-1, 1])
def test_a_place_at_its_limit_is_compared_in_units_of_the_wire(says: str, verdict: str, side: int) -> None:
    record = stopped(250.0 + side * 0.0531)
    if "stop_error < 0" in says and side < 0:
        verdict = "kept"
    found = judged(record, f"at stopped {says}")
    assert found.verdict == verdict
    if "0.0532" not in says:
        assert found.margin == 0.0


def test_scores_are_known_at_the_stop_and_at_the_end() -> None:
    record = stopped(250.1)
    assert judged(record, "at stopped time_error <= 0 s").margin == pytest.approx(0.0047)
    assert judged(record, "at end stop_error <= 0.3 m").margin == pytest.approx(0.2)
    assert judged(record, "at halt stop_error <= 0.3 m", halt="stopped").verdict == "kept"


def test_a_score_of_the_whole_run_is_known_at_its_last_stop_only() -> None:
    stops = tuple(
        ScoredStop(PlannedStop(name, 250.0, 0.3, 0.1), Standstill(instant_s, 250.0))
        for name, instant_s in (("first", 0.05), ("last", 0.2))
    )
    score = Score("PASS", {"energy_kj": 3.0}, {}, (), "", stops=stops)
    events = [(0.05, Event.STOPPED), (0.2, Event.STOPPED)]
    found = judged(record_of(lost(0, 0), events=events, score=score), "at stopped energy < 4 kJ")
    assert (found.verdict, found.margin, found.instant_s) == ("kept", 1.0, 0.2)


def test_telegrams_in_a_row_begin_anew_after_a_wrong_one_and_after_a_silence() -> None:
    speeds = lost(0, 0)
    speeds[8] = REFUSED
    speeds[20] = None
    record = record_of(speeds)
    assert judged(record, "from 80 ms to 120 ms, never good(TRN_SPEED) > 4").verdict == "kept"
    assert judged(record, "from 80 ms to 80 ms, always bad(TRN_SPEED) = 1 and good(TRN_SPEED) = 0").verdict == "kept"
    assert judged(record, "from 80 ms to 80 ms, always age(TRN_SPEED) = 10 ms").verdict == "kept"
    # One telegram that is lost is no end of a row, a longer silence is.
    assert judged(record, "from 210 ms to 210 ms, always good(TRN_SPEED) = 12").verdict == "kept"
    silent = record_of(lost(10, 13))
    assert judged(silent, "from 120 ms to 120 ms, always good(TRN_SPEED) = 0").verdict == "kept"
    assert judged(silent, "from 130 ms to 130 ms, always good(TRN_SPEED) = 1").verdict == "kept"


def test_a_telegram_that_comes_again_counts_for_nothing_and_ends_no_row() -> None:
    """As in the watches: it carries no new information."""
    speeds = lost(0, 0)
    speeds[8] = REPEATED
    record = record_of(speeds)
    row = "from {0} ms to {0} ms, always good(TRN_SPEED) = {1} and bad(TRN_SPEED) = {2}"
    for instant_ms, good, bad in ((70, 8, 0), (80, 8, 1), (90, 9, 0), (100, 10, 0)):
        assert judged(record, row.format(instant_ms, good, bad)).verdict == "kept", instant_ms


def test_a_telegram_that_its_receiver_refuses_has_no_value() -> None:
    speeds = lost(0, 0)
    # Its speed is 0.
    speeds[8] = REFUSED
    record = record_of(speeds)
    for says in ("always measured_speed >= 1 m/s", "always TRN_SPEED.TrainSpeed >= 1 m/s"):
        assert judged(record, says).margin == 0.0
    assert judged(record, "eventually bad(TRN_SPEED) = 1").verdict == "kept"
    # Its check variable has: it says why it is refused.
    assert judged(record, "always TRN_SPEED.SpeedChk = correct").verdict == "violated"
    first = record_of([REFUSED, 1000, 1000])
    assert judged(first, "always measured_speed >= 1 m/s").verdict == "kept"
    none = record_of([REFUSED] * 3)
    assert judged(none, "always measured_speed >= 1 m/s").verdict == "says nothing"


def test_a_margin_at_the_limit_is_0_in_any_unit_and_scale() -> None:
    record = record_of(lost(0, 0), [(256, RUNNING)] * 15)
    for says in (
        "measured_speed <= 1 m/s or notch_command < -1000 notch",
        "measured_speed <= 1 m/s or measured_speed < -400 km/h",
        "measured_speed <= 1 m/s and measured_speed < 400 km/h",
    ):
        assert judged(record, f"always {says}").margin == 0.0


def test_a_margin_of_several_units_has_each_in_its_own() -> None:
    commands = [(256, RUNNING)] * 5 + [(-128, CUT)] * 10
    found = judged(record_of(lost(0, 0), commands), "never controller_level >= traction_cut and notch_command > 0")
    assert (found.verdict, found.unit, found.instant_s) == ("kept", "scaled", 0.1)
    assert [(part.margin, part.unit) for part in found.parts] == [(0.0, "level"), (-0.5, "notch")]


def test_the_values_of_earlier_ticks_are_known_once_the_record_has_them() -> None:
    record = record_of([tick * 100 for tick in range(30)], events=[(0.1, Event.STOPPED)])
    # The speed rises by 0.1 m/s in each tick of 10 ms.
    for says in (
        "rate(measured_speed, 50 ms) = 10 m/s2", "before(measured_speed, 50 ms) = measured_speed - 0.5 m/s",
        "mean(measured_speed, 50 ms) = measured_speed - 0.2 m/s",
        "lowest(measured_speed, 50 ms) = measured_speed - 0.5 m/s", "highest(measured_speed, 50 ms) = measured_speed",
    ):  # fmt: skip
        found = judged(record, f"always {says}")
        assert (found.verdict, found.margin) == ("kept", 0.0)
    assert judged(record, "never since(stopped) < 1 s and measured_speed < 1 m/s").verdict == "kept"
    assert judged(record, "never since(stopped) > 200 ms").verdict == "kept"
    assert judged(record, "never since(stopped) >= 190 ms").margin == 0.0
    assert judged(record, "eventually within 1e9 s measured_speed > 9 m/s").verdict == "open"
    assert judged(record, "never measured_speed > 1 m/s for longer than 1e9 s").verdict == "open"


def test_names_stand_for_values_and_conditions() -> None:
    record = record_of(lost(10, 16), notches((0, 512), (14, -128)))
    found = judged(record, "whenever is_old, within window notch_command <= 0".replace("window", "20 ms"),
                   is_old="age(TRN_SPEED) > most", most="2 * 10 ms")  # fmt: skip
    assert (found.verdict, found.antecedent_met) == ("kept", 1)


def test_a_requirement_for_runs_without_faults_is_not_judged_on_a_faulty_one() -> None:
    requirement = Requirement("T-1", "always measured_speed < 2 m/s", when="none")
    healthy = record_of(lost(0, 0))
    faulty = record_of(
        lost(0, 0),
        certificate={"injected": [{"number": 1, "fault": "TRN_SPEED loss @1s", "begun_s": None, "ended_s": None,
                                   "effect_s": None, "hits": 0}]},
    )  # fmt: skip
    invalid = healthy.copy_with(invalid="the bus was lost", score=healthy.score, events=())
    verdicts = [judge_requirements(one, [requirement])[0].verdict for one in (healthy, faulty, invalid)]
    assert verdicts == ["kept", "not judged", "not judged"]
    assert judge_requirements(faulty, [replace(requirement, when="any")])[0].kept


def test_a_fault_by_hand_is_a_fault_of_the_run_when_an_order_has_injected_it() -> None:
    requirement = Requirement("T-1", "always measured_speed < 2 m/s", when="none")
    found = []
    for order in (FaultOrder.NONE, FaultOrder.CLEAR, FaultOrder.INJECT):
        record = record_of(lost(0, 0))
        record = record.copy_with(
            scenario=replace(record.scenario, faults=("safety_loop off @manual",)), score=record.score, events=()
        )
        told = SupCmd(command=SupCommand.START, fault_number=1, fault_order=order)
        record.trace.add(SupCmd.PORT, 0, told.encode())
        found.append(judge_requirements(record, [requirement])[0].verdict)
    assert found == ["kept", "kept", "not judged"]


SENTENCES = (
    Requirement("T-1", "whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0, until good(TRN_SPEED) >= 5"),
    Requirement("T-2", "at stopped abs(stop_error) <= 0.3 m and abs(time_error) <= 5 s"),
    Requirement("T-3", "never train_level >= traction_cut and traction > 0.01 kN for longer than 20 ms"),
    Requirement("T-4", "never abs(rate(mean(true_accel, 500 ms), 20 ms)) > 0.75 m/s3 for longer than 500 ms"),
    Requirement("T-5", "whenever fault, within 70 ms controller_level >= hold"),
    Requirement("T-6", "whenever true_speed > limit_at_train + 5 km/h, within 500 ms train_level = emergency"),
)


def made(folder: Path, fd: bool = False) -> Record:
    scenario = load_any(str(TEST_DATA / "pairs.toml"), (), ("TRN_SPEED loss @20s for 90ms",))
    folder.mkdir()
    write_inputs(folder, scenario, None)
    run = RunSpec(str(TEST_DATA / "pairs.toml"), law=LawSpec("ipfc_plus"))
    write_folder(local_run(scenario, folder, run, fd=fd))
    return checked_record(str(folder), None)


@pytest.mark.slow
def test_a_record_of_any_form_gives_the_same_outcomes(tmp_path: Path) -> None:
    classic, fd = made(tmp_path / "classic"), made(tmp_path / "fd", fd=True)
    found = judge_requirements(classic, SENTENCES)
    assert [one.verdict for one in found] == ["kept", "kept", "kept", "kept", "kept", "says nothing"]
    assert classic.log.read_bytes() != fd.log.read_bytes()
    assert judge_requirements(fd, SENTENCES) == found
    # A telegram of tick 1999 is the last one: the controller's watch cuts traction at the same tick.
    cut = next(event for event in classic.events if event.kind == LEVEL and event.level == "traction_cut")
    assert (found[0].trigger_s, cut.time_s) == (20.06, 20.06)
