"""The cost of one control period of a law on the TMS320F28335, relative to the available time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.arithmetic.float32 import Single
from railhil.controller_node.program.cycles import C28X_CYCLES, CPU_MHZ, FLASH_FACTOR, FPU_CYCLES, estimated_cycles
from railhil.controller_node.program.model import LawProgram


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
