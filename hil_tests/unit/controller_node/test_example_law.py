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
ENTRY = 'pi = "pi:Pi"'
EXAMPLE = ROOT / "docs" / "examples" / "pi.py"


@pytest.fixture(autouse=True)
def plugged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The example and its registration, on the path of this process."""
    package = tmp_path / "plug" / "pi-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: pi\nVersion: 1\n")
    (package / "entry_points.txt").write_text(f"[railhil.laws]\n{ENTRY.replace(chr(34), '')}\n")
    shutil.copy(EXAMPLE, package.parent)
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.delitem(sys.modules, "pi", raising=False)
    importlib.invalidate_caches()


def test_the_registration_is_the_one_of_the_text() -> None:
    assert ENTRY in (ROOT / "docs/howto/add_law.md").read_text(encoding="utf-8")
    assert load_law("pi").name == "pi"


def test_it_is_what_railhil_new_law_writes(tmp_path: Path) -> None:
    done = railhil("new", "law", "pi", "--out", tmp_path / "new")
    # Its name is installed here, by the fixture only for this process.
    assert done.exit_code == 0, done.err
    written = tmp_path / "new" / "src" / "pi.py"
    assert written.read_text("utf-8") == EXAMPLE.read_text("utf-8"), "copy it to docs/examples"


@pytest.mark.slow
def test_it_brings_the_train_to_its_stop_in_every_arithmetic() -> None:
    wide, fixed, single = (
        direct_run(SCENARIO, RunSpec(law=LawSpec("pi", arithmetic))) for arithmetic in ("float64", "iq", "float32")
    )
    for run in (wide, fixed, single):
        assert run.score.extras["overspeed_mps"] == 0
        assert abs(run.score.signed["stop_error_m"] or 99) < 1
        assert run.score.values["itae"] < 5000
    assert fixed.arithmetic is not None
    assert fixed.arithmetic.flags == 0
    equal = sum(a == b for a, b in zip(wide.commands("notch"), fixed.commands("notch"), strict=False))
    assert equal > 0.5 * len(wide.commands("notch"))


@pytest.mark.parametrize("corner", [0, 1])
def test_no_operation_can_wrap_inside_the_bounds_of_its_search(corner: int, tmp_path: Path) -> None:
    tunable = load_law("pi").tunable
    lines = "\n".join(f"{name} = {bounds[corner]}" for name, bounds in tunable.items())
    path = tmp_path / "pi.toml"
    path.write_text(f'law = "pi"\n[parameters]\n{lines}\n', encoding="utf-8")
    parameters = load_parameters(path)
    bounds = ControlLoop(SCENARIO, LawSpec("pi", parameters=parameters), make("iq")).law.state_bounds()
    assert not analyse_law(record(SCENARIO, LawSpec("pi", parameters=parameters)), bounds, WIRE).may_wrap


def test_its_integral_stands_still_while_another_notch_is_sent() -> None:
    """30 s of full error with the traction cut: one law is told of it, one not, one has just begun."""
    told, untold, fresh = (ControlLoop(SCENARIO, LawSpec("pi"), make("iq")) for _ in range(3))
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
    written(SCENARIO, folder, law="pi")
    done = checked(compiled(folder, "gcc", STRICT, "pi_run", "pi"), folder / "pi_log.txt")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "control periods identical" in done.stdout
