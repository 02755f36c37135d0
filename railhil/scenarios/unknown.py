"""Substitute for the scenario of a run on the bus, for a watcher that does not have its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan

from railhil.dbc import Contract
from railhil.scenarios.model import PublishedScore, Timing
from railhil.scenarios.system import OfSystem


@dataclass(frozen=True, slots=True)
class UnknownScenario(OfSystem):
    """A scenario of which only the system and the first 32 bit of the hash are known. Displays of its run show the data
    of the wire, and no data of the scenario's file (target, timetable, stopping point).

    The port table gives ticks and periods, see :class:`railhil.scenarios.model.AnyScenario`.
    """

    system: str
    #: First 32 bit of the hash in hexadecimal digits.
    sha256: str
    timing: Timing

    @classmethod
    def told(cls, system: str, scenario_hash: int, contract: Contract) -> UnknownScenario:
        """The number in a handshake telegram."""
        return cls(system, f"{scenario_hash:08x}", Timing(base_tick_ns=contract.base_tick_ns))

    @property
    def name(self) -> str:
        """For titles."""
        return f"unknown scenario {self.sha256}"

    @property
    def title(self) -> str:
        """For titles."""
        return self.name

    @property
    def planned_s(self) -> float:
        """Not known."""
        return nan

    @property
    def described(self) -> Mapping[str, object]:
        """Nothing."""
        return {}

    assumptions: tuple[str, ...] = ()
    published: tuple[PublishedScore, ...] = ()
    faults: tuple[str, ...] = ()
    watch_weakened: str = ""
    can_be_perturbed: bool = False
    every_run_is_drawn: bool = False
