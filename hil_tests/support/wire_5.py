"""A record as wire version 5 had it: PLT_IDENT in the handshake only, where the hash of the old port table stands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from railhil.bus.ident import CtlIdent, PltIdent, SupIdent
from railhil.bus.mvb import TelegramSource
from railhil.bus.store import TrafficStore
from railhil.dbc import Contract
from railhil.record.framelog import log_line, read_log

_VERSION = 5


def as_wire_5(log: Path, contract: Contract, wire_hash: int) -> bytes:
    """The lines of a log of classic CAN without the repeated PLT_IDENT, and with the old handshake.

    :param contract: with which it was recorded.
    :param wire_hash: first 32 bit of the hash of the port table of version 5.
    """
    kinds = {can_id: kind for kind in (PltIdent, CtlIdent, SupIdent) for can_id in contract.port(kind.PORT).can_ids}
    store = TrafficStore([contract.port(kind.PORT) for kind in (PltIdent, CtlIdent, SupIdent)])
    lines, told = [], set()
    for time_ns, frame in read_log(log):
        kind = kinds.get(frame.can_id)
        if kind is None:
            lines.append(log_line(time_ns, frame))
        elif (port := store.feed(frame, time_ns)) is not None and not (kind is PltIdent and kind in told):
            told.add(kind)
            ident = replace(kind.decode(store.raw(port)), wire_hash=wire_hash, version=_VERSION)
            source = TelegramSource(contract.port(port), False)
            lines += [log_line(time_ns, one) for one in source.frames(ident.encode())]
    return "".join(lines).encode()
