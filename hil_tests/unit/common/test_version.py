"""The version says which release or which commit this is; only a tree's own repository can say so."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from railhil.common.version import label


def _git(tree: Path, *words: str) -> str:
    own = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    return subprocess.run(["git", *own, *words], cwd=tree, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository with one commit."""
    tree = tmp_path / "tree"
    (tree / "bus").mkdir(parents=True)
    (tree / "bus" / "frame.py").write_text("LENGTH = 8\n")
    (tree / "notes.md").write_text("Notes.\n")
    (tree / ".gitignore").write_text("*.pyc\n")
    _git(tree, "init", "-q")
    _git(tree, "add", ".")
    _git(tree, "commit", "-q", "-m", "First")
    return tree


def _commit(tree: Path) -> str:
    return _git(tree, "rev-parse", "--short=7", "HEAD")


def test_working_tree_is_named_by_its_commit(tree: Path) -> None:
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}"


def test_changed_file_of_a_package_makes_the_tree_dirty(tree: Path) -> None:
    (tree / "notes.md").write_text("Other notes.\n")
    assert not label(tree, "0.2.0").endswith(".dirty")
    (tree / "bus" / "frame.py").write_text("LENGTH = 9\n")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}.dirty"


def test_new_file_of_a_package_makes_the_tree_dirty(tree: Path) -> None:
    """A build takes it; what git is told to ignore is made by builds and runs."""
    _git(tree, "config", "status.showUntrackedFiles", "no")
    _git(tree, "tag", "v0.2.0")
    (tree / "more.md").write_text("More notes.\n")
    (tree / "bus" / "frame.pyc").write_text("")
    assert label(tree, "0.2.0") == ""
    (tree / "bus" / "more.py").write_text("LENGTH = 9\n")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}.dirty"


@pytest.mark.parametrize(("key", "value"), [("core.abbrev", "12"), ("log.excludeDecoration", "refs/tags/*")])
def test_settings_of_git_change_no_version(tree: Path, key: str, value: str) -> None:
    _git(tree, "config", key, value)
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}"
    _git(tree, "tag", "v0.2.0")
    assert label(tree, "0.2.0") == ""


@pytest.mark.parametrize("options", [[], ["-a", "-m", "Release"]], ids=["light", "annotated"])
def test_release_is_the_commit_with_its_tag(tree: Path, options: list[str]) -> None:
    _git(tree, "tag", "v0.1.0")
    _git(tree, "tag", *options, "v0.2.0")
    assert label(tree, "0.2.0") == ""
    (tree / "bus" / "frame.py").write_text("LENGTH = 9\n")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}.dirty"
    _git(tree, "commit", "-q", "-a", "-m", "Second")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}"


def test_tree_without_repository_is_no_release(tree: Path) -> None:
    """Also in a tagged repository of something else."""
    _git(tree, "tag", "v0.2.0")
    shutil.copytree(tree / "bus", tree / "vendored" / "bus")
    assert label(tree / "vendored", "0.2.0") == "+unknown"


@pytest.mark.parametrize("expected", ["", "+g1234567", "+g1234567.dirty"])
def test_source_archive_keeps_its_version(tmp_path: Path, expected: str) -> None:
    (tmp_path / "PKG-INFO").write_text(f"Metadata-Version: 2.4\nName: railhil\nVersion: 0.2.0{expected}\n")
    assert label(tmp_path, "0.2.0") == expected


@pytest.mark.parametrize("left", ["empty", "broken", "without commit"])
def test_repository_above_is_not_that_of_the_tree(tree: Path, left: str) -> None:
    _git(tree, "tag", "v0.2.0")
    inner = tree / "vendored"
    (inner / ".git").mkdir(parents=True)
    if left != "empty":
        _git(inner, "init", "-q")
    if left == "broken":
        (inner / ".git" / "HEAD").unlink()
    assert label(inner, "0.2.0") == "+unknown"


def test_repository_that_git_cannot_read_is_no_release(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tree / ".git" / "HEAD").unlink()
    assert label(tree, "0.2.0") == "+unknown"
    monkeypatch.setenv("PATH", "")
    assert label(tree, "0.2.0") == "+unknown"


def test_variables_of_a_git_hook_name_no_other_repository(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = _commit(tree)
    monkeypatch.setenv("GIT_DIR", str(tree / "elsewhere"))
    assert label(tree, "0.2.0") == f"+g{wanted}"
