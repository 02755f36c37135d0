"""Writes the body of a C function from a recorded program: one line of C for each operation.

In fixed point, operations that the IQmath library has (N = 1..30) are calls of its functions, all others of the
``iq_*`` functions in ``railhil_iq.h``. Every value is a local constant, so a debugger shows each of them. A function
whose values would not fit the stack has variables instead, each used again once its value is no longer needed
(:class:`Slots`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.export.text import Names, comment, identifier, literal
from railhil.controller_node.program.model import Kind, Operation, Program, Quantity, Table, Value

#: The IQmath library provides its functions for 1 to 30 fraction bits.
NAMED_Q = range(1, 31)

_PLAIN = {"add": "iq_add", "sub": "iq_sub", "neg": "iq_neg", "minimum": "iq_min", "maximum": "iq_max"}
_CURVE_BITS = 8
#: Largest shifts of a 64-bit product and of a 32-bit number.
_PRODUCT_SHIFT_MAX = 62
_SHIFT_MAX = 31
#: railhil's own functions, for formats that the library lacks. There are none for quotients and roots, which would need
#: more than 64 bits there.
_OWN = {"mpy": "iq_mpy", "rmpy": "iq_rmpy", "rsmpy": "iq_rsmpy"}


def _library_call(name: str, q: int, *arguments: str) -> str:
    """A call of the library function for this format if there is one, else of railhil's own function.

    :raises ValueError: there is neither.
    """
    if q in NAMED_Q:
        return f"_IQ{q}{name}({', '.join(arguments)})"
    if name not in _OWN or not 0 <= q <= _PRODUCT_SHIFT_MAX:
        raise ValueError(f"{name} with {q} fraction bits")
    return f"{_OWN[name]}({', '.join(arguments)}, {q})"


def _shift(argument: str, q_from: int, q_to: int) -> str:
    """Conversion to another format.

    :raises ValueError: all bits of the number would be shifted out.
    """
    if q_to - q_from > _SHIFT_MAX:
        raise ValueError(f"convert from Q{q_from} to Q{q_to}")
    if q_to > q_from:
        return f"iq_shl({argument}, {q_to - q_from})"
    # A shift by 31 leaves only the sign; larger shifts give the same result.
    return f"iq_shr({argument}, {min(q_from - q_to, _SHIFT_MAX)})"


@dataclass(slots=True)
class Data:
    """Constants and tables of the C file, collected while its functions are written."""

    law: str
    constants: dict[tuple[str, int, int], tuple[str, Constant]] = field(default_factory=dict)
    tables: dict[str, tuple[str, Table]] = field(default_factory=dict)
    _names: Names = field(init=False)

    def __post_init__(self) -> None:
        self._names = Names()

    def constant(self, constant: Constant) -> str:
        """Name of a constant in C."""
        key = (constant.name, constant.raw, constant.q)
        if key not in self.constants:
            name = self._names.new(f"{self.law}_{identifier(constant.name)}".upper())
            self.constants[key] = (name, constant)
        return self.constants[key][0]

    def table(self, table: Table) -> str:
        """Name of a table in C.

        :raises ValueError: another table has the same name.
        """
        if table.name not in self.tables:
            self.tables[table.name] = (self._names.new(f"{self.law}_{identifier(table.name)}_table"), table)
        name, known = self.tables[table.name]
        if known.constants != table.constants:
            raise ValueError(f"two tables of the law are called {table.name}")
        return name


class Body(ABC):
    """Lines of one C function that computes a recorded program.

    ``locals``: number of its local variables, for the estimate of the stack.

    :param places: C expression of each input of the program, by its name; an input without one is not read.
    :param names: of the function's variables.
    """

    #: C type of its numbers.
    number: ClassVar[str]

    def __init__(self, program: Program, places: Mapping[str, str], names: Names) -> None:
        self.lines: list[str] = []
        self.locals = 0
        self._program = program
        self._names = names
        self._quantities: dict[int, Quantity] = {}
        for quantity in program.quantities:
            self._quantities.setdefault(quantity.value.number, quantity)
        self._expressions = {value.number: places[name] for name, value in program.inputs if name in places}

    def expression(self, value: Value) -> str:
        """C expression that reads a value."""
        return self._expressions[value.number] if value.constant is None else self._constant(value.constant)

    @abstractmethod
    def _constant(self, constant: Constant) -> str:
        """C expression of a constant."""

    def _named(self, value: Value) -> str:
        """A new name for a value: that of its quantity, if it has one."""
        quantity = self._quantities.get(value.number)
        return self._names.new(quantity.name if quantity else f"v{value.number}")

    def assignments(self, targets: Mapping[str, str]) -> list[str]:
        """Statements that write outputs of the program.

        A member that is assigned to another one is copied first, at the end of ``lines``, before either is written.

        :param targets: C expression of each output's member, by its leaf; other outputs are not written.
        """
        sources = {leaf: self.expression(value) for leaf, value in self._program.outputs if leaf in targets}
        moved = [source for leaf, source in sources.items() if source in targets.values() and source != targets[leaf]]
        kept = {source: self._keep(source) for source in dict.fromkeys(moved)}
        return [
            f"{targets[leaf]} = {kept.get(source, source)};"
            for leaf, source in sources.items()
            if source != targets[leaf]
        ]

    def _keep(self, place: str) -> str:
        """Add a local copy of ``place``, which is about to be overwritten; returns its name."""
        name = self._names.new(f"before_{place.rpartition('>')[2]}")
        self.lines.append(f"const {self.number} {name} = {place};")
        self.locals += 1
        return name

    def _right(self, operation: Operation, arguments: list[str]) -> str:
        """The operation as a C expression."""
        match operation.op:
            case "gt":
                return f"{arguments[0]} > {arguments[1]}"
            case "where":
                return f"{arguments[0]} ? {arguments[1]} : {arguments[2]}"
        return self._call(operation, arguments)

    @abstractmethod
    def _call(self, operation: Operation, arguments: list[str]) -> str:
        """The same for operations that are calls of functions."""


class FixedBody(Body):
    """The body of a function in fixed point.

    :param parameters: names of the function's parameters.
    :param shared: values share variables.
    """

    number = "int32_t"

    def __init__(
        self,
        program: Program,
        data: Data,
        places: Mapping[str, str],
        parameters: Iterable[str] = (),
        *,
        shared: bool = False,
    ) -> None:
        super().__init__(program, places, Names(taken=parameters))
        self._data = data
        used = {value.number for _, value in program.outputs}
        used.update(argument.number for operation in program.operations for argument in operation.arguments)
        self._slots = Slots(program, self._names) if shared else None
        for operation in program.operations:
            self._write(operation, operation.result.number in used)
        if self._slots is not None:
            self.lines[:0] = self._slots.declarations
            self.locals = self._slots.count

    def _constant(self, constant: Constant) -> str:
        return self._data.constant(constant)

    def _write(self, operation: Operation, used: bool) -> None:
        result = operation.result
        quantity = self._quantities.get(result.number)
        arguments = [self.expression(value) for value in operation.arguments]
        if self._slots is None:
            name = self._named(result)
            words = remark(result.q, quantity.unit if quantity else "")
            kind = "int " if result.kind is Kind.CONDITION else f"{self.number} "
            constant = "const "
        else:
            name, kind, constant = self._slots.taken(operation), "", ""
            words = remark(result.q, quantity.unit if quantity else "", quantity.name if quantity else "")
        self.locals += 1
        if operation.op == "dot":
            self._write_dot(f"{kind}{name}", arguments, operation.parameters[0], words)
        else:
            self._note(operation, arguments)
            self.lines.append(f"{constant}{kind}{name} = {self._right(operation, arguments)};{words}")
        if not used:
            self.lines.append(f"(void){name};")
        self._expressions[result.number] = name

    def _write_dot(self, declared: str, arguments: list[str], q: int, words: str) -> None:
        half, name = len(arguments) // 2, declared.rpartition(" ")[2]
        terms = [_library_call("rmpy", q, *pair) for pair in zip(arguments[:half], arguments[half:], strict=True)]
        self.lines.append(f"{declared} = {terms[0]};{words}")
        self.lines += [f"{name} = iq_add({name}, {term});" for term in terms[1:]]

    def _note(self, operation: Operation, arguments: list[str]) -> None:
        """Add a call that counts the events of an operation whose C function does not count them."""
        what = {"div": "division", "rsmpy": "product"}.get(operation.op)
        if what is not None:
            self.lines.append(f"iq_note_{what}({', '.join(arguments)}, {operation.parameters[0]}, events);")

    def _call(self, operation: Operation, arguments: list[str]) -> str:
        parameters = operation.parameters
        listed = ", ".join(arguments)
        match operation.op:
            case "add" | "sub" | "neg" | "minimum" | "maximum":
                return f"{_PLAIN[operation.op]}({listed})"
            case "mpy" | "rmpy" | "rsmpy" | "div" | "sqrt":
                return _library_call(operation.op, parameters[0], *arguments)
            case "mpy_iqx":
                q_a, q_b, q = parameters
                if q in NAMED_Q and q_a in NAMED_Q and q_b in NAMED_Q:
                    return f"_IQ{q}mpyIQX({arguments[0]}, {q_a}, {arguments[1]}, {q_b})"
                if abs(q_a + q_b - q) > _PRODUCT_SHIFT_MAX:
                    raise ValueError(f"mpy_iqx from Q{q_a} and Q{q_b} to Q{q}")
                return f"iq_mpy_iqx({arguments[0]}, {q_a}, {arguments[1]}, {q_b}, {q})"
            case "abs":
                q_of = operation.result.q
                return f"_IQ{q_of}abs({listed})" if q_of in NAMED_Q else f"iq_abs({listed})"
            case "quantise":
                return _library_call("rmpy", parameters[0] - parameters[1], listed, literal(1))
            case "convert":
                return _shift(listed, *parameters)
            case "sat":
                return f"iq_limit({listed}, events)"
            case "clip":
                return f"_IQsat({listed})"
        return self._look_up(operation, listed)

    def _look_up(self, operation: Operation, argument: str) -> str:
        """Operations on tables."""
        if operation.op == "index":
            return f"iq_index({argument}, {literal(operation.parameters[0])})"
        if operation.op == "curve":
            assert operation.curve is not None
            table = self._data.table(Table(operation.curve.name, operation.curve.samples))
            return f"iq_curve({table}, {argument}, {operation.curve.q_in - _CURVE_BITS})"
        assert operation.table is not None
        table = self._data.table(operation.table)
        if operation.op == "locate":
            return f"iq_locate({table}, {literal(len(operation.table.constants))}, {argument})"
        if operation.op == "at":
            offset = operation.parameters[0]
            return f"{table}[{argument} + {literal(offset)}]" if offset else f"{table}[{argument}]"
        raise KeyError(operation.op)


def remark(q: int | None, unit: str, name: str = "") -> str:
    """Comment after a value: its name, format and unit, if it has them."""
    words = ", ".join(word for word in (comment(name), "" if q is None else f"Q{q}", comment(unit)) if word)
    return f" /* {words} */" if words else ""


_PER_LINE = 10
#: Type and first letter of the variables of conditions, and of all other values.
_CONDITION, _NUMBER = ("int", "c"), ("int32_t", "w")


class Slots:
    """Variables of a program: one is free again after the last operation that reads its value.

    Outputs are read after all operations.

    :param names: of the function.
    """

    def __init__(self, program: Program, names: Names) -> None:
        self._names = names
        #: Last operation that reads a value, by the value's number.
        self._last: dict[int, int] = {}
        for place, operation in enumerate(program.operations):
            self._last |= {value.number: place for value in (operation.result, *operation.arguments)}
        self._last |= {value.number: len(program.operations) for _, value in program.outputs}
        self._place = 0
        self._held: dict[int, tuple[tuple[str, str], str]] = {}
        self._free: dict[tuple[str, str], list[str]] = {_NUMBER: [], _CONDITION: []}
        self._made: dict[tuple[str, str], list[str]] = {_NUMBER: [], _CONDITION: []}

    @property
    def count(self) -> int:
        """Number of variables so far."""
        return sum(map(len, self._made.values()))

    @property
    def declarations(self) -> list[str]:
        """In C."""
        return [
            f"{kind} {', '.join(made[first : first + _PER_LINE])};"
            for (kind, _), made in self._made.items()
            for first in range(0, len(made), _PER_LINE)
        ]

    def taken(self, operation: Operation) -> str:
        """The variable for the result of the next operation."""
        place = self._place
        self._place += 1
        over = [number for number in self._held if self._last[number] <= place]
        # A sum of products is written in several steps, so its result must not replace a factor.
        in_steps = operation.op == "dot"
        if not in_steps:
            self._release(over)
        kind = _CONDITION if operation.result.kind is Kind.CONDITION else _NUMBER
        free = self._free[kind]
        if not free:
            self._made[kind].append(self._names.new(f"{kind[1]}{len(self._made[kind])}"))
            free.append(self._made[kind][-1])
        name = free.pop()
        if in_steps:
            self._release(over)
        self._held[operation.result.number] = (kind, name)
        return name

    def _release(self, numbers: list[int]) -> None:
        for number in numbers:
            kind, name = self._held.pop(number)
            self._free[kind].append(name)
