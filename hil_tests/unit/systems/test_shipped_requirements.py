"""The requirements that ship with each system: they fit its scenarios, its runs keep them, and each says something."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.judge.requirements.outcome import Outcome
from railhil.judge.requirements.requirement import check_requirements, read_requirements
from railhil.run.make import record_run
from railhil.scenarios.load import load_any, names
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import names as system_names

SYSTEMS = ("ato", "emu3", "hst1", "line", "stop")
PAIRS, TINY_LINE = str(TEST_DATA / "pairs.toml"), str(TEST_DATA / "tiny_line.toml")
#: A limit that the train exceeds on a steep grade where its brake does not hold it.
OVERSPEED = ("line.speed_limit_kmh=[[-200, 31]]", "plan.running_time_s=46")
#: Runs in which each sentence of a system says something: scenario, law, faults, settings.
Row = tuple[str, str, Sequence[str], Sequence[str]]
RUNS: dict[str, list[Row]] = {
    "ato": [
        (PAIRS, "ipfc_plus", (), ()),
        (PAIRS, "ipfc_plus", ("TRN_SPEED loss @8s for 90ms", "TRN_SPEED loss @12s"), ()),
        (PAIRS, "ipfc_plus", ("TRN_POS loss @6s for 3s",), ()),
        (PAIRS, "ipfc_plus", ("doors off @15s for 2s", "safety_loop off @20s"), ()),
        (PAIRS, "ipfc_plus", ("NOTCH_CMD.NotchChk raw 0 @8s x3", "NOTCH_CMD loss @12s for 950ms"), ()),
        (PAIRS, "ipfc_plus", ("gradient offset -100 @8s", "adhesion low 0.01 @8s"), OVERSPEED),
    ],
    "line": [
        (TINY_LINE, "ipfc_plus", (), ()),
        (TINY_LINE, "ipfc_plus", ("doors off @section 1 5s",), ()),
    ],
    "stop": [
        ("yizhuang_stop", "reaim", (), ()),
        ("yizhuang_stop", "ilc_stop", ("controller kill @5s",), ()),
        ("yizhuang_stop", "ilc_stop", ("sensor.speed off @5s for 2s",), ()),
        ("yizhuang_stop", "ilc_stop", ("actuator.brake off @20s",), ()),
        ("yizhuang_stop", "ilc_stop", ("bus down @33.5s for 680ms",), ()),
    ],
    "hst1": [
        ("jinan_xuzhou_emergency", "pid", (), ()),
        ("hst_short", "pid", ("UNIT1_CMD loss 100% @10s for 1s", "UNIT1_FB loss 100% @20s for 1s"), ()),
        ("hst_short", "pid", ("REF loss 100% @20s for 2s",), ()),
        ("hst_short", "pid", ("EVENT loss 100% @20s for 2s", "safety_loop off @30s"), ("task.duration_s=60",)),
        ("jinan_xuzhou_emergency", "pid", ("actuator.brake off @emergency_called+3s",), ()),
    ],
    "emu3": [
        ("jinan_xuzhou_emu3_emergency", "pid", (), ()),
        *(
            (
                "emu3_short",
                "pid",
                (f"UNIT{unit}_CMD loss 100% @10s for 1s", f"UNIT{unit}_FB loss 100% @20s for 1s"),
                (),
            )
            for unit in (1, 2, 3)
        ),
        ("emu3_short", "pid", ("REF loss 100% @20s for 2s",), ()),
        ("emu3_short", "pid", ("EVENT loss 100% @20s for 2s", "safety_loop off @30s"), ("task.duration_s=60",)),
        ("jinan_xuzhou_emu3", "pid", (), ("task.start_s=3600", "task.duration_s=30")),
        ("jinan_xuzhou_emu3_emergency", "pid", ("actuator.brake off @emergency_called+3s",), ()),
    ],
}


@cache
def shipped() -> list[AnyScenario]:
    return [load_any(name) for name in names()]


def outcomes(system: str, row: int) -> tuple[Outcome, ...]:
    scenario, law, faults, settings = RUNS[system][row]
    with TemporaryDirectory() as folder:
        spec = RunSpec(
            scenario, tuple(settings), LawSpec(law), bus="local", faults=tuple(faults), out=Path(folder) / "run",
            requirements=tuple(one.as_json() for one in read_requirements(system)),
        )  # fmt: skip
        return record_run(spec, keep=False).score.requirements


def test_every_system_ships_requirements() -> None:
    assert set(system_names()) >= set(SYSTEMS)
    for system in SYSTEMS:
        found = read_requirements(system)
        assert len(found) >= 10
        assert all(one.title and one.source for one in found)


@pytest.mark.slow
@pytest.mark.parametrize("system", SYSTEMS)
def test_they_fit_each_shipped_scenario_of_their_system(system: str) -> None:
    found = read_requirements(system)
    fitting = [scenario for scenario in shipped() if scenario.system == system]
    assert fitting
    for scenario in fitting:
        check_requirements(found, scenario)


@pytest.mark.slow
def test_a_line_can_be_judged_by_the_requirements_of_its_trains_as_well() -> None:
    check_requirements((*read_requirements("ato"), *read_requirements("line")), load_any("four_stops"))


@pytest.mark.slow
@pytest.mark.parametrize("system", SYSTEMS)
def test_no_run_violates_them_and_each_says_something_in_one(system: str) -> None:
    verdicts = defaultdict(set)
    for row in range(len(RUNS[system])):
        for one in outcomes(system, row):
            assert not one.violated, one.line
            verdicts[one.id].add(one.verdict)
    assert [name for name, found in verdicts.items() if "kept" not in found] == []
