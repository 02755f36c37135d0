"""Acceptance filters for CAN controllers other than the eCAN, from the same mailbox table: ``railhil_filters.h``.

Each table holds register words in the layout of the chip's manual, so that a driver copies them. The identifiers are
the 11-bit ones that a receive mailbox accepts. A list of identifiers accepts exactly these. A controller with fewer
filters than identifiers compares some bits only; the header then names the other identifiers that pass, which
``railhil_receive`` counts as frames without a mailbox.

Sources: ST RM0008 (bxCAN, identifier list mode, scale 16 bits), RM0440 (FDCAN, RXGFC, standard filter element); Bosch
M_CAN user's manual 3.3.0 (GFC, standard message ID filter element); AMD UG1087 (CAN: AFR, AFMR1..4, AFIR1..4).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Final, NamedTuple

from railhil.controller_node.ecan import Mailbox
from railhil.controller_node.export.text import header

_IDENTIFIERS: Final = range(0x800)
_ALL_BITS: Final = 0x7FF
#: Filters of a ZynqMP's CAN controller.
_ZYNQMP_FILTERS: Final = 4
#: GFC: frames that match no element are rejected (ANFS, ANFE 2), remote frames too (RRFS, RRFE).
_REJECT_OTHERS: Final = 2 << 4 | 2 << 2 | 1 << 1 | 1


class Filter(NamedTuple):
    """One filter: it accepts an 11-bit identifier that equals ``can_id`` in every bit that is set in ``compared``."""

    can_id: int
    compared: int

    def accepts(self, can_id: int) -> bool:
        """Whether the identifier passes."""
        return not (can_id ^ self.can_id) & self.compared

    @property
    def size(self) -> int:
        """Number of the 11-bit identifiers that pass."""
        return 1 << (_ALL_BITS & ~self.compared).bit_count()

    def joined(self, other: Filter) -> Filter:
        """The narrowest filter that accepts what either accepts."""
        compared = self.compared & other.compared & ~(self.can_id ^ other.can_id)
        return Filter(self.can_id & compared, compared)


def narrow_filters(identifiers: Sequence[int], count: int) -> list[Filter]:
    """At most ``count`` filters that accept all identifiers, and few others.

    Two filters at a time are joined, those that let in the fewest further identifiers. The result is the same for the
    same identifiers, but not the best possible.
    """
    filters = [Filter(can_id, _ALL_BITS) for can_id in sorted(set(identifiers))]
    while len(filters) > count:
        pairs = combinations(filters, 2)
        one, other = min(pairs, key=lambda pair: pair[0].joined(pair[1]).size - pair[0].size - pair[1].size)
        joined = one.joined(other)
        filters = sorted({joined, *(each for each in filters if each.joined(joined) != joined)})
    return filters


def filters_header(name: str, table: Sequence[Mailbox]) -> str:
    """Text of ``railhil_filters.h``.

    :param name: of the law in C.
    :param table: the checked mailbox table.
    """
    received = [box for box in table if not box.transmit]
    identifiers = [can_id for can_id in _IDENTIFIERS if any(box.accepts(can_id) for box in received)]
    masked = narrow_filters(identifiers, _ZYNQMP_FILTERS)
    others = [i for i in _IDENTIFIERS if i not in identifiers and any(one.accepts(i) for one in masked)]
    elements = [f"    {_hex(1 << 30 | 1 << 27 | one << 16 | other)}," for one, other in _groups(identifiers, 2)]
    return header(
        "RAILHIL_FILTERS_H",
        [
            "railhil_filters.h: acceptance filters of some CAN controllers for the received frames of",
            f"{name}_mailboxes.h: {len(identifiers)} identifiers of 11 bits, data frames. All go to one receive",
            "FIFO, which keeps the order of the bus. Register words in the layout of the chip's manual.",
            "Generated: export again, do not edit. Not run on these chips.",
        ],
        ["<stdint.h>"],
        [
            "/* bxCAN (STM32F1, F2, F4, L4): words FxR1 and FxR2 of a filter bank in identifier list mode (FM1R 1)",
            " * with 16 bits a filter (FS1R 0), for FIFO 0 (FFA1R 0). Exact. */",
            *_table("BXCAN", "[2]", [f"    {{{', '.join(map(_hex, bank))}}}," for bank in _bxcan(identifiers)]),
            "",
            "/* M_CAN and ST's FDCAN: standard message ID filter elements, two identifiers each, for FIFO 0. Exact,",
            " * with all other frames rejected: GFC of an M_CAN or of an STM32H7; RXGFC where ST's message RAM is",
            " * fixed (STM32G0, G4, H5, L5, U5), which also holds the number of elements. */",
            *_table("MCAN", "", elements),
            f"#define RAILHIL_MCAN_GFC {_hex(_REJECT_OTHERS)}",
            f"#define RAILHIL_FDCAN_RXGFC {_hex(len(elements) << 16 | _REJECT_OTHERS)}",
            "",
            "/* ZynqMP and Zynq-7000: AFMRn and AFIRn, to be written while UAFn in AFR is 0.",
            *_others(others),
            " */",
            *_table("ZYNQMP", "[2]", [f"    {{{', '.join(map(_hex, _zynqmp(one)))}}}," for one in masked]),
            "",
        ],
    )


def _hex(word: int) -> str:
    return f"UINT32_C({word:#010x})"


def _table(chip: str, columns: str, rows: Sequence[str]) -> list[str]:
    count = f"RAILHIL_{chip}_FILTER_COUNT"
    first = f"static const uint32_t railhil_{chip.lower()}_filters[{count}]{columns} = {{"
    return [f"#define {count} {len(rows)}u", first, *rows, "};"]


def _groups(identifiers: Sequence[int], size: int) -> list[list[int]]:
    """The identifiers in groups of one size; the last one repeats its last identifier."""
    groups = [list(identifiers[i : i + size]) for i in range(0, len(identifiers), size)]
    return [group + [group[-1]] * (size - len(group)) for group in groups]


def _bxcan(identifiers: Sequence[int]) -> list[tuple[int, int]]:
    """Banks of four: STDID in bits 15:5 of each half word; RTR, IDE and EXID of a standard data frame are 0."""
    return [(a << 5 | b << 21, c << 5 | d << 21) for a, b, c, d in _groups(identifiers, 4)]


def _zynqmp(one: Filter) -> tuple[int, int]:
    """Mask and identifier: bits 31:21; bits 20 (SRR) and 19 (IDE) are compared with 0."""
    return one.compared << 21 | 1 << 20 | 1 << 19, one.can_id << 21


def _others(others: Sequence[int]) -> list[str]:
    """Lines of a comment: the identifiers that pass although no mailbox receives them."""
    if not others:
        return [" * Exact."]
    words = [f"{can_id:#05x}" for can_id in others]
    lines = [f" *   {' '.join(words[i : i + 12])}" for i in range(0, len(words), 12)]
    return [f" * NOT exact: {_ZYNQMP_FILTERS} filters also let in the identifiers", *lines]
