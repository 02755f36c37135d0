"""Units of the values in a sentence: each is a factor of SI units, with the dimensions that a comparison checks."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Final, TypeAlias

from railhil.common.errors import did_you_mean

#: Exponents of the base units, sorted by their names.
Dimensions: TypeAlias = tuple[tuple[str, int], ...]
#: A share such as 30 % or 5 permil, and a level of a watch, are told from numbers and from each other.
RATIO, LEVEL = "ratio", "level"
_FACTOR = re.compile(r"([A-Za-z%]+|1)([2-9]?)")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit; a value times ``factor`` is in SI units. ``text``: as it is written, empty for a number."""

    text: str
    dimensions: Dimensions
    factor: Fraction

    @property
    def quantity(self) -> str:
        """What has this unit, in words with the article, such as ``a length``."""
        return _WORDS.get(self.dimensions) or f"a quantity in {_written(self.dimensions)}"

    @property
    def name(self) -> str:
        """The unit behind a figure; a number has none."""
        return self.text


NUMBER: Final = Unit("", (), Fraction(1))
STEPS: Final = Unit("level", ((LEVEL, 1),), Fraction(1))

_FORCE: Final = {"kg": 1, "m": 1, "s": -2}
_ENERGY: Final = {"kg": 1, "m": 2, "s": -2}
_POWER: Final = {"kg": 1, "m": 2, "s": -3}
#: Unit -> base units and factor.
_KNOWN: Final[Mapping[str, tuple[Mapping[str, int], Fraction]]] = {
    "1": ({}, Fraction(1)),
    **{name: ({"m": 1}, Fraction(10) ** power) for name, power in {"m": 0, "mm": -3, "cm": -2, "km": 3}.items()},
    **{name: ({"s": 1}, Fraction(10) ** power) for name, power in {"s": 0, "ms": -3, "us": -6, "ns": -9}.items()},
    "min": ({"s": 1}, Fraction(60)),
    "h": ({"s": 1}, Fraction(3600)),
    "kg": ({"kg": 1}, Fraction(1)),
    "t": ({"kg": 1}, Fraction(1000)),
    **{name: (_FORCE, Fraction(10) ** power) for name, power in {"N": 0, "kN": 3, "MN": 6}.items()},
    **{name: (_ENERGY, Fraction(10) ** power) for name, power in {"J": 0, "kJ": 3, "MJ": 6}.items()},
    **{name: (_ENERGY, Fraction(3600) * 10**power) for name, power in {"Wh": 0, "kWh": 3}.items()},
    **{name: (_POWER, Fraction(10) ** power) for name, power in {"W": 0, "kW": 3, "MW": 6}.items()},
    "Hz": ({"s": -1}, Fraction(1)),
    "%": ({RATIO: 1}, Fraction(1, 100)),
    "permil": ({RATIO: 1}, Fraction(1, 1000)),
    # Counts are numbers: a sentence may give them with their unit or without.
    **dict.fromkeys(("notch", "bit", "cycles"), ({}, Fraction(1))),
    "level": ({LEVEL: 1}, Fraction(1)),
}
_WORDS: Final[Mapping[Dimensions, str]] = {
    (): "a number without a unit",
    (("m", 1),): "a length",
    (("s", 1),): "a time",
    (("m", 1), ("s", -1)): "a speed",
    (("m", 1), ("s", -2)): "an acceleration",
    (("m", 1), ("s", -3)): "a jerk",
    (("kg", 1),): "a mass",
    tuple(sorted(_FORCE.items())): "a force",
    tuple(sorted(_ENERGY.items())): "an energy",
    tuple(sorted(_POWER.items())): "a power",
    ((RATIO, 1),): "a share",
    ((LEVEL, 1),): "a level",
    (("s", -1),): "a rate",
}
#: SI units that have a name of their own.
_NAMED: Final = {
    tuple(sorted(_FORCE.items())): "N",
    tuple(sorted(_ENERGY.items())): "J",
    tuple(sorted(_POWER.items())): "W",
}


@cache
def unit_of(text: str) -> Unit:
    """The unit of a signal: a known one, else one of its own that can be compared only with itself."""
    try:
        return given_unit(text) if text else NUMBER
    except ValueError:
        return Unit(text, ((text, 1),), Fraction(1))


@cache
def given_unit(text: str) -> Unit:
    """The unit that a sentence gives behind a number, such as ``km/h`` or ``m/s3``.

    :raises ValueError: there is no such unit; the message says which part, and the unit that was probably meant.
    """
    dimensions: dict[str, int] = {}
    factor = Fraction(1)
    for place, part in enumerate(text.split("/")):
        found = _FACTOR.fullmatch(part)
        if found is None or found[1] not in _KNOWN:
            hint = did_you_mean(found[1] if found else part, _KNOWN)
            raise ValueError(f'"{part}" is no unit' + (f", {hint}" if hint else ""))
        power = int(found[2] or 1) * (-1 if place else 1)
        bases, scale = _KNOWN[found[1]]
        factor *= scale**power
        for base, exponent in bases.items():
            dimensions[base] = dimensions.get(base, 0) + exponent * power
    return Unit(text, _sorted(dimensions), factor)


def product(left: Unit, right: Unit, power: int) -> Unit:
    """The SI unit of a product (``power`` 1) or of a quotient (-1). A share of something is in its unit."""
    dimensions = dict(left.dimensions)
    for base, exponent in right.dimensions:
        dimensions[base] = dimensions.get(base, 0) + exponent * power
    if len(dimensions) > 1:
        dimensions.pop(RATIO, None)
    found = _sorted(dimensions)
    return Unit(_written(found), found, Fraction(1))


def _sorted(dimensions: Mapping[str, int]) -> Dimensions:
    return tuple(sorted((base, exponent) for base, exponent in dimensions.items() if exponent))


def _written(dimensions: Dimensions) -> str:
    if dimensions in _NAMED:
        return _NAMED[dimensions]
    above = "*".join(base + (str(power) if power > 1 else "") for base, power in dimensions if power > 0)
    below = "".join(f"/{base}" + (str(-power) if power < -1 else "") for base, power in dimensions if power < 0)
    return "" if not dimensions else (above or "1") + below
