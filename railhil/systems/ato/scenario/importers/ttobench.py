"""Tracks in the TTOBench JSON format, library versions 1.1 to 1.5.

D. Kouzoupis, I. Pendharkar, F. Corman, "TTOBench - an Open-Source Library for Train Trajectory Optimization",
Operations Research Forum 4:67 (2023). Units are named in the file and must be m, km/h (or m/s) and permil. Curvatures,
tunnels (from 1.4 on) and braking data for ETCS (from 1.5 on) are left out.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, Strict

from railhil.common.errors import InputError
from railhil.common.user_files import given_json
from railhil.scenarios.profiles import Profile
from railhil.scenarios.validation import validate
from railhil.systems.ato.scenario.importers.foreign import Foreign, find_unknown
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, list_unused
from railhil.systems.ato.scenario.model import Line

VERSIONS = tuple(f"TTOBench v1.{minor}" for minor in range(1, 6))
_Row = Annotated[tuple[float, float], Strict(False)]


class _Metadata(Foreign):
    model_config = ConfigDict(extra="ignore")
    id: str
    version: str = Field(alias="library version")


class _Stops(Foreign):
    unit: Literal["m", "km"]
    values: Annotated[list[float], Field(min_length=2)]


class _LimitUnits(Foreign):
    position: Literal["m", "km"]
    velocity: Literal["km/h", "m/s"]


class _Limits(Foreign):
    units: _LimitUnits
    values: Annotated[list[_Row], Field(min_length=1)]


class _GradientUnits(Foreign):
    position: Literal["m", "km"]
    slope: Literal["permil", "\N{PER MILLE SIGN}"]


class _Gradients(Foreign):
    units: _GradientUnits
    values: Annotated[list[_Row], Field(min_length=1)]


class _Track(Foreign):
    DESCRIBING = ("altitude",)
    metadata: _Metadata
    stops: _Stops
    limits: _Limits = Field(alias="speed limits")
    gradients: _Gradients | None = None


_METRES = {"m": 1.0, "km": 1000.0}


def load_line(file: str | Path) -> StopLine:
    """A track as a line in its own positions, with stops named ``stop 0``, ``stop 1``, ... in file order.

    A track without gradients is level. Raises :class:`InputError`.
    """
    data = _read(file)
    track = validate(_Track, data, lambda _: file)
    if track.metadata.version not in VERSIONS:
        raise InputError(file, "metadata.library version", track.metadata.version, f"one of {', '.join(VERSIONS)}")
    stop_m = [value * _METRES[track.stops.unit] for value in track.stops.values]
    _check_increasing(file, "stops", stop_m)
    limit_scale = 1 / 3.6 if track.limits.units.velocity == "km/h" else 1.0
    remarks = list_unused(find_unknown(file, track))
    grade: Profile = ((stop_m[0], 0.0),)
    if track.gradients is None:
        remarks += ("level: its file has no gradients",)
    else:
        scale_m = _METRES[track.gradients.units.position]
        grade = tuple((from_x * scale_m, permil) for from_x, permil in track.gradients.values)
        _check_increasing(file, "gradients", [row[0] for row in grade])
    scale_m = _METRES[track.limits.units.position]
    limits = tuple((from_x * scale_m, limit * limit_scale) for from_x, limit in track.limits.values)
    _check_increasing(file, "speed limits", [row[0] for row in limits])
    for row, (_, limit_mps) in enumerate(limits):
        if limit_mps <= 0:
            raise InputError(file, f"speed limits.values[{row}]", track.limits.values[row], "a limit above 0")
    stops = tuple(Stop(f"stop {number}", position_m) for number, position_m in enumerate(stop_m))
    return StopLine(Line(track.metadata.id, grade, limits), stops, remarks)


def _check_increasing(file: str | Path, key: str, positions: list[float]) -> None:
    for row, (earlier, later) in enumerate(pairwise(positions), start=1):
        if later <= earlier:
            raise InputError(file, f"{key}.values[{row}]", later, f"a position above {earlier}")


def _read(file: str | Path) -> dict[str, Any]:
    return given_json(Path(file), "a TTOBench track object (JSON in UTF-8)")
