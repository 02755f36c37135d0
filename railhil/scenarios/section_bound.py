"""Least traction work of the sections of a scenario: what a system's part ``bound`` lists."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias


@dataclass(frozen=True, slots=True)
class WorkBound:
    """Traction work at the wheel that no driving falls short of: lower bound, and the work of one driving, kJ."""

    dual_kj: float
    feasible_kj: float

    @property
    def bound_kj(self) -> float:
        """The smaller of both values."""
        return min(self.dual_kj, self.feasible_kj)


@dataclass(frozen=True, slots=True)
class SectionBound:
    """A section from stop to stop with its shortest time and the least work in its running time.

    ``ideal``: within all that train and line permit; ``comfort``: within the usual limits of a comfortable driving,
    None if the running time is too short for them.
    """

    name: str
    length_m: float
    running_time_s: float
    shortest_s: float
    ideal: WorkBound
    comfort: WorkBound | None


#: The part ``bound`` of a system: the sections of a scenario in running order, each computed when it is asked for.
#: It raises :class:`railhil.common.errors.InputError` for a running time below the shortest.
ListBounds: TypeAlias = Callable[[Any], Iterator[SectionBound]]
