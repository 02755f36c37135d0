"""A line with its stops, from which a single run can be cut out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from railhil.scenarios import profiles
from railhil.systems.ato.scenario.model import Balise, Line

#: Balises of stop ``i`` are numbered ``10 i + 1, 10 i + 2, ...`` in running order; stops 25 apart share numbers,
#: because the telegram has only 8 bits for them.
_NUMBERS_PER_STOP = 10
_STOPS_NUMBERED = 25


@dataclass(frozen=True, slots=True)
class Stop:
    """A stopping point: its name and the position of the train's front there, in m along the line."""

    name: str
    position_m: float


@dataclass(frozen=True, slots=True)
class StopLine:
    """A whole line in its own positions (m), with its stops in running order.

    ``remarks`` say what its file has but a run does not use, and what was chosen where the file says nothing.
    """

    line: Line
    stops: tuple[Stop, ...]
    remarks: tuple[str, ...] = ()

    def section(
        self,
        from_index: int,
        to_index: int,
        train_length_m: float,
        balises_before_stop_m: tuple[float, ...] = (),
    ) -> Line:
        """The run between two stops, shifted so that it starts at 0.

        Keeps the profiles under the standing train at both ends (they may start at negative positions) and the balises
        of the line in between. ``balises_before_stop_m`` lists distances before each stopping point in running order;
        it adds the balises of the arrival stop, and of the departure stop the one at the stopping point.
        """
        start_m, end_m = self.stops[from_index].position_m, self.stops[to_index].position_m
        low_m = start_m - train_length_m
        line = self.line
        balises = tuple(
            Balise(balise.number, balise.surveyed_m - start_m, balise.true_m - start_m)
            for balise in line.balises
            if start_m <= balise.surveyed_m <= end_m
        )
        return Line(
            name=f"{line.name}: {self.stops[from_index].name} - {self.stops[to_index].name}",
            grade_permil=profiles.shift(profiles.cut(line.grade_permil, low_m, end_m), start_m),
            speed_limit_mps=profiles.shift(profiles.cut(line.speed_limit_mps, low_m, end_m), start_m),
            balises=balises + _stop_balises(from_index, to_index, end_m - start_m, balises_before_stop_m),
        )


def list_begins(line: Line, start_m: float) -> tuple[str, ...]:
    """Remarks about profiles whose first row lies behind the start of a run: its value holds before it, too."""
    (grade_m, permil), (limit_m, limit_mps) = line.grade_permil[0], line.speed_limit_mps[0]
    words = ((grade_m, f"grade, {permil:g} permil"), (limit_m, f"speed limit, {limit_mps * 3.6:g} km/h"))
    return tuple(
        f"the first {what}, begins at {from_m:g} m and is taken to hold from {start_m:g} m"
        for from_m, what in words
        if from_m > start_m
    )


def list_unused(names: Sequence[str]) -> tuple[str, ...]:
    """The remark about what a file has but a run does not use, if there is anything."""
    return (f"not used of its file: {', '.join(names)}",) if names else ()


def lay_balises(stop_index: int, stop_m: float, before_stop_m: Sequence[float]) -> tuple[Balise, ...]:
    """The balises before a stop, numbered in running order.

    :param stop_index: number of the stop along the run or the line, from 0.
    :param before_stop_m: their distances before the stopping point.
    """
    first = _NUMBERS_PER_STOP * (stop_index % _STOPS_NUMBERED) + 1
    return tuple(
        Balise(number, stop_m - before_m, stop_m - before_m) for number, before_m in enumerate(before_stop_m, first)
    )


def _stop_balises(
    from_index: int, to_index: int, distance_m: float, before_stop_m: tuple[float, ...]
) -> tuple[Balise, ...]:
    """Balises laid at the same distances before every stop; the one at the departure point lies under the train."""
    here = (balise for balise in lay_balises(from_index, 0.0, before_stop_m) if balise.surveyed_m == 0.0)
    return (*here, *lay_balises(to_index, distance_m, before_stop_m))
