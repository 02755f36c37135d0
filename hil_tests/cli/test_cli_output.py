"""What the commands print and leave behind: JSON alone, tables that fit, exit codes that survive a closed pipe."""

from __future__ import annotations

import io
import json
import os
import shlex
import shutil
import subprocess
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import command, railhil
from hil_tests.support.recordings import certified
from hil_tests.support.scores import made_score, with_values
from railhil.audit import __main__ as audit
from railhil.campaign import __main__ as campaign
from railhil.cli.commands import parser
from railhil.cli.result_printer import print_scores, print_verdict
from railhil.common.output import Output
from railhil.common.streams import escape_controls
from railhil.record.framelog import sha256_of
from railhil.scenarios.load import load, short_names
from railhil.tuning import command as tune

_SCORE = made_score("FAIL", 50652.7, 107441.0, -12.0718, 10.1449, 31.143, ("late",))


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
    done = railhil("run", short, "--seed", "1", "--json", "--no-report", "--out", folder)
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


@pytest.mark.slow
@pytest.mark.loop
def test_a_weakened_watch_stands_in_console_report_and_certificate(tmp_path):
    path = tmp_path / "weak.toml"
    path.write_text(QUICK_TOML + "[watch]\nemergency_ms = 100000\noverspeed_margin_kmh = 1e7\n")
    done = railhil("run", path, "--bus", "local", "--out", tmp_path / "run")
    assert done.exit_code in (0, 1), done.err
    words = "emergency_ms 100000 (usual 1000), overspeed_margin_kmh 1e+07 (usual 5)"
    assert [line for line in done.out.splitlines() if line.startswith("watch")] == [f"watch weakened: {words}"]
    assert f"Watch weakened: {words}." in (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert strict_json(tmp_path / "run" / "certificate.json")["watch_weakened"] == words
    assert f"watch weakened: {words}" in railhil("scenarios", path).out
    again = railhil("score", tmp_path / "run")
    assert [line for line in again.out.splitlines() if line.startswith("watch")] == [f"watch weakened: {words}"]
    assert railhil("score", tmp_path / "run", "--json").json["watch_weakened"] == words


@pytest.mark.slow
@pytest.mark.loop
def test_score_of_a_run_that_was_invalid_for_its_timing(json_run, short, tmp_path):
    """The timing does not stand in the log, so the certificate beside it has the last word on validity."""
    folder, document, _ = json_run
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    certified(copy, verdict="INVALID", line="timing: too late")
    done = railhil("score", copy, "--json")
    assert (done.exit_code, done.json["verdict"], done.json["line"]) == (3, "INVALID", "timing: too late")
    assert done.json["scores"] == document["scores"]
    assert railhil("score", copy, "--scenario", short, "--json").json == done.json


@pytest.mark.loop
def test_a_log_that_was_changed_stays_invalid_when_the_scenario_is_named(json_run, short, tmp_path):
    """Two lines swapped: every telegram of it is good."""
    folder, _, _ = json_run
    lines = (folder / "frames.log").read_text().splitlines(keepends=True)
    lines[-2:] = reversed(lines[-2:])
    log = tmp_path / "frames.log"
    log.write_text("".join(lines))
    certified = strict_json(folder / "certificate.json")
    (tmp_path / "certificate.json").write_text(json.dumps(certified | {"verdict": "INVALID", "line": "too late"}))
    done = railhil("score", tmp_path, "--scenario", short, "--json")
    assert (done.exit_code, done.json["verdict"]) == (3, "INVALID")
    other = f"(sha256 {sha256_of(log)}) is not the log that certificate.json beside it is of"
    assert f"frames.log {other} (sha256 {certified['frames_sha256']})" in done.json["line"]
    # Without a certificate nobody says which log it should be.
    (tmp_path / "certificate.json").unlink()
    assert railhil("score", tmp_path, "--scenario", short).exit_code in (0, 1)


@pytest.mark.loop
def test_score_refuses_a_log_that_was_changed(json_run, tmp_path):
    folder, _, _ = json_run
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    lines = (folder / "frames.log").read_text().splitlines(keepends=True)
    (copy / "frames.log").write_text("".join(lines[:-1]))
    done = railhil("score", copy)
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


@pytest.mark.slow
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
    assert done.stderr == "railhil: standard output: no space left on device\n"


def printed(arguments: list[str]) -> str:
    """Standard output of a command in this process."""
    with redirect_stdout(io.StringIO()) as text:
        namespace = parser().parse_args(arguments)
        assert namespace.work(namespace) == 0
    return text.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [["ports"], ["ports", "trn_speed"], ["scenarios"], ["doctor", "--quick"]])
def test_json_output_is_json_and_ascii(arguments):
    text = printed([*arguments, "--json"])
    assert text.isascii()
    assert json.loads(text)


@pytest.mark.slow
def test_timing_that_python_can_prints_does_not_spoil_json():
    timing = ["f_clock=8000000", "tseg1=5", "tseg2=2", "sjw=2", "brp=2", "nof_samples=1"]
    done = railhil("doctor", "--quick", "--json", "-i", "socketcan", "-c", "can0", "--timing", *timing)
    assert done.json["bus"].startswith("socketcan:can0")
    assert "BR: 500_000 bit/s" in done.err


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_score_table_cuts_nothing(monkeypatch, columns, lvshun):
    monkeypatch.setenv("COLUMNS", str(columns))
    label = "ipfc float64 (measured)" if columns > 60 else "from the log"
    other = with_values(_SCORE, energy_kj=107442.0)
    long = "ipfc_plus+1a2b3c4d tuned (on this seed) (measured)"
    with redirect_stdout(io.StringIO()) as text:
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
    ports = printed(["ports"])
    scenarios = printed(["scenarios"])
    assert "…" not in ports + scenarios
    for name in ("TIME_SYNC", "NOTCH_CMD", "SIM_TRUTH", "supervisor"):
        assert name in ports
    table = [line for line in ports.splitlines() if not line.startswith(("DBC", "load"))]
    assert max(len(line) for line in table + scenarios.splitlines()) <= columns
    if columns >= 80:
        assert all(name in scenarios for name in short_names().values())


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
        with redirect_stdout(io.StringIO()) as text:
            print_verdict(Output(), "FAIL", "late")
        assert ("\x1b[1;31m" in text.getvalue()) is coloured
        assert "FAIL: late" in text.getvalue()


