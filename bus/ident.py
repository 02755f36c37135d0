"""The handshake: each node states the run that it is about to make, and the run starts only if all three agree."""

from __future__ import annotations

import zlib
from typing import ClassVar

from railhil.bus import telegrams
from railhil.bus.layout import FLAG_TRUE, flag
from railhil.bus.telegrams import Role as Role
from railhil.common import command_line
from railhil.common.plug_ins import entries
from railhil.dbc import Contract

#: Codes of ``arithmetic``, ``indexing`` and ``pace`` in the handshake.
ARITHMETICS = ("none", *command_line.ARITHMETICS)
#: Model of each arithmetic: the IQmath library, or the rounding of the floating-point unit.
PROFILES = {
    "float64": "ieee754",
    "float32": "nearest",
    "iq": "c28",
    "iq-portable": "portable",
    "float32-truncated": "truncated",
}
INDEXINGS = ("none", *command_line.INDEXINGS)
_LAW_MAX = 0xFFF
PACES = ("none", *command_line.PACES)


class Ident(telegrams.Ident):
    """The run that a node is about to make; one layout for PLT_IDENT, CTL_IDENT and SUP_IDENT."""

    __slots__ = ()
    #: The node that is the source of the port. Its number is also its MVB device address, except for the plant.
    ROLE: ClassVar[Role]

    @property
    def is_own(self) -> bool:
        """True when the role matches the port's source; otherwise the telegram is not from a node of the bench."""
        return self.role == self.ROLE

    def differences(self, other: Ident) -> list[str]:
        """One sentence for each property in which two nodes disagree; unknown values (0) never count as different."""
        strange = [ident for ident in (self, other) if not ident.is_own]
        if strange:
            return [f"{ident.PORT} has role {ident.role}, allowed {ident.ROLE.value}" for ident in strange]
        mine, theirs = self.ROLE.name.lower(), other.ROLE.name.lower()
        found = []
        for name, title, known in (
            ("scenario_hash", "scenario", lambda value: True),
            ("wire_hash", "DBC", lambda value: True),
            ("version", "wire version", lambda value: True),
            ("law", "controller", bool),
            ("arithmetic", "arithmetic", bool),
            ("indexing", "indexing", bool),
            ("pace", "pace", bool),
        ):
            a, b = getattr(self, name), getattr(other, name)
            if a != b and known(a) and known(b):
                hint = "; say --controller and --parameters alike" if name == "law" else ""
                found.append(f"{title} differs: {mine} {_shown(name, a)}, {theirs} {_shown(name, b)}{hint}")
        seeds_known = Role.CONTROLLER not in (self.role, other.role)
        if seeds_known and (self.seed, self.perturbed) != (other.seed, other.perturbed):
            found.append(f"seed differs: {mine} {self.seed}, {theirs} {other.seed}")
        return found


def _shown(field: str, value: int) -> str:
    """A handshake value for the user: its name if it has one, else the hexadecimal code."""
    if field == "law":
        return law_words(value)
    words = {"arithmetic": ARITHMETICS, "indexing": INDEXINGS, "pace": PACES}.get(field, ())
    return words[value] if value < len(words) else f"{value:08x}"


def law_words(code: int, group: str = "railhil.laws") -> str:
    """The installed laws with this code and their own parameters; the code of a parameter file cannot be decoded.

    :param group: entry point group of the system's laws.
    """
    return " or ".join(laws_of_code(code, group)) or f"{code:03x} (no installed law with its own parameters)"


class PltIdent(Ident, telegrams.PltIdent):
    """PLT_IDENT."""

    __slots__ = ()
    ROLE = Role.PLANT


class CtlIdent(Ident, telegrams.CtlIdent):
    """CTL_IDENT."""

    __slots__ = ()
    ROLE = Role.CONTROLLER


class SupIdent(Ident, telegrams.SupIdent):
    """SUP_IDENT."""

    __slots__ = ()
    ROLE = Role.SUPERVISOR


_CLASSES: dict[Role, type[Ident]] = {Role.PLANT: PltIdent, Role.CONTROLLER: CtlIdent, Role.SUPERVISOR: SupIdent}


def law_code(controller: str) -> int:
    """12-bit code of a controller's name: the low bits of its CRC-32, with 0 replaced by 4095; 0 for the empty name
    (not known)."""
    if not controller:
        return 0
    return zlib.crc32(controller.encode()) & _LAW_MAX or _LAW_MAX


def laws_of_code(code: int, group: str = "railhil.laws") -> list[str]:
    """The installed laws that have this code with their own parameters, sorted.

    :param group: entry point group of the system's laws.
    """
    return sorted(name for name in entries(group) if law_code(name) == code)


def make_ident(
    role: Role,
    scenario_sha256: str,
    *,
    seed: int = 0,
    perturbed: bool = False,
    controller: str = "",
    arithmetic: str = "none",
    indexing: str = "none",
    pace: str = "none",
    contract: Contract,
) -> Ident:
    """Handshake telegram of a node; hashes are truncated to their first 32 bits.

    :param contract: of the run's system.
    """
    return _CLASSES[role](
        scenario_hash=int(scenario_sha256[:8], 16),
        wire_hash=int(contract.sha256[:8], 16),
        seed=seed,
        law=law_code(controller),
        role=role,
        arithmetic=ARITHMETICS.index(arithmetic),
        indexing=INDEXINGS.index(indexing),
        perturbed=flag(perturbed),
        pace=PACES.index(pace),
    )


def is_perturbed(ident: Ident) -> bool:
    """True when the node states that it runs with drawn parameters."""
    return ident.perturbed == FLAG_TRUE
