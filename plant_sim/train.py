"""The train of the system ``ato`` on the bus: the plant with its telegrams and its gate for commands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from railhil.bus.layout import Telegram
from railhil.bus.telegrams import CtlStat, NotchCmd
from railhil.plant_sim.gate import CommandGate
from railhil.plant_sim.plant import NOTCH_LSB_PER_NOTCH, Plant
from railhil.plant_sim.run_end import RunEnd
from railhil.plant_sim.telegrams import TrainTelegrams
from railhil.scenarios.model import Scenario
from railhil.scenarios.perturb import perturbed


class TrainOnBus(Plant):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    :param drawn: draw the scenario's perturbations with the seed.
    :param rate: pace of the run, simulated seconds per wall second; 0: lockstep.
    """

    commands: ClassVar[Mapping[str, type[Telegram]]] = {NotchCmd.PORT: NotchCmd}
    statuses = (CtlStat.PORT,)

    def __init__(self, scenario: Scenario, seed: int, drawn: bool = False, rate: float = 0.0) -> None:
        actual = perturbed(scenario, seed) if drawn else scenario
        super().__init__(actual, seed)
        self.gate = CommandGate(
            round(actual.train.notch_max * NOTCH_LSB_PER_NOTCH),
            round(actual.watch.notch_step_max * NOTCH_LSB_PER_NOTCH),
            actual.watch.two_sources_max,
        )
        self._telegrams = TrainTelegrams(actual, self, rate)
        self.makers = self._telegrams.makers
        self.ending = RunEnd(actual, self)
        self._abandoned_ns = actual.watch.emergency_ms * 1_000_000

    @property
    def refused(self) -> Mapping[str, int]:
        """Counters of the gate."""
        return self.gate.counters

    def take(self, telegram: Telegram) -> None:
        """Take NOTCH_CMD if it passes the gate, and tell the watch what the gate finds suspicious."""
        assert isinstance(telegram, NotchCmd)
        gate = self.gate
        if gate.accept(telegram):
            self.command(gate.notch_256th, gate.emergency(telegram))
        if gate.suspicion:
            self.suspect(gate.suspicion)

    def telegram_of(self, event: Any) -> Telegram | None:
        """BALISE for a balise passing, TRN_WATCH for a new level of the watch."""
        if event.kind == "watch":
            return self._telegrams.watch()
        if event.balise is None:
            return None
        return self._telegrams.balise(event.balise.number, event.balise.surveyed_m, event.odometer_mm)

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether the train's watch had reached the emergency age."""
        return command_age_ns > self._abandoned_ns
