"""Quantities that an FMU exchanges with the bench, and the file with the FMU's names for them."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
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
    "s": ("s", 1.0), "ms": ("s", 1e-3),
}  # fmt: skip
#: The unit of a quantity that is the integer of the wire.
RAW = "raw"


class Input(NamedTuple):
    """A quantity that the bench gives to the FMU: its unit, its usual value, and another value for the check of
    determinism (:mod:`railhil.fmu.determinism`); ``raw``: value of 1 on the wire, None: it is not on the wire."""

    unit: str
    usual: float
    other: float
    raw: float | None = None


class Output(NamedTuple):
    """A quantity that the FMU gives to the bench: its unit; ``raw`` as in :class:`Input`."""

    unit: str
    raw: float | None = None


@dataclass(frozen=True, slots=True)
class Quantities:
    """Quantities that the bench exchanges with an FMU.

    :param inputs: by name; in the check of determinism the first follows a course of its own.
    :param outputs: by name.
    :param needed: names that every map must have.
    :param switches: inputs that may be Boolean.
    :param any_number: variables may be integers, of single precision and Boolean, too.
    """

    inputs: Mapping[str, Input]
    outputs: Mapping[str, Output]
    needed: tuple[str, ...] = ()
    switches: tuple[str, ...] = ()
    any_number: bool = False

    @property
    def tables(self) -> dict[str, Mapping[str, Input | Output]]:
        """The quantities by table of the map."""
        return {"inputs": self.inputs, "outputs": self.outputs}


def factors_of(quantity: Input | Output) -> dict[str, float]:
    """Units in which a variable may have the quantity, with the factors to the quantity's own unit."""
    found = {quantity.unit: 1.0}
    found |= {name: factor for name, (base, factor) in UNITS.items() if base == quantity.unit}
    return found if quantity.raw is None else {**found, RAW: quantity.raw}


class Named(NamedTuple):
    """A variable of the FMU: its name, and the unit that the map gives it (None: none)."""

    variable: str
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Names:
    """The names of an FMU for our quantities, and values of its parameters: numbers, or names of the bench's values."""

    file: Path
    inputs: Mapping[str, Named]
    outputs: Mapping[str, Named]
    parameters: Mapping[str, float | str]


def equal_names(file: Path, quantities: Quantities, variables: Container[str], inputs: Iterable[str]) -> Names:
    """The names of an FMU whose variables have the names of the quantities.

    :param file: the FMU.
    :param inputs: variables that want a value in each step.
    :raises InputError: one of them has the name of no quantity, so nobody would set it.
    """
    for name in inputs:
        if name not in quantities.inputs:
            allowed = f"{', '.join(quantities.inputs)}; a file of names says which input is which"
            raise InputError(file, "inputs", name, allowed, did_you_mean(name, quantities.inputs))
    found = {
        key: {name: Named(name) for name in table if name in variables} for key, table in quantities.tables.items()
    }
    return Names(file, found["inputs"], found["outputs"], {})


def read_names(path: Path, quantities: Quantities) -> Names:
    """The file with the names.

    :raises InputError: it cannot be read, or a key or value is not allowed.
    """
    with refuse_unreadable(path, "a TOML file"):
        table = parse_toml(given_text(path))
    _known(path, "", table, ("inputs", "outputs", "parameters"))
    found = {
        key: {
            name: _named(path, f"{key}.{name}", entry, quantity)
            for name, quantity in known.items()
            if (entry := _section(path, table, key, known).get(name)) is not None
        }
        for key, known in quantities.tables.items()
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


def _section(path: Path, table: Mapping[str, Any], key: str, known: Mapping[str, Any] | None) -> dict[str, Any]:
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


def _named(path: Path, key: str, entry: Any, quantity: Input | Output) -> Named:
    """One entry: ``"v"``, or ``{ variable = "v", unit = "km/h" }``."""
    given = {"variable": entry} if isinstance(entry, str) else entry
    if not isinstance(given, dict) or not isinstance(given.get("variable"), str):
        raise InputError(path, key, entry, 'the name of a variable, or { variable = "v", unit = "km/h" }')
    _known(path, f"{key}.", given, ("variable", "unit"))
    unit, allowed = given.get("unit"), factors_of(quantity)
    if unit is not None and unit not in list(allowed):
        raise InputError(path, f"{key}.unit", unit, ", ".join(allowed))
    return Named(given["variable"], unit)
