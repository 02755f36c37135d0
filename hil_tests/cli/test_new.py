"""``railhil new``: what it writes is accepted, linted, installed and run; what it cannot write is refused in one
line."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint
from hil_tests.support.paths import ROOT, make_tree
from hil_tests.support.toy_system import install, railhil
from hil_tests.support.warm import run_module
from railhil import cli
from railhil.dbc import house_contract, system_contract
from railhil.scenarios.parameters import load_parameters

#: The longest name that is allowed.
LONG = "a_law_whose_name_is_as_long_as_it_may_be"


def run(*words: str | Path, cwd: Path, site: Path | None = None, **variables: str) -> None:
    """A module that must end well."""
    paths = os.pathsep.join(map(str, (*([site] if site else []), ROOT)))
    environment = {**os.environ, "PYTHONPATH": paths, **variables}
    module, *arguments = map(str, words)
    done = run_module(module, arguments, environment=environment, cwd=cwd)
    assert done.returncode == 0, done.stdout + done.stderr


def make_check(folder: Path) -> None:
    """Exported C computes its log again, and its controller compiles."""
    done = subprocess.run(
        ["make", "check", "node"], cwd=folder, capture_output=True, text=True, timeout=110, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^[1-9]\d* control periods identical, ", done.stdout, re.MULTILINE)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a law and a system."""
    folder = tmp_path_factory.mktemp("made")
    for kind in ("law", "system"):
        assert cli.main(["new", kind, f"my{kind}", "--out", str(folder / f"my{kind}")]) == 0
    return folder


