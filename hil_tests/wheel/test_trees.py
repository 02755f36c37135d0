"""A tree unpacked from a zip: installed in each way, read by each tool, and refused where something is missing."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.paths import ROOT, make_tree
from hil_tests.support.venvs import RUNNING, Environment, MissingCapabilityError, base_python, libraries_of
from railhil import AT_TOP
from railhil.bench import local_run
from railhil.common.held_code import OURS, held_sha256
from railhil.judge.folder import code_sha256
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

PYRIGHT = "pyright@1.1.414"
_HOOK = "import setuptools.build_meta as build, sys; getattr(build, 'build_' + sys.argv[1])(sys.argv[2])"
_HELD = "from railhil.common.held_code import OURS, held_sha256; print(held_sha256(OURS))"
#: A module of a new folder below one at the top: uses one package inside railhil/, one beside it, and has one error.
_ANNEX = """\
from railhil.common.exit_codes import PASS
from railhil.dbc import wire_contract

passed: int = PASS
ports: str = wire_contract().ports
"""


@pytest.fixture
def tree(archive: Path, tmp_path: Path) -> Path:
    shutil.unpack_archive(archive, tmp_path / "tree")
    return tmp_path / "tree"


@pytest.fixture(params=["installed", "editable"])
def environment(tree: Path, tmp_path: Path, request: pytest.FixtureRequest) -> Environment:
    """``pip install .`` and ``pip install -e .``; the libraries are those of the running environment."""
    made = Environment.make(tmp_path, base_python(), libraries_of(base_python(), RUNNING))
    made.install_source(tree, *(["-e"] if request.param == "editable" else []))
    if request.param == "installed":
        shutil.rmtree(tree)
    return made


def test_git_holds_no_link_and_nothing_that_a_build_makes() -> None:
    said = subprocess.run(["git", "ls-files", "--stage"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    lines = [line.split(maxsplit=3) for line in said.splitlines()]
    assert len(lines) > 1000
    assert [name for mode, _, _, name in lines if mode == "120000" or ".egg-info/" in name or "build/" in name] == []


@pytest.mark.long_after(1)
def test_each_installation_gives_the_bytes_and_has_the_code_of_the_checkout(
    environment: Environment, tmp_path: Path
) -> None:
    (environment.folder / "short.toml").write_text(QUICK_TOML)
    (tmp_path / "here").mkdir()
    expected = local_run(load(str(environment.folder / "short.toml")), tmp_path / "here", RunSpec(seed=3))
    words = ("run", "short.toml", "--seed", "3", "--bus", "local", "--no-report", "--out", "run")
    environment.run("railhil", *words, exit_code=1 if expected.score.failures else 0)
    certificate = json.loads((environment.folder / "run" / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["frames_sha256"] == expected.frames_sha256
    assert certificate["code_sha256"] == code_sha256()
    assert environment.run("python", "-c", _HELD).strip() == held_sha256(OURS)


@pytest.mark.long
@pytest.mark.parametrize("environment", ["editable"], indirect=True)
def test_an_editable_installation_has_new_folders_and_runs_the_tests(environment: Environment, tree: Path) -> None:
    for folder in ("bus/annex/deeper", "railhil/annex"):
        (tree / folder).mkdir(parents=True)
        (tree / folder / "__init__.py").write_text("PLACE = __name__\n")
    look = "from railhil import annex; from railhil.bus.annex.deeper import PLACE; print(annex.PLACE, PLACE)"
    assert environment.run("python", "-c", look).split() == ["railhil.annex", "railhil.bus.annex.deeper"]
    bare = "import importlib.util as u, sys; print(*(n for n in sys.argv[1:] if u.find_spec(n)))"
    assert environment.run("python", "-c", bare, *AT_TOP, "hil_tests", "benchmarks").split() == []
    words = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "hil_tests/unit/bus/test_acceptance.py")
    assert " passed" in environment.run("python", *words, cwd=tree)


@pytest.mark.long
def test_a_tree_on_the_path_takes_no_package_from_an_installed_railhil(tree: Path, tmp_path: Path) -> None:
    look = "import importlib, sys; print(*(importlib.import_module(name).__file__ for name in sys.argv[1:]))"
    words = [sys.executable, "-c", look, *(f"{OURS}.{name}" for name in ("common", *AT_TOP))]
    variables = {**os.environ, "PYTHONPATH": str(tree)}
    done = subprocess.run(words, cwd=tmp_path, env=variables, capture_output=True, text=True, timeout=100, check=True)
    places = [tree / OURS / "common", *(tree / name for name in AT_TOP)]
    assert done.stdout.split() == [str(place / "__init__.py") for place in places]


def _with_annex(tree: Path) -> str:
    """Add a module with an error to the tree, and make ``build/tree``; returns the module's file."""
    (tree / "bus" / "annex").mkdir()
    (tree / "bus" / "annex" / "__init__.py").write_text(_ANNEX)
    make_tree(tree / "build" / "tree", tree)
    return "bus/annex/__init__.py"


@pytest.mark.long
def test_mypy_sees_all_packages(tree: Path) -> None:
    file = _with_annex(tree)
    words = [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", "--cache-dir", "cache"]
    done = subprocess.run(
        [*words, "-p", "railhil.bus.annex"], cwd=tree, capture_output=True, text=True, timeout=300, check=False
    )
    found = [line for line in done.stdout.splitlines() if ": error: " in line]
    assert len(found) == 1, done.stdout + done.stderr
    assert found[0].startswith(f"build/tree/railhil/{file}:5: ")
    assert "[assignment]" in found[0]


@pytest.fixture
def pyright(tmp_path: Path) -> Path:
    """The program, from npm's registry."""
    words = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--prefix", tmp_path, PYRIGHT]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        raise MissingCapabilityError(f"MISSING CAPABILITY npm's registry: {done.stderr[-200:]}")
    return tmp_path / "node_modules" / ".bin" / "pyright"


@pytest.mark.long
@pytest.mark.needs_node
def test_pyright_sees_all_packages(tree: Path, pyright: Path) -> None:
    file = _with_annex(tree)
    words = [pyright, "--outputjson", "--pythonpath", sys.executable, file]
    done = subprocess.run(words, cwd=tree, capture_output=True, text=True, timeout=300, check=False)
    found = json.loads(done.stdout)["generalDiagnostics"]
    assert [(one["range"]["start"]["line"], one["rule"]) for one in found] == [(4, "reportAssignmentType")], found


@pytest.mark.long_after(2)
@pytest.mark.parametrize("kind", ["wheel", "sdist", "editable"])
@pytest.mark.parametrize("left", ["text", "nothing"])
def test_a_tree_without_its_folders_is_refused_in_one_line(tmp_path: Path, kind: str, left: str) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    (source / "railhil").mkdir(parents=True)
    out.mkdir()
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE", "railhil/__init__.py"):
        shutil.copy(ROOT / name, source / name)
    if left == "text":
        for name in AT_TOP:
            (source / name).write_text(f"../{name}")
    words = [sys.executable, "-c", _HOOK, kind, str(out)]
    done = subprocess.run(words, cwd=source, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode != 0
    assert not any(out.iterdir())
    (line,) = (line for line in done.stderr.splitlines() if "cannot be built" in line)
    assert all(name in line for name in AT_TOP)
    assert "Traceback" not in done.stderr


def test_the_build_and_python_know_the_same_folders_at_the_top() -> None:
    folders = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["package-dir"]
    assert folders == {OURS: OURS, **{f"{OURS}.{name}": name for name in AT_TOP}}
