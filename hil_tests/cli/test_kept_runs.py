"""What is kept of an incomplete run: stopped, terminal closed, disk full."""

from __future__ import annotations

import json
import os
import pty
import re
import shlex
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Done, command, railhil, wait_for
from railhil.bus.ident import Role, make_ident
from railhil.bus.mvb import TelegramSource
from railhil.bus.select import BusChoice
from railhil.dbc import wire_contract
from railhil.judge.folder import RecordFailed, write_folder
from railhil.record.framelog import FrameLog, log_line, read_log
from railhil.record.trace import Trace
from railhil.run.bus_run import BusRun
from railhil.run.conclusion import result_of
from railhil.run.run import Plan
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import SimTruth


def interruptible() -> None:
    """A job that was started in the background ignores Ctrl-C, and so would what it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.parametrize(
    ("number", "whole_group"),
    [(signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGHUP, False)],
)
def test_stopped_run_keeps_its_log_and_is_invalid(tmp_path, socket_folder, monkeypatch, number, whole_group):
    """Ctrl-C and a terminal that is gone reach every process of it at once, SIGTERM only the one it is sent to."""
    monkeypatch.setenv("TMPDIR", str(socket_folder))
    folder = tmp_path / "run"
    # One of them has a report too.
    words = () if number is signal.SIGINT else ("--no-report",)
    process = subprocess.Popen(
        command("run", "--pace", "realtime", "--rate", "20", *words, "--out", folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=interruptible,
    )
    wait_for(lambda: (folder / "frames.log").stat().st_size > 100_000)
    (os.killpg if whole_group else os.kill)(process.pid, number)
    out, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (128 + number, "")
    assert f"INVALID: stopped by {number.name} at simulation time " in out
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)
    score, certificate = (json.loads((folder / name).read_text()) for name in ("score.json", "certificate.json"))
    assert score["verdict"] == certificate["verdict"] == "INVALID"
    assert set(score["scores"].values()) == {None}
    assert set(score["signed"]) == {"time_error_s", "stop_error_m"}
    suite = ET.parse(folder / "junit.xml").getroot()
    assert "stopped by" in suite.find("testcase/error").get("message")
    assert (suite.get("failures"), suite.get("errors"), suite.find(".//failure")) == ("0", "1", None)
    properties = {found.get("name"): found.get("value") for found in suite.findall("properties/property")}
    assert (properties["verdict"], properties["frames_sha256"]) == ("INVALID", certificate["frames_sha256"])
    assert json.loads((folder / "telemetry.json").read_text())["steps"] > 0
    assert not list(socket_folder.iterdir())
    assert len(list(read_log(folder / "frames.log"))) == score["run"]["frames"]
    assert railhil("score", folder).exit_code == 3


#: Sends Ctrl-C twice from within the writing of the results, as a terminal does: to whoever writes, and to the command.
INTERRUPTED = """
import os, signal, sys
import railhil.judge.folder
from railhil.cli import main
written, command = railhil.judge.folder.write_blf, os.getpid()
def ctrl_c():
    for process in {command, os.getpid()}:
        os.kill(process, signal.SIGINT)
def interrupted(log, out):
    ctrl_c()
    written(log, out)
    ctrl_c()