@pytest.fixture(scope="module")
def law_site(made: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install(made / "mylaw", tmp_path_factory.mktemp("law"))


@pytest.fixture(scope="module")
def system_site(made: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install(made / "mysystem", tmp_path_factory.mktemp("system"))


def test_it_says_what_it_wrote_and_what_comes_next(here, tmp_path):
    done = here("new", "law", "mylaw")
    files = ("pyproject.toml", "README.md", "src/mylaw.py", "test_mylaw.py")
    assert done.out.splitlines() == [
        *(f"wrote mylaw/{name}" for name in files),
        "next: cd mylaw",
        "      pip install -e .",
        "      railhil run --controller mylaw",
        "      railhil audit lvshun_tieshan --controller mylaw --runs 0",
    ]
    assert (done.exit_code, done.err) == (0, "")
    written = [path for path in (tmp_path / "mylaw").rglob("*") if path.is_file()]
    assert sorted(str(path.relative_to(tmp_path / "mylaw")) for path in written) == sorted(files)
    document = here("new", "system", "mysystem", "--out", "deep/down", "--json").json
    assert document["made"] == "deep/down"
    assert document["next"][:2] == ["cd deep/down", "pip install -e ."]
    assert all((tmp_path / file).is_file() for file in document["files"])
    assert here("new", "scenario", "myrun").out.splitlines() == [
        "wrote myrun.toml",
        "next: railhil scenarios myrun.toml",
        "      railhil run myrun.toml",
    ]


def test_no_file_that_is_there_is_touched(here, tmp_path):
    """A folder with other files is filled; with one of these, none is written."""
    (tmp_path / "mylaw").mkdir()
    (tmp_path / "mylaw" / "README.md").write_text("mine")
    said = complaint(here("new", "law", "mylaw"))
    assert said == ("railhil: mylaw/README.md: exists already, expected a new one (--out says where)")
    assert [path.name for path in (tmp_path / "mylaw").iterdir()] == ["README.md"]
    assert (tmp_path / "mylaw" / "README.md").read_text() == "mine"
    (tmp_path / "mylaw" / "README.md").rename(tmp_path / "mylaw" / "NOTES.md")
    assert here("new", "law", "mylaw").exit_code == 0
    (tmp_path / "myrun.toml").symlink_to("nowhere.toml")
    assert "myrun.toml: exists already" in complaint(here("new", "scenario", "myrun"))
    assert not (tmp_path / "nowhere.toml").exists()


@pytest.mark.parametrize("kind", ["law", "system"])
@pytest.mark.parametrize(
    ("name", "allowed"),
    [
        ("MyLaw", "at most 40 small letters, digits and underscores"),
        ("law_", "between a letter and a letter or digit"),
        ("setup", "none of setup, conftest"),
        ("my-law", "small letters, digits and underscores"),
        ("2law", "between a letter and"),
        ("class", "no word of Python"),
        ("../law", "small letters"),
        ("", "small letters"),
        ("läw", "small letters"),
        ("a" * 41, "at most 40"),
        ("json", "a name that no installed module has"),
    ],
)
def test_names_of_distributions(here, tmp_path, kind, name, allowed):
    said = complaint(here("new", kind, name))
    assert said.startswith(f"railhil: command line: NAME: found {name!r}")
    assert allowed in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("law", "ipfc"), "NAME: found 'ipfc', allowed a name that no installed law has (ipfc, "),
        (("system", "ato"), "NAME: found 'ato', allowed a name that no installed system has (ato, "),
        (("law", "constant"), "NAME: found 'constant', allowed another name: Constant has another meaning"),
        (("law", "false"), "NAME: found 'false', allowed another name: False has another meaning"),
        (
            ("system", "mine", "--law", "vector_law"),
            "--law: found 'vector_law', allowed another name: VectorLaw has another meaning",
        ),
        (("system", "mine", "--law", "My"), "--law: found 'My', allowed at most 40 small letters"),
        (("line", "My line"), "NAME: found 'My line', allowed at most 80 small letters"),
        (("line", "lvshun_tieshan"), "NAME: found 'lvshun_tieshan', allowed a name that no shipped scenario has"),
        (("line", "mine", "--out", "mine"), "--out: found 'mine', allowed a file that ends in .toml"),
        (("line", "mine", "--out", "broken.toml"), "broken.toml: exists already"),
        (("scenario", "My run"), "NAME: found 'My run', allowed at most 80 small letters"),
        (("scenario", "lvshun_tieshan"), "NAME: found 'lvshun_tieshan', allowed a name that no shipped scenario has"),
        (("scenario", "yizhuang_05"), "NAME: found 'yizhuang_05', allowed a name that no shipped scenario has"),
        (("scenario", "mine", "--out", "mine"), "--out: found 'mine', allowed a file that ends in .toml"),
        (("scenario", "mine", "--extends", "lvshun_tieshn"), "did you mean lvshun_tieshan?"),
        (("scenario", "mine", "--extends", "no.toml"), "no.toml: does not exist"),
        (("scenario", "mine", "--extends", "broken.toml"), "broken.toml: plan.distance_m: found -1"),
        (("law", "mine", "--out", "broken.toml"), "broken.toml: is a file, expected a folder for the new files"),
    ],
)
def test_what_cannot_be_written_is_one_line(here, tmp_path, words, said):
    (tmp_path / "broken.toml").write_text('extends = "lvshun_tieshan"\nname = "b"\n[plan]\ndistance_m = -1\n')
    assert said in complaint(here("new", *words))
    assert [path.name for path in tmp_path.iterdir()] == ["broken.toml"]


def test_a_failed_write_leaves_no_file(here, tmp_path, monkeypatch):
    """The fourth of them finds no room."""
    opened = Path.open
    left = iter(range(3))

    def full(path, mode="r", **words):
        if mode == "x" and next(left, None) is None:
            raise OSError(28, "No space left on device")
        return opened(path, mode, **words)

    monkeypatch.setattr(Path, "open", full)
    said = complaint(here("new", "system", "mysystem"))
    where = "mysystem/src/mysystem/__init__.py"
    assert f"{where}: cannot be written: no space left on device" in said
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_the_ports_of_the_bench_come_from_its_own_table(made: Path) -> None:
    path = made / "mysystem" / "src" / "mysystem" / "ports.toml"
    written = [port["name"] for port in tomllib.loads(path.read_text(encoding="utf-8"))["port"]]
    assert written == ["CART_STAT", "CART_CMD", "LAW_STAT", "TRUTH"]
    contract = system_contract(path)
    assert contract.clock_port.name == "CART_STAT"
    assert {port.name for port in contract.ports} == {*written, *(port.name for port in house_contract().ports)}


