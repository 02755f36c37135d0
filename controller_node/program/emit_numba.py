"""Emits a recorded program as a loop over many trains, for numba: the operations of :mod:`.emit_python`, on rows of
arrays.

A train with an event to count is left unchanged and marked; the law itself computes that step. All numbers of the
program are arguments, so one machine code serves every line and every parameter file with the same operations.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.program.emit_python import FIXED, FLOAT32, FLOAT64, Emitter, is_state
from railhil.controller_node.program.model import Kind, Operation, Program
from railhil.controller_node.program.ranges import Ranges

#: Functions of :mod:`railhil.batch.law_parts` for operations that are not a line of text; another one is refused.
_PARTS = {
    FIXED: {"div": "quotient_int"},
    FLOAT64: {"div": "quotient", "quantise": "nearest_multiple"},
    FLOAT32: {"div": "quotient_single", "quantise": "nearest_multiple"},
}
#: First arguments of a function: rows of the first four are trains; ``numbers`` are integers in fixed point, ``limits``
#: always.
_ARGUMENTS = ("state", "given", "answer", "left", "numbers", "limits")
_OWN = (*_ARGUMENTS, "train", "located", "nearest", "LEFT", "part")


class Emitted(NamedTuple):
    """The text of a module with one function, and the function's arguments after its first four."""

    text: str
    numbers: list[Any]
    limits: list[int]
    tables: list[Sequence[Any]]


class _NumbaEmitter(Emitter):
    """One program in one family of arithmetics, for many trains."""

    def __init__(self, program: Program, family: str, number: Arithmetic[Any]) -> None:
        super().__init__(program, family, number)
        self._parts = _PARTS[family]
        self._head: list[str] = []
        #: The numbers in the order of their first use, each with its name.
        self._constants: dict[str, Any] = {}
        self._limits: dict[str, int] = {}
        self._tables: dict[str, Sequence[Any]] = {}

    def _free(self, wanted: str) -> str:
        self._taken.update(_OWN)
        return super()._free(wanted)

    def _name(self, prefix: str, part: Any, as_used: Callable[[], Any]) -> str:
        name = super()._name(prefix, part, as_used)
        (self._constants if prefix == "c" else self._tables)[name] = self.names[name]
        return name

    def emitted(self, ranges: Ranges | None) -> Emitted:
        """Text and numbers.

        :raises KeyError: an operation that cannot be emitted.
        """
        before = set(self.names)
        self._write(ranges)
        if ranges is not None:
            bounds = [name for name in self.names if name not in before and name.startswith(("low_", "high_"))]
            self._limits = {name: self.names[name] for name in bounds} | self._limits
        counts = {"state": 0, "given": 0, "answer": 0}

        def place(array: str) -> str:
            counts[array] += 1
            return f"{array}[train, {counts[array] - 1}]"

        body = []
        for name, value in self._program.inputs:
            read = place("state" if is_state(name) else "given")
            body.append(f"{self._values[value.number]} = {f'int({read})' if value.kind is Kind.INDEX else read}")
        body += [line.removeprefix("    ") for line in self._lines]
        counts["state"] = 0
        for name, value in self._program.outputs:
            body.append(f"{place('state' if is_state(name) else 'answer')} = {self._read(value)}")
        begin = [
            f"{name} = {array}[{i}]"
            for array, names in (("numbers", self._constants), ("limits", self._limits))
            for i, name in enumerate(names)
        ]
        lines = [
            *dict.fromkeys(self._head),
            "",
            "",
            f"def {self._program.name}({', '.join((*_ARGUMENTS, *self._tables))}):",
            *(f"    {line}" for line in begin),
            "    for train in range(given.shape[0]):",
            "        if left[train]:",
            "            continue",
            *(f"        {line}" for line in body),
        ]
        text = "\n".join(lines) + "\n"
        return Emitted(text, list(self._constants.values()), list(self._limits.values()), list(self._tables.values()))

    def _part(self, name: str) -> str:
        """A function or number of :mod:`railhil.batch.law_parts`."""
        self._head.append(f"from railhil.batch.law_parts import {name}")
        return name

    def _leave_if(self, condition: str) -> None:
        self._say(f"if {condition}:", "    left[train] = True", "    continue")

    def _call(self, operation: Operation, to: str, arguments: str) -> None:
        self._say(f"{to} = {self._part(self._parts[operation.op])}({arguments})")
        if self._fixed:
            self._leave_if(f"{to} == {self._part('LEFT')}")

    def _rounded(self, to: str, expression: str) -> None:
        # Numbers that are neither normal nor zero are not counted, and need no law.
        self._say(f"{to} = {self._part('nearest')}({expression})" if self._single else f"{to} = {expression}")

    def _write_curve(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        if self._fixed or self._single:
            super()._write_curve(operation, to, words)
            return
        assert operation.curve is not None
        function = operation.curve.function
        if not isinstance(function, partial):
            # Numba cannot store the machine code of a function with numbers of its own.
            raise KeyError(f"curve {operation.curve.name}")
        name, code = function.func.__name__, function.func.__code__
        digest = hashlib.sha256(code.co_code + repr(code.co_consts).encode()).hexdigest()[:16]
        self._head += [
            f"from {function.func.__module__} import {name}  # {digest}",
            "from railhil.batch.compiled import part",
            f"{name} = part({name})",
        ]
        numbers = [self._free(f"{name}_{i}") for i in range(len(function.args))]
        self._constants |= dict(zip(numbers, function.args, strict=True))
        self._say(f"{to} = {name}({', '.join((*numbers, words[0]))})")

    def _write_index(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        # It depends on the length of a table.
        last = self._free("last")
        self._limits[last] = operation.parameters[0]
        self._say(f"{to} = min(max({words[0]}, 0), {last})")

    def _write_locate(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = {self._part('located')}({self._table(operation)}, {words[0]})")


def emit_numba(program: Program, family: str, number: Arithmetic[Any], ranges: Ranges | None) -> Emitted:
    """The module of a program for many trains: a function named as the program.

    :param number: arithmetic of the family for one train: it makes the constants.
    :param ranges: of the program in fixed point: a train with an input outside them is left.
    :raises KeyError: an operation that cannot be emitted.
    """
    return _NumbaEmitter(program, family, number).emitted(ranges)
