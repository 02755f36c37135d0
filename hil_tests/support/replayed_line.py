"""Runs over a line whose motion is recorded, and runs in which the whole plant is moved as recorded.

In a replay, the train moves, and its doors, holding brake and place in the timetable change, as they were recorded,
whatever the controller sends. All else is the plant as it is: its sensors, balises, track side and train protection.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass, field, replace
from random import Random
from typing import Any, NamedTuple

import pytest

from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource
from railhil.plant_sim import node as plant_node
from railhil.plant_sim.ato.dynamics import Motion, Step
from railhil.plant_sim.ato.plant import SLIVER_TICKS
from railhil.plant_sim.line.onboard import Onboard
from railhil.plant_sim.line.train import LineTrain
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import CtlStat, NotchCmd
from railhil.wire.line import AtoStat, AtpLim, AtpStat, DoorCmd

#: Telegrams of the controller after the handshake.
COMMANDS = (NotchCmd, DoorCmd)
ANSWERS = (*COMMANDS, CtlStat, AtoStat)
#: Share of the random commands that have other values than the one before.
_CHANGED = 0.02


class World(NamedTuple):
    """What a look of the protection finds beside the motion: doors, holding brake and place in the timetable."""

    doors: tuple[tuple[int, bool], ...]
    has_psd: bool
    is_held: bool
    journey: dict[str, Any]


@dataclass
class Recording:
    """Of one run: the motion after each tick, and at each look of the protection the world and what it demands.

    ``told``: time in ns, port and data of its telegrams. ``passed``: so many commands passed the plant's checks.
    """

    motions: list[Motion] = field(default_factory=list)
    worlds: list[World] = field(default_factory=list)
    demands: list[tuple[object, ...]] = field(default_factory=list)
    told: list[tuple[int, str, bytes]] = field(default_factory=list)
    passed: dict[str, int] = field(default_factory=dict)


class RecordedTrain(LineTrain):
    """A train that notes its motion and what its protection sees and demands."""

    def __init__(self, scenario: LineScenario, seed: int) -> None:
        self.recording = Recording()
        super().__init__(scenario, seed)

    def advance(self) -> None:
        super().advance()
        self.recording.motions.append(self._motion)

    def _look(self, onboard: Onboard) -> None:
        doors, journey = self.doors, self.journey
        sides = tuple((door.state, door.has_lost_lock) for door in (doors.left, doors.right, doors.psd))
        place = {**vars(journey), "_passed_clear": set(journey._passed_clear)}
        self.recording.worlds.append(World(sides, doors.has_psd, self.holding.is_applied, place))
        super()._look(onboard)
        self.recording.demands.append((onboard.reaction, *astuple(onboard.demands)))


class _End:
    """The end of a replay, after its last recorded tick."""

    def __init__(self, due_tick: int) -> None:
        self.due_tick = due_tick

    def happened(self, kind: str, tick: int) -> None:
        """Nothing ends it earlier."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        return Event.ENDED_COMPLETE if tick >= self.due_tick else None


class ReplayedTrain(RecordedTrain):
    """A train that is moved as recorded."""

    def __init__(self, scenario: LineScenario, seed: int, recorded: Recording) -> None:
        super().__init__(scenario, seed)
        self._recorded = recorded
        self._moved = self._replay
        self.ending = _End(len(recorded.motions))

    def _replay(self, *_: object) -> Step:
        return Step(self._recorded.motions[self.tick], 0.0, self._step_s)

    def _move(self, from_tick: float, ticks: float) -> None:
        # A command may divide a tick; the recorded motion is that of its end.
        if from_tick + ticks >= self.tick + 1 - SLIVER_TICKS:
            super()._move(from_tick, ticks)

    def _look(self, onboard: Onboard) -> None:
        world, doors = self._recorded.worlds[len(self.recording.worlds)], self.doors
        for door, (state, has_lost_lock) in zip((doors.left, doors.right, doors.psd), world.doors, strict=True):
            door.state, door.has_lost_lock = state, has_lost_lock
        doors.has_psd, self.holding.is_applied = world.has_psd, world.is_held
        vars(self.journey).update(world.journey, _passed_clear=set(world.journey["_passed_clear"]))
        super()._look(onboard)


def play(
    monkeypatch: pytest.MonkeyPatch,
    line: LineScenario,
    recorded: Recording | None = None,
    change: Callable[[type[Any], bytes], bytes] | None = None,
    seed: int = 0,
) -> Recording:
    """A run of plant node, controller node and recorder in this process.

    :param recorded: the plant moves like this; None: freely.
    :param change: makes the data of each telegram of the controller after the handshake from its class and data; None:
        they stay.
    """
    spec = RunSpec(law=LawSpec("ipfc_plus"), seed=seed)
    train = RecordedTrain(line, seed) if recorded is None else ReplayedTrain(line, seed, recorded)
    found = train.recording
    session = make_session(line, lambda _: None, spec)
    controller = line.installed_system.part("controller")(line, spec.law, None)
    kinds = {kind.port().address: kind for kind in ANSWERS}
    protection = {can_id: kind.PORT for kind in (AtpLim, AtpStat) for can_id in kind.port().can_ids}
    sources = {kind: TelegramSource(kind.port()) for kind in ANSWERS}

    def answer(frame: Frame) -> list[Frame]:
        if (port := protection.get(frame.can_id)) is not None:
            found.told.append((session.time_ns, port, bytes(frame.data)))
        answers: list[Frame] = controller.handle(frame)
        if change is None or not answers or (kind := kinds.get(answers[0].can_id)) is None:
            return answers
        data = b"".join(one.data for one in answers)[: kind.port().data_bytes]
        return list(sources[kind].frames(change(kind, data)))

    with monkeypatch.context() as patch:
        patch.setattr(plant_node, "make_plant", lambda *_, **__: (train, None))
        plant = plant_node.make_plant_node(line, spec, LocalBus([answer, session.handle]))
        plant.run()
    found.passed = {port: accepted for port, (accepted, _) in train.judged.items()}
    return found


def random_bytes(draw: Random) -> Callable[[type[Any], bytes], bytes]:
    """Telegrams of random bytes."""
    return lambda kind, data: draw.randbytes(len(data))


def random_values(draw: Random) -> Callable[[type[Any], bytes], bytes]:
    """Commands of random values, with a life sign and a check variable that the train accepts.

    Each value lasts for some telegrams, 2 s on average: a brake or a door needs that long.
    """
    last: dict[type[Any], Any] = {}

    def change(kind: type[Any], data: bytes) -> bytes:
        if kind not in COMMANDS:
            return draw.randbytes(len(data))
        if kind not in last or draw.random() < _CHANGED:
            last[kind] = kind.decode(draw.randbytes(len(data)))
            if kind is NotchCmd:
                last[kind] = replace(last[kind], notch_256th=draw.randint(-7 * 256, 7 * 256))
        return bytes(replace(last[kind], life=kind.decode(data).life, check=CHECK_CORRECT).encode())

    return change


def first_difference(one: Recording, other: Recording) -> str:
    """The first look or telegram of the protection that is not equal to the last bit in two runs of the same motion;
    empty: none."""
    assert one.motions == other.motions
    for what, before, after in (("look", one.demands, other.demands), ("telegram", one.told, other.told)):
        for number, (first, second) in enumerate(zip(before, after, strict=True)):
            if first != second:
                return f"{what} {number}: {first}, then {second}"
    return ""
