"""The train of a line with the faults of a train of ``ato``, and those of doors, stops and train protection.

Faults of adhesion and of the axle do not reach the protection's own axle sensor: its axle is neither driven nor braked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

from railhil.faults.model import Fault
from railhil.plant_sim.ato.dynamics import Window
from railhil.plant_sim.ato.faults.forces import FeltChecks
from railhil.plant_sim.ato.faults.train import FaultyTrain, UnreadBalise
from railhil.plant_sim.ato.forces import TrainConstants
from railhil.plant_sim.ato.plant import EventKind
from railhil.plant_sim.faults.readings import BaliseReport
from railhil.plant_sim.line.braked import BrakedTrain, with_brake
from railhil.plant_sim.line.brakes import EmergencyForce
from railhil.plant_sim.line.faults.axle import FaultyAxle
from railhil.plant_sim.line.faults.stations import Stations
from railhil.plant_sim.line.onboard import EMERGENCY_BRAKE
from railhil.plant_sim.line.pass_mark import PassMark
from railhil.plant_sim.line.train import LineTrain
from railhil.systems.ato.scenario.model import Balise
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.line import AtpCause


class FaultyLineTrain(FaultyTrain, LineTrain):
    """See :class:`railhil.plant_sim.faults.plants.FaultyPlant`."""

    OWN_PLACES: ClassVar[tuple[str, ...]] = ("doors",)

    def __init__(
        self, scenario: LineScenario, seed: int, drawn: bool, rate: float, faults: Sequence[tuple[int, Fault]]
    ) -> None:
        super().__init__(scenario, seed, drawn, rate, faults)
        if self.onboard is not None:
            sensors, period_s = self.onboard.sensors, self.onboard.period_ticks * self._step_s
            self.onboard.sensors = FaultyAxle(sensors, self.injections, period_s)
            self.onboard.read_own = self._read_own_balise
        self._stations = Stations(self, self.injections)

    def _assemble(self, scenario: Any, seed: int, drawn: bool, rate: float) -> None:
        LineTrain.__init__(self, scenario, seed, drawn, rate)

    def _load(self, factor: float) -> None:
        BrakedTrain._load(self, factor)
        self._healthy = replace(self._line, train=self._train, line=self._line.legs[self.journey.leg])
        self._take_mismatch()
        # As in a train without faults, its checks begin anew.
        self._train, self._constants = self._actual_train, self._base
        self._own_checks = FeltChecks(self._applied_mismatch.applied(self._healthy), self._base, self._forces)
        self._changed = True

    def _take_mismatch(self) -> None:
        super()._take_mismatch()
        self._plain_constants = self._base

    def _turn_back(self) -> None:
        super()._turn_back()
        self._shifts_m = {}
        self._shift_balises()

    # -- what the faults need -----------------------------------------------------------------------------------------

    @property
    def emergency(self) -> EmergencyForce | None:
        """The emergency brake, if it has a force of its own."""
        return self._emergency

    @property
    def is_emergency(self) -> bool:
        """Whether the emergency brake is applied, by the watch or by the train protection."""
        return super().is_emergency or (self.onboard is not None and self.onboard.reaction == EMERGENCY_BRAKE)

    @property
    def is_in_window(self) -> bool:
        """Whether the train stands within the door window of its stop."""
        journey = self.journey
        offset_m = self._motion.position_m - journey.stop.position_m
        return self.is_standing and journey.has_arrived and abs(offset_m) <= self._line.route.door_window_m

    @property
    def _healthy_constants(self) -> TrainConstants:
        # The emergency brake's force has just been taken into the constants.
        return self._constants if self.is_emergency and self._emergency is not None else self._base

    def advance(self) -> None:
        """Simulate one tick with the faults of stops and protection."""
        self._stations.act()
        super().advance()
        self._stations.note()

    def _protect(self) -> None:
        """The forces under the faults; they do not reach the holding brake."""
        super()._protect()
        held_n = self.holding.acting_n
        if held_n > 0.0:
            self._window = Window(self._window.traction, max(self._window.brake_min_n, held_n))
            self._constants = with_brake(self._constants, held_n, self._motion.speed_mps)

    # -- balises and events -------------------------------------------------------------------------------------------

    def _pass_balise(self, balise: Balise, after_s: float) -> None:
        if isinstance(balise, PassMark):
            LineTrain._pass_balise(self, balise, after_s)
        else:
            super()._pass_balise(balise, after_s)

    def _read_balise(self, balise: Balise, after_s: float, odometer_mm: int) -> None:
        if self.onboard is not None and not isinstance(balise, UnreadBalise):
            self.onboard.pass_balise(balise)
        super()._read_balise(balise, after_s, odometer_mm)

    def _read_own_balise(self, balise: Balise) -> None:
        """Read a balise that only the protection sees: with the same reader."""
        assert self.onboard is not None
        true_m = balise.true_m + self._reader.shift_m(balise.number)
        for report in self._reader.reported(BaliseReport(balise.number, balise.surveyed_m)):
            if report.valid:
                self.onboard.pass_balise(Balise(report.number, balise.surveyed_m, true_m))

    def _event(self, kind: EventKind, *given: Any) -> None:
        super()._event(kind, *given)
        if kind == "atp" and self.onboard is not None:
            self.injections.happened(AtpCause(self.onboard.cause).name.lower())
