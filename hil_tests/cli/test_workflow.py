"""The workflows of hosted CI, which cannot run here: GitHub's schema, shell text that parses and contains no
expressions, make targets that exist; the step that runs the bench for other repositories is executed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from hil_tests.support.paths import ROOT

_FOLDER = ROOT / ".github" / "workflows"
_WORKFLOWS = sorted(path.name for path in _FOLDER.glob("*.yml"))
_SHORT = ROOT / "hil_tests" / "transport" / "compose" / "short_move.toml"
#: What GitHub starts for ``shell: bash``.
_BASH = ["bash", "--noprofile", "--norc", "-eo", "pipefail"]


def workflow(name: str) -> dict[str, Any]:
    """One workflow; YAML 1.1 reads its key ``on`` as True."""
    return yaml.safe_load((_FOLDER / name).read_text())


def steps(name: str) -> Iterator[dict[str, Any]]:
    """The steps of all its jobs; a job that is another workflow has none of its own."""
    for job in workflow(name)["jobs"].values():
        yield from job.get("steps", [])


def scripts() -> list[str]:
    """All shell text, with the text of an inner ``sh -ec '...'`` beside the outer one."""
    found = [step["run"] for name in _WORKFLOWS for step in steps(name) if "run" in step]
    return found + [inner for text in found for inner in re.findall(r"sh -ec '([^']*)'", text)]


def make_targets() -> set[str]:
    """Targets that the workflows make."""
    lines = [line for text in scripts() for line in text.splitlines() if "apt-get" not in line]
    return set(re.findall(r"\bmake ([a-z.][\w./-]*)", "\n".join(lines)))


@pytest.mark.parametrize(
    ("schema", "pattern"),
    [
        ("github-workflows", ".github/workflows/*.yml"),
        ("github-issue-forms", ".github/ISSUE_TEMPLATE/[!c]*.yml"),
        ("github-issue-config", ".github/ISSUE_TEMPLATE/config.yml"),
        ("citation-file-format", "CITATION.cff"),
    ],
)
def test_schema_of_what_the_hosting_service_reads(schema: str, pattern: str) -> None:
    files = [str(path) for path in ROOT.glob(pattern)]
    assert files
    done = subprocess.run(
        [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}", *files],
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_shell_text_parses_and_takes_no_expressions():
    """An expression in shell text is how a foreign pull request runs commands of its own."""
    assert len(scripts()) > 8
    for text in scripts():
        assert "${{" not in text
        done = subprocess.run(["bash", "-n"], input=text, capture_output=True, text=True, timeout=10, check=False)
        assert done.returncode == 0, f"{text}\n{done.stderr}"


def test_every_target_exists():
    assert {"lint", "test-here", "test-vcan", "test-docker"} <= make_targets()
    for target in sorted(make_targets()):
        done = subprocess.run(
            ["make", "-n", target], cwd=ROOT, capture_output=True, text=True, timeout=30, check=False,
            env={name: value for name, value in os.environ.items() if not name.startswith("MAKE")},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr


def test_a_version_of_an_action_is_a_commit():
    """A tag can be moved to other code, a commit cannot."""
    for name in _WORKFLOWS:
        for step in steps(name):
            assert re.fullmatch(r"actions/[a-z-]+@[0-9a-f]{40}", step.get("uses", f"actions/none@{'0' * 40}"))


def bench_step(folder: Path, **inputs: str) -> subprocess.CompletedProcess[str]:
    """The step of the reusable workflow that runs the bench, with its inputs, in ``folder``."""
    (step,) = (step for step in steps("bench.yml") if step.get("name") == "Run")
    defaults = workflow("bench.yml")[True]["workflow_call"]["inputs"]
    names = {variable: re.fullmatch(r"\$\{\{ inputs\.(\w+) \}\}", text) for variable, text in step["env"].items()}
    values = {variable: inputs.get(m[1], str(defaults[m[1]].get("default"))) for variable, m in names.items() if m}
    assert len(values) == len(step["env"])
    (folder / "step.sh").write_text(step["run"])
    search = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    return subprocess.run(
        [*_BASH, "step.sh"], cwd=folder, capture_output=True, text=True, timeout=100, check=False,
        env={**os.environ, **values, "PATH": search, "GITHUB_STEP_SUMMARY": "summary.md"},
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.loop
def test_bench_step_leaves_a_report_and_a_summary(tmp_path):
    done = bench_step(tmp_path, scenario=str(_SHORT), arithmetic="float64", seed="2")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "bench" / "report.html").is_file()
    assert "PASS" in (tmp_path / "summary.md").read_text()


def test_bench_step_leaves_law_and_arithmetic_to_the_system() -> None:
    inputs = workflow("bench.yml")[True]["workflow_call"]["inputs"]
    assert {inputs[name]["default"] for name in ("controller", "arithmetic")} == {""}


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(("name", "value"), [("scenario", "$(touch broken)"), ("parameters", "none.toml")])
def test_bench_step_fails_when_the_run_does(tmp_path, name, value):
    done = bench_step(tmp_path, **{"scenario": str(_SHORT), name: value})
    assert done.returncode == 2, done.stdout + done.stderr
    assert value in (tmp_path / "summary.md").read_text()
    assert not (tmp_path / "broken").exists()


def test_page_of_a_release_is_the_part_of_the_changelog(tmp_path: Path) -> None:
    (step,) = (step for step in steps("release.yml") if step.get("name") == "The page of the release")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    for name, text in {"gh": '#!/bin/sh\necho "$@" >words\n', "step.sh": step["run"]}.items():
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    (tmp_path / "CHANGELOG.md").write_text(text)
    subprocess.run(
        [*_BASH, "step.sh"], cwd=tmp_path, timeout=60, check=True,
        env={"PATH": f"{tmp_path}:{os.environ['PATH']}", "GITHUB_REF_NAME": f"v{version}"},
    )  # fmt: skip
    notes = (tmp_path / "notes.md").read_text()
    assert re.search(rf"^## \[{re.escape(version)}\].*\n{re.escape(notes)}(## |\Z)", text, re.M)
    assert f"create v{version} " in (tmp_path / "words").read_text()


def test_tag_of_a_release_is_a_version() -> None:
    """As GitHub reads patterns: a full stop is itself, a plus sign repeats what stands before it."""
    (pattern,) = workflow("release.yml")[True]["push"]["tags"]
    wanted = re.compile(pattern.replace(".", r"\."))
    assert [tag for tag in ("v0.2.0", "v1.10.0", "v0.2.0rc1", "v0.2", "vehicle") if wanted.fullmatch(tag)] == [
        "v0.2.0",
        "v1.10.0",
    ]


def test_release_comes_after_all_tests_and_its_page_last() -> None:
    """One job makes all that is published: without the image there is no page."""
    jobs = workflow("release.yml")["jobs"]
    assert jobs["tests"] == {"uses": "./.github/workflows/ci.yml"}
    assert "workflow_call" in workflow("ci.yml")[True]
    (publishing,) = (job for job in jobs.values() if "permissions" in job)
    assert publishing["needs"] == "tests"
    names = [step.get("name") for step in publishing["steps"]]
    assert names.index("Into the registry") < names.index("The page of the release") == len(names) - 1


def test_job_that_publishes_takes_nothing_from_a_cache_and_leaves_no_credentials() -> None:
    for step in steps("release.yml"):
        assert not {"cache", "cache-from"} & step.get("with", {}).keys()
        assert not step.get("uses", "").startswith("actions/cache@")
        if step.get("uses", "").startswith("actions/checkout@"):
            assert step["with"]["persist-credentials"] is False


@pytest.mark.parametrize(("place", "code"), [("main", 0), ("main~1", 0), ("side", 1)])
def test_release_is_made_of_a_commit_of_main(tmp_path: Path, place: str, code: int) -> None:
    (step,) = (step for step in steps("release.yml") if step.get("name") == "The tag is on main")
    own = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "advice.detachedHead=false"]
    main, side = (["commit", "-q", "--allow-empty", "-m", name] for name in ("main", "side"))
    setup = [["init", "-q", "-b", "main", "."], main, main, ["update-ref", "refs/remotes/origin/main", "main"]]
    setup += [["checkout", "-q", "-b", "side"], side]
    for words in (*setup, ["checkout", "-q", "--detach", place]):
        subprocess.run([*own, *words], cwd=tmp_path, check=True)
    assert subprocess.run([*_BASH, "-c", step["run"]], cwd=tmp_path, check=False).returncode == code


def test_version_is_one_in_every_file_that_states_it() -> None:
    """pyproject.toml is the source; a release has a date."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["version"] == version
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## [{version}] - {cited['date-released']}\n" in changes


