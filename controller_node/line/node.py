"""The controller of the system ``line`` on the bus: clock, watches, odometer and mailboxes over the whole run, a
station automaton, and a law for each section."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Final

from railhil.bus.layout import Telegram, flag
from railhil.bus.responder import Reading
from railhil.controller_node.ato.controller import ControlOutput
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.line.heed import PermittedSpeed
from railhil.controller_node.line.jog import STEP_MS, Creep, CreepLimits
from railhil.controller_node.line.place import Place
from railhil.controller_node.line.rules import StationRules
from railhil.controller_node.line.sections import Aim, SectionControllers
from railhil.controller_node.line.stations import Drive, Situation, Stations
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.line.scenario.model import LineScenario, Mode
from railhil.wire.ato import WatchLevel
from railhil.wire.line import AtoProfile, AtoStat, AtoState, AtpLim, DoorCmd, DoorStat, ModeOrder, StnInfo

#: Ports with mailboxes besides those of ``ato``. ATP_STAT is not among them: all 32 mailboxes are taken.
MAILBOXES: Final = (DoorStat, StnInfo, AtpLim)
ANSWERS: Final = (DoorCmd, AtoStat)
#: Code of a running time's origin, by its name.
_PROFILES: Final = {one.name.lower(): one for one in AtoProfile}
#: Orders of the track side, by their code.
_MODES: Final[Mapping[int, Mode]] = {
    ModeOrder.TIMETABLE: "timetable",
    ModeOrder.FAST: "fast",
    ModeOrder.NORMAL: "normal",
    ModeOrder.ECONOMY: "economy",
}
_NS_PER_MS: Final = 1_000_000
_UINT16_MAX: Final = 0xFFFF
#: Largest distance in ATO_STAT, cm.
_LEFT_MAX_CM: Final = (1 << 23) - 1
_NOT_CHOSEN: Final = Aim("timetable", 0.0)
_NORMAL: Final = WatchLevel.NORMAL
_LAW: Final = Drive.LAW


class LineNode(ControllerNode):
    """A station automaton over a law for each section.

    At a stop the law is not stepped, the notch is 0 and the holding brake is ordered. All controllers of the timetable
    are made here, before the run begins.

    :param controller: computes the notch of every section instead of the law; None: the law.
    """

    computes: ClassVar[type[Any]] = SectionControllers

    def __init__(
        self,
        scenario: LineScenario,
        law: LawSpec,
        controller: Any = None,
        *,
        fd: bool = False,
        bit_rate: int | None = None,
    ) -> None:
        made = controller
        if not isinstance(controller, SectionControllers):
            made = SectionControllers(scenario, law, controller=controller)
        self._sections: SectionControllers = made
        super().__init__(scenario, law, made, fd=fd, bit_rate=bit_rate)
        self.stations = Stations(StationRules.of(scenario))
        self._place = Place()
        self._creep = Creep(CreepLimits.of(scenario, scenario.route.jog.speed_mps))
        self._crept_slot = -1
        self._end_margin_01mm = round(scenario.watch.end_of_authority_margin_m * 1e4)
        self._resting = ControlOutput(0, (0,) * len(made.notes), 0, 0, 0)
        self._aim = _NOT_CHOSEN
        # Stop at which the controller of the next section was prepared.
        self._prepared_for = -1
        self._door_life = self._ato_life = 0
        self.permitted = PermittedSpeed()
        self._heeds = scenario.atp.heed_atp
        self._of_law: ControlOutput | None = None
        responder = self.responder
        responder.on(DoorStat, self._take_doors)
        responder.on(StnInfo, self._take_info)
        responder.on(AtpLim, self._take_protection)

    def mailbox_telegrams(self, safe: bool) -> tuple[Sequence[type[Telegram]], Sequence[type[Telegram]]]:
        """Those of ``ato``, and of doors and stations: together all mailboxes of the chip."""
        received, sent = super().mailbox_telegrams(safe)
        return (*received, *MAILBOXES), (*sent, *ANSWERS)

    def answers(self, safe: bool) -> dict[str, Callable[[], Telegram]]:
        """Those of ``ato``, DOOR_CMD and ATO_STAT."""
        return super().answers(safe) | {DoorCmd.PORT: self._door_cmd, AtoStat.PORT: self._ato_stat}

    @property
    def counters(self) -> dict[str, int]:
        """Counters of refused and lost frames, of balises, and of the station automaton, by cause."""
        refused = {"balise_shifted": self._place.refused, **self.stations.counters}
        return super().counters | {cause: count for cause, count in refused.items() if count}

    def _take_doors(self, reading: Reading[DoorStat]) -> None:
        self.stations.take_doors(reading.telegram, self._clock.own_ns // _NS_PER_MS)

    def _take_info(self, reading: Reading[StnInfo]) -> None:
        self.stations.take_info(reading.telegram, self._clock.own_ns // _NS_PER_MS)

    def _take_protection(self, reading: Reading[AtpLim]) -> None:
        self.permitted.take(reading.telegram, self.guard.speed_01mmps or 0, self._clock.own_ns // _NS_PER_MS)

    def _control(self) -> None:
        """Step the automaton; when a control period has begun, step the law of the section, if it drives."""
        clock, guard = self._clock, self.guard
        speed_01mmps = guard.speed_01mmps
        if not clock.is_set or speed_01mmps is None:
            return
        if self._output is None:
            guard.wait(False)
        k, own_ns = clock.now_ns // self._control_ns, clock.own_ns
        begins = k != self._last_k
        stations, balise = self.stations, self._balises.last
        if begins or not speed_01mmps or stations.drive is not _LAW:
            odometer_01mm = self._odometer.at(own_ns)
            self._place.take(balise)
            place_01mm = self._place.at(odometer_01mm)
            now_ms, own_ms = clock.now_ns // _NS_PER_MS, own_ns // _NS_PER_MS
            is_sound = guard.level is _NORMAL
            stations.step(Situation(now_ms, own_ms, speed_01mmps, place_01mm, begins, is_sound))
            self._follow(k, place_01mm, odometer_01mm)
            if stations.drive is not _LAW:
                self._output = self._drive(own_ms, place_01mm, speed_01mmps)
        if begins:
            self._begin_period(k, odometer_01mm, speed_01mmps)
        if self._heeds and stations.drive is _LAW and self._of_law is not None:
            self._output = self._heed(self._of_law)

    def _begin_period(self, k: int, odometer_01mm: int, speed_01mmps: int) -> None:
        """Step the law of the section at the beginning of a control period, if it drives."""
        guard, balise = self.guard, self._balises.last
        is_late = k > self._last_k + 1 and self._last_k >= 0
        self._overruns += is_late
        guard.period(is_late)
        self._last_k = k
        if self.stations.drive is not _LAW:
            guard.overrun(False)
            self._of_law = None
            return
        if self._end_01mm is not None:
            guard.overrun(self._balises.is_beyond(odometer_01mm, self._end_01mm))
        self._output = self._of_law = self._sections.step(k, speed_01mmps, odometer_01mm, balise)
        self._steps += 1

    def _heed(self, output: ControlOutput) -> ControlOutput:
        """The law's output, without traction where the permitted speed is near."""
        if output.notch_code <= 0 or self.permitted.allows(self._clock.own_ns // _NS_PER_MS):
            return output
        return replace(output, notch_code=0)

    def _follow(self, k: int, place_01mm: int, odometer_01mm: int) -> None:
        """Begin or end a law's section, as the automaton has decided in this step."""
        stations, sections = self.stations, self._sections
        index, balise = stations.stop, self._balises.last
        aim: Aim | None = self._aim
        if stations.departed:
            aim = sections.depart(index, k, place_01mm, odometer_01mm, balise, _MODES[stations.mode_order])
        elif stations.resumed:
            aim = sections.resume(index, k, place_01mm, odometer_01mm, balise)
        elif stations.rejoined:
            aim = sections.rejoin(index, odometer_01mm, place_01mm, balise)
        else:
            if stations.crept:
                self._creep.start()
            if stations.state is AtoState.CLOSING and self._prepared_for != index:
                self._prepared_for = index
                expected_ns = stations.expected_departure_ms(self._clock.now_ns // _NS_PER_MS) * _NS_PER_MS
                mode = _MODES[stations.mode_order]
                sections.prepare(index, -(-expected_ns // self._control_ns), place_01mm, mode)
            if stations.drive is not _LAW:
                sections.rest()
            return
        if aim is None:
            stations.halt()
        else:
            self._aim = aim
        if self._end_01mm is not None:
            self._end_01mm = sections.end_01mm + self._end_margin_01mm

    def _drive(self, own_ms: int, place_01mm: int, speed_01mmps: int) -> ControlOutput:
        """What is sent while no law drives: a creep's notch, or none."""
        stations = self.stations
        if stations.drive is Drive.NONE:
            return self._resting
        slot = own_ms // STEP_MS
        if slot == self._crept_slot and self._output is not None:
            return self._output
        self._crept_slot = slot
        grade_001permil = self._track_info.grade_001permil(own_ms * _NS_PER_MS) or 0
        left_01mm = stations.next.position_01mm - place_01mm
        code = self._creep.step(left_01mm, speed_01mmps, grade_001permil)
        return ControlOutput(code, self._resting.notes, 0, 0, 0)

    def _door_cmd(self) -> Telegram:
        stations = self.stations
        self._door_life = (self._door_life + 1) & 0xF
        return DoorCmd(
            order=stations.order,
            depart_ready=flag(stations.is_ready),
            hold_brake=flag(stations.holds),
            station=stations.station,
            life=self._door_life,
        )

    def _ato_stat(self) -> Telegram:
        stations, aim = self.stations, self._aim
        self._ato_life = (self._ato_life + 1) & 0xF
        left_cm = (stations.next.position_01mm - self._place.at(self._odometer.at(self._clock.own_ns))) // 100
        return AtoStat(
            state=stations.state,
            profile=_PROFILES[aim.profile],
            section=self._sections.index + 1,
            running_time_ds=min(round(aim.running_time_s * 10), _UINT16_MAX),
            distance_left_cm=min(max(left_cm, -_LEFT_MAX_CM), _LEFT_MAX_CM),
            ready=flag(stations.state is not AtoState.INITIALISING),
            life=self._ato_life,
        )
