"""The registered laws: each inherits the tests of :class:`~hil_tests.properties.laws.LawProperties`."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.properties.laws import SEEDS, LawProperties
from railhil.batch import Case
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws import names
from railhil.controller_node.program.tracer import record
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import run_batch


class PredictiveProperties(LawProperties):
    """Laws with the paper's internal model, which wraps first where the model's response is largest."""

    # By chance a raw notch lies within 1e-4 of a code's edge in up to four of 393 periods; the unit tests use four
    # runs.
    equal_share_min = 0.985

    def corners(self) -> Iterator[dict[str, float]]:
        """Highest gain, smallest damping or stiffness; any corner for the others."""
        tunable = self.kind().tunable
        model = {"model_gain_mps": (0.10,), "model_damping_per_s": (0.30, 0.60), "model_stiffness_per_s2": (0.025,)}
        assert {key: tunable[key] for key in model} == {
            "model_gain_mps": (0.05, 0.10),
            "model_damping_per_s": (0.30, 0.60),
            "model_stiffness_per_s2": (0.025, 0.05),
        }
        rest = {key: bounds for key, bounds in tunable.items() if key not in model}
        largest = [dict(zip(model, corner, strict=True)) for corner in itertools.product(*model.values())]
        for k, other in enumerate(itertools.product(*rest.values())):
            yield {**largest[k % len(largest)], **dict(zip(rest, other, strict=True))}

    def test_starts_in_fixed_point_and_float32_at_the_corners(self) -> None:
        scenario = load(self.scenario)
        for corner in self.corners():
            given = ParameterSet(self.law, corner, Path("corner"))
            for arithmetic in ("float32", "iq"):
                ControlLoop(scenario, LawSpec(self.law, parameters=given), make(arithmetic))


class TestIpfc(PredictiveProperties):
    law = "ipfc"


class TestTpfc1(PredictiveProperties):
    law = "tpfc1"
    is_batch_long = True


class TestTpfc2(PredictiveProperties):
    law = "tpfc2"
    is_batch_long = True


class TestTdmc(LawProperties):
    law = "tdmc"
    # Its many checks in fixed point take 25 s of processor time to compile.
    batched = "float64"


class TestFuzzyPid(LawProperties):
    law = "fuzzy_pid"
    is_batch_long = True


class TestIpfcPlus(LawProperties):
    law = "ipfc_plus"
    scenario = "lvshun_tieshan_worn_wheels"
    notch_raw_error_max = 5e-5


class TestIpfcPlusStop(LawProperties):
    law = "ipfc_plus_stop"
    is_batch_long = True
    scenario = "lvshun_tieshan_worn_wheels"
    notch_raw_error_max = 2e-4


def test_every_registered_law_inherits_them() -> None:
    kinds = [kind for kind in globals().values() if isinstance(kind, type) and issubclass(kind, LawProperties)]
    tested = [kind.law for kind in kinds if hasattr(kind, "law")]
    assert sorted(tested) == sorted(names())


@pytest.mark.slow
def test_the_law_that_reads_balises_is_the_one_that_stops() -> None:
    """The inputs of track laws arrive: with worn wheels no other law can know the train's position."""
    scenario = load("lvshun_tieshan_worn_wheels")
    worst = {
        law: run_batch(Case(scenario, LawSpec(law)), SEEDS).values["stop_error_m"].max()
        for law in ("ipfc", "ipfc_plus")
    }
    assert load_law("ipfc_plus").track
    assert worst["ipfc_plus"] < 0.1 < 5.0 < worst["ipfc"]


def test_what_a_law_may_know_is_in_the_program() -> None:
    """The comparison of programs detects a difference."""
    scenario = load("yizhuang_04_jiugong_yizhuang_qiao")
    heavier = replace(scenario, train=replace(scenario.train, inertial_mass_kg=scenario.train.inertial_mass_kg * 1.1))
    assert record(heavier, LawSpec("ipfc_plus")) != record(scenario, LawSpec("ipfc_plus"))
