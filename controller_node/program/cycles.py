"""Cycles of a law's operations on a TMS320F28335 at 150 MHz.

A law has no branches, so every control period has the same operations: the estimate is also the worst case.
"""

from __future__ import annotations

from collections import Counter

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
