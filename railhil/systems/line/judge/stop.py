"""One stop of a run over a line with all its figures, those of the section before it included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from railhil.common.digits import count_of
from railhil.judge.stops import ScoredStop, StopColumn
from railhil.systems.line.judge.lateness import NO_DELAY, Delay
from railhil.systems.line.scenario.model import Side


@dataclass(frozen=True, slots=True)
class SectionFigures:
    """The run from the stop before, in its own time and place.

    ``number``: of the section, from 1. ``planned_s``, ``chosen_s``, ``made_s``: running time of the timetable, of the
    controller (None: it told none) and of the train. ``traction_kj``: work at the wheel, ``regenerated_kj``: estimate
    (:mod:`railhil.systems.ato.energy.record`). ``bound_kj``: least work of a comfortable driving in the time made
    (:mod:`railhil.systems.line.shipped_bounds`), ``energy_share_percent``: the traction work as a share of it; None:
    none is shipped. ``comfort_mps2_per_km``: eq. (6), ``itae_kmh_s2``: eq. (4)
    against the curve for the running time that was chosen; None: no curve has that time. ``nearest_m``: distance to the
    place where the permitted speed is down to the train's. ``level``: strongest level of the train protection, "off"
    without one.
    """

    number: int
    planned_s: float
    chosen_s: float | None
    made_s: float
    traction_kj: float
    regenerated_kj: float | None
    bound_kj: float | None
    energy_share_percent: float | None
    comfort_mps2_per_km: float
    itae_kmh_s2: float | None
    nearest_m: float | None
    level: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LineStop(ScoredStop):
    """A stop of a line.

    ``dwell_nominal_s``, ``dwell_drawn_s``: least time from the standstill to the departure in the timetable, and as
    drawn for this run; ``dwell_s``: the time that it was. ``opened_after_s``: from the standstill to open doors;
    ``moved_after_s``: from the due departure to the first motion. ``late_for``: who has made the departure late
    (:class:`Delay`); empty where it is not.
    """

    platform: Side = "none"
    dwell_nominal_s: float | None = None
    dwell_drawn_s: float | None = None
    dwell_s: float | None = None
    opened_after_s: float | None = None
    moved_after_s: float | None = None
    delay: Delay = NO_DELAY
    late_for: str = ""
    jogs: int = 0
    reopened: int = 0
    refused: int = 0
    doors_opened: bool = False
    is_missed: bool = False
    section: SectionFigures | None = None

    @property
    def misses(self) -> tuple[str, ...]:
        """As of every stop, and the doors that did not open where the train had to stop."""
        # A dataclass with slots is another class than the one of this body, so that super() fails.
        found = super(LineStop, self).misses
        served = self.planned.service == "stop" and self.standstill is not None
        if served and self.platform != "none" and not self.doors_opened:
            found = (*found, "doors did not open")
        return found

    @property
    def columns(self) -> tuple[StopColumn, ...]:
        """Departure, exchange, section and train protection."""
        return (
            StopColumn("departs late (s)", _text(self.departure_late_s, "+.2f"), brief=True),
            StopColumn("", self.note, brief=True),
            StopColumn("dwell drawn (s)", _text(self.dwell_drawn_s, ".1f")),
            StopColumn("dwell (s)", _text(self.dwell_s, ".1f")),
            StopColumn("doors open after (s)", _text(self.opened_after_s, ".1f")),
            StopColumn("jogs", str(self.jogs or "-")),
            *_section_columns(self.section),
        )

    @property
    def note(self) -> str:
        """Speed of the passing, jogs, or who has made the departure late, in words; empty without any."""
        if self.passed is not None:
            return f"passed, {self.passed.speed_mps * 3.6:.0f} km/h"
        words = [count_of(self.jogs, "jog")] if self.jogs else []
        return ", ".join([*words, self.late_for] if self.late_for else words)

    def as_json(self) -> dict[str, Any]:
        """As of every stop, with the figures of a line."""
        document = super(LineStop, self).as_json()
        verdict = document.pop("verdict")
        section = self.section
        return {
            **document,
            "platform": self.platform,
            "dwell_nominal_s": self.dwell_nominal_s,
            "dwell_drawn_s": self.dwell_drawn_s,
            "dwell_s": self.dwell_s,
            "opened_after_s": self.opened_after_s,
            "moved_after_s": self.moved_after_s,
            "late_for": self.late_for,
            "delay_s": {name: getattr(self.delay, name) for name in Delay.__dataclass_fields__},
            "jogs": self.jogs,
            "reopened": self.reopened,
            "refused": self.refused,
            "missed": self.is_missed,
            "section": section and {name: getattr(section, name) for name in SectionFigures.__dataclass_fields__},
            "verdict": verdict,
        }


#: Columns of a section: heading, attribute of :class:`SectionFigures`, factor, format, whether a terminal shows it.
_OF_SECTION: Final = (
    ("run (s)", "made_s", 1.0, ".2f", True),
    ("traction (MJ)", "traction_kj", 1e-3, ".1f", False),
    ("returned (MJ)", "regenerated_kj", 1e-3, ".1f", False),
    ("energy share (%)", "energy_share_percent", 1.0, ".0f", False),
    ("ride comfort (m/s²/km)", "comfort_mps2_per_km", 1.0, ".3f", False),
    ("ITAE (km/h s²)", "itae_kmh_s2", 1.0, ".0f", False),
    ("to P (m)", "nearest_m", 1.0, ".1f", True),
)


def _section_columns(of: SectionFigures | None) -> Iterator[StopColumn]:
    for heading, name, factor, spec, brief in _OF_SECTION:
        value = getattr(of, name, None)
        yield StopColumn(heading, _text(None if value is None else value * factor, spec), brief)
    yield StopColumn("ATP", of.level if of else "-", brief=True)


def _text(value: float | None, spec: str) -> str:
    return "-" if value is None else format(value, spec)
