"""Two benches on one interface: the second is refused, the first does not notice."""

from __future__ import annotations

import multiprocessing
from pathlib import Path

import pytest

from hil_tests.transport.vcan.bench import run_on, say_into, socketcan
from railhil.bus.link import open_link
from railhil.bus.select import BusChoice
from railhil.common.exit_codes import USAGE, run_guarded
from railhil.live.processes import Nodes
from railhil.live.recorder import open_recorder, refuse_occupied
from railhil.plant_sim.node import make_plant_node
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]


def second_plant(scenario: Scenario) -> int:
    """A bus administrator by itself, as ``railhil node plant``."""
    link = open_link(socketcan(), "plant")
    try:
        make_plant_node(scenario, RunSpec(), link).run()
    finally:
        link.close()
    return 0


def second_run(folder: Path) -> int:
    """What ``railhil run`` does before it starts its nodes."""
    choice = BusChoice(socketcan(), "the test's")
    link = open_recorder(choice, Nodes(folder), lockstep=True)
    try:
        refuse_occupied(link, choice)
    finally:
        link.close()
    return 0


def test_second_bench_is_refused_in_one_line(hop, hop_reference, folder):
    fork = multiprocessing.get_context("fork")
    started = {}

    def start(name: str, main) -> None:
        def process() -> None:
            say_into(folder / f"{name}.second")
            raise SystemExit(run_guarded(name, main))

        started[name] = fork.Process(target=process)
        started[name].start()

    def disturb(time_s: float) -> None:
        if time_s > 2.0 and not started:
            start("plant", lambda: second_plant(hop))
            start("run", lambda: second_run(folder))

    result, exit_codes = run_on(socketcan(), hop, folder, on_progress=disturb)
    for process in started.values():
        process.join(30)
    assert {name: process.exitcode for name, process in started.items()} == {"plant": USAGE, "run": USAGE}
    said = {name: (folder / f"{name}.second").read_text().splitlines() for name in started}
    assert said["plant"] == ["plant: another bus administrator polls on this bus: one bench at a time"]
    assert [line.partition("another bench is running on it")[1] for line in said["run"]] != [""]
    assert len(said["run"]) == 1
    assert (result.line, exit_codes, result.frames_sha256) == ("", [0, 0], hop_reference.frames_sha256)
