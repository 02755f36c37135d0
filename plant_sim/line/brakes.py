"""Holding brake and emergency brake of a train of the system ``line``."""

from __future__ import annotations

from math import exp
from typing import Final

from railhil.systems.line.scenario.model import EmergencyBrake

_FULL: Final = 1.0


class HoldingBrake:
    """Holds the standing train without its actuator, which thereby stays without a charge.

    It is applied at standstill while it is demanded. It is released without a demand when the traction exceeds
    resistance and grade, or after an accepted departure downhill.

    :ivar force_n: its braking force, the parking brake's.
    :ivar share: of that force, less than 1 if it is weak.
    """

    def __init__(self, force_n: float) -> None:
        self.force_n = force_n
        self.share = _FULL
        #: A train that has not yet moved is held.
        self.is_applied = True

    def apply(self) -> None:
        """Apply it at standstill."""
        self.is_applied = True

    def follow(self, traction_n: float, against_n: float, departing: bool) -> None:
        """Release it if the train then moves forward by its own force, or may roll.

        :param traction_n: force of the actuator, >= 0.
        :param against_n: resistance and grade at standstill; below 0 downhill.
        :param departing: the departure was accepted.
        """
        if traction_n > max(0.0, against_n) or (departing and against_n < 0.0):
            self.is_applied = False

    @property
    def acting_n(self) -> float:
        """The force that it has now."""
        return self.force_n * self.share if self.is_applied else 0.0


class EmergencyForce:
    """Force of the emergency brake: nothing for the dead time, then a first-order lag; it stays for the run.

    :param mass_kg: nominal inertial mass: the brake has a force, whatever the load is.
    :ivar share: of its force, less than 1 if it is weak.
    """

    def __init__(self, brake: EmergencyBrake, mass_kg: float, tick_s: float) -> None:
        self.full_n = brake.braking_mps2 * mass_kg
        self.share = _FULL
        self._brake = brake
        self._tick_s = tick_s
        self._ticks = 0

    def step(self) -> float:
        """Force over the next tick of the demand, at its middle."""
        acting_s = (self._ticks + 0.5) * self._tick_s - self._brake.dead_s
        self._ticks += 1
        if acting_s <= 0.0:
            return 0.0
        lag_s = self._brake.lag_s
        return self.full_n * self.share * (_FULL - exp(-acting_s / lag_s) if lag_s > 0.0 else _FULL)
