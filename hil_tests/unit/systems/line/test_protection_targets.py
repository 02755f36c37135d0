"""Target curves under the train protection: the gaps of the shipped ones, and what a scenario is refused for."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from math import inf
from time import process_time
from typing import TYPE_CHECKING, Any, cast

import pytest

from railhil.common.errors import InputError
from railhil.scenarios.load import load_any
from railhil.scenarios.validation import Keys, join_keys
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.systems.line.scenario.model import RouteSignal
from railhil.systems.line.scenario.protection import PROFILES
from railhil.systems.line.scenario.protection_check import _end_target, _samples, check_targets, track_of

if TYPE_CHECKING:
    from railhil.systems.line.scenario.model import LineScenario


#: Indices of ``LimitCurve.times``; the EBI itself has no time.
_SERVICE, _WARNING, _PERMITTED = range(3)


@dataclass(frozen=True, slots=True)
class Gaps:
    """Smallest ways of a target curve to the limits before the next stop, and to those before lower limits, in m.

    ``ceiling_mps`` is the smallest speed left below the ceilings.
    """

    permitted_m: float
    warning_m: float
    service_m: float
    emergency_m: float
    lower_limit_m: float
    ceiling_mps: float


def find_gaps(line: LineScenario, index: int, curve: TargetCurve) -> Gaps:
    """How near a target curve of a section comes to the limits.

    :param index: number of the section, from 0.
    :raises GradeNotHeldError: a brake does not hold a grade on the way.
    """
    section = line.sections[index]
    track = track_of(line.atp, line.train, line.legs[section.leg])
    end = _end_target(line, section, track)
    least = [inf] * 4
    lower_m = ceiling_mps = inf
    for sample in _samples(line, section, curve):
        for row, which in enumerate((_PERMITTED, _WARNING, _SERVICE)):
            least[row] = min(least[row], sample.gap_m(end, which))
        if sample.speed_mps > end.floor.permitted_mps:
            emergency_m = end.emergency.place_m(sample.speed_mps, 0.0, sample.accel_mps2)
            least[3] = min(least[3], emergency_m - sample.most_m)
        for target in track.lower:
            if target.place_m > sample.most_m:
                lower_m = min(lower_m, sample.gap_m(target, _PERMITTED))
        ceiling = track.ceiling(sample.least_m, sample.most_m)
        ceiling_mps = min(ceiling_mps, ceiling.permitted_mps - sample.speed_mps)
    return Gaps(least[0], least[1], least[2], least[3], lower_m, ceiling_mps)


def refuse(keys: Keys, found: object, allowed: str) -> InputError:
    return InputError("line.toml", join_keys(keys), found, allowed)


@pytest.fixture(scope="module")
def yizhuang() -> LineScenario:
    return cast("LineScenario", load_any("yizhuang_out"))


@pytest.fixture(scope="module")
def four_stops() -> LineScenario:
    return cast("LineScenario", load_any("four_stops"))


def least(line: LineScenario) -> Gaps:
    rows = [find_gaps(line, index, section.target) for index, section in enumerate(line.sections)]
    names = Gaps.__slots__
    return Gaps(**{name: min(getattr(row, name) for row in rows) for name in names})


def with_overlap(line: LineScenario, eoa_m: float, svl_m: float = 30.0) -> LineScenario:
    stops = tuple(replace(stop, eoa_overlap_m=eoa_m, svl_overlap_m=svl_m) for stop in line.stops)
    return replace(line, stops=stops)


def refusal(line: LineScenario) -> str:
    with pytest.raises(InputError) as refused:
        check_targets(line, refuse)
    return str(refused.value)


def test_the_gaps_of_the_shipped_targets_are_those_of_independent_programs(yizhuang: LineScenario) -> None:
    """5.0 m to P, 7.7 m to W, 9.4 m to SBI, 26 m to EBI, 27 m before lower limits, 2.0 km/h below ceilings."""
    gaps = least(yizhuang)
    assert gaps.permitted_m == pytest.approx(5.0, abs=0.1)
    assert gaps.warning_m == pytest.approx(7.7, abs=0.1)
    assert gaps.service_m == pytest.approx(9.4, abs=0.1)
    assert gaps.emergency_m == pytest.approx(26.0, abs=0.2)
    assert gaps.lower_limit_m == pytest.approx(27.0, abs=2.0)
    assert gaps.ceiling_mps * 3.6 == pytest.approx(2.0, abs=0.05)


def test_with_an_end_of_authority_5_m_behind_the_stops_the_targets_touch_the_permitted_speed(
    yizhuang: LineScenario,
) -> None:
    near = with_overlap(yizhuang, 5.0)
    assert least(near).permitted_m == pytest.approx(0.0, abs=0.05)
    assert "target Songjiazhuang - Xiaocun" in refusal(near)


def test_slow_brakes_need_slower_targets_even_with_40_m(yizhuang: LineScenario) -> None:
    """T_driver 4 s, T_warning 2 s, T_bs 1.5 s: about 10 m beyond P."""
    slow = replace(yizhuang, atp=replace(yizhuang.atp, t_driver_s=4.0, t_warning_s=2.0, t_bs_s=1.5))
    assert least(with_overlap(slow, 40.0, 80.0)).permitted_m == pytest.approx(-10.0, abs=1.0)


def test_shipped_lines_pass_and_quickly(yizhuang: LineScenario, four_stops: LineScenario) -> None:
    check_targets(four_stops, refuse)
    begin_s = process_time()
    check_targets(yizhuang, refuse)
    assert process_time() - begin_s < 0.3


def test_a_protection_that_is_off_checks_nothing(yizhuang: LineScenario) -> None:
    check_targets(replace(with_overlap(yizhuang, 5.0), atp=replace(yizhuang.atp, enabled=False)), refuse)


def test_an_error_names_section_place_speed_and_what_is_allowed(four_stops: LineScenario) -> None:
    text = refusal(replace(four_stops, atp=PROFILES["subset026"]))
    match = re.fullmatch(
        r"line\.toml: target ([AB]) - ([BD]): found ([0-9.]+) km/h at ([0-9]+) m, "
        r"allowed ([0-9.]+) km/h \(atp: permitted ([0-9.]+) less ato_margin_kmh\)",
        text,
    )
    assert match is not None
    found, allowed, permitted = (float(match[group]) for group in (3, 5, 6))
    assert allowed == pytest.approx(permitted - 1.0)
    assert found > permitted


def test_a_curve_keeps_the_margin_in_m(four_stops: LineScenario) -> None:
    gap_m = least(four_stops).permitted_m
    check_targets(replace(four_stops, atp=replace(four_stops.atp, ato_margin_m=gap_m - 0.01)), refuse)
    assert "target A - B" in refusal(replace(four_stops, atp=replace(four_stops.atp, ato_margin_m=gap_m + 0.01)))


def test_a_ceiling_keeps_the_margin_in_kmh(four_stops: LineScenario) -> None:
    gap_mps = least(four_stops).ceiling_mps
    check_targets(replace(four_stops, atp=replace(four_stops.atp, ato_margin_mps=gap_mps - 0.001)), refuse)
    text = refusal(replace(four_stops, atp=replace(four_stops.atp, ato_margin_mps=gap_mps + 0.001)))
    assert "target B - D: found" in text
    assert "(atp: permitted 60.0 less ato_margin_kmh)" in text


def with_braking(line: LineScenario, braking_mps2: float, regulation: Any = "retime") -> LineScenario:
    """Its curves of the timetable stay as they are; those that are made anew brake harder."""
    generate = replace(line.route.generate, braking_max_mps2=braking_mps2)
    return replace(line, route=replace(line.route, generate=generate, regulation=regulation))


def test_the_fastest_curve_of_a_regulated_section_stays_below_the_warning(four_stops: LineScenario) -> None:
    text = refusal(with_braking(four_stops, 0.9))
    match = re.fullmatch(
        r"line\.toml: target A - B, retimed to 98\.6 s: found ([0-9.]+) km/h at [0-9]+ m, "
        r"allowed ([0-9.]+) km/h \(atp: warning\); a smaller route\.generate\.braking_max_mps2, or "
        r"route\.regulation = none or profiles, makes it slower",
        text,
    )
    assert match is not None, text
    assert float(match[1]) > float(match[2])


def test_without_regulation_no_curve_is_faster_than_that_of_the_timetable(four_stops: LineScenario) -> None:
    check_targets(with_braking(four_stops, 0.9, "none"), refuse)


def test_fastest_curves_above_the_permitted_speed_are_among_the_assumptions(
    four_stops: LineScenario, yizhuang: LineScenario
) -> None:
    for line, count in ((four_stops, 1), (yizhuang, 2), (load_any("zurich"), 0)):
        said = [sentence for sentence in line.assumptions if sentence.startswith("regulation: ")]
        assert len(said) == (count > 0)
        assert sum(sentence.count(" in ") for sentence in said) == count
    assert "A - B in 98.6 s (0.1 km/h)" in " ".join(four_stops.assumptions)


@pytest.mark.parametrize("name", ["four_stops", "yizhuang_out"])
def test_a_profile_that_is_too_fast_is_refused_with_the_key_that_makes_it_slower(name: str) -> None:
    with pytest.raises(InputError) as refused:
        load_any(name, ["route.regulation=profiles"])
    said = str(refused.value)
    assert "\n" not in said
    assert "profile fast: found " in said
    assert "a larger reserve in route.profiles_percent[0], now 0, makes it slower" in said
    load_any(name, ["route.regulation=profiles", "route.profiles_percent=[7, 9, 12]"])


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"emergency_mps2": ((0.0, 0.6),)}, "A_safe -0.086 m/s2 at 1230 m, 0 km/h"),
        ({"service_mps2": ((0.0, 0.45),)}, "A_expected -0.095 m/s2 at 1210 m, 0 km/h"),
    ],
)
def test_brakes_that_do_not_hold_a_grade_are_refused(
    four_stops: LineScenario, changed: dict[str, Any], words: str
) -> None:
    leg = replace(four_stops.legs[0], grade_permil=((-118.0, 0.0), (1150.0, -58.8787), (1300.0, 0.0)))
    leg = replace(leg, speed_limit_mps=leg.speed_limit_mps[:2])
    line = replace(four_stops, legs=(leg,), atp=replace(four_stops.atp, **changed))
    brake = "emergency" if "A_safe" in words else "service"
    assert (
        refusal(line)
        == f"line.toml: atp: found {words}, allowed above 0.05: the {brake} brake does not hold this grade"
    )


def test_a_signal_on_a_grade_that_no_brake_holds_is_refused(four_stops: LineScenario) -> None:
    leg = replace(four_stops.legs[0], grade_permil=((-118.0, 0.0), (400.0, -100.0), (500.0, 0.0)))
    signals = (RouteSignal(450.0, 100.0),)
    assert "does not hold this grade" in refusal(replace(four_stops, legs=(leg,), signals=signals))


def test_a_track_is_made_once(yizhuang: LineScenario) -> None:
    made = track_of(yizhuang.atp, yizhuang.train, yizhuang.legs[0])
    assert track_of(yizhuang.atp, yizhuang.train, yizhuang.legs[0]) is made
