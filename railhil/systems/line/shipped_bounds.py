"""Least traction work of the sections of shipped lines, for scores and figures.

``bounds.toml`` has rows for each section, from its fastest running time to that of the timetable: the comfort bound,
and the multiplier by which it holds for other times
(:meth:`railhil.systems.ato.energy.programme.EnergyBound.bound_at_kj`). The bound is a convex function of the time, so
each row is a line below it, and the highest of these lines counts. A section is known by all that its bound depends on,
not by its name. ``python -m railhil.systems.line.shipped_bounds`` prints the rows; that takes minutes.
"""

from __future__ import annotations

import tomllib
from functools import cache
from hashlib import sha256
from importlib.resources import files
from math import ceil, log

from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.sections import section_scenario

#: The lines whose sections are in the table.
LINES = ("yizhuang_out", "yizhuang_back", "four_stops", "zurich")
#: Decimals to which places and grades of a section are compared.
_DECIMALS = 6
#: A shorter time than this share of the shortest one in the table has no bound.
_MIN_SHARE = 0.97
#: Ratio of two running times in the table, at most.
_RATIO = 1.06


def shipped_bound_kj(line: LineScenario, number: int, running_time_s: float) -> float | None:
    """The comfort bound of a section in a running time; None if it is not in the table, or the time is too short.

    :param number: of the section, from 1.
    """
    rows = _rows_of(line, number - 1)
    if not rows or running_time_s < _MIN_SHARE * min(row["running_time_s"] for row in rows):
        return None
    return max(row["bound_kj"] - row["multiplier_w"] * (running_time_s - row["running_time_s"]) / 1000 for row in rows)


def has_shipped_bounds(line: LineScenario) -> bool:
    """Whether the table has all sections of a line."""
    return all(_rows_of(line, index) for index in range(len(line.sections)))


def _rows_of(line: LineScenario, index: int) -> list[dict[str, float]]:
    return _table().get(section_key(section_scenario(line, index)), [])


def section_key(section: Scenario) -> str:
    """What the bound of a section depends on besides the time, as a digest."""

    def rounded(rows: tuple[tuple[float, float], ...]) -> list[tuple[float, float]]:
        return [(round(at, _DECIMALS) + 0.0, round(value, _DECIMALS) + 0.0) for at, value in rows]

    line = section.line
    said = (
        rounded(line.grade_permil),
        rounded(line.speed_limit_mps),
        round(section.plan.distance_m, _DECIMALS),
        section.train,
    )
    return sha256(repr(said).encode()).hexdigest()[:16]


@cache
def _table() -> dict[str, list[dict[str, float]]]:
    text = files(__package__).joinpath("bounds.toml").read_text(encoding="utf-8")
    found: dict[str, list[dict[str, float]]] = {}
    for row in tomllib.loads(text)["section"]:
        found.setdefault(row["key"], []).append(row)
    return found


def list_times_s(fastest_s: float, running_time_s: float) -> list[float]:
    """Running times of a section's rows: from the fastest, which is rounded up to 0.1 s, to that of the timetable."""
    shortest_s = min(ceil(fastest_s * 10) / 10, running_time_s)
    steps = ceil(log(running_time_s / shortest_s) / log(_RATIO))
    between_s = (round(shortest_s * (running_time_s / shortest_s) ** (step / steps), 1) for step in range(steps))
    return [*between_s, running_time_s]


def main() -> None:
    """Print the table of :data:`LINES`."""
    from railhil.scenarios.load import load_any
    from railhil.systems.ato.energy.programme import energy_bound

    print("# Written by python -m railhil.systems.line.shipped_bounds: comfort bounds, see there.")
    for name in LINES:
        line = load_any(name)
        assert isinstance(line, LineScenario)
        for index in range(len(line.sections)):
            section = section_scenario(line, index)
            for time_s in list_times_s(line.sections[index].fastest_s, section.plan.running_time_s):
                found = energy_bound(section, time_s, "comfort")
                print("[[section]]")
                print(f'name = "{name} {index + 1}"')
                print(f'key = "{section_key(section)}"')
                print(f"running_time_s = {time_s:.10g}")
                print(f"bound_kj = {found.bound_kj:.1f}")
                print(f"multiplier_w = {found.multiplier_w:.1f}", flush=True)


if __name__ == "__main__":
    main()
