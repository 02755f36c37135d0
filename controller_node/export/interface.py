"""The export of a law for several units: readings and commands are those of its system's ``Interface``."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
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
from railhil.controller_node.export.headers import octets
from railhil.controller_node.export.text import SHARED, Names, identifier, literal, wide
from railhil.controller_node.program.model import Value
from railhil.controller_node.program.tracer import record_loop
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.controller_node.vector.law import Interface, raw_range
from railhil.controller_node.vector.node import ports_of, refuse_indexing, sources_of
from railhil.dbc import Port, Signal
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

_PERIODS = 80
_SENT_EVERY = 7
#: Largest number of control periods that the log takes from a run of the bench.
_PLAYED_MAX = 2000
_COMMENT_COLUMNS = 110
#: Octets of process data in the longest telegram.
_OCTETS_MAX = 32
#: A ``railhil_signal_t`` that belongs to no port.
_NOWHERE = "{-1, 0, 0, 0}"


class _Listener(VectorController):
    """The law's controller; it records its control periods."""

    def __init__(self, control: InterfaceControl) -> None:
        super().__init__(control.scenario, control.law)
        self.periods: list[Period] = []
        self._untold = (0,) * len(control.told)

    def step(self, raws: Sequence[int]) -> Any:
        self.periods.append(Period(0 if self.periods else FLAG_BEGIN, tuple(raws), self._untold))
        return super().step(raws)

    def sent(self, *raws: int) -> None:
        last = self.periods[-1]
        self.periods[-1] = last._replace(flags=last.flags | FLAG_SENT, told=raws)
        super().sent(*raws)


class InterfaceControl(Control):
    """See :class:`railhil.controller_node.export.control.Control`; the system has a part ``interface``."""

    folder = f"{SHARED}/interface"
    sources = ("railhil_law.c",)
    headers = ("railhil_law.h",)

    def __init__(self, scenario: AnyScenario, law: LawSpec) -> None:
        super().__init__(scenario, law)
        self.system = system = scenario.installed_system
        self._interface: Interface = system.part("interface")
        refuse_indexing(system, law)
        self.programs = record_loop(VectorLoop, scenario, replace(law, memory=None))
        interface = self._interface
        readings, commands = Names(), Names()
        given = [(reading.name, readings.new(reading.name)) for reading in interface.readings]
        told = [(command.name, commands.new(command.name)) for command in interface.commands]
        self.given = tuple(Word(name, parameter, parameter) for name, parameter in given)
        self.told = tuple(Word(name, parameter, f"sent.{parameter}") for name, parameter in told)
        self.record = (*self.given, *self.told)
        self._leaves: dict[str, str] = {f"in[{i}]": reading.name for i, reading in enumerate(interface.readings)}
        self._leaves |= {f"out.commands[{i}]": command.name for i, command in enumerate(interface.commands)}
        self._leaves |= {f"out.notes[{i}]": note.name for i, note in enumerate(interface.notes)}
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

    def wires(self) -> dict[str, Wire]:
        """Readings and commands are the integers of their signals, notes have the law's own formats."""
        interface = self._interface
        given, told = ([word.parameter for word in side] for side in (self.given, self.told))
        found = wires_of(interface, given, told)
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

    def loop(self, number: Arithmetic[int]) -> Loop:
        return VectorLoop(self.scenario, replace(self.law, memory=None), number)

    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """A run of the bench, random readings over their whole range, and the limits of the readings."""
        if play is not None:
            listener = _Listener(self)
            play(listener)
            yield listener.periods[:_PLAYED_MAX]
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
        interface = self._interface
        _, sent = self.ports()
        return [
            Define("SOURCE_COUNT", str(len(self._signs())), "ports with readings"),
            Define("CHECK_COUNT", str(len(self._checks())), "check variables of these ports; at least 1"),
            Define("READING_COUNT", str(len(interface.readings))),
            Define("COMMAND_COUNT", str(len(interface.commands))),
            Define("NOTE_COUNT", str(len(self.macros())), "notes"),
            Define("TOLD_COUNT", str(len(self._told())), "notes; overflow flags and number of steps of each status"),
            Define("ANSWER_COUNT", str(len(sent) - 1), "ports with commands or a status"),
        ]

    def tables(self) -> list[str]:
        """Positions of all numbers in the process data, and the process data before they are written."""
        interface = self._interface
        _, sent = self.ports()
        kinds = {kind.PORT: kind for kind in (*(item.telegram for item in interface.commands), *interface.statuses)}
        answers = [kinds[port.name] for port in sent if port.name in kinds]
        safe = ", ".join(literal(command.safe) for command in interface.commands)
        ages = ", ".join(wide(interface.age_max_ns(reading)) for reading in interface.readings)
        blanks = [line for kind in answers for line in ("    {", *octets(kind().encode()), "    },")]
        return [
            "/* A number in the process data of a port: first bit (0: the highest of the first octet), number of bits",
            " * (0: the telegram does not contain it). */",
            "typedef struct {",
            "    int port;",
            "    unsigned first_bit;",
            "    unsigned bits;",
            "    int is_signed;",
            "} railhil_signal_t;",
            "",
            "/* Life sign of each port with readings, and its check variables. */",
            *_table("signs", "SOURCE_COUNT", self._signs()),
            *_table("checks", "CHECK_COUNT", self._checks()),
            *_table("readings", "READING_COUNT", [_place(item.telegram, item.field) for item in interface.readings]),
            "/* Largest age of each reading in ns; above it safe commands. */",
            f"static const int64_t railhil_ages_ns[RAILHIL_READING_COUNT] = {{{ages}}};",
            "",
            *_table("commands", "COMMAND_COUNT", [_place(item.telegram, item.field) for item in interface.commands]),
            "/* Commands sent while a reading is missing or too old. */",
            f"static const int32_t railhil_safe[RAILHIL_COMMAND_COUNT] = {{{safe}}};",
            "",
            *_table("told", "TOLD_COUNT", self._told()),
            "/* For each port that is sent: its life sign, and its process data before the signals are written. */",
            *_table("lives", "ANSWER_COUNT", [_place(kind, "life") for kind in answers]),
            f"static const unsigned char railhil_blanks[RAILHIL_ANSWER_COUNT][{_OCTETS_MAX}] = {{",
            *blanks,
            "};",
            "",
        ]

    def _told(self) -> list[str]:
        """Positions of the notes, then of overflow flags and number of steps in each status."""
        interface = self._interface
        notes = [(interface.status_of(note), note.field) for note in interface.notes]
        # C does not allow an empty array.
        statuses = interface.statuses or (None,)
        counts = [(status, field) for status in statuses for field in ("overflow_flags", "step_count")]
        return [_place(status, field) for status, field in (*(note for note in notes if note[0]), *counts)]

    def _signs(self) -> list[str]:
        return [_row(port, life_of(kind)) for port, kind in sources_of(self._interface).items()]

    def _checks(self) -> list[str]:
        sources = sources_of(self._interface).items()
        # C does not allow an empty array.
        return [_row(port, signal) for port, kind in sources for signal in checks_of(kind).values()] or [_NOWHERE]

    def places(self, source: Source) -> dict[str, str]:
        out = [column for column in source.columns if column.startswith("out.")]
        return {
            "GIVEN": ", ".join(f"law->raws[{i}]" for i in range(len(self.given))),
            "COMMANDS": ", ".join(f"law->{column}" for column in out[: len(self.told)]),
            "SAFE": ", ".join(f"railhil_safe[{i}]" for i in range(len(self.told))),
            "TOLD": ", ".join(
                [
                    *(f"{macro}(law->out)" for macro in source.macros),
                    *["flags, (int32_t)(law->steps & 0xFFFFu)"] * max(1, len(self._interface.statuses)),
                ]
            ),
        }


