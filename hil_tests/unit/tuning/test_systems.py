"""Tuning of laws of other systems than ``ato``: their criteria, their batches, and what they must declare."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import pytest

from hil_tests.support.plug import plug_in
from railhil.common.errors import InputError
from railhil.controller_node.high_speed.laws.pid import Pid
from railhil.controller_node.laws import find
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named
from railhil.study.perturbed_runs import run_seeds
from railhil.tuning.objective import objective
from railhil.tuning.search import Box, Protocol
from railhil.tuning.trials import Trials

TUNED = [(name, law) for name in ("stop", "hst1") for law in system_named(name).law_names()]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenario", "law", "candidate", "terms"),
    [
        ("yizhuang_stop", "ilc_stop", {"first_offset_m": 4.0}, "overshoot_m running_time_s jerk_mps3"),
        ("hst_short", "pid", {"kp_per_s": 0.4}, "max_error_kmh slope_mps3 energy_kwh"),
    ],
)
def test_candidates_are_judged_by_the_criteria_of_the_system(
    scenario: str, law: str, candidate: dict[str, float], terms: str
) -> None:
    known = load_any(scenario)
    trials = Trials(known, LawSpec(law, "float64"), (0, 1))
    assert {*terms.split()} <= {term.criterion.key for term in trials.scale.medians}
    given = LawSpec(law, "float64", parameters=ParameterSet(law, candidate, Path("alone")))
    assert trials.of([candidate]) == [objective(trials.scale, run_seeds(known, given, (0, 1)).scores)]
    assert trials.of_defaults() != trials.of([candidate])[0]


def test_a_candidate_that_the_law_refuses_is_no_law_and_its_reason_is_counted() -> None:
    trials = Trials(load_any("hst_short"), LawSpec("mm_gpc", "float64"), (0,))
    refused, made = trials.of([{"control_weight": 0.0, "forgetting": 0.5}, {"control_weight": 8.0}])
    assert refused is None
    assert made is not None
    ((reason, count),) = trials.refusals.items()
    assert (count, "spectral radius" in reason) == (1, True)


@pytest.mark.parametrize(("system", "law"), TUNED)
def test_own_parameters_lie_inside_the_search(system: str, law: str) -> None:
    kind: Any = find(law, system_named(system).laws)
    if not kind.tunable:
        with pytest.raises(InputError, match=f"found '{law}', allowed a law that declares tunable parameters"):
            Box.of(law, kind)
        return
    box = Box.of(law, kind)
    assert all(low <= own <= high for low, own, high in zip(box.low, box.default, box.high, strict=True))


class Unknown(Pid[Any]):
    """Bounds of a parameter that the law does not have."""

    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {"kq": (0.0, 1.0)}


class Reversed(Pid[Any]):
    """The upper bound first."""

    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {"kd": (1.0, 0.0)}


class Beyond(Pid[Any]):
    """A bound outside the range of the parameter."""

    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {"kd": (0.0, 11.0)}


@pytest.mark.parametrize("name", ["unknown", "reversed"])
def test_bounds_that_no_search_can_use_are_one_line(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plug_in(tmp_path, monkeypatch, "railhil.laws_high_speed", unknown=Unknown, reversed=Reversed)
    with pytest.raises(InputError, match=rf"controller: {name}.tunable.k[qd]: found \(.*, allowed a number among"):
        _ = Protocol(load_any("hst_short"), LawSpec(name, "float64")).box


def test_a_candidate_outside_the_range_of_its_parameter_ends_the_search(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, "railhil.laws_high_speed", beyond=Beyond)
    trials = Trials(load_any("hst_short"), LawSpec("beyond", "float64"), (0,))
    with pytest.raises(InputError, match=r"search: parameters.kd: found 11.0, allowed"):
        trials.of([{"kd": 11.0}])
