"""Known mistakes in a protection: each, made in the code, is noticed by a named test."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest

from hil_tests.mutation.install import replace_code
from hil_tests.unit.plant_sim.atp import test_protection as reactions
from hil_tests.unit.plant_sim.atp import test_supervision as looks
from hil_tests.unit.systems.line import test_braking_curves as curves


class Mistake(NamedTuple):
    """A text of a module, what stands there by mistake, and the test that notices it."""

    module: str
    right: str
    wrong: str
    test: Callable[[], None]


def goldens() -> None:
    for case in curves.CASES.values():
        curves.test_positions_are_those_of_independent_programs(case)
        curves.test_release_speed_and_ceiling_are_those_of_independent_programs(case)


_BRAKE, _CURVE, _LIMITS, _TRACK = (
    f"railhil.systems.line.braking.{name}" for name in ("brake", "curve", "limits", "track")
)
_SUPERVISION, _PROTECTION = "railhil.plant_sim.atp.supervision", "railhil.plant_sim.atp.protection"
_MEAN = """lowest = tuple(zip(*(row.tolist() for row in __import__(
            "railhil.scenarios.profiles", fromlist=["grade_rows"]).grade_rows(grade_permil, length_m)[:2])))"""

MISTAKES = {
    "sign of the grade": Mistake(
        _BRAKE, "return self.gravity_mps2 * permil", "return -self.gravity_mps2 * permil", goldens
    ),
    "mean instead of lowest grade": Mistake(
        _BRAKE, "lowest = find_lowest(grade_permil, length_m, inf)", _MEAN, goldens
    ),
    "no dead time of the emergency brake": Mistake(
        _BRAKE, "return max(self.t_be_s - self.t_traction_s, 0.0)", "return 0.0", goldens
    ),
    "SBD ends at the supervised location": Mistake(
        _TRACK,
        "self.braking.service_limits(eoa_m)",
        "self.braking.service_limits(svl_m)",
        reactions.test_the_limits_before_an_end_of_authority_are_reached_in_order_and_at_their_places,
    ),
    "EBI by the estimated position": Mistake(
        _SUPERVISION,
        "accel_mps2) - place.most_m",
        "accel_mps2) - place.estimated_m",
        reactions.test_the_limits_before_an_end_of_authority_are_reached_in_order_and_at_their_places,
    ),
    "SBI of the SBD by the most advanced position": Mistake(
        _SUPERVISION,
        "service.place_m(speed_mps, 0.0) - place.estimated_m",
        "service.place_m(speed_mps, 0.0) - place.most_m",
        reactions.test_the_limits_before_an_end_of_authority_are_reached_in_order_and_at_their_places,
    ),
    "a factor of the brake is valid above its speed only": Mistake(
        _BRAKE,
        "share = profile_value(self.k_dry, speed_mps)",
        "share = profile_value(self.k_dry, speed_mps - 1e-9)",
        goldens,
    ),
    "the permitted speed itself is too fast": Mistake(
        _SUPERVISION,
        "if speed_mps <= levels.permitted_mps:",
        "if speed_mps < levels.permitted_mps:",
        looks.test_exactly_at_a_limit_nothing_is_exceeded,
    ),
    "only one of two steps that coincide is taken": Mistake(
        _CURVE,
        "at_speed_step_m >= next_m, at_speed_step_m <= next_m",
        "at_speed_step_m >= next_m, at_speed_step_m < next_m",
        curves.test_steps_of_speed_and_position_that_coincide_are_both_taken,
    ),
    "release speed whatever the overlap": Mistake(
        _LIMITS, "return emergency.speed_mps(end_m + trip_m, 0.0, most_mps)", "return most_mps", goldens
    ),
    "the traction cut is not latched": Mistake(
        _PROTECTION,
        "if excess == NOTHING:\n            self._cut_cause",
        "if excess < ABOVE_WARNING:\n            self._cut_cause",
        reactions.test_traction_cut_at_the_warning_comes_back_at_the_permitted_speed,
    ),
    "the service brake is not latched": Mistake(
        _PROTECTION,
        "(excess == NOTHING and not self._is",
        "(excess < ABOVE_SERVICE and not self._is",
        reactions.test_traction_and_service_brake_come_back_at_the_permitted_speed,
    ),
    "the emergency brake is not latched": Mistake(
        _PROTECTION,
        "        emergency, service = self._emergency_cause",
        "        emergency, service = supervision.excess == ABOVE_EMERGENCY and self._emergency_cause",
        reactions.test_the_emergency_brake_stays_until_the_end,
    ),
}


@contextmanager
def made(mistake: Mistake) -> Iterator[None]:
    module = importlib.import_module(mistake.module)
    source = Path(str(module.__file__)).read_text(encoding="utf-8")
    assert source.count(mistake.right) == 1
    # As many lines as before: functions are found by their first line.
    wrong = mistake.wrong if "\n" in mistake.right else " ".join(mistake.wrong.split())
    indent = len(mistake.right) - len(mistake.right.lstrip())
    changed = source.replace(mistake.right, " " * indent + wrong if "\n" not in mistake.right else wrong)
    assert replace_code(module, ast.parse(changed))
    try:
        yield
    finally:
        assert replace_code(module, ast.parse(source))


@pytest.mark.parametrize("name", MISTAKES)
def test_a_known_mistake_is_noticed(name: str) -> None:
    mistake = MISTAKES[name]
    mistake.test()
    with made(mistake), pytest.raises(AssertionError):
        mistake.test()
    mistake.test()
