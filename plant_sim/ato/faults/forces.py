"""The forces of a train with faults of its two sides (traction, service brake) and of the rail that carries them.

Low adhesion limits the force that the rail can carry. An axle slips or slides when more is demanded.

The train is one equivalent axle that carries the whole weight ``m g``, is driven and braked, and is the one whose
speed is measured. With the coefficient of adhesion ``mu``, the force ``F`` demanded of the axle, its speed ``w`` at the
wheel's rim, the train's speed ``v``, and the rotating mass ``J`` (inertial mass minus mass)::

    force on the train   = F                                 |F| <= mu m g, and w = v
                         = mu m g sign(w - v)                otherwise
    J d(w - v)/dt        = F - mu m g sign(w - v)            w >= 0: a locked wheel stands

``sign(w - v)`` equals the sign of ``F`` when a slide begins. The axle rolls again when ``w`` reaches ``v``. This is
Coulomb's friction and Newton's law for the rotating mass, a model of our own: no creep curve, no slip or slide
protection, one coefficient whatever the speed. The train's acceleration keeps the full inertial mass while the axle
slips. When the adhesion is good again, the axle rolls at once.
"""

from __future__ import annotations

from dataclasses import replace
from math import copysign, inf
from typing import NamedTuple

from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.dynamics import Lag, Motion, Window
from railhil.plant_sim.ato.faults.equipment import Side, cap_limit, share_limit
from railhil.plant_sim.ato.forces import TrainConstants, effort_limit_n
from railhil.plant_sim.ato.plant import NOTCH_LSB_PER_NOTCH
from railhil.plant_sim.ato.train_checks import OwnChecks
from railhil.plant_sim.faults.injections import Injections
from railhil.systems.ato.scenario.model import Scenario, Train
from railhil.wire.ato import WatchCause

#: Rotating mass as a share of the mass, for a train whose data has less.
_ROTATING_MIN = 0.01


class AxleSlip:
    """The difference between the axle and the train: ``slip_mps`` = w - v, ``slip_m`` its integral over time."""

    def __init__(self) -> None:
        self.slip_mps = 0.0
        self.slip_m = 0.0

    def step(
        self, demand_n: float, carried_n: float, speed_mps: float, mass_kg: float, inertial_kg: float, step_s: float
    ) -> None:
        """One step of the axle.

        :param demand_n: force demanded of the axle, traction positive.
        :param carried_n: largest force that the rail carries; infinite: good adhesion.
        :param speed_mps: of the train.
        """
        before = self.slip_mps
        if before == 0.0 and abs(demand_n) <= carried_n:
            return
        if carried_n == float("inf"):
            self.slip_mps = 0.0
            return
        rotating_kg = max(inertial_kg - mass_kg, _ROTATING_MIN * mass_kg)
        rate_mps2 = (demand_n - copysign(carried_n, before or demand_n)) / rotating_kg
        after = max(before + rate_mps2 * step_s, -speed_mps)
        if before * after < 0.0:
            after = 0.0
        self.slip_mps = after
        self.slip_m += (before + after) / 2 * step_s


class Allowed(NamedTuple):
    """Forces of one tick: constants and window for the dynamics, and the force that no command explains, traction
    positive.

    The constants already contain that force as a negative resistance: it adds to the others, and as a brake it holds
    the train but never moves it.
    """

    constants: TrainConstants
    window: Window
    extra_n: float


class Demand(NamedTuple):
    """Demands of one tick: notch code of the plant, speed, whether the train is powered and whether the emergency brake
    is applied."""

    code: int
    speed_mps: float
    powered: bool
    emergency: bool


