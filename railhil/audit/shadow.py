"""Shadow run: the audited arithmetic drives the train, other arithmetics compute along on the same inputs.

Every loop is told the notch that was really sent, so that the states stay comparable and what is left between two
loops is the arithmetic alone, not two trains that drift apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ldexp
from typing import Any

import numpy as np

from railhil.bench import BenchRun, coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.laws.base import NOTCH_Q, BaliseReading
from railhil.controller_node.loop import ControlLoop
from railhil.controller_node.program.model import Quantity
from railhil.controller_node.telemetry import VALUE_BITS, Telemetry
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec, RunSpec


class Watched:
    """A control loop that keeps the values of its named quantities and its notch codes, one row per period.

    :param law: its arithmetic is not looked at.
    :param quantities: those of the law, in the order of its notes.
    """

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec,
        arithmetic: Arithmetic[Any],
        quantities: Sequence[Quantity],
    ) -> None:
        self.arithmetic = arithmetic
        self.loop: ControlLoop[Any] = ControlLoop(scenario, law, arithmetic)
        self.telemetry = Telemetry(quantities)
        #: In the units of the quantities.
        self.rows: list[list[float]] = []
        #: 1/256 notch.
        self.codes: list[int] = []
        self._lsb = [1.0 if arithmetic.wide else ldexp(1.0, -quantity.q) for quantity in quantities]
        arithmetic.noted = []

    def step(self, k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int]) -> int:
        """One control period; its notch code."""
        _, outputs = self.loop.step(k, speed_01mmps, position_01mm, balise)
        noted = self.arithmetic.noted
        assert noted is not None
        self.rows.append([float(value) * lsb for value, lsb in zip(noted, self._lsb, strict=True)])
        self.telemetry.take(self.arithmetic)
        self.codes.append(int(self.arithmetic.raw(outputs.notch, NOTCH_Q)))
        return self.codes[-1]

    @property
    def not_finite(self) -> int:
        """How many values were infinite."""
        return int(np.count_nonzero(~np.isfinite(self.rows)))

    def sent(self, code: int) -> None:
        """Tell the law the notch really sent."""
        self.loop.sent(self.arithmetic.from_raw(code, NOTCH_Q))
        self.telemetry.take(self.arithmetic)


@dataclass(frozen=True, slots=True)
class ShadowRun:
    """One run: ``audited`` drove the train, ``reference`` (float64) and ``others`` computed along."""

    quantities: tuple[Quantity, ...]
    run: BenchRun
    audited: Watched
    reference: Watched
    others: tuple[Watched, ...]


def shadow_run(
    scenario: Scenario,
    law: LawSpec,
    arithmetic: Arithmetic[Any],
    quantities: tuple[Quantity, ...],
    *,
    others: Sequence[Arithmetic[Any]] = (),
    seed: int = 0,
) -> ShadowRun:
    """Run the nominal train with the audited arithmetic and shadow it.

    :param others: fresh arithmetics that compute along beside float64.
    """
    audited, reference, *along = (
        Watched(scenario, law, each, quantities) for each in (arithmetic, make("float64"), *others)
    )

    def drive(*given: Any) -> int:
        code = audited.step(*given)
        for shadow in (reference, *along):
            shadow.step(*given)
            shadow.sent(code)
        return code

    run = coupled_run(scenario, drive, RunSpec(law=law, seed=seed))
    return ShadowRun(quantities, run, audited, reference, tuple(along))


@dataclass(frozen=True, slots=True)
class QuantityError:
    """Error of one quantity against float64 over a run, in the unit of the quantity.

    ``bias`` is the mean with its sign, ``worst_step`` the control period of the largest error. ``outside`` counts the
    periods in which float64's value does not fit the format at all: there the law has put a limit in its place, and
    the difference is none of the arithmetic's. They are left out, as are periods in which the audited value is
    infinite (a bar of its own); with nothing left the figures are None.
    """

    name: str
    q: int
    unit: str
    rms: float | None
    maximum: float | None
    bias: float | None
    worst_step: int | None
    outside: int

    def lsb(self, value: float) -> float:
        """A value in units of the last bit of the quantity's format."""
        return ldexp(value, self.q)


def errors(quantities: Sequence[Quantity], audited: Watched, reference: Watched) -> list[QuantityError]:
    """Errors of every quantity."""
    found, wanted = np.array(audited.rows), np.array(reference.rows)
    result = []
    for i, quantity in enumerate(quantities):
        fits = np.abs(wanted[:, i]) < ldexp(1.0, VALUE_BITS - quantity.q)
        if audited.arithmetic.wide:
            fits = np.isfinite(found[:, i])
        steps = np.flatnonzero(fits)
        error = (found[:, i] - wanted[:, i])[steps]
        outside = len(fits) - len(steps)
        if not len(steps):
            result.append(QuantityError(quantity.name, quantity.q, quantity.unit, None, None, None, None, outside))
            continue
        size = np.abs(error)
        result.append(
            QuantityError(
                quantity.name,
                quantity.q,
                quantity.unit,
                rms=float(np.sqrt(np.mean(error**2))),
                maximum=float(size.max()),
                bias=float(error.mean()),
                worst_step=int(steps[size.argmax()]),
                outside=outside,
            )
        )
    return result


@dataclass(frozen=True, slots=True)
class Codes:
    """Notch codes of one arithmetic beside those of float64 on the same inputs."""

    steps: int
    equal: int
    #: 1/256 notch.
    largest: int

    @property
    def equal_share(self) -> float:
        """Share of control periods with the same code."""
        return self.equal / self.steps


def compare_codes(audited: Watched, reference: Watched) -> Codes:
    """Compare what two loops of one run would have sent."""
    pairs = list(zip(audited.codes, reference.codes, strict=True))
    return Codes(len(pairs), sum(a == b for a, b in pairs), max(abs(a - b) for a, b in pairs))
