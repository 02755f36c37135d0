"""The score of hand-made records: what makes one incomplete, what fails a run, and every boundary of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from railhil.bus.codes import Event
from railhil.bus.ident import PltIdent, Role, make_ident
from railhil.bus.telegrams import RunEvent
from railhil.dbc import Contract, wire_contract
from railhil.faults.truth import HOLE_MAX_S
from railhil.judge.record_checks import milestone_missing
from railhil.record.trace import Trace
from railhil.scenarios.load import load
from railhil.systems.ato.judge.criteria import CRITERIA, STOP_ERROR
from railhil.systems.ato.judge.invariants import broken
from railhil.systems.ato.judge.score import score, standstill_unclear
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.wire.ato import CtlStat, SimTruth, TrnWatch

LVSHUN = load("lvshun_tieshan")
#: 0.5 m/s2 for 2 s and back to rest, at 2 m after 4 s; 10 m/s allowed.
HOP = replace(
    LVSHUN,
    target=TargetCurve(((0.0, 0.5), (1.9, 0.5), (2.1, -0.5), (4.0, -0.5))),
    plan=replace(LVSHUN.plan, distance_m=2.0, running_time_s=4.0),
    line=replace(LVSHUN.line, speed_limit_mps=((0.0, 10.0),)),
)
STOPPED, COMPLETE, OVERTIME = Event.STOPPED, Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED
#: The end of a run that stops at 2 m after 4 s: (event, instant in 0.1 ms, position in 0.1 mm).
ARRIVED = ((STOPPED, 40_000, 20_000), (COMPLETE, 45_000, 20_000))


def position_01mm(ms: int) -> int:
    """2 m in 4 s at an even speed: which speed the truth shows beside it is up to the test."""
    return min(5 * ms, 20_000)


def record(
    events: Sequence[tuple[int, int, int]] = ARRIVED,
    *,
    moments_ms: Sequence[int] = range(0, 4520, 20),
    speed_01mmps: Any = lambda ms: 5000 if ms < 4000 else 0,
    truth: Any = lambda ms: {},
    numbers: Sequence[int] | None = None,
    again: Any = lambda ms: None,
) -> Trace:
    """A record with a SIM_TRUTH at each moment, and perhaps another one at the same instant."""
    trace = Trace(wire_contract())
    for ms in moments_ms:
        values = {"position_01mm": position_01mm(ms), "speed_01mmps": speed_01mmps(ms), **truth(ms)}
        trace.add(SimTruth.PORT, ms * 1_000_000, SimTruth(**values).encode())
        if (other := again(ms)) is not None:
            trace.add(SimTruth.PORT, ms * 1_000_000, other.encode())
    for place, (event, instant_01ms, where_01mm) in enumerate(events):
        number = place + 1 if numbers is None else numbers[place]
        trace.add(RunEvent.PORT, instant_01ms * 100_000, RunEvent(event, number, instant_01ms, where_01mm).encode())
    return trace


def test_a_run_that_arrives() -> None:
    found = score(HOP, record())
    assert (found.verdict, found.failures, found.ended) == ("PASS", (), "ended_complete")
    assert found.signed == {"time_error_s": 0.0, "stop_error_m": 0.0}
    assert found.extras == {"overspeed_mps": 0.0}
    # 0.04 MJ/s of the auxiliaries for 4 s, no force; no acceleration.
    assert (found.values["energy_kj"], found.values["comfort"]) == (160.0, 0.0)
    assert [stop.verdict for stop in found.stops] == ["PASS"]
    assert found.listed_stops == ()
    assert replace(found, stops=found.stops * 2).listed_stops == found.stops * 2
    assert found.as_json() == {
        "verdict": "PASS",
        "scores": found.values,
        "signed": found.signed,
        "overspeed_mps": 0.0,
        "failures": [],
        "ended": "ended_complete",
        "stops": [found.stops[0].as_json()],
    }


def test_each_signal_of_the_truth_is_used_for_what_it_is() -> None:
    def truth(ms: int) -> dict[str, int]:
        braking = ms >= 2000
        return {"accel_01mmps2": -3000 if braking else 5000, "traction_20n": 0 if braking else 100, "brake_20n": 50}

    found = score(replace(HOP, energy=replace(HOP.energy, xi_m=0.5, xi_b=0.25)), record(truth=truth))
    # 0.5 m/s: 2 kN until 1.98 s, half of it in the step after; the brake's 1 kN until the step before 4 s.
    traction_j, brake_j = 2000 * 0.5 * 1.99, 1000 * 0.5 * 3.99
    assert found.values["energy_kj"] == pytest.approx((traction_j / 0.5 + 40_000 * 4 + brake_j * 0.25) / 1000)
    assert found.values["comfort"] == pytest.approx((0.8 + 0.3) / 0.002)


@pytest.mark.parametrize(
    ("instant_01ms", "where_01mm", "failures"),
    [
        (40_000, 17_000, ()),
        (40_000, 16_999, ("stop error -0.3001 m, allowed +-0.3 m",)),
        (37_000, 20_000, ()),
        (43_001, 20_000, ("time error +0.3001 s, allowed +-0.3 s",)),
        (44_000, 24_000, ("stop error +0.400 m, allowed +-0.3 m", "time error +0.400 s, allowed +-0.3 s")),
    ],
)
def test_limits_of_the_plan(instant_01ms: int, where_01mm: int, failures: tuple[str, ...]) -> None:
    found = score(
        HOP,
        record(
            ((STOPPED, instant_01ms, where_01mm), (COMPLETE, 60_000, where_01mm)),
            moments_ms=range(0, 6000, 20),
            speed_01mmps=lambda ms: 5000 if 10 * ms < instant_01ms else 0,
            truth=lambda ms: {"position_01mm": where_01mm if 10 * ms >= instant_01ms - 2000 else position_01mm(ms)},
        ),
    )
    assert (found.verdict, found.failures) == ("FAIL" if failures else "PASS", failures)
    assert found.signed["stop_error_m"] == pytest.approx(where_01mm / 1e4 - 2.0)
    assert found.values["stop_error_m"] == pytest.approx(abs(where_01mm / 1e4 - 2.0))
    assert found.with_sign(STOP_ERROR) == found.signed["stop_error_m"]
    assert found.with_sign(CRITERIA[1]) == found.values["energy_kj"]


@pytest.mark.parametrize(
    ("front_m", "speed_mps", "over_mps", "said"),
    [(2.0, 10.0, 0.0, ""), (2.0, 10.0001, 0.0001, "0.0004"), (1e3, 11.0, 1.0, "3.60")],
)
def test_overspeed(front_m: float, speed_mps: float, over_mps: float, said: str) -> None:
    def speed_01mmps(ms: int) -> int:
        return round(speed_mps * 1e4) if ms == 1000 else 5000 if ms < 4000 else 0

    found = score(HOP, record(speed_01mmps=speed_01mmps))
    assert found.extras["overspeed_mps"] == pytest.approx(over_mps, abs=1e-9)
    assert found.failures == ((f"overspeed {said} km/h, allowed 0",) if over_mps else ())


@pytest.mark.parametrize(("front_m", "verdict"), [(81.9, "FAIL"), (82.1, "PASS")])
def test_a_higher_limit_counts_when_the_rear_has_passed(front_m: float, verdict: str) -> None:
    """8 m/s until 2 m; the train of 80 m runs 10 m/s."""
    line = replace(HOP.line, speed_limit_mps=((0.0, 8.0), (2.0, 10.0)))

    def truth(ms: int) -> dict[str, int]:
        return {"position_01mm": round(front_m * 1e4), "speed_01mmps": 100_000 if ms < 2000 else 0}

    events = ((STOPPED, 20_000, round(front_m * 1e4)), (COMPLETE, 45_000, 0))
    plan = replace(HOP.plan, distance_m=front_m, time_error_max_s=9.0)
    assert score(replace(HOP, line=line, plan=plan), record(events, truth=truth)).verdict == verdict


def test_emergency_brake_at_its_first_instant() -> None:
    events = ((Event.EMERGENCY, 12_345, 6000), (Event.EMERGENCY, 20_000, 6000), *ARRIVED)
    assert score(HOP, record(events)).failures == ("emergency brake at 1.23 s",)


def test_a_wrap_of_the_controller_fails_the_run() -> None:
    trace = record()
    for ms, flags in ((320, 2), (480, 3), (640, 1)):
        trace.add(CtlStat.PORT, ms * 1_000_000, CtlStat(overflow_flags=flags).encode())
    assert score(HOP, trace).failures == ("fixed-point wrap in the controller, reported at 0.48 s",)


def test_a_run_that_does_not_stop() -> None:
    moving = record([(OVERTIME, 140_000, 0)], speed_01mmps=lambda ms: 5000)
    found = score(HOP, moving)
    assert found.failures == ("not stopped 10 s after the timetable",)
    assert (found.verdict, found.ended) == ("FAIL", "ended_not_stopped")
    assert found.values["stop_error_m"] is found.values["punctuality_s"] is None
    assert found.values["energy_kj"] == pytest.approx(40 * 4.5)


def test_set_points_by_distance_are_taken_from_the_identity() -> None:
    def itae(*idents: Any) -> float:
        trace = record()
        for ident in idents:
            trace.add(ident.PORT, 0, ident.encode())
        return score(HOP, trace).values["itae"] or 0.0

    def ident(indexing: str) -> Any:
        return make_ident(Role.CONTROLLER, HOP.sha256, indexing=indexing, contract=wire_contract())

    by_time = itae()
    assert itae(ident("time")) == by_time
    assert itae(ident("distance")) != by_time
    # The number of an indexing that this version does not know.
    assert itae(replace(ident("time"), indexing=3)) == by_time


# -- records that do not show a complete run --------------------------------------------------------------------------


def invalid(trace: Trace) -> str:
    found = score(HOP, trace)
    assert (found.verdict, set(found.values.values()), found.stops) == ("INVALID", {None}, ())
    assert found.extras == {"overspeed_mps": 0.0}
    (reason,) = found.failures
    return f"{found.ended}: {reason}"


def test_a_record_without_an_end_or_a_truth() -> None:
    assert invalid(record([(STOPPED, 40_000, 20_000)])) == "record_incomplete: run record_incomplete"
    assert invalid(record([])) == "record_incomplete: run record_incomplete"
    for moments in ((), (0,)):
        assert invalid(record(moments_ms=moments)) == "ended_complete: run ended_complete"
    assert score(HOP, record([(COMPLETE, 200, 0)], moments_ms=(0, 20))).verdict == "FAIL"


@pytest.mark.parametrize("event", [event for event in Event if event > OVERTIME])
def test_a_run_that_ended_otherwise(event: Event) -> None:
    assert invalid(record([*ARRIVED, (event, 45_100, 0)])) == f"{event.name.lower()}: run {event.name.lower()}"


@pytest.mark.parametrize(
    ("fault", "silences"),
    [
        ("node.controller kill @1s", True),
        ("node.plant kill @1s", False),
        ("bus off @1s for 1s", True),
        ("NOTCH_CMD loss @1s", True),
        ("TRN_SPEED loss @1s", False),
        ("command.notch value 3 @1s", False),
        ("sensor.speed off @1s", False),
    ],
)
def test_a_controller_that_a_fault_has_silenced(fault: str, silences: bool) -> None:
    """The run is complete, and fails."""
    trace = record([(STOPPED, 40_000, 20_000), (Event.ENDED_CONTROLLER_LOST, 45_000, 20_000)])
    found = score(replace(HOP, faults=("TRN_POS loss @1s", fault)), trace)
    assert found.ended == "ended_controller_lost"
    if silences:
        assert (found.verdict, found.failures) == ("FAIL", ("controller lost",))
    else:
        assert (found.verdict, found.failures) == ("INVALID", ("run ended_controller_lost",))


def test_a_rule_of_every_run_that_is_broken_fails_the_run() -> None:
    trace = record(truth=lambda ms: {"traction_20n": 100})
    trace.add(TrnWatch.PORT, 0, TrnWatch(2).encode())
    rules = broken(HOP, trace)
    assert len(rules) == 1
    found = score(HOP, trace)
    assert (found.verdict, found.failures) == ("FAIL", tuple(rules))


def test_a_rule_that_the_record_cannot_decide_is_invalid() -> None:
    trace = record()
    trace.add(PltIdent.PORT, 0, make_ident(Role.PLANT, HOP.sha256, contract=wire_contract()).encode())
    unclear = "ended_complete: record: no TRN_WATCH, so the level of the train's watch is not known"
    assert invalid(trace) == unclear


def test_codes_that_no_event_has_are_left_out() -> None:
    assert score(HOP, record([*ARRIVED, (200, 45_100, 0), (11, 45_200, 0)])) == score(HOP, record())


def test_a_hole_in_the_truth() -> None:
    assert HOLE_MAX_S == 1.0
    kept = [ms for ms in range(0, 4520, 20) if not 1000 < ms < 2000]
    assert score(HOP, record(moments_ms=kept)).verdict == "PASS"
    kept.remove(2000)
    assert invalid(record(moments_ms=kept)) == (
        "ended_complete: record: no SIM_TRUTH for 1.02 s from 1.00 s on, allowed 1 s"
    )


def test_a_telegram_recorded_twice_counts_once() -> None:
    other = SimTruth(20_000, 200_000, traction_20n=3000)
    assert score(HOP, record(again=lambda ms: other if ms in (0, 500, 2020) else None)) == score(HOP, record())


# -- milestones against each other and against the truth --------------------------------------------------------------


def unnumbered() -> Contract:
    """The wire contract without the numbers of RUN_EVENT, as that of version 0.1.0."""
    contract = wire_contract()
    port = contract.port(RunEvent.PORT)
    plain = replace(port, signals=tuple(item for item in port.signals if item.name != "EventNumber"))
    return replace(contract, ports=tuple(plain if item.name == port.name else item for item in contract.ports))


def test_missing_milestones_are_named() -> None:
    assert score(HOP, record(numbers=[2, 1])).verdict == "PASS"
    assert milestone_missing(Trace(wire_contract())) == milestone_missing(Trace(unnumbered())) == ""
    assert invalid(record(numbers=[1, 3])) == "ended_complete: record: RUN_EVENT 2 of 3 is missing"
    assert invalid(record(numbers=[2, 8])) == "ended_complete: record: RUN_EVENT 1, 3, 4, 5, 6, ... of 8 is missing"
    assert invalid(record(numbers=[2, 7])) == "ended_complete: record: RUN_EVENT 1, 3, 4, 5, 6 of 7 is missing"


@pytest.mark.parametrize(
    ("speed_mps", "ms", "clear"),
    # The first SIM_TRUTH 0.1 s and more after the stop, which may show 10 m/s2 since then.
    [(1.0, 4100, True), (1.0001, 4100, False), (1.01, 4100, False), (5.0, 4080, True), (9.0, 4120, True)],
)
def test_the_speed_after_a_stop(speed_mps: float, ms: int, clear: bool) -> None:
    trace = record(speed_01mmps=lambda at: round(speed_mps * 1e4) if at == ms else 0, moments_ms=range(0, 4520, 20))
    found = score(replace(HOP, line=replace(HOP.line, speed_limit_mps=((0.0, 50.0),))), trace)
    assert found.verdict == ("PASS" if clear else "INVALID")
    if not clear:
        assert found.failures == (f"record: STOPPED at 4.00 s, but SIM_TRUTH shows {speed_mps:.2f} m/s at 4.10 s",)


@pytest.mark.parametrize(("speed_mps", "clear"), [(4.99, True), (5.01, False)])
def test_the_speed_after_a_stop_with_telegrams_missing(speed_mps: float, clear: bool) -> None:
    """Half a second later: up to 5 m/s."""
    kept = [ms for ms in range(0, 4520, 20) if not 3980 < ms < 4500]
    found = standstill_unclear(
        record(moments_ms=kept),
        np.array(kept) / 1000,
        np.array([position_01mm(ms) / 1e4 for ms in kept]),
        np.array([speed_mps if ms == 4500 else 0.5 for ms in kept]),
    )
    assert (found == "") == clear


@pytest.mark.parametrize(
    ("where_01mm", "clear"),
    # At 3.9 s and before, the truth shows 19.4 m: 20 ms before that at the earliest; 2 LSB on either side.
    [(19_397, False), (19_398, True), (20_000, True), (20_002, True), (20_003, False)],
)
def test_the_place_of_a_stop(where_01mm: int, clear: bool) -> None:
    reason = standstill_unclear(
        record([(STOPPED, 40_000, where_01mm)]),
        np.arange(0, 4520, 20) / 1000,
        np.array([position_01mm(ms) / 1e4 for ms in range(0, 4520, 20)]),
        np.zeros(226),
    )
    said = f"record: STOPPED at {where_01mm / 1e4:.2f} m, but SIM_TRUTH shows the train at 2.00 m at 4.10 s"
    assert reason == ("" if clear else said)


def test_a_stop_at_either_end_of_the_record() -> None:
    time_s = np.arange(0, 4060, 20) / 1000
    position_m, speed_mps = np.array([0.0002, *np.linspace(0.5, 2.0, 202)]), np.zeros(203)

    def reason(instant_01ms: int, where_01mm: int) -> str:
        return standstill_unclear(record([(STOPPED, instant_01ms, where_01mm)]), time_s, position_m, speed_mps)

    assert reason(40_000, 20_000) == reason(500, 0) == ""
    assert reason(40_000, 20_100) == "record: STOPPED at 2.01 m, but SIM_TRUTH shows the train at 2.00 m at 4.04 s"
    assert reason(500, -1) != ""


def stands(from_ms: int, to_ms: int, instant_01ms: int | None, at_01mm: int = 20_000) -> str:
    """A train at rest from one SIM_TRUTH to another, and STOPPED at an instant."""
    moments = range(0, 6000, 20)
    events = [] if instant_01ms is None else [(STOPPED, instant_01ms, at_01mm)]
    # The other stops of the record are of no interest: everywhere at this place.
    return standstill_unclear(
        record(events),
        np.array(moments) / 1000,
        np.array([0.0] + [at_01mm / 1e4] * (len(moments) - 1)),
        np.array([0.0 if from_ms <= ms <= to_ms else 0.5 for ms in moments]),
    )


def test_a_standstill_without_stopped() -> None:
    said = "record: no STOPPED, but SIM_TRUTH shows that the train stands from 2.00 s on"
    assert stands(2000, 2480, None) == ""
    assert stands(2000, 2500, None) == said
    # Up to 0.1 s after its last SIM_TRUTH, as the log's stamps allow.
    assert stands(2000, 2500, 26_000) == ""
    assert stands(2000, 2500, 26_010) == said
    assert stands(2000, 2500, 19_000) == ""


def test_a_standstill_near_the_start_is_no_stop() -> None:
    assert stands(2000, 3000, None, at_01mm=10_000) == ""
    assert stands(2000, 3000, None, at_01mm=10_001) != ""


def test_a_train_at_rest_until_the_end_of_the_record() -> None:
    assert stands(5480, 6000, None) == "record: no STOPPED, but SIM_TRUTH shows that the train stands from 5.48 s on"
    assert stands(5500, 6000, None) == ""


def test_the_first_standstill_that_is_long_enough() -> None:
    moments = range(0, 6000, 20)
    speeds = np.array([0.0 if 1000 <= ms < 1200 or 3000 <= ms < 4000 or ms >= 5000 else 0.5 for ms in moments])
    found = standstill_unclear(
        record([(STOPPED, 45_000, 50_000)]), np.array(moments) / 1000, np.array([0.0] + [5.0] * 299), speeds
    )
    assert found.endswith("stands from 3.00 s on")
