"""The brakes of a train on a line: what holding brake, train protection and emergency brake add to those of ``ato``."""

from __future__ import annotations

from dataclasses import replace
from math import inf

from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato import dynamics, force_tables, forces
from railhil.plant_sim.ato.command_watch import watch_brake_mps2
from railhil.plant_sim.ato.dynamics import Window
from railhil.plant_sim.ato.forces import EffortLimit, TrainConstants
from railhil.plant_sim.ato.plant import PARKING_BRAKE_PERMIL
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.plant_sim.ato.train_checks import OwnChecks
from railhil.plant_sim.line.brakes import EmergencyForce, HoldingBrake
from railhil.plant_sim.line.doors import TrainDoors
from railhil.plant_sim.line.journey import Journey
from railhil.plant_sim.line.onboard import EMERGENCY_BRAKE, NO_REACTION, SERVICE_BRAKE, Onboard
from railhil.systems.line.scenario.dwell import draw_dwells
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.perturb import DrawnLine
from railhil.wire.ato import WatchLevel


@mypyc_attr(allow_interpreted_subclasses=True)
class BrakedTrain(TrainOnBus):
    """A train whose forces are also limited by its holding brake, train protection and emergency brake.

    :param scenario: as surveyed and planned.
    :param drawn: what the run has drawn of it.
    :ivar journey: where the train is in its timetable.
    :ivar doors: of the train and of the platform.
    :ivar holding: the holding brake.
    :ivar onboard: the train protection; None: the train has none.
    :ivar is_busy: it stands, or has doors that are not locked: the equipment of a stop needs every tick.
    """

    def __init__(self, scenario: LineScenario, drawn: DrawnLine, seed: int, rate: float) -> None:
        actual = drawn.scenario
        tick_s = actual.timing.base_tick_ns * 1e-9
        self.journey = Journey(actual, draw_dwells(actual, seed))
        self.doors = TrainDoors(actual.route.doors, tick_s)
        # The first balises are read before the train protection is switched on.
        self.onboard: Onboard | None = None
        self.is_busy = True
        #: A brake besides those of watch and actuator acts.
        self._is_braked = True
        super().__init__(actual, seed, False, rate)
        self._line = actual
        self._unloaded = self._train
        self.holding = HoldingBrake(self._parking_brake_n)
        if scenario.atp.enabled:
            self.onboard = Onboard(scenario, seed, drawn.atp_wheel_factor)
        self._protection_brake_mps2 = 0.0
        brake = scenario.emergency
        self._emergency = None if brake is None else EmergencyForce(brake, scenario.train.inertial_mass_kg, tick_s)

    @property
    def is_standing(self) -> bool:
        """Whether the train stands."""
        return self._motion.speed_mps <= 0.0

    def _load(self, factor: float) -> None:
        """Change the mass at a stop, to this share of that of the run."""
        bare = self._unloaded
        train = replace(bare, mass_kg=bare.mass_kg * factor, inertial_mass_kg=bare.inertial_mass_kg * factor)
        self._train = train
        self._constants = self._plain_constants = force_tables.train_constants(train)
        self._own_checks = OwnChecks(self._line, self._constants)
        self._parking_brake_n = train.mass_kg * train.gravity_mps2 * PARKING_BRAKE_PERMIL / 1000
        self.holding.force_n = self._parking_brake_n

    def _attend(self) -> None:
        """Find where the standing train is, and whether it is held over the coming tick."""
        raise NotImplementedError

    def _move_doors(self) -> None:
        """Move the doors over the coming tick."""
        raise NotImplementedError

    def _protect(self) -> None:
        """The forces that the train's watches, brakes and interlocks allow over the coming tick."""
        if is_busy := self.is_busy:
            self._attend()
        onboard = self.onboard
        if onboard is not None and self.tick % onboard.period_ticks == 0:
            self._look(onboard)
        before_n = self._window.brake_min_n
        super()._protect()
        if self._is_braked or self._window.brake_min_n == inf:
            self._brake(before_n)
        if is_busy:
            # At the end: what these doors become in the tick permits no force in it.
            self._move_doors()

    def _look(self, onboard: Onboard) -> None:
        """Let the train protection look; report a stronger reaction."""
        before, motion = onboard.reaction, self._motion
        authority = self.journey.authority(motion.position_m, self.tick, self.doors.psd.is_locked)
        locked = self.doors.are_locked
        held = self.holding.is_applied
        if onboard.look(self.tick, motion.position_m, motion.speed_mps, authority, locked, held):
            self._mark("atp")
            if onboard.reaction == EMERGENCY_BRAKE:
                self._mark("emergency")
        if onboard.reaction != before:
            # The service brake is released over some time, also when nothing demands it any more.
            self._is_braked = held or onboard.reaction > NO_REACTION or self._protection_brake_mps2 > 0.0

    def _brake(self, before_n: float) -> None:
        """Add holding brake, train protection and emergency brake to the forces that watch and interlocks allow.

        :param before_n: demand of the last tick; the service brake remains while the emergency brake builds up.
        """
        traction, brake_min_n = self._window
        reaction = NO_REACTION if self.onboard is None else self.onboard.reaction
        service_n = self._protection_brake_n(reaction)
        if brake_min_n == inf or reaction == EMERGENCY_BRAKE:
            brake_min_n = inf
            if self._emergency is not None:
                brake_min_n = max(before_n, self._emergency.step())
                self._constants = with_brake(self._plain_constants, brake_min_n, self._motion.speed_mps)
        traction = traction and reaction == NO_REACTION
        self._window = Window(traction, max(brake_min_n, service_n, self.holding.acting_n))
        if not traction and self._motion.actuator_n > 0.0:
            # The contactors are open, as in the plant of ato.
            self._motion = self._motion._replace(actuator_n=0.0)
        self._is_braked = self.holding.is_applied or reaction > NO_REACTION or service_n > 0.0

    def _protection_brake_n(self, reaction: int) -> float:
        """Service brake that the train protection demands: it builds up and is released like that of the watch."""
        if reaction < SERVICE_BRAKE and self._protection_brake_mps2 == 0.0:
            return 0.0
        level = WatchLevel.SERVICE_BRAKE if reaction >= SERVICE_BRAKE else WatchLevel.NORMAL
        mass_kg, train = self._constants.mass_kg, self._train
        braking_mps2 = max(0.0, -dynamics.applied_n(self._constants, self._window, self._motion) / mass_kg)
        self._protection_brake_mps2 = watch_brake_mps2(
            level, self._protection_brake_mps2, braking_mps2, not self.is_standing, self._step_s,
            train.service_braking_mps2,
        )  # fmt: skip
        return self._protection_brake_mps2 * mass_kg

    def _mark(self, kind: str, after_s: float = 0.0) -> None:
        """Note a milestone of the standing train, after the current tick."""
        self._event(kind, after_s, self._motion.position_m)


def with_brake(constants: TrainConstants, force_n: float, speed_mps: float) -> TrainConstants:
    """The constants of a train whose brake can have this force, too."""
    most_n = max(force_n, forces.effort_limit_n(constants.brake, speed_mps))
    return constants._replace(brake=EffortLimit(most_n, inf, (), ()))
