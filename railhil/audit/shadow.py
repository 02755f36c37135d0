"""Shadow run: the audited arithmetic drives the plant, other arithmetics compute in parallel on the same inputs.

Every controller is given the commands that were really sent. Their states therefore stay comparable: differences come
from the arithmetic alone, not from two plants that drift apart.

The controller that drives does not receive its own commands. A law that computes without formats
(``VectorLaw.floating``) knows them before they are rounded for the bus, by up to half a code, which is far more than
the arithmetic does. Such a law is therefore compared with float64 by a twin in the same arithmetic, which receives the
sent commands like all others.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ldexp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.law_controller import CommandCode, Computed, maker_of
from railhil.controller_node.program.model import Quantity
from railhil.controller_node.telemetry import VALUE_BITS, Telemetry
from railhil.judge.result import Result
from railhil.run.local import unrecorded_run
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec


class Watched:
    """A controller that records the values of its named quantities and the codes of its commands, one row per period.

    :param law: its arithmetic is ignored; ``arithmetic`` counts.
    :raises InputError: there is no such law, it cannot be made, or the system's controller lacks parts that the audit
        needs (see :mod:`railhil.controller_node.law_controller`).
    """

    def __init__(self, scenario: AnyScenario, law: LawSpec, arithmetic: Arithmetic[Any]) -> None:
        self.arithmetic = arithmetic
        made = maker_of(scenario.installed_system, scenario)
        self.controller: Any = made(scenario, law, arithmetic, may_wrap=True)
        self.telemetry: Telemetry = self.controller.telemetry
        self._history = self.telemetry.history = []
        #: One code for each command, raw.
        self.codes: list[tuple[int, ...]] = []

    def step(self, *given: Any) -> Computed:
        """One control period."""
        computed: Computed = self.controller.step(*given)
        self.codes.append(computed.commands)
        return computed

    def sent(self, *codes: int) -> None:
        """Pass the commands really sent to the law."""
        self.controller.sent(*codes)

    def __getattr__(self, name: str) -> Any:
        """Everything else that the controller's node uses."""
        return getattr(self.controller, name)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """The recorded quantities, in the order of the columns of :attr:`rows`."""
        return self.telemetry.quantities

    @property
    def rows(self) -> NDArray[np.float64]:
        """Values in the units of the quantities, shape (periods, quantities)."""
        lsb = [1.0 if self.arithmetic.wide else ldexp(1.0, -quantity.q) for quantity in self.quantities]
        return np.array(self._history, dtype=np.float64).reshape(-1, len(lsb)) * lsb

    @property
    def not_finite(self) -> int:
        """Number of infinite values."""
        return int(np.count_nonzero(~np.isfinite(self.rows)))


class Shadowed(Watched):
    """The controller that drives the plant; it passes its inputs and the commands sent to its shadows.

    :param along: the shadows.
    """

    def __init__(
        self, scenario: AnyScenario, law: LawSpec, arithmetic: Arithmetic[Any], along: Sequence[Watched]
    ) -> None:
        super().__init__(scenario, law, arithmetic)
        self._along = along

    def step(self, *given: Any) -> Computed:
        computed = super().step(*given)
        for shadow in self._along:
            shadow.step(*given)
            shadow.sent(*computed.commands)
        return computed

    def sent(self, *codes: int) -> None:
        super().sent(*codes)
        for shadow in self._along:
            shadow.sent(*codes)


def floored(arithmetic: Arithmetic[int]) -> Arithmetic[int]:
    """A fresh fixed-point arithmetic of the same kind that floors the products which the original rounds: it shows the
    error that a law gets from ``mpy`` instead of ``rmpy``.

    Each floored product is half an LSB lower on average, a sum of n products n/2 LSB. The quantiser of the notch
    still rounds: its rounding is part of the law's equations.
    """
    kind: Any = type(arithmetic)

    class Floored(kind):  # type: ignore[misc]
        def rmpy(self, a: int, b: int, q: int) -> int:
            return self.mpy(a, b, q)  # type: ignore[no-any-return]

        def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
            total = 0
            for coefficient, value in zip(coefficients, values, strict=True):
                total = self.add(total, self.mpy(coefficient, value, q))
            return total

        def quantise(self, a: int, q_from: int, q_to: int) -> int:
            return super().rmpy(a, 1, q_from - q_to)  # type: ignore[no-any-return]

    twin: Arithmetic[int] = Floored()
    return twin


