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
#: So many digits of a commit in every clone: those of ``git log`` depend on how much a clone holds.
_DIGITS = 7
_TIMEOUT_S = 10.0


@cache
def full_version() -> str:
    """The version of the running railhil; that of a working tree is asked of git once in a process."""
    tree = Path(railhil.__path__[0]).parent
    if not (tree / "pyproject.toml").is_file():
        from importlib.metadata import version

        return version("railhil")
    import tomllib

    with (tree / "pyproject.toml").open("rb") as file:
        base = str(tomllib.load(file)["project"]["version"])
    return base + label(tree, base)


def label(tree: Path, base: str) -> str:
    """The part of the version that names the commit of a tree: ``+g1234567``, or nothing for a release.

    A source archive keeps the label that it was made with. Of any other tree only its own repository can tell the
    commit; without one that git reads, it is ``+unknown``.

    :param base: the version in its pyproject.toml.
    """
    if not (tree / ".git").exists():
        if not (tree / "PKG-INFO").is_file():
            return "+unknown"
        from importlib.metadata import Distribution

        return Distribution.at(tree).version.removeprefix(base)
    try:
        # Where .git is no repository, git looks for one in the folders above: then the tree has a prefix in it.
        prefix, commit = _git(tree, "rev-parse", "--show-prefix", "HEAD").rsplit("\n", 2)[:2]
        if prefix:
            return "+unknown"
        # git reads the files only where their size or time is not that of the commit.
        if _git(tree, "status", "--porcelain", "--untracked-files=all", "--", *_BUILT):
            return f"+g{commit[:_DIGITS]}.dirty"
        is_release = bool(_git(tree, "tag", "--points-at", "HEAD", "--list", f"v{base}"))
    except (OSError, subprocess.SubprocessError):
        # No git here, or it refuses a tree of another user.
        return "+unknown"
    return "" if is_release else f"+g{commit[:_DIGITS]}"


def _git(tree: Path, *words: str) -> str:
    """What git prints; hooks of git set variables that would name another repository."""
    own = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    return subprocess.run(
        ["git", "--no-optional-locks", "-C", str(tree), *words], env=own, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=_TIMEOUT_S, check=True,
    ).stdout  # fmt: skip
