"""Speed and command once more as safe telegrams (SDTv2), for scenarios with ``safety.sdt``; fields as in
:mod:`railhil.bus.telegrams`, trailer as in :mod:`railhil.bus.sdt`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from railhil.bus.layout import FLAG_FALSE, Telegram, signal

#: Major version of the user data of both.
SAFE_DATA_VERSION = 1


@dataclass(slots=True)
class SpeedSdt(Telegram):
    """SPEED_SDT, speed and odometer as a safe telegram.

    ::

          0    1    2     3     4    5    6    7
        +--------------+------+-------------------+
        |     s24      | tick |  odometer s32 mm  |   speed 0.1 mm/s; tick: bits 23 to 16
        +--------------+------+-------------------+
          8    9    10   11   12   13   14   15
        +---------+----+----+-------------------+
        |  tick   |ver |ssc |       crc32       |   tick: bits 15 to 0; trailer of railhil.bus.sdt
        +---------+----+----+-------------------+
    """

    PORT: ClassVar[str] = "SPEED_SDT"
    speed_01mmps: int = signal("SafeSpeed")
    tick_high: int = signal("SafeSpeedTickHigh")
    odometer_mm: int = signal("SafePos")
    tick_low: int = signal("SafeSpeedTick")
    version: int = signal("SafeSpeedVersion")
    ssc: int = signal("SafeSpeedSsc")
    code: int = signal("SafeSpeedCode")


@dataclass(slots=True)
class NotchSdt(Telegram):
    """NOTCH_SDT, the command of NOTCH_CMD as a safe telegram.

    ::

          0    1     2      3       4       5    6    7
        +---------+-------+------+----------------------+
        |  s16    | spare | tick | emergency      spare |   notch 1/256; tick: bits 23 to 16
        +---------+-------+------+----------------------+
          8    9    10   11   12   13   14   15
        +---------+----+----+-------------------+
        |  tick   |ver |ssc |       crc32       |   tick: bits 15 to 0; trailer of railhil.bus.sdt
        +---------+----+----+-------------------+
    """

    PORT: ClassVar[str] = "NOTCH_SDT"
    notch_256th: int = signal("SafeNotch")
    spare: int = signal("SafeNotchSpare")
    tick_high: int = signal("SafeNotchTickHigh")
    emergency: int = signal("SafeEmergency", FLAG_FALSE)
    rest: int = signal("SafeNotchRest")
    tick_low: int = signal("SafeNotchTick")
    version: int = signal("SafeNotchVersion")
    ssc: int = signal("SafeNotchSsc")
    code: int = signal("SafeNotchCode")


def safe_tick(telegram: SpeedSdt | NotchSdt) -> int:
    """Simulation time of the source in base ticks, modulo 2^24."""
    return telegram.tick_high << 16 | telegram.tick_low


def safe_tick_fields(tick: int) -> dict[str, int]:
    """The fields that hold the time of a safe telegram."""
    return {"tick_high": tick >> 16 & 0xFF, "tick_low": tick & 0xFFFF}
