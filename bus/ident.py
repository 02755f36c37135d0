"""The handshake: each node states what it is about to run, and a run starts only if all three agree."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar

from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE, FLAG_TRUE, Telegram, flag, signal
from railhil.common import command_line
from railhil.common.plug_ins import entries
from railhil.dbc import Contract, wire_contract
from railhil.dbc.contract import WIRE_VERSION


class Role(IntEnum):
    """The three nodes; the numbers of controller and supervisor are also their MVB device addresses."""

    PLANT = 0
    CONTROLLER = 1
    SUPERVISOR = 2


#: Codes of ``arithmetic``, ``indexing`` and ``pace`` in the handshake.
ARITHMETICS = ("none", *command_line.ARITHMETICS)
#: What each arithmetic reproduces: the IQmath library, or the rounding of the floating-point unit.
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


@dataclass(slots=True)
class Ident(Telegram):
    """What a node is about to run; one layout for PLT_IDENT, CTL_IDENT and SUP_IDENT.

    ::

          0    1    2    3    4    5    6    7
        +-------------------+-------------------+
        |   scenario hash   |     wire hash     |
        +-------------------+-------------------+
          8    9    10   11   12     13          14                 15
        +-------------------+--------------+---------------+-------------------+
        |       seed        |  law   arith |role  index per| chk pace version  |
        +-------------------+--------------+---------------+-------------------+
    """

    PORT: ClassVar[str] = "PLT_IDENT"
    #: The node that is the source of the port.
    ROLE: ClassVar[Role] = Role.PLANT
    scenario_hash: int = signal("{p}ScenarioHash")
    wire_hash: int = signal("{p}WireHash")
    seed: int = signal("{p}Seed")
    law: int = signal("{p}Law")
    role: int = signal("{p}Role")
    arithmetic: int = signal("{p}Arithmetic")
    indexing: int = signal("{p}Indexing")
    perturbed: int = signal("{p}Perturbed", FLAG_FALSE)
    check: int = signal("{p}IdentChk", CHECK_CORRECT)
    pace: int = signal("{p}Pace")
    version: int = signal("{p}Version", WIRE_VERSION)

    @property
    def is_own(self) -> bool:
        """True when the role is that of the port's source; otherwise the telegram is not from a node of the bench."""
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
        return _law_shown(value)
    words = {"arithmetic": ARITHMETICS, "indexing": INDEXINGS, "pace": PACES}.get(field, ())
    return words[value] if value < len(words) else f"{value:08x}"


def _law_shown(code: int) -> str:
    """The installed laws with this code and their own parameters; the code of a parameter file cannot be decoded."""
    return " or ".join(laws_of_code(code)) or f"{code:03x} (no installed law with its own parameters)"


@dataclass(slots=True)
class PltIdent(Ident):
    """PLT_IDENT, see :class:`Ident`."""

    PORT: ClassVar[str] = "PLT_IDENT"


@dataclass(slots=True)
class CtlIdent(Ident):
    """CTL_IDENT, see :class:`Ident`."""

    PORT: ClassVar[str] = "CTL_IDENT"
    ROLE: ClassVar[Role] = Role.CONTROLLER


@dataclass(slots=True)
class SupIdent(Ident):
    """SUP_IDENT, see :class:`Ident`."""

    PORT: ClassVar[str] = "SUP_IDENT"
    ROLE: ClassVar[Role] = Role.SUPERVISOR


_CLASSES: dict[Role, type[Ident]] = {Role.PLANT: PltIdent, Role.CONTROLLER: CtlIdent, Role.SUPERVISOR: SupIdent}


def law_code(controller: str) -> int:
    """12-bit code of a controller's name: the low bits of its CRC-32, with 0 replaced by 4095; 0 for the empty name
    (not known)."""
    if not controller:
        return 0
    return zlib.crc32(controller.encode()) & _LAW_MAX or _LAW_MAX


def laws_of_code(code: int, group: str = "railhil.laws") -> list[str]:
    """The installed laws whose code with their own parameters this is, sorted.

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
    contract: Contract | None = None,
) -> Ident:
    """Handshake telegram of a node; hashes are truncated to their first 32 bits.

    :param contract: of the run's system; None: that of railhil's own train.
    """
    return _CLASSES[role](
        scenario_hash=int(scenario_sha256[:8], 16),
        wire_hash=int((contract or wire_contract()).sha256[:8], 16),
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
