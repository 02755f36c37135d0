"""What every law is tested for in the same way: many trains and one, fixed point beside float64, no wrap."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railhil.audit.shadow import Codes, compare_codes, errors, shadow_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.controller import BatchController, Controller
from railhil.controller_node.laws.base import Law
from railhil.controller_node.laws.parameters import law_parameters
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.record import record
from railhil.scenarios.model import Scenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec


@dataclass(frozen=True, slots=True)
class Shadowed:
    """Fixed point beside float64 on the inputs of one nominal run; the largest error of the raw notch in notches."""

    notch_raw_error: float
    codes: Codes


def shadowed(scenario: Scenario, law: str, indexing: str = "time") -> Shadowed:
    """Let a law drive in fixed point and compute along in float64."""
    quantities = record(scenario, LawSpec(law, indexing=indexing)).quantities
    run = shadow_run(scenario, LawSpec(law, indexing=indexing), make("iq"), quantities)
    raw = next(e for e in errors(quantities, run.audited, run.reference) if e.name == "notch_raw")
    assert raw.maximum is not None
    return Shadowed(raw.maximum, compare_codes(run.audited, run.reference))


def same_for_many_and_for_one(scenario: Scenario, law: str, arithmetic: str, periods: int = 20) -> None:
    """Random and wild speeds of 4 trains, stepped together and alone, other notches sent now and then."""
    generator = np.random.Generator(np.random.PCG64(20210825))
    batch = BatchController(scenario, 4, LawSpec(law, arithmetic))
    alone = [Controller(scenario, LawSpec(law, arithmetic)) for _ in range(4)]
    for k in range(100, 100 + periods):
        speed = np.array([generator.integers(0, 220_000), generator.integers(0, 1_500_000), 216_667, 216_667])
        speed[2:] += generator.integers(-20, 21, 2)
        position = generator.integers(0, 30_000_000, 4)
        together = batch.step(k, speed, position)
        singles = [c.step(k, int(v), int(x)) for c, v, x in zip(alone, speed, position, strict=True)]
        assert [single.notch_code for single in singles] == together.notch_code.tolist()
        assert [single.error_raw for single in singles] == together.error_raw.tolist()
        if k % 7 == 3:
            sent = generator.integers(-1792, 1793, 4)
            batch.sent(sent)
            for controller, code in zip(alone, sent, strict=True):
                controller.sent(int(code))


def bounds_hold_at_the_corners(scenario: Scenario, kind: type[Law[Any, Any]], corners: int = 12) -> None:
    """Interval analysis at the defaults and at corners of the search space, drawn with a fixed seed."""
    generator = np.random.Generator(np.random.PCG64(7))
    drawn: list[dict[str, float]] = [{}]
    drawn += [{name: float(generator.choice(bounds)) for name, bounds in kind.tunable.items()} for _ in range(corners)]
    for corner in drawn:
        parameters = ParameterSet(kind.name, corner, Path("corner"))
        law = kind(make("float64"), scenario, law_parameters(kind.name, kind, parameters))
        program = record(scenario, LawSpec(kind.name, indexing=kind.indexings[0], parameters=parameters))
        assert analyse_law(program, law.state_bounds()).may_wrap == [], corner
