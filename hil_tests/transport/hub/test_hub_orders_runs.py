"""The bench on a hub that is ordered to disturb it: three nodes in threads of this process, orders from the plant."""

from __future__ import annotations

import contextlib
import hashlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.hub import PATIENCE_S, HubProcess, running_hub
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.codes import Event
from railhil.bus.errors import PeerSilent
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.disturbances import Order
from railhil.bus.hub.link import BatchLink
from railhil.bus.link import Link
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.process_loop import serve
from railhil.dbc import wire_contract
from railhil.plant_sim.node import PlantNode, make_plant_node
from railhil.record.framelog import FrameLog, read_log
from railhil.record.session import Session, make_session
from railhil.record.trace import Trace, trace_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, SimTruth

pytestmark = [pytest.mark.loop, pytest.mark.faults]

#: Orders by the tick before which the plant gives them.
Orders = dict[int, list[Order]]
_LOCKSTEP = RunSpec()


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """A run of 2 m in 4 s."""
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    return load(path)


@pytest.fixture(scope="module")
def hub() -> Iterator[HubProcess]:
    with running_hub("--faults") as hub:
        yield hub


class Bench:
    """One run: plant in this thread, the others in their own; ``counters`` of each link, ``trace`` of the record."""

    def __init__(
        self, hub: HubProcess, scenario: Scenario, folder: Path, orders: Orders, spec: RunSpec = _LOCKSTEP
    ) -> None:
        folder.mkdir(exist_ok=True)
        log = FrameLog(folder)
        session = make_session(scenario, log.write, spec)
        controller = ControllerNode(scenario, LawSpec())
        with contextlib.ExitStack() as stack:
            links = {role: BatchLink(hub.bus(role=role)) for role in ("controller", "supervisor", "plant")}
            for link in links.values():
                stack.callback(link.close)
            plant = make_plant_node(scenario, spec, links["plant"])
            _order_before_ticks(plant, links["plant"].bus, orders)  # type: ignore[arg-type]

            def control() -> None:
                try:
                    serve(controller, links["controller"])
                except PeerSilent as silence:
                    self.said = str(silence)

            threads = [
                threading.Thread(target=control),
                threading.Thread(target=_record, args=(session, links["supervisor"])),
            ]
            links["supervisor"].lossless = not spec.is_realtime
            for thread in threads:
                thread.start()
            self.said = ""
            self.event = plant.run()
            links["plant"].close()
            for thread in threads:
                thread.join(PATIENCE_S)
                assert not thread.is_alive()
            self.counters = {role: link.counters for role, link in links.items()}
            self.missed_polls = plant.counters.get("missed_polls", 0)
        log.close()
        self.sha256 = hashlib.sha256(log.path.read_bytes()).hexdigest()
        self.trace: Trace = trace_of(read_log(log.path), wire_contract())


def _order_before_ticks(plant: PlantNode, bus: HubBus, orders: Orders) -> None:
    begin: Callable[[], None] = plant.begin

    def ordering() -> None:
        for order in orders.get(plant.plant.tick, ()):
            bus.order(order)
        begin()

    plant.begin = ordering  # type: ignore[method-assign]


def _record(session: Session, link: Link) -> None:
    while session.ended is None:
        for frame in link.receive(1.0):
            if answers := session.handle(frame):
                link.send(answers)


def longest_silence_s(trace: Trace, port: Any) -> float:
    return float(np.diff(trace.times_s(port.PORT)).max())


def test_without_an_order_the_bytes_are_those_of_any_bus(hub, scenario, tmp_path) -> None:
    bench = Bench(hub, scenario, tmp_path / "hub", {})
    assert bench.sha256 == local_run(scenario, tmp_path, RunSpec()).frames_sha256
    assert bench.missed_polls == 0


#: B1 to B4, B7: what is ordered, and the longest time without a notch that follows from it, in s.
CATALOGUE: dict[str, tuple[Orders, float]] = {
    "B1 errors": ({100: [Order("errors", "controller", count=5)]}, 0.02),
    "B2 passive": ({100: [Order("errors", "controller", count=20)]}, 0.02),
    "B3 off and back": ({100: [Order("bus_off", "controller")], 130: [Order("restart", "controller")]}, 0.32),
    "B5 full": ({100: [Order("full", "controller")], 110: [Order("full", "controller", on=False)]}, 0.12),
    "B7 line A": ({100: [Order("line", "plant", line="A")]}, 0.02),
}


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("name", CATALOGUE)
def test_time_goes_on_in_lockstep_and_the_record_is_the_same_each_time(hub, scenario, tmp_path, name) -> None:
    orders, silence_s = CATALOGUE[name]
    bench = Bench(hub, scenario, tmp_path / "once", orders)
    assert Bench(hub, scenario, tmp_path / "again", orders).sha256 == bench.sha256
    assert longest_silence_s(bench.trace, NotchCmd) == pytest.approx(silence_s)
    assert longest_silence_s(bench.trace, SimTruth) == pytest.approx(0.02), "the train goes on"
    assert (bench.missed_polls > 0) is (silence_s > 0.02)
    traction_n = bench.trace.values(SimTruth.PORT, "TractionForce")
    silent = (bench.trace.times_s(SimTruth.PORT) > 1.12) & (bench.trace.times_s(SimTruth.PORT) < 1.0 + silence_s)
    assert not traction_n[silent].any(), "cut by the train's own watch"


def test_a_controller_that_stays_off_is_stopped_by_the_train(hub, scenario, tmp_path) -> None:
    """B4: latched."""
    bench = Bench(hub, scenario, tmp_path, {100: [Order("bus_off", "controller")]})
    assert bench.event is Event.ENDED_CONTROLLER_LOST
    assert bench.trace.values(SimTruth.PORT, "TrueSpeed")[-1] == 0
    assert bench.said == "controller waits for the bus administrator, which has ended"
    assert bench.counters["controller"]["bus_off"] == 1
    assert bench.trace.times_s(NotchCmd.PORT)[-1] <= 1.0


@pytest.mark.wall_clock
def test_in_real_time_the_train_cuts_traction_and_nothing_stale_comes_later(hub, scenario, tmp_path) -> None:
    """B3, then B5."""
    orders = {tick + start: found for start, name in ((0, "B3 off and back"), (90, "B5 full"))
              for tick, found in CATALOGUE[name][0].items()}  # fmt: skip
    bench = Bench(hub, scenario, tmp_path, orders, RunSpec(pace="realtime", rate=2))
    times_s, truth_s = bench.trace.times_s(NotchCmd.PORT), bench.trace.times_s(SimTruth.PORT)
    for begin_s, end_s in ((1.0, 1.3), (1.9, 2.0)):
        assert not len(times_s[(times_s > begin_s) & (times_s < end_s - 0.03)])
        after = (times_s > end_s) & (times_s < end_s + 0.5)
        assert len(times_s[after]) > 10, "it takes part again"
        # The next answer is a new one: no backlog.
        assert set(np.diff(bench.trace.raw(NotchCmd.PORT, "NotchLife")[after]) % 16) <= {1, 2, 3}
    cut = (truth_s > 1.14) & (truth_s < 1.3)
    assert not bench.trace.values(SimTruth.PORT, "TractionForce")[cut].any()
    counters = bench.counters["controller"]
    assert (counters["bus_off"], counters["outages"], counters["send_dropped"] > 0) == (1, 1, True)
