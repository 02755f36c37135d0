"""The plant's watch on the supervisor in real time: it is lost if it does not answer, but not if the plant cannot
receive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace

import pytest

from railhil.bus.codes import Event, ends_run
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import master_frame
from railhil.bus.telegrams import SupCmd
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import make_plant_node
from railhil.plant_sim.supervision import SupervisorWatch
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd

PERIOD_NS = 160_000_000
SUP_POLL = master_frame(SupCmd.port().f_code, SupCmd.port().address)
NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
S = 1_000_000_000


def watch(rate: float) -> tuple[SupervisorWatch, SimpleNamespace]:
    """A watch that has just heard the supervisor, at time 0, and its endpoint."""
    endpoint = SimpleNamespace(is_down=False)
    found = SupervisorWatch(endpoint, PERIOD_NS, rate)
    found.heard(0)
    return found, endpoint


@pytest.mark.parametrize(
    ("rate", "limit_s"), [(0.0, 60.0), (1.0, 2.0), (20.0, 2.0), (0.2, 2.0), (0.1, 4.0), (0.05, 8.0), (0.01, 40.0)]
)
def test_at_any_rate_two_polls_are_missed_before_it_is_lost(rate: float, limit_s: float) -> None:
    found, _ = watch(rate)
    assert found.limit_ns == round(limit_s * S)
    assert not found.is_lost(found.limit_ns)
    assert found.is_lost(found.limit_ns + 1)
    if rate:
        assert not found.is_lost(round(2 * PERIOD_NS / rate) + 5_000_000), "one answer was lost"


def test_an_outage_of_the_plant_itself_is_not_counted() -> None:
    found, endpoint = watch(1.0)
    endpoint.is_down = True
    found.begin()
    found.end(10 * S)
    assert not found.is_lost(12 * S)
    assert found.is_lost(12 * S + 1)


def test_nor_is_the_opening_of_its_interface() -> None:
    """A serial adapter takes seconds for that, within one poll."""
    found, endpoint = watch(1.0)
    endpoint.is_down = True
    found.begin()
    endpoint.is_down = False
    found.end(10 * S)
    found.begin()
    found.end(12 * S)
    assert not found.is_lost(12 * S)


class Interrupted(LocalBus):
    """A bus whose supervisor is not heard from its poll number ``from_poll`` for ``polls`` polls."""

    def __init__(
        self, nodes: Sequence[Callable[[Frame], list[Frame]]], from_poll: int, polls: int, is_down: bool
    ) -> None:
        super().__init__([nodes[0], self._to_supervisor])
        self._supervisor = nodes[1]
        self._silent = range(from_poll, from_poll + polls)
        self._polls = 0
        self._outage = is_down

    def _to_supervisor(self, frame: Frame) -> list[Frame]:
        if frame == SUP_POLL:
            self._polls += 1
            is_silent = self._polls in self._silent
            self.is_down = self._outage and is_silent
            return [] if is_silent else self._supervisor(frame)
        return self._supervisor(frame)


class Late(LocalBus):
    """A bus on which the answer to one poll of NOTCH_CMD comes with the next telegram of the plant."""

    def __init__(self, nodes: Sequence[Callable[[Frame], list[Frame]]], poll: int) -> None:
        super().__init__([self._to_controller, nodes[1]])
        self._controller = nodes[0]
        self._left = poll
        self._kept: list[Frame] = []

    def _to_controller(self, frame: Frame) -> list[Frame]:
        kept, self._kept = self._kept, []
        answers = self._controller(frame)
        if frame == NOTCH_POLL:
            self._left -= 1
            if self._left == 0:
                self._kept, answers = answers, []
        return kept + answers


def test_a_plant_reports_the_frames_that_came_too_late(run_2m: Scenario) -> None:
    run = RunSpec(pace="realtime", rate=20.0)
    session = make_session(run_2m, lambda line: None, run)
    node = ControllerNode(run_2m, LawSpec())
    plant = make_plant_node(run_2m, run, Late([node.handle, session.handle], poll=10), reply_ns=20_000_000)
    assert ends_run(plant.run())
    assert plant.received["frames"]["late"] >= len(NotchCmd.port().can_ids), "more if the machine is busy"


@pytest.mark.parametrize("is_down", [False, True])
def test_a_plant_waits_for_its_own_interface_and_not_for_the_supervisor(run_2m: Scenario, is_down: bool) -> None:
    run = RunSpec(pace="realtime", rate=20.0)
    session = make_session(run_2m, lambda line: None, run)
    controller = ControllerNode(run_2m, LawSpec())
    bus = Interrupted([controller.handle, session.handle], from_poll=10, polls=20, is_down=is_down)
    # Two and a half periods of the poll, 20 ms: fewer than 20 polls, also of a plant that makes up for lost time.
    plant = make_plant_node(run_2m, run, bus, reply_ns=2_000_000, silence_ns=0)
    if is_down:
        assert ends_run(plant.run())
        assert plant.administrator.counters["missed_polls"] >= 20
    else:
        with pytest.raises(PeerSilent, match=r"supervisor silent for 0\.02 s"):
            plant.run()
        assert controller.ended is Event.ENDED_SUPERVISOR_LOST
