"""A run begins when its panel can be opened; a panel that hangs or ends does not hold it up."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from railhil.bus.select import own_pipes
from railhil.cli import panel as cli
from railhil.common.errors import InputError
from railhil.live.sockets import PanelSocket
from railhil.panel.command import arguments
from railhil.panel.operator import Operator
from railhil.run.run import Plan
from railhil.run.spec import with_requirements
from railhil.scenarios.run_spec import RunSpec


@contextmanager
def _beside(folder: Path, port: int) -> Iterator[Any]:
    """A lockstep run over pipes with a panel at this port."""
    spec = RunSpec("lvshun_tieshan")
    beginning = Plan(spec, spec.load(), own_pipes(), folder)
    with cli.PanelBeside(port, None, None) as page, page.beside(beginning) as plan:
        yield plan


@pytest.mark.slow
def test_the_page_can_be_opened_when_the_run_begins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")
    # On a busy machine a panel takes longer to start than a run waits for it.
    monkeypatch.setattr(cli, "_READY_S", 60.0)
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with _beside(tmp_path, port), socket.create_connection(("127.0.0.1", port), 1.0):
        pass


@pytest.mark.slow
def test_a_panel_whose_port_is_taken_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")
    monkeypatch.setattr(cli, "_READY_S", 3600.0)
    with socket.create_server(("127.0.0.1", 0)) as taken, _beside(tmp_path, taken.getsockname()[1]) as plan:
        assert not plan.panel.is_greeted(0.0)


def test_a_panel_that_hangs_is_waited_for_so_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "_READY_S", 0.3)
    words = [sys.executable, "-c", "import time; time.sleep(3600)"]
    with PanelSocket(tmp_path / "desk") as desk, subprocess.Popen(words) as process:
        began_s = time.monotonic()
        cli._wait_until_shown(process, desk)
        process.kill()
    assert time.monotonic() - began_s >= 0.3


def test_commands_that_come_with_the_greeting_are_kept(tmp_path: Path) -> None:
    with PanelSocket(tmp_path / "desk") as desk:
        operator = Operator(str(tmp_path / "desk"))
        operator.report = {"phase": "waiting"}
        assert not operator.execute({"do": "pause"})
        operator.greet()
        assert desk.is_greeted(1.0)
        assert desk.is_greeted(0.0)
        assert desk.take(0.0) == [{"do": "pause"}]
        assert desk.take(0.0) == []


def test_a_panel_that_only_greeted_is_told_nothing_and_told_all_once_it_looks(tmp_path: Path) -> None:
    with PanelSocket(tmp_path / "desk") as desk:
        operator = Operator(str(tmp_path / "desk"))
        operator.greet()
        assert desk.is_greeted(1.0)
        # More than the queue of a socket holds.
        for number in range(50):
            desk.tell({"phase": "running", "number": number})
        operator.look()
        desk.take(1.0)
        operator.look()
        assert operator.report == {"phase": "running", "number": 49}
        operator.close()


def test_the_panel_beside_a_run_judges_by_the_sentences_of_the_run(tmp_path: Path) -> None:
    files = [tmp_path / "one.toml", tmp_path / "two.toml"]
    for number, path in enumerate(files):
        path.write_text(f'[[requirement]]\nid = "A-{number}"\nsays = "never true_speed < 0 km/h"\n', encoding="utf-8")
    spec = with_requirements(RunSpec("lvshun_tieshan"), [*files, "ato"])
    words = cli.PanelBeside(0, None, None)._words(Plan(spec, spec.load(), own_pipes(), tmp_path), tmp_path / "desk")
    assert arguments().parse_args(words).requirements == [*map(str, files), "ato"]


def test_a_report_with_all_faults_of_a_long_list_arrives(tmp_path: Path) -> None:
    faults = [f"TRN_SPEED loss {number % 100}% @manual for 5s expect 'the train stops'" for number in range(255)]
    with PanelSocket(tmp_path / "desk") as desk:
        operator = Operator(str(tmp_path / "desk"))
        operator.greet()
        desk.tell({"phase": "ended", "faults": faults, "rerun": " ".join(faults)})
        operator.look()
        desk.take(1.0)
        operator.look()
        assert operator.report["faults"] == faults
        operator.close()


def test_a_run_does_not_wait_for_the_start_button_of_a_page_that_has_ended(tmp_path: Path) -> None:
    spec = RunSpec("lvshun_tieshan")
    plan = Plan(spec, spec.load(), own_pipes(), tmp_path)
    with PanelSocket(tmp_path / "desk") as desk, subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
        with pytest.raises(InputError, match="--wait: a panel that has ended, expected one on which Start is pressed"):
            cli._wait_for_start(desk, plan, process)
