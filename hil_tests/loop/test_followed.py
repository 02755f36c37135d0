"""A run in lockstep with a panel needs no hub, and a panel that hangs or dies changes nothing in it."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path
from typing import Any

import psutil
import pytest

from hil_tests.support.cli import Started, wait_for
from hil_tests.support.operator import pressed
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.codes import SupCommand
from railhil.bus.frame import Frame
from railhil.bus.telegrams import SupCmd
from railhil.common.exit_codes import FAIL, PASS
from railhil.dbc import wire_contract
from railhil.panel.receiver import LogFollower
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.run.local import LocalRun, local_plan
from railhil.scenarios.run_spec import RunSpec

pytestmark = [pytest.mark.loop, pytest.mark.slow]


def panel_of(command: Started) -> psutil.Process | None:
    """The panel beside a run, as soon as it is that."""
    children = psutil.Process(command.process.pid).children()
    return next((child for child in children if "railhil.panel" in child.cmdline()), None)


@pytest.mark.long_after(1)
@pytest.mark.parametrize("how", [signal.SIGSTOP, signal.SIGKILL], ids=["stopped", "killed"])
def test_a_panel_that_is_gone_changes_nothing(tmp_path: Path, how: signal.Signals) -> None:
    """Pause and start come from another hand; what was recorded until the pause can be followed."""
    pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")
    scenario, folder, desk = tmp_path / "short.toml", tmp_path / "run", tmp_path / "desk"
    scenario.write_text(RUN_2M_TOML, encoding="utf-8")
    run = Started(
        "run", scenario, "--panel", "0", "--operator", desk, "--out", folder, "--quiet", "--no-report"
    )  # fmt: skip
    # It is taken at the second SUP_CMD, so the run cannot be over before.
    wait_for(lambda: pressed(desk, {"do": "pause"}))
    panel: Any = wait_for(lambda: panel_of(run))
    # Less important than the run.
    wait_for(lambda: panel.nice() > 0)
    ours = os.sched_getaffinity(0)
    wait_for(lambda: len(ours) == 1 or set(panel.cpu_affinity()) != ours)
    processors = set(panel.cpu_affinity())
    panel.send_signal(how)
    followed = LogFollower(wait_for(lambda: (folder / "frames.log").exists() and folder))
    heard: list[Frame] = []

    def has_paused() -> bool:
        heard.extend(followed.receive())
        said = [frame for frame in heard if frame.can_id == 0x108]
        return len(said) >= 2

    wait_for(has_paused)
    assert not any(child.name() == "railhil hub" for child in psutil.Process(run.process.pid).children())
    if len(ours) > 1:
        assert not processors & set(run.child("plant").cpu_affinity()), "in lockstep the nodes have one for themselves"
    assert pressed(desk, {"do": "start"})
    done, _ = run.finish()
    assert done.exit_code in (PASS, FAIL), done.err
    assert not panel.is_running()
    certificate = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["transport"] == "railhil:pipes"
    frames = [frame for _, frame in read_log(folder / "frames.log")]
    heard += followed.receive()
    assert heard == frames
    commands = trace_of(read_log(folder / "frames.log"), wire_contract()).raw(SupCmd.PORT, "SupCommand").tolist()
    assert commands[1] == SupCommand.NONE
    # Orders by hand make the same run again.
    spec = RunSpec.from_file(folder / "certificate.json")
    assert spec.orders
    again = LocalRun(local_plan(spec.load(), spec, tmp_path))
    again.execute()
    assert again.log.path.read_bytes() == (folder / "frames.log").read_bytes()
