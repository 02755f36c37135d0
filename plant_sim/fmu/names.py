"""What an FMU of a train exchanges with the bench, and the file with its names for it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words, did_you_mean

#: Unit -> its SI unit here, and the factor to it.
UNITS = {
    "N": ("N", 1.0), "kN": ("N", 1e3), "m": ("m", 1.0), "km": ("m", 1e3), "m/s": ("m/s", 1.0),
    "km/h": ("m/s", 1 / 3.6), "permil": ("permil", 1.0), "%": ("permil", 10.0), "1": ("1", 1.0),
}  # fmt: skip
#: What the bench gives to the FMU, and what it takes from it: quantity -> unit.
INPUTS = {"force_n": "N", "traction_allowed": "1", "brake_min_n": "N", "grade_permil": "permil"}
OUTPUTS = {"position_m": "m", "speed_mps": "m/s", "effort_n": "N"}
_NEEDED = ("force_n", *OUTPUTS)


@dataclass(frozen=True, slots=True)
class Named:
    """A variable of the FMU: its name, and its unit with the factor to ours."""

    variable: str
    unit: str
    factor: float


@dataclass(frozen=True, slots=True)
class Names:
    """The names of an FMU for our quantities, and values of its parameters: numbers, or names of the train's keys."""

    file: Path
    inputs: Mapping[str, Named]
    outputs: Mapping[str, Named]
    parameters: Mapping[str, float | str]


def read_names(path: Path) -> Names:
    """The file with the names.

    :raises InputError: it cannot be read, or a key or value is not allowed.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "file", Words((error.strerror or str(error)).lower()), "a TOML file") from None
    except ValueError as error:
        raise InputError(path, "file", Words("no TOML"), "a TOML file", str(error)) from None
    _known(path, "", table, ("inputs", "outputs", "parameters"))
    found = {
        key: {
            name: _named(path, f"{key}.{name}", entry, unit)
            for name, unit in quantities.items()
            if (entry := _section(path, table, key, quantities).get(name)) is not None
        }
        for key, quantities in (("inputs", INPUTS), ("outputs", OUTPUTS))
    }
    for name in _NEEDED:
        key = "outputs" if name in OUTPUTS else "inputs"
        if name not in found[key]:
            raise InputError(path, f"{key}.{name}", Words("no such key"), "the name of the FMU's variable")
    parameters = _section(path, table, "parameters", None)
    for name, value in parameters.items():
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise InputError(path, f"parameters.{name}", value, "a number, or a key of the train such as 'mass_kg'")
    return Names(path, found["inputs"], found["outputs"], parameters)


def _section(path: Path, table: Mapping[str, Any], key: str, known: Mapping[str, str] | None) -> dict[str, Any]:
    section = table.get(key, {})
    if not isinstance(section, dict):
        raise InputError(path, key, section, "a table")
    if known is not None:
        _known(path, f"{key}.", section, known)
    return section


def _known(path: Path, prefix: str, table: Mapping[str, Any], known: Any) -> None:
    for key in table:
        if key not in known:
            raise InputError(path, f"{prefix}{key}", Words("no such key"), ", ".join(known), did_you_mean(key, known))


def _named(path: Path, key: str, entry: Any, ours: str) -> Named:
    """One entry: ``"v"``, or ``{ variable = "v", unit = "km/h" }``."""
    given = {"variable": entry} if isinstance(entry, str) else entry
    if not isinstance(given, dict) or not isinstance(given.get("variable"), str):
        raise InputError(path, key, entry, 'the name of a variable, or { variable = "v", unit = "km/h" }')
    _known(path, f"{key}.", given, ("variable", "unit"))
    unit = given.get("unit", ours)
    allowed = [name for name, (base, _) in UNITS.items() if base == ours]
    if unit not in allowed:
        raise InputError(path, f"{key}.unit", unit, ", ".join(allowed))
    return Named(given["variable"], unit, UNITS[unit][1])
