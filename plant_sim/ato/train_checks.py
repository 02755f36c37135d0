"""Checks of the train's own watch besides the commands: its forces, and the end of its authority.

==================== =========================================================== =======================================
check                found when                                                  limit of detection
==================== =========================================================== =======================================
runaway              without a traction notch, traction is left that is larger   traction up to that share
                     than the actuator's decay explains, by
                     ``traction_left_max`` of the largest, for 0.1 s
brake not answering  the deceleration is below ``brake_share_min`` of the        demands below ``grade_allowance`` over
                     demand, less ``grade_allowance``, for 1 s                   ``brake_share_min``
end of authority     the speed is above that from which the train stops before   off by default
                     its end with ``end_of_authority_braking``
==================== =========================================================== =======================================

The forces are checked every 50 ms. All three checks apply the emergency brake. Nothing here depends on the controller:
forces, speed and position are the train's own, and the notch is the acting one.

The batch compiles the marked functions (:mod:`railhil.common.compilable` lists the permitted language).
"""

from __future__ import annotations

from math import exp, inf
from typing import Final, NamedTuple

from railhil.common.compilable import compilable_functions
from railhil.common.floats import larger, smaller
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato.dynamics import Motion
from railhil.plant_sim.ato.forces import TrainConstants, effort_limit_n
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import WatchCause

#: Share of the actuator's pole that the checks assume.
SLOWEST: Final = 0.9
RUNNING_S: Final = 0.1
WEAK_S: Final = 1.0
#: Time between two checks of the forces.
LOOK_S: Final = 0.05
_LSB_PER_NOTCH: Final = 256


# Looking up a member of an enum costs as much as a call on CPython 3.11.
_NOTHING: Final = WatchCause.NONE


class TrainChecks(NamedTuple):
    """Limits of a scenario. ``end_m`` is infinite without an end of authority; the forces are checked every
    ``look_ticks``."""

    look_ticks: int
    end_m: float
    end_braking_mps2: float
    left_max_n: float
    running_looks: int
    share: float
    allowance_mps2: float
    weak_looks: int


class ForceState(NamedTuple):
    """Traction that may be left, and checks above it in a row; braking that the acting notch must have reached, and
    checks below it in a row."""

    left_n: float
    running_looks: int
    floor_n: float
    weak_looks: int


#: In traction, or at standstill: nothing is expected.
FREE_FORCES: Final = ForceState(inf, 0, 0.0, 0)


def train_checks(scenario: Scenario) -> TrainChecks:
    """The limits; perturbations do not change them."""
    watch, train, tick_s = scenario.watch, scenario.train, scenario.timing.base_tick_ns * 1e-9
    look_ticks = max(1, round(LOOK_S / tick_s))
    return TrainChecks(
        look_ticks,
        scenario.plan.distance_m + watch.end_of_authority_margin_m if watch.end_of_authority else inf,
        watch.end_of_authority_braking_mps2,
        train.traction.force_max_n * watch.traction_left_max_percent / 100,
        round(RUNNING_S / tick_s / look_ticks),
        watch.brake_share_min_percent / 100,
        train.gravity_mps2 * watch.grade_allowance_permil / 1000,
        round(WEAK_S / tick_s / look_ticks),
    )


def slow_decay(checks: TrainChecks, pole_per_s: float, tick_s: float) -> float:
    """Factor of a force from one check to the next, with the slowest actuator that is assumed."""
    return exp(-SLOWEST * pole_per_s * tick_s * checks.look_ticks)


def is_beyond_authority(checks: TrainChecks, position_m: float, speed_mps: float) -> bool:
    """True when the train is moving and can no longer stop before the end of its authority as planned."""
    return speed_mps > 0.0 and speed_mps * speed_mps > 2.0 * checks.end_braking_mps2 * larger(
        0.0, checks.end_m - position_m
    )


def forces_step(
    checks: TrainChecks,
    constants: TrainConstants,
    state: ForceState,
    decay: float,
    steady_n: float,
    actuator_n: float,
    brake_min_n: float,
    speed_mps: float,
    accel_mps2: float,
) -> ForceState:
    """State after a check of the forces of a moving train without a traction notch.

    :param decay: see :func:`slow_decay`.
    :param steady_n: force of the acting notch in the long run, at most 0.
    :param actuator_n: force of the actuator, traction positive.
    :param brake_min_n: demand of the watch itself; infinite: the full brake.
    """
    left_n, running, floor_n, weak = state
    left_n = smaller(left_n * decay, larger(actuator_n, 0.0))
    running = running + 1 if actuator_n > left_n + checks.left_max_n else 0
    floor_n = smaller(-steady_n, floor_n * decay - steady_n * (1.0 - decay))
    wanted_n = checks.share * larger(floor_n, brake_min_n)
    allowance_n = checks.allowance_mps2 * constants.mass_kg
    if wanted_n > allowance_n:
        most_n = checks.share * effort_limit_n(constants.brake, speed_mps)
        wanted_n = smaller(wanted_n, most_n)
    missing = wanted_n > allowance_n and -accel_mps2 * constants.mass_kg < wanted_n - allowance_n
    weak = weak + 1 if missing else 0
    return ForceState(left_n, running, floor_n, weak)


def is_running(checks: TrainChecks, state: ForceState) -> bool:
    """True when the train has traction that nobody demands."""
    return state.running_looks > checks.running_looks


def is_weak(checks: TrainChecks, state: ForceState) -> bool:
    """True when the brake does not answer."""
    return state.weak_looks > checks.weak_looks


@mypyc_attr(allow_interpreted_subclasses=True)
class OwnChecks:
    """The checks of one train, tick by tick.

    :param scenario: of the real train: its watch knows its actuator.
    """

    def __init__(self, scenario: Scenario, constants: TrainConstants) -> None:
        self._checks = train_checks(scenario)
        self._has_end = scenario.watch.end_of_authority
        self._constants = constants
        self._decay = slow_decay(self._checks, constants.pole_per_s, scenario.timing.base_tick_ns * 1e-9)
        #: Every tick is checked with an end of authority, else the ticks of the force checks.
        self.every_ticks = 1 if self._has_end else self._checks.look_ticks
        self._n_per_notch = scenario.train.force_per_notch_n
        self._forces = FREE_FORCES

    def finding(self, tick: int, acting_code: int, motion: Motion, brake_min_n: float) -> WatchCause:
        """The check that demands the emergency brake, NONE if none does.

        :param tick: a multiple of ``every_ticks``.
        :param acting_code: notch that acts on the actuator, 1/256.
        """
        checks = self._checks
        position_m, speed_mps, actuator_n, accel_mps2 = motion
        if tick % checks.look_ticks == 0:
            if acting_code > 0 or speed_mps <= 0.0:
                self._forces = FREE_FORCES
            else:
                self._forces = forces_step(
                    checks,
                    self._constants,
                    self._forces,
                    self._decay,
                    acting_code * self._n_per_notch / _LSB_PER_NOTCH,
                    actuator_n,
                    brake_min_n,
                    speed_mps,
                    accel_mps2,
                )
                if is_running(checks, self._forces):
                    return WatchCause.RUNAWAY
                if is_weak(checks, self._forces):
                    return WatchCause.BRAKE_NOT_ANSWERING
        if self._has_end and is_beyond_authority(checks, position_m, speed_mps):
            return WatchCause.END_OF_AUTHORITY
        return _NOTHING


compilable_functions(is_beyond_authority, is_running, is_weak, forces_step)
