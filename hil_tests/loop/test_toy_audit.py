"""``railhil audit`` of a plug-in system: the toy system, whose laws have two commands."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.toy_system import SCENARIO, install_toy, railhil

pytestmark = [pytest.mark.loop, pytest.mark.slow]

COMMANDS = ["force[0]", "force[1]"]
_NO_BATCH = "no batch of trains for system two_carts: every run goes through the nodes, one by one"

_LOOK = '''
"""The examination of the two carts' own system."""
from railhil.audit.bars import Bar, Look

def look(scenario, law, fresh):
    said = f"{law.controller} on {fresh().counters.wraps} wraps"
    return Look("carts", "Carts at rest", said, {"apart": 2}, (Bar("carts that roll away", "1", "0", False),))
'''
_MUTE = '''
"""A controller's node without the attribute ``computes``."""
from railhil.controller_node.vector.node import VectorNode

def node(*given, **named):
    return VectorNode(*given, **named)
'''


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.fixture
def copy(site: Path, tmp_path: Path) -> Path:
    """A copy of the installation that the test may change."""
    return Path(shutil.copytree(site, tmp_path / "site"))


def edit(copy: Path, file: str, old: str, new: str) -> None:
    path = copy / "two_carts" / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def audited(site: Path, *words: str, exit_code: int = 0) -> dict[str, Any]:
    done = railhil(site, "audit", str(SCENARIO), *words, "--json")
    assert done.returncode == exit_code, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_every_part_of_the_audit_is_there(site: Path, tmp_path: Path) -> None:
    done = railhil(site, "audit", str(SCENARIO), "--runs", "3", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert _NO_BATCH in done.stderr
    headings = (
        "two_carts_2m: apart in iq",
        "Range and headroom",
        "Error of iq against float64",
        "Rounded (rmpy) and floored (mpy) products",
        "force[1] codes with floored products: ",
        "Scores of the run (nominal, seed 0)",
        "Medians of 3 perturbed runs",
        "Cycles of one control period",
        "Constants rounded",
        "Limits",
    )
    positions = [done.stdout.index(heading) for heading in headings]
    assert positions == sorted(positions)
    for foreign in ("notch", "Train held", "at rest", "itae", "stop_error"):
        assert foreign not in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 100
    assert done.stdout.rstrip().endswith("all limits met")
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_figures_of_every_quantity_and_command(site: Path) -> None:
    found = audited(site, "--controller", "apart", "--runs", "2", "--seed", "5")
    assert (found["scenario"], found["controller"], found["seed"], found["runs"]) == ("two_carts_2m", "apart", 5, 2)
    names = [row["name"] for row in found["ranges"]]
    assert names[:2] == ["position[0]", "position[1]"]
    assert names[-3:] == [*COMMANDS, "stretch"]
    assert [row["name"] for row in found["errors"]] == names
    assert [row["name"] for row in found["floor"]["errors"]] == names
    # The bounds of a reading are those of its signal: a signed field of 24 bits.
    bounds = {row["name"]: row for row in found["bounds"]["quantities"]}
    assert (bounds["position[0]"]["minimum"], bounds["position[0]"]["maximum"]) == (-(2**23), 2**23 - 1)
    assert (bounds["force[1]"]["minimum"], bounds["force[1]"]["maximum"]) == (-2000, 2000)
    assert found["bounds"]["may_wrap"] == 0
    for row in found["ranges"]:
        assert bounds[row["name"]]["minimum"] <= row["minimum"] <= row["maximum"] <= bounds[row["name"]]["maximum"]
    # Readings have no error, results of products do.
    errors = {row["name"]: row for row in found["errors"]}
    assert errors["moved[0]"]["maximum"] == 0
    assert 0 < errors["wanted[0]"]["maximum_lsb"] < 20
    for codes in (found["commands"], found["floor"]["commands"]):
        assert list(codes) == COMMANDS
        for one in codes.values():
            assert (one["unit"], one["q"], one["steps"]) == ("0.01 N", 0, 121)
            assert one["equal_share"] >= 0.99
    assert set(found["scores"]) == {"iq", "float64"}
    assert set(found["scores"]["iq"]) == set(found["floor"]["scores"]) == {"error_m", "stretch_m"}
    assert [one["score"] for one in found["effect"]] == ["error_m", "stretch_m"]
    assert found["effect"][0]["allowed"] == 0.0001, "what the system's criterion says"
    assert found["cost"]["cycles"] > 0
    assert "standstill" not in found
    assert not [bar for bar in found["bars"] if "notch" in bar["name"] or "held" in bar["name"]]


@pytest.mark.long
def test_the_score_is_that_of_a_run_with_the_same_seed(site: Path, tmp_path: Path) -> None:
    found = audited(site, "--runs", "0", "--seed", "5")
    words = ("--seed", "5", "--bus", "local", "--out", str(tmp_path / "run"), "--quiet", "--no-report", "--json")
    run = railhil(site, "run", str(SCENARIO), *words)
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout)["scores"] == found["scores"]["iq"]


def test_single_precision_has_no_formats(site: Path) -> None:
    found = audited(site, "--arithmetic", "float32", "--runs", "0")
    assert (found["bounds"], found["floor"], found["effect"]) == (None, None, [])
    assert set(found["scores"]) == {"float32", "float64"}
    assert list(found["commands"]) == COMMANDS


def test_without_a_batch_fewer_runs_are_usual(site: Path) -> None:
    done = railhil(site, "audit", str(SCENARIO), "--json", "--set", "task.duration_s=1")
    assert json.loads(done.stdout)["runs"] == 20
    assert _NO_BATCH in done.stderr


def test_formats_that_are_too_coarse_miss_the_bars(copy: Path) -> None:
    edit(copy, "laws.py", "_GAIN_Q = 20", "_GAIN_Q = 9")
    found = audited(copy, "--runs", "0", exit_code=1)
    missed = {bar["name"] for bar in found["bars"] if not bar["met"]}
    assert {f"{name} codes equal to float64's" for name in COMMANDS} <= missed
    assert {f"largest difference of a {name} code" for name in COMMANDS} <= missed
    assert found["commands"]["force[0]"]["largest"] > 1
    assert [constant["name"] for constant in found["coarse_constants"]] == ["stiffness"]


def test_a_law_that_may_wrap_is_audited_though_it_does_not_run(copy: Path) -> None:
    edit(copy, "laws.py", "ar.clip(reading, *self._far)", "ar.mpy(reading, self._far[0], 0)")
    found = audited(copy, "--runs", "0", exit_code=1)
    assert found["bounds"]["may_wrap"] > 0
    (bar,) = (bar for bar in found["bars"] if bar["name"].startswith("operations that may wrap"))
    assert not bar["met"]


def test_a_system_may_look_at_more(copy: Path) -> None:
    (copy / "two_carts" / "look.py").write_text(_LOOK, encoding="utf-8")
    edit(copy, "__init__.py", 'task="', 'audit="two_carts.look:look", task="')
    found = audited(copy, "--runs", "0", exit_code=1)
    assert found["carts"] == {"apart": 2}
    assert [bar["name"] for bar in found["bars"] if not bar["met"]] == ["carts that roll away"]
    done = railhil(copy, "audit", str(SCENARIO), "--runs", "0")
    assert "Carts at rest\napart on 0 wraps\n" in done.stdout


def test_a_controller_that_cannot_be_looked_into_is_refused(copy: Path) -> None:
    (copy / "two_carts" / "mute.py").write_text(_MUTE, encoding="utf-8")
    edit(copy, "__init__.py", "railhil.controller_node.vector.node:VectorNode", "two_carts.mute:node")
    done = railhil(copy, "audit", str(SCENARIO), "--runs", "0")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "whose controller is two_carts.mute:node" in line
    assert "a class attribute computes" in line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--controller", "ipfc"), "controller: name: found 'ipfc', allowed one of apart"),
        (("--indexing", "distance", "--runs", "0"), "--indexing: found 'distance', allowed time with system two_carts"),
        (("--set", "task.mass_spread=0"), "--runs: the scenario two_carts_2m, which has nothing to draw"),
        (("--set", "task.colour=3"), "task.colour: unknown key"),
    ],
)
def test_bad_input_is_one_line(site: Path, words: tuple[str, ...], said: str) -> None:
    done = railhil(site, "audit", str(SCENARIO), *words)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert said in line
