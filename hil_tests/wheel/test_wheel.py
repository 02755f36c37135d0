"""The wheel in an empty folder, together with distributions from PyPI that have the names of railhil's folders."""

from __future__ import annotations

import json
import shutil
import zipfile
from importlib.metadata import PathDistribution
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.paths import ROOT
from hil_tests.support.venvs import RUNNING, Environment, base_python, downloaded, libraries_of
from hil_tests.wheel.conftest import Built
from railhil import AT_TOP
from railhil.bench import Result

#: Of our top folders, supervisor, scenarios and dbc are names of other people's distributions.
NEIGHBOURS = ("supervisor==4.3.0", "scenarios==0.0.2", "dbc==0.3.1")
#: What a checkout has at its top and nobody may get by installing the bench.
OURS_ALONE = (*sorted({*AT_TOP} - {"dbc"}), "hil_tests", "benchmarks", "docker", "docs")
SUBCOMMANDS = (
    "run",
    "rerun",
    "replay",
    "score",
    "report",
    "compare",
    "doctor",
    "bus hub",
    "new law",
    "new line",
    "new scenario",
    "new system",
)
#: Commands that become another program, each a Python of its own.
PROGRAMS = ("campaign", "tune", "audit", "export-c", "node plant", "node controller")
_HELPS = """
import contextlib, sys
from railhil.cli import main
for command in sys.argv[1:]:
    with contextlib.suppress(SystemExit):
        main([*command.split(), "--help"])
"""
#: A compiled function of the batch draws the numbers of the node, and its machine code is kept.
_COMPILES = """
import numpy as np
from railhil.batch.compiled import FUNCTIONS
from railhil.systems.ato.batch.noise import standard_noise
from railhil.scenarios import streams
from railhil.scenarios.streams import chain_of, key_of, normals
found = standard_noise([chain_of(3)], np.arange(99))[:, 0]
same = found.tolist() == normals(key_of(3, streams.AXLE_NOISE), 0, 99).tolist()
print(same and any(kept.is_there for kept in FUNCTIONS))
"""


