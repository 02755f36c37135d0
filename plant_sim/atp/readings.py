"""What the train protection sees, and what it demands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from railhil.scenarios.profiles import Profile

#: ``Demands.status``.
NORMAL: Final = 0
INDICATION: Final = 1
OVERSPEED: Final = 2
WARNING: Final = 3
INTERVENTION: Final = 4
#: ``Demands.monitoring``.
CEILING_MONITORING: Final = 0
TARGET_MONITORING: Final = 1
RELEASE_MONITORING: Final = 2
#: ``Demands.cause``.
NONE: Final = 0
CEILING: Final = 1
TARGET: Final = 2
RELEASE: Final = 3
TRIP: Final = 4
POSITION: Final = 5
DOORS: Final = 6
ROLL_AWAY: Final = 7
SELF_TEST: Final = 8
RED_SIGNAL: Final = 9


@dataclass(frozen=True, slots=True)
class Track:
    """The track of one leg as surveyed, in run positions; ``balises`` are (number, surveyed_m)."""

    grade_permil: Profile
    speed_limit_mps: Profile
    balises: tuple[tuple[int, float], ...]


@dataclass(frozen=True, slots=True)
class TrainData:
    """What the protection knows of its train. ``speed_limit_mps`` is the train's own."""

    length_m: float
    speed_limit_mps: float
    gravity_mps2: float = 9.81


@dataclass(frozen=True, slots=True)
class Authority:
    """The train may run to ``eoa_m``; nothing endangered lies before ``svl_m``."""

    eoa_m: float
    svl_m: float
    red_signal: bool = False


class Readings(NamedTuple):
    """What an onboard unit has at one tick (a tuple, as one is made in every tick).

    :ivar speed_mps: of its own axle sensor, like the odometer.
    :ivar balises: passed since the last step: number read, and own odometer at the passing.
    :ivar authority: None: none has been received in this tick.
    :ivar train_held: the train is meant to stand: a movement is one of rolling away.
    """

    time_s: float
    speed_mps: float
    odometer_m: float
    balises: tuple[tuple[int, float], ...]
    authority: Authority | None
    doors_locked: bool
    train_held: bool


@dataclass(slots=True)
class Demands:
    """Demands at the brakes and what a display shows; the constants of this module are its codes.

    :ivar target_distance_m: from the estimated position to the target that limits the train, or to the end of
        authority.
    :ivar uncertainty_m: half the interval of the position.
    """

    traction_cut: bool = False
    service_brake: bool = False
    emergency_brake: bool = False
    status: int = NORMAL
    monitoring: int = CEILING_MONITORING
    cause: int = NONE
    permitted_mps: float = 0.0
    warning_mps: float = 0.0
    sbi_mps: float = 0.0
    ebi_mps: float = 0.0
    target_distance_m: float = 0.0
    target_speed_mps: float = 0.0
    release_mps: float = 0.0
    uncertainty_m: float = 0.0
