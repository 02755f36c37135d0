"""Trains side by side: the state of a block of trains as one array for each quantity, so that the processor computes
several trains with one instruction.

A train lies in a lane while its run is steady: it moves, no brake of its watch is on, and it stays inside one row of
each of its tables. Whatever else happens is computed on its record (:data:`railhil.batch.layout.TRAIN`), as in the
bench; a lane is loaded from the record and stored there. Before a control period, a train of which nothing else can
happen in it is calm (:mod:`railhil.batch.calm`): it stays in its lane from one period to the next. All numbers of a
block are in one array, a quantity at its offset.
"""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import Any

from railhil.batch import compiled
from railhil.common.compilable import smaller
from railhil.plant_sim.command_watch import GOOD_AFTER_SERVICE_BRAKE, CommandWatchLevel
from railhil.plant_sim.plant import NOTCH_LSB_PER_NOTCH

#: Trains in a block.
LANES = 64

(
    POSITION,
    SPEED,
    ACTUATOR,
    ACCEL,
    MASS,
    RESISTANCE_A,
    RESISTANCE_B,
    RESISTANCE_C,
    GRADE_N,
    DECAY,
    MEAN,
    STEADY,
    # Row of the grade table: from and to which position, grade at its start, its slope.
    GRADE_FROM,
    GRADE_TO,
    PERMIL,
    PERMIL_PER_M,
    # Rows of the effort curves, traction and brake: from and to which speed; start, width, force, rise of the force.
    TRACTION_FROM,
    TRACTION_TO,
    TRACTION_START,
    TRACTION_WIDTH,
    TRACTION_N,
    TRACTION_RISE,
    BRAKE_FROM,
    BRAKE_TO,
    BRAKE_START,
    BRAKE_WIDTH,
    BRAKE_N,
    BRAKE_RISE,
    # Speed of the emergency brake, where the limit changes, tick of the next notch.
    TRIP,
    LIMIT_TO,
    DUE,
    # The watch's look at the forces.
    SLOW_DECAY,
    LEFT,
    RUNNING,
    FLOOR,
    WEAK,
    # Sums of the score.
    TRACTION_J,
    BRAKE_J,
    TRACTION_W,
    BRAKE_W,
    OVERSPEED,
    TRUE_POSITION,
    # Wanted speed and its error, limit of the line, acceleration at a control tick.
    WANTED,
    ERROR,
    ALLOWED,
    NOW,
    # 1 while the train is in its lane; 1 if its look, its step, its sample has to be computed on the record.
    STEADY_RUN,
    LOOK_LEFT,
    STEP_LEFT,
    SAMPLE_LEFT,
    # First tick in the lane.
    SINCE,
    # 1 while a calm train stays in its lane from period to period; steepest mean grade of its line, and the farthest
    # it goes in a tick.
    CALM,
    STEEPEST,
    REACH,
    # Tick in which the next notch begins to act, -1: in none of the period; its steady force. Duration, decay and mean
    # of the tick's parts before and after; 0 s: there is no such part.
    SPLIT,
    NEXT_STEADY,
    FIRST_S,
    FIRST_DECAY,
    FIRST_MEAN,
    SECOND_S,
    SECOND_DECAY,
    SECOND_MEAN,
    # Sum of the speed errors of the cycle; tick from which a train that is not calm is computed.
    SUM_KMH,
    JOINS,
    # Position that the odometer shows; wheel, noise of the speed sensor, and both readings.
    SHOWN,
    WHEEL,
    NOISE_MPS,
    SPEED_READ,
    ODOMETER_READ,
) = (number * LANES for number in range(69))
#: Size of the array.
SIZE = 69 * LANES

_NORMAL = int(CommandWatchLevel.NORMAL)


@compiled.aside
def _load_effort(s: Any, lane: int, at: int, table: Any, speed_mps: float) -> None:
    """The row of an effort curve around a speed; ``at``: the first of the six quantities."""
    speeds, forces = table.curve_mps, table.curve_n
    count = len(speeds)
    row = bisect_right(speeds, speed_mps)
    s[at + lane] = speeds[row - 1] if row > 0 else -inf
    s[at + LANES + lane] = speeds[row] if row < count else inf
    # A constant is a row without a rise.
    s[at + 2 * LANES + lane], s[at + 3 * LANES + lane] = 0.0, 1.0
    s[at + 4 * LANES + lane], s[at + 5 * LANES + lane] = 0.0, 0.0
    if count > 0:
        if row == 0:
            s[at + 4 * LANES + lane] = forces[0]
        elif row == count:
            s[at + 4 * LANES + lane] = forces[count - 1]
        else:
            s[at + 2 * LANES + lane] = speeds[row - 1]
            s[at + 3 * LANES + lane] = speeds[row] - speeds[row - 1]
            s[at + 4 * LANES + lane] = forces[row - 1]
            s[at + 5 * LANES + lane] = forces[row] - forces[row - 1]


