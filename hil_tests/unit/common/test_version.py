"""The version says which release or which commit this is."""

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
    (tree / ".git_archival.txt").write_text("$Format:%h %D$\n")
    (tree / ".gitattributes").write_text(".git_archival.txt export-subst\n")
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


@pytest.mark.parametrize("options", [[], ["-a", "-m", "Release"]], ids=["light", "annotated"])
def test_release_is_the_commit_with_its_tag(tree: Path, options: list[str]) -> None:
    _git(tree, "tag", "v0.1.0")
    _git(tree, "tag", *options, "v0.2.0")
    assert label(tree, "0.2.0") == ""
    (tree / "bus" / "frame.py").write_text("LENGTH = 9\n")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}.dirty"
    _git(tree, "commit", "-q", "-a", "-m", "Second")
    assert label(tree, "0.2.0") == f"+g{_commit(tree)}"


def test_archive_of_a_commit_is_named_by_it(tree: Path, tmp_path: Path) -> None:
    for tag, expected in ((None, f"+g{_commit(tree)}"), ("v0.2.0", "")):
        if tag:
            _git(tree, "tag", tag)
        _git(tree, "archive", "--prefix=zip/", "-o", str(tmp_path / "zip.tar"), "HEAD")
        shutil.unpack_archive(tmp_path / "zip.tar", tmp_path)
        assert label(tmp_path / "zip", "0.2.0") == expected


def test_copy_without_git_is_the_plain_version(tree: Path) -> None:
    shutil.rmtree(tree / ".git")
    assert label(tree, "0.2.0") == ""


def test_repository_that_git_cannot_read_is_no_release(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tree / ".git" / "HEAD").unlink()
    assert label(tree, "0.2.0") == "+unknown"
    monkeypatch.setenv("PATH", "")
    assert label(tree, "0.2.0") == "+unknown"


def test_variables_of_a_git_hook_name_no_other_repository(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = _commit(tree)
    monkeypatch.setenv("GIT_DIR", str(tree / "elsewhere"))
    assert label(tree, "0.2.0") == f"+g{wanted}"
