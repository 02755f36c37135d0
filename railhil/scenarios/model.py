"""The part of a scenario that the bench needs, for any system; its canonical form, whose SHA-256 the nodes compare."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from railhil.common.errors import InputError, Words

if TYPE_CHECKING:
    from railhil.scenarios.system import System


def list_injected_faults(faults: Sequence[str]) -> list[str]:
    """The faults of a scenario without the keys that only explain and judge them."""
    # Imported here: a run without faults does not load their language, which takes a tenth of a node's start.
    from railhil.faults.language import fault_text, parse

    return [fault_text(parse(text, "faults"), judging=False) for text in faults]


def canonical_text(table: dict[str, Any]) -> str:
    """A table as JSON with sorted keys, no spaces and shortest round-trip floats."""
    return json.dumps(table, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)


def text_sha256(table: dict[str, Any]) -> str:
    """SHA-256 (hex) of a table in canonical form."""
    return hashlib.sha256(canonical_text(table).encode("ascii")).hexdigest()


@dataclass(frozen=True, slots=True)
class Timing:
    """Ticks and periods. Times on the wire and in the log are whole numbers of ``base_tick_ns``."""

    base_tick_ns: int = 10_000_000
    control_period_ns: int = 500_000_000
    #: Simulation time from the sampling of the speed to the moment at which the command takes effect.
    loop_delay_s: float = 0.04
    #: Port periods that differ from the port table, by port name.
    port_period_ns: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PublishedScore:
    """One row of a published result table, printed with the measured scores: law and values by criterion."""

    controller: str
    values: Mapping[str, float]

    def as_table(self) -> dict[str, str | float]:
        """The row as in files, the values on the same level as the law."""
        return {"controller": self.controller, **self.values}

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> PublishedScore:
        """The row of such a table."""
        return cls(table["controller"], {key: value for key, value in table.items() if key != "controller"})


class AnyScenario(Protocol):
    """The part of a scenario that the bench itself needs, for any system."""

    @property
    def name(self) -> str:
        """Name of the run in folders and logs."""

    @property
    def title(self) -> str:
        """Title of the run in tables."""

    @property
    def system(self) -> str:
        """Name of its system."""

    @property
    def installed_system(self) -> System:
        """Its system (:class:`railhil.scenarios.system.OfSystem`)."""

    @property
    def usual_law(self) -> str:
        """The law of its runs when none is asked for."""

    @property
    def timing(self) -> Timing:
        """Ticks and periods."""

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Sentences about values that are chosen rather than published or measured."""

    @property
    def published(self) -> tuple[PublishedScore, ...]:
        """Rows of a published result table."""

    @property
    def sha256(self) -> str:
        """Hash of all values that change the run."""

    @property
    def faults(self) -> tuple[str, ...]:
        """The faults, as canonical texts (:mod:`railhil.faults.language`), in the order of their numbers."""

    @property
    def marks(self) -> Mapping[str, Sequence[float | None]]:
        """Planned instants at which faults may begin (:data:`railhil.scenarios.fault_list.Marks`)."""

    @property
    def planned_s(self) -> float:
        """Planned duration of the run, in s."""

    @property
    def watch_weakened(self) -> str:
        """Limits of the watches that are higher than usual; empty if there are none."""

    @property
    def described(self) -> Mapping[str, object]:
        """Further properties for a list of scenarios, by keys with units."""

    @property
    def can_be_perturbed(self) -> bool:
        """Whether it defines the draws of a perturbed run."""

    @property
    def every_run_is_drawn(self) -> bool:
        """Whether nominal runs make the same draws."""


def watch_sentence(scenario: AnyScenario) -> str:
    """Remark beside every verdict under weaker watches than usual, because it proves less; empty if none is weaker."""
    weakened = scenario.watch_weakened
    return f"watch weakened: {weakened}" if weakened else ""


def require_perturbations(scenario: AnyScenario, key: str) -> None:
    """Refuse perturbed runs of a scenario without distributions: they would all be nominal.

    :param key: the option or command that requests them.
    :raises InputError: there is nothing to draw.
    """
    if not scenario.can_be_perturbed:
        found = Words(f"the scenario {scenario.name}, which has nothing to draw (no [perturbations])")
        raise InputError("command line", key, found, "a scenario that says what is drawn, in which range")


def require_free_draws(scenario: AnyScenario, key: str, *, wholly: bool = False) -> None:
    """Refuse many drawn runs of a scenario that has its own ``draws`` and ``noise``: they would all be the same.

    :param key: the command that requests them. :param wholly: neither of them may be given, nor ``noise_from``.
    :raises InputError: both are given, or one of them.
    """
    given = [name for name in ("draws", "noise", "noise_from") if getattr(scenario, name, ())]
    if {"draws", "noise"} <= {*given} or (wholly and given):
        found = Words(f"the scenario {scenario.name} with {' and '.join(given)} of its own")
        raise InputError("command line", key, found, "a scenario without them: this command draws them")


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Classes of ``ato``: laws that were written for version 0.1.0 import them from here."""
        from importlib import import_module

        if name.startswith("__"):
            # Python asks for `__path__` in every import from here.
            raise AttributeError(name)
        return getattr(import_module("railhil.systems.ato.scenario.model"), name)
