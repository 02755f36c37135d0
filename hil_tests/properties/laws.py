"""Properties of every control law, as a test class: a law inherits the tests through a subclass (``test_laws.py``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from hil_tests.support.batch_controller import BatchController
from hil_tests.support.exported import SANITIZED, checked, compiled, written
from railhil.audit.shadow import compare_codes, errors, shadow_run
from railhil.batch import Case
from railhil.bench import direct_run, local_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.controller import WIRE, Controller
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import Law
from railhil.controller_node.laws.parameters import law_parameters
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.tracer import record
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.batch.replay import trace_digest
from railhil.systems.ato.scenario.model import Perturbations, Scenario
from railhil.systems.ato.scenario.perturb import perturb

YIZHUANG = (
    pytest.param("yizhuang_01_songjiazhuang_xiaocun", marks=pytest.mark.long),
    "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan",
    pytest.param("yizhuang_11_jinghai_lu_ciqu_nan", marks=pytest.mark.long),
)
#: Seeds of the perturbed runs; their trains differ in mass, resistance, brakes, wheels, delays.
SEEDS = range(1000, 1020)
_WORN = "lvshun_tieshan_worn_wheels"


class LawProperties:
    """Whatever its scores, a law stops, stays below the limits, wraps nowhere, and behaves the same in every
    arithmetic, on one train and on many, over the bus, coupled directly, in the batch and in C."""

    #: Its registered name.
    law: ClassVar[str]
    #: Scenario on which its single steps are examined.
    scenario: ClassVar[str] = "lvshun_tieshan"
    #: Fixed point compared with float64 on equal inputs: largest error of the raw notch, in notches.
    notch_raw_error_max: ClassVar[float] = 2e-4
    #: And the minimum share of equal notch codes.
    equal_share_min: ClassVar[float] = 0.99
    #: Arithmetic of its batches; in fixed point too, which is long for a law that takes long to compile there.
    batched: ClassVar[str] = "iq"
    #: Whether its batches are compiled in long tests only: another law has the same kinds of operations.
    is_batch_long: ClassVar[bool] = False

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Set-points by time and by distance, for a law that supports both; the arithmetics of its batches."""
        if "indexing" in metafunc.fixturenames:
            metafunc.parametrize("indexing", self.kind().indexings)
        if "batched" in metafunc.fixturenames:
            first = pytest.param(self.batched, marks=[pytest.mark.long] if self.is_batch_long else [])
            fixed_point = [pytest.param("iq", marks=pytest.mark.long)] if self.batched != "iq" else []
            metafunc.parametrize("batched", [first, *fixed_point])

    @classmethod
    def kind(cls) -> type[Law[Any, Any]]:
        """The law's class."""
        return load_law(cls.law)

    def corners(self) -> Iterator[dict[str, float]]:
        """Parameters at which no operation may wrap: its own, and corners of the search space, drawn with a fixed
        seed."""
        generator = np.random.Generator(np.random.PCG64(7))
        yield {}
        for _ in range(12):
            yield {name: float(generator.choice(bounds)) for name, bounds in self.kind().tunable.items()}

    # -- arithmetics --------------------------------------------------------------------------------------------------

    @pytest.mark.long_after(2)
    @pytest.mark.slow
    @pytest.mark.parametrize("arithmetic", ["float64", "float32", "iq", "iq-portable"])
    def test_many_trains_equal_each_alone(self, arithmetic: str) -> None:
        """Random and extreme speeds of 4 trains, stepped together and alone, with other notches sent occasionally.

        In iq with set-points over distance, if the law has them: over time it drives the trains of all other tests.
        """
        scenario = load(self.scenario)
        indexing = self.kind().indexings[-1] if arithmetic == "iq" else "time"
        generator = np.random.Generator(np.random.PCG64(20210825))
        batch = BatchController(scenario, 4, LawSpec(self.law, arithmetic, indexing=indexing))
        alone = [Controller(scenario, LawSpec(self.law, arithmetic, indexing=indexing)) for _ in range(4)]
        for k in range(100, 120):
            speed = np.array([generator.integers(0, 220_000), generator.integers(0, 1_500_000), 216_667, 216_667])
            speed[2:] += generator.integers(-20, 21, 2)
            position = generator.integers(0, 30_000_000, 4)
            together = batch.step(k, speed, position)
            singles = [c.step(k, int(v), int(x)) for c, v, x in zip(alone, speed, position, strict=True)]
            assert [single.notch_code for single in singles] == together.notch_code.tolist()
            assert [single.error_raw for single in singles] == together.error_raw.tolist()
            notes = [tuple(values[train] for values in together.notes) for train in range(4)]
            assert [single.notes for single in singles] == notes
            if k % 7 == 3:
                sent = generator.integers(-1792, 1793, 4)
                batch.sent(sent)
                for controller, code in zip(alone, sent, strict=True):
                    controller.sent(int(code))

    @pytest.mark.long_after(1)
    @pytest.mark.slow
    def test_fixed_point_follows_float64(self, indexing: str) -> None:
        """A nominal run in fixed point, with a float64 copy on the same inputs."""
        scenario = load(self.scenario)
        run = shadow_run(scenario, LawSpec(self.law, indexing=indexing), make("iq"))
        raw = next(e for e in errors(run.quantities, run.audited, run.reference) if e.name == "notch_raw")
        (codes,) = compare_codes(run.audited, run.reference)
        assert raw.maximum is not None
        assert raw.maximum < self.notch_raw_error_max
        assert codes.equal_share >= self.equal_share_min
        assert codes.largest <= 1

    @pytest.mark.slow
    def test_nothing_wraps_in_the_whole_search_space(self) -> None:
        scenario, kind = load(self.scenario), self.kind()
        for corner in self.corners():
            given = ParameterSet(self.law, corner, Path("corner"))
            law = kind(make("float64"), scenario, law_parameters(self.law, kind, given))
            program = record(scenario, LawSpec(self.law, indexing=kind.indexings[0], parameters=given))
            assert analyse_law(program, law.state_bounds(), WIRE).may_wrap == [], corner

    def test_own_parameters_lie_inside_the_search(self) -> None:
        own = self.kind().parameters_type()
        assert 4 <= len(self.kind().tunable) <= 10
        for name, (low, high) in self.kind().tunable.items():
            assert low <= getattr(own, name) <= high, name

    @pytest.mark.slow
    @pytest.mark.needs_compiler
    def test_exported_c_computes_the_same(self, tmp_path: Path) -> None:
        written(load(self.scenario), tmp_path, "time", self.law)
        done = checked(compiled(tmp_path, "gcc", SANITIZED, "run", self.law), tmp_path / f"{self.law}_log.txt")
        assert done.returncode == 0, done.stdout

    # -- its inputs ---------------------------------------------------------------------------------------------

    def test_nothing_drawn_is_in_the_program(self) -> None:
        """The law knows only the nominal scenario: neither the sensors and loop delay of a run, nor the true balise
        positions, nor the ranges of the draws."""
        known = load("yizhuang_04_jiugong_yizhuang_qiao")
        drawn = perturb(load(_WORN), 1003)
        balises = tuple(replace(balise, true_m=balise.true_m + 7.0) for balise in known.line.balises)
        told = replace(
            known,
            sensors=drawn.sensors,
            timing=replace(known.timing, loop_delay_s=drawn.timing.loop_delay_s),
            line=replace(known.line, balises=balises),
            perturbations=Perturbations(),
        )
        assert balises
        assert told.sensors != known.sensors
        assert told.timing != known.timing
        assert told.perturbations != known.perturbations
        assert record(told, LawSpec(self.law)) == record(known, LawSpec(self.law))

    # -- on the train -------------------------------------------------------------------------------------------------

    @pytest.mark.slow
    @pytest.mark.parametrize("name", YIZHUANG)
    def test_takes_a_train_from_station_to_station(self, name: str, batched: str) -> None:
        scenario, law = load(name), LawSpec(self.law, batched)
        nominal = run_batch(Case(scenario, law, perturbed=False), [0])
        drawn = run_batch(Case(scenario, law), SEEDS)
        for runs in (nominal, drawn):
            assert set(runs.ended) == {"ended_complete"}
            assert not np.isnan(runs.values["stop_error_m"]).any()
            assert runs.extras["overspeed_mps"].max() == 0.0
            assert not any("emergency" in text for texts in runs.failures for text in texts)
            assert runs.wraps.max() == 0
        # A wheel that is half a percent off makes a train that relies on it stop about ten metres off, not more.
        assert drawn.values["stop_error_m"].max() < 20.0
        assert nominal.values["stop_error_m"][0] < 1.5

    @pytest.mark.slow
    def test_bus_direct_coupling_and_batch_give_the_same_notches(self, tmp_path: Path, batched: str) -> None:
        """With worn wheels and misplaced balises, so that a law that uses the balises must get the same readings."""
        scenario: Scenario = load(_WORN)
        spec = RunSpec(law=LawSpec(self.law, batched), seed=1003, perturbed=True)
        over_bus = local_run(scenario, tmp_path, spec)
        coupled = direct_run(scenario, spec)
        batch = run_batch(Case(scenario, spec.law), [1003])
        assert over_bus.commands("notch") == coupled.commands("notch")
        assert over_bus.score == coupled.score
        assert trace_digest(scenario, over_bus.trace) == batch.digest[0]
        assert batch.values["itae"][0] == over_bus.score.values["itae"]
        assert batch.signed["stop_error_m"][0] == over_bus.score.signed["stop_error_m"]
        assert over_bus.refused == {}
