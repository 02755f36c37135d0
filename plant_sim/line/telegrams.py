"""Makes the telegrams of a train on a line: those of ``ato``, and those of doors, stations and train protection."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Final

from railhil.bus.layout import flag
from railhil.common.floats import rounded
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.plant_sim.line.doors import SIDES
from railhil.plant_sim.line.onboard import EMERGENCY_BRAKE, TRACTION_CUT
from railhil.systems.ato.scenario.target import Target
from railhil.systems.line.scenario.model import LineScenario, StationStop
from railhil.wire.line import AtpLim, AtpStat, DoorStat, ModeOrder, Service, StnInfo

if TYPE_CHECKING:
    from railhil.plant_sim.line.train import LineTrain

_UINT16_MAX: Final = 0xFFFF
_UINT8_MAX: Final = 0xFF
_INT24_MAX: Final = 0x7FFFFF
_MODES: Final = {one.name.lower(): int(one) for one in ModeOrder}
_SERVICES: Final = {"pass": int(Service.PASS), "stop": int(Service.STOP), "terminal": int(Service.TERMINAL)}


class LineTelegrams(TrainTelegrams):
    """Adds DOOR_STAT, STN_INFO, ATP_LIM and ATP_STAT; target and limits of TRK_INFO are those of the section."""

    def __init__(self, scenario: LineScenario, train: LineTrain, rate: float) -> None:
        super().__init__(scenario, train, rate)
        self._line = scenario
        self._train = train
        self._aim = rounded(scenario.stops[0].position_m * 1000), 0
        #: Telegrams that were made under way, where only their life signs change.
        self._doors_under_way: DoorStat | None = None
        self._station_under_way: tuple[int | None, StnInfo] | None = None
        self.makers |= {
            DoorStat.PORT: self._doors,
            StnInfo.PORT: self._station,
            AtpLim.PORT: self._protection_limit,
            AtpStat.PORT: self._protection,
        }

    def begin_section(self) -> None:
        """Take target, limits and stop of the section that the train begins."""
        journey = self._train.journey
        self._target = Target(self._line.sections[journey.section].target)
        self._target_start_tick = journey.departure_tick
        self._target_half_mps = []
        self._limits = self._line.legs[journey.leg].speed_limit_mps
        self._aim = rounded(journey.stop.position_m * 1000), _to_ds(journey.stop.arrive_s)

    def _target_speed_half_mps(self) -> int:
        return 0 if self._train.journey.has_arrived else super()._target_speed_half_mps()

    def _doors(self) -> DoorStat:
        train, life = self._train, next(self._lives[DoorStat.PORT])
        told, psd_locked = self._doors_under_way, flag(train.are_platforms_locked)
        if told is not None and not train.is_busy and told.psd_locked == psd_locked:
            told.life = life
            return told
        doors, journey = train.doors, train.journey
        made = DoorStat(
            left_state=doors.left.state,
            right_state=doors.right.state,
            doors_locked=flag(doors.are_train_doors_locked),
            psd_state=doors.psd.state,
            psd_locked=psd_locked,
            psd_present=int(doors.has_psd),
            in_window=flag(train.docking.is_in_window),
            obstructions=min(doors.obstructions, _UINT8_MAX),
            dwell_left_ds=min(ceil(round(journey.dwell_left_s(train.tick) * 10, 6)), _UINT16_MAX),
            reopened=min(doors.reopened, _UINT8_MAX),
            side_permitted=train.sides_permitted,
            life=life,
        )
        self._doors_under_way = None if train.is_busy else made
        return made

    def _station(self) -> StnInfo:
        train, life = self._train, next(self._lives[StnInfo.PORT])
        journey, tick = train.journey, train.tick
        told = self._station_under_way
        has_aspects = bool(self._line.signals or journey.held_red)
        if told is not None and told[0] == journey.next_stop and not train.is_busy and not has_aspects:
            told[1].life = life
            return told[1]
        position_m = train.position_01mm / 1e4
        stop: StationStop = journey.stop
        here = train.station_here
        made = StnInfo(
            station_here=0 if here is None else here + 1,
            station_next=0 if journey.next_stop is None else journey.next_stop + 1,
            section=journey.section + 1,
            leg=journey.leg,
            service_next=_SERVICES[stop.service],
            depart_permit=flag(train.is_departure_permitted),
            signal_next=journey.signal_aspect(position_m, tick),
            due_arrival_ds=_to_ds(stop.arrive_s),
            platform_side=SIDES[stop.platform],
            mode_order=self._mode_order(here),
            due_departure_ds=_to_ds(stop.depart_s),
            next_stop_mm=rounded(stop.position_m * 1000),
            life=life,
        )
        # Signals change with time and place.
        self._station_under_way = None if train.is_busy or has_aspects else (journey.next_stop, made)
        return made

    def _mode_order(self, here: int | None) -> int:
        """The order for the section that begins where the train stands, or in which it is."""
        if here is None:
            here = self._line.sections[max(self._train.journey.section, 0)].departure
        return _MODES[self._line.stops[here].mode]

    def _protection_limit(self) -> AtpLim:
        life, onboard = next(self._lives[AtpLim.PORT]), self._train.onboard
        if onboard is None:
            return AtpLim(life=life)
        demands = onboard.demands
        return AtpLim(_to_4mmps(demands.permitted_mps), onboard.status, demands.monitoring, life=life)

    def _protection(self) -> AtpStat:
        life, onboard = next(self._lives[AtpStat.PORT]), self._train.onboard
        if onboard is None:
            return AtpStat(life=life)
        demands, reaction = onboard.demands, onboard.reaction
        return AtpStat(
            traction_cut=flag(reaction >= TRACTION_CUT),
            service_brake=flag(demands.service_brake),
            emergency_brake=flag(reaction == EMERGENCY_BRAKE),
            cause=onboard.cause,
            warning_4mmps=_to_4mmps(demands.warning_mps),
            sbi_4mmps=_to_4mmps(demands.sbi_mps),
            ebi_4mmps=_to_4mmps(demands.ebi_mps),
            target_distance_cm=_limited(demands.target_distance_m, 100, -_INT24_MAX, _INT24_MAX),
            target_speed_half_mps=_limited(demands.target_speed_mps, 2, 0, _UINT8_MAX),
            release_speed_dmps=_limited(demands.release_mps, 10, 0, _UINT8_MAX),
            uncertainty_cm=_limited(demands.uncertainty_m, 100, 0, _UINT16_MAX),
            life=life,
        )


def _limited(value: float, per_unit: int, least: int, most: int) -> int:
    """A value in steps of the wire; beyond their ends it is the end."""
    return rounded(min(max(value * per_unit, least), most))


def _to_4mmps(speed_mps: float) -> int:
    return _limited(speed_mps, 250, 0, _UINT16_MAX)


def _to_ds(time_s: float | None) -> int:
    return 0 if time_s is None else rounded(time_s * 10)
