"""The stopping laws in fixed point and single precision: no wrap, the same stops, and the same words in C."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.stops import SHORT, stop_scenario
from railhil.audit.shadow import compare_codes, errors, shadow_run
from railhil.bench import direct_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.stop.filters import FILTERS
from railhil.controller_node.stop.learning import GAMMA_LEAST
from railhil.controller_node.vector.controller import VectorController
from railhil.scenarios.memory_store import read_memory
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

CLOSED = stop_scenario(*SHORT, "task.start_m=2560", name="yizhuang_stop_closed")


def spec(law: str, arithmetic: str = "iq", **values: Any) -> LawSpec:
    parameters = ParameterSet(law, values, Path("test.toml")) if values else None
    return LawSpec(law, arithmetic, parameters=parameters)


@pytest.mark.parametrize("name", FILTERS)
def test_no_filter_can_wrap(name):
    VectorController(CLOSED, spec("ilc_stop", filter=name, start_inside_cycle=True, trigger="window_or_late"))


def test_the_re_aim_cannot_wrap_without_its_parts():
    VectorController(CLOSED, spec("reaim", observer=False, balises=False, learning=False))
    VectorController(CLOSED, spec("reaim", sample_period_ms=16, gamma=GAMMA_LEAST))


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ilc_stop", "reaim"])
def test_all_arithmetics_stop_at_the_same_place(law):
    stops = {
        arithmetic: direct_run(CLOSED, RunSpec(law=LawSpec(law, arithmetic), seed=5)).score.signed["stop_error_m"]
        for arithmetic in ("float64", "float32", "iq")
    }
    assert stops["float32"] == pytest.approx(stops["float64"], abs=0.005)
    assert stops["iq"] == pytest.approx(stops["float64"], abs=0.005)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ilc_stop", "reaim"])
def test_fixed_point_commands_what_float64_commands_from_the_same_readings(law):
    shadow = shadow_run(CLOSED, LawSpec(law, "iq"), make("iq"), seed=5)
    for codes in compare_codes(shadow.twin, shadow.reference):
        assert (codes.equal_share >= 0.99, codes.largest <= 1) == (True, True), codes
    found = {one.name: one for one in errors(shadow.quantities, shadow.twin, shadow.reference)}
    if law == "reaim":
        # A sum over all cycles would add up what a conversion floors.
        assert abs(found["disturbance"].bias) < 1e-5


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.needs_compiler
@pytest.mark.parametrize("law", ["ilc_stop", "reaim"])
@pytest.mark.parametrize("arithmetic", ["iq", "float32"])
def test_the_exported_law_computes_the_same_words(law, arithmetic, tmp_path):
    settings = [word for setting in SHORT for word in ("--set", setting)]
    words = ("export-c", law, "yizhuang_stop_closed", *settings, "--arithmetic", arithmetic, "--out", tmp_path)
    done = railhil(*words)
    assert done.exit_code == 0, done.err
    if arithmetic == "iq":
        # Block M1 of the target has 1024, also for what is around the law.
        assert int(re.search(r"stack about (\d+) words", done.out)[1]) <= 768
    checked = subprocess.run(["make", "-s", "check"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "identical" in checked.stdout


def test_an_export_in_an_arithmetic_that_the_law_has_not_is_refused(tmp_path):
    done = railhil("export-c", "one_shot", "yizhuang_stop", "--arithmetic", "iq", "--out", tmp_path / "a")
    assert (done.exit_code, "one_shot has no fixed-point formats" in done.err) == (2, True)


@pytest.mark.long
@pytest.mark.slow
def test_runs_of_the_bench_learn_from_each_other_and_not_twice_from_one(tmp_path):
    memory = tmp_path / "memory"
    settings = [word for setting in (*SHORT, "task.start_m=2560") for word in ("--set", setting)]
    common = ("run", "yizhuang_stop", "--controller", "ilc_stop", *settings, "--bus", "local", "--no-report")
    errors, kept = [], []
    for place, number in enumerate((1, 2, 2)):
        words = ("--run-number", number, "--memory", memory, "--out", tmp_path / str(place))
        assert railhil(*common, *words).exit_code in (0, 1)
        score = json.loads((tmp_path / str(place) / "score.json").read_text(encoding="utf-8"))
        errors.append(abs(score["signed"]["stop_error_m"]))
        newest = read_memory(memory).newest
        assert newest is not None
        kept.append(newest.values["records"])
    assert errors[1] < 0.8 * errors[0]
    assert [[one["last_run"] for one in records] for records in kept] == [[1], [2], [2]]
    assert kept[1] == kept[2]
