"""C28x instructions and a machine that executes them: the part of the instruction set that exported laws need.

Written from TI's TMS320C28x CPU and Instruction Set Reference Guide (SPRU430F): flags from the tables of chapter 2,
inactive cycles from section 4.4, addressing modes from chapter 5, results and cycles from chapter 6. It is a model, and
no chip has confirmed it. There is no branch in it. Program and data are in memory without wait states; two accesses to
one memory block in the same cycle, and interrupts, are not modelled. V is not kept, because no instruction here
depends on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Final, NamedTuple

_MASK: Final = 0xFFFF_FFFF
_SIGN: Final = 0x8000_0000
_LOW: Final = 0xFFFF
#: Cycles between an instruction that writes a memory location, or an auxiliary register in its execute phase, and the
#: first one that can read the location or use the register for an address (section 4.4).
_SETTLED: Final = 4

#: The instructions: syntax, words of program memory, cycles. For SETC and CLRC the guide has "1, 2": it is 1 for the
#: bits here, because the cycles that TI states for its functions (IQNint, IQNmpyI32int) leave no more.
_TABLE = """
MOVL ACC,loc32        1 1 | MOVL loc32,ACC        1 1 | MOVL loc32,ACC,COND   2 1 | MOVL P,loc32          1 1
MOVL loc32,P          1 1 | MOVL P,ACC            1 1 | MOVL ACC,P            1 1 | MOVL XT,loc32         1 1
MOVL XARn,loc32       1 1 | MOVL XARn,#22bit      2 1 | MOVB ACC,#8bit        1 1 | MOV loc16,#0          1 1
MOVB loc16,#8bit,COND 2 1 | MOVW DP,#16bit        2 1 | ADDB SP,#7bit         1 1 | SUBB SP,#7bit         1 1
ADDL ACC,loc32        1 1 | SUBL ACC,loc32        1 1 | ADDU ACC,loc16        1 1 | ADDUL P,loc32         2 1
ADDCL ACC,loc32       2 1 | NEG ACC               1 1 | ABS ACC               1 1 | ABSTC ACC             1 1
NEGTC ACC             1 1 | LSL ACC,#1..16        1 1 | SFR ACC,#1..16        1 1 | LSL64 ACC:P,#1..16    1 1
ASR64 ACC:P,#1..16    1 1 | IMPYL P,XT,loc32      2 1 | QMPYL ACC,XT,loc32    2 2 | CMPL ACC,loc32        1 1
MINL ACC,loc32        2 1 | MAXL ACC,loc32        2 1 | MINCUL P,loc32        2 1 | MAXCUL P,loc32        2 1
SUBCUL ACC,loc32      2 1 | RPT #8bit             1 1 | TBIT loc16,#bit       1 1 | CLRC TC               1 1
CLRC OVM              1 1 | SETC SXM              1 1 | SPM 0                 1 1 | LCR #22bit            2 4
LRETR                 1 4
"""


class Cost(NamedTuple):
    """Words of program memory and cycles of an instruction."""

    words: int
    cycles: int


#: What each instruction costs, by its syntax in the guide's headings.
INSTRUCTIONS = {
    entry.rsplit(maxsplit=2)[0].strip(): Cost(*map(int, entry.split()[-2:]))
    for entry in _TABLE.replace("\n", "|").split("|")
    if entry.strip()
}


class Mode(Enum):
    """Addressing modes of an operand (loc16, loc32)."""

    #: Offset in the page of 64 words that DP selects.
    DIRECT = "@{}"
    #: Words below the stack pointer.
    STACK = "*-SP[{}]"
    #: Address in an auxiliary register, plus AR0.
    INDEXED = "*+XAR{}[AR0]"
    #: The accumulator itself.
    ACC = "@ACC"


class Loc(NamedTuple):
    """An operand: its addressing mode, and the number in it."""

    mode: Mode
    number: int = 0

    def __str__(self) -> str:
        return self.mode.value.format(self.number)


class Instruction(NamedTuple):
    """One instruction.

    ``syntax``: a key of :data:`INSTRUCTIONS`. ``number``: the constant in it. ``register``: n of XARn. ``condition``:
    COND. ``operation``: the law's operation for which it is there.
    """

    syntax: str
    loc: Loc | None = None
    number: int = 0
    register: int = 0
    condition: str = ""
    operation: str = ""

    def __str__(self) -> str:
        name, _, operands = self.syntax.partition(" ")
        parts = [f"#{self.number}" if part.startswith("#") else part for part in operands.split(",")]
        text = f"{name} {','.join(parts)}".replace("XARn", f"XAR{self.register}").replace("COND", self.condition)
        return text.replace("loc32", str(self.loc)).replace("loc16", str(self.loc)).strip()


def signed(word: int) -> int:
    """32 bits as a signed number."""
    return (word ^ _SIGN) - _SIGN


class Machine:
    """Registers and data memory; 32-bit values are held without sign.

    ``memory``: 32-bit values by the address of their low word, which is even. A 16-bit operand is their low word.
    """

    def __init__(self) -> None:
        self.acc = self.p = self.xt = 0
        self.xar = [0] * 8
        self.dp = self.sp = 0
        self.n = self.z = self.c = self.tc = self.sxm = self.ovm = False
        #: Net overflows of ACC, and carries of ADDUL, since it was cleared: 6 bits.
        self.ovc = 0
        #: Right shift of a product; unknown before SPM.
        self.pm: int | None = None
        self.repeat = 0
        self.memory: dict[int, int] = {}

    def execute(self, stream: Sequence[Instruction]) -> None:
        """Execute the instructions in their order.

        :raises KeyError: one reads a location to which nothing has been written.
        """
        for instruction in stream:
            for _ in range(self.repeat + 1):
                self.repeat = 0
                self._run(instruction)

    def measure(self, stream: Sequence[Instruction]) -> list[int]:
        """Execute the instructions; returns the cycles of each one, with the inactive ones before it.

        Without branches the cycles do not depend on data.
        """
        written: dict[int | None, int] = {}
        now, taken = 0, []
        for instruction in stream:
            syntax, loc = instruction.syntax, instruction.loc
            address = None if loc is None or loc.mode is Mode.ACC else self._address(loc)
            needed: list[int | None] = [] if address is None or _writes(syntax) else [address]
            if loc is not None and loc.mode is Mode.INDEXED:
                needed.append(_AR0)
            start = max([now, *(written[place] + _SETTLED for place in needed if place in written)])
            if _writes(syntax) or syntax == "MOVL XARn,loc32":
                written[_AR0 if address is None else address] = start
            end = start + INSTRUCTIONS[syntax].cycles + self.repeat
            self.execute([instruction])
            taken.append(end - now)
            now = end
        return taken

    def _address(self, loc: Loc) -> int:
        match loc.mode:
            case Mode.DIRECT:
                return self.dp << 6 | loc.number
            case Mode.STACK:
                return self.sp - loc.number
        return self.xar[loc.number] + (self.xar[0] & _LOW)

    def _read(self, loc: Loc) -> int:
        return self.acc if loc.mode is Mode.ACC else self.memory[self._address(loc)]

    def _write(self, instruction: Instruction, value: int) -> None:
        assert instruction.loc is not None
        address = self._address(instruction.loc)
        if "loc16" in instruction.syntax:
            value |= self.memory.get(address, 0) & ~_LOW
        self.memory[address] = value

    def _set(self, value: int, carry: bool | None = None) -> None:
        """ACC with flags N, Z and, if given, C."""
        self.acc = value & _MASK
        self.n, self.z = self.acc >= _SIGN, self.acc == 0
        if carry is not None:
            self.c = carry

    def _set_pair(self, value: int) -> None:
        """ACC:P with flags N and Z."""
        self._set(value >> 32)
        self.p = value & _MASK
        self.z = self.z and self.p == 0

    def _sum(self, exact: int, carry: bool) -> None:
        """ACC after a sum: saturated with OVM, else the overflow is counted."""
        over = (exact >= _SIGN) - (exact < -_SIGN)
        if over and self.ovm:
            exact = _SIGN - 1 if over > 0 else _SIGN
        elif over:
            self._count_overflow(over)
        self._set(exact, carry)

    def _count_overflow(self, count: int) -> None:
        self.ovc = (self.ovc + count + 32) % 64 - 32

    def _negative(self) -> int:
        """The negative of ACC; the smallest number stays or, with OVM, is saturated."""
        return _SIGN - 1 if self.acc == _SIGN and self.ovm else -self.acc

    def _compare(self, value: int) -> None:
        """Flags of ACC - value; N is the sign of the exact difference, C means no borrow."""
        difference = signed(self.acc) - signed(value)
        self.n, self.z, self.c = difference < 0, difference == 0, self.acc >= value

    def _holds(self, condition: str) -> bool:
        match condition:
            case "GT":
                return not self.n and not self.z
            case "EQ":
                return self.z
            case "LT":
                return self.n
            case "HIS":
                return self.c
        assert condition == "TC", condition
        return self.tc

    def _run(self, instruction: Instruction) -> None:
        syntax, number = instruction.syntax, instruction.number
        loc = instruction.loc
        value = 0 if loc is None or _writes(syntax) else self._read(loc)
        acc, pair = signed(self.acc), signed(self.acc) << 32 | self.p
        match syntax:
            case "MOVL ACC,loc32":
                self._set(value)
            case "MOVL loc32,ACC":
                self._write(instruction, self.acc)
            case "MOVW DP,#16bit":
                self.dp = number
            case "MOVL XT,loc32":
                self.xt = value
            case "IMPYL P,XT,loc32":
                assert self.pm == 0
                self.p = signed(self.xt) * signed(value) & _MASK
            case "QMPYL ACC,XT,loc32":
                self._set(signed(self.xt) * signed(value) >> 32)
            case "ADDUL P,loc32":
                self.c = self.p + value > _MASK
                self._count_overflow(self.c)
                self.p = self.p + value & _MASK
                self.n, self.z = self.p >= _SIGN, self.p == 0
            case "ADDCL ACC,loc32":
                self._sum(acc + signed(value) + self.c, self.acc + value + self.c > _MASK)
            case "LSL64 ACC:P,#1..16":
                self.c = bool(pair >> (64 - number) & 1)
                self._set_pair(pair << number)
            case "ASR64 ACC:P,#1..16":
                self.c = bool(pair >> (number - 1) & 1)
                self._set_pair(pair >> number)
            case "ADDL ACC,loc32":
                self._sum(acc + signed(value), self.acc + value > _MASK)
            case "SUBL ACC,loc32":
                self._sum(acc - signed(value), self.acc >= value)
            case "ADDU ACC,loc16":
                self._sum(acc + (value & _LOW), self.acc + (value & _LOW) > _MASK)
            case "MINL ACC,loc32":
                self._compare(value)
                self.acc = self.acc if self.n else value
            case "MAXL ACC,loc32":
                self._compare(value)
                self.acc = value if self.n else self.acc
            case "MINCUL P,loc32":
                # After MINL of the upper half: that was larger, or the same.
                if not self.n:
                    self.p = min(self.p, value) if self.z else value
            case "MAXCUL P,loc32":
                if self.n or self.z:
                    self.p = value if self.n else max(self.p, value)
            case "CMPL ACC,loc32":
                self._compare(value)
            case "LSL ACC,#1..16":
                self._set(self.acc << number, bool(self.acc >> (32 - number) & 1))
            case "SFR ACC,#1..16":
                self._set((acc if self.sxm else self.acc) >> number, bool(self.acc >> (number - 1) & 1))
            case "NEG ACC":
                self._set(self._negative(), self.acc == 0)
            case "ABS ACC" | "ABSTC ACC":
                self.tc = self.tc != (acc < 0) if syntax == "ABSTC ACC" else self.tc
                self._set(self._negative() if acc < 0 else acc, False)
            case "NEGTC ACC":
                self._set(self._negative() if self.tc else acc, self.acc == 0 if self.tc else None)
            case "MOVL loc32,ACC,COND" | "MOVB loc16,#8bit,COND":
                if self._holds(instruction.condition):
                    self._write(instruction, number if syntax.startswith("MOVB") else self.acc)
            case "MOV loc16,#0":
                self._write(instruction, 0)
            case "MOVL loc32,P":
                self._write(instruction, self.p)
            case "MOVL P,loc32":
                self.p = value
            case "MOVL P,ACC":
                self.p = self.acc
            case "MOVL ACC,P":
                assert self.pm == 0
                self._set(self.p)
            case "MOVB ACC,#8bit":
                self._set(number)
            case "MOVL XARn,loc32":
                self.xar[instruction.register] = value
            case "MOVL XARn,#22bit":
                self.xar[instruction.register] = number
            case "SUBCUL ACC,loc32":
                rest = self.acc << 1 | self.p >> 31
                taken = rest >= value
                self._set(rest - value if taken else rest, taken)
                self.p = (self.p << 1 | taken) & _MASK
            case "RPT #8bit":
                self.repeat = number
            case "TBIT loc16,#bit":
                self.tc = bool(value >> number & 1)
            case "ADDB SP,#7bit":
                self.sp += number
            case "SUBB SP,#7bit":
                self.sp -= number
            case "CLRC TC":
                self.tc = False
            case "CLRC OVM":
                self.ovm = False
            case "SETC SXM":
                self.sxm = True
            case "SPM 0":
                self.pm = 0
            case _:
                assert syntax in ("LCR #22bit", "LRETR"), syntax


#: Key of the auxiliary register that is part of an address, beside the addresses of memory.
_AR0: Final = None


def _writes(syntax: str) -> bool:
    """Whether the operand is the destination."""
    return syntax.partition(" ")[2].startswith("loc") and not syntax.startswith("TBIT")
