"""A law for several units on one arithmetic: raw integers of the bus in, raw integers out, once per control period."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.common.plug_ins import plugged_in
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Arithmetic, Constant, Counters, T
from railhil.controller_node.compiled_law import compile_law
from railhil.controller_node.cost import cost_of
from railhil.controller_node.law_controller import CommandCode
from railhil.controller_node.law_state import LawState
from railhil.controller_node.laws import find
from railhil.controller_node.laws.fault import law_fault, place
from railhil.controller_node.laws.memory import kept, memory_arguments
from railhil.controller_node.laws.parameters import law_parameters
from railhil.controller_node.program.model import LawProgram, Value
from railhil.controller_node.program.ranges import refuse_wraps
from railhil.controller_node.program.record import recorded
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.telemetry import Telemetry
from railhil.controller_node.vector.law import Answer, Interface, VectorLaw, raw_range
from railhil.scenarios.memory import Memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System, system_named


@dataclass(frozen=True, slots=True)
class VectorOutput:
    """Result of one control period: raw integers, in the order of the interface.

    ``overflow_flags``: bit 0 wrap, bit 1 saturation, bit 2 division by zero, each since the start of the run.
    """

    commands: tuple[int, ...]
    notes: tuple[int, ...]
    overflow_flags: int


class VectorLoop(LawState[T]):
    """Law and state on one arithmetic.

    :raises InputError: there is no such law for this system, it cannot be constructed for this scenario, or the
        parameters or the memory belong to another law.
    """

    def __init__(
        self,
        system: System,
        scenario: AnyScenario,
        law: str,
        arithmetic: Arithmetic[T],
        given: ParameterSet | None,
        memory: Memory | None,
    ) -> None:
        super().__init__(arithmetic)
        self._scenario = scenario
        self._memory = memory
        #: Name by which the law was requested.
        self.name = law
        self.interface: Interface = system.part("interface")
        kind = find(law, system.laws, VectorLaw)
        if kind.solver and not arithmetic.solves:
            allowed = "float64: this law is computed by a solver, which has no fixed point, single precision or C"
            raise InputError("controller", f"{law}, arithmetic", Words(arithmetic.name), allowed)
        if kind.floating and not arithmetic.wide:
            allowed = "float64 or float32: this law has no fixed-point formats"
            raise InputError("controller", f"{law}, arithmetic", Words("fixed point"), allowed)
        parameters = law_parameters(law, kind, given)
        try:
            remembered = memory_arguments(law, kind, scenario, memory)
            with plugged_in():
                self.law: VectorLaw[T, Any] = kind(arithmetic, scenario, parameters, *remembered)
        except InputError:
            raise
        except Exception as error:
            # A law is plug-in code and may raise anything.
            at = place(kind, error)
            cause = f"{type(error).__name__}: {error}{f', at {at}' if at else ''}"
            allowed = f"a law that can be made for {scenario.name}"
            raise InputError("controller", law, Words("a law that fails at its start"), allowed, cause) from error
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
            done = self._compiled_step(raws)
            if done is not None:
                return done
        inputs = self.inputs(raws)
        if self.state is None:
            self.state = self.law.start(inputs)
        self.state, answer = self.answered(self.state, inputs)
        return inputs, answer

    def _compiled_step(self, raws: Sequence[Any]) -> tuple[tuple[T, ...], Answer[T]] | None:
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

    def answered(self, state: Any, inputs: tuple[T, ...]) -> tuple[Any, Answer[T]]:
        """The law's step; its commands are rounded and limited to their bounds."""
        ar = self.arithmetic
        after, answer = self.law.step(state, inputs)
        commands = tuple(
            ar.note(command.name, ar.clip(_rounded(ar, value, command.law_q, command.q), high, low), command.q,
                    command.unit)
            for command, value, (low, high) in zip(self.interface.commands, answer.commands, self._bounds, strict=True)
        )  # fmt: skip
        notes = tuple(
            ar.note(note.name, value, note.law_q, note.unit)
            for note, value in zip(self.interface.notes, answer.notes, strict=True)
        )
        return after, Answer(commands, notes)

    def kept(self) -> dict[str, Any] | None:
        """The law's memory to keep after the run, see :func:`railhil.controller_node.laws.memory.kept`."""
        return kept(self.name, self.law, self._scenario, self.state, self._memory)


def _rounded(ar: Arithmetic[T], value: T, law_q: int, q: int) -> T:
    return ar.quantise(value, law_q, q) if q < law_q else ar.convert(value, law_q, q)


