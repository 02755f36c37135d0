"""Quantities that an FMU of a train exchanges with the bench, and the file with the FMU's names for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.user_files import given_text, refuse_unreadable
from railhil.scenarios.tomlfile import parse_toml

#: Unit -> its SI unit here, and the factor to it.
UNITS = {
    "N": ("N", 1.0), "kN": ("N", 1e3), "m": ("m", 1.0), "km": ("m", 1e3), "m/s": ("m/s", 1.0),
    "km/h": ("m/s", 1 / 3.6), "m/s2": ("m/s2", 1.0), "permil": ("permil", 1.0), "%": ("permil", 10.0), "1": ("1", 1.0),
}  # fmt: skip


class Input(NamedTuple):
    """A quantity that the bench gives to the FMU: its unit, its usual value, and another value for the check of
    determinism (:mod:`railhil.plant_sim.fmu.determinism`)."""

    unit: str
    usual: float
    other: float


@dataclass(frozen=True, slots=True)
class Quantities:
    """Quantities that the plant of a system exchanges with an FMU of its train.

    :param inputs: by name; the first is the command.
    :param outputs: units by name.
    :param needed: names that every map must have.
    :param switches: inputs that may be Boolean.
    """

    inputs: Mapping[str, Input]
    outputs: Mapping[str, str]
    needed: tuple[str, ...]
    switches: tuple[str, ...] = ()

    @property
    def units(self) -> dict[str, dict[str, str]]:
        """Units by table of the map and name."""
        return {"inputs": {name: one.unit for name, one in self.inputs.items()}, "outputs": dict(self.outputs)}


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


def read_names(path: Path, quantities: Quantities) -> Names:
    """The file with the names.

    :raises InputError: it cannot be read, or a key or value is not allowed.
    """
    with refuse_unreadable(path, "a TOML file"):
        table = parse_toml(given_text(path))
    _known(path, "", table, ("inputs", "outputs", "parameters"))
    found = {
        key: {
            name: _named(path, f"{key}.{name}", entry, unit)
            for name, unit in units.items()
            if (entry := _section(path, table, key, units).get(name)) is not None
        }
        for key, units in quantities.units.items()
    }
    for name in quantities.needed:
        key = "outputs" if name in quantities.outputs else "inputs"
        if name not in found[key]:
            raise InputError(path, f"{key}.{name}", Words(), "the name of the FMU's variable")
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
            raise InputError(path, f"{prefix}{key}", Words("unknown key"), ", ".join(known), did_you_mean(key, known))


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
