"""The score of a run over a line: figures of each stop, the verdict and its reasons, and where they are shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.line_records import Told, driven_run, milestones_in, trace_of
from railhil.bus.codes import ControllerFlag, Event
from railhil.bus.telegrams import RunEvent
from railhil.cli.result_printer import print_scores
from railhil.common.output import Output
from railhil.judge.score import Score
from railhil.judge.stops import worst_stop
from railhil.record.notes import WRAP_FAILURE
from railhil.scenarios.load import load_any
from railhil.systems.line.judge.course import course_of
from railhil.systems.line.judge.invariants import limits_at
from railhil.systems.line.judge.judging import JUDGING
from railhil.systems.line.judge.milestones import milestones_of
from railhil.systems.line.judge.score import score
from railhil.systems.line.judge.stop import LineStop
from railhil.systems.line.scenario.model import LineScenario, RouteSignal
from railhil.wire.ato import CtlStat, SimTruth
from railhil.wire.line import AtpLim, AtpStat, DoorStat

LINE, TOLD = driven_run()


def judged(line: LineScenario = LINE, change: Callable[[Told], Told | None] = lambda told: told) -> Score:
    """The score of the recorded run, with changed telegrams."""
    return score(line, trace_of(line, filter(None, map(change, TOLD))))


def with_stop(place: int, **values: object) -> LineScenario:
    """The line with another stop in the timetable."""
    stops = list(LINE.stops)
    stops[place] = replace(stops[place], **values)  # type: ignore[arg-type]
    return replace(LINE, stops=tuple(stops))


def stop_of(found: Score, place: int) -> LineStop:
    stop = found.stops[place]
    assert isinstance(stop, LineStop)
    return stop


def test_a_run_in_order_passes_and_has_the_figures_of_each_stop() -> None:
    found = judged()
    assert (found.verdict, found.failures, found.ended) == ("PASS", (), "ended_complete")
    assert [stop.planned.name for stop in found.stops] == ["1 A", "2 B", "3 C", "4 D"]
    first, second, passed, last = (stop_of(found, place) for place in range(4))
    assert (first.error_m, first.departure_late_s, first.section) == (None, 0.0, None)
    assert (second.error_m, second.late_s) == (pytest.approx(0.2203), pytest.approx(0.2914, abs=1e-4))
    assert (second.dwell_nominal_s, second.departure_late_s, second.late_for) == (20.0, 0.0, "")
    assert second.opened_after_s == pytest.approx(2.83, abs=0.02), "doors 2.5 s, those of the platform 0.3 s later"
    assert second.dwell_drawn_s == pytest.approx(20.0, abs=0.1)
    assert second.dwell_s == pytest.approx(260 - 123.29, abs=0.01)
    assert passed.passed is not None
    assert passed.passed.speed_mps == pytest.approx(15.1, abs=0.1)
    assert (passed.standstill, passed.missed) == (None, "")
    assert last.section is not None
    assert (last.section.number, last.section.planned_s) == (2, LINE.sections[1].running_time_s)
    assert last.section.made_s == pytest.approx(last.standstill.instant_s - 260.0)  # type: ignore[union-attr]
    assert last.section.traction_kj > 50_000
    assert found.signed["stop_error_m"] == second.error_m, "the worst stop, with its sign"
    assert found.values["punctuality_percent"] == 100.0


def test_without_a_train_protection_nothing_is_said_of_how_near_it_was() -> None:
    section = stop_of(judged(replace(LINE, atp=replace(LINE.atp, enabled=False))), 1).section
    assert section is not None
    assert (section.nearest_m, section.level) == (None, "off")


def test_energy_that_comes_back_is_no_score_of_a_train_without_an_electric_brake() -> None:
    without = replace(LINE, train=replace(LINE.train, electric_brake=None))
    returned = next(criterion for criterion in JUDGING.criteria if criterion.key == "regenerated_kj")
    assert (returned.applies(LINE), returned.applies(without)) == (True, False)
    assert judged(without).values["regenerated_kj"] is None


def test_the_energy_share_is_the_work_of_the_sections_by_their_bounds() -> None:
    document = judged().as_json()
    stops, scores = document["stops"], document["scores"]
    assert isinstance(stops, list)
    assert isinstance(scores, dict)
    sections = [stop["section"] for stop in stops if stop["section"]]
    assert [one["number"] for one in sections] == [1, 2]
    for one in sections:
        assert one["energy_share_percent"] == pytest.approx(100.0 * one["traction_kj"] / one["bound_kj"])
        assert one["energy_share_percent"] > 100.0
    work_kj, bound_kj = (sum(one[key] for one in sections) for key in ("traction_kj", "bound_kj"))
    assert scores["energy_share_percent"] == pytest.approx(100.0 * work_kj / bound_kj)


def test_a_line_without_shipped_bounds_has_no_energy_share() -> None:
    heavier = replace(LINE, train=replace(LINE.train, mass_kg=1.01 * LINE.train.mass_kg))
    share = next(criterion for criterion in JUDGING.criteria if criterion.key == "energy_share_percent")
    assert (share.applies(LINE), share.applies(heavier)) == (True, False)
    assert judged(heavier).values["energy_share_percent"] is None
    section = stop_of(judged(heavier), 1).section
    assert section is not None
    assert (section.bound_kj, section.energy_share_percent) == (None, None)


def test_the_score_is_written_with_every_stop() -> None:
    stops = judged().as_json()["stops"]
    assert isinstance(stops, list)
    assert {frozenset(stop) for stop in stops} == {frozenset(stops[0])}, "each stop has the same keys"
    assert stops[3]["section"]["number"] == 2
    assert stops[1]["delay_s"]["controller"] == 0.0
    assert stops[2]["passed_s"] == pytest.approx(344.02, abs=0.01)


@pytest.mark.parametrize(
    ("line", "failures"),
    [
        (with_stop(1, stop_error_max_m=0.2), ["stop 2 B: +0.220 m (allowed +-0.2 m)"]),
        (with_stop(1, arrive_s=118.0), ["stop 2 B: arrival +5.291 s (allowed +-5 s)"]),
        (with_stop(1, arrive_s=129.0), ["stop 2 B: arrival -5.709 s (allowed +-5 s)"]),
        (with_stop(3, arrive_s=440.0), ["stop 4 D: arrival +8.277 s (allowed +-5 s)"]),
        (
            with_stop(1, stop_error_max_m=0.1, arrive_s=118.0),
            ["stop 2 B: +0.220 m (allowed +-0.1 m)", "stop 2 B: arrival +5.291 s (allowed +-5 s)"],
        ),
    ],
)
def test_each_limit_that_is_missed_is_one_line(line: LineScenario, failures: list[str]) -> None:
    found = judged(line)
    assert (found.verdict, list(found.failures)) == ("FAIL", failures)


def test_the_doors_open_only_on_the_side_of_the_platform_and_in_the_window() -> None:
    found = judged(with_stop(1, platform="right"))
    assert len(found.failures) == 1
    assert found.failures[0].startswith("invariant 8: left doors open, which is not the side of the platform at 123.")
    narrow = replace(LINE, route=replace(LINE.route, door_window_m=0.1))
    assert judged(narrow).failures[0].startswith("invariant 8: left doors open outside of the window")


def test_a_door_open_in_motion_is_named() -> None:
    def change(told: Told) -> Told:
        if told.port == DoorStat.PORT and 60e9 <= told.time_ns <= 62e9:
            return told._replace(data=replace(DoorStat.decode(told.data), left_state=2).encode())
        return told

    found = judged(change=change)
    assert any(text.startswith("invariant 8: left doors open in motion at 60.") for text in found.failures)


def test_traction_with_an_open_door_is_named() -> None:
    def change(told: Told) -> Told:
        if told.port == DoorStat.PORT and 10e9 <= told.time_ns <= 11e9:
            return told._replace(data=replace(DoorStat.decode(told.data), psd_locked=1, psd_present=1).encode())
        return told

    (said,) = judged(change=change).failures
    assert said.startswith("invariant 7: ")
    assert " kN of traction with an open door, at 10." in said


def _with_reaction(from_s: float, until_s: float, milestone: bool, status: int = 4) -> Callable[[Told], Told]:
    """The run with a brake of the train protection for some time; the jog at no stop becomes its milestone."""
    atp = LINE.installed_system.events["atp"]

    def change(told: Told) -> Told:
        inside = from_s * 1e9 <= told.time_ns <= until_s * 1e9
        if told.port == AtpLim.PORT and inside:
            return told._replace(data=replace(AtpLim.decode(told.data), status=status).encode())
        if told.port == AtpStat.PORT and inside and status == 4:
            return told._replace(data=replace(AtpStat.decode(told.data), service_brake=2, cause=2).encode())
        if told.port == RunEvent.PORT and milestone:
            found = RunEvent.decode(told.data)
            # The first motion of the run says nothing about a line.
            if found.event == 1:
                return told._replace(data=replace(found, event=atp).encode())
        return told

    return change


def test_an_intervention_of_the_train_protection_fails_the_run_and_a_warning_does_not() -> None:
    (start,) = milestones_in(TOLD, "departed", LINE)
    at_s = next(RunEvent.decode(told.data).instant_01ms / 1e4 for told in TOLD if _is_number(told, start))
    found = judged(change=_with_reaction(at_s, at_s + 1.0, milestone=True))
    assert found.verdict == "FAIL"
    assert found.failures[0].startswith(f"train protection intervened at {at_s:.0f}.")
    assert found.failures[0].endswith("(above the curve to a target), allowed never")
    assert (found.extras["atp_interventions"], found.extras["atp_warnings"]) == (1.0, 1.0)
    warned = judged(change=_with_reaction(at_s, at_s + 1.0, milestone=True, status=3))
    assert (warned.verdict, warned.extras["atp_warnings"], warned.extras["atp_interventions"]) == ("PASS", 1.0, 0.0)


def _is_number(told: Told, number: int) -> bool:
    return told.port == RunEvent.PORT and RunEvent.decode(told.data).number == number


def test_the_front_beyond_the_supervised_location_is_named() -> None:
    def change(told: Told) -> Told:
        if told.port == SimTruth.PORT:
            truth = SimTruth.decode(told.data)
            return told._replace(data=replace(truth, position_01mm=truth.position_01mm).encode())
        return told

    (said,) = judged(with_stop(3, svl_overlap_m=0.05, eoa_overlap_m=0.0), change).failures
    assert said == "invariant 9: the front was at 3420.09 m, supervised location 3420.05 m behind stop 4 D"


def test_the_worst_stop_is_one_that_misses_a_limit() -> None:
    def name(found: Score) -> str:
        stop = worst_stop(found.stops)
        assert stop is not None
        return stop.planned.name

    assert name(judged()) == "2 B"
    assert name(judged(with_stop(3, arrive_s=440.0))) == "4 D"


def test_a_terminal_shows_one_line_per_stop_and_then_the_totals(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    found = judged(with_stop(1, stop_error_max_m=0.2))
    print_scores(Output(), LINE, [("ipfc_plus iq (measured)", found)])
    lines = capsys.readouterr().out.splitlines()
    rows = [next(at for at, line in enumerate(lines) if line.startswith(name)) for name in ("1 A", "2 B", "3 C", "4 D")]
    assert rows == sorted(rows)
    assert "+0.2203" in lines[rows[1]]
    assert lines[rows[1]].rstrip().endswith("FAIL")
    assert "passed" in lines[rows[2]]
    totals = next(at for at, line in enumerate(lines) if line.startswith("ipfc_plus iq"))
    assert totals > rows[3]
    assert "100.0" in lines[totals]
    assert max(map(len, lines)) <= 100


def test_a_comparison_shows_the_worst_stop_of_each_run(capsys: pytest.CaptureFixture[str]) -> None:
    print_scores(Output(), LINE, [("ipfc", judged()), ("pid", judged())], every_stop=False)
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2:] == ["ipfc: worst stop 2 B +0.2203 m PASS", "pid: worst stop 2 B +0.2203 m PASS"]
    assert not any(line.startswith("4 D") for line in lines)
    counted = JUDGING.counted([judged()])
    assert [stop["name"] for stop in counted["worst_stops"]] == ["2 B"]


def test_every_line_says_what_it_is_not() -> None:
    said = " ".join(load_any("four_stops").assumptions)
    for words in ("SUBSET-026-3, 3.13", "no conformity", "not the real timetable", "no other trains"):
        assert words in said


def test_the_judging_of_a_line_is_told_in_words(tmp_path: Path) -> None:
    assert JUDGING.asked(LINE) == (
        "3420 m in 600 s, 3 stops, 1 passed; allowed ±0.3 m and ±5 s at each, 10 s of own delay"
    )
    names = [name for name, failure in JUDGING.checks(LINE, judged()) if not failure]
    assert names == [name for name, _ in JUDGING.checks(LINE, judged())]
    missed = dict(JUDGING.checks(LINE, judged(with_stop(1, platform="right"))))
    assert missed["doors_only_in_the_window"].startswith("invariant 8")


def test_after_a_turn_back_the_limits_of_the_next_leg_hold() -> None:
    """The leg begins with the departure from the turn-back, so the limit of one place depends on the time."""
    slow = replace(LINE.legs[0], speed_limit_mps=((-118.0, 10.0),))
    line = replace(with_stop(1, turn_back=True), legs=(LINE.legs[0], slow))
    milestones, _ = milestones_of(line, trace_of(line, TOLD))
    course = course_of(line, milestones)
    times_s, places_m = np.array([100.0, 259.9, 260.0, 300.0]), np.full(4, 1200.0)
    assert limits_at(line, course, times_s, places_m).tolist() == [80 / 3.6, 80 / 3.6, 10.0, 10.0]
    found = judged(line)
    assert found.verdict == "FAIL"
    assert found.failures[0].startswith("overspeed ")
    assert found.extras["overspeed_mps"] == pytest.approx(15.3 - 10.0, abs=0.2)


def _with_event(kind: str, event: int, place: int = 0, later_s: float = 0.0) -> Callable[[Told], Told]:
    """The run with another milestone in the place of one."""
    number = milestones_in(TOLD, kind, LINE)[place]

    def change(told: Told) -> Told:
        if not _is_number(told, number):
            return told
        found = RunEvent.decode(told.data)
        instant_01ms = found.instant_01ms + round(later_s * 1e4)
        return told._replace(data=replace(found, event=event, instant_01ms=instant_01ms).encode())

    return change


def test_an_emergency_brake_fails_the_run() -> None:
    found = judged(change=_with_event("departed", Event.EMERGENCY))
    assert (found.verdict, len(found.failures)) == ("FAIL", 1)
    assert found.failures[0].startswith("emergency brake at 5.")


def test_a_stop_whose_doors_stayed_shut_is_not_served() -> None:
    opened, locked = _with_event("doors_open", 1), _with_event("doors_locked", 1)

    def change(told: Told) -> Told:
        if told.port == DoorStat.PORT and told.time_ns < 300e9:
            return told._replace(data=replace(DoorStat.decode(told.data), left_state=0, psd_state=0).encode())
        return opened(locked(told))

    found = judged(change=change)
    assert (found.verdict, found.failures) == ("FAIL", ("stop 2 B: doors did not open",))


def test_a_train_that_rolls_away_from_a_stop_is_named() -> None:
    def change(told: Told) -> Told:
        time_s = told.time_ns / 1e9
        if told.port != SimTruth.PORT or time_s > 4.0:
            return told
        found = SimTruth.decode(told.data)
        rolled_m = time_s / 2 - np.sin(np.pi * time_s / 2) / np.pi
        speed_mps = 0.5 - 0.5 * np.cos(np.pi * time_s / 2)
        moved = replace(found, position_01mm=round((rolled_m - 2.0) * 1e4), speed_01mmps=round(speed_mps * 1e4))
        return told._replace(data=moved.encode())

    assert any(text.startswith("invariant 11: the train moved 2.0") for text in judged(change=change).failures)


def test_an_emergency_brake_that_the_protection_takes_back_is_named() -> None:
    def change(told: Told) -> Told:
        if told.port == AtpStat.PORT and 60e9 <= told.time_ns <= 62e9:
            return told._replace(data=replace(AtpStat.decode(told.data), emergency_brake=2, cause=2).encode())
        return _with_reaction(60.0, 62.0, milestone=False)(told)

    milestone = _with_event("departed", LINE.installed_system.events["atp"], later_s=55.0)
    found = judged(change=lambda told: milestone(change(told)))
    assert any(text.startswith("invariant 10: ") for text in found.failures), found.failures


def test_a_train_beyond_a_red_signal_is_named() -> None:
    found = judged(replace(LINE, signals=(RouteSignal(600.0, 200.0),)))
    assert found.failures[0].startswith("invariant 9: the front was at 1200.")
    assert found.failures[0].endswith("supervised location 620.00 m behind a red signal")
    assert judged(replace(LINE, signals=(RouteSignal(600.0, 10.0),))).verdict == "PASS"


def test_a_passing_where_the_train_was_not_is_a_contradiction() -> None:
    found = judged(change=_with_event("passed", LINE.installed_system.events["passed"], later_s=2.0))
    assert found.verdict == "INVALID"
    assert "passed at stop 3 C at" in found.failures[0]


def test_a_departure_that_the_controller_holds_back_fails_the_run() -> None:
    (said,) = judged(with_stop(1, depart_s=(LINE.stops[1].depart_s or 0.0) - 20.0)).failures
    assert said.startswith("stop 2 B: departure +20."), said


def test_a_wrap_of_the_controller_fails_the_run() -> None:
    status = CtlStat(overflow_flags=ControllerFlag.WRAP)
    found = score(LINE, trace_of(LINE, [*TOLD, Told(TOLD[-1].time_ns, CtlStat.PORT, status.encode())]))
    assert (found.verdict, len(found.failures)) == ("FAIL", 1)
    assert found.failures[0].startswith(WRAP_FAILURE)
