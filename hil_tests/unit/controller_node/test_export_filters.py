"""The exported filter tables: a model of each controller's acceptance rule tries every 11-bit identifier."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from railhil.controller_node.ato.node import ANSWERS, MAILBOXES, SAFE_ANSWERS, SAFE_MAILBOXES
from railhil.controller_node.ecan import Mailbox, mailbox_table
from railhil.controller_node.export.filters import Filter, filters_header, narrow_filters
from railhil.dbc import wire_contract

CONTRACT = wire_contract()
SIDES = {"plain": (MAILBOXES, ANSWERS), "sdt": (SAFE_MAILBOXES, SAFE_ANSWERS)}
TABLES = {
    name: mailbox_table(CONTRACT, *([CONTRACT.port(telegram.PORT) for telegram in side] for side in sides))
    for name, sides in SIDES.items()
}
#: Standard data frames, standard remote frames, extended data frames with the same base identifier.
KINDS = ("data", "remote", "extended")


Accepts = Callable[[int, str], bool]


def words(header: str, chip: str) -> list[list[int]]:
    """Rows of one table of the header; its length is what the macro says."""
    found = re.search(rf"railhil_{chip}_filters\[\w+\](?:\[2\])? = {{\n(.*?)\n}};", header, flags=re.DOTALL)
    assert found is not None
    rows = [[int(word, 16) for word in re.findall(r"UINT32_C\((0x\w+)\)", row)] for row in found[1].splitlines()]
    assert f"#define RAILHIL_{chip.upper()}_FILTER_COUNT {len(rows)}u\n" in header
    return rows


def macro(header: str, name: str) -> int:
    found = re.search(rf"#define {name} UINT32_C\((0x\w+)\)\n", header)
    assert found is not None
    return int(found[1], 16)


def bxcan(header: str) -> Accepts:
    """RM0008, filter banks: in 16-bit list mode STDID[10:0], RTR, IDE, EXID[17:15] equal one half of a word."""
    halves = {half for bank in words(header, "bxcan") for word in bank for half in (word & 0xFFFF, word >> 16)}
    return lambda can_id, kind: can_id << 5 | (kind == "remote") << 4 | (kind == "extended") << 3 in halves


def mcan(header: str) -> Accepts:
    """M_CAN 3.3.0, 2.4.5: SFT 1 compares SFID1 and SFID2, SFEC 1 stores in FIFO 0; GFC decides on all others."""
    elements = [element for (element,) in words(header, "mcan")]
    gfc, rxgfc = macro(header, "RAILHIL_MCAN_GFC"), macro(header, "RAILHIL_FDCAN_RXGFC")
    assert (rxgfc & 0x3F, rxgfc >> 16 & 0x1F) == (gfc, len(elements))
    assert {(element >> 30, element >> 27 & 7) for element in elements} == {(1, 1)}
    listed = {can_id for element in elements for can_id in (element >> 16 & 0x7FF, element & 0x7FF)}
    # ANFS, ANFE: frames without an element go to a FIFO below 2; RRFS: remote frames are rejected before.
    others = {"data": gfc >> 4 & 3 < 2, "extended": gfc >> 2 & 3 < 2, "remote": False}
    return lambda can_id, kind: (
        not gfc & 0b10 if kind == "remote" else others[kind] or (kind == "data" and can_id in listed)
    )


def zynqmp(header: str) -> Accepts:
    """UG1085, CAN acceptance filters: equal in the bits that are 1 in AFMR; SRR is RTR of a standard frame."""
    rows = words(header, "zynqmp")

    def accepts(can_id: int, kind: str) -> bool:
        word = can_id << 21 | (kind != "data") << 20 | (kind == "extended") << 19
        return any(not (word ^ identifier) & mask for mask, identifier in rows)

    return accepts


RULES: dict[str, Callable[[str], Accepts]] = {"bxcan": bxcan, "mcan": mcan, "zynqmp": zynqmp}


def passing(accepts: Accepts, kind: str = "data") -> set[int]:
    return {can_id for can_id in range(0x800) if accepts(can_id, kind)}


def expected(table: tuple[Mailbox, ...]) -> set[int]:
    """By the eCAN's rule, with which the tables must agree."""
    return {can_id for can_id in range(0x800) if any(box.accepts(can_id) for box in table if not box.transmit)}


@pytest.mark.parametrize("table", TABLES.values(), ids=TABLES)
@pytest.mark.parametrize("chip", ["bxcan", "mcan"])
def test_list_of_identifiers_accepts_exactly_those_of_the_mailboxes(chip: str, table: tuple[Mailbox, ...]) -> None:
    accepts = RULES[chip](filters_header("ipfc", table))
    assert passing(accepts) == expected(table)
    assert [passing(accepts, kind) for kind in KINDS[1:]] == [set(), set()]


@pytest.mark.parametrize("table", TABLES.values(), ids=TABLES)
def test_masks_accept_those_of_the_mailboxes_and_the_header_names_the_others(table: tuple[Mailbox, ...]) -> None:
    header = filters_header("ipfc", table)
    accepts = zynqmp(header)
    comment = header.partition("/* ZynqMP")[2].partition("*/")[0]
    named = {int(word, 16) for word in re.findall(r"\b0x[0-9a-f]+", comment)}
    assert passing(accepts) > expected(table)
    assert passing(accepts) - expected(table) == named
    assert len(named) < 24
    assert len(words(header, "zynqmp")) == 4
    assert [passing(accepts, kind) for kind in KINDS[1:]] == [set(), set()]


def test_filters_are_exact_where_there_are_enough() -> None:
    """Two neighbours are one filter; four identifiers that fill two masks are two filters."""
    assert narrow_filters([0x10, 0x11], 1) == [Filter(0x10, 0x7FE)]
    assert narrow_filters([0x10, 0x11, 0x200, 0x210], 2) == [Filter(0x10, 0x7FE), Filter(0x200, 0x7EF)]
    assert narrow_filters([5, 5, 5], 4) == [Filter(5, 0x7FF)]
    few = (Mailbox(0, "A", "A", 0x123), Mailbox(31, "POLL", "POLL", 0x80), Mailbox(30, "B", "B", 0x200, transmit=True))
    header = filters_header("law", few)
    assert [passing(rule(header)) for rule in RULES.values()] == [{0x123, 0x80}] * 3
    assert "NOT exact" not in header
