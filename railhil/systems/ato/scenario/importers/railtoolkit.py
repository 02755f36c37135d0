"""Paths and trains in the railtoolkit formats: running-path 2022.05 and 2024.07, rolling-stock 2022.05 (YAML).

In running-path 2024.07 the rows are objects, and a section may leave out speed or resistance: it then has those of the
section before it. Points of interest are named by ``label``, in later files of the same version by ``id``.

Train resistance in permil of weight (Wende, Fahrdynamik des Schienenverkehrs, 2003, pp. 151-153; V in km/h):

* traction unit, multiple unit: ``(base m_traction + rolling (m - m_traction)) / m + air ((V + 15) / 100)^2``
* passenger coach:              ``base + rolling V / 100 + air ((V + 15) / 100)^2``
* freight wagon:                ``base + air (V / 100)^2``

The resistance of powered vehicles uses their mass without load, that of coaches and wagons their mass with load; grade
and inertia always include the load (``inertia = (mass + load_limit) * rotation_mass``). With this interpretation the
nine published running times are reproduced within 0.6 %, which is the step error of the published values. Gravity is
9.80665 m/s2. Braking defaults are those of TrainRuns.jl: 0.375 m/s2, and 0.225 m/s2 with freight wagons in the train.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import fsum
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import AliasChoices, Field, Strict

from railhil.common.errors import InputError, Words
from railhil.common.extras import missing_library
from railhil.common.user_files import given_text, refuse_unreadable
from railhil.scenarios.profiles import Profile, merge_profiles
from railhil.scenarios.validation import Keys, validate
from railhil.scenarios.yamlfile import parse_yaml
from railhil.systems.ato.scenario.importers.foreign import Foreign, find_unknown
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, list_unused
from railhil.systems.ato.scenario.model import Effort, Line, Train

#: Versions of each format that are read.
VERSIONS = {"running-path": ("2022.05", "2024.07"), "rolling-stock": ("2022.05",)}
GRAVITY_MPS2 = 9.80665
_BRAKING_MPS2 = {"passenger": 0.375, "freight": 0.225}
#: Head wind that Wende adds to the train's speed.
_WIND_KMH = 15.0

_Positive = Annotated[float, Field(gt=0)]


class _Section(Foreign):
    """Speed or resistance that are not given (``model_fields_set``) are those of the section before."""

    DESCRIBING = ("name", "id", "UUID", "description")
    position: float
    speed: _Positive = 0.0
    resistance: float = 0.0


class _Point(Foreign):
    DESCRIBING = ("name", "UUID", "description")
    position: float
    label: Annotated[str, Field(validation_alias=AliasChoices("label", "id"))]
    measure: Literal["front", "middle", "rear"]


class _Path(Foreign):
    """A path of version 2024.07."""

    DESCRIBING = ("name", "UUID")
    id: str
    description: str = ""
    characteristic_sections: Annotated[list[_Section], Field(min_length=2)]
    points_of_interest: list[_Point] = []


class _PathFile(Foreign):
    paths: Annotated[list[_Path], Field(min_length=1)]


class _RowPath(Foreign):
    """A path of version 2022.05."""

    DESCRIBING = ("UUID", "description")
    name: str
    id: str
    characteristic_sections: Annotated[
        list[Annotated[tuple[float, _Positive, float], Strict(False)]], Field(min_length=2)
    ]
    points_of_interest: list[Annotated[tuple[float, str, Literal["front", "rear"]], Strict(False)]] = []

    def in_objects(self) -> _Path:
        """The same path as one of version 2024.07."""
        return _Path(
            id=self.id,
            description=self.name,
            characteristic_sections=[
                _Section(position=at_m, speed=limit_kmh, resistance=permil)
                for at_m, limit_kmh, permil in self.characteristic_sections
            ],
            points_of_interest=[
                _Point(position=at_m, label=label, measure=measure) for at_m, label, measure in self.points_of_interest
            ],
        )


class _RowPathFile(Foreign):
    paths: Annotated[list[_RowPath], Field(min_length=1)]


class _Vehicle(Foreign):
    DESCRIBING = ("UUID", "picture", "power_type")
    name: str
    id: str
    vehicle_type: Literal["traction unit", "freight", "passenger", "multiple unit"]
    length: _Positive
    mass: _Positive
    load_limit: _Positive | None = None
    mass_traction: _Positive | None = None
    rotation_mass: Annotated[float, Field(ge=1)] = 1.0
    base_resistance: _Positive | None = None
    rolling_resistance: _Positive | None = None
    air_resistance: _Positive | None = None
    speed_limit: _Positive | None = None
    a_braking: Annotated[float, Field(lt=0)] | None = None
    tractive_effort: list[Annotated[tuple[float, float], Strict(False)]] = []


class _Train(Foreign):
    DESCRIBING = ("UUID",)
    name: str
    id: str
    formation: Annotated[list[str], Field(min_length=1)]


_Entry = TypeVar("_Entry", _Path, _RowPath, _Train)


class _StockFile(Foreign):
    trains: Annotated[list[_Train], Field(min_length=1)]
    vehicles: Annotated[list[_Vehicle], Field(min_length=1)]


def load_line(file: str | Path, *, train_length_m: float, path_id: str | None = None) -> StopLine:
    """A path as a line (its only one, or the one with ``path_id``), positions in m as in the file.

    Stops are ``start``, ``end`` and the points of interest measured at the front or in the middle of a train of this
    length. The path resistance in permil is used as the grade. Raises :class:`InputError`.
    """
    data = _read(file, "running-path")
    origin = _name_file(file)
    if data["schema_version"] == "2022.05":
        rows = _choose(file, "paths", validate(_RowPathFile, data, origin).paths, path_id)
        unused, path = _find_unknown(file, "paths", rows), rows.in_objects()
    else:
        path = _choose(file, "paths", validate(_PathFile, data, origin).paths, path_id)
        unused = _find_unknown(file, "paths", path)
    positions = [section.position for section in path.characteristic_sections]
    if any(later <= earlier for earlier, later in pairwise(positions)):
        raise InputError(file, f"paths {path.id} characteristic_sections", positions, "increasing positions")
    limits, grades = _profiles(file, path)
    ahead_m = {"front": 0.0, "middle": train_length_m / 2}
    points = [
        Stop(point.label, point.position + ahead_m[point.measure])
        for point in path.points_of_interest
        if point.measure in ahead_m
    ]
    inner = [point for point in points if positions[0] < point.position_m < positions[-1]]
    stops = [
        Stop("start", positions[0]),
        *sorted(inner, key=lambda stop: stop.position_m),
        Stop("end", positions[-1]),
    ]
    rest = len(path.points_of_interest) - len(inner)
    unused += [f"{rest} of the points of interest (measured at the rear, or outside the path)"] if rest else []
    given = [section.position for section in path.characteristic_sections if "resistance" in section.model_fields_set]
    level_to_m = given[0] if given else positions[-1]
    level = f"level where its file has no resistance: {positions[0]:g} to {level_to_m:g} m"
    remarks = (level,) if level_to_m > positions[0] else ()
    line = Line(path.description or path.id, grades, limits)
    return StopLine(line, tuple(stops), (*list_unused(unused), *remarks))


def _find_unknown(file: str | Path, key: str, entry: _Path | _RowPath | _Train | _Vehicle) -> list[str]:
    """See :func:`find_unknown`; an entry of a list is named by its id."""
    return find_unknown(file, entry, (f"{key} {entry.id}",))


def _profiles(file: str | Path, path: _Path) -> tuple[Profile, Profile]:
    """Speed limits (m/s) and grades (permil); a path that gives no resistance is level up to its first one."""
    limit_kmh = permil = 0.0
    limits: list[tuple[float, float]] = []
    grades: list[tuple[float, float]] = []
    for row, section in enumerate(path.characteristic_sections):
        if "speed" in section.model_fields_set:
            limit_kmh = section.speed
        elif row == 0:
            raise InputError(file, f"paths {path.id} characteristic_sections[0].speed", Words(), "a speed at the start")
        if "resistance" in section.model_fields_set:
            permil = section.resistance
        limits.append((section.position, limit_kmh / 3.6))
        grades.append((section.position, permil))
    return merge_profiles(tuple(limits)), merge_profiles(tuple(grades))


def load_train(
    file: str | Path,
    *,
    actuator_pole_per_s: float,
    accel_per_notch_mps2: float,
    train_id: str | None = None,
    notch_max: float = 7.0,
) -> Train:
    """A train as one rigid mass; the caller supplies what the format does not contain (actuator, notches).

    The brake force limit is the one that gives the file's braking rate on the inertial mass.
    Raises :class:`InputError`.
    """
    stock = validate(_StockFile, _read(file, "rolling-stock"), _name_file(file))
    chosen = _choose(file, "trains", stock.trains, train_id)
    by_id = {vehicle.id: vehicle for vehicle in stock.vehicles}
    for unit in chosen.formation:
        if unit not in by_id:
            raise InputError(file, f"trains {chosen.id} formation", unit, f"one of {', '.join(sorted(by_id))}")
    vehicles = [by_id[unit] for unit in chosen.formation]
    # Unknown keys that are not mistyped say nothing about a run: pictures, owners, prices.
    _find_unknown(file, "trains", chosen)
    for vehicle in by_id.values():
        _find_unknown(file, "vehicles", vehicle)
    mass_t = fsum(_loaded_t(vehicle) for vehicle in vehicles)
    inertial_kg = 1000 * fsum(_loaded_t(vehicle) * vehicle.rotation_mass for vehicle in vehicles)
    davis = np.sum([np.array(_resistance(v)) * _resisting_t(v) for v in vehicles], axis=0) / mass_t
    limits_kmh = [vehicle.speed_limit for vehicle in vehicles if vehicle.speed_limit is not None]
    braking_mps2 = _braking(vehicles)
    return Train(
        name=chosen.name,
        mass_kg=mass_t * 1000,
        inertial_mass_kg=inertial_kg,
        length_m=fsum(vehicle.length for vehicle in vehicles),
        davis_a_n_per_kn=float(davis[0]),
        davis_b_n_per_kn_kmh=float(davis[1]),
        davis_c_n_per_kn_kmh2=float(davis[2]),
        traction=_traction(file, chosen, vehicles),
        brake=Effort(force_max_n=braking_mps2 * inertial_kg),
        actuator_pole_per_s=actuator_pole_per_s,
        force_per_notch_n=accel_per_notch_mps2 * inertial_kg,
        notch_max=notch_max,
        speed_limit_mps=min(limits_kmh) / 3.6 if limits_kmh else 1000.0,
        service_braking_mps2=braking_mps2,
        gravity_mps2=GRAVITY_MPS2,
    )


def _loaded_t(vehicle: _Vehicle) -> float:
    return vehicle.mass + (vehicle.load_limit or 0.0)


def _resisting_t(vehicle: _Vehicle) -> float:
    """Mass by which the resistance terms of a vehicle are multiplied: without load for powered vehicles."""
    return _loaded_t(vehicle) if vehicle.vehicle_type in ("passenger", "freight") else vehicle.mass


def _resistance(vehicle: _Vehicle) -> tuple[float, float, float]:
    """Davis coefficients of one vehicle in permil of its weight, V in km/h (see the module's formulas)."""
    base = vehicle.base_resistance or 0.0
    rolling = vehicle.rolling_resistance or 0.0
    air = (vehicle.air_resistance or 0.0) / 100**2
    if vehicle.vehicle_type == "freight":
        return base, 0.0, air
    if vehicle.vehicle_type == "passenger":
        return base + air * _WIND_KMH**2, rolling / 100 + 2 * _WIND_KMH * air, air
    driven = (vehicle.mass_traction or vehicle.mass) / vehicle.mass
    return base * driven + rolling * (1 - driven) + air * _WIND_KMH**2, 2 * _WIND_KMH * air, air


def _braking(vehicles: list[_Vehicle]) -> float:
    given = [-vehicle.a_braking for vehicle in vehicles if vehicle.a_braking is not None]
    if given:
        return min(given)
    return _BRAKING_MPS2["freight" if any(v.vehicle_type == "freight" for v in vehicles) else "passenger"]


def _traction(file: str | Path, train: _Train, vehicles: list[_Vehicle]) -> Effort:
    """Sum of the effort curves of all powered vehicles over the union of their speeds."""
    powered = [vehicle for vehicle in vehicles if vehicle.tractive_effort]
    if not powered:
        raise InputError(file, f"trains {train.id} formation", train.formation, "a vehicle with tractive_effort")
    for vehicle in powered:
        speeds = [row[0] for row in vehicle.tractive_effort]
        if any(later <= earlier for earlier, later in pairwise(speeds)):
            raise InputError(file, f"vehicles {vehicle.id} tractive_effort", speeds, "increasing speeds")
    speeds_kmh = sorted({row[0] for vehicle in powered for row in vehicle.tractive_effort})
    total_n = np.zeros(len(speeds_kmh))
    for vehicle in powered:
        table = np.array(vehicle.tractive_effort)
        total_n += np.interp(speeds_kmh, table[:, 0], table[:, 1])
    curve = tuple((kmh / 3.6, float(force_n)) for kmh, force_n in zip(speeds_kmh, total_n, strict=True))
    return Effort(force_max_n=float(total_n.max()), curve=curve)


def _choose(file: str | Path, key: str, entries: list[_Entry], wanted: str | None) -> _Entry:
    ids = [entry.id for entry in entries]
    if wanted is None and len(entries) == 1:
        return entries[0]
    if wanted not in ids:
        found = Words("no choice among several") if wanted is None else wanted
        raise InputError(file, f"{key} id", found, f"one of {', '.join(ids)}")
    return entries[ids.index(wanted)]


def _read(file: str | Path, kind: str) -> dict[str, Any]:
    expected = f"a {kind} document in YAML"
    try:
        with refuse_unreadable(Path(file), expected):
            data = parse_yaml(given_text(Path(file)))
    except ImportError as error:
        raise missing_library(str(file), error, "railtoolkit") from None
    if not isinstance(data, dict):
        raise InputError(file, "", Words(f"is a {type(data).__name__}"), expected)
    schema = f"https://railtoolkit.org/schema/{kind}.json"
    if data.get("schema") != schema:
        raise InputError(file, "schema", data.get("schema", Words()), schema)
    if data.get("schema_version") not in VERSIONS[kind]:
        allowed = " or ".join(map(repr, VERSIONS[kind]))
        raise InputError(file, "schema_version", data.get("schema_version", Words()), f"the text {allowed}")
    return data


def _name_file(file: str | Path) -> Callable[[Keys], str | Path]:
    def origin(_: Keys) -> str | Path:
        return file

    return origin
