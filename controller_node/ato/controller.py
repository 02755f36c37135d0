"""The controller without the bus: integers from the bus in, notch code out, once per control period."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.common.errors import InputError
from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Counters
from railhil.controller_node.ato.loop import NO_BALISE, ControlLoop
from railhil.controller_node.compiled_law import compile_law
from railhil.controller_node.cost import Cost, cost_of
from railhil.controller_node.law_controller import CommandCode
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading
from railhil.controller_node.laws.fault import law_fault
from railhil.controller_node.laws.note import on_wire, on_wire_batch
from railhil.controller_node.program.model import LawProgram
from railhil.controller_node.program.ranges import WIRE, Interval, refuse_wraps
from railhil.controller_node.program.record import record
from railhil.controller_node.telemetry import Telemetry
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec


@dataclass(frozen=True, slots=True)
class ControlOutput:
    """The result of one control period.

    ``notch_code``: 1/256 notch, inside the notch range. ``notes``: the law's notes as CTL_STAT holds them, in the order
    of :attr:`~railhil.controller_node.laws.base.Law.notes`. ``error_raw``: set-point minus speed, km/h, Q20.
    ``overflow_flags``: bit 0 wrap, bit 1 saturation, bit 2 division by zero, each since the start of the run.
    ``cycles``: estimated C28x cycles of a step (the same for every step), program in RAM, 0 for float64.
    """

    notch_code: int
    notes: tuple[int, ...]
    overflow_flags: int
    cycles: int
    error_raw: int

    @property
    def commands(self) -> tuple[int]:
        """All that it answers, see :class:`railhil.controller_node.law_controller.Computed`."""
        return (self.notch_code,)


@dataclass(frozen=True, slots=True)
class BatchOutput:
    """:class:`ControlOutput` for N trains: int64 arrays of shape (N,); flags are common to all."""

    notch_code: NDArray[np.int64]
    notes: tuple[NDArray[np.int64], ...]
    error_raw: NDArray[np.int64]
    overflow_flags: int


def _watched(
    scenario: Scenario, law: LawSpec, arithmetic: Arithmetic[Any], may_wrap: bool = False
) -> tuple[ControlLoop[Any], LawProgram, Telemetry, Cost]:
    """A control loop whose arithmetic notes its quantities, its program, its telemetry and the cost of a step."""
    loop: ControlLoop[Any] = ControlLoop(scenario, law, arithmetic)
    program = record(scenario, law, wide=arithmetic.wide)
    ranges = None
    if not arithmetic.wide and not may_wrap:
        period_s, notch_max = scenario.timing.control_period_ns / 1e9, scenario.train.notch_max
        ranges = refuse_wraps(program, loop.law, f"at {period_s:g} s and {notch_max:g} notches")
    loop.compiled = compile_law(program, loop.law, arithmetic, ranges)
    # Start here, because the constants of the law have been made by now.
    arithmetic.noted = []
    price = cost_of(program, arithmetic, scenario.timing.control_period_ns)
    return loop, program, Telemetry(program.quantities), price


def _failed(
    loop: ControlLoop[Any], telemetry: Telemetry, arithmetic: Arithmetic[Any], error: Exception, function: str
) -> InputError:
    """The error line for a law that raised during a run, with the last quantity that it named in this period."""
    named = telemetry.quantities[: len(arithmetic.noted or ())]
    return law_fault(loop.name, type(loop.law), error, function, named[-1].name if named else None)


@mypyc_attr(allow_interpreted_subclasses=True)
class Controller:
    """Controller of one train, see also :class:`railhil.controller_node.law_controller.LawController`.

    ``telemetry`` is up to date after each :meth:`step`; ``cost`` is that of every control period.

    :param law: a registered law (entry point group ``railhil.laws``) and how it is run; in ``iq`` (C28x fixed point)
        there is no float between the arguments of :meth:`step` and its result. None: the default law.
    :param arithmetic: a fresh one to use instead of the one named by ``law``.
    :param may_wrap: accept a law in which an operation may wrap.
    :raises scenarios.errors.InputError: one of the names is unknown, the parameters are not those of the law, or a
        fixed-point format of the law may wrap for this scenario. In :meth:`step` and :meth:`sent`: the law has raised.
    """

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec | None = None,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
    ) -> None:
        law = law or LawSpec()
        self.arithmetic = self._number = arithmetic or make(law.arithmetic)
        self._loop, self.program, self.telemetry, self.cost = _watched(scenario, law, self._number, may_wrap)
        self._code: int | None = None
        self.law = self._loop.law
        #: The law's notes.
        self.notes = self.law.notes

    def step(
        self, k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int] = NO_BALISE
    ) -> ControlOutput:
        """One control period.

        :param k: number of the control period; it may start above 0 and skip.
        :param speed_01mmps: measured speed in 0.1 mm/s.
        :param position_01mm: measured position in 0.1 mm from the start of the run (the odometer).
        :param balise: the last balise passed.
        """
        number = self._number
        try:
            inputs, outputs = self._loop.step(k, speed_01mmps, position_01mm, balise)
        except Exception as fault:
            # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
            raise _failed(self._loop, self.telemetry, number, fault, "step") from fault
        self._code = code = number.raw(outputs.notch, NOTCH_Q)
        told = zip(self.notes, outputs.notes, strict=True)
        error = number.sub(inputs.set_point, inputs.speed)
        self.telemetry.take(number)
        return ControlOutput(
            notch_code=code,
            notes=tuple([on_wire(note, number.raw(value, note.q)) for note, value in told]),
            overflow_flags=number.counters.flags,
            # A law has no branches: every step costs the same.
            cycles=self.cost.cycles,
            error_raw=number.raw(error, SPEED_Q),
        )

    @property
    def commands(self) -> tuple[CommandCode, ...]:
        """The notch."""
        return (CommandCode("notch", NOTCH_Q, "notch"),)

    @property
    def wire(self) -> Mapping[str, Interval]:
        """Smallest and largest raw value of what :meth:`step` may be given."""
        return WIRE

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero since the controller was made."""
        return self._number.counters

    def kept(self) -> dict[str, Any] | None:
        """Key and values of the law's memory after the last step; None for a law that keeps none.

        :raises InputError: the law has raised, or answers what no file can hold.
        """
        return self._loop.kept()

    def sent(self, notch_code: int) -> None:
        """Tell the law the notch (1/256) really sent, if it differs from the result of :meth:`step`.

        The internal model is driven by the notch really sent; without a call it uses the result of ``step``. Before the
        first step the call has no effect.
        """
        if self._code is not None and notch_code != self._code:
            self._code = notch_code
            try:
                self._loop.sent(self._number.from_raw(notch_code, NOTCH_Q))
            except Exception as fault:
                # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
                raise _failed(self._loop, self.telemetry, self._number, fault, "with_sent") from fault
            self.telemetry.take(self._number)


