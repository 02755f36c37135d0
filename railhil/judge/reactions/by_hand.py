"""The fault catalogue of a system as faults that an operator injects: ``railhil run --catalogue``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from railhil.common.errors import InputError
from railhil.faults.language import fault_text, parse, sameness
from railhil.faults.model import Fault, Trigger
from railhil.judge.reactions.catalogue import catalogue_of
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System

#: Levels that change nothing before they are injected: others change the waits of the run, or the start of the hub.
_LEVELS = ("train", "sensor", "actuator", "command", "telegram")


def faults_by_hand(scenario: AnyScenario) -> tuple[str, ...]:
    """The faults of the catalogue of the scenario's system, as texts ``@manual combine id ENTRY``; each fault once.

    They have no duration: the operator chooses it. Places with faults of the scenario are left out, and faults that
    this system cannot inject (a train of one unit has no second one).

    :raises InputError: the catalogue is damaged.
    """
    system = scenario.installed_system
    taken = {parse(text).place for text in scenario.faults}
    texts: dict[tuple[object, ...], str] = {}
    for fault in _catalogued(system):
        if fault.place.level in _LEVELS and fault.place not in taken and _fits(fault, system):
            texts.setdefault(sameness(fault), fault_text(fault))
    return tuple(texts.values())


def _fits(fault: Fault, system: System) -> bool:
    try:
        fault_texts((fault_text(fault),), system, lambda row: Path())
    except InputError:
        return False
    return True


def _catalogued(system: System) -> Iterator[Fault]:
    by_hand = Trigger("manual")
    for entry in catalogue_of(system):
        for text in entry.faults:
            yield replace(
                parse(text), trigger=by_hand, duration_s=None, until="", expect=None, combine=True, id=entry.id
            )
