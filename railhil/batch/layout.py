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


#: Rows of ``readings``.
READ_SPEED, READ_ODOMETER, READ_BALISES, READ_ENDED = range(4)


class PerTrain(NamedTuple):
    """Tables with one row for each train: mean grade, balises in the order of passing, delayed notches.

    ``error_sums_kmh`` (cycles, N) and ``control_accel_raw`` (N, control ticks; 0.1 mm/s2) are for the score. ``lanes``
    are the blocks, (blocks, :data:`railhil.batch.lanes.SIZE`). Trains are in the order of their lanes here;
    ``order`` (N,) is the place of each in the order of the seeds, which is that of ``readings`` (4, N), what the law
    reads at a poll: speed (0.1 mm/s), odometer (0.1 mm) and balises passed; and how the run has ended (0: it has not).
    """

    permil: Any
    permil_per_m: Any
    balise_m: Any
    staged_due: Any
    staged_code: Any
    error_sums_kmh: Any
    control_accel_raw: Any
    order: Any
    lanes: Any
    readings: Any


#: What each control period of each train needs lies together.
_HOT_FLOATS = ("wheel_factor", "noise_sigma_mps", "delay_ticks", "force_per_notch_n", "pole_per_s")
_HOT_INTS = (
    "ended",
    "staged_last",
    "staged_first",
    "staged_count",
    "acting_code",
    "grade_row",
)
_FIELDS = [(name, np.float64) for name in _HOT_FLOATS] + [(name, np.int64) for name in _HOT_INTS]
_FIELDS += [
    (name, np.float64)
    for name in (
        "mass_kg",
        "resistance_a_n",
        "resistance_b_n_per_mps",
        "resistance_c_n_per_mps2",
        "grade_n_per_permil",
        "lag_decay",
        "lag_mean",
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
        "level",
        "age_ticks",
        "good",
        "running_looks",
        "weak_looks",
        # Truth samples so far, and the position in the last of them.
        "samples",
        "true_position_01mm",
        # Events: -1 until they occur.
        "stop_tick",
        "stop_01ms",
        "stop_01mm",
        "emergency_01ms",
        "end_tick",
    )
]
#: Constants and state of one train: a record whose fields are attributes in the interpreter as well.
TRAIN = np.dtype((np.record, _FIELDS))
