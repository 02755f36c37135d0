"""The mailbox table: which CAN identifier the controller receives or sends through which of the eCAN's 32 mailboxes.

The table is made from the port table and checked at start. A telegram of several blocks takes one mailbox for each of
its CAN frames. The order of the numbers follows the chip: mailboxes are read in ascending order, so a telegram's
receive mailboxes ascend to the trailer; of several waiting frames the highest mailbox number is sent first (with equal
priority level), so its transmit mailboxes descend. The poll has the highest number because that one is matched first.

Source: TI SPRU074F and SPRUI07, chapter eCAN (mailbox layout, acceptance, transmit order).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Final

from railhil.bus.schedule import POLL_BYTES
from railhil.dbc import Contract, ContractError, Port

#: Mailboxes of one eCAN module (in eCAN mode, each with its own acceptance mask).
MAILBOXES_MAX: Final = 32
_ID_MAX: Final = {False: 0x7FF, True: 0x1FFF_FFFF}
_CLASSIC_BYTES: Final = 8
#: Names in the ``port`` column for the two frames of the bus administrator, which belong to no port.
POLL: Final = "POLL"
DEVICE_STATUS: Final = "DEVICE_STATUS"


@dataclass(frozen=True, slots=True)
class Mailbox:
    """One mailbox.

    ``number`` 0..31. ``port``: name in the port table, or ``POLL``, ``DEVICE_STATUS``; ``name`` also says which part
    (``TRK_INFO.1``, ``TRK_INFO.trailer``). ``mask``: identifier bits that are *not* compared (the chip's acceptance
    mask has a 1 there). ``transmit``: direction. ``length``: data bytes (DLC). ``overwrite``: a full mailbox takes the
    newer frame (OPC bit clear); otherwise it is protected. ``extended``: 29-bit identifier (IDE).
    """

    number: int
    port: str
    name: str
    can_id: int
    mask: int = 0
    transmit: bool = False
    length: int = _CLASSIC_BYTES
    overwrite: bool = True
    extended: bool = False

    def accepts(self, can_id: int, extended: bool = False) -> bool:
        """True when a received identifier matches: every compared bit equal, and the identifier of the same kind."""
        return extended == self.extended and not (can_id ^ self.can_id) & ~self.mask

    def overlaps(self, other: Mailbox) -> bool:
        """True when some identifier matches both mailboxes."""
        return self.extended == other.extended and not (self.can_id ^ other.can_id) & ~(self.mask | other.mask)

    def __str__(self) -> str:
        return f"mailbox {self.number} ({self.name})"


def mailbox_table(contract: Contract, received: Sequence[Port], sent: Sequence[Port]) -> tuple[Mailbox, ...]:
    """The mailboxes of a node, in the order of their numbers.

    :param received: ports that the node receives, most urgent first.
    :param sent: ports that it sends.
    :raises ContractError: the ports do not fit, see :func:`check_table`.
    """
    parts = [(port.name, *part) for port in received for part in _parts(port)]
    table = [Mailbox(number, port, name, can_id) for number, (port, name, can_id) in enumerate(parts)]
    number = MAILBOXES_MAX - 1
    table.append(Mailbox(number, POLL, POLL, contract.poll_id, length=POLL_BYTES))
    answers = [(port.name, *part) for port in sent for part in _parts(port)]
    for port_name, name, can_id in [*answers, (DEVICE_STATUS, DEVICE_STATUS, contract.device_status_id)]:
        number -= 1
        table.append(Mailbox(number, port_name, name, can_id, transmit=True))
    table.sort(key=lambda mailbox: mailbox.number)
    check_table(table, contract, received, sent)
    return tuple(table)


def _parts(port: Port) -> list[tuple[str, int]]:
    """Name and identifier of each CAN frame of a port, in sending order."""
    if port.single_frame:
        return [(port.name, port.address)]
    names = [*(f"{port.name}.{block}" for block in range(port.blocks)), f"{port.name}.trailer"]
    return list(zip(names, port.can_ids, strict=True))


def check_table(table: Sequence[Mailbox], contract: Contract, received: Sequence[Port], sent: Sequence[Port]) -> None:
    """Check that the table fits into the chip, and that it agrees with the port table.

    :raises ContractError: one line with the mailbox, what was found and what is allowed.
    """
    if len(table) > MAILBOXES_MAX:
        raise _wrong("mailboxes", len(table), f"at most {MAILBOXES_MAX}")
    for mailbox in table:
        _check_mailbox(mailbox)
    for one, other in combinations(table, 2):
        _check_pair(one, other)
    wanted = [(POLL, contract.poll_id, False, POLL_BYTES)]
    wanted += [(port.name, can_id, False, _CLASSIC_BYTES) for port in received for can_id in port.can_ids]
    wanted += [(port.name, can_id, True, _CLASSIC_BYTES) for port in sent for can_id in port.can_ids]
    wanted += [(DEVICE_STATUS, contract.device_status_id, True, _CLASSIC_BYTES)]
    for port_name, can_id, transmit, length in wanted:
        _check_covered(table, port_name, can_id, transmit, length)
    for port in contract.ports:
        if port not in received:
            _check_deaf(table, port)
    for port in (*received, *sent):
        _check_order(table, port)


def _wrong(key: str, found: object, allowed: str) -> ContractError:
    return ContractError(f"eCAN mailbox table: {key}: found {found}, allowed {allowed}")


def _check_mailbox(mailbox: Mailbox) -> None:
    highest = _ID_MAX[mailbox.extended]
    if not 0 <= mailbox.number < MAILBOXES_MAX:
        raise _wrong(f"{mailbox.name}: number", mailbox.number, f"0..{MAILBOXES_MAX - 1}")
    if not 0 <= mailbox.can_id <= highest:
        raise _wrong(f"{mailbox}: identifier", f"{mailbox.can_id:#x}", f"0..{highest:#x}")
    if not 0 <= mailbox.mask <= highest:
        raise _wrong(f"{mailbox}: mask", f"{mailbox.mask:#x}", f"0..{highest:#x}")
    if mailbox.transmit and mailbox.mask:
        raise _wrong(f"{mailbox}: mask", f"{mailbox.mask:#x}", "0 in a transmit mailbox")
    if not 0 <= mailbox.length <= _CLASSIC_BYTES:
        raise _wrong(f"{mailbox}: length", mailbox.length, f"0..{_CLASSIC_BYTES} bytes")


def _check_pair(one: Mailbox, other: Mailbox) -> None:
    if one.number == other.number:
        raise _wrong(f"{one}: number", f"{one.number} again in {other.name}", "each number once")
    if not one.overlaps(other):
        return
    if one.transmit != other.transmit:
        raise _wrong(f"{one}: identifier", f"{one.can_id:#x} in both directions ({other})", "one direction")
    # The highest number wins, and only a protected mailbox leaves a frame to the next one.
    if one.transmit or max(one, other, key=lambda mailbox: mailbox.number).overwrite:
        raise _wrong(f"{one}: identifier", f"{one.can_id:#x}, also matched by {other}", "identifiers of its own")


def _check_covered(table: Sequence[Mailbox], port_name: str, can_id: int, transmit: bool, length: int) -> None:
    found = [mailbox for mailbox in table if mailbox.transmit == transmit and mailbox.accepts(can_id)]
    direction = "transmit" if transmit else "receive"
    if not found:
        raise _wrong(f"{port_name}: {can_id:#x}", "no mailbox", f"a {direction} mailbox for each CAN frame of the port")
    for mailbox in found:
        if mailbox.length != length:
            raise _wrong(f"{mailbox}: length", mailbox.length, f"{length} bytes")


def _check_deaf(table: Sequence[Mailbox], port: Port) -> None:
    """A port that the node does not receive (the simulated truth, its own answers) must match no receive mailbox."""
    for mailbox in table:
        for can_id in port.can_ids:
            if not mailbox.transmit and mailbox.accepts(can_id):
                raise _wrong(f"{mailbox}: mask", f"{mailbox.mask:#x}, which lets {port.name} in", "ports of this node")


def _check_order(table: Sequence[Mailbox], port: Port) -> None:
    order = {can_id: place for place, can_id in enumerate(port.can_ids)}
    own = sorted((mailbox for mailbox in table if mailbox.can_id in order), key=lambda box: order[box.can_id])
    for first, second in pairwise(own):
        if (first.number > second.number) != first.transmit and first.can_id != second.can_id:
            way = "descending in sending order" if first.transmit else "ascending to the trailer"
            raise _wrong(f"{second}: number", f"{second.number} after {first.number}", f"numbers {way}")
