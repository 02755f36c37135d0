"""The workflows of hosted CI, which cannot run here: GitHub's schema, shell text that parses and contains no
expressions, make targets that exist; the step that runs the bench for other repositories is executed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

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
    """The steps of all its jobs."""
    for job in workflow(name)["jobs"].values():
        yield from job["steps"]


def scripts() -> list[str]:
    """All shell text, with the text of an inner ``sh -ec '...'`` beside the outer one."""
    found = [step["run"] for name in _WORKFLOWS for step in steps(name) if "run" in step]
    return found + [inner for text in found for inner in re.findall(r"sh -ec '([^']*)'", text)]


def make_targets() -> set[str]:
    """Targets that the workflows make."""
    lines = [line for text in scripts() for line in text.splitlines() if "apt-get" not in line]
    return set(re.findall(r"\bmake ([a-z.][\w./-]*)", "\n".join(lines)))


def test_schema_of_github():
    files = [str(_FOLDER / name) for name in _WORKFLOWS]
    done = subprocess.run(
        [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-workflows", *files],
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
    assert {"lint", "test-here", "test-vcan", "test-compose"} <= make_targets()
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


@pytest.mark.parametrize(("name", "value"), [("scenario", "$(touch broken)"), ("parameters", "none.toml")])
def test_bench_step_fails_when_the_run_does(tmp_path, name, value):
    done = bench_step(tmp_path, **{"scenario": str(_SHORT), name: value})
    assert done.returncode == 2, done.stdout + done.stderr
    assert value in (tmp_path / "summary.md").read_text()
    assert not (tmp_path / "broken").exists()
