"""All parts but the physics of a plant of a plug-in system, for a run of a given duration."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from railhil.bus.acceptance import Acceptance
from railhil.bus.clock import rate_to_10th, to_time_sync
from railhil.bus.codes import Event, TimeState
from railhil.bus.layout import Telegram
from railhil.bus.telegrams import TimeSync

#: Time without commands after which a plant counts as abandoned.
ABANDONED_NS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Milestone:
    """A milestone of the run, see :class:`railhil.plant_sim.any_plant.Happened`."""

    kind: str
    instant_01ms: int
    position_01mm: int


def due_tick_of(duration_s: float, tick_ns: int) -> int:
    """The tick at which a run of this duration ends."""
    return round(duration_s * 1e9 / tick_ns)


class TimedEnd:
    """The run ends after its duration, or when its controller is lost (:class:`railhil.plant_sim.any_plant.Ending`).

    :param duration_s: simulation time of the complete run.
    """

    def __init__(self, duration_s: float, tick_ns: int) -> None:
        self.due_tick = due_tick_of(duration_s, tick_ns)

    def happened(self, kind: str, tick: int) -> None:
        """No event ends the run."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if controller_lost:
            return Event.ENDED_NOT_STOPPED
        return Event.ENDED_COMPLETE if tick >= self.due_tick else None


class TimedPlant(ABC):
    """Tick, clock, life signs, command checks, milestones and end of a plant that runs for its task's ``duration_s``.

    A subclass is an :class:`railhil.plant_sim.any_plant.AnyPlant` that adds ``commands``, ``statuses``,
    ``position_01mm``, ``act`` and ``advance``. ``refused`` counts commands as :class:`Acceptance` does.

    :param scenario: a :class:`railhil.scenarios.task.TaskScenario`.
    :param rate: simulated seconds per second, 0 in lockstep.
    :param makers: for each published port, the function that makes its telegram, in the order of sending;
        TIME_SYNC comes after them.
    """

    def __init__(self, scenario: Any, rate: float, makers: Mapping[str, Callable[[], Telegram | None]]) -> None:
        self.tick = 0
        self.tick_ns: int = scenario.timing.base_tick_ns
        self.refused: Counter[str] = Counter()
        self.ending = TimedEnd(scenario.task.duration_s, self.tick_ns)
        self.makers = {**makers, TimeSync.PORT: self._time_sync}
        self._rate_10th = rate_to_10th(rate)
        self._life: dict[str, int] = {}
        self._milestones: list[Milestone] = []
        self._reached: set[str] = set()
        self._gates: dict[str, Acceptance] = {}

    def next_life(self, port: str) -> int:
        """Life sign of the next telegram of a port."""
        self._life[port] = life = (self._life.get(port, -1) + 1) & 0xF
        return life

    def take(self, telegram: Telegram) -> None:
        """Take a command and carry it out if it is accepted (:class:`railhil.bus.acceptance.Acceptance`)."""
        gate = self._gates.get(telegram.PORT)
        if gate is None:
            gate = self._gates[telegram.PORT] = Acceptance(type(telegram), self.refused)
        if gate.accept(telegram):
            self.act(telegram)

    @abstractmethod
    def act(self, telegram: Telegram) -> None:
        """Carry out an accepted command, from the current tick on."""

    def milestone(self, kind: str, position_01mm: int, *, once: bool = False, instant_01ms: int | None = None) -> None:
        """Record a milestone for RUN_EVENT.

        :param once: only the first time in the run.
        :param instant_01ms: None: the instant of the current tick.
        """
        if once and kind in self._reached:
            return
        self._reached.add(kind)
        if instant_01ms is None:
            instant_01ms = self.tick * self.tick_ns // 100_000
        self._milestones.append(Milestone(kind, instant_01ms, position_01mm))

    def drain_events(self) -> list[Milestone]:
        """Milestones since the last call."""
        found, self._milestones = self._milestones, []
        return found

    def telegram_of(self, event: Milestone) -> Telegram | None:
        """No milestone has its own telegram."""
        return None

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether the plant no longer receives commands."""
        return command_age_ns > ABANDONED_NS

    def _time_sync(self) -> Telegram:
        life = self.next_life(TimeSync.PORT)
        return to_time_sync(self.tick, self.tick_ns, rate_10th=self._rate_10th, state=TimeState.RUNNING, life=life)