@dataclass(frozen=True, slots=True)
class ShadowRun:
    """One run: ``audited`` drove the plant, ``reference`` (float64) and ``others`` computed in parallel.

    ``twin``: the controller in the audited arithmetic that is compared with the reference.
    """

    run: Result
    audited: Watched
    twin: Watched
    reference: Watched
    others: tuple[Watched, ...]

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Quantities of the law."""
        return self.audited.quantities


def run_under(scenario: AnyScenario, law: LawSpec, controller: Watched, seed: int = 0) -> Result:
    """The nominal run with a given controller: by the system's part ``direct`` (no bus), else through the nodes.

    :raises InputError: the law raises, or no control period was computed.
    """
    system = scenario.installed_system
    run: Callable[..., Result] = system.optional_part("direct") or unrecorded_run
    done = run(scenario, RunSpec(law=law, seed=seed), controller)
    if not controller.codes:
        found = Words("no control period: the readings never came")
        raise InputError(scenario.name, "controller", found, "a run in which the law is asked")
    return done


def shadow_run(
    scenario: AnyScenario,
    law: LawSpec,
    arithmetic: Arithmetic[Any],
    *,
    others: Sequence[Arithmetic[Any]] = (),
    twin: Arithmetic[Any] | None = None,
    seed: int = 0,
) -> ShadowRun:
    """Run the nominal plant with the audited arithmetic and shadow it.

    :param others: fresh arithmetics that compute in parallel, in addition to float64.
    :param twin: a fresh one like ``arithmetic``, for a law that is compared by a twin; None: the driving one is.
    :raises InputError: like :class:`Watched` and :func:`run_under`.
    """
    reference, *along = (Watched(scenario, law, each) for each in (make("float64"), *others))
    twins = [Watched(scenario, law, twin)] if twin is not None else []
    audited = Shadowed(scenario, law, arithmetic, (reference, *along, *twins))
    run = run_under(scenario, law, audited, seed)
    return ShadowRun(run, audited, twins[0] if twins else audited, reference, tuple(along))


@dataclass(frozen=True, slots=True)
class QuantityError:
    """Error of one quantity against float64 over a run, in the unit of the quantity.

    ``bias`` is the signed mean, ``worst_step`` the control period of the largest error. ``outside`` counts the periods
    in which float64's value does not fit the format at all. There the law substitutes a limit, so the difference is not
    an error of the arithmetic. These periods are excluded, as are those in which the audited value is infinite (this
    has a limit of its own); if none is left, the figures are None.
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
        """A value in LSB of the quantity's format."""
        return ldexp(value, self.q)


def errors(quantities: Sequence[Quantity], audited: Watched, reference: Watched) -> list[QuantityError]:
    """Errors of every quantity."""
    found, wanted = np.asarray(audited.rows), np.asarray(reference.rows)
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
    """Codes of one command in one arithmetic compared with float64's codes on the same inputs."""

    command: CommandCode
    steps: int
    equal: int
    #: Largest difference, raw.
    largest: int

    @property
    def equal_share(self) -> float:
        """Share of control periods with the same code."""
        return self.equal / self.steps


def compare_codes(audited: Watched, reference: Watched) -> tuple[Codes, ...]:
    """Compare the commands computed by two controllers of one run, command by command."""
    found = []
    columns = zip(*audited.codes, strict=True), zip(*reference.codes, strict=True)
    for command, ours, theirs in zip(audited.controller.commands, *columns, strict=True):
        differences = [abs(a - b) for a, b in zip(ours, theirs, strict=True)]
        found.append(Codes(command, len(differences), differences.count(0), max(differences)))
    return tuple(found)
