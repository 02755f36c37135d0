"""Train status, and the interlocks by which it acts on the forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

#: Lowest permanent line voltage in % of nominal: 1000 V of 1500 V, 500 V of 750 V (EN 50163, table 1).
LINE_VOLTAGE_MIN_PERCENT: Final = 200 / 3


@dataclass(slots=True)
class TrainStatus:
    """State of the train's equipment; a healthy train by default. Setting a field takes effect from the next step on.

    ``line_voltage_percent`` is of nominal, ``fault`` the code 0..15 of PLT_STAT (0 = none).
    """

    power_on: bool = True
    pantograph_up: bool = True
    main_breaker_closed: bool = True
    doors_closed_locked: bool = True
    parking_brake_released: bool = True
    safety_loop_closed: bool = True
    brake_available: bool = True
    line_voltage_percent: float = 100.0
    fault: int = 0

    @property
    def traction_enabled(self) -> bool:
        """True when no interlock of the train blocks traction."""
        return (
            self.power_on
            and self.pantograph_up
            and self.main_breaker_closed
            and self.doors_closed_locked
            and self.parking_brake_released
            and self.safety_loop_closed
            and self.brake_available
            and self.line_voltage_percent >= LINE_VOLTAGE_MIN_PERCENT
        )
