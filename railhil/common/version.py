"""The version in full: a release, or the commit of the working tree from which railhil runs or was built.

``0.2.0`` is the commit with the tag v0.2.0, and an installation of it. Any other commit is ``0.2.0+g1234567``, with
``.dirty`` where a file of the packages differs from the commit. The first part stands in pyproject.toml.
"""

from __future__ import annotations

import os
import subprocess
from functools import cache
from pathlib import Path

import railhil

#: The files on which results may depend; what else a tree holds makes no other version of it.
_BUILT = ("railhil", *railhil.AT_TOP, "pyproject.toml", "setup.py")
#: ``git archive`` writes the commit and its tags into this file.
_ARCHIVED = ".git_archival.txt"
_FORMAT = "%h %D"
_TIMEOUT_S = 10.0


@cache
def full_version() -> str:
    """The version of the running railhil; that of a working tree is asked of git once in a process."""
    tree = Path(railhil.__path__[0]).parent
    if not ((tree / ".git").exists() and (tree / "pyproject.toml").is_file()):
        from importlib.metadata import version

        return version("railhil")
    import tomllib

    with (tree / "pyproject.toml").open("rb") as file:
        base = str(tomllib.load(file)["project"]["version"])
    return base + label(tree, base)


def label(tree: Path, base: str) -> str:
    """The part of the version that names the commit of a tree: ``+g1234567``, or nothing for a release.

    :param base: the version in its pyproject.toml. A tree without a record of its commit is taken for a release, one
        whose record cannot be read is ``+unknown``.
    """
    if not (tree / ".git").exists():
        archived = tree / _ARCHIVED
        text = archived.read_text(encoding="ascii") if archived.is_file() else "$"
        return "" if text.startswith("$") else _named(text, base)
    try:
        said = _git(tree, "log", "-1", "--no-show-signature", "--abbrev=7", f"--format={_FORMAT}", "--decorate=short")
        # git reads the files only where their size or time is not that of the commit.
        changed = _git(tree, "diff", "--name-only", "--no-ext-diff", "HEAD", "--", *_BUILT)
    except (OSError, subprocess.SubprocessError):
        # No git here, or it refuses a tree of another user.
        return "+unknown"
    return _named(said, base, bool(changed))


def _named(said: str, base: str, is_dirty: bool = False) -> str:
    """The label by what git says of the commit.

    :param said: in :data:`_FORMAT`, as ``1234567 HEAD -> main, tag: v0.2.0``.
    """
    commit, _, names = said.strip().partition(" ")
    if f"tag: v{base}" in names.split(", ") and not is_dirty:
        return ""
    return f"+g{commit}" + ".dirty" * is_dirty


def _git(tree: Path, *words: str) -> str:
    """What git prints; hooks of git set variables that would name another repository."""
    own = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    return subprocess.run(
        ["git", "--no-optional-locks", "-C", str(tree), *words], env=own, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=_TIMEOUT_S, check=True,
    ).stdout  # fmt: skip
