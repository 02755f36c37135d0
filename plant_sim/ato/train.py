"""The train of the system ``ato`` on the bus: the plant with its telegrams and its gate for commands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhil.bus.layout import Telegram
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato.command_watch import CommandWatchState
from railhil.plant_sim.ato.gate import CommandGate
from railhil.plant_sim.ato.plant import NOTCH_LSB_PER_NOTCH, Plant
from railhil.plant_sim.ato.run_end import RunEnd
from railhil.plant_sim.ato.safe_command import SafeCommand
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturbed
from railhil.wire.ato import CtlStat, NotchCmd, NotchSdt, WatchCause


@mypyc_attr(allow_interpreted_subclasses=True)
class TrainOnBus(Plant):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    :param drawn: draw the scenario's perturbations with the seed.
    :param rate: pace of the run, simulated seconds per wall second; 0: lockstep.
    """

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
        self.commands: Mapping[str, type[Telegram]] = {NotchCmd.PORT: NotchCmd}
        self._safe: SafeCommand | None = None
        if actual.safety.sdt:
            self._safe = SafeCommand(actual)
            self.commands = {NotchCmd.PORT: NotchCmd, NotchSdt.PORT: NotchSdt}
        self._abandoned_ns = actual.watch.emergency_ms * 1_000_000

    @property
    def refused(self) -> Mapping[str, int]:
        """Counters of the gate, and of the safe channel if there is one."""
        return self.gate.counters if self._safe is None else {**self.gate.counters, **self._safe.counters}

    @property
    def judged(self) -> dict[str, tuple[int, Mapping[str, int]]]:
        """For each port with commands how many were accepted, and the counters of its check."""
        found: dict[str, tuple[int, Mapping[str, int]]] = {
            NotchCmd.PORT: (self.gate.counters["accepted"], self.gate.counters)
        }
        if self._safe is not None:
            found[NotchSdt.PORT] = (self._safe.accepted, self._safe.counters)
        return found

    def take(self, telegram: Telegram) -> None:
        """Take NOTCH_CMD if it passes the gate, and tell the watch what the gate finds suspicious; with a safe channel,
        take it only if NOTCH_SDT confirms it."""
        gate, safe = self.gate, self._safe
        if isinstance(telegram, NotchSdt):
            assert safe is not None
            command = safe.confirmed(telegram, self.tick)
            if command is not None:
                self.command(gate.notch_256th, gate.emergency(command))
            return
        assert isinstance(telegram, NotchCmd)
        if gate.accept(telegram):
            emergency = gate.emergency(telegram)
            if safe is None or emergency:
                self.command(gate.notch_256th, emergency)
            else:
                safe.hold(telegram, self.tick)
        if gate.suspicion:
            self.suspect(gate.suspicion)

    def _cause(self, watch: CommandWatchState) -> WatchCause:
        cause = super()._cause(watch)
        unsafe = cause is WatchCause.COMMAND_AGE and self._safe is not None and self._safe.refuses
        return WatchCause.SAFETY_CODE if unsafe else cause

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
