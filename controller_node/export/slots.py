"""Variables of a C function that several values share, one after the other."""

from __future__ import annotations

from railhil.controller_node.export.names import Names
from railhil.controller_node.program.model import Kind, Operation, Program

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
