"""Cases of braking curves in files of ``hil_tests/data/line``: brake, grade and target of each, with values computed by
independent programs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios.profiles import Profile
from railhil.systems.line.braking.brake import BrakeModel
from railhil.systems.line.braking.limits import INCREMENTS, Braking, LimitCurve, interpolate, release_mps

LINE_DATA = TEST_DATA / "line"
#: Faster than every row of a case.
_FASTEST_MPS = 30.0


def read_cases() -> list[dict[str, Any]]:
    """The cases of curves.json."""
    cases: list[dict[str, Any]] = json.loads((LINE_DATA / "curves.json").read_text(encoding="utf-8"))
    return cases


def brake_of(table: Mapping[str, Any]) -> BrakeModel:
    """The brake of a case."""
    t_bs_s, most = table["t_bs"], table["a_max_reduced_adhesion"]
    return BrakeModel(
        emergency_mps2=_profile(table["a_emergency"]),
        service_mps2=_profile(table["a_service"]),
        k_dry=_profile(table["k_dry"]),
        k_wet=_profile(table["k_wet"]),
        m_avadh=table["m_avadh"],
        a_max_reduced_mps2=inf if most is None else most,
        t_be_s=table["t_be"],
        t_bs1_s=t_bs_s if table["t_bs1"] is None else table["t_bs1"],
        t_bs2_s=t_bs_s if table["t_bs2"] is None else table["t_bs2"],
        t_cut_s=table["t_traction_cut_off"],
        t_warning_s=table["t_warning"],
        t_driver_s=table["t_driver"],
        t_ind_min_s=table["t_indication_min"],
        rotating_percent=table["rotating_percent"],
        gravity_mps2=table["gravity"],
        cut_at_warning=table["traction_cut_off_implemented"],
    )


@dataclass(frozen=True, slots=True)
class BrakingCase:
    """The curves of one case. ``service`` is None before a lower limit, ``release_mps`` likewise."""

    brake: BrakeModel
    gradients: Profile
    emergency: LimitCurve
    service: LimitCurve | None
    release_mps: float | None
    ceiling_mps: tuple[float, ...]
    fastest_mps: float = _FASTEST_MPS

    def positions_m(self, speed_mps: float, accel_mps2: float) -> list[float]:
        """One row of a case without its speed."""
        found = [self.emergency.curve.position_m(speed_mps)]
        for limits, accel in ((self.emergency, accel_mps2), (self.service, 0.0)):
            if limits is not None:
                times = limits.times
                leads = (0.0, times.service_s, times.warning_s, times.permitted_s, times.indication_s)
                found += [limits.place_m(speed_mps, lead_s, accel) for lead_s in leads]
        return found

    def speeds_mps(self, position_m: float, accel_mps2: float) -> list[float]:
        """One row of ``at_position`` without its position."""
        times = self.emergency.times
        leads = (0.0, times.service_s, times.warning_s, times.permitted_s)
        found = [self.emergency.speed_mps(position_m, lead_s, self.fastest_mps, accel_mps2) for lead_s in leads]
        if self.service is not None:
            leads = (self.service.times.service_s, self.service.times.permitted_s)
            found += [self.service.speed_mps(position_m, lead_s, self.fastest_mps) for lead_s in leads]
        return found


def make_case(case: Mapping[str, Any]) -> BrakingCase:
    """The curves of a case, as the product makes them.

    :raises GradeNotHeldError: the case is one that is refused.
    """
    brake = brake_of(case["brake"])
    gradients = brake.gradient_steps(_profile(case["grade"]), case["length"])
    braking = Braking(brake, gradients, _FASTEST_MPS, _profile(case["v_delta0"]))
    increments, ceiling_mps = INCREMENTS["subset026"], case["ceiling"]
    steps = (increments.warning, increments.service, increments.emergency)
    ceilings = (ceiling_mps, *(ceiling_mps + interpolate(step, ceiling_mps) for step in steps))
    target_mps, target_m = case["target_speed"], case["target_m"]
    if case["kind"] == "eoa":
        emergency, service = braking.emergency_limits(case["svl_m"], 0.0, 0.0), braking.service_limits(target_m)
        released = release_mps(emergency, target_m, case["d_trip"], case["v_release_nominal"])
        return BrakingCase(brake, gradients, emergency, service, released, ceilings)
    above = case["dv_foot"]
    foot_mps = target_mps + (interpolate(increments.emergency, target_mps) if above is None else above)
    emergency = braking.emergency_limits(target_m, foot_mps, target_mps)
    return BrakingCase(brake, gradients, emergency, None, None, ceilings)


def _profile(rows: list[list[float]]) -> Profile:
    return tuple((at, value) for at, value in rows)
