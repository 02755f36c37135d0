"""What the commands print and leave behind: JSON alone, tables that fit, exit codes that survive a closed pipe."""

from __future__ import annotations

import io
import json
import os
import shlex
import signal
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Done, command, railhil, wait_for
from railhil.bus.ident import Role, make_ident
from railhil.bus.mvb import TelegramSource
from railhil.bus.select import BusChoice
from railhil.bus.telegrams import SimTruth
from railhil.cli.commands import parser
from railhil.cli.show import print_scores, print_verdict
from railhil.common.output import Output
from railhil.dbc import wire_contract
from railhil.scenarios.load import load, names
from railhil.supervisor.folder import RecordFailed, write_folder
from railhil.supervisor.framelog import FrameLog, log_line, read_log
from railhil.supervisor.options import RunOptions
from railhil.supervisor.run import Run
from railhil.supervisor.score import Score
from railhil.supervisor.trace import Trace

_SCORE = Score("FAIL", 50652.7, 107441.0, 12.0718, 10.1449, 31.143, -12.0718, 10.1449, 0.0, ("late",), "complete")


@pytest.fixture(scope="module")
def short(tmp_path_factory) -> Path:
    """A scenario of 8 s."""
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(QUICK_TOML)
    return path


@pytest.fixture(scope="module")
def json_run(short, tmp_path_factory) -> tuple[Path, Any, str]:
    """Folder, parsed standard output and standard error of one run with --json."""
    folder = tmp_path_factory.mktemp("json") / "run"
    done = railhil("run", short, "--seed", "1", "--json", "--out", folder)
    assert done.exit_code in (0, 1), done.err
    return folder, done.json, done.err


def strict_json(path: Path) -> Any:
    """JSON without NaN and infinities, which many readers refuse."""

    def refuse(name: str) -> None:
        raise AssertionError(name)

    return json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


@pytest.mark.slow
@pytest.mark.loop
def test_json_of_a_run_is_its_score_file(json_run):
    folder, document, err = json_run
    assert document == strict_json(folder / "score.json")
    assert [line for line in err.splitlines() if not line.startswith("bus: ")] == []
    assert strict_json(folder / "certificate.json")["verdict"] == document["verdict"]


@pytest.mark.loop
def test_score_of_a_run_that_was_invalid_for_its_timing(json_run, short, tmp_path):
    """The timing does not stand in the log, so the certificate beside it has the last word on validity."""
    folder, document, _ = json_run
    (tmp_path / "frames.log").write_bytes((folder / "frames.log").read_bytes())
    certificate = strict_json(folder / "certificate.json") | {"verdict": "INVALID", "line": "timing: too late"}
    (tmp_path / "certificate.json").write_text(json.dumps(certificate))
    done = railhil("score", tmp_path, "--json")
    assert (done.exit_code, done.json["verdict"], done.json["line"]) == (3, "INVALID", "timing: too late")
    assert done.json["scores"] == document["scores"]
    assert railhil("score", tmp_path, "--scenario", short, "--json").json == done.json


@pytest.mark.loop
def test_a_certificate_of_another_log_says_nothing_about_this_one(json_run, short, tmp_path):
    folder, document, _ = json_run
    (tmp_path / "frames.log").write_bytes((folder / "frames.log").read_bytes())
    certificate = strict_json(folder / "certificate.json")
    other = certificate | {"verdict": "INVALID", "line": "timing: too late", "frames_sha256": "00"}
    (tmp_path / "certificate.json").write_text(json.dumps(other))
    done = railhil("score", tmp_path, "--scenario", short, "--json")
    assert done.json["verdict"] == document["verdict"]
    assert done.exit_code == {"PASS": 0, "FAIL": 1}[document["verdict"]]


@pytest.mark.loop
def test_score_refuses_a_log_that_was_changed(json_run, tmp_path):
    folder, _, _ = json_run
    (tmp_path / "certificate.json").write_bytes((folder / "certificate.json").read_bytes())
    lines = (folder / "frames.log").read_text().splitlines(keepends=True)
    (tmp_path / "frames.log").write_text("".join(lines[:-1]))
    done = railhil("score", tmp_path)
    assert done.exit_code == 2
    assert "frames.log: sha256: found" in done.one_line()