class BatchController:
    """Controllers of N trains on the same scenario, stepped together; same law, same results as N controllers.

    Parameters, attributes and errors as :class:`Controller`, plus ``trains``, the number N.
    """

    def __init__(
        self,
        scenario: Scenario,
        trains: int,
        law: LawSpec | None = None,
    ) -> None:
        law = law or LawSpec()
        self._number = make(law.arithmetic, batch=True)
        self._loop, _, self.telemetry, self.cost = _watched(scenario, law, self._number)
        self._trains = trains

    def step(
        self,
        k: int,
        speed_01mmps: NDArray[np.int64],
        position_01mm: NDArray[np.int64],
        balise: BaliseReading[Any] = NO_BALISE,
    ) -> BatchOutput:
        """One control period of all trains; arguments as :meth:`Controller.step`, arrays of shape (N,)."""
        number = self._number
        try:
            inputs, outputs = self._loop.step(k, speed_01mmps, position_01mm, balise)
        except Exception as fault:
            # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
            raise _failed(self._loop, self.telemetry, number, fault, "step") from fault
        told = zip(self._loop.law.notes, outputs.notes, strict=True)
        notes = tuple(on_wire_batch(note, self._raw(value, note.q)) for note, value in told)
        error = number.sub(inputs.set_point, inputs.speed)
        self.telemetry.take(number)
        return BatchOutput(
            notch_code=self._raw(outputs.notch, NOTCH_Q),
            notes=notes,
            error_raw=self._raw(error, SPEED_Q),
            overflow_flags=number.counters.flags,
        )

    def sent(self, notch_code: NDArray[np.int64]) -> None:
        """Like :meth:`Controller.sent`, for all trains, after the first step."""
        try:
            self._loop.sent(self._number.from_raw(notch_code, NOTCH_Q))
        except Exception as fault:
            # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
            raise _failed(self._loop, self.telemetry, self._number, fault, "with_sent") from fault
        self.telemetry.take(self._number)

    def _raw(self, value: Any, q: int) -> NDArray[np.int64]:
        return np.broadcast_to(np.asarray(self._number.raw(value, q), dtype=np.int64), (self._trains,))
