"""Faults of the balise reader: missed, reported twice, at a wrong place, or without a valid value."""

from __future__ import annotations

from dataclasses import dataclass, replace

from railhil.plant_sim.faults.injections import Injections, number_of
from railhil.scenarios.model import Balise


@dataclass(frozen=True, slots=True)
class UnreadBalise(Balise):
    """A balise of which the reader has nothing but its number: its telegram's check variable says erroneous."""


class FaultyReader:
    """What the reader reports for a balise, with the faults that are active, in the order of their numbers."""

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        self._faults = [(one, injections.samples(one)) for one in injections.at("sensor", "balise")]

    def reported(self, balise: Balise) -> list[Balise]:
        """The reports for one passing: none, one or several."""
        found = [balise]
        for one, source in self._faults:
            if not one.active:
                continue
            fault, before = one.fault, found
            if fault.what == "missed":
                found = []
            elif fault.what == "doubled":
                found = [each for each in found for _ in range(2)]
            elif fault.what == "wrong":
                error_m = number_of(fault, "error_m")
                found = [replace(each, surveyed_m=each.surveyed_m + error_m) for each in found]
            elif fault.what == "off" or source.random() < number_of(fault, "share"):
                found = [UnreadBalise(each.number, 0.0, each.true_m) for each in found]
            if found != before:
                self._injections.hit(one, _text(before), _text(found))
        return found


def _text(reports: list[Balise]) -> str:
    if not reports:
        return "none"
    return " ".join(
        "invalid" if isinstance(each, UnreadBalise) else f"{each.number}:{each.surveyed_m:g}" for each in reports
    )