class FaultyForces:
    """The forces under faults of the actuators and of the adhesion, tick by tick."""

    def __init__(self, injections: Injections, step_s: float) -> None:
        self.traction = Side(injections.at("actuator", "traction"), 1, step_s)
        self.brake = Side(injections.at("actuator", "brake"), -1, step_s)
        self.axle = AxleSlip()
        self._injections = injections
        injections.attach(self._take)
        self._step_s = step_s
        #: Traction that no notch commands, and braking force that the watch demanded of a healthy brake.
        self.runaway_n = 0.0
        self.demanded_n = 0.0
        # Largest force that the rail carries.
        self._carried_n = inf

    def _take(self) -> None:
        injections = self._injections
        self.traction.take(injections.at("actuator", "traction"))
        self.brake.take(injections.at("actuator", "brake"))
        self._adhesion = injections.at("train", "adhesion")

    def change(self, train: Train, motion: Motion, force_n: float) -> Motion:
        """Take the faults that have begun or ended, for the motion from here on.

        The present force follows a change of its side at once. After a loss it builds up from zero.

        :param train: as it is, with its mass.
        :param force_n: force on the train at this instant, traction positive.
        """
        self._train = train
        before = self.traction.state.share, self.brake.state.share
        self.traction.change(max(0.0, force_n))
        self.brake.change(max(0.0, -force_n))
        #: Train and factors of a full tick when traction acts, and when the brake does.
        self._by_side = self._as_moved_by(self.traction), self._as_moved_by(self.brake)
        carried = [one.fault.parameter("coefficient") for one in self._adhesion if one.active]
        self._carried_n = min(carried, default=inf) * train.mass_kg * train.gravity_mps2
        actuator_n = motion.actuator_n
        side, share_before = (self.traction, before[0]) if actuator_n > 0.0 else (self.brake, before[1])
        if side.state.instead is not None:
            return motion._replace(actuator_n=0.0)
        if side.state.share != share_before:
            factor = side.state.share / share_before if share_before > 0.0 else 0.0
            return motion._replace(actuator_n=actuator_n * factor)
        return motion

    def _as_moved_by(self, side: Side) -> tuple[Train, Lag]:
        train, share, pole = self._train, side.state.share, side.pole
        if share != 1.0 or pole != 1.0:
            train = replace(
                train,
                force_per_notch_n=train.force_per_notch_n * share,
                actuator_pole_per_s=train.actuator_pole_per_s * pole,
            )
        return train, dynamics.lag(train.actuator_pole_per_s, self._step_s)

    def acting(self, code: int) -> int:
        """Notch code that acts on the actuators when the plant's code is ``code``."""
        return self.traction.acting(code) + self.brake.acting(code)

    def mover(self, acting_code: int, actuator_n: float) -> tuple[Train, Lag]:
        """The train as the side that acts moves it, and the factors of a full tick."""
        return self._by_side[acting_code < 0 or (acting_code == 0 and actuator_n < 0.0)]

    def allowed(self, healthy: TrainConstants, window: Window, demand: Demand) -> Allowed:
        """The forces of the coming tick.

        :param healthy: constants without these faults.
        :param window: forces that watch and interlocks allow.
        """
        constants, extra_n = healthy, 0.0
        self.runaway_n, self.demanded_n = 0.0, window.brake_min_n
        pull, push = self.traction.state, self.brake.state
        if not demand.emergency and (pull.share != 1.0 or push.share != 1.0):
            traction, brake = share_limit(constants.traction, pull.share), share_limit(constants.brake, push.share)
            constants = constants._replace(traction=traction, brake=brake)
        # At EMERGENCY the main breaker opens, and the brake no longer depends on its actuator.
        for side, state, acts in (
            (self.traction, pull, demand.powered and not demand.emergency),
            (self.brake, push, not demand.emergency),
        ):
            if not side.faults:
                continue
            limit = constants.traction if side is self.traction else constants.brake
            instead_n = None
            if state.instead is not None and acts:
                instead_n = min(state.instead, effort_limit_n(limit, demand.speed_mps))
                if side is self.traction:
                    self.runaway_n = instead_n
                extra_n += instead_n if side is self.traction else -instead_n
            side.note(self._injections, acts, demand.code, self._commanded_n(side, demand, window), instead_n)
        if pull.instead is not None:
            constants = constants._replace(traction=cap_limit(constants.traction, 0.0))
        if push.instead is not None and not demand.emergency:
            constants = constants._replace(brake=cap_limit(constants.brake, 0.0))
        if push.share != 1.0 and not demand.emergency:
            window = window._replace(brake_min_n=window.brake_min_n * push.share)
        self._uncarried = Allowed(constants, window, extra_n)
        return self._carried(constants, window, extra_n)

    def _carried(self, constants: TrainConstants, window: Window, extra_n: float) -> Allowed:
        """These forces if the rail carries them; while the axle slips or slides, its friction in their place."""
        carried_n = self._carried_n
        if carried_n < inf and self.axle.slip_mps != 0.0:
            extra_n = copysign(carried_n, self.axle.slip_mps)
            traction, brake = cap_limit(constants.traction, 0.0), cap_limit(constants.brake, 0.0)
            constants = constants._replace(traction=traction, brake=brake)
        elif carried_n < inf:
            extra_n = min(max(extra_n, -carried_n), carried_n)
            constants = constants._replace(
                traction=cap_limit(constants.traction, carried_n - extra_n),
                brake=cap_limit(constants.brake, carried_n + extra_n),
            )
        if extra_n != 0.0:
            constants = constants._replace(resistance_a_n=constants.resistance_a_n - extra_n)
        return Allowed(constants, window, extra_n)

    def _commanded_n(self, side: Side, demand: Demand, window: Window) -> float:
        """Force that notch and watch demand of a healthy side in the end, >= 0."""
        notch_n = abs(side.part(demand.code)) * self._train.force_per_notch_n / NOTCH_LSB_PER_NOTCH
        if side is self.brake:
            return max(notch_n, window.brake_min_n)
        return notch_n if window.traction and window.brake_min_n == 0.0 else 0.0

    def moved(self, motion: Motion, code: int) -> None:
        """End a tick: note the notch for dead times, move a slipping or sliding axle.

        :param code: notch code of the plant.
        """
        self.traction.remember(code)
        self.brake.remember(code)
        if self._carried_n == inf and self.axle.slip_mps == 0.0:
            return
        constants, window, extra_n = self._uncarried
        at_axle = motion._replace(speed_mps=max(0.0, motion.speed_mps + self.axle.slip_mps))
        demand_n = dynamics.applied_n(constants, window, at_axle) + extra_n
        for one in self._adhesion:
            acts = one.active and abs(demand_n) > self._carried_n
            self._injections.effect(one, acts, f"{demand_n:.0f} N", f"{self._carried_n:.0f} N")
        train = self._train
        self.axle.step(demand_n, self._carried_n, motion.speed_mps, train.mass_kg, train.inertial_mass_kg, self._step_s)


class FeltChecks(OwnChecks):
    """Inputs of the train's own checks: the actual force of the drive, and the demand on the brake."""

    def __init__(self, scenario: Scenario, constants: TrainConstants, forces: FaultyForces) -> None:
        super().__init__(scenario, constants)
        self._felt = forces

    def finding(self, tick: int, acting_code: int, motion: Motion, brake_min_n: float) -> WatchCause:
        """See :meth:`railhil.plant_sim.ato.train_checks.OwnChecks.finding`."""
        if self._felt.runaway_n > 0.0:
            motion = motion._replace(actuator_n=max(0.0, motion.actuator_n) + self._felt.runaway_n)
        return super().finding(tick, acting_code, motion, max(brake_min_n, self._felt.demanded_n))
