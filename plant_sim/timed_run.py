"""For plants of systems that plug in: what every one has beside its physics, when its run lasts a given time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from railhil.bus.acceptance import Acceptance
from railhil.bus.clock import rate_to_10th, to_time_sync
from railhil.bus.layout import Telegram
from railhil.bus.telegrams import Event, TimeState, TimeSync

#: A plant without a command for so long is abandoned.
ABANDONED_NS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Milestone:
    """A milestone of the run, see :class:`railhil.plant_sim.any_plant.Happened`."""

    kind: str
    instant_01ms: int
    position_01mm: int


class TimedEnd:
    """The run is over when its time is, or its controller is gone (:class:`railhil.plant_sim.any_plant.Ending`).

    :param duration_s: simulation time of the whole run.
    """

    def __init__(self, duration_s: float, tick_ns: int) -> None:
        self.due_tick = round(duration_s * 1e9 / tick_ns)

    def happened(self, kind: str, tick: int) -> None:
        """Nothing that happens ends the run."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None when it goes on."""
        if controller_lost:
            return Event.ENDED_NOT_STOPPED
        return Event.ENDED_COMPLETE if tick >= self.due_tick else None


class TimedPlant(ABC):
    """Tick, clock, life signs, command checks, milestones and end of a plant that runs for its task's ``duration_s``.

    A subclass is an :class:`railhil.plant_sim.any_plant.AnyPlant` with what is its own: ``commands``, ``statuses``,
    ``position_01mm``, ``act`` and ``advance``. ``refused`` counts commands as :class:`Acceptance` does.

    :param scenario: a :class:`railhil.scenarios.task.TaskScenario`.
    :param rate: simulated seconds per second, 0 in lockstep.
    :param makers: what makes the telegram of each port that it publishes, in the order in which they are sent;
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
        """A command has come: it acts if it is accepted (:class:`railhil.bus.acceptance.Acceptance`)."""
        gate = self._gates.get(telegram.PORT)
        if gate is None:
            gate = self._gates[telegram.PORT] = Acceptance(type(telegram), self.refused)
        if gate.accept(telegram):
            self.act(telegram)

    @abstractmethod
    def act(self, telegram: Telegram) -> None:
        """Carry out a command that was accepted, from the current tick on."""

    def milestone(self, kind: str, position_01mm: int, *, once: bool = False) -> None:
        """Something that RUN_EVENT tells of has happened at the current tick.

        :param once: only the first time in the run.
        """
        if once and kind in self._reached:
            return
        self._reached.add(kind)
        self._milestones.append(Milestone(kind, self.tick * self.tick_ns // 100_000, position_01mm))

    def drain_events(self) -> list[Milestone]:
        """What has happened since the last call."""
        found, self._milestones = self._milestones, []
        return found

    def telegram_of(self, event: Milestone) -> Telegram | None:
        """No milestone has a telegram of its own."""
        return None

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether nobody commands the plant any more."""
        return command_age_ns > ABANDONED_NS

    def _time_sync(self) -> Telegram:
        life = self.next_life(TimeSync.PORT)
        return to_time_sync(self.tick, self.tick_ns, rate_10th=self._rate_10th, state=TimeState.RUNNING, life=life)
