"""A recorded log drives one node, as fast as it can; its frames are compared with the recorded ones.

The controller gets every recorded frame that is not its own, and answers the recorded polls. The plant gets the
recorded answers to its polls; its publications and polls must equal the recorded ones. Both are under the faults of the
run.
"""

from __future__ import annotations

import time
from collections import defaultdict, deque
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from railhil.bus.errors import BusError
from railhil.bus.frame import FD, Frame
from railhil.bus.local import AnsweredAtOnce
from railhil.bus.mvb import F_DEVICE_STATUS, device_status_frame, parse_master_frame
from railhil.bus.own_frames import OwnFrames
from railhil.controller_node.controller import AnyController, make_controller_node
from railhil.dbc import Contract
from railhil.plant_sim.node import make_plant_node
from railhil.record.difference import Difference, FrameWords, Timed, difference_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

NODES = ("controller", "plant")


@dataclass(slots=True)
class PortAnswers:
    """Frames of one port, or the polls: their number in the record, and the number of equal ones of the node.

    ``unrecorded``: answers of the node to polls without a recorded answer. ``first``: the first difference.
    """

    recorded: int = 0
    equal: int = 0
    unrecorded: int = 0
    first: Difference | None = None

    @property
    def same(self) -> bool:
        """True if every recorded frame is equal."""
        return self.first is None and self.recorded == self.equal


@dataclass(slots=True)
class Replayed:
    """A replay of one node. ``ports``: by name of the port, ``polls`` for the polls of the plant."""

    node: str
    frames: int
    sim_time_s: float
    wall_time_s: float = 0.0
    ports: dict[str, PortAnswers] = field(default_factory=lambda: defaultdict(PortAnswers))

    @property
    def speed_factor(self) -> float:
        """Simulated seconds per wall second."""
        return self.sim_time_s / self.wall_time_s if self.wall_time_s else float("nan")

    def same(self, ports: Iterable[str]) -> bool:
        """True if the node gave all recorded frames of these ports."""
        return all(self.ports[port].same for port in ports)

    def first(self, ports: Iterable[str]) -> Difference | None:
        """The first difference in these ports."""
        found = [self.ports[port].first for port in ports]
        return min((one for one in found if one is not None), key=lambda one: one.line, default=None)


def replay(node: str, record: Sequence[Timed], scenario: AnyScenario, spec: RunSpec) -> Replayed:
    """Drive a node with a record.

    :param node: one of :data:`NODES`.
    :param record: of a run of this scenario with this version's wire contract, from its first frame on; not empty.
    :param spec: the run; for the controller only its law, and the seed of its faults.
    """
    system = scenario.installed_system
    fd = bool(record[0][1].flags & FD)
    replayed = Replayed(node, len(record), record[-1][0] / 1e9)
    if node == "controller":
        controller = make_controller_node(scenario, spec, fd=fd)
        begun_ns = time.perf_counter_ns()
        _drive_controller(controller, record, replayed, system.contract)
    else:
        bus = RecordedBus(record, replayed, system.contract)
        plant = make_plant_node(scenario, spec, bus, fd=fd)
        begun_ns = time.perf_counter_ns()
        # A run that ended because a node was silent ends in the same way again.
        with suppress(_RecordEnds, BusError):
            plant.run()
        bus.finish()
    replayed.wall_time_s = (time.perf_counter_ns() - begun_ns) / 1e9
    return replayed


def _drive_controller(
    controller: AnyController, record: Sequence[Timed], replayed: Replayed, contract: Contract
) -> None:
    own, ours = _ids(contract, "controller"), OwnFrames(contract)
    words = FrameWords(contract)
    waiting: dict[str, deque[Frame]] = defaultdict(deque)
    for line, (time_ns, frame) in enumerate(record, 1):
        name = own.get(frame.can_id) if frame in ours else None
        if name is None:
            answers = controller.handle(frame)
            if answers:
                # A poll without a recorded answer is not compared with the answer to the next poll.
                port = own[answers[0].can_id]
                replayed.ports[port].unrecorded += bool(waiting[port])
                waiting[port] = deque(answers)
            continue
        found = replayed.ports[name]
        found.recorded += 1
        answer = waiting[name].popleft() if waiting[name] else None
        if answer == frame:
            found.equal += 1
        elif found.first is None:
            now = None if answer is None else (time_ns, answer)
            found.first = difference_of(line, (time_ns, frame), now, words, words)
    for name, left in waiting.items():
        replayed.ports[name].unrecorded += bool(left)


