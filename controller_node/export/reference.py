"""The reference log: control periods computed by the law itself in Python, for the exported C to recompute.

The recorded program from which the C is written runs in parallel; if its results differ from the law's, the export is
refused.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic import make
from railhil.controller_node.export.control import FLAG_SENT, Control, Period, Play, Word
from railhil.controller_node.export.text import comment
from railhil.controller_node.program.model import Evaluator, Kind, Program, Value, name_leaves

_MASK = 2**32 - 1


class Function(Protocol):
    """One function of a law, recorded or made from the recording."""

    def run(self, inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Outputs by name."""


class _Twin:
    """The law and its recorded program in parallel, from the start of a run.

    :param functions: makes what runs each function of the program; None: the recorded operations.
    :param made_from: what differs if the results do, "its recorded operations".
    :raises InputError: in :meth:`period`, if their results differ.
    """

    def __init__(
        self,
        control: Control,
        functions: Callable[[Program], Function] | None = None,
        made_from: str = "its recorded operations",
    ) -> None:
        self._control, programs = control, control.programs
        self._made_from = made_from
        self._number, self._other = make(control.law.arithmetic), make(control.law.arithmetic)
        self._loop = control.loop(self._number)
        parts = (programs.inputs, programs.start, programs.step, programs.sent)
        make_function = functions or (lambda part: Evaluator(part, self._other))
        self._inputs, self._start, self._step, self._sent = map(make_function, parts)
        self._state: dict[str, Any] | None = None

    def period(self, period: Period) -> tuple[int, ...]:
        """Result words of one control period."""
        control, loop = self._control, self._loop
        inputs, outputs = loop.step(period.given)
        given = self._inputs.run(self._wire(control.programs.inputs, control.given, period.given))
        if self._state is None:
            self._state = self._start.run(given)
        after = self._step.run(self._state | given)
        self._state = {name: value for name, value in after.items() if name.startswith("state.")}
        if period.flags & FLAG_SENT:
            loop.sent(period.told)
            told = self._wire(control.programs.sent, control.told, period.told)
            self._state = self._sent.run(self._state | told)
        law: list[Any] = [*name_leaves(inputs, "in"), *name_leaves(loop.state, "state"), *name_leaves(outputs, "out")]
        program = [*given.items(), *self._state.items(), *((n, v) for n, v in after.items() if n.startswith("out."))]
        for (name, value), (_, other) in zip(law, program, strict=True):
            if value != other:
                found = Words(f"{name} = {other} from {self._made_from}, {value} from the law")
                raise InputError("controller", control.programs.law, found, "a law without branches on data")
        counters = self._number.counters
        words = [self._word(name, value) for name, value in law]
        return (*words, counters.saturations, counters.zero_divisions)

    def _wire(self, program: Program, words: Sequence[Word], raws: Sequence[int]) -> dict[str, Any]:
        """Integers of the wire as numbers of the recorded program."""
        values = dict(program.inputs)

        def operand(value: Value, raw: int) -> Any:
            return raw if value.kind is Kind.INDEX else self._other.from_raw(raw, value.q or 0)

        return {word.name: operand(values[word.name], raw) for word, raw in zip(words, raws, strict=True)}

    def _word(self, name: str, value: Any) -> int:
        """A number as a word of the log."""
        if name in self._control.formats:
            value = self._number.raw(value, self._control.formats[name])
        if isinstance(value, float):
            (value,) = struct.unpack("<i", struct.pack("<f", value))
        word: int = value
        return word


def count_equal_periods(control: Control, functions: Callable[[Program], Function], made_from: str) -> int:
    """Number of control periods in the reference runs, whose inputs, states and outputs are all the law's.

    :param functions: see :class:`_Twin`, also for ``made_from``.
    :raises InputError: they differ in one.
    """
    count = 0
    for periods in control.runs(None):
        twin = _Twin(control, functions, made_from)
        for period in periods:
            twin.period(period)
            count += 1
    return count


def _line(words: Sequence[int]) -> str:
    return " ".join(f"{word & _MASK:08X}" for word in words)


def reference_log(control: Control, columns: Sequence[str], play: Play | None = None) -> str:
    """The log as text: comment lines, then one line of hexadecimal words for each control period.

    :param columns: names of the result words.
    :param play: see :meth:`~railhil.controller_node.export.control.Control.runs`.
    :raises InputError: the results of the recorded program differ from the law's.
    """
    scenario, law = control.scenario, control.law
    words = (*control.given, *control.told)
    order = [words.index(word) for word in control.record]
    lines = [
        comment(f"# railhil log 1: law {control.programs.law}, scenario {scenario.name}, {law.set_points}"),
        f"# scenario SHA-256 {scenario.sha256}",
        "# each word: 8 hexadecimal digits of an int32, two's complement",
        f"# {' '.join(['flags', *(word.column for word in control.record), *columns])}",
    ]
    for periods in control.runs(play):
        twin = _Twin(control)
        for period in periods:
            values = (*period.given, *period.told)
            lines.append(_line((period.flags, *(values[place] for place in order), *twin.period(period))))
    return "\n".join(lines) + "\n"