def test_nothing_is_left_to_be_filled_in(made: Path) -> None:
    for path in made.rglob("*"):
        if path.is_file():
            assert "$" not in path.read_text(encoding="utf-8"), path


@pytest.mark.parametrize("name", ["mine", LONG])
def test_what_is_written_is_linted_and_formatted(here, tmp_path, name):
    here("new", "law", name, "--out", "law")
    here("new", "system", name, "--out", "system", "--law", name)
    for folder in ("law", "system"):
        # By its own rules, and by those of this repository that do not hang on which names come first.
        run("ruff", "check", "--no-cache", ".", cwd=tmp_path / folder)
        words = ("--no-cache", "--config", ROOT / "pyproject.toml", "--ignore", "I001")
        run("ruff", "check", *words, ".", cwd=tmp_path / folder)
    run("ruff", "format", "--no-cache", "--check", "law", cwd=tmp_path)
    run("ruff", "format", "--no-cache", "--check", "system", cwd=tmp_path)


@pytest.mark.long
@pytest.mark.slow
def test_what_is_written_is_typed(made: Path, tmp_path: Path) -> None:
    make_tree(tmp_path / "tree")
    for kind in ("law", "system"):
        # What railhil imports is not installed with types in it: its own errors are its own matter.
        words = ("--strict", "--follow-imports", "silent", "--cache-dir", tmp_path / "cache")
        run("mypy", *words, ".", cwd=made / f"my{kind}", MYPYPATH=str(tmp_path / "tree"))


@pytest.mark.slow
def test_their_tests_pass(made: Path, law_site: Path, system_site: Path) -> None:
    run("pytest", "-q", "-p", "no:cacheprovider", cwd=made / "mylaw", site=law_site)
    run("pytest", "-q", "-p", "no:cacheprovider", cwd=made / "mysystem", site=system_site)


