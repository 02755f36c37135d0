"""Planned instants of a line, at which faults may begin: ``@stop 3``, ``@section 5 40s``."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.scenarios.fault_list import Marks
from railhil.systems.line.scenario.model import StationStop


def find_marks(stops: Sequence[StationStop]) -> Marks:
    """Arrival at each stop, and departure into each section, in s; numbers count from 1.

    The run begins at the first stop. A stop that the train passes has no time.
    """
    return {
        "stop": (0.0, *(stop.arrive_s for stop in stops[1:])),
        "section": tuple(stop.depart_s for stop in stops if stop.depart_s is not None),
    }
