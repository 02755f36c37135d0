"""Traction or brake of a train that is commanded by an acceleration, with faults (:mod:`railhil.faults.actuators`)."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

from railhil.faults.activity import Activity
from railhil.faults.actuators import FaultySide
from railhil.plant_sim.faults.injections import Injections

#: A fault of a side counts as visible if the acceleration differs by more than this from the healthy one.
_NOTICED_MPS2 = 0.001


class AccelerationSide(FaultySide):
    """Traction or brake.

    :param sign: 1 for traction, -1 for the brake.
    :ivar healthy_mps2: the last acceleration without faults.
    :ivar instead_mps2: acceleration that a fault gives instead; None: no such fault.
    """

    def __init__(self, activities: Iterable[Activity], sign: int) -> None:
        super().__init__(activities)
        self.sign = sign
        self.healthy_mps2 = 0.0
        self.instead_mps2: float | None = None

    def take_at(self, injections: Injections, name: str, unit: int = 0) -> None:
        """Have the faults of the actuator of this name.

        :param unit: of the train, from 1; 0: it has one.
        """
        self.take(injections.at("actuator", name, unit=unit))

    def update(self, most_mps2: float) -> None:
        """Take the faults that have begun or ended.

        :param most_mps2: largest magnitude of the acceleration of this side.
        """
        self.change(self.healthy_mps2 if self.instead_mps2 is None else self.instead_mps2)
        instead = self.state.instead
        self.instead_mps2 = self.sign * most_mps2 if instead == inf else instead

    def acting_mps2(self, commanded_mps2: float) -> float:
        """The acceleration that this side gives for a commanded one."""
        self.healthy_mps2 = commanded_mps2 if commanded_mps2 * self.sign > 0.0 else 0.0
        return self.healthy_mps2 * self.state.share if self.instead_mps2 is None else self.instead_mps2

    def note(self, injections: Injections) -> None:
        """Note which faults change the acceleration of this instant."""
        healthy_mps2 = self.healthy_mps2
        acting_mps2 = self.acting_mps2(healthy_mps2)
        differs = abs(acting_mps2 - healthy_mps2) > _NOTICED_MPS2
        for one in self.faults:
            fault, is_active = one.activity.fault, one.activity.active
            if one.field in ("poles", "delays_s"):
                injections.effect(one.activity, is_active, "1", str(*fault.values.values()))
            else:
                before, after = f"{healthy_mps2:.3f} m/s2", f"{acting_mps2:.3f} m/s2"
                injections.effect(one.activity, is_active and differs, before, after)
