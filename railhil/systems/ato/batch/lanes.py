"""The numbers of a block of trains in one array: a quantity at its offset, a train in its lane, so that the processor
computes several trains with one instruction.

All numbers are floats; whole ones are exact.
"""

from __future__ import annotations

#: Trains in a block.
LANES = 64

(
    # Constants of a train, and factors of its actuator over a whole tick and from one check of its forces to the next.
    MASS,
    RESISTANCE_A,
    RESISTANCE_B,
    RESISTANCE_C,
    GRADE_N,
    POLE,
    LAG_DECAY,
    LAG_MEAN,
    SLOW_DECAY,
    FORCE_PER_NOTCH,
    WHEEL,
    NOISE,
    DELAY_TICKS,
    # Motion, as in ``dynamics.Motion``.
    POSITION,
    SPEED,
    ACTUATOR,
    ACCEL,
    # The notch: force in the long run, code that acts, last code that was sent, queue of the delayed ones, and
    # the instant in ticks at which the next of them begins to act; infinite: there is none.
    STEADY,
    ACTING,
    LAST_CODE,
    STAGED_FIRST,
    STAGED_COUNT,
    DUE,
    # The train's watch: ``CommandWatchState``, ``Window``, its demand, ``ForceState``, the limit and where it ends.
    LEVEL,
    AGE,
    GOOD,
    TRACTION,
    BRAKE_MIN,
    WATCH_BRAKE,
    LEFT,
    RUNNING,
    FLOOR,
    WEAK,
    LIMIT,
    LIMIT_TO,
    # Events: -1 until they occur. ``ENDED``: how the run has ended, 0 while it continues.
    LEG_FROM,
    STOP_TICK,
    STOP_01MS,
    STOP_01MM,
    EMERGENCY_01MS,
    ENDED,
    END_TICK,
    # Sums of the score up to the last SIM_TRUTH, its number plus 1, its position and powers, its speed error.
    SAMPLES,
    TRUE_POSITION,
    TRACTION_J,
    BRAKE_J,
    TRACTION_W,
    BRAKE_W,
    OVERSPEED,
    WANTED,
    ERROR,
    # Position that the odometer shows.
    SHOWN,
    # 1 while the train has no other events than motion; 1 if a tick or a check has to be computed by the whole
    # functions.
    ORDINARY,
    TICK_LEFT,
    LOOK_LEFT,
    # Rows of the tables in which the train is, and their ends. Grades, effort curves, limit of the score.
    SPEED_FROM,
    SPEED_TO,
    PLACE_TO,
    GRADE_ROW,
    GRADE_FROM,
    PERMIL,
    PERMIL_PER_M,
    TRACTION_FROM,
    TRACTION_TO,
    TRACTION_FIRST,
    TRACTION_LAST,
    BRAKE_FROM,
    BRAKE_TO,
    BRAKE_FIRST,
    BRAKE_LAST,
    ALLOWED,
    # ``dynamics.Lag`` of the part of a tick that is computed, and of both parts of a tick in which a notch begins to
    # act, the second also in ticks; 0 s: there is no such part.
    PART_S,
    PART_DECAY,
    PART_MEAN,
    FIRST_S,
    FIRST_DECAY,
    FIRST_MEAN,
    SECOND_S,
    SECOND_DECAY,
    SECOND_MEAN,
    SECOND_TICKS,
    # Acceleration at a control tick. In the first lane the age of the last command, which all trains have in common.
    NOW,
    BLOCK_AGE,
) = (number * LANES for number in range(83))
#: Size of the array.
SIZE = 83 * LANES
