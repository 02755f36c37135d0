"""The export of a law for several units: its system's ``Interface`` gives readings and commands."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from railhil.bus.acceptance import checks_of, life_of
from railhil.bus.layout import Telegram
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Arithmetic
from railhil.controller_node.export.control import (
    FLAG_BEGIN,
    FLAG_SENT,
    Comments,
    Control,
    Define,
    Generator,
    Loop,
    Macro,
    Period,
    Play,
    Source,
    Wire,
    Word,
)
from railhil.controller_node.export.ports import CTelegram
from railhil.controller_node.export.text import SHARED, Names, literal, wide
from railhil.controller_node.program.model import Value, identifier
from railhil.controller_node.program.tracer import record_loop
from railhil.controller_node.vector.controller import VectorController, VectorLoop, refuse_wide_readings
from railhil.controller_node.vector.law import Interface, raw_range
from railhil.controller_node.vector.node import ports_of, refuse_indexing, sources_of
from railhil.dbc import Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

_PERIODS = 80
_SENT_EVERY = 7
#: Largest number of control periods that the log takes from a run of the bench.
_PLAYED_MAX = 2000
_COMMENT_COLUMNS = 110


class _LogFull(Exception):
    """The log has all control periods that it takes from a run."""


class _Listener(VectorController):
    """The law's controller; it records its control periods.

    :raises _LogFull: in :meth:`step`.
    """

    def __init__(self, control: InterfaceControl) -> None:
        super().__init__(control.scenario, control.law)
        self.periods: list[Period] = []
        self._untold = (0,) * len(control.told)

    def step(self, raws: Sequence[int]) -> Any:
        if len(self.periods) == _PLAYED_MAX:
            raise _LogFull
        self.periods.append(Period(0 if self.periods else FLAG_BEGIN, tuple(raws), self._untold))
        return super().step(raws)

    def sent(self, *raws: int) -> None:
        last = self.periods[-1]
        self.periods[-1] = last._replace(flags=last.flags | FLAG_SENT, told=raws)
        super().sent(*raws)


class InterfaceControl(Control):
    """See :class:`railhil.controller_node.export.control.Control`; the system has a part ``interface``."""

    folder = f"{SHARED}/interface"
    arithmetics = ("iq", "float32")
    sources = ("railhil_telegrams.c",)
    headers = ("railhil_guard.h",)

    def __init__(self, scenario: AnyScenario, law: LawSpec) -> None:
        super().__init__(scenario, law)
        self.system = system = scenario.installed_system
        self._interface: Interface = system.part("interface")
        refuse_indexing(system, law)
        is_wide = law.arithmetic == "float32"
        if is_wide:
            refuse_wide_readings(self._interface)
        self.programs = record_loop(VectorLoop, scenario, replace(law, memory=None), wide=is_wide)
        interface = self._interface
        self.given, self.told = _words(interface)
        self.record = (*self.given, *self.told)
        self.commands = tuple(f"out.commands[{i}]" for i in range(len(self.told)))
        self._leaves: dict[str, str] = {f"in[{i}]": reading.name for i, reading in enumerate(interface.readings)}
        self._leaves |= dict(zip(self.commands, (command.name for command in interface.commands), strict=True))
        self._leaves |= {f"out.notes[{i}]": note.name for i, note in enumerate(interface.notes)}
        self.formats = {leaf: command.q for leaf, command in zip(self.commands, interface.commands, strict=True)}
        self.formats |= {f"out.notes[{i}]": note.law_q for i, note in enumerate(interface.notes)}
        self._units: dict[str, str] = {f"in[{i}]": reading.unit for i, reading in enumerate(interface.readings)}

    def comments(self, name: str) -> Comments:
        interface = self._interface
        use = (
            f"In each control period call {name}_inputs, in the first one also {name}_start, then {name}_step. The "
            f"result is the commands in out, each the raw integer of its signal. If other commands are sent, pass them "
            f"to {name}_sent."
        )
        commands = [
            f"{word.parameter}: {command.telegram.PORT} {command.field}, {command.bounds[0]} to {command.bounds[1]}, "
            f"safe {command.safe}"
            for word, command in zip(self.told, interface.commands, strict=True)
        ]
        readings = ", ".join(f"{reading.telegram.PORT} {reading.field}" for reading in interface.readings)
        return Comments(
            use=(*textwrap.wrap(use, _COMMENT_COLUMNS), *commands),
            inputs=_lines(f"Raw integers of {readings}"),
            sent="The commands really sent since the last control period, raw integers",
            status=", ".join(kind.PORT for kind in interface.statuses),
            what="commands",
            other="commands other than the law's were",
            constants="its scenario and its law",
            units="commands as raw integers",
            node="readings and their ages, commands, notes",
            record=_lines(f"{', '.join(word.column for word in self.record)}, raw integers of their signals"),
        )

    def member(self, leaf: str) -> str:
        return self._leaves[leaf]

    def input_unit(self, leaf: str, value: Value) -> str:
        return self._units[leaf]

    @classmethod
    def wires(cls, scenario: AnyScenario) -> dict[str, Wire]:
        """Readings and commands are the integers of their signals, notes have the law's own formats."""
        interface: Interface = scenario.installed_system.part("interface")
        given, told = _words(interface)
        readings = zip(given, interface.readings, strict=True)
        found = {
            word.column: Wire.of(item.telegram, item.field, identifier(item.name), 2.0**-item.q)
            for word, item in readings
        }
        for word, item in zip(told, interface.commands, strict=True):
            out, name, one = f"out.{word.parameter}", identifier(item.name), 2.0**-item.q
            sent = Wire(f"sent instead of {out}", quantity=f"sent_{name}", one=one)
            found |= {out: Wire.of(item.telegram, item.field, name, one), word.column: sent}
        for note in interface.notes:
            words = " ".join(filter(None, (f"1/2^{note.law_q}", note.unit)))
            found[f"out.{identifier(note.name)}"] = Wire(f"1 is {words}")
        return found

    def macros(self) -> list[Macro]:
        interface = self._interface
        found = []
        for number, note in enumerate(interface.notes):
            status = interface.status_of(note)
            if status is None:
                continue
            low, high = raw_range(status, note.field)
            words = ", ".join(filter(None, (note.field, f"1/2^{note.q}", note.unit)))
            held = (max(low, INT32_MIN), min(high, INT32_MAX))
            found.append(Macro(identifier(note.name), f"out.notes[{number}]", note.law_q - note.q, held, words))
        return found

    def loop(self, number: Arithmetic[Any]) -> Loop:
        return VectorLoop(self.scenario, replace(self.law, memory=None), number)

    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """A run of the bench, random readings over their whole range, and the limits of the readings."""
        if play is not None:
            listener = _Listener(self)
            with suppress(_LogFull):
                play(listener)
            yield listener.periods
        yield self._made(1, lambda generator, low, high: generator.between(low, high))
        yield self._made(2, _end)

    def _made(self, seed: int, choose: Callable[[Generator, int, int], int]) -> Iterator[Period]:
        """Random readings; in some periods commands other than the law's are sent."""
        generator = Generator(seed)
        ranges = [raw_range(reading.telegram, reading.field) for reading in self._interface.readings]
        bounds = [command.bounds for command in self._interface.commands]
        for k in range(_PERIODS):
            given, told = (
                tuple(choose(generator, low, high) for low, high in intervals) for intervals in (ranges, bounds)
            )
            flags = (FLAG_BEGIN if k == 0 else 0) | (FLAG_SENT if k % _SENT_EVERY == 3 else 0)
            yield Period(flags, given, told)

    def ports(self) -> tuple[list[Port], list[Port]]:
        return ports_of(self.contract, self._interface)

    def constants(self) -> list[Define]:
        return [Define("SOURCE_COUNT", str(len(sources_of(self._interface))), "ports with readings")]

    def tables(self) -> list[str]:
        """Largest ages of the readings, and the safe commands."""
        interface = self._interface
        ages_ns = [
            min(interface.age_max_ns(item) for item in interface.readings if port == item.telegram.PORT)
            for port in sources_of(interface)
        ]
        safe = ", ".join(literal(command.safe) for command in interface.commands)
        return [
            "/* Largest age of the readings of each port in ns; above it safe commands. */",
            f"static const int64_t railhil_ages_ns[RAILHIL_SOURCE_COUNT] = {{{', '.join(map(wide, ages_ns))}}};",
            "",
            "/* Commands sent while a reading is missing or too old. */",
            f"static const int32_t railhil_safe[RAILHIL_COMMAND_COUNT] = {{{safe}}};",
            "",
        ]

    def _taken(self, constants: Mapping[str, str]) -> list[str]:
        """The cases of the ports with readings."""
        lines = []
        for source, (port, kind) in enumerate(sources_of(self._interface).items()):
            telegram, signals, life = CTelegram(kind.port()), dict(kind.signals()), life_of(kind)
            sign = "NO_LIFE" if life is None else f"(int){telegram.member(life)}"
            checks = [f"{telegram.member(check)} == RAILHIL_CHECK_CORRECT" for check in checks_of(kind).values()]
            readings = [
                f"            guard->raws[{number}] = (int32_t){telegram.member(signals[item.field])};"
                for number, item in enumerate(self._interface.readings)
                if port == item.telegram.PORT
            ]
            lines += [
                f"    case {constants[port]}: {{",
                f"        const {telegram.type} telegram = railhil_unpack_{telegram.name}(process);",
                f"        const int is_correct = {' && '.join(checks) or '1'};",
                f"        if (accept(guard, {source}, now_ns, {sign}, is_correct, counts)) {{",
                *readings,
                "        }",
                "        break;",
                "    }",
            ]
        return lines

    def _answers(self, source: Source, constants: Mapping[str, str]) -> list[str]:
        """The cases of the ports with commands or a status."""
        interface, lines = self._interface, []
        in_status = [note for note in interface.notes if interface.status_of(note)]
        noted = [(note, f"{macro}(law->out)") for note, macro in zip(in_status, source.macros, strict=True)]
        for kind in dict.fromkeys((*(item.telegram for item in interface.commands), *interface.statuses)):
            telegram = CTelegram(kind.port())
            lines += [
                f"    case {constants[kind.PORT]}: {{",
                f"        {telegram.type} telegram = railhil_new_{telegram.name}();",
                *_set(kind, {field: str(value) for field, value in kind().items() if not _is_default(kind, field)}),
            ]
            if kind in interface.statuses:
                told = {note.field: value for note, value in noted if interface.status_of(note) is kind}
                lines += [
                    *_set(kind, {"step_count": "(int32_t)(law->steps & 0xFFFFu)"}),
                    "        if (law->steps != 0) {",
                    *(f"    {line}" for line in _set(kind, {**told, "overflow_flags": "railhil_law_flags(law)"})),
                    "        }",
                ]
            else:
                commands = enumerate(interface.commands)
                lines += [
                    "        railhil_law_command(law, clock, commands, counts);",
                    *_set(kind, {item.field: f"commands[{n}]" for n, item in commands if item.telegram is kind}),
                ]
            lines += [
                *_set(kind, {"life": "railhil_law_life(law, port)"}),
                f"        railhil_pack_{telegram.name}(&telegram, process);",
                "        break;",
                "    }",
            ]
        return lines

    def places(self, source: Source, constants: Mapping[str, str]) -> dict[str, str]:
        answers = self._answers(source, constants)
        return {"TAKEN": "\n".join(self._taken(constants)), "ANSWERS": "\n".join(answers)}