railhil.judge.folder.write_blf = interrupted
sys.exit(main())
"""


@pytest.mark.slow
@pytest.mark.loop
def test_ctrl_c_while_results_are_written_waits_until_they_are_whole(tmp_path):
    (tmp_path / "short.toml").write_text(QUICK_TOML)
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, "run", "short.toml", "--no-report", "--out", "run"],
        capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (130, "")
    assert {path.name for path in (tmp_path / "run").iterdir()} == {
        "frames.log", "frames.blf", "signals.csv", "events.csv", "score.json", "junit.xml", "certificate.json",
        "scenario.json", "ports.toml", "railhil.dbc", "telemetry.json", "plant.txt", "controller.txt", "SHA256SUMS",
    }  # fmt: skip
    assert railhil("score", "run", cwd=tmp_path).exit_code in (0, 1)


@pytest.mark.slow
@pytest.mark.loop
def test_run_whose_terminal_is_gone_is_recorded(tmp_path):
    """The progress bar and the verdict find no terminal any more; SIGHUP reaches every process of the run."""
    folder = tmp_path / "run"
    child, terminal = pty.fork()
    if child == 0:
        words = ("--pace", "realtime", "--rate", "20", "--no-report", "--out", folder)
        os.execv(sys.executable, command("run", *words))
    wait_for(lambda: (folder / "frames.log").stat().st_size > 100_000)
    os.close(terminal)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 129
    with pytest.raises(ProcessLookupError):
        os.killpg(child, 0)
    score, certificate = (json.loads((folder / name).read_text()) for name in ("score.json", "certificate.json"))
    assert score["verdict"] == certificate["verdict"] == "INVALID"
    assert "stopped by SIGHUP" in certificate["line"]
    assert json.loads((folder / "telemetry.json").read_text())["steps"] > 0


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_run_that_ignores_sighup_goes_on_without_its_terminal(tmp_path):
    folder = tmp_path / "run"
    (tmp_path / "short.toml").write_text(QUICK_TOML)
    child, terminal = pty.fork()
    if child == 0:
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        words = (tmp_path / "short.toml", "--pace", "realtime", "--rate", "5", "--no-report", "--out", folder)
        os.execv(sys.executable, command("run", *words))
    wait_for(lambda: (folder / "frames.log").is_file() and (folder / "frames.log").stat().st_size > 1000)
    os.close(terminal)
    _, status = os.waitpid(child, 0)
    score = json.loads((folder / "score.json").read_text())
    assert os.waitstatus_to_exitcode(status) in (0, 1, 3)
    assert score["ended"] == "ended_complete"


def on_small_disk(disk: Path, size_kib: int, *words: str | Path) -> Done:
    """A command with so much room in a folder: on a disk of its own where a user may mount one, else by a limit on the
    size of each file. What the folder holds is copied into ``kept`` beside it."""
    disk.mkdir()
    keep = f"cp -r {shlex.quote(str(disk))} {shlex.quote(str(disk.with_name('kept')))}"
    mounted = ["unshare", "--mount", "bash", "-c"]
    kept = f"code=$?; {keep}; exit $code"
    tmpfs = f"mount -t tmpfs -o size={size_kib}k none {shlex.quote(str(disk))}"
    if subprocess.run([*mounted, tmpfs], capture_output=True, check=False).returncode == 0:
        done = subprocess.run(
            [*mounted, f"{tmpfs}; {shlex.join(map(str, words))}; {kept}"],
            capture_output=True,
            text=True,
            timeout=90,
            check=False,
        )
    else:
        limited = f"(ulimit -f {size_kib}; {shlex.join(map(str, words))}); {kept}"
        done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, timeout=90, check=False)
    return Done(done.returncode, done.stdout, done.stderr)


@pytest.mark.slow
@pytest.mark.loop
def test_disk_that_is_full_in_the_run(tmp_path):
    """The log is kept up to its last whole line, and nothing looks like a result."""
    folder = tmp_path / "disk" / "run"
    done = on_small_disk(tmp_path / "disk", 512, *command("run", "--out", folder))
    line = done.one_line()
    assert done.exit_code == 4
    assert line.startswith(f"railhil: run folder {folder} cannot be written: ")
    assert re.search(r": (file too large|no space left on device); frames.log is kept as far as it got$", line)
    kept = tmp_path / "kept" / "run"
    assert len(list(read_log(kept / "frames.log"))) > 1000
    assert {path.suffix for path in kept.iterdir()} <= {".log", ".txt", ".json", ".toml", ".dbc"}
    assert not {"certificate.json", "score.json"} & {path.name for path in kept.iterdir()}


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("size_kib", [4, 100])
def test_disk_without_room_for_a_run(tmp_path, size_kib):
    folder = tmp_path / "disk" / "run"
    done = on_small_disk(tmp_path / "disk", size_kib, *command("run", "--out", folder))
    assert done.exit_code == 4
    said = rf"railhil: {folder} cannot be written: (file too large|no space left on device)"
    assert re.fullmatch(said, done.one_line())
    assert not list((tmp_path / "kept").iterdir())


def test_folder_that_is_full_after_the_run_holds_the_log_alone(monkeypatch, tmp_path, lvshun):
    choice = BusChoice({"interface": "railhil", "channel": "c"}, "test")
    run = BusRun(Plan(RunSpec(), lvshun, choice, tmp_path))
    log = FrameLog(tmp_path)
    ident = make_ident(Role.PLANT, lvshun.sha256, contract=wire_contract())
    for frame in TelegramSource(wire_contract().port(ident.PORT), False).frames(ident.encode()):
        log.write(log_line(0, frame))
    result = result_of(run, log.close(), {}, "a reason", False, [])
    result.trace = Trace(wire_contract())
    result.trace.add(SimTruth.PORT, 0, SimTruth().encode())
    write_folder(result)
    kept = sorted(path.name for path in tmp_path.iterdir())
    results = ["frames.blf", "frames.log", "junit.xml", "score.json", "signals.csv"]
    assert kept == ["SHA256SUMS", "certificate.json", "events.csv", *results]

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "telemetry.json").touch()
    monkeypatch.setattr("railhil.judge.folder.certificate", full)
    with pytest.raises(RecordFailed, match="cannot be written: no space left on device") as caught:
        write_folder(result)
    assert caught.value.exit_code == 4
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frames.log", "telemetry.json"]
