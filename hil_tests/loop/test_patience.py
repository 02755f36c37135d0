"""Which nodes lockstep waits for, and for how long."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from hil_tests.support.cli import railhil, wait_for
from railhil.bus.errors import PeerSilent
from railhil.common.patience import LATER_S, Lifelines
from railhil.controller_node import process_loop as serve_module
from railhil.controller_node.process_loop import serve
from railhil.live.processes import Nodes

_PROGRAM = "import time; time.sleep(600)"


def test_a_lifeline_ends_with_its_process(tmp_path: Path) -> None:
    """However it ends, at once, and never before; of a node without one nothing is known."""
    reading, writing = os.pipe()
    process = subprocess.Popen([sys.executable, "-c", _PROGRAM], pass_fds=[writing])
    os.close(writing)
    lifelines = Lifelines({"controller": reading})
    try:
        assert not lifelines.has_ended("controller")
        process.send_signal(signal.SIGSTOP)
        assert not lifelines.has_ended("controller")
        process.kill()
        wait_for(lambda: lifelines.has_ended("controller"))
        assert not lifelines.has_ended("supervisor")
    finally:
        process.kill()
        process.wait()
        os.close(reading)


def test_no_descriptor_of_a_lifeline_is_left_open(tmp_path: Path) -> None:
    """A writing end that somebody else keeps would make a dead node look alive."""
    before = set(os.listdir("/proc/self/fd"))
    with Nodes(tmp_path) as nodes:
        nodes.start("plant", "this", [], watches=["supervisor", "controller"])
        assert len(set(os.listdir("/proc/self/fd")) - before) == 2
        nodes.start("controller", "this", [])
        assert len(set(os.listdir("/proc/self/fd")) - before) == 1
    assert set(os.listdir("/proc/self/fd")) == before


@pytest.mark.slow
def test_a_lifeline_that_is_none_is_one_line() -> None:
    for words in ("controller=99999", "controller", "controller=x"):
        done = railhil("node", "plant", "--lifeline", words)
        assert done.exit_code == 2
        assert f"found {words}, allowed NODE=DESCRIPTOR of an open file" in done.one_line()


@pytest.mark.parametrize(
    ("lockstep", "heard", "limit_s"), [(True, True, 60 + LATER_S), (False, True, 3), (True, False, 7)]
)
def test_a_controller_waits_as_long_as_the_bus_administrator_may(
    monkeypatch: pytest.MonkeyPatch, lockstep: bool, heard: bool, limit_s: float
) -> None:
    """Which waits for another node in lockstep; before the first frame it has a time of its own."""
    clock = SimpleNamespace(now_s=0.0)
    monkeypatch.setattr(serve_module, "time", SimpleNamespace(monotonic=lambda: clock.now_s))
    frames = [["a frame"]] if heard else []

    def receive(timeout_s: float) -> list[str]:
        clock.now_s += timeout_s
        return frames.pop() if frames else []

    link = SimpleNamespace(receive=receive, take_gap_ns=lambda: 0, is_down=False, has_ended=lambda node: False)
    node = SimpleNamespace(ended=None, handle=lambda frame: [], lockstep=lockstep)
    with pytest.raises(PeerSilent, match=f"no frame for {limit_s:g} s"):
        serve(node, link, appear_s=7.0)  # type: ignore[arg-type]
    assert limit_s < clock.now_s <= limit_s + 1.5
