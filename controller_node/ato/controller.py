"""The controller without the bus: integers from the bus in, notch code out, once per control period."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.ato.control_loop import NO_BALISE, POSITION_MAX_01MM, ControlLoop
from railhil.controller_node.ato.guard import SPEED_MAX_01MMPS
from railhil.controller_node.law_controller import CommandCode, LawController
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading
from railhil.controller_node.laws.note import on_wire
from railhil.controller_node.program.ranges import Interval
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

#: Range of the values passed to the law: larger speeds from the wire are refused, positions limited.
WIRE: dict[str, Interval] = {
    "speed_01mmps": (0, SPEED_MAX_01MMPS),
    "position_01mm": (-POSITION_MAX_01MM, POSITION_MAX_01MM),
    "balise": (0, 255),
    "balise_01mm": (-POSITION_MAX_01MM, POSITION_MAX_01MM),
    "balise_odometer_01mm": (-POSITION_MAX_01MM, POSITION_MAX_01MM),
}
COMMANDS: Final = (CommandCode("notch", NOTCH_Q, "notch"),)


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
        """All of its outputs, see :class:`railhil.controller_node.law_controller.Computed`."""
        return (self.notch_code,)


@mypyc_attr(allow_interpreted_subclasses=True)
class Controller(LawController):
    """Controller of one train; ``law`` None: the default law."""

    loop: ClassVar[type[Any]] = ControlLoop
    commands: tuple[CommandCode, ...] = COMMANDS
    wire: Mapping[str, Interval] = WIRE

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec | None = None,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
    ) -> None:
        super().__init__(scenario, law or LawSpec(), arithmetic, may_wrap=may_wrap)
        self._code: int | None = None
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
        number = self.arithmetic
        try:
            inputs, outputs = self._loop.step(k, speed_01mmps, position_01mm, balise)
        except Exception as fault:
            # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
            raise self.failed(fault, "step") from fault
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

    def sent(self, notch_code: int) -> None:
        """Tell the law the notch (1/256) really sent, if it differs from the result of :meth:`step`.

        The internal model is driven by the notch really sent; without a call it uses the result of ``step``. Before the
        first step the call has no effect.
        """
        if self._code is not None and notch_code != self._code:
            self._code = notch_code
            try:
                self._loop.sent(self.arithmetic.from_raw(notch_code, NOTCH_Q))
            except Exception as fault:
                # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
                raise self.failed(fault, "with_sent") from fault
            self.telemetry.take(self.arithmetic)
