"""The controller's mailbox table: its content, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.paths import ROOT
from railhil.common.exit_codes import USAGE, exit_code_of
from railhil.controller_node.ato.node import ANSWERS, MAILBOXES, mailboxes
from railhil.controller_node.ecan.mailboxes import POLL, Mailbox, check_table, mailbox_table
from railhil.dbc import ContractError, Port, wire_contract

CONTRACT = wire_contract()
RECEIVED = [CONTRACT.port(telegram.PORT) for telegram in MAILBOXES]
SENT = [CONTRACT.port(telegram.PORT) for telegram in ANSWERS]
DOCUMENT = ROOT / "docs" / "explanation" / "ecan.md"


def by_name() -> dict[str, Mailbox]:
    return {box.name: box for box in mailboxes()}


def test_each_frame_of_each_port_has_its_own_mailbox():
    table = mailboxes()
    assert len(table) == len({box.number for box in table}) <= 32
    assert {box.can_id for box in table if not box.transmit} == {0x080, *(i for port in RECEIVED for i in port.can_ids)}
    assert {box.can_id for box in table if box.transmit} == {0x088, *(i for port in SENT for i in port.can_ids)}
    assert {box.length for box in table if box.name != POLL} == {8}
    assert by_name()[POLL] == Mailbox(31, POLL, POLL, 0x080, length=3)
    assert [box.number for box in table] == sorted(box.number for box in table)


def test_order_of_the_numbers_is_the_order_on_the_wire():
    """Sent: the highest number leaves first. Read together: the trailer must come after its blocks."""
    names = by_name()
    assert names["CTL_STAT.0"].number > names["CTL_STAT.1"].number > names["CTL_STAT.trailer"].number
    assert names["TRK_INFO.0"].number < names["TRK_INFO.1"].number < names["TRK_INFO.trailer"].number
    assert names["TRN_SPEED"].number == 0
    assert max(names.values(), key=lambda box: box.number).name == POLL


def test_only_the_controller_s_ports_are_let_in():
    for port in CONTRACT.ports:
        heard = {any(box.accepts(i) and not box.transmit for box in mailboxes()) for i in port.can_ids}
        assert heard == {port in RECEIVED}, port.name
    assert not any(box.accepts(0x080, extended=True) for box in mailboxes())


def test_document_prints_the_table():
    rows = [
        f"| {box.number} | {box.name} | {box.can_id:#05x} | {box.mask:#05x} | "
        f"{'transmit' if box.transmit else 'receive'} | {box.length} |"
        for box in mailboxes()
    ]
    lines = DOCUMENT.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith("| ") and "receive" in line.split(" | ")[4:5]] == [
        row for row in rows if "receive" in row
    ]
    assert [line for line in lines if line.startswith("| ") and "transmit" in line.split(" | ")[4:5]] == [
        row for row in rows if "transmit" in row
    ]


def changed(name: str, **values: object) -> list[Mailbox]:
    return [replace(box, **values) if box.name == name else box for box in mailboxes()]  # type: ignore[arg-type]


FREE = 20


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (changed("TRN_SPEED", number=32), "TRN_SPEED: number: found 32, allowed 0..31"),
        (changed("TRN_SPEED", number=-1), "number: found -1"),
        (changed("TRN_SPEED", number=31), "number: found 31 again in POLL"),
        (changed("TRN_SPEED", can_id=0x918), "identifier: found 0x918, allowed 0..0x7ff"),
        (changed("TRN_SPEED", can_id=0x2000_0000, extended=True), "allowed 0..0x1fffffff"),
        (changed("TRN_SPEED", mask=0x800), "mask: found 0x800"),
        (changed("NOTCH_CMD", mask=1), "mask: found 0x1, allowed 0 in a transmit mailbox"),
        (changed("TRN_SPEED", length=9), "length: found 9, allowed 0..8 bytes"),
        (changed("TRN_SPEED", length=4), "length: found 4, allowed 8 bytes"),
        (changed("POLL", length=8), "length: found 8, allowed 3 bytes"),
        (changed("TRN_SPEED", extended=True), "TRN_SPEED: 0x118: found no mailbox"),
        (changed("TRN_SPEED", transmit=True), "TRN_SPEED: 0x118: found no mailbox, allowed a receive mailbox"),
        (changed("CTL_STAT.1", transmit=False), "CTL_STAT: 0x139: found no mailbox, allowed a transmit mailbox"),
        (changed("DEVICE_STATUS", can_id=0x089), "DEVICE_STATUS: 0x88: found no mailbox"),
        ([box for box in mailboxes() if box.name != "TRK_INFO.1"], "TRK_INFO: 0x131: found no mailbox"),
        ([box for box in mailboxes() if box.name != "POLL"], "POLL: 0x80: found no mailbox"),
        (changed("PLT_STAT", can_id=0x118), "identifier: found 0x118, also matched by mailbox"),
        (changed("PLT_STAT", mask=0x008), "also matched by"),
        (changed("NOTCH_CMD", can_id=0x118), "identifier: found 0x118 in both directions"),
        (changed("NOTCH_CMD", can_id=0x138), "identifier: found 0x138, also matched by"),
        # One don't-care bit more, and the simulated truth comes in beside the balise.
        (changed("BALISE.0", mask=0x010), "mask: found 0x10, which lets SIM_TRUTH in"),
        (changed("TRN_SPEED", can_id=0x110, mask=0x008), "in both directions"),
        (changed("TRK_INFO.1", number=FREE), "number: found 10 after 20, allowed numbers ascending to the trailer"),
        (changed("CTL_STAT.0", number=FREE), "allowed numbers descending in sending order"),
        ([*mailboxes(), Mailbox(FREE, "TRN_SPEED", "second", 0x118)], "identifier: found 0x118, also matched by"),
        # A protected mailbox below an open one would never get a frame.
        ([*changed("TRN_SPEED", overwrite=False), Mailbox(FREE, "TRN_SPEED", "second", 0x118)], "also matched by"),
    ],
)
def test_wrong_table_is_refused_in_one_line(table: list[Mailbox], words: str):
    with pytest.raises(ContractError) as caught:
        check_table(table, CONTRACT, RECEIVED, SENT)
    text = str(caught.value)
    assert text.startswith("eCAN mailbox table: ")
    assert words in text
    assert "\n" not in text
    assert exit_code_of(caught.value) == USAGE


def test_two_mailboxes_for_one_identifier_are_right_when_the_higher_is_protected():
    check_table([*mailboxes(), Mailbox(FREE, "TRN_SPEED", "first", 0x118, overwrite=False)], CONTRACT, RECEIVED, SENT)


def test_mask_over_free_identifiers_is_no_shadow():
    check_table(changed("TRN_SPEED", mask=0x004), CONTRACT, RECEIVED, SENT)


def test_more_ports_than_the_chip_has_mailboxes():
    many = [Port(f"P{k}", 0x300 + 8 * k, 3, 0, "plant", "event", "", ()) for k in range(4)]
    with pytest.raises(ContractError, match="mailboxes: found 35, allowed at most 32"):
        mailbox_table(CONTRACT, [*RECEIVED, *many], SENT)
    assert len(mailbox_table(CONTRACT, [*RECEIVED, *many[:3]], SENT)) == 32
