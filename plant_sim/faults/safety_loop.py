"""The safety loop of a train that has no interlocks on its bus: open, it takes the emergency brake for good."""

from __future__ import annotations

from railhil.plant_sim.faults.injections import Injections

#: Place of the fault, level ``train``.
SAFETY_LOOP = "safety_loop"


class SafetyLoop:
    """Looks whether a fault has opened the loop; closing it again does not release the brake of the run."""

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        self._faults = injections.at("train", SAFETY_LOOP)
        #: It is, or has been, open.
        self.opened = False

    def look(self) -> None:
        """Faults have begun or ended."""
        for one in self._faults:
            self._injections.effect(one, one.active, "closed", "open")
            self.opened = self.opened or one.active
