"""The train of the system ``line`` on the bus: a train of ``ato`` with doors, holding brake and timetable."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Mapping, Sequence
from typing import Final

from railhil.bus.acceptance import Acceptance
from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE, Telegram
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato import forces
from railhil.plant_sim.line.braked import BrakedTrain
from railhil.plant_sim.line.docking import DockingLoop
from railhil.plant_sim.line.doors import CLOSE, SIDES
from railhil.plant_sim.line.pass_mark import PassMark
from railhil.plant_sim.line.run_end import LineRunEnd
from railhil.plant_sim.line.telegrams import LineTelegrams
from railhil.systems.ato.scenario.model import Balise
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.perturb import draw_line
from railhil.wire.ato import CtlStat
from railhil.wire.line import AtoStat, DoorCmd

_NO_ORDER: Final = (0, 0)


@mypyc_attr(allow_interpreted_subclasses=True)
class LineTrain(BrakedTrain):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    :ivar docking: tells whether the train stands within the door window.
    :ivar stood_from_tick: of the present standstill.
    """

    statuses: Sequence[str] = (CtlStat.PORT, AtoStat.PORT)

    def __init__(self, scenario: LineScenario, seed: int, drawn: bool = False, rate: float = 0.0) -> None:
        drawn_line = draw_line(scenario, seed, drawn)
        actual = drawn_line.scenario
        tick_s = actual.timing.base_tick_ns * 1e-9
        self.docking = DockingLoop(actual.route.door_window_m, seed, tick_s)
        self.stood_from_tick = 0
        self._has_left = False
        super().__init__(scenario, drawn_line, seed, rate)
        self._section_masses = drawn_line.section_masses
        self._hold_commanded = True
        self._order = _NO_ORDER
        self._order_refused = self._departure_refused = False
        self._load(self._section_masses[0])
        self.doors.has_psd = self.journey.stop.psd
        self._balises = deque(sorted((*self._balises, *self.journey.passed_marks()), key=_place))
        self._line_telegrams = LineTelegrams(actual, self, rate)
        self._telegrams = self._line_telegrams
        self.makers = self._telegrams.makers
        self.ending = LineRunEnd(actual, self)
        self.commands = {**self.commands, DoorCmd.PORT: DoorCmd}
        self._door_counters: Counter[str] = Counter()
        self._door_gate = Acceptance(DoorCmd, self._door_counters)
        self._doors_accepted = 0

    # -- readings -----------------------------------------------------------------------------------------------------

    @property
    def station_here(self) -> int | None:
        """Number of the stop at which the train stands, from 0; None: under way, or creeping."""
        return self.journey.arrival if self.journey.has_arrived and self.is_standing else None

    @property
    def sides_permitted(self) -> int:
        """Sides on which the doors may open now, as bits."""
        return SIDES[self.journey.stop.platform] if self.docking.is_in_window and self.station_here is not None else 0

    @property
    def are_platforms_locked(self) -> bool:
        """Whether the doors of the platform where the train stands, and of those on its way, are closed and locked."""
        doors = self.doors
        if doors.psd.is_locked or doors.has_psd:
            return doors.is_psd_locked
        return not self.journey.awaits_platform(self._motion.position_m)

    @property
    def is_departure_permitted(self) -> bool:
        """Whether the track side permits the departure now."""
        return (
            self.is_standing and self.doors.is_psd_locked and self.journey.permits(self._motion.position_m, self.tick)
        )

    @property
    def refused(self) -> Mapping[str, int]:
        """Counters of the gate of NOTCH_CMD, and those of DOOR_CMD."""
        own = {f"door_{cause}": count for cause, count in self._door_counters.items()}
        return {**super().refused, **own}

    @property
    def judged(self) -> dict[str, tuple[int, Mapping[str, int]]]:
        """For each port with commands: the number accepted, and the counters of its check."""
        return {**super().judged, DoorCmd.PORT: (self._doors_accepted, self._door_counters)}

    # -- commands -----------------------------------------------------------------------------------------------------

    def take(self, telegram: Telegram) -> None:
        """Take a command, if its check accepts it."""
        if not isinstance(telegram, DoorCmd):
            super().take(telegram)
        elif self._door_gate.accept(telegram):
            self._doors_accepted += 1
            self._hold_commanded = telegram.hold_brake != FLAG_FALSE
            self._obey(telegram.order, telegram.station)
            if telegram.depart_ready == FLAG_TRUE:
                self._depart(telegram.station)
            else:
                self._departure_refused = False

    def _obey(self, order: int, station: int) -> None:
        """Carry out an order for the doors, or report once that it is refused."""
        if (order, station) != self._order:
            self._order, self._order_refused = (order, station), False
        if not order:
            return
        if order == CLOSE:
            self.doors.close()
        elif station and self.station_here == station - 1 and not order & ~self.sides_permitted:
            self.doors.open(order)
            self.is_busy = True
            self.show_doors()
        elif not self._order_refused:
            self._order_refused = True
            self._mark("door_refused")

    def _depart(self, station: int) -> None:
        """Begin the next section, or report once that the departure is refused."""
        journey, here = self.journey, self.station_here
        if here is None and journey.section >= 0 and station - 1 == self._left_stop:
            # The departure has been accepted; the order remains until the train moves.
            return
        if here is None or here != station - 1 or not self.doors.are_locked or not self.is_departure_permitted:
            if not self._departure_refused:
                self._departure_refused = True
                self._mark("door_refused")
            return
        if not journey.has_opened and journey.section >= 0:
            self._mark("missed")
        self._mark("departure")
        turned = journey.depart(self.tick)
        self.doors.has_psd = False
        if turned:
            self._mark("turn_back")
            self._turn_back()
        self._load(self._section_masses[journey.section])
        self._line_telegrams.begin_section()
        self.docking.leave()

    @property
    def _left_stop(self) -> int:
        return self._line.sections[self.journey.section].departure

    def _turn_back(self) -> None:
        """Take profiles and balises of the next leg; its balises under the standing train have been read."""
        leg = self._line.legs[self.journey.leg]
        self._enter(leg)
        if self.onboard is not None:
            self.onboard.enter(self.journey.leg, self._motion.position_m)
        self._balises = deque(sorted((*leg.balises, *self.journey.passed_marks()), key=_place))
        while self._balises and self._balises[0].true_m <= self._motion.position_m:
            self._pass_balise(self._balises.popleft(), 0.0)

    # -- time ---------------------------------------------------------------------------------------------------------

    def _attend(self) -> None:
        """Measure the place, and hold the train at a stop."""
        journey, doors, docking, motion = self.journey, self.doors, self.docking, self._motion
        standing = motion.speed_mps <= 0.0
        if standing and self.tick % docking.period_ticks == 0:
            if journey.has_arrived:
                docking.measure(motion.position_m - journey.stop.position_m, self.tick)
            else:
                # A standstill before the departure is one at the stop that it leaves.
                stood_ticks = self.tick - max(self.stood_from_tick, journey.departure_tick)
                if journey.stand_short(motion.position_m, self.tick, stood_ticks):
                    self._arrive()
        if standing and (self._hold_commanded or not doors.are_locked):
            self.holding.apply()
            self._is_braked = True
        elif self.holding.is_applied:
            grade_permil = forces.mean_grade_permil(self._grades, motion.position_m)
            against_n = forces.resistance_n(self._constants, 0.0, grade_permil)
            self.holding.follow(max(0.0, motion.actuator_n), against_n, not journey.has_arrived)
        self.is_busy = standing or bool(doors.opened) or self.holding.is_applied or not doors.are_locked

    def _move_doors(self) -> None:
        """Move doors that were ordered to open over the coming tick, and report at its end what they have become."""
        doors = self.doors
        if not doors.opened:
            return
        were_locked = doors.are_locked
        doors.step(not self.is_standing)
        if not self.journey.has_opened and doors.are_open:
            self.journey.open(self.tick + 1)
            self._mark("doors_open", self._step_s)
        if doors.are_locked != were_locked:
            self.show_doors()
        if doors.are_locked:
            doors.opened = 0
            self._mark("doors_locked", self._step_s)

    def show_doors(self) -> None:
        """Take the state of the doors into the interlock of traction."""
        self.status.doors_closed_locked = self.doors.are_locked
        self.is_busy = True

    def _start(self, after_s: float, position_m: float) -> None:
        """The first motion after a standstill: of the run, of a creep at a stop, or of a section."""
        if not self._has_left:
            self._has_left = True
            super()._start(after_s, position_m)
        elif self.journey.has_arrived:
            self._event("jog", after_s, position_m)
        self.docking.leave()

    def _stand(self, after_s: float, position_m: float) -> None:
        super()._stand(after_s, position_m)
        self._departed = False
        self._stood_m = position_m
        self.stood_from_tick = self.tick
        self.is_busy = True
        if self.journey.stand(position_m):
            self._arrive(after_s)

    def _arrive(self, after_s: float = 0.0) -> None:
        """Report the arrival at a stop; the doors of its platform now count."""
        self._mark("arrived", after_s)
        self.doors.has_psd = self.journey.stop.psd
        self.show_doors()

    def _pass_balise(self, balise: Balise, after_s: float) -> None:
        if isinstance(balise, PassMark):
            self.journey.pass_stop(balise.number)
            self._event("passed", after_s, balise.true_m)
        else:
            if self.onboard is not None:
                self.onboard.pass_balise(balise)
            super()._pass_balise(balise, after_s)


def _place(balise: Balise) -> tuple[float, int]:
    return balise.true_m, balise.number
