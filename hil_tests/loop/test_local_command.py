"""``railhil run --bus local``: all nodes in one process, the record of a run over a bus."""

from __future__ import annotations

import hashlib
import json
import os
import re
import signal
from pathlib import Path
from typing import Any

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Railhil, Started, railhil, wait_for
from hil_tests.support.paths import ROOT
from hil_tests.support.plug import Wrapping, plug_in
from hil_tests.support.published import PUBLISHED_SHA256, PUBLISHED_WIRE_5_SHA256, WIRE_5_HASH
from hil_tests.support.wire_5 import as_wire_5
from railhil.bus.transports import limits, limits_of
from railhil.common.exit_codes import FAIL, INVALID, PASS, USAGE
from railhil.controller_node.ato.laws.ipfc import Ipfc, IpfcState
from railhil.controller_node.laws.base import LawInputs, LawOutputs
from railhil.controller_node.program.tracer import Tracer
from railhil.dbc import wire_contract
from railhil.judge.folder import code_files
from railhil.run.local import LocalRun, local_plan
from railhil.run.run import Observer
from railhil.scenarios.load import load, load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.testing.result import disturbed

#: What processes leave of their own.
_OF_PROCESSES = {"hub.txt", "plant.txt", "controller.txt"}


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path


def documents(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    return tuple(json.loads((folder / name).read_text()) for name in ("certificate.json", "score.json"))


@pytest.mark.slow
def test_the_default_run_has_the_published_hash(tmp_path: Path) -> None:
    done = railhil("run", "--bus", "local", "--out", tmp_path / "run", "--quiet", "--no-report", "--verbose")
    assert done.exit_code == PASS, done.err
    assert re.search(r"^all files written \d+\.\d\d s after the last frame$", done.out, re.MULTILINE)
    assert documents(tmp_path / "run")[0]["frames_sha256"] == PUBLISHED_SHA256
    # Nothing else has moved in the record when PLT_IDENT was repeated for the first time.
    before = as_wire_5(tmp_path / "run" / "frames.log", wire_contract(), WIRE_5_HASH)
    assert hashlib.sha256(before).hexdigest() == PUBLISHED_WIRE_5_SHA256


@pytest.mark.slow
@pytest.mark.loop
def test_the_folder_is_that_of_a_run_over_the_hub(short: Path, tmp_path: Path) -> None:
    codes = []
    for name, words in (("hub", ["-i", "railhil"]), ("local", ["--bus", "local"])):
        done = railhil("run", short, "--seed", "2", "--perturbed", "--out", tmp_path / name, "--quiet", *words)
        codes.append(done.exit_code)
    assert codes[0] == codes[1] in (PASS, FAIL)
    (theirs, their_score), (ours, our_score) = documents(tmp_path / "hub"), documents(tmp_path / "local")
    assert ours["frames_sha256"] == theirs["frames_sha256"]
    assert list(ours) == list(theirs)
    assert list(our_score["run"]) == list(their_score["run"])
    for key in ("verdict", "scores", "signed", "telemetry", "failures"):
        assert our_score[key] == their_score[key], key
    assert (ours["transport"], ours["bus"], theirs["bus"]) == ("local", "local", "auto")
    ours_only, theirs_only = ({path.name for path in (tmp_path / name).iterdir()} for name in ("local", "hub"))
    assert theirs_only - ours_only == _OF_PROCESSES
    assert not ours_only - theirs_only
    assert railhil("score", tmp_path / "local").exit_code == codes[0]


def test_a_spec_that_is_none_leaves_no_folder(here: Railhil, tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text("sede = 1\n")
    done = here("run", "--spec", tmp_path / "run.toml", "--out", tmp_path / "out")
    assert done.exit_code == USAGE
    assert done.err.startswith(f"railhil: {tmp_path}/run.toml: sede: unknown key")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("--pace", "realtime"),
        ("-i", "socketcan", "-c", "vcan0"),
        ("--fd",),
        ("--attach",),
        ("--no-controller",),
    ],
)
def test_what_needs_a_bus_is_refused(here: Railhil, short: Path, tmp_path: Path, words: tuple[str, ...]) -> None:
    done = here("run", short, "--bus", "local", *words, "--out", tmp_path / "run")
    assert done.exit_code == USAGE
    assert "--bus local" in done.one_line()
    assert not (tmp_path / "run").exists()


def test_the_hash_of_the_code_covers_what_such_a_run_is_made_by() -> None:
    names = {name for name, _ in code_files()}
    assert {
        "run/local.py",
        "run/coupled.py",
        "record/session.py",
        "scenarios/run_spec.py",
        "dbc/ports.toml",
    } <= names


@pytest.mark.slow
def test_what_it_does_not_model_is_said() -> None:
    assert limits_of("local") == limits()["local"]
    assert "one process" in railhil("doctor", "--quick", "--json").json["limits"]["local"]


