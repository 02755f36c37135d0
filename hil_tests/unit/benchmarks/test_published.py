"""The statements of docs/explanation/paper_ordering.md about the published table, as far as they can be computed."""

from __future__ import annotations

import pytest

from benchmarks.published import alternating_run, tabulated
from railhil.scenarios.load import load

SCENARIO = load("lvshun_tieshan")


@pytest.mark.long
@pytest.mark.slow
def test_published_comfort_and_energy_are_not_reached_together() -> None:
    plain, shaken = (alternating_run(SCENARIO, notches) for notches in (0.0, 4.0))
    published = next(row for row in SCENARIO.published if row.controller == "ipfc")
    assert plain.score.values["comfort"] is not None
    assert shaken.score.values["comfort"] is not None
    assert plain.score.values["energy_kj"] is not None
    assert shaken.score.values["energy_kj"] is not None
    # Far from the published comfort still, and the energy is above the published one already.
    assert 5 * plain.score.values["comfort"] < shaken.score.values["comfort"] < published.values["comfort"]
    assert shaken.score.values["energy_kj"] > max(plain.score.values["energy_kj"], published.values["energy_kj"]) + 2000
    table = tabulated(SCENARIO, [plain, shaken])
    assert table.row_count == 3