def _ids(contract: Contract, source: str) -> dict[int, str]:
    """Identifiers of the frames of a node, and their ports."""
    ports = [port for port in contract.ports if port.source == source]
    return {can_id: port.name for port in ports for can_id in (*port.can_ids, port.fd_id)}


class _RecordEnds(Exception):
    """The plant continues after the record's last frame, or differs so much that the rest cannot be compared."""


class RecordedBus(AnsweredAtOnce):
    """The plant's endpoint (:class:`railhil.plant_sim.supervision.RunEndpoint`): compares the plant's frames with the
    record, and gives the plant the recorded answers."""

    def __init__(self, record: Sequence[Timed], replayed: Replayed, contract: Contract) -> None:
        super().__init__()
        self._record = record
        self._replayed = replayed
        self._next = 0
        self._diverged = False
        self._poll_id = contract.poll_id
        self._ours = OwnFrames(contract)
        self._own = _ids(contract, "plant") | {contract.poll_id: "polls"}
        self._words = FrameWords(contract)

    def send(self, frames: Sequence[Frame]) -> None:
        """Compare; answers that are recorded after a frame are there to be received.

        :raises _RecordEnds: nothing more can be compared.
        """
        for frame in frames:
            asked = parse_master_frame(frame.data) if frame.can_id == self._poll_id else None
            if asked is not None and asked[0] == F_DEVICE_STATUS:
                # The scan before the run is not recorded: every node is there.
                self._inbox.append(device_status_frame(asked[1], 0))
            else:
                self._compare(frame)

    def _compare(self, frame: Frame) -> None:
        if self._next >= len(self._record):
            raise _RecordEnds
        time_ns, recorded = self._record[self._next]
        self._next += 1
        found = self._replayed.ports[self._own.get(recorded.can_id, "polls")]
        found.recorded += 1
        if recorded == frame:
            found.equal += 1
        elif found.first is None:
            found.first = difference_of(self._next, (time_ns, recorded), (time_ns, frame), self._words, self._words)
        if recorded.can_id != frame.can_id or (frame.can_id == self._poll_id and recorded != frame):
            self._diverged = True
            raise _RecordEnds
        while self._next < len(self._record) and not self._is_sent(answer := self._record[self._next][1]):
            self._inbox.append(answer)
            self._next += 1

    def _is_sent(self, frame: Frame) -> bool:
        """Whether a recorded frame is the plant's."""
        return frame.can_id in self._own and frame in self._ours

    def finish(self) -> None:
        """The plant has ended: frames that are left in the record are a difference."""
        left = self._record[self._next :]
        if left and not self._diverged:
            found = self._replayed.ports[self._own.get(left[0][1].can_id, "polls")]
            found.first = found.first or difference_of(self._next + 1, left[0], None, self._words, self._words)


def facts(replayed: Replayed, ports: Sequence[str]) -> dict[str, Any]:
    """A replay as JSON: figures and first difference of each port."""
    first = replayed.first(ports)
    return {
        "node": replayed.node,
        "same": replayed.same(ports),
        "frames": replayed.frames,
        "sim_time_s": replayed.sim_time_s,
        "wall_time_s": replayed.wall_time_s,
        "speed_factor": replayed.speed_factor,
        "ports": {
            name: {
                "recorded": replayed.ports[name].recorded,
                "equal": replayed.ports[name].equal,
                "unrecorded": replayed.ports[name].unrecorded,
            }
            for name in ports
        },
        "difference": None if first is None else first.as_json(),
    }