@pytest.mark.slow
def test_ctrl_c_keeps_what_was_recorded(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    started = Started("run", "--bus", "local", "--out", folder, "--quiet", "--no-report")
    wait_for(lambda: (folder / "frames.log").exists() and (folder / "frames.log").stat().st_size > 400_000)
    started.process.send_signal(signal.SIGINT)
    done, _ = started.finish()
    assert done.exit_code == 128 + signal.SIGINT
    certificate, _ = documents(folder)
    assert certificate["verdict"] == "INVALID"
    assert "stopped by SIGINT at simulation time" in certificate["line"]
    assert (folder / "telemetry.json").is_file()


class StopsAfter(Observer):
    """Sends SIGINT to this process at a poll of SUP_CMD."""

    def __init__(self, polls: int) -> None:
        self._left = polls

    def on_progress(self, sim_time_s: float) -> None:
        self._left -= 1
        if self._left == 0:
            signal.raise_signal(signal.SIGINT)


@pytest.mark.long
@pytest.mark.slow
def test_a_run_that_is_stopped_at_any_poll_has_lost_nothing(short: Path, tmp_path: Path) -> None:
    """Also where the poll of SUP_CMD follows a TIME_SYNC; the check of every test in this folder reads the counters."""
    for polls in range(1, 10):
        folder = tmp_path / str(polls)
        folder.mkdir()
        run = LocalRun(local_plan(load(short), RunSpec(), folder), StopsAfter(polls))
        result = run.execute()
        assert (result.exit_code, run.stopped_exit_code) == (INVALID, 128 + signal.SIGINT)
        assert disturbed(result.recorder_counters) == {}, polls


class Stumbling(Ipfc[Any]):
    """IPFC that raises in its fourth period; its record does not show it, else it would not start."""

    steps = 0

    def step(self, state: IpfcState[Any], inputs: LawInputs[Any]) -> tuple[IpfcState[Any], LawOutputs[Any]]:
        """One control period."""
        if not isinstance(self._ar, Tracer):
            self.steps += 1
            if self.steps > 3:
                raise ZeroDivisionError("in the middle of the run")
        return super().step(state, inputs)


def test_a_law_that_raises_is_bad_input_with_its_place(
    short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, stumbling=Stumbling)
    folder = tmp_path / "run"
    folder.mkdir()
    spec = RunSpec(str(short), law=LawSpec("stumbling"), bus="local")
    result = LocalRun(local_plan(spec.load(), spec, folder)).execute()
    assert (result.exit_code, result.verdict) == (USAGE, "INVALID")
    assert "in the middle of the run" in result.line
    assert "test_local_command.py" in result.line
    assert result.frames > 0


#: Limits that the short run meets.
_WIDE = ("plan.stop_error_max_m=8", "plan.time_error_max_s=8")


@pytest.mark.faults
@pytest.mark.parametrize(
    ("faults", "verdict", "line"),
    [
        ((), "FAIL", "fixed-point wrap in the controller, reported at 0.00 s"),
        (("CTL_STAT loss x1 @3.3s",), "FAIL", "fixed-point wrap in the controller, reported at 0.00 s"),
        *(
            ((text,), "INVALID", "record: no CTL_STAT says that the controller's arithmetic has wrapped, which it did ")
            for text in ("CTL_STAT loss @0s", "CTL_STAT.OverflowFlags value 0 @0s", "CTL_STAT masquerade TRK_INFO @0s")
        ),
    ],
)
def test_no_fault_of_its_telegram_hides_a_wrap(
    short: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    faults: tuple[str, ...],
    verdict: str,
    line: str,
) -> None:
    """The controller itself has counted it."""
    plug_in(tmp_path, monkeypatch, wrapping=Wrapping)
    folder = tmp_path / "run"
    folder.mkdir()
    scenario = load_any(str(short), _WIDE, faults)
    spec = RunSpec(str(short), law=LawSpec("wrapping"), bus="local")
    result = LocalRun(local_plan(scenario, spec, folder)).execute()
    assert (result.verdict, result.score.verdict) == (verdict, "FAIL" if verdict == "FAIL" else "PASS")
    assert result.exit_code == (FAIL if verdict == "FAIL" else INVALID)
    assert result.line.startswith(line)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_no_fault_of_its_telegram_hides_a_wrap_on_the_hub(
    short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, wrapping=Wrapping)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path / 'plug'}{os.pathsep}{ROOT}")
    done = railhil(
        "run", short, *(word for text in _WIDE for word in ("--set", text)), "-i", "railhil",
        "--controller", "wrapping", "--fault", "CTL_STAT loss @0s", "--out", tmp_path / "run", "--no-report",
    )  # fmt: skip
    assert done.exit_code == INVALID, done.err
    assert "no CTL_STAT says that the controller's arithmetic has wrapped" in documents(tmp_path / "run")[0]["line"]