def test_text_of_users_is_printed_as_it_is(lvshun):
    """Brackets and colons are markup and emoji for rich; an unknown closing tag would even raise."""
    odd = "[/x] [bold]a[/] :train:"
    row = replace(lvshun.published[0], controller=odd)
    with redirect_stdout(io.StringIO()) as text:
        print_scores(Output(), replace(lvshun, title=odd, published=(row,)), [(odd, _SCORE)])
        print_verdict(Output(), "FAIL", odd)
    assert text.getvalue().count(odd) == 4


#: Clears the screen, sets the window's title, turns what follows round, begins a line of its own.
STEERING = "\x1b[2J\x1b]0;owned\x07 \u202egnorw\u2066 \x9b31m \x7f \r\n"
WRITTEN_OUT = r"\x1b[2J\x1b]0;owned\x07 \u202egnorw\u2066 \x9b31m \x7f"


def test_text_of_files_never_steers_the_terminal(monkeypatch, lvshun, capsys):
    text = io.StringIO()
    monkeypatch.setattr("sys.stdout", text)
    row = replace(lvshun.published[0], controller=STEERING)
    scenario = replace(lvshun, title=STEERING, published=(row,))
    console = Output()
    console.width = 200
    print_scores(console, scenario, [(STEERING, _SCORE)])
    print_verdict(console, "FAIL", STEERING)
    assert text.getvalue().count(WRITTEN_OUT) == 4
    assert set(text.getvalue()) & set(STEERING) <= set("[2J]0;owned gr31m\n")
    with pytest.raises(SystemExit):
        parser().parse_args(["run", "--rate", STEERING])
    assert WRITTEN_OUT in (said := capsys.readouterr().err)
    assert "\x1b" not in said


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Zürich – 北京\u3000南\t\n", "Zürich – 北京\u3000南\t\n"),
        ("\u200d\u200c\u00ad\N{VARIATION SELECTOR-16}", "\u200d\u200c\u00ad\N{VARIATION SELECTOR-16}"),
        ("\u2028\udc80\U000e0041", r"\u2028\udc80\U000e0041"),
    ],
)
def test_writing_of_every_language_stays_as_it_is(text, shown):
    assert escape_controls(text) == shown


def test_errors_in_files_never_steer_the_terminal(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('extends = "lvshun_tieshan"\n[plan]\n"\\u001b[2J\\u202e" = 3\n', encoding="utf-8")
    done = railhil("scenarios", path)
    assert done.exit_code == 2
    assert "plan.?[2J?: unknown key" in done.one_line()


@pytest.mark.slow
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


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["score", "--help"]])
def test_help_names_the_exit_codes(here, arguments):
    done = here(*arguments)
    assert done.exit_code == 0
    for words in ("1    FAIL", "2    usage or bad input", "3    INVALID", "4    TOOL ERROR", "130  stopped by Ctrl-C"):
        assert words in done.out


def test_every_command_with_a_result_has_the_same_json_option():
    programs = [audit.arguments(), campaign.arguments(), tune.arguments()]
    commands = parser()._subparsers._group_actions[0].choices
    found = [commands[name] for name in ("run", "compare", "score", "scenarios", "ports", "doctor")] + programs
    said = {action.help for one in found for action in one._actions if "--json" in action.option_strings}
    assert said == {"print the result as one JSON document, all else to standard error"}
    assert all(one._option_string_actions["--json"].nargs == 0 for one in found)


@pytest.mark.parametrize("words", ["ports", "--help", "run --bus local --no-report --quiet --out {out}"])
def test_closed_output_is_one_line(tmp_path: Path, words: str) -> None:
    given = words.format(out=tmp_path / "run")
    for closed, said in ((">&-", b"railhil: standard output: closed\n"), ("<&- >&- 2>&-", b"")):
        done = subprocess.run(f"{shlex.join(command())} {given} {closed}", shell=True, capture_output=True, check=False)
        assert (done.returncode, done.stderr) == (4, said)
    assert not list(tmp_path.iterdir()), "no run is made whose result nobody can read"


@pytest.mark.long_after(2)
@pytest.mark.parametrize("closed", ["2>&-", "<&- 2>&-"])
@pytest.mark.parametrize("words", ["run {short} --seed 1 --no-report --quiet --out {out}", "score {run}", "nonsense"])
@pytest.mark.slow
def test_a_closed_stream_changes_nothing_but_what_is_printed(
    short: Path, json_run: tuple[Path, Any, str], tmp_path: Path, words: str, closed: str
) -> None:
    """Nor may the log of a run take the number of the stream, to which the nodes print."""
    recorded, score, _ = json_run
    given = words.format(short=short, run=recorded, out=tmp_path / "run")
    done = subprocess.run(f"{shlex.join(command())} {given} {closed}", shell=True, capture_output=True, check=False)
    assert b"Error" not in done.stderr + done.stdout
    assert done.returncode == (2 if words == "nonsense" else int(score["verdict"] == "FAIL"))
    if words.startswith("run"):
        assert sha256_of(tmp_path / "run" / "frames.log") == sha256_of(recorded / "frames.log")
