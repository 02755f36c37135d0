"""Runs in this process over a bus on which every frame can be changed, for all nodes and the recorder alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.plant_sim.node import make_plant_node
from railhil.record.framelog import FrameLog, read_log
from railhil.record.session import make_session
from railhil.record.trace import Trace, trace_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named

Disturbance = Callable[[Frame, float], list[Frame]]


class _DisturbedBus(LocalBus):
    """Passes the administrator's frames through a function, too."""

    def __init__(
        self, nodes: Sequence[Callable[[Frame], list[Frame]]], changed: Callable[[Frame], list[Frame]]
    ) -> None:
        super().__init__([lambda frame, node=node: self._answers(node, frame) for node in nodes])
        self._changed = changed

    def _answers(self, node: Callable[[Frame], list[Frame]], frame: Frame) -> list[Frame]:
        return [item for answer in node(frame) for item in self._changed(answer)]

    def send(self, frames: Sequence[Frame]) -> None:
        super().send([item for frame in frames for item in self._changed(frame)])


def disturbed_run(scenario: AnyScenario, folder: Path, disturbance: Disturbance, spec: RunSpec | None = None) -> Trace:
    """Trace of a run in whose bus ``disturbance`` (frame, simulation time in s) gives the frames that really come."""
    system = system_named(scenario.system)
    spec = spec or RunSpec(law=LawSpec(system.law))
    log = FrameLog(folder)
    session = make_session(scenario, log.write, spec)
    node = system.part("controller")(scenario, spec.law)

    def changed(frame: Frame) -> list[Frame]:
        return disturbance(frame, session.sim_time_s)

    plant = make_plant_node(scenario, spec, _DisturbedBus([node.handle, session.handle], changed))
    plant.run()
    log.close()
    return trace_of(read_log(log.path), system.contract)


def damaged(frame: Frame) -> Frame:
    """A frame whose first bit is wrong, so that its check sequence does not fit."""
    return frame._replace(data=bytes([frame.data[0] ^ 0x80]) + frame.data[1:])