@compiled.aside
def load(common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, tick: int) -> None:
    """Load a train whose run is steady into a lane, for ``tick`` and later ones; another one stays on its record."""
    s[STEADY_RUN + lane] = 0.0
    if (
        train.ended != 0
        or train.level != _NORMAL
        or train.watch_brake_mps2 != 0.0
        or train.traction == 0
        or train.brake_min_n != 0.0
        or train.speed_mps <= 0.0
        or train.stop_tick >= 0
        or train.position_m >= train.limit_to_m
        or tick > common.last_tick
        or common.notch_ticks > common.limits.hold
        or train.age_ticks >= common.limits.hold
    ):
        return
    from_m, row = common.grade_from_m, train.grade_row
    while row + 1 < from_m.size and from_m[row + 1] <= train.position_m:
        row += 1
    train.grade_row = row
    if train.position_m < from_m[row]:
        return
    s[GRADE_FROM + lane] = from_m[row]
    s[GRADE_TO + lane] = from_m[row + 1] if row + 1 < from_m.size else inf
    s[PERMIL + lane], s[PERMIL_PER_M + lane] = tables.permil[index, row], tables.permil_per_m[index, row]
    s[POSITION + lane], s[SPEED + lane] = train.position_m, train.speed_mps
    s[ACTUATOR + lane], s[ACCEL + lane] = train.actuator_n, train.accel_mps2
    s[MASS + lane], s[GRADE_N + lane] = train.mass_kg, train.grade_n_per_permil
    s[RESISTANCE_A + lane], s[RESISTANCE_B + lane] = train.resistance_a_n, train.resistance_b_n_per_mps
    s[RESISTANCE_C + lane] = train.resistance_c_n_per_mps2
    s[DECAY + lane], s[MEAN + lane] = train.lag_decay, train.lag_mean
    s[STEADY + lane] = train.acting_code * train.force_per_notch_n / NOTCH_LSB_PER_NOTCH
    _load_effort(s, lane, TRACTION_FROM, common.traction, train.speed_mps)
    _load_effort(s, lane, BRAKE_FROM, common.brake, train.speed_mps)
    s[TRIP + lane] = train.limit_mps + common.overspeed_margin_mps
    s[LIMIT_TO + lane] = train.limit_to_m
    s[DUE + lane] = tables.staged_due[index, train.staged_first] if train.staged_count > 0 else inf
    s[SLOW_DECAY + lane], s[LEFT + lane], s[FLOOR + lane] = train.slow_decay, train.left_n, train.floor_n
    s[RUNNING + lane], s[WEAK + lane] = train.running_looks, train.weak_looks
    s[TRACTION_J + lane], s[BRAKE_J + lane] = train.traction_j, train.brake_j
    s[TRACTION_W + lane], s[BRAKE_W + lane] = train.traction_w, train.brake_w
    s[OVERSPEED + lane], s[TRUE_POSITION + lane] = train.overspeed_mps, train.true_position_01mm
    s[SINCE + lane] = tick
    # None is known yet.
    s[FIRST_S + lane] = s[SECOND_S + lane] = -1.0
    s[STEADY_RUN + lane] = 1.0


@compiled.aside
def store(truth_ticks: int, notch_ticks: int, train: Any, s: Any, lane: int, tick: int) -> None:
    """Store a train from its lane to its record, before ``tick``.

    :param truth_ticks: between two SIM_TRUTH; ``notch_ticks``: between two polls of the notch.
    """
    train.position_m, train.speed_mps = s[POSITION + lane], s[SPEED + lane]
    train.actuator_n, train.accel_mps2 = s[ACTUATOR + lane], s[ACCEL + lane]
    train.left_n, train.floor_n = s[LEFT + lane], s[FLOOR + lane]
    train.running_looks, train.weak_looks = int(s[RUNNING + lane]), int(s[WEAK + lane])
    train.traction_j, train.brake_j = s[TRACTION_J + lane], s[BRAKE_J + lane]
    train.traction_w, train.brake_w = s[TRACTION_W + lane], s[BRAKE_W + lane]
    train.overspeed_mps, train.true_position_01mm = s[OVERSPEED + lane], int(s[TRUE_POSITION + lane])
    train.samples = tick // truth_ticks + 1
    # The watch in these ticks: each poll brings a good command.
    since = int(s[SINCE + lane])
    polls = (tick - 1) // notch_ticks - (since - 1) // notch_ticks
    train.age_ticks = (tick - 1) % notch_ticks if polls > 0 else train.age_ticks + tick - since
    train.good = smaller(train.good + polls, GOOD_AFTER_SERVICE_BRAKE)
    s[STEADY_RUN + lane] = 0.0
