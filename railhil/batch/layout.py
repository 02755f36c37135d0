"""Data of the compiled loop: the constants common to all trains of a batch, and one record for each train."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Common(NamedTuple):
    """Constants not affected by perturbations; ticks are base ticks, tables are arrays.

    ``traction`` and ``brake`` are effort tables, ``limits`` and ``checks`` the watch's. ``front_limit_from_m`` and
    ``front_limit_mps`` are the limit used by the train's watch, ``line_limits`` (rows, 2) that of the score. For each
    truth sample: ``truth_s`` its time, ``wanted_mps`` the set-point by time, ``cycle`` the column of the ITAE sums (-1:
    none), ``control_sample`` the column of the kept accelerations (-1: none).
    """

    step_s: float
    truth_ticks: int
    position_ticks: int
    notch_ticks: int
    last_tick: int
    after_stop_ticks: int
    notch_max_code: int
    traction: Any
    brake: Any
    limits: Any
    checks: Any
    grade_from_m: Any
    front_limit_from_m: Any
    front_limit_mps: Any
    overspeed_margin_mps: float
    service_mps2: float
    speed_lsb_mps: float
    odometer_lsb_m: float
    line_limits: Any
    length_m: float
    by_distance: bool
    truth_s: Any
    wanted_mps: Any
    cycle: Any
    control_sample: Any
    target: Any


class PerTrain(NamedTuple):
    """Tables with one row for each train: mean grade, balises in the order of passing, delayed notches.

    ``error_sums_kmh`` (cycles, N) and ``control_accel_raw`` (N, control ticks; 0.1 mm/s2) are for the score. ``lanes``
    is the working space of the block in progress.
    """

    permil: Any
    permil_per_m: Any
    balise_m: Any
    staged_due: Any
    staged_code: Any
    error_sums_kmh: Any
    control_accel_raw: Any
    lanes: Any


_FIELDS = [
    (name, np.float64)
    for name in (
        "mass_kg",
        "resistance_a_n",
        "resistance_b_n_per_mps",
        "resistance_c_n_per_mps2",
        "grade_n_per_permil",
        "pole_per_s",
        "lag_decay",
        "lag_mean",
        "force_per_notch_n",
        "wheel_factor",
        "noise_sigma_mps",
        "delay_ticks",
        # Motion, and the forces allowed by the train's protection.
        "position_m",
        "speed_mps",
        "actuator_n",
        "accel_mps2",
        "brake_min_n",
        "slow_decay",
        "left_n",
        "floor_n",
        "watch_brake_mps2",
        "limit_mps",
        "limit_to_m",
        "leg_from_m",
        # Sums for the score.
        "traction_j",
        "brake_j",
        "traction_w",
        "brake_w",
        "overspeed_mps",
    )
] + [
    (name, np.int64)
    for name in (
        "traction",
        "grade_row",
        "level",
        "age_ticks",
        "good",
        "running_looks",
        "weak_looks",
        "staged_last",
        "acting_code",
        "staged_first",
        "staged_count",
        # Balises passed, readings.
        "passed",
        "speed_01mmps",
        "odometer_01mm",
        # Truth samples so far, and the position in the last of them.
        "samples",
        "true_position_01mm",
        # Events: -1 until they occur.
        "stop_tick",
        "stop_01ms",
        "stop_01mm",
        "emergency_01ms",
        "ended",
        "end_tick",
    )
]
#: Constants and state of one train: a record whose fields are attributes in the interpreter as well.
TRAIN = np.dtype((np.record, _FIELDS))
