"""Deviations of the bench from the paper with the published scores of a system."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from importlib.resources import files


@dataclass(frozen=True, slots=True)
class Deviation:
    """``at``: place in the paper; ``reading``: interpretation used here; ``other``: effect of the alternative, or
    empty if not known."""

    at: str
    reading: str
    other: str


def read_deviations(package: str) -> tuple[str, tuple[Deviation, ...]]:
    """The paper, and all deviations from it in the order of its equations.

    :param package: the package with their file, ``deviations.toml``.
    """
    content = tomllib.loads(files(package).joinpath("deviations.toml").read_text(encoding="utf-8"))
    return content["source"], tuple(Deviation(**row) for row in content["deviation"])
