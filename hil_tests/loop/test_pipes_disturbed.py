"""Runs over pipes whose processes are stopped or killed at any instant, with a stranger at the pipes: no hang, no
process left, one line that says why."""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import time
from contextlib import ExitStack
from pathlib import Path

import psutil
import pytest

from hil_tests.support.cli import Started, wait_for
from hil_tests.support.operator import pressed
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR
from railhil.record.framelog import read_log
from railhil.run.local import LocalRun, local_plan
from railhil.scenarios.run_spec import RunSpec

pytestmark = [pytest.mark.loop, pytest.mark.faults, pytest.mark.slow]
#: Simulated seconds per second: the run of 24 s takes 0.8 s.
PACE = 30.0
END_S = 10.0


class Disturbed:
    """A run at a pace at which an instant can be met; ``nodes`` are its processes by role."""

    def __init__(self, folder: Path) -> None:
        scenario, desk = folder / "short.toml", folder / "desk"
        scenario.write_text(RUN_72M_TOML, encoding="utf-8")
        self.folder = folder / "run"
        self.log = self.folder / "frames.log"
        self.command = Started("run", scenario, "--operator", desk, "--out", self.folder, "--quiet", "--no-report")
        wait_for(lambda: pressed(desk, {"do": "pace", "pace": PACE}))
        self.nodes = {role: self.command.child(role) for role in ("plant", "controller")}
        self.nodes["supervisor"] = psutil.Process(self.command.process.pid)

    def at(self, size_bytes: int) -> None:
        """Wait until this much is recorded."""
        wait_for(lambda: self.log.stat().st_size > size_bytes)

    def stranger(self, held: ExitStack) -> None:
        """Open the pipes of plant and controller, as another process of this user can, and hold them. (Whoever also
        held their lifelines could delay the end of nodes whose supervisor was killed, until they lose patience.)"""
        for role in ("plant", "controller"):
            process = Path(f"/proc/{self.nodes[role].pid}")
            pipes = [end for end in (process / "fd").iterdir() if os.readlink(end).startswith("pipe:")]
            flags = {end: (process / "fdinfo" / end.name).read_text().split()[3] for end in pipes}
            # Nothing waits at a pipe between the nodes; lifelines are usual ones.
            between = [end for end in pipes if int(flags[end], 8) & os.O_NONBLOCK]
            assert len(between) == {"plant": 4, "controller": 2}[role]
            for end in between:
                held.callback(os.close, os.open(end, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC))

    def gone(self) -> bool:
        """Whether all processes have ended."""
        return not psutil.wait_procs(list(self.nodes.values()), timeout=END_S)[1]


def test_a_plant_that_stands_still_changes_nothing(tmp_path: Path) -> None:
    run = Disturbed(tmp_path)
    run.at(100_000)
    run.nodes["plant"].send_signal(signal.SIGSTOP)
    time.sleep(1.0)
    run.nodes["plant"].send_signal(signal.SIGCONT)
    done, _ = run.command.finish()
    assert done.exit_code in (PASS, FAIL), done.out
    certificate = json.loads((run.folder / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["transport"] == "railhil:pipes"
    spec = RunSpec.from_file(run.folder / "certificate.json")
    same = LocalRun(local_plan(spec.load(), spec, tmp_path))
    same.execute()
    assert same.log.path.read_bytes() == run.log.read_bytes()


@pytest.mark.long_after(1)
@pytest.mark.parametrize("what", ["plant", "controller", "supervisor", "full disk"])
def test_what_dies_at_any_instant_ends_the_run(tmp_path: Path, what: str) -> None:
    """With a stranger that holds both ends of every pipe: a pipe then never looks as if its node had gone."""
    instant = random.Random(what).randrange(0, 400_000)
    run = Disturbed(tmp_path)
    with ExitStack() as held:
        run.at(instant)
        run.stranger(held)
        if what == "full disk":
            limits = (instant + 100_000, resource.RLIM_INFINITY)
            resource.prlimit(run.command.process.pid, resource.RLIMIT_FSIZE, limits)
        else:
            run.nodes[what].kill()
        done, seconds = run.command.finish()
        assert seconds < END_S
        assert run.gone()
    assert list(read_log(run.log)), "the record can be read as far as it got"
    if what == "supervisor":
        assert done.exit_code == -signal.SIGKILL
    elif what == "full disk":
        assert done.exit_code == TOOL_ERROR
        assert done.one_line().endswith("cannot be written: file too large; frames.log is kept as far as it got")
    else:
        assert done.exit_code == INVALID
        lines = [line for line in done.out.splitlines() if f"{what} lost at simulation time" in line]
        assert len(lines) == 1
        assert "killed by SIGKILL" in lines[0]
