"""Least traction work of the sections of shipped lines, for the figures of a report.

``bounds.toml`` has a row for each section: the comfort bound in its timetable's running time, and the multiplier by
which it holds for other times (:meth:`railhil.systems.ato.energy.programme.EnergyBound.bound_at_kj`). A section is
known by all that its bound depends on, not by its name. ``python -m railhil.systems.line.shipped_bounds`` prints the
rows; that takes minutes.
"""

from __future__ import annotations

import tomllib
from functools import cache
from hashlib import sha256
from importlib.resources import files

from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.sections import section_scenario

#: The lines whose sections are in the table.
LINES = ("yizhuang_out", "yizhuang_back")
#: Decimals to which places and grades of a section are compared.
_DECIMALS = 6
_MIN_SHARE = 0.97


def shipped_bound_kj(line: LineScenario, number: int, running_time_s: float) -> float | None:
    """The comfort bound of a section in a running time; None if it is not in the table, or the time differs too much.

    :param number: of the section, from 1.
    """
    row = _table().get(section_key(section_scenario(line, number - 1)))
    if row is None or running_time_s < _MIN_SHARE * row["running_time_s"]:
        return None
    return row["bound_kj"] - row["multiplier_w"] * (running_time_s - row["running_time_s"]) / 1000


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
def _table() -> dict[str, dict[str, float]]:
    text = files(__package__).joinpath("bounds.toml").read_text(encoding="utf-8")
    return {row["key"]: row for row in tomllib.loads(text)["section"]}


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
            found = energy_bound(section, section.plan.running_time_s, "comfort")
            print("[[section]]")
            print(f'name = "{name} {index + 1}"')
            print(f'key = "{section_key(section)}"')
            print(f"running_time_s = {section.plan.running_time_s:.10g}")
            print(f"bound_kj = {found.bound_kj:.1f}")
            print(f"multiplier_w = {found.multiplier_w:.1f}", flush=True)


if __name__ == "__main__":
    main()
