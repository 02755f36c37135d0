"""Emits a recorded program as one straight-line Python function, which takes a third of the time of the law.

A law calls a method of its arithmetic for every operation. In the emitted function each operation is one line of
Python, named after its quantity where it has a name. It gives the law's results while no event is to be counted: a
value that would saturate, be divided by zero or leave the range for which the interval analysis has shown that nothing
wraps (:mod:`railhil.controller_node.program.ranges`) makes it return None, and the law itself computes that step
(:mod:`railhil.controller_node.compiled_law`).

``fixed`` serves both profiles of fixed point, ``float64`` double precision, ``float32`` single precision rounded to
nearest: there a result is stored in the one place of an array of singles and read back, and numbers that are neither
normal nor zero are left to the law.
"""

from __future__ import annotations

import re
from array import array
from bisect import bisect_right
from collections.abc import Callable, Sequence
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Arithmetic, Curve
from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN, LAST_CELL
from railhil.controller_node.program.model import Kind, Operation, Program, Value

if TYPE_CHECKING:
    from railhil.controller_node.program.ranges import Ranges

FIXED, FLOAT64, FLOAT32 = "fixed", "float64", "float32"
#: Operations that the functions leave to the arithmetic, because they are rare or differ between the profiles.
_CALLED = {FIXED: ("div", "sqrt"), **dict.fromkeys((FLOAT64, FLOAT32), ("div", "sqrt", "quantise"))}
#: Built-in names, arguments and local variables of a function, besides those of the program.
_OWN = ("abs", "cell", "given", "int", "len", "max", "min", "product", "scaled", "state", "value")
_STATE = "state"


def is_state(name: str) -> bool:
    """True for an input or output of a program that belongs to the law's state."""
    return name.partition(".")[0].partition("[")[0] == _STATE


def checked_inputs(program: Program) -> list[Value]:
    """Inputs whose range a function of fixed point checks: the state, or the wire values if the program has no state.

    The other inputs are results of another program, and their ranges follow from it.
    """
    states = [value for name, value in program.inputs if is_state(name)]
    return [value for value in states or [value for _, value in program.inputs] if value.kind is Kind.NUMBER]