# -- what pip installs there -------------------------------------------------------------------------------------------


_PYTHONS = ("3.11", "3.12", "3.13")


def wanted_by(lines: list[str], python: str) -> list[Requirement]:
    """Those requirements that a Python has on the platform of the lock."""
    machine = {"python_version": python, "python_full_version": f"{python}.0", "sys_platform": "linux"}
    machine |= {"platform_machine": "x86_64", "implementation_name": "cpython"}
    return [one for one in map(Requirement, lines) if not one.marker or one.marker.evaluate(machine)]


def locked_packages(name: str, python: str) -> dict[str, Version]:
    """Package -> version that a lock file has for a Python; every entry must be one version with hashes."""
    text = re.sub(r"^#.*\n", "", (ROOT / "requirements" / name).read_text(), flags=re.M)
    entries = re.findall(r"^(\S.*?) \\\n((?:    --hash=sha256:[0-9a-f]{64}(?: \\)?\n)+)", text, re.M)
    assert "".join(f"{line} \\\n{hashes}" for line, hashes in entries) == text
    found = wanted_by([line for line, _ in entries], python)
    assert len({one.name for one in found}) == len(found)
    return {canonicalize_name(one.name): Version(str(one.specifier).removeprefix("==")) for one in found}


@pytest.mark.parametrize("python", _PYTHONS)
@pytest.mark.parametrize("name", ["ci.txt", "bench.txt"])
def test_the_lock_names_all_that_the_project_needs(name: str, python: str) -> None:
    """pip refuses with --require-hashes what is not in it: `make lock` after a change of pyproject.toml.

    Also those extras that no workflow installs by their name: their libraries are needed by the tests."""
    document = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = document["project"]["optional-dependencies"]
    wanted = [*document["build-system"]["requires"], *document["project"]["dependencies"]]
    wanted += [line for extra in (extras if name == "ci.txt" else ["report"]) for line in extras[extra]]
    found = locked_packages(name, python)
    for one in wanted_by(wanted, python):
        assert found[canonicalize_name(one.name)] in one.specifier, str(one)


def test_the_smaller_lock_is_a_part_of_the_other() -> None:
    for python in _PYTHONS:
        assert locked_packages("bench.txt", python).items() <= locked_packages("ci.txt", python).items()


def test_the_lock_serves_the_pythons_of_the_workflow() -> None:
    assert tuple(workflow("ci.yml")["jobs"]["tests"]["strategy"]["matrix"]["python"]) == _PYTHONS


def test_the_workflows_install_nothing_without_a_hash() -> None:
    """But the bench itself, and in bench.yml the distribution of the caller."""
    for job in workflow("ci.yml")["jobs"].values():
        text = "\n".join(step.get("run", "") for step in job["steps"])
        assert text.index("make locked") < re.search(r"make (lint|test|docs)[\w-]*", text).start()  # type: ignore[union-attr]
        assert "pip install" not in text
    lines = [line.strip() for text in scripts() for line in text.splitlines() if "pip install" in line]
    assert len(lines) == 4
    assert ["--require-hashes" in line or "--no-deps" in line or '"$INSTALL"' in line for line in lines] == [True] * 4
    done = subprocess.run(["make", "-n", "locked"], cwd=ROOT, capture_output=True, text=True, timeout=30, check=True)
    assert "--require-hashes" in done.stdout
