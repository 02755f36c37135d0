"""The age of TRK_INFO: what it demands, and what makes it younger."""

from __future__ import annotations

from dataclasses import replace

import pytest

from railhil.controller_node.ato.speed_watch import Finding
from railhil.controller_node.ato.track_info import TrackInfo
from railhil.scenarios.load import load
from railhil.wire.ato import CtlCause, TrkInfo, WatchLevel

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000


def level_at(track: TrackInfo, now_ns: int) -> WatchLevel:
    found = track.finding(now_ns)
    return WatchLevel.NORMAL if found is None else found.level


@pytest.mark.parametrize(("period_ms", "cut_ms"), [(160, 480), (300, 900), (10, 30)])
def test_three_periods_cut_and_a_second_brakes(period_ms: int, cut_ms: int) -> None:
    timing = replace(SCENARIO.timing, port_period_ns={TrkInfo.PORT: period_ms * MS})
    track = TrackInfo(replace(SCENARIO, timing=timing))
    track.take(TrkInfo(speed_limit_4mmps=5000, grade_001permil=3000), 7 * MS)
    levels = [
        level_at(track, 7 * MS + age_ns) for age_ns in (0, cut_ms * MS, cut_ms * MS + 1, 1000 * MS, 1000 * MS + 1)
    ]
    normal, cut, brake = WatchLevel.NORMAL, WatchLevel.TRACTION_CUT, WatchLevel.SERVICE_BRAKE
    assert levels == [normal, normal, cut, cut, brake]
    # An old grade judges no brake; the limit stays.
    grades = [track.grade_001permil(7 * MS + age_ns) for age_ns in (cut_ms * MS, cut_ms * MS + 1)]
    assert (grades, track.limit_01mmps) == ([3000, None], 200_000)


def test_before_the_first_telegram_it_ages_from_the_beginning() -> None:
    track = TrackInfo(SCENARIO)
    assert track.finding(1001 * MS) == Finding(WatchLevel.SERVICE_BRAKE, CtlCause.TRACK_AGE)
    assert (track.limit_01mmps, track.grade_001permil(0)) == (None, None)


@pytest.mark.parametrize("changed", [{"life": 0}, {"limit_check": 0}, {"grade_check": 2}])
def test_what_says_nothing_new_makes_nothing_younger(changed: dict[str, int]) -> None:
    track = TrackInfo(SCENARIO)
    track.take(TrkInfo(speed_limit_4mmps=5000), 0)
    track.take(replace(TrkInfo(speed_limit_4mmps=4000, grade_001permil=5, life=1), **changed), 160 * MS)
    assert level_at(track, 481 * MS) is WatchLevel.TRACTION_CUT
    # What its check variable says to be correct is used all the same.
    assert track.limit_01mmps == (160_000 if "grade_check" in changed else 200_000)
    track.take(TrkInfo(speed_limit_4mmps=3000, life=2), 600 * MS)
    assert (level_at(track, 1080 * MS), track.limit_01mmps) == (WatchLevel.NORMAL, 120_000)
