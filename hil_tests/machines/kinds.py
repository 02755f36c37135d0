"""The kinds of virtual machines with kernel SocketCAN that this host can have."""

from __future__ import annotations

from collections.abc import Mapping

from railhil.machines import debian
from railhil.machines.vcan_vm import ensure_machine
from railhil.machines.vm_image import KINDS, Kind


def first_available(kinds: Mapping[str, Kind] = KINDS) -> str:
    """Name of the first kind of machine that this host can have, all of it installed; it may still not boot.

    Raises:
        CapabilityError: it can have none.
        MachineError: a package is not as expected.
    """
    failures = []
    for name, kind in kinds.items():
        try:
            ensure_machine(kind)
        except debian.CapabilityError as error:
            failures.append(f"{kind.said}: {error}")
        else:
            return name
    raise debian.CapabilityError("; ".join(failures))
