"""The whole loop with an implausible position or implausible balises: the train stops before its stopping point or at
it.

With laws that use the position (IPFC+, and every law by distance) the node uses dead reckoning for a second and then
brakes; the others run on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.paths import ROOT
from railhil.bench import Result, direct_run, local_run
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.layout import CHECK_CORRECT, Telegram
from railhil.bus.mvb import TelegramSource
from railhil.common.errors import InputError
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Balise, Scenario
from railhil.wire.ato import BalisePassed, CtlCause, CtlMode, CtlStat, NotchCmd, SimTruth, TrnPos, TrnSpeed

WORN = load("lvshun_tieshan_worn_wheels")
#: 94 s; coasts from 36 s, brakes from 70 s on.
SHORT = load("yizhuang_05")
#: Worn wheels, and every perturbation drawn.
SEED = 1003
SPEED_ID = TrnSpeed.port().address
#: Telegram and time in s -> telegrams that arrive in its place.
Fault = Callable[[Any, float], list[Any]]


class Wire:
    """Does something to the telegrams of one port of one block; counts time by the ticks of TRN_SPEED."""

    def __init__(self, kind: type[Telegram], fault: Fault) -> None:
        self._kind, self._fault = kind, fault
        self._block_id, self._trailer_id = kind.port().can_ids
        self._source = TelegramSource(kind.port())
        self._block = b""
        self._ticks = 0

    def __call__(self, frame: Frame) -> list[Frame]:
        self._ticks += frame.can_id == SPEED_ID and not frame.flags
        if frame.can_id == self._block_id:
            self._block = frame.data
            return []
        if frame.can_id != self._trailer_id:
            return [frame]
        telegrams = self._fault(self._kind.decode(self._block), (self._ticks - 1) / 100)
        return [out for telegram in telegrams for out in self._source.frames(telegram.encode())]


def silent(begin_s: float, end_s: float = 1e9) -> Fault:
    return lambda telegram, now_s: [] if begin_s <= now_s < end_s else [telegram]


def changed(begin_s: float, end_s: float = 1e9, *, check: int = CHECK_CORRECT, off_mm: int | None = None) -> Fault:
    """From a time on: another check variable, and the odometer off by so much, or 0 for None."""

    def fault(telegram: TrnPos, now_s: float) -> list[TrnPos]:
        if not begin_s <= now_s < end_s:
            return [telegram]
        return [replace(telegram, check=check, odometer_mm=0 if off_mm is None else telegram.odometer_mm + off_mm)]

    return fault


def late(by_s: float) -> Fault:
    """Every new balise comes so late; until then the port is silent."""
    seen_s: dict[int, float] = {}

    def fault(telegram: BalisePassed, now_s: float) -> list[BalisePassed]:
        return [telegram] if now_s - seen_s.setdefault(telegram.balise_id, now_s) >= by_s else []

    return fault


def run_with(folder: Path, kind: type[Telegram], fault: Fault, scenario: Scenario = SHORT, **options: Any) -> Result:
    folder.mkdir(exist_ok=True)
    seed, drawn = options.pop("seed", SEED), options.pop("drawn", True)
    law = LawSpec(**{"controller": "ipfc_plus", **options})
    return local_run(scenario, folder, RunSpec(law=law, seed=seed, perturbed=drawn), wire=Wire(kind, fault))


def assert_braked(run: Result, begin_s: float) -> None:
    """Service brake 1 s after the last good position, to the end, as CTL_STAT says too; short of the stopping point."""
    times_s, modes = run.trace.times_s(NotchCmd.PORT), run.trace.raw(NotchCmd.PORT, "CtlMode")
    entered_s = times_s[modes == CtlMode.SERVICE_BRAKE][0]
    assert 0.98 <= entered_s - begin_s <= 1.04
    assert set(modes[times_s < entered_s]) == {CtlMode.RUNNING}
    assert set(modes[times_s >= entered_s]) == {CtlMode.SERVICE_BRAKE}
    stat_s, levels = run.trace.times_s(CtlStat.PORT), run.trace.raw(CtlStat.PORT, "LadderLevel")
    assert set(levels[stat_s >= entered_s + 0.02]) == {3}
    # No traction any more from there on, beyond what the ramp of the brake takes back.
    truth_s = run.trace.times_s(SimTruth.PORT)
    assert (run.trace.raw(SimTruth.PORT, "TractionForce")[truth_s > entered_s + 4.0] == 0).all()
    assert run.ended is Event.ENDED_COMPLETE
    assert run.score.signed["stop_error_m"] is not None
    assert run.score.signed["stop_error_m"] < 0.0
    assert run.score.extras["overspeed_mps"] == 0.0
    assert not any("emergency" in failure for failure in run.score.failures)


# -- position ---------------------------------------------------------------------------------------------------------


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("begin_s", "scenario"), [(60, WORN), pytest.param(75, SHORT, marks=pytest.mark.long), (88, SHORT)]
)
def test_silent_position_is_reckoned_for_a_second_and_then_braked(
    tmp_path: Path, begin_s: float, scenario: Scenario
) -> None:
    run = run_with(tmp_path, TrnPos, silent(begin_s), scenario)
    assert_braked(run, begin_s)
    assert run.refused == {}


@pytest.mark.slow
@pytest.mark.faults
def test_a_position_that_is_wrong_is_as_good_as_none(tmp_path: Path) -> None:
    run = run_with(tmp_path, TrnPos, changed(80, off_mm=-20_000))
    assert_braked(run, 80)
    assert set(run.refused) == {"controller.position_jump"}


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ipfc_plus", "ipfc_plus_stop"])
def test_lost_half_a_second_before_the_stop(tmp_path: Path, law: str) -> None:
    """Reckoned to the stop."""
    run = run_with(tmp_path, TrnPos, silent(93.5), controller=law)
    assert run.score.values["stop_error_m"] is not None
    assert run.score.values["stop_error_m"] < 0.1


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize("fault", [silent(60, 60.6), changed(60, 60.8, off_mm=-20_000)], ids=["silent", "jump"])
def test_less_than_a_second_is_bridged(tmp_path: Path, fault: Fault) -> None:
    run = run_with(tmp_path, TrnPos, fault)
    assert set(run.trace.raw(NotchCmd.PORT, "CtlMode")) == {CtlMode.RUNNING}
    assert run.score.failures == ()
    assert run.score.values["stop_error_m"] is not None
    assert run.score.values["stop_error_m"] < 0.05


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_position_that_comes_back_is_used_again(tmp_path: Path) -> None:
    # Far enough from the stopping point to make up for the time lost.
    run = run_with(tmp_path, TrnPos, silent(60, 65), load("yizhuang_04"))
    times_s, modes = run.trace.times_s(NotchCmd.PORT), run.trace.raw(NotchCmd.PORT, "CtlMode")
    braking_s = times_s[modes == CtlMode.SERVICE_BRAKE]
    assert 60.98 <= braking_s[0] <= 61.04
    assert 65.0 < braking_s[-1] < 65.5
    assert set(modes[times_s > braking_s[-1]]) == {CtlMode.RUNNING}
    assert run.score.failures == ()
    assert run.score.values["stop_error_m"] is not None
    assert run.score.values["stop_error_m"] < 0.05


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_position_that_never_comes_holds_the_train(tmp_path: Path) -> None:
    run = run_with(tmp_path, TrnPos, silent(0))
    assert np.max(run.trace.raw(SimTruth.PORT, "TruePos")) < 20_000
    assert set(run.trace.raw(CtlStat.PORT, "LadderLevel")[-10:]) == {3}


@pytest.mark.long
@pytest.mark.slow
def test_a_law_by_distance_brakes_and_one_by_time_runs_on(tmp_path: Path) -> None:
    by_distance = run_with(tmp_path / "d", TrnPos, silent(60), controller="tdmc", indexing="distance")
    assert_braked(by_distance, 60)
    by_time = run_with(tmp_path / "t", TrnPos, silent(60), controller="tdmc")
    healthy = direct_run(SHORT, RunSpec(law=LawSpec("tdmc"), seed=SEED, perturbed=True))
    assert by_time.commands("notch") == healthy.commands("notch")


# -- balises ----------------------------------------------------------------------------------------------------------


def few_balises(*at_m: float) -> Scenario:
    """9 km with few balises: there a reading wrong by 65.536 m is inside of what a worn wheel explains."""
    slope = load(ROOT / "docs/examples/desiro_slope.toml")
    balises = tuple(Balise(number, place_m, place_m) for number, place_m in enumerate(at_m, 1))
    return replace(slope, line=replace(slope.line, balises=balises))


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_late_balises_are_placed_or_not_used(tmp_path: Path) -> None:
    run = run_with(tmp_path, BalisePassed, late(3), few_balises(2000, 5000, 8000), seed=0, drawn=False)
    # At two of them the train is faster than 65 m in 3 s.
    assert run.refused == {"controller.balise_late": 2}
    assert run.score.values["stop_error_m"] is not None
    assert run.score.values["stop_error_m"] < 0.05


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_a_first_balise_that_may_be_an_old_one_is_not_used(tmp_path: Path) -> None:
    """The port was lost until 3 s after the third balise, more than 65.536 m behind it."""
    third_late = late(3)

    def fault(telegram: BalisePassed, now_s: float) -> list[BalisePassed]:
        return [] if telegram.balise_id < 3 else third_late(telegram, now_s)

    run = run_with(tmp_path, BalisePassed, fault, few_balises(0, 3000, 6000), seed=0, drawn=False)
    assert run.refused == {"controller.balise_late": 1}
    assert run.score.values["stop_error_m"] is not None
    assert run.score.values["stop_error_m"] < 0.05


@pytest.mark.long
@pytest.mark.slow
def test_a_law_with_a_wrong_position_brakes_at_the_end_of_its_authority(tmp_path: Path) -> None:
    """The third balise tells a place 65 m short of its own, which a worn wheel would explain; the last one is right."""

    def fault(telegram: BalisePassed, now_s: float) -> list[BalisePassed]:
        off_mm = 65_000 if telegram.balise_id == 3 else 0
        return [replace(telegram, surveyed_mm=telegram.surveyed_mm - off_mm)]

    run = run_with(tmp_path, BalisePassed, fault, few_balises(0, 3000, 6000, 8900), seed=0, drawn=False)
    braked = run.trace.raw(NotchCmd.PORT, "CtlMode") == CtlMode.SERVICE_BRAKE
    assert set(run.trace.raw(NotchCmd.PORT, "CtlCause")[braked]) == {CtlCause.POSITION_IMPLAUSIBLE}
    began_s = run.trace.times_s(NotchCmd.PORT)[braked][0]
    passed = run.trace.raw(SimTruth.PORT, "TruePos") > 9_005_0000
    # In the control period after it, 20 m at most: the wheel and the survey are allowed for.
    assert 0.0 < began_s - run.trace.times_s(SimTruth.PORT)[passed][0] < 1.0
    assert run.score.signed["stop_error_m"] is not None
    assert run.score.signed["stop_error_m"] > 5.0


def test_a_scenario_numbers_its_balises_from_1(tmp_path: Path) -> None:
    path = tmp_path / "zero.toml"
    path.write_text('extends = "lvshun_tieshan"\nname = "zero"\n[line]\nbalises = [{number=0, surveyed_m=600.0}]\n')
    with pytest.raises(InputError, match=r"line\.balises\[0\]\.number: found 0, allowed at least 1"):
        load(path)