def _is_default(kind: type[Telegram], field: str) -> bool:
    """Whether a new telegram of a class has the value of the port table."""
    return bool(getattr(kind(), field) == dict(kind.signals())[field].default)


def _set(kind: type[Telegram], values: Mapping[str, str]) -> list[str]:
    """Statements that give values to the fields that a telegram has."""
    telegram, signals = CTelegram(kind.port()), dict(kind.signals())
    return [f"        {telegram.set(signals[field], value)}" for field, value in values.items() if field in signals]


def _end(generator: Generator, low: int, high: int) -> int:
    """One end of an interval, or a value from -1 to 1."""
    return (low, max(low, -1), 0, min(high, 1), high)[generator.between(0, 4)]


def _words(interface: Interface) -> tuple[tuple[Word, ...], tuple[Word, ...]]:
    """The readings and the commands as words."""
    readings, commands = Names(), Names()
    given = [(reading.name, readings.new(reading.name)) for reading in interface.readings]
    told = [(command.name, commands.new(command.name)) for command in interface.commands]
    return (
        tuple(Word(name, parameter, parameter) for name, parameter in given),
        tuple(Word(name, parameter, f"sent.{parameter}") for name, parameter in told),
    )


def _lines(text: str) -> str:
    """Text wrapped into lines of a C comment."""
    return "\n * ".join(textwrap.wrap(text, _COMMENT_COLUMNS))
