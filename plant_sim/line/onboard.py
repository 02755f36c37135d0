"""The train protection on board: its own axle sensor and balise reader, and the plant's view of its demands.

The protection sees nothing else of the train (:mod:`railhil.plant_sim.atp`). A protection that no longer works applies
the emergency brake: its demands must be fresh.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Final, Protocol

from railhil.plant_sim.ato.plant_readings import AxleSensors
from railhil.plant_sim.atp.protection import PERIOD_S, TrainProtection
from railhil.plant_sim.atp.readings import INTERVENTION, SELF_TEST, Authority, Demands, Readings, Track, TrainData
from railhil.scenarios import streams
from railhil.systems.ato.scenario.model import Balise, Line
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.protection import protection_balises

#: Demands may be this old.
FRESH_S: Final = 0.4
#: Reactions, from none to the emergency brake.
NO_REACTION, TRACTION_CUT, SERVICE_BRAKE, EMERGENCY_BRAKE = range(4)


class OwnAxle(Protocol):
    """The axle sensor of the train protection (:class:`AxleSensors`)."""

    def speed_01mmps(self, speed_mps: float, tick: int) -> int:
        """Reading of a true speed >= 0 at a tick, in 0.1 mm/s."""

    def odometer_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, to its resolution."""

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, interpolated between its counts as a balise reader does."""


class Onboard:
    """One train protection with its sensors; it is looked at every ``period_ticks``.

    :param scenario: as surveyed and planned, without perturbations.
    :param wheel_factor: share of the true distance that its own axle reads.
    :ivar is_dead: it no longer works (a fault).
    :ivar has_authority: it receives the movement authority (unless a fault prevents it).
    :ivar demands: its last ones, always the same object.
    :ivar reaction: the strongest of its demands.
    :ivar has_failed: the emergency brake acts because the demands were too old; it stays until the end of the run.
    """

    def __init__(self, scenario: LineScenario, seed: int, wheel_factor: float) -> None:
        train, tick_s = scenario.train, scenario.timing.base_tick_ns * 1e-9
        self.is_dead = False
        self.has_authority = True
        self.period_ticks = max(1, round(PERIOD_S / tick_s))
        self.reaction = NO_REACTION
        self.sensors: OwnAxle = AxleSensors(
            replace(scenario.sensors, wheel_factor=wheel_factor), seed, streams.PROTECTION_NOISE
        )
        own = [_own_balises(scenario, leg) for leg in range(len(scenario.legs))]
        self._legs = tuple(_track(leg, ahead) for leg, ahead in zip(scenario.legs, own, strict=True))
        #: Balises that only the protection sees, ahead of the train.
        self._own_of_legs, self._own = own, deque(own[scenario.stops[0].leg])
        data = TrainData(train.length_m, train.speed_limit_mps, train.gravity_mps2)
        self._protection = TrainProtection(scenario.atp, data, self._legs[scenario.stops[0].leg], 0.0)
        #: Reads one of them; a faulty reader may change it.
        self.read_own: Callable[[Balise], None] = self.pass_balise
        self.demands: Demands = self._protection.demands
        self.has_failed = False
        self._tick_s = tick_s
        self._fresh_ticks = round(FRESH_S / tick_s)
        self._fresh_tick = 0
        self._passed: list[tuple[int, float]] = []

    @property
    def status(self) -> int:
        """Its status as it is told; :data:`~railhil.plant_sim.atp.readings.INTERVENTION` if it has failed."""
        return INTERVENTION if self.has_failed else self.demands.status

    @property
    def cause(self) -> int:
        """The cause of its reaction as it is told; that of its own check if it has failed."""
        return SELF_TEST if self.has_failed else self.demands.cause

    def pass_balise(self, balise: Balise) -> None:
        """Read a balise."""
        self._passed.append((balise.number, self.sensors.odometer_between_mm(balise.true_m) / 1000))

    def enter(self, leg: int, position_m: float) -> None:
        """Another leg begins, at standstill. Run positions go on, so the protection keeps the place that it knows.

        :param position_m: true position, for its sensors.
        """
        place, odometer_m = self._protection.place, self._odometer_m(position_m)
        place.update(odometer_m)
        self._protection.enter(self._legs[leg], odometer_m, 0.5 * (place.least_m + place.most_m))
        self._own = deque(one for one in self._own_of_legs[leg] if one.true_m > position_m)

    def look(
        self, tick: int, position_m: float, speed_mps: float, authority: Authority, doors_locked: bool, held: bool
    ) -> bool:
        """Let it look at the readings of a tick, a multiple of ``period_ticks``.

        :param position_m: true position, for its sensors, like the speed.
        :returns: whether it reacts more strongly than before.
        """
        before = self.reaction
        while self._own and self._own[0].true_m <= position_m:
            self.read_own(self._own.popleft())
        if not self.is_dead:
            self._fresh_tick = tick
            demands = self._protection.step(
                Readings(
                    tick * self._tick_s,
                    self.sensors.speed_01mmps(speed_mps, tick) * 1e-4,
                    self._odometer_m(position_m),
                    tuple(self._passed),
                    authority if self.has_authority else None,
                    doors_locked,
                    held,
                )
            )
            self._passed.clear()
            self.reaction = EMERGENCY_BRAKE if self.has_failed else _reaction(demands)
        elif tick - self._fresh_tick > self._fresh_ticks:
            self.has_failed = self.has_failed or not self.demands.emergency_brake
            self.reaction = EMERGENCY_BRAKE
        return self.reaction > before

    def _odometer_m(self, position_m: float) -> float:
        return self.sensors.odometer_mm(position_m) / 1000


def _own_balises(scenario: LineScenario, leg: int) -> list[Balise]:
    """The balises of a leg that only the protection sees, in their order."""
    spacing_m, balises = scenario.atp.balise_spacing_m, scenario.legs[leg].balises
    found: list[Balise] = []
    for section in scenario.sections:
        if section.leg == leg:
            from_m, to_m = (scenario.stops[number].position_m for number in (section.departure, section.arrival))
            found += protection_balises(spacing_m, balises, from_m, to_m)
    return sorted(found, key=lambda one: one.true_m)


def _track(leg: Line, own: list[Balise]) -> Track:
    known = (*leg.balises, *own)
    return Track(leg.grade_permil, leg.speed_limit_mps, tuple((one.number, one.surveyed_m) for one in known))


def _reaction(demands: Demands) -> int:
    if demands.emergency_brake:
        return EMERGENCY_BRAKE
    if demands.service_brake:
        return SERVICE_BRAKE
    return TRACTION_CUT if demands.traction_cut else NO_REACTION
