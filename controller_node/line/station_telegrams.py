"""The telegrams of doors and stations as the station automaton knows them, with their ages."""

from __future__ import annotations

from typing import Final

from railhil.bus.layout import CHECK_CORRECT, FLAG_TRUE
from railhil.bus.lifesign import LifeSign
from railhil.controller_node.line.rules import ServedStop
from railhil.wire.line import DoorSide, DoorStat, StnInfo

#: Age above which STN_INFO and DOOR_STAT are lost.
AGE_MAX_MS: Final = 1000


class StationTelegrams:
    """The last accepted DOOR_STAT and STN_INFO."""

    def __init__(self) -> None:
        self.doors: DoorStat | None = None
        self.info: StnInfo | None = None
        self._doors_ms = self._info_ms = 0
        self._doors_life, self._info_life = LifeSign(), LifeSign()

    def take_doors(self, telegram: DoorStat, own_ms: int) -> None:
        """Take a DOOR_STAT telegram; one that repeats its life sign, or whose check is not correct, is not used."""
        if telegram.check == CHECK_CORRECT and self._doors_life.judge(telegram.life).fresh:
            self._doors_life.accept(telegram.life)
            self.doors, self._doors_ms = telegram, own_ms

    def take_info(self, telegram: StnInfo, own_ms: int) -> None:
        """Take a STN_INFO telegram, as :meth:`take_doors`."""
        if telegram.check == CHECK_CORRECT and self._info_life.judge(telegram.life).fresh:
            self._info_life.accept(telegram.life)
            self.info, self._info_ms = telegram, own_ms

    def is_fresh(self, own_ms: int) -> bool:
        """Whether both telegrams are known and not too old."""
        if self.doors is None or self.info is None:
            return False
        return own_ms - self._doors_ms <= AGE_MAX_MS and own_ms - self._info_ms <= AGE_MAX_MS

    def side_states(self, side: DoorSide) -> tuple[int, ...]:
        """States of the doors on a side, and of the platform's own."""
        doors = self.doors
        if doors is None:
            return ()
        left = (doors.left_state,) if side in (DoorSide.LEFT, DoorSide.BOTH) else ()
        right = (doors.right_state,) if side in (DoorSide.RIGHT, DoorSide.BOTH) else ()
        return left + right + ((doors.psd_state,) if doors.psd_present else ())

    @property
    def are_locked(self) -> bool:
        """Whether the doors of train and platform are told to be locked."""
        doors = self.doors
        return doors is not None and doors.doors_locked == FLAG_TRUE and doors.psd_locked == FLAG_TRUE

    def is_wrong_side(self, here: ServedStop) -> bool:
        """Whether the track side names another stop or another side than the timetable."""
        info, doors = self.info, self.doors
        if info is None or doors is None:
            return True
        told = doors.side_permitted
        return info.station_here != here.number or info.platform_side != here.side or (told != 0 and told != here.side)