def _refuse_wide_readings(interface: Interface) -> None:
    """Refuse a reading that does not fit an int32: in fixed point a reading is an int32, as on the chip.

    :raises InputError: there is such a reading.
    """
    for reading in interface.readings:
        low, high = raw_range(reading.telegram, reading.field)
        if low < INT32_MIN or high > INT32_MAX:
            found = Words(f"{reading.telegram.PORT}.{reading.field} with {low} to {high}")
            allowed = f"{INT32_MIN} to {INT32_MAX} in fixed point"
            raise InputError("interface", f"reading {reading.name}", found, allowed)


class _Traced:
    """A vector loop with the interface that the recorder of programs expects of a law."""

    def __init__(self, loop: VectorLoop[Value]) -> None:
        self.start = loop.law.start
        self.step = loop.answered
        self.with_sent = loop.law.with_sent


def vector_program(
    system: System, scenario: AnyScenario, law: str, given: ParameterSet | None, memory: Memory | None, wide: bool
) -> LawProgram:
    """Programs of a law for several units, see :func:`railhil.controller_node.program.record.record`."""
    tracer = Tracer(wide)
    loop: VectorLoop[Value] = VectorLoop(system, scenario, law, tracer, given, memory)
    interface = loop.interface
    if not wide:
        _refuse_wide_readings(interface)

    def inputs() -> tuple[Value, ...]:
        return loop.inputs([tracer.input(reading.name, reading.q) for reading in interface.readings])

    def told() -> tuple[Value, ...]:
        return tuple(tracer.input(command.name, command.q) for command in interface.commands)

    return recorded(tracer, law, type(loop.law), _Traced(loop), inputs, told)


class VectorController:
    """Controller of one system, see :class:`railhil.controller_node.law_controller.LawController`.

    :param law: a law of the system, with its options.
    :param arithmetic: a fresh arithmetic, used instead of the one that ``law`` names.
    :param may_wrap: accept also a law in which an operation may wrap.
    :raises InputError: as :class:`VectorLoop`; an operation of the law may wrap in fixed point for some reading. In
        :meth:`step` and :meth:`sent`: the law has raised.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        law: LawSpec,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
    ) -> None:
        system, name, given = system_named(scenario.system), law.controller, law.parameters
        self.arithmetic = self._number = number = arithmetic or make(law.arithmetic)
        self._loop: VectorLoop[Any] = VectorLoop(system, scenario, name, number, given, law.memory)
        self.law = self._loop.law
        #: Inputs and outputs of the law.
        self.interface = interface = self._loop.interface
        self.wire = {reading.name: raw_range(reading.telegram, reading.field) for reading in interface.readings}
        self.commands = tuple(CommandCode(item.name, item.q, item.unit) for item in interface.commands)
        self.program = program = vector_program(system, scenario, name, given, law.memory, number.wide)
        ranges = None
        if not number.wide and not may_wrap:
            period_s = scenario.timing.control_period_ns / 1e9
            ranges = refuse_wraps(program, self.law, f"at {period_s:g} s on {scenario.name}", self.wire)
        self._loop.compiled = compile_law(program, self.law, number, ranges)
        # Telemetry starts here, after the law's constants have been made.
        number.noted = []
        self.telemetry = Telemetry(program.quantities)
        self.cost = cost_of(program, number, scenario.timing.control_period_ns)

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero since the controller was made."""
        return self._number.counters

    @property
    def state(self) -> Any:
        """State of the law; None before the first step."""
        return self._loop.state

    def kept(self) -> dict[str, Any] | None:
        """See :meth:`railhil.controller_node.ato.controller.Controller.kept`."""
        return self._loop.kept()

    def step(self, raws: Sequence[int]) -> VectorOutput:
        """One control period, from one raw integer for each reading."""
        number, interface = self._number, self.interface
        try:
            _, answer = self._loop.step(raws)
        except Exception as fault:
            # A law is plug-in code: any exception is reported as the law's, with file and line.
            raise self._failed(fault, "step") from fault
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
            raise self._failed(fault, "with_sent") from fault
        self.telemetry.take(self._number)

    def _failed(self, error: Exception, function: str) -> InputError:
        named = self.telemetry.quantities[: len(self._number.noted or ())]
        last = named[-1].name if named else None
        return law_fault(self._loop.name, type(self._loop.law), error, function, last)
