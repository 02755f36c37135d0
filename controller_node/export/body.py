"""Writes the body of a C function from a recorded program: one line of C for each operation.

Every value is a local constant, so a debugger shows each of them. A function whose values would not fit the stack has
variables instead, each used again once its value is no longer needed (:class:`Slots`). What depends on the arithmetic
is in the subclasses of :class:`Body`, :mod:`.fixed` and :mod:`.single`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.export.text import Names, comment, literal
from railhil.controller_node.program.model import Kind, Operation, Program, Quantity, Table, Value, identifier


@dataclass(slots=True)
class Data:
    """Constants and tables of the C file, collected while its functions are written.

    ``literal``: of a constant in C.
    """

    law: str
    literal: Callable[[Constant], str]
    constants: dict[tuple[str, str, int], tuple[str, Constant]] = field(default_factory=dict)
    tables: dict[str, tuple[str, Table]] = field(default_factory=dict)
    _names: Names = field(init=False)

    def __post_init__(self) -> None:
        self._names = Names()

    def constant(self, constant: Constant) -> str:
        """Name of a constant in C."""
        key = (constant.name, self.literal(constant), constant.q)
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
    :param parameters: names of the function's parameters.
    :param shared: values share variables.
    :raises ValueError: an operation that the arithmetic does not have in C.
    """

    #: C type of its numbers, and the header of the arithmetic.
    number: ClassVar[str]
    header: ClassVar[str]
    #: Whether numbers have formats, and words about them for the comments of the C.
    has_formats: ClassVar[bool]
    code_words: ClassVar[tuple[str, ...]]
    value_words: ClassVar[str]
    constant_words: ClassVar[str]
    #: Options that the C needs of a compiler, and its libraries.
    flags: ClassVar[str]
    libraries: ClassVar[str]
    #: First word of its C functions.
    prefix: ClassVar[str]

    def __init__(
        self,
        program: Program,
        data: Data,
        places: Mapping[str, str],
        parameters: Iterable[str] = (),
        *,
        shared: bool = False,
    ) -> None:
        self.lines: list[str] = []
        self.locals = 0
        self._program = program
        self._data = data
        self._names = Names(taken=parameters)
        self._quantities: dict[int, Quantity] = {}
        for quantity in program.quantities:
            self._quantities.setdefault(quantity.value.number, quantity)
        self._expressions = {value.number: places[name] for name, value in program.inputs if name in places}
        used = {value.number for _, value in program.outputs}
        used.update(argument.number for operation in program.operations for argument in operation.arguments)
        self._slots = Slots(program, self._names, self.number) if shared else None
        for operation in program.operations:
            self._write(operation, operation.result.number in used)
        if self._slots is not None:
            self.lines[:0] = self._slots.declarations
            self.locals = self._slots.count

    @staticmethod
    @abstractmethod
    def literal(constant: Constant) -> str:
        """A constant in C."""

    @staticmethod
    @abstractmethod
    def from_raw(expression: str, q: int) -> str:
        """The number of an integer in Q ``q``, as C expressions."""

    @staticmethod
    @abstractmethod
    def raw(expression: str, q: int) -> str:
        """The integer in Q ``q`` of a number, as C expressions."""

    @staticmethod
    @abstractmethod
    def note(expression: str, shift: int, low: int, high: int) -> str:
        """An integer without its last ``shift`` bits, limited to ``low`` and ``high``, as C expressions."""

    def expression(self, value: Value) -> str:
        """C expression that reads a value."""
        return self._expressions[value.number] if value.constant is None else self._data.constant(value.constant)

    def assignments(self, targets: Mapping[str, str], formats: Mapping[str, int]) -> list[str]:
        """Statements that write outputs of the program.

        A member that is assigned to another one is copied first, at the end of ``lines``, before either is written.

        :param targets: C expression of each output's member, by its leaf; other outputs are not written.
        :param formats: Q of the outputs that are written as integers.
        """
        sources = {leaf: self.expression(value) for leaf, value in self._program.outputs if leaf in targets}
        moved = [source for leaf, source in sources.items() if source in targets.values() and source != targets[leaf]]
        kept = {source: self._keep(source) for source in dict.fromkeys(moved)}
        written = {leaf: kept.get(source, source) for leaf, source in sources.items() if source != targets[leaf]}
        written |= {leaf: self.raw(written[leaf], formats[leaf]) for leaf in written if leaf in formats}
        return [f"{targets[leaf]} = {source};" for leaf, source in written.items()]

    def _keep(self, place: str) -> str:
        """Add a local copy of ``place``, which is about to be overwritten; returns its name."""
        name = self._names.new(f"before_{place.rpartition('>')[2]}")
        self.lines.append(f"const {self.number} {name} = {place};")
        self.locals += 1
        return name

    def _write(self, operation: Operation, used: bool) -> None:
        result = operation.result
        quantity = self._quantities.get(result.number)
        q, unit = result.q if self.has_formats else None, quantity.unit if quantity else ""
        arguments = [self.expression(value) for value in operation.arguments]
        if self._slots is None:
            name = self._names.new(quantity.name if quantity else f"v{result.number}")
            words = remark(q, unit)
            kind = f"{type_of(result, self.number)} "
            constant = "const "
        else:
            name, kind, constant = self._slots.taken(operation), "", ""
            words = remark(q, unit, quantity.name if quantity else "")
        self.locals += 1
        if operation.op == "dot":
            self._write_dot(f"{kind}{name}", arguments, operation.parameters[0], words)
        else:
            self.lines += self._counts(operation, arguments)
            right = self._right(operation, arguments)
            # A conversion that changes nothing may have the variable of its argument.
            if right != name:
                self.lines.append(f"{constant}{kind}{name} = {right};{words}")
        if not used:
            self.lines.append(f"(void){name};")
        self._expressions[result.number] = name

    def _write_dot(self, declared: str, arguments: list[str], q: int, words: str) -> None:
        half, name = len(arguments) // 2, declared.rpartition(" ")[2]
        terms = [self._product(*pair, q) for pair in zip(arguments[:half], arguments[half:], strict=True)]
        self.lines.append(f"{declared} = {terms[0]};{words}")
        self.lines += [f"{name} = {self.prefix}_add({name}, {term});" for term in terms[1:]]

    def _right(self, operation: Operation, arguments: list[str]) -> str:
        """The operation as a C expression."""
        match operation.op:
            case "gt":
                return f"{arguments[0]} > {arguments[1]}"
            case "where":
                return f"{arguments[0]} ? {arguments[1]} : {arguments[2]}"
            case "index":
                return f"{self.prefix}_index({arguments[0]}, {literal(operation.parameters[0])})"
            case "locate" | "at":
                return self._look_up(operation, arguments[0])
        return self._call(operation, arguments)

    def _look_up(self, operation: Operation, argument: str) -> str:
        """The place of a number in a table, or the entry at a place."""
        assert operation.table is not None
        table = self._data.table(operation.table)
        if operation.op == "locate":
            return f"{self.prefix}_locate({table}, {literal(len(operation.table.constants))}, {argument})"
        offset = operation.parameters[0]
        return f"{table}[{argument} + {literal(offset)}]" if offset else f"{table}[{argument}]"

    def _curve(self, operation: Operation) -> str:
        """The table of a curve."""
        assert operation.curve is not None
        return self._data.table(Table(operation.curve.name, operation.curve.samples))

    @abstractmethod
    def _counts(self, operation: Operation, arguments: list[str]) -> list[str]:
        """Statements that count the events of an operation whose C function does not count them."""

    @abstractmethod
    def _product(self, a: str, b: str, q: int) -> str:
        """One term of a sum of products."""

    @abstractmethod
    def _call(self, operation: Operation, arguments: list[str]) -> str:
        """The operation as a C expression, for operations that are calls of functions."""