def content(wheel: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def installed(built: Built, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    """The wheel and its neighbours; the libraries are those of the running environment."""
    folder = tmp_path_factory.mktemp("beside")
    libraries = libraries_of(base_python(), RUNNING)
    return Environment.make(folder, base_python(), libraries, built.wheel, *downloaded(*NEIGHBOURS))


@pytest.fixture(scope="module")
def run_folder(installed: Environment) -> Path:
    """The nominal run of the installed command."""
    installed.run("railhil", "run", "--seed", "2", "--bus", "local", "--no-report", "--out", "nominal")
    return installed.folder / "nominal"


def test_wheel_holds_one_package_and_no_tests(built: Built) -> None:
    names = content(built.wheel)
    assert {name.split("/")[0] for name in names} == {"railhil", f"railhil-{built.version}.dist-info"}
    assert {"railhil/py.typed", "railhil/bus/store.py", "railhil/dbc/railhil.dbc"} <= names.keys()
    ours = [name for name in names if not name.startswith(("railhil/testing/", "railhil/pytest_plugin.py"))]
    assert not [name for name in ours if "test" in name.lower() or "__pycache__" in name or "benchmark" in name]


def test_wheel_holds_every_tracked_file_of_the_package(built: Built) -> None:
    """Data files too: a pattern that is missing in pyproject.toml is seen by nobody who works in a checkout."""
    wanted = {
        str(path.relative_to(top))
        for top, below in ((ROOT / "railhil", ""), *((ROOT, name) for name in AT_TOP))
        for path in (top / below).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    found = {name.removeprefix("railhil/") for name in content(built.wheel) if name.startswith("railhil/")}
    assert found == wanted


@pytest.mark.long
def test_source_archive_makes_the_same_wheel(built: Built, wheel_of_sdist: Path) -> None:
    assert wheel_of_sdist.name == built.wheel.name
    assert content(wheel_of_sdist) == content(built.wheel)


@pytest.mark.long
def test_page_on_the_package_index(installed: Environment) -> None:
    (folder,) = installed.site_packages.glob("railhil-*.dist-info")
    metadata = PathDistribution(folder).metadata
    assert metadata["Author"]
    assert {line.split(", ")[0] for line in metadata.get_all("Project-URL")} >= {"Homepage", "Changelog", "Issues"}
    versions = {line.rsplit(" ", 1)[1] for line in metadata.get_all("Classifier") if "Python :: 3." in line}
    assert versions == {"3.11", "3.12", "3.13"}
    description = metadata.get_payload()
    assert "](docs/" not in description
    assert "](CONTRIBUTING" not in description


def test_nothing_but_railhil_is_importable(installed: Environment) -> None:
    look = "import importlib.util as u, sys; print(*(n for n in sys.argv[1:] if u.find_spec(n)))"
    assert installed.run("python", "-c", look, *OURS_ALONE).split() == []
    names = ("supervisor", "scenarios", "dbc", "railhil")
    where = "import importlib, sys; print(*(importlib.import_module(name).__file__ for name in sys.argv[1:]))"
    files = installed.run("python", "-c", where, *names).split()
    assert [Path(file).parent for file in files] == [installed.site_packages / name for name in names]


def test_neighbours_still_work(installed: Environment) -> None:
    assert installed.run("supervisord", "--version").strip() == "4.3.0"
    assert "[supervisord]" in installed.run("echo_supervisord_conf")


def test_run_gives_the_bytes_of_the_checkout(run_folder: Path, nominal: Result) -> None:
    certificate = json.loads((run_folder / "certificate.json").read_text())
    assert certificate["frames_sha256"] == nominal.frames_sha256


def test_installation_says_the_commit_of_its_wheel(installed: Environment, run_folder: Path, built: Built) -> None:
    """Also one from the source archive, which has no repository."""
    assert json.loads((run_folder / "certificate.json").read_text())["railhil"] == built.version
    assert installed.run("railhil", "--version") == f"railhil {built.version}\n"
    assert built.wheel.name == f"railhil-{built.version}-py3-none-any.whl"


def test_its_log_is_scored(installed: Environment, run_folder: Path, nominal: Result) -> None:
    document = json.loads(installed.run("railhil", "score", run_folder / "frames.log", "--json"))
    assert document["scores"]["itae"] == nominal.score.values["itae"]


@pytest.mark.long
def test_campaign_of_a_few_runs(installed: Environment) -> None:
    """numba reads what is installed and compiles one function of it; the loops are interpreted, or compiling them would
    take as long as all other tests of the wheel."""
    assert installed.run("python", "-c", _COMPILES).split() == ["True"]
    (installed.folder / "quick.toml").write_text(QUICK_TOML)
    words = ("campaign", "quick.toml", "--runs", "1", "--laws", "ipfc", "--out", "campaign")
    assert "ipfc" in installed.run("railhil", *words, variables={"NUMBA_DISABLE_JIT": "1"})
    assert (installed.folder / "campaign" / "campaign.json").is_file()


@pytest.mark.long
def test_what_railhil_new_writes_is_installed_as_it_says(installed: Environment) -> None:
    """Commands run beside the folders: none is taken for the module that has its name."""
    for kind in ("law", "line", "scenario", "system"):
        assert installed.run("railhil", "new", kind, f"my{kind}").startswith(f"wrote my{kind}")
    for kind in ("law", "system"):
        installed.install_source(installed.folder / f"my{kind}", "-e")
    installed.run("railhil", "run", "myscenario.toml", "--controller", "mylaw", "--no-report", "--out", "my_run")
    installed.run("railhil", "run", "myline.toml", "--controller", "ipfc_plus", "--no-report", "--out", "my_line_run")
    installed.run("railhil", "run", "mysystem/mysystem.toml", "--no-report", "--out", "my_system_run")


@pytest.mark.long
def test_the_example_suite_of_a_user(installed: Environment) -> None:
    """pytest finds the plugin by itself; the suite needs nothing beside it but the wheel."""
    shutil.copytree(
        ROOT / "docs/examples/suite", installed.folder / "suite", ignore=shutil.ignore_patterns("__pycache__")
    )
    words = ("-p", "no:cacheprovider", "--railhil-seeds", "7", "--railhil-runs", "kept", "suite")
    said = installed.run("python", "-m", "pytest", *words)
    assert "ATO-12  PASSED     2 of 2 tests passed" in said
    assert (installed.folder / "kept" / "requirements.csv").is_file()


def test_every_command_is_there(installed: Environment) -> None:
    said = installed.run("python", "-c", _HELPS, *SUBCOMMANDS)
    usages = [line for line in said.splitlines() if line.startswith("usage: ")]
    wanted = [f"usage: railhil {command} " for command in SUBCOMMANDS]
    assert [usage[: len(start)] for usage, start in zip(usages, wanted, strict=True)] == wanted


@pytest.mark.long_after(2)
@pytest.mark.parametrize("command", PROGRAMS)
def test_every_program_is_there(installed: Environment, command: str) -> None:
    assert f"railhil {command}" in installed.run("railhil", *command.split(), "--help")


def test_python_can_finds_the_hub(installed: Environment) -> None:
    look = "import can.interfaces; print(can.interfaces.BACKENDS['railhil'])"
    assert "railhil.bus.hub.client" in installed.run("python", "-c", look)


def test_types_are_seen(installed: Environment) -> None:
    assert (installed.site_packages / "railhil" / "py.typed").is_file()