@pytest.mark.slow
@pytest.mark.loop
def test_plot(json_run, tmp_path):
    folder, _, _ = json_run
    for out, words in (("x.gif", "allowed a name that ends in .svg"), ("no/x.svg", "no such file or directory")):
        done = railhil("plot", folder, "--out", tmp_path / out)
        assert done.exit_code == 2
        assert words in done.one_line()
    assert not list(tmp_path.iterdir())
    done = railhil("plot", folder, "--out", tmp_path / "x.svg")
    assert (done.exit_code, done.out) == (0, f"{tmp_path / 'x.svg'}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["x.svg"]


@pytest.mark.loop
def test_reader_that_is_gone_changes_no_exit_code(json_run):
    folder, document, _ = json_run
    expected = 0 if document["verdict"] == "PASS" else 1
    for arguments in (["score", folder], ["score", folder, "--json"]):
        reader, writer = os.pipe()
        os.close(reader)
        done = subprocess.run(
            command(*arguments), stdout=writer, stderr=subprocess.PIPE, text=True, timeout=60, check=False
        )
        os.close(writer)
        assert (done.returncode, done.stderr) == (expected, "")


def test_full_output_is_one_line():
    with open("/dev/full", "w") as full:
        done = subprocess.run(command("ports"), stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.returncode == 4
    assert done.stderr == "railhil: OSError: [Errno 28] No space left on device\n"


def printed(monkeypatch, arguments: list[str]) -> str:
    """Standard output of a command in this process."""
    text = io.StringIO()
    monkeypatch.setattr("sys.stdout", text)
    namespace = parser().parse_args(arguments)
    assert namespace.work(namespace) == 0
    return text.getvalue()


@pytest.mark.parametrize("arguments", [["ports"], ["ports", "trn_speed"], ["scenarios"], ["doctor", "--quick"]])
def test_json_output_is_json_and_ascii(monkeypatch, arguments):
    text = printed(monkeypatch, [*arguments, "--json"])
    assert text.isascii()
    assert json.loads(text)


def test_timing_that_python_can_prints_does_not_spoil_json():
    timing = ["f_clock=8000000", "tseg1=5", "tseg2=2", "sjw=2", "brp=2", "nof_samples=1"]
    done = railhil("doctor", "--quick", "--json", "-i", "socketcan", "-c", "can0", "--timing", *timing)
    assert done.json["bus"].startswith("socketcan:can0")
    assert "BR: 500_000 bit/s" in done.err


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_score_table_cuts_nothing(monkeypatch, columns, lvshun):
    monkeypatch.setenv("COLUMNS", str(columns))
    text = io.StringIO()
    monkeypatch.setattr("sys.stdout", text)
    label = "ipfc float64 (measured)" if columns > 60 else "from the log"
    other = replace(_SCORE, energy_kj=107442.0)
    long = "ipfc_plus+1a2b3c4d tuned (on this seed) (measured)"
    print_scores(Output(), lvshun, [(label, _SCORE), (long, other)])
    lines = text.getvalue().splitlines()
    table = lines[1:]
    assert max(map(len, table)) <= columns
    assert "…" not in text.getvalue()
    assert "\x1b" not in text.getvalue()
    for row in lvshun.published:
        assert any(line.startswith(f"{row.controller} (published) ") for line in lines)
    # Numbers end where the unit above them ends.
    units = next(line for line in table if "m/s2/km" in line)
    measured = next(line for line in table if "107441" in line)
    for unit, number in (("km/h s2", "50652.7"), ("kJ", "107441"), ("error m", "10.1449"), ("m/s2/km", "31.143")):
        assert units.index(unit) + len(unit) == measured.index(number) + len(number)
    assert all(word in text.getvalue() for word in long.split())


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_names_are_never_cut(monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    ports = printed(monkeypatch, ["ports"])
    scenarios = printed(monkeypatch, ["scenarios"])
    assert "…" not in ports + scenarios
    for name in ("TIME_SYNC", "NOTCH_CMD", "SIM_TRUTH", "supervisor"):
        assert name in ports
    table = [line for line in ports.splitlines() if not line.startswith(("DBC", "load"))]
    assert max(len(line) for line in table + scenarios.splitlines()) <= columns
    if columns >= 80:
        assert all(name in scenarios for name in names())


def test_no_colour_where_none_is_wanted(monkeypatch):
    """FORCE_COLOR stands for a terminal here; a file or pipe has neither."""
    monkeypatch.setenv("TERM", "xterm-256color")
    for environment, coloured in (
        ({"FORCE_COLOR": "1"}, True),
        ({"NO_COLOR": "1"}, False),
        ({"FORCE_COLOR": ""}, False),
    ):
        for key, value in environment.items():
            monkeypatch.setenv(key, value)
        text = io.StringIO()
        monkeypatch.setattr("sys.stdout", text)
        print_verdict(Output(), "FAIL", "late")
        assert ("\x1b[1;31m" in text.getvalue()) is coloured
        assert "FAIL: late" in text.getvalue()


def test_text_of_users_is_printed_as_it_is(monkeypatch, lvshun):
    """Brackets and colons are markup and emoji for rich; an unknown closing tag would even raise."""
    text = io.StringIO()
    monkeypatch.setattr("sys.stdout", text)
    odd = "[/x] [bold]a[/] :train:"
    row = replace(lvshun.published[0], controller=odd)
    print_scores(Output(), replace(lvshun, title=odd, published=(row,)), [(odd, _SCORE)])
    print_verdict(Output(), "FAIL", odd)
    assert text.getvalue().count(odd) == 4


def test_a_terminal_without_the_characters_gets_question_marks(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('extends = "lvshun_tieshan"\nname = "mine"\ntitle = "Zürich – Bern"\n', encoding="utf-8")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        command("scenarios", path), env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "Z?rich" in done.stdout
    assert load(path).title == "Zürich – Bern"


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["score", "--help"], ["node", "plant", "--help"]])
def test_help_names_the_exit_codes(arguments):
    done = railhil(*arguments)
    assert done.exit_code == 0
    for words in ("1    FAIL", "2    usage or bad input", "3    INVALID", "4    TOOL ERROR", "130  stopped by Ctrl-C"):
        assert words in done.out


# -- a run that does not come to its end ------------------------------------------------------------------------------


def interruptible() -> None:
    """A job that was started in the background ignores Ctrl-C, and so would what it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.parametrize(("number", "whole_group"), [(signal.SIGINT, True), (signal.SIGTERM, False)])
def test_stopped_run_keeps_its_log_and_is_invalid(tmp_path, number, whole_group):
    """Ctrl-C reaches every process of the terminal at once, SIGTERM only the one it is sent to."""
    folder = tmp_path / "run"
    process = subprocess.Popen(
        command("run", "--pace", "realtime", "--rate", "20", "--out", folder),
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
    assert "stopped by" in suite.find("testcase/failure").get("message")
    assert len(list(read_log(folder / "frames.log"))) == score["run"]["frames"]
    assert railhil("score", folder).exit_code == 3


@pytest.mark.loop
def test_log_that_cannot_grow(tmp_path):
    """A limit on the file's size stands for a full disk: the log is kept, and nothing looks like a result."""
    folder = tmp_path / "run"
    limited = f"ulimit -f 300; exec {shlex.join(command('run', '--out', folder))}"
    done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, timeout=60, check=False)
    line = Done(done.returncode, done.stdout, done.stderr).one_line()
    assert done.returncode == 4
    assert f"run folder {folder} cannot be written: file too large; frames.log is kept" in line
    assert (folder / "frames.log").stat().st_size == 300 * 1024
    assert {path.suffix for path in folder.iterdir()} == {".log", ".txt"}


def test_folder_that_is_full_after_the_run_holds_the_log_alone(monkeypatch, tmp_path, lvshun):
    choice = BusChoice({"interface": "railhil", "channel": "c"}, "test")
    run = Run(lvshun, RunOptions("lvshun_tieshan"), choice, tmp_path)
    log = FrameLog(tmp_path)
    ident = make_ident(Role.PLANT, lvshun.sha256)
    for frame in TelegramSource(wire_contract().port(ident.PORT), False).frames(ident.encode()):
        log.write(log_line(0, frame))
    result = run._result(0, log.close(), {}, "a reason", False)
    trace = Trace()
    trace.add(SimTruth.PORT, 0, SimTruth().encode())
    write_folder(tmp_path, lvshun, run.options, result, trace, [])
    kept = sorted(path.name for path in tmp_path.iterdir())
    assert kept == ["certificate.json", "frames.blf", "frames.log", "junit.xml", "score.json", "signals.csv"]

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("railhil.supervisor.folder.certificate", full)
    with pytest.raises(RecordFailed, match="cannot be written: no space left on device") as caught:
        write_folder(tmp_path, lvshun, run.options, result, trace, [])
    assert caught.value.exit_code == 4
    assert [path.name for path in tmp_path.iterdir()] == ["frames.log"]
