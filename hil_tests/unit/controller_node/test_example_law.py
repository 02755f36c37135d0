"""The worked example of docs/howto/add_law.md, registered like any user's law."""

from __future__ import annotations

import importlib
import shutil
import sys
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.exported import STRICT, checked, compiled, written
from hil_tests.support.paths import ROOT
from railhil.bench import direct_run
from railhil.cli.new_scenario import line_file
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import WIRE
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import NOTCH_RAW_Q
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.tracer import record
from railhil.scenarios.load import load
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec

SCENARIO = load("lvshun_tieshan")
ENTRY = 'mylaw = "mylaw:Mylaw"'
EXAMPLE = ROOT / "docs" / "examples" / "mylaw.py"


@pytest.fixture(autouse=True)
def plugged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The example and its registration, on the path of this process."""
    package = tmp_path / "plug" / "mylaw-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: mylaw\nVersion: 1\n")
    (package / "entry_points.txt").write_text(f"[railhil.laws]\n{ENTRY.replace(chr(34), '')}\n")
    shutil.copy(EXAMPLE, package.parent)
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.delitem(sys.modules, "mylaw", raising=False)
    importlib.invalidate_caches()


def test_the_registration_is_the_one_of_the_text() -> None:
    assert ENTRY in (ROOT / "docs" / "howto" / "add_law.md").read_text(encoding="utf-8")
    assert load_law("mylaw").name == "mylaw"


def test_it_is_what_railhil_new_law_writes(tmp_path: Path) -> None:
    done = railhil("new", "law", "mylaw", "--out", tmp_path / "new")
    # Its name is installed here, by the fixture only for this process.
    assert done.exit_code == 0, done.err
    written = tmp_path / "new" / "src" / "mylaw.py"
    assert written.read_text("utf-8") == EXAMPLE.read_text("utf-8"), "copy it to docs/examples"


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["float64", "iq", "float32"])
def test_it_brings_the_train_to_its_stop_in_every_arithmetic(arithmetic: str) -> None:
    run = direct_run(SCENARIO, RunSpec(law=LawSpec("mylaw", arithmetic)))
    assert run.score.verdict == "PASS", run.score.failures
    assert run.arithmetic is not None
    assert run.arithmetic.flags == 0


#: Settings of a line and a train of a user's own: as they are written, on a grade at the stop, heavy, slow to answer.
OWN = {
    "as written": [],
    "grade": ["line.grade_permil=[[0, 0], [900, -15], [1200, 12]]"],
    "heavy": [
        "train.mass_t=300",
        "train.traction={force_max_kn=350, power_max_kw=4000}",
        "train.brake.force_max_kn=380",
    ],
    "slow": ["train.actuator_pole_per_s=0.34", "timing.loop_delay_s=0.2"],
    "fast": ["train.actuator_pole_per_s=2.5", "timing.control_period_ms=200"],
}


@pytest.mark.parametrize("settings", OWN.values(), ids=OWN)
def test_it_stops_another_train_on_another_line_within_the_limits(settings: list[str], tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(line_file("mine"), encoding="utf-8")
    run = direct_run(load(path, settings), RunSpec(law=LawSpec("mylaw", "iq")))
    assert run.score.verdict == "PASS", run.score.failures


@pytest.mark.parametrize("corner", [0, 1])
def test_no_operation_can_wrap_inside_the_bounds_of_its_search(corner: int, tmp_path: Path) -> None:
    tunable = load_law("mylaw").tunable
    lines = "\n".join(f"{name} = {bounds[corner]}" for name, bounds in tunable.items())
    path = tmp_path / "mylaw.toml"
    path.write_text(f'law = "mylaw"\n[parameters]\n{lines}\n', encoding="utf-8")
    parameters = load_parameters(path)
    bounds = ControlLoop(SCENARIO, LawSpec("mylaw", parameters=parameters), make("iq")).law.state_bounds()
    assert not analyse_law(record(SCENARIO, LawSpec("mylaw", parameters=parameters)), bounds, WIRE).may_wrap


def test_its_sums_stand_still_while_another_notch_is_sent() -> None:
    """30 s of full error with the traction cut: one law is told of it, one not, one has just begun."""
    told, untold, fresh = (ControlLoop(SCENARIO, LawSpec("mylaw"), make("iq")) for _ in range(3))
    for _ in range(60):
        told.step(100, 150_000, 0)
        told.sent(0)
        untold.step(100, 150_000, 0)
    after, wound, first = (loop.step(100, 150_000, 0)[1].notch_raw for loop in (told, untold, fresh))
    assert after == first
    assert wound > first + (2 << NOTCH_RAW_Q)
    told.sent(told.state.notch)
    assert told.step(100, 150_000, 0)[1].notch_raw > first, "the notch that was its own changes nothing"


@pytest.mark.needs_compiler
def test_it_is_exported_without_a_line_more(tmp_path: Path) -> None:
    folder = tmp_path / "c"
    written(SCENARIO, folder, law="mylaw")
    done = checked(compiled(folder, "gcc", STRICT, "mylaw_run", "mylaw"), folder / "mylaw_log.txt")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "control periods identical" in done.stdout
