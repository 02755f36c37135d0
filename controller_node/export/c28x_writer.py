"""C28x instructions for a recorded function: one straight line, without a branch or a call.

Every operation becomes the instructions that compute it word for word, also division and curve. Inputs, state,
outputs and constants are in data memory (direct addressing), values in between on the stack; the value in ACC is not
stored if only the next operation needs it. Format limits are not counted.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

from railhil.controller_node.arithmetic.base import INT32_MAX, Constant
from railhil.controller_node.export.c28x_machine import Instruction, Loc, Mode
from railhil.controller_node.program.model import Operation, Program, Value

_MASK: Final = 0xFFFF_FFFF
#: Where data and tables are: blocks L0 and L4 of the F28335 (TI SPRS439).
_DATA, _TABLES = 0x8000, 0xC000
_LONG = 2
#: Values that ``*-SP[6bit]`` reaches; further ones are in data memory.
_ON_STACK = 31
_SHIFT_MAX = 16
_BINARY = {"add": "ADDL", "sub": "SUBL", "minimum": "MINL", "maximum": "MAXL"}
#: Operations that take the value in ACC as any argument, and the place of the argument that others take from there.
_COMMUTATIVE = {"add", "minimum", "maximum", "mpy", "rmpy", "rsmpy"}
_FROM_ACC = {
    "sub": 0,
    "neg": 0,
    "abs": 0,
    "convert": 0,
    "sat": 0,
    "clip": 0,
    "quantise": 0,
    "gt": 0,
    "index": 0,
    "where": 1,
}
#: What instructions are for that belong to no operation.
FRAME, OUTPUTS = "call, return, modes", "outputs"

#: An operand: an address in data memory, or what an instruction reaches without DP.
Place = int | Loc


class Layout:
    """Addresses in data memory, in the order of first use: ``names`` of all places, ``words`` of the constants."""

    def __init__(self) -> None:
        self.names: dict[str, int] = {}
        self.words: dict[int, int] = {}
        self._next = {_DATA: _DATA, _TABLES: _TABLES}

    def place(self, name: str, longs: int = 1, block: int = _DATA) -> int:
        """Address of ``longs`` 32-bit values."""
        if name not in self.names:
            self.names[name] = self._next[block]
            self._next[block] += _LONG * longs
        return self.names[name]

    def constant(self, raw: int) -> int:
        """Address of a constant."""
        address = self.place(f"constant {raw & _MASK:08X}")
        self.words[address] = raw & _MASK
        return address

    def table(self, name: str, constants: tuple[Constant, ...]) -> int:
        """Address of a table."""
        address = self.place(f"table {name}", len(constants), _TABLES)
        self.words |= {address + _LONG * i: constant.raw & _MASK for i, constant in enumerate(constants)}
        return address


class Writer:
    """Writes one function as ``stream``.

    :raises ValueError: an operation for which there is no straight line, or a format that it does not reach.
    """

    def __init__(self, program: Program, layout: Layout) -> None:
        self._layout = layout
        self._operation = FRAME
        self._inputs = {value.number: name for name, value in program.inputs}
        #: Operations that read a value, by its number; outputs are read after all operations.
        self._readers: dict[object, list[int]] = {}
        reads = [(place, value) for place, of in enumerate(program.operations) for value in of.arguments]
        for place, value in [*reads, *((len(program.operations), value) for _, value in program.outputs)]:
            self._readers.setdefault(value.number, []).append(place)
        #: Places of values (by number) and of parts of an operation (by name).
        self._slots: dict[object, int] = {}
        self._free: list[int] = []
        self._made = 0
        #: Numbers of the values in ACC and, doubled, in XAR0; the page in DP.
        self._acc: int | None = None
        self._index: int | None = None
        self._page: int | None = None
        self.stream: list[Instruction] = []
        for syntax in ("SPM 0", "SETC SXM", "CLRC OVM"):
            self._put(syntax)
        for place, operation in enumerate(program.operations):
            self._write(place, operation, program.operations[place + 1 : place + 2])
        self._write_outputs(program)
        frame = _LONG * min(self._made, _ON_STACK)
        self.stream.insert(0, Instruction("ADDB SP,#7bit", number=frame, operation=FRAME))
        self.stream.insert(0, Instruction("LCR #22bit", operation=FRAME))
        self.stream += [
            Instruction("SUBB SP,#7bit", number=frame, operation=FRAME),
            Instruction("LRETR", operation=FRAME),
        ]

    def _put(
        self, syntax: str, place: Place | None = None, number: int = 0, *, register: int = 0, condition: str = ""
    ) -> None:
        """Add an instruction, and before it the page of its operand unless DP has it."""
        if isinstance(place, int):
            page, offset = divmod(place, 64)
            if page != self._page:
                self.stream.append(Instruction("MOVW DP,#16bit", number=page, operation=self._operation))
                self._page = page
            place = Loc(Mode.DIRECT, offset)
        self.stream.append(Instruction(syntax, place, number, register, condition, self._operation))

    def _shift(self, syntax: str, count: int) -> None:
        for _ in range(count // _SHIFT_MAX):
            self._put(syntax, number=_SHIFT_MAX)
        if count % _SHIFT_MAX:
            self._put(syntax, number=count % _SHIFT_MAX)

    def _slot(self, key: object) -> Place:
        """Place of a value that is neither input nor constant."""
        if key not in self._slots:
            if not self._free:
                self._free.append(self._made)
                self._made += 1
            self._slots[key] = self._free.pop()
        slot = self._slots[key]
        return Loc(Mode.STACK, _LONG * (slot + 1)) if slot < _ON_STACK else self._layout.place(f"value {slot}")

    def _place(self, value: Value) -> Place:
        if value.constant is not None:
            return self._layout.constant(value.constant.raw)
        name = self._inputs.get(value.number)
        return self._slot(value.number) if name is None else self._layout.place(name)

    def _is_in_acc(self, value: Value) -> bool:
        return value.constant is None and value.number == self._acc

    def _load(self, value: Value) -> None:
        if not self._is_in_acc(value):
            self._put("MOVL ACC,loc32", self._place(value))
            self._acc = None if value.constant is not None else value.number

    def _write(self, place: int, operation: Operation, following: list[Operation]) -> None:
        self._operation = operation.op
        number = operation.result.number
        if self._is_left_in_acc(operation):
            self._acc = number
            if not self._is_taken(number, place, following):
                self._put("MOVL loc32,ACC", self._slot(number))
        for key in list(self._slots):
            if max(self._readers.get(key, [place])) <= place:
                self._free.append(self._slots.pop(key))

    def _is_taken(self, number: int, place: int, following: list[Operation]) -> bool:
        """Whether a result is needed in ACC only, by the next operation."""
        readers = self._readers.get(number, [])
        if not readers or not following or readers != [place + 1]:
            return not readers
        (after,) = following
        at = [value.number for value in after.arguments].index(number)
        return after.op in _COMMUTATIVE or _FROM_ACC.get(after.op) == at

    def _write_outputs(self, program: Program) -> None:
        self._operation = OUTPUTS
        moved = [(name, value) for name, value in program.outputs if self._inputs.get(value.number) != name]
        kept: dict[int, Place] = {}
        for value in (value for _, value in moved if self._inputs.get(value.number) in dict(moved)):
            # An input that is overwritten by another output.
            self._load(value)
            kept[value.number] = self._slot(f"kept {value.number}")
            self._put("MOVL loc32,ACC", kept[value.number])
        for name, value in moved:
            if value.number in kept:
                self._put("MOVL ACC,loc32", kept[value.number])
                self._acc = value.number
            self._load(value)
            self._put("MOVL loc32,ACC", self._layout.place(name))

    def _is_left_in_acc(self, operation: Operation) -> bool:
        """Write an operation; whether its result is in ACC. Otherwise it is in its place."""
        arguments, parameters = operation.arguments, operation.parameters
        match operation.op:
            case "add" | "sub" | "minimum" | "maximum":
                a, b = arguments
                if self._is_in_acc(b) and operation.op != "sub":
                    a, b = b, a
                self._load(a)
                self._put(f"{_BINARY[operation.op]} ACC,loc32", self._place(b))
            case "neg" | "abs":
                self._load(arguments[0])
                self._put(f"{operation.op.upper()} ACC")
            case "clip" | "sat" | "index":
                self._load(arguments[0])
                is_index = operation.op == "index"
                upper = self._layout.constant(parameters[0]) if is_index else self._place(arguments[1])
                self._put("MINL ACC,loc32", upper)
                self._put("MAXL ACC,loc32", self._layout.constant(0) if is_index else self._place(arguments[2]))
            case "convert":
                q_from, q_to = parameters
                if q_to - q_from > 31:
                    raise ValueError(f"convert from Q{q_from} to Q{q_to}")
                self._load(arguments[0])
                self._shift("LSL ACC,#1..16" if q_to > q_from else "SFR ACC,#1..16", min(abs(q_to - q_from), 31))
            case "mpy" | "rmpy" | "rsmpy":
                a, b = arguments
                self._multiply(a, b, parameters[0], rounds=operation.op != "mpy", limits=operation.op == "rsmpy")
            case "quantise":
                one = Value(-1, 0, constant=Constant("one", 1.0, 0))
                self._multiply(arguments[0], one, parameters[0] - parameters[1])
            case "dot":
                self._dot(arguments, parameters[0])
            case "at":
                self._look_up(operation)
            case "curve":
                self._interpolate(operation)
            case "gt" | "where":
                self._choose(operation)
                return False
            case "div":
                self._divide(operation)
                return False
            case _:
                raise ValueError(f"{operation.op}, for which there is no straight line of instructions")
        return True

    def _multiply(self, a: Value, b: Value, q: int, *, rounds: bool = True, limits: bool = False) -> None:
        """ACC = a product without its last ``q`` bits."""
        constant = self._layout.constant
        if self._is_in_acc(b):
            a, b = b, a
        self._put("MOVL XT,loc32", Loc(Mode.ACC) if self._is_in_acc(a) else self._place(a))
        self._put("IMPYL P,XT,loc32", self._place(b))
        self._put("QMPYL ACC,XT,loc32", self._place(b))
        self._acc = None
        if rounds:
            self._put("ADDUL P,loc32", constant(1 << (q - 1)))
            self._put("ADDCL ACC,loc32", constant(1 << (q - 1) >> 32))
        if limits:
            largest, smallest = (1 << (31 + q)) - 1, -1 << (31 + q)
            self._put("MINL ACC,loc32", constant(largest >> 32))
            self._put("MINCUL P,loc32", constant(largest))
            self._put("MAXL ACC,loc32", constant(smallest >> 32))
            self._put("MAXCUL P,loc32", constant(smallest))
        self._scale(q)

    def _scale(self, q: int) -> None:
        """ACC = the low 32 bits of ACC:P without its last ``q`` bits."""
        if q < _SHIFT_MAX:
            self._shift("ASR64 ACC:P,#1..16", q)
            self._put("MOVL ACC,P")
        else:
            self._shift("LSL64 ACC:P,#1..16", max(32 - q, 0))
            self._shift("SFR ACC,#1..16", min(max(q - 32, 0), 31))

    def _dot(self, arguments: tuple[Value, ...], q: int) -> None:
        half, total = len(arguments) // 2, self._slot("total")
        for term, pair in enumerate(zip(arguments[:half], arguments[half:], strict=True)):
            self._operation = "rmpy"
            self._multiply(*pair, q)
            self._operation = "add"
            if term:
                self._put("ADDL ACC,loc32", total)
            if term < half - 1:
                self._put("MOVL loc32,ACC", total)

    def _choose(self, operation: Operation) -> None:
        """A condition is a word, 1 if it holds."""
        result = self._slot(operation.result.number)
        if operation.op == "gt":
            a, b = operation.arguments
            self._load(a)
            self._put("MOV loc16,#0", result)
            self._put("CMPL ACC,loc32", self._place(b))
            self._put("MOVB loc16,#8bit,COND", result, 1, condition="GT")
        else:
            condition, a, b = operation.arguments
            self._load(a)
            self._put("MOVL P,loc32", self._place(b))
            self._put("MOVL loc32,P", result)
            self._put("TBIT loc16,#bit", self._place(condition))
            self._put("MOVL loc32,ACC,COND", result, condition="TC")

    def _entry(self, register: int, address: int) -> Loc:
        """The operand AR0 words after an address."""
        self._put("MOVL XARn,#22bit", number=address, register=register)
        return Loc(Mode.INDEXED, register)

    def _look_up(self, operation: Operation) -> None:
        table, (index,), (offset,) = operation.table, operation.arguments, operation.parameters
        assert table is not None
        if self._index != index.number:
            self._load(index)
            self._shift("LSL ACC,#1..16", 1)
            self._put("MOVL XARn,loc32", Loc(Mode.ACC))
            self._index = index.number
        start = self._layout.table(table.name, table.constants)
        self._put("MOVL ACC,loc32", self._entry(4, start + _LONG * offset))

    def _interpolate(self, operation: Operation) -> None:
        curve, (a,) = operation.curve, operation.arguments
        assert curve is not None
        if max(abs(right.raw - left.raw) for left, right in pairwise(curve.samples)) > INT32_MAX:
            raise ValueError(f"curve {curve.name}, whose samples are more than an int32 apart")
        bits, cell, acc = curve.q_in - 8, self._slot("cell"), Loc(Mode.ACC)
        self._load(a)
        self._shift("SFR ACC,#1..16", bits)
        self._put("MINL ACC,loc32", self._layout.constant(255))
        self._put("MAXL ACC,loc32", self._layout.constant(0))
        self._put("MOVL loc32,ACC", cell)
        self._shift("LSL ACC,#1..16", 1)
        self._put("MOVL XARn,loc32", acc)
        self._put("MOVL ACC,loc32", cell)
        self._shift("LSL ACC,#1..16", bits)
        self._put("MOVL loc32,ACC", cell)
        self._put("MOVL ACC,loc32", self._place(a))
        self._put("SUBL ACC,loc32", cell)
        self._put("MOVL XT,loc32", acc)
        start = self._layout.table(curve.name, curve.samples)
        left, right = self._entry(5, start), self._entry(4, start + _LONG)
        self._put("MOVL ACC,loc32", right)
        self._put("SUBL ACC,loc32", left)
        self._put("IMPYL P,XT,loc32", acc)
        self._put("QMPYL ACC,XT,loc32", acc)
        self._scale(bits)
        self._put("ADDL ACC,loc32", left)
        self._index = None

    def _divide(self, operation: Operation) -> None:
        """Long division of the magnitudes; the remainder decides the rounding, ties upward."""
        a, b = operation.arguments
        result = self._slot(operation.result.number)
        over, zero, negative, divisor, tie = map(self._slot, ("over", "zero", "negative", "divisor", "tie"))
        largest = self._layout.constant(INT32_MAX)

        def flag(place: Place, condition: str) -> None:
            self._put("MOVB loc16,#8bit,COND", place, 1, condition=condition)

        for place in (over, zero, negative):
            self._put("MOV loc16,#0", place)
        self._put("CLRC TC")
        self._load(b)
        self._put("ABSTC ACC")
        flag(zero, "EQ")
        self._put("MOVL loc32,ACC", divisor)
        self._put("MOVL ACC,loc32", self._place(a))
        self._put("ABSTC ACC")
        flag(negative, "TC")
        self._put("MOVL P,ACC")
        # Twice the remainder from which on the magnitude is rounded up: one more if the quotient is negative.
        self._put("MOVL ACC,loc32", divisor)
        self._put("ADDU ACC,loc16", negative)
        self._put("MOVL loc32,ACC", tie)
        self._put("MOVB ACC,#8bit")
        self._shift("LSL64 ACC:P,#1..16", operation.parameters[0])
        self._put("CMPL ACC,loc32", divisor)
        flag(over, "HIS")
        self._put("RPT #8bit", number=31)
        self._put("SUBCUL ACC,loc32", divisor)
        self._shift("LSL ACC,#1..16", 1)
        self._put("CMPL ACC,loc32", tie)
        self._put("MOVL ACC,P")
        # The sum is below 2^32: a numerator of 32 bits gives no quotient that rounds up to it.
        self._put("ADDCL ACC,loc32", self._layout.constant(0))
        flag(over, "LT")
        self._put("NEGTC ACC")
        self._put("MOVL loc32,ACC", result)
        # INT32_MAX plus one is INT32_MIN.
        self._put("MOVL ACC,loc32", largest)
        self._put("ADDU ACC,loc16", negative)
        self._put("TBIT loc16,#bit", over)
        self._put("MOVL loc32,ACC,COND", result, condition="TC")
        self._put("MOVL ACC,loc32", largest)
        self._put("TBIT loc16,#bit", zero)
        self._put("MOVL loc32,ACC,COND", result, condition="TC")
        self._acc = None
