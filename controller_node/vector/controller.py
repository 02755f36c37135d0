"""A law for several units on one arithmetic: raw integers of the bus in, raw integers out, once per control period."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Arithmetic, Constant, T
from railhil.controller_node.law_controller import CommandCode, LawController
from railhil.controller_node.law_loop import LawLoop
from railhil.controller_node.laws import law_class
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.vector.law import Answer, Interface, VectorLaw, raw_range
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec


@dataclass(frozen=True, slots=True)
class VectorOutput:
    """Result of one control period: raw integers, in the order of the interface.

    ``overflow_flags``: bit 0 wrap, bit 1 saturation, bit 2 division by zero, each since the start of the run.
    """

    commands: tuple[int, ...]
    notes: tuple[int, ...]
    overflow_flags: int


class VectorLoop(LawLoop[T]):
    """Law and state on one arithmetic.

    :raises InputError: there is no such law for this system; or as :class:`~railhil.controller_node.law_loop.LawLoop`.
    """

    def __init__(self, scenario: AnyScenario, law: LawSpec, arithmetic: Arithmetic[T]) -> None:
        system = scenario.installed_system
        self.interface: Interface = system.part("interface")
        kind = law_class(law, scenario, VectorLaw)
        period_s = scenario.timing.control_period_ns / 1e9
        if not arithmetic.wide:
            refuse_wide_readings(self.interface)
        super().__init__(scenario, law, arithmetic, kind, f"{period_s:g} s on {scenario.name}")
        self._bounds = [
            tuple(arithmetic.const(Constant(f"{command.name}_{end}", raw / 2**command.q, command.q, "port table"))
                  for end, raw in zip(("lowest", "highest"), command.bounds, strict=True))
            for command in self.interface.commands
        ]  # fmt: skip

    def inputs(self, raws: Sequence[Any]) -> tuple[T, ...]:
        """The law's inputs from raw integers of the bus."""
        ar = self.arithmetic
        return tuple(
            ar.note(reading.name, ar.from_raw(raw, reading.q), reading.q, reading.unit)
            for reading, raw in zip(self.interface.readings, raws, strict=True)
        )

    def step(self, raws: Sequence[Any]) -> tuple[tuple[T, ...], Answer[T]]:
        """One control period; the first one also makes the law's state. Returns the law's inputs and its answer."""
        if self.compiled is not None:
            done = self._step_compiled(raws)
            if done is not None:
                return done
        inputs = self.inputs(raws)
        if self.state is None:
            self.state = self.law.start(inputs)
        self.state, answer = self.compute_answer(self.state, inputs)
        return inputs, answer

    def _step_compiled(self, raws: Sequence[Any]) -> tuple[tuple[T, ...], Answer[T]] | None:
        ar = self.arithmetic
        wire = tuple([ar.from_raw(raw, item.q) for item, raw in zip(self.interface.readings, raws, strict=True)])
        done = self.step_compiled(wire)
        if done is None:
            return None
        inputs, answer = done
        commands = len(self.interface.commands)
        return inputs, Answer(answer[:commands], answer[commands:])

    def sent(self, raws: Sequence[Any]) -> None:
        """Pass the commands really sent, raw, to the law."""
        commands = zip(self.interface.commands, raws, strict=True)
        told = [self.arithmetic.from_raw(raw, command.q) for command, raw in commands]
        self.state = self.law.with_sent(self.state, told)

    def compute_answer(self, state: Any, inputs: Any) -> tuple[Any, Any]:
        """The law's step; its commands are rounded and limited to their bounds."""
        ar = self.arithmetic
        after, answer = self.law.step(state, inputs)
        commands = tuple(
            ar.note(command.name, ar.clip(_round(ar, value, command.law_q, command.q), high, low), command.q,
                    command.unit)
            for command, value, (low, high) in zip(self.interface.commands, answer.commands, self._bounds, strict=True)
        )  # fmt: skip
        notes = tuple(
            ar.note(note.name, value, note.law_q, note.unit)
            for note, value in zip(self.interface.notes, answer.notes, strict=True)
        )
        return after, Answer(commands, notes)

    def trace_inputs(self, tracer: Tracer) -> Any:
        """The readings."""
        return self.inputs([tracer.input(reading.name, reading.q) for reading in self.interface.readings])

    def trace_commands(self, tracer: Tracer) -> Any:
        """The commands."""
        return tuple(tracer.input(command.name, command.q) for command in self.interface.commands)


def _round(ar: Arithmetic[T], value: T, law_q: int, q: int) -> T:
    return ar.quantise(value, law_q, q) if q < law_q else ar.convert(value, law_q, q)


def refuse_wide_readings(interface: Interface) -> None:
    """Refuse a reading that does not fit an int32: in fixed point and in C a reading is an int32, as on the chip.

    :raises InputError: there is such a reading.
    """
    for reading in interface.readings:
        low, high = raw_range(reading.telegram, reading.field)
        if low < INT32_MIN or high > INT32_MAX:
            found = Words(f"{reading.telegram.PORT}.{reading.field} with {low} to {high}")
            allowed = f"{INT32_MIN} to {INT32_MAX} in fixed point and in C"
            raise InputError("interface", f"reading {reading.name}", found, allowed)


class VectorController(LawController):
    """Controller of a system whose laws have an ``Interface``."""

    loop = VectorLoop

    def __init__(
        self,
        scenario: AnyScenario,
        law: LawSpec,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
    ) -> None:
        #: Inputs and outputs of the law.
        self.interface: Interface = scenario.installed_system.part("interface")
        self.wire = {item.name: raw_range(item.telegram, item.field) for item in self.interface.readings}
        self.commands = tuple(CommandCode(item.name, item.q, item.unit) for item in self.interface.commands)
        super().__init__(scenario, law, arithmetic, may_wrap=may_wrap)

    def step(self, raws: Sequence[int]) -> VectorOutput:
        """One control period, from one raw integer for each reading."""
        number, interface = self.arithmetic, self.interface
        try:
            _, answer = self._loop.step(raws)
        except Exception as fault:
            # A law is plug-in code: any exception is reported as the law's, with file and line.
            raise self.failed(fault, "step") from fault
        commands = zip(interface.commands, answer.commands, strict=True)
        notes = zip(interface.notes, answer.notes, strict=True)
        output = VectorOutput(
            tuple(number.raw(value, command.q) for command, value in commands),
            tuple(number.raw(value, note.law_q) >> (note.law_q - note.q) for note, value in notes),
            number.counters.flags,
        )
        self.telemetry.take(number)
        return output

    def sent(self, *raws: int) -> None:
        """Pass the commands really sent to the law if they differ from those that :meth:`step` returned.

        :param raws: one raw integer for each command.
        """
        if self._loop.state is None:
            return
        try:
            self._loop.sent(raws)
        except Exception as fault:
            # A law is plug-in code: any exception is reported as the law's, with file and line.
            raise self.failed(fault, "with_sent") from fault
        self.telemetry.take(self.arithmetic)