class Emitter:
    """One program in one family of arithmetics, line by line, and the numbers that it names.

    :mod:`.emit_numba` emits the same operations for many trains.
    """

    def __init__(self, program: Program, family: str, number: Arithmetic[Any]) -> None:
        self._program = program
        self._fixed = family == FIXED
        self._single = family == FLOAT32
        self._called = _CALLED[family]
        self._number = number
        self._lines: list[str] = []
        #: Global names of the function.
        self.names: dict[str, Any] = {
            "bisect_right": bisect_right,
            "FLT_MAX": FLT_MAX,
            "FLT_MIN": FLT_MIN,
            "single": array("f", [0.0]),
            **{op: getattr(number, op) for op in self._called},
        }
        self._taken = {*_OWN, *self.names}
        # Name of each constant, table and curve by its identity: equal ones keep their own names.
        self._named: dict[int, str] = {}
        self._values = {value.number: self._free(_word(name)) for name, value in program.inputs}
        noted = {quantity.value.number: quantity.name for quantity in program.quantities}
        for operation in program.operations:
            result = operation.result.number
            self._values[result] = self._free(_word(noted[result]) if result in noted else f"{operation.op}_{result}")

    def _free(self, wanted: str) -> str:
        """A new unique name."""
        name, count = wanted, 1
        while name in self._taken or iskeyword(name) or not name.isidentifier():
            count += 1
            name = f"{wanted if wanted.isidentifier() else 'x'}_{count}"
        self._taken.add(name)
        return name

    def _name(self, prefix: str, part: Any, as_used: Callable[[], Any]) -> str:
        """Global name of a constant, table or curve."""
        name = self._named.get(id(part))
        if name is None:
            name = self._named[id(part)] = self._free(f"{prefix}_{_word(part.name)}")
            self.names[name] = as_used()
        return name

    def text(self, ranges: Ranges | None) -> str:
        """The function; ``names`` is complete then."""
        self._write(ranges)
        states = [value for name, value in self._program.inputs if is_state(name)]
        given = [value for name, value in self._program.inputs if not is_state(name)]
        body = list(self._lines)
        after = [self._read(value) for name, value in self._program.outputs if is_state(name)]
        answer = [self._read(value) for name, value in self._program.outputs if not is_state(name)]
        noted = [self._read(quantity.value) for quantity in self._program.quantities]
        body += ["    return ("]
        for words in (after, answer, noted):
            body += [f"    {line}" for line in _tuple(words)]
        body += ["    )"]
        head = [f"def {self._program.name}(state, given):"]
        head += _unpacked([self._values[value.number] for value in states], "state")
        head += _unpacked([self._values[value.number] for value in given], "given")
        return "\n".join([*head, *body]) + "\n"

    def _write(self, ranges: Ranges | None) -> None:
        """The lines of the checked inputs and of all operations."""
        if ranges is not None:
            for value in checked_inputs(self._program):
                name = self._values[value.number]
                low, high = (self._free(f"{end}_{name.removeprefix(f'{_STATE}_')}") for end in ("low", "high"))
                self.names[low], self.names[high] = ranges.of(value)
                self._leave_if(f"not {low} <= {name} <= {high}")
        for operation in self._program.operations:
            self._operation(operation)

    def _read(self, value: Value) -> str:
        constant = value.constant
        if constant is not None:
            return self._name("c", constant, lambda: self._number.const(constant))
        return self._values[value.number]

    def _table(self, operation: Operation) -> str:
        table = operation.table
        assert table is not None
        return self._name("t", table, lambda: self._number.table(table.name, table.constants))

    def _curve(self, curve: Curve) -> str:
        """The samples of a curve, or in float64 its function."""

        def as_used() -> Any:
            if self._fixed:
                return tuple(sample.raw for sample in curve.samples)
            return self._number.load(curve.samples) if self._single else curve.function

        return self._name("f", curve, as_used)

    def _say(self, *lines: str) -> None:
        self._lines += [f"    {line}" for line in lines]

    def _operation(self, operation: Operation) -> None:
        to = self._values[operation.result.number]
        words = [self._read(value) for value in operation.arguments]
        if operation.op in self._called:
            self._call(operation, to, ", ".join([*words, *map(str, operation.parameters)]))
            return
        write: Callable[[Operation, str, Sequence[str]], None] | None = getattr(self, f"_write_{operation.op}", None)
        if write is None:
            raise KeyError(operation.op)
        write(operation, to, words)

    def _call(self, operation: Operation, to: str, arguments: str) -> None:
        """An operation that the arithmetic computes."""
        self._say(f"{to} = {operation.op}({arguments})")

    def _leave_if(self, condition: str) -> None:
        """Leave the step to the law itself."""
        self._say(f"if {condition}:", "    return None")

    def _rounded(self, to: str, expression: str) -> None:
        """A sum or product, rounded by single precision, which has neither denormals nor -0."""
        if not self._single:
            self._say(f"{to} = {expression}")
            return
        # + 0.0: -0 is +0.
        self._say(f"single[0] = {expression}", f"{to} = value = single[0] + 0.0")
        self._leave_if("not (FLT_MIN <= value <= FLT_MAX or -FLT_MAX <= value <= -FLT_MIN) and value")

    # -- one method for each operation ---------------------------------------------------------------------------------

    def _write_add(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._rounded(to, f"{words[0]} + {words[1]}")

    def _write_sub(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._rounded(to, f"{words[0]} - {words[1]}")

    def _write_neg(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = {'0.0 - ' if self._single else '-'}{words[0]}")

    def _write_abs(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = abs({words[0]})")

    def _product(self, first: str, second: str, q: int, rounded: bool) -> str:
        if not self._fixed:
            return f"{first} * {second}"
        return f"{first} * {second}{f' + {1 << (q - 1)}' if rounded else ''}{f' >> {q}' if q else ''}"

    def _write_mpy(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._rounded(to, self._product(words[0], words[1], operation.parameters[0], False))

    def _write_rmpy(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._rounded(to, self._product(words[0], words[1], operation.parameters[0], True))

    def _write_rsmpy(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._write_rmpy(operation, to, words)
        if self._fixed:
            self._leave_if(f"not {INT32_MIN} <= {to} <= {INT32_MAX}")

    def _write_mpy_iqx(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        q_a, q_b, q = operation.parameters
        shift = q_a + q_b - q
        moved = f" >> {shift}" if shift > 0 else f" << {-shift}" if shift else ""
        self._rounded(to, f"{words[0]} * {words[1]}{moved if self._fixed else ''}")

    def _write_dot(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        half = len(words) // 2
        for number, (first, second) in enumerate(zip(words[:half], words[half:], strict=True)):
            if self._single:
                self._rounded("product" if number else to, f"{first} * {second}")
                if number:
                    self._rounded(to, f"{to} + product")
                continue
            begin = "" if self._fixed or number else "0.0 + "
            product = self._product(first, second, operation.parameters[0], True)
            self._say(f"{to} {'+=' if number else '='} {begin}{product}")

    def _write_convert(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        q_from, q_to = operation.parameters
        shift = f" << {q_to - q_from}" if q_to > q_from else f" >> {q_from - q_to}" if q_to < q_from else ""
        self._say(f"{to} = {words[0]}{shift if self._fixed else ''}")

    def _write_quantise(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        q = operation.parameters[0] - operation.parameters[1]
        self._say(f"{to} = {words[0]} + {1 << (q - 1)} >> {q}")

    def _write_sat(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        a, upper, lower = words
        if not self._fixed:
            self._write_clip(operation, to, words)
            return
        self._leave_if(f"not {lower} <= {a} <= {upper}")
        self._say(f"{to} = {a}")

    def _write_clip(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        a, upper, lower = words
        if self._fixed:
            if not _is_ordered(operation):
                # The profiles differ if the limits are swapped.
                self._leave_if(f"{lower} > {upper}")
            self._say(f"{to} = {a} if {a} < {upper} else {upper}", f"if {to} < {lower}:", f"    {to} = {lower}")
        else:
            self._say(f"{to} = {lower} if {lower} > {a} else {a}", f"if {upper} < {to}:", f"    {to} = {upper}")

    def _write_minimum(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        a, b = words
        self._say(f"{to} = {b} if {b} < {a} else {a}")

    def _write_maximum(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        a, b = words
        self._say(f"{to} = {b} if {b} > {a} else {a}")

    def _write_gt(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = {words[0]} > {words[1]}")

    def _write_where(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = {words[1]} if {words[0]} else {words[2]}")

    def _write_curve(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        assert operation.curve is not None
        curve, a = self._curve(operation.curve), words[0]
        if self._single:
            self._say(f"scaled = {a} * 256.0", f"cell = int(min(scaled, {LAST_CELL}))")
            self._rounded("product", f"{curve}[cell + 1] - {curve}[cell]")
            self._rounded("product", "product * (scaled - cell)")
            self._rounded(to, f"{curve}[cell] + product")
            return
        if not self._fixed:
            self._say(f"{to} = {curve}({a})")
            return
        bits = operation.curve.q_in - 8
        self._say(
            f"cell = min({a} >> {bits}, 255)",
            f"{to} = {curve}[cell]",
            f"{to} += ({curve}[cell + 1] - {to}) * ({a} - (cell << {bits})) >> {bits}",
        )

    def _write_at(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        offset = operation.parameters[0]
        self._say(f"{to} = {self._table(operation)}[{words[0]}{f' + {offset}' if offset else ''}]")

    def _write_index(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        self._say(f"{to} = min(max({words[0]}, 0), {operation.parameters[0]})")

    def _write_locate(self, operation: Operation, to: str, words: Sequence[str]) -> None:
        table = self._table(operation)
        self._say(f"{to} = min(max(bisect_right({table}, {words[0]}) - 1, 0), len({table}) - 2)")


def _is_ordered(operation: Operation) -> bool:
    """True for constant limits that are not swapped."""
    upper, lower = (limit.constant for limit in operation.arguments[1:])
    return upper is not None and lower is not None and lower.raw <= upper.raw


def _word(name: str) -> str:
    """A name of Python from one of the law: ``state.model[0]`` becomes ``state_model_0``."""
    return re.sub(r"\W+", "_", f"minus_{name[1:]}" if name.startswith("-") else name).strip("_")


def _tuple(words: Sequence[str]) -> list[str]:
    return ["    (", *(f"        {word}," for word in words), "    ),"] if words else ["    (),"]


def _unpacked(names: Sequence[str], of: str) -> list[str]:
    if len(names) < 2:
        return [f"    ({name},) = {of}" for name in names]
    return ["    (", *(f"        {name}," for name in names), f"    ) = {of}"]


def emit_python(
    program: Program, family: str, number: Arithmetic[Any], ranges: Ranges | None
) -> tuple[str, dict[str, Any]]:
    """Text of a function of state and other inputs, named as the program, and the global names that it uses.

    :param number: arithmetic of the family: it makes the constants and does the operations that are called.
    :param ranges: of the program in fixed point: for inputs outside them the function returns None.
    :raises KeyError: an operation that only a law can do, such as the solution of a problem.
    """
    emitter = Emitter(program, family, number)
    text = emitter.text(ranges)
    return text, emitter.names