def type_of(value: Value, number: str) -> str:
    """C type of a value.

    :param number: type of numbers.
    """
    return {Kind.CONDITION: "int", Kind.INDEX: "int32_t", Kind.NUMBER: number}[value.kind]


def remark(q: int | None, unit: str, name: str = "") -> str:
    """Comment after a value: its name, format and unit, if it has them."""
    words = ", ".join(word for word in (comment(name), "" if q is None else f"Q{q}", comment(unit)) if word)
    return f" /* {words} */" if words else ""


_PER_LINE = 10


class Slots:
    """Variables of a program: one is free again after the last operation that reads its value.

    Outputs are read after all operations.

    :param names: of the function.
    :param number: C type of numbers.
    """

    def __init__(self, program: Program, names: Names, number: str) -> None:
        self._names = names
        self._number = number
        #: Last operation that reads a value, by the value's number.
        self._last: dict[int, int] = {}
        for place, operation in enumerate(program.operations):
            self._last |= {value.number: place for value in (operation.result, *operation.arguments)}
        self._last |= {value.number: len(program.operations) for _, value in program.outputs}
        self._place = 0
        self._held: dict[int, tuple[tuple[str, str], str]] = {}
        #: Type and first letter of the variables of numbers, indices and conditions.
        kinds = [(number, "w"), ("int32_t", "w"), ("int", "c")]
        self._free: dict[tuple[str, str], list[str]] = {kind: [] for kind in kinds}
        self._made: dict[tuple[str, str], list[str]] = {kind: [] for kind in kinds}

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
        kind = (type_of(operation.result, self._number), "c" if operation.result.kind is Kind.CONDITION else "w")
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