@pytest.mark.long
@pytest.mark.slow
def test_the_law_of_the_system_is_tuned(made: Path, system_site: Path, tmp_path: Path) -> None:
    scenario, file = made / "mysystem" / "mysystem.toml", tmp_path / "hold.toml"
    words = ("--budget", "10", "--seeds", "0", "--runs", "2", "--out", file)
    done = railhil(system_site, "tune", "hold", scenario, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "end error" in done.stdout
    assert set(load_parameters(file).values) == {"stiffness_n_per_m", "damping_n_per_mps"}
    refused = railhil(system_site, "tune", "ipfc", scenario, cwd=tmp_path)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "railhil tune: controller: name: found 'ipfc', allowed one of hold\n"


_NO_TRUTH = """
import pytest


def test_waits(bench):
    with bench.start(scenario="mysystem.toml") as live:
        for words in ({"speed": 1.0}, {"position": lambda metres: metres > 1}):
            with pytest.raises(ValueError, match="system mysystem does not say where it is sent; wait for a port"):
                live.wait_until(timeout_s=1, **words)
        assert live.time_s == 0
"""


@pytest.mark.long
@pytest.mark.slow
def test_a_users_test_cannot_wait_for_a_truth_that_the_system_does_not_name(
    made: Path, system_site: Path, tmp_path: Path
) -> None:
    (tmp_path / "test_waits.py").write_text(_NO_TRUTH)
    shutil.copy(made / "mysystem" / "mysystem.toml", tmp_path)
    run("pytest", "-q", "-p", "no:cacheprovider", cwd=tmp_path, site=system_site)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.parametrize(
    ("arithmetic", "words"),
    [pytest.param("iq", (), marks=pytest.mark.long), ("float64", ("--bus", "local", "--no-report"))],
)
def test_the_law_drives_the_train(law_site: Path, tmp_path: Path, arithmetic: str, words: tuple[str, ...]) -> None:
    """Over the hub and with a report, and in one process."""
    given = ("--controller", "mylaw", "--arithmetic", arithmetic, *words)
    done = railhil(law_site, "run", *given, "--out", tmp_path / "run", "--quiet")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"mylaw {arithmetic} (measured)" in done.stdout
    scores = json.loads((tmp_path / "run" / "score.json").read_text())
    assert scores["telemetry"]["wraps"] == 0


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.needs_compiler
def test_the_law_is_audited_and_exported(law_site: Path, tmp_path: Path) -> None:
    done = railhil(law_site, "audit", "lvshun_tieshan", "--controller", "mylaw", "--runs", "0")
    assert done.returncode == 0, done.stdout + done.stderr
    done = railhil(law_site, "export-c", "mylaw", "--out", str(tmp_path / "c"))
    assert done.returncode == 0, done.stdout + done.stderr
    make_check(tmp_path / "c")


def test_the_name_of_an_installed_law_or_system_is_taken(law_site: Path, system_site: Path, tmp_path: Path) -> None:
    for site, kind in ((law_site, "law"), (system_site, "system")):
        done = railhil(site, "new", kind, f"my{kind}", cwd=tmp_path)
        assert done.returncode == 2
        assert f"NAME: found 'my{kind}', allowed a name that no installed {kind} has" in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.needs_compiler
def test_the_system_goes_through_every_command(made: Path, system_site: Path, tmp_path: Path) -> None:
    scenario = str(made / "mysystem" / "mysystem.toml")

    def done(*words: str) -> str:
        found = railhil(system_site, *words, cwd=tmp_path)
        assert found.returncode == 0, found.stdout + found.stderr
        return found.stdout

    done("run", scenario, "--out", "hub", "--quiet")
    done("run", scenario, "--out", "local", "--no-report", "--bus", "local")
    hub, local = (json.loads((tmp_path / name / "certificate.json").read_text()) for name in ("hub", "local"))
    assert (hub["system"], hub["controller"], hub["verdict"]) == ("mysystem", "hold", "PASS")
    assert hub["frames_sha256"] == local["frames_sha256"]
    page = (tmp_path / "hub" / "report.html").read_text(encoding="utf-8")
    for said in ("The cart over time", "12 s; allowed ±0.02 m", "2 kg", "Arrived", "end error", "overshoot"):
        assert said in page
    assert set(json.loads(done("score", "hub", "--json"))["scores"]) == {"error_m", "overshoot_m"}
    # Beside the other, as it names the files of the folder.
    done("report", "hub", "--out", "hub/again.html")
    assert (tmp_path / "hub" / "again.html").read_text(encoding="utf-8") == page
    done("compare", scenario, "--out", "compared", "--bus", "local", "--no-report")
    done("campaign", scenario, "--runs", "3", "--out", "campaign")
    found = json.loads((tmp_path / "campaign" / "summary.json").read_text())["laws"]["hold"]
    assert found["inside"]["pass"]["runs"] == 3
    audit = json.loads(done("audit", scenario, "--runs", "3", "--json"))
    assert (audit["met"], list(audit["commands"])) == (True, ["force"])
    done("export-c", "hold", scenario, "--out", "c")
    make_check(tmp_path / "c")


@pytest.mark.slow
def test_a_scenario_may_build_upon_one_of_a_plugged_in_system(made: Path, system_site: Path, tmp_path: Path) -> None:
    base = made / "mysystem" / "mysystem.toml"
    path = tmp_path / "far.toml"
    assert railhil(system_site, "new", "scenario", "far", "--extends", str(base), "--out", str(path)).returncode == 0
    text = path.read_text(encoding="utf-8")
    assert "# mass of the cart (in kg; no default; number above 0 to 1000)\n#mass_kg = 2.0\n" in text
    assert "# friction, proportional to speed (in N/(m/s); default 0; number from 0 to 1000)\n" in text
    path.write_text(text.replace("#target_m = 2.0", "target_m = 3.0"), encoding="utf-8")
    done = railhil(system_site, "run", str(path), "--bus", "local", "--quiet", "--no-report", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