def wires_of(interface: Interface, given: Iterable[str], told: Iterable[str]) -> dict[str, Wire]:
    """Readings, commands and commands sent by their columns.

    :param given: columns of the readings.
    :param told: those of the commands, without the word before.
    """
    found = {column: Wire.of(item.telegram, item.field) for column, item in zip(given, interface.readings, strict=True)}
    for column, item in zip(told, interface.commands, strict=True):
        wire = Wire.of(item.telegram, item.field)
        found |= {f"out.{column}": wire, f"sent.{column}": Wire(f"sent instead of out.{column}")}
    return found


def _place(kind: type[Telegram] | None, field: str) -> str:
    """Position of a field in its telegram, as a C initialiser."""
    signal = dict(kind.signals()).get(field) if kind else None
    return _NOWHERE if kind is None or signal is None else _row(kind.PORT, signal)


def _row(port: str, signal: Signal | None) -> str:
    """A ``railhil_signal_t`` as a C initialiser; ``signal`` is None for a port without this signal."""
    if signal is None:
        return f"{{RAILHIL_{port}, 0, 0, 0}}"
    return f"{{RAILHIL_{port}, {signal.first_bit}, {signal.length}, {int(signal.signed)}}}"


def _table(name: str, size: str, rows: Sequence[str]) -> list[str]:
    opening = f"static const railhil_signal_t railhil_{name}[RAILHIL_{size}] = {{"
    return [opening, *(f"    {row}," for row in rows), "};", ""]


def _end(generator: Generator, low: int, high: int) -> int:
    """One end of an interval, or a value from -1 to 1."""
    return (low, max(low, -1), 0, min(high, 1), high)[generator.between(0, 4)]


def _lines(text: str) -> str:
    """Text wrapped into lines of a C comment."""
    return "\n * ".join(textwrap.wrap(text, _COMMENT_COLUMNS))
