"""Data of the compiled loop: the constants common to all trains of a batch, and tables with a row for each train."""

from __future__ import annotations

from typing import Any, NamedTuple


class Common(NamedTuple):
    """Constants not affected by perturbations; ticks are base ticks, tables are arrays.

    ``traction`` and ``brake`` are effort tables, ``limits`` and ``checks`` the watch's. ``front_limit_from_m`` and
    ``front_limit_mps`` are the limit used by the train's watch, ``line_limits`` (rows, 2) that of the score. For each
    truth sample: ``truth_s`` its time, ``wanted_mps`` the set-point by time, ``cycle`` the column of the ITAE sums (-1:
    none), ``control_sample`` the column of the kept accelerations (-1: none). ``side_by_side``: False computes each
    train by itself, with the same results.
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
    side_by_side: bool


#: Rows of ``readings``.
READ_SPEED, READ_ODOMETER, READ_BALISES, READ_ENDED = range(4)


class PerTrain(NamedTuple):
    """Tables with one row for each train: mean grade, balises in the order of passing, delayed notches.

    ``error_sums_kmh`` (cycles, N) and ``control_accel_raw`` (N, control ticks; 0.1 mm/s2) are for the score. ``blocks``
    are the numbers of the trains, (blocks, :data:`.lanes.SIZE`). Trains are in the order of their lanes;
    ``order`` (N,) is the place of each in the order of the seeds. ``readings`` (4, N) is in the same order: the law's
    readings at a poll, speed (0.1 mm/s), odometer (0.1 mm) and balises passed; and how the run has ended (0: it has
    not).
    """

    permil: Any
    permil_per_m: Any
    balise_m: Any
    staged_due: Any
    staged_code: Any
    error_sums_kmh: Any
    control_accel_raw: Any
    order: Any
    blocks: Any
    readings: Any
