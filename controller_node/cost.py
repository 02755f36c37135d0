"""The cost of one control period of a law on the TMS320F28335, relative to the available time.

A law has no branches, so every control period has the same operations: the estimate is also the worst case.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.arithmetic.float32 import Single
from railhil.controller_node.program.model import LawProgram

#: Clock of the F28335.
CPU_MHZ = 150
#: Our estimate of the factor for program and constants in flash at 150 MHz (5 wait states, pipelined) instead of RAM.
FLASH_FACTOR = 2

#: IQ arithmetic, including call and return, with tables in internal memory: TI IQmath user's guide V1.70, section 4.3.
#: Additions, shifts, comparisons, branches and memory traffic are our estimates.
C28X_CYCLES = {
    "mpy": 6,
    "rmpy": 17,
    "rsmpy": 21,
    "mpy_iqx": 7,
    "div": 63,
    "sqrt": 63,
    "sat": 7,
    "clip": 7,
    "abs": 2,
    "neg": 2,
    "add": 2,
    "sub": 2,
    "convert": 4,
    "quantise": 17,
    "minimum": 4,
    "maximum": 4,
    "gt": 2,
    "where": 4,
    "index": 7,
    "at": 2,
    # Two shifts, an index computation, two loads, a product, three sums.
    "curve": 28,
    "locate_step": 8,
}

#: float32 on the FPU: TI FPU fast RTS guide (div, sqrt); two cycles for a product or sum with its delay slot.
FPU_CYCLES = C28X_CYCLES | {
    "mpy": 2,
    "rmpy": 2,
    "rsmpy": 2,
    "mpy_iqx": 2,
    "div": 25,
    "sqrt": 29,
    "sat": 2,
    "clip": 2,
    "abs": 1,
    "neg": 1,
    "convert": 0,
    # Scale, floor, scale.
    "quantise": 8,
    "minimum": 1,
    "maximum": 1,
    "gt": 1,
    "where": 4,
    "curve": 20,
}

#: Two operands in, one out.
_LOAD_STORE = 2


def estimated_cycles(counts: Counter[str], table: dict[str, int] | None = None) -> int:
    """Cycles of counted operations with program and data in RAM; times :data:`FLASH_FACTOR` from flash.

    :raises KeyError: an operation that is not in the table.
    """
    costs = C28X_CYCLES if table is None else table
    return sum((costs[operation] + _LOAD_STORE) * count for operation, count in counts.items() if costs[operation])


@dataclass(frozen=True, slots=True)
class Cost:
    """Operations and estimated C28x cycles of one control period; a law has no branches, so this is also the worst
    case.

    ``cycles`` has program and data in RAM and is 0 for an arithmetic that the chip does not support (float64).
    """

    operations: dict[str, int]
    cycles: int
    period_ns: int

    @property
    def cycles_flash(self) -> int:
        """Cycles with the program in flash."""
        return self.cycles * FLASH_FACTOR

    @property
    def ram_us(self) -> float:
        """Time with the program in RAM, in us."""
        return self.cycles / CPU_MHZ

    @property
    def flash_us(self) -> float:
        """Time with the program in flash, in us."""
        return self.cycles_flash / CPU_MHZ

    @property
    def share(self) -> float:
        """Share of the control period with the program in flash, 1 = all of it."""
        return self.flash_us * 1000 / self.period_ns


def cost_of(program: LawProgram, arithmetic: Arithmetic[Any], period_ns: int) -> Cost:
    """Cost of a law in an arithmetic.

    :param program: recorded ``wide`` for a wide arithmetic.
    """
    counts = program.step_counts()
    cycles = 0
    if isinstance(arithmetic, Single):
        cycles = estimated_cycles(counts, FPU_CYCLES)
    elif not arithmetic.wide:
        cycles = estimated_cycles(counts, C28X_CYCLES)
    return Cost(dict(sorted(counts.items(), key=lambda item: (-item[1], item[0]))), cycles, period_ns)
