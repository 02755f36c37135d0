"""The statements of a run in its log: the nodes state the hash of their scenario, which covers its faults.

They do so in the handshake, and the plant repeats it. Nothing else in a log depends on faults that have not begun.
"""

from __future__ import annotations

import re

from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, PltIdent, SupIdent
from railhil.bus.injector.telegram_frames import data_of, is_whole, with_data, with_signal
from railhil.scenarios.model import AnyScenario

#: Telegrams in which the nodes state the run.
_STATEMENTS = (PltIdent, CtlIdent, SupIdent)


def restate(lines: bytes, scenario: AnyScenario) -> bytes:
    """Lines of a log as the nodes of another run would have written them.

    :param lines: whole telegrams in classic frames, as every run in one process has them.
    :param scenario: of the other run.
    """
    contract, scenario_hash = scenario.installed_system.contract, int(scenario.sha256[:8], 16)
    kinds = {can_id: kind for kind in _STATEMENTS for can_id in contract.port(kind.PORT).can_ids}
    ids = b"|".join(b"%03X" % can_id for can_id in kinds)
    changed, met = bytearray(lines), []
    for found in re.finditer(rb" (" + ids + rb")#([0-9A-F]*) ", lines):
        met.append((found.start(2), Frame(int(found[1], 16), bytes.fromhex(found[2].decode()), 0)))
        kind = kinds[met[-1][1].can_id]
        port = contract.port(kind.PORT)
        if not is_whole(port, frames := [frame for _, frame in met]):
            continue
        data = with_signal(data_of(port, frames), dict(kind.signals())["scenario_hash"], scenario_hash)
        for (place, _), frame in zip(met, with_data(port, frames, data), strict=True):
            octets = frame.data.hex().upper().encode()
            changed[place : place + len(octets)] = octets
        met = []
    assert not met, "a statement of a run is cut off"
    return bytes(changed)
