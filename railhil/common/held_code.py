"""The code on which a law or a system may depend: its package and its distribution."""

from __future__ import annotations

import hashlib
import importlib.util
import os
from collections.abc import Iterator
from functools import cache
from importlib.metadata import Distribution
from pathlib import Path

import railhil

#: The package whose builds (compiled, sources) give the same results, so that only its sources and tables count.
OURS = __name__.partition(".")[0]
_SOURCES = (".py", ".toml", ".dbc", ".csv")


def place_of(name: str) -> Path:
    """A file or folder of railhil by its name below the package.

    :raises FileNotFoundError: there is none.
    """
    own, *beside = railhil.__path__
    # Beside the package, a checkout has folders of other names, which are no part of it.
    for folder in (own, *(beside if Path(name).parts[0] in railhil.AT_TOP else ())):
        place = Path(folder, name)
        if place.exists():
            return place
    raise FileNotFoundError(f"{OURS}/{name}")


@cache
def held_sha256(module: str, distribution: Distribution | None = None) -> str:
    """Hash over all files on which the results of a module may depend (names and contents, in order of names).

    These are the files of its top-level package, and those of the distribution that it comes from: a module that it
    imports from there may change as well. Files that Python makes of them (``__pycache__``) do not count.

    :param module: name with dots.
    :param distribution: None: only the top-level package.
    """
    tops = {module.partition(".")[0]}
    found: dict[str, Path] = {}
    if distribution is not None and OURS not in tops:
        tops |= set((distribution.read_text("top_level.txt") or "").split())
        found = {str(file): Path(str(distribution.locate_file(file))) for file in distribution.files or ()}
        found = {name: path for name, path in found.items() if not _is_metadata(name)}
    for top in tops:
        found |= _files_of(top)
    digest = hashlib.sha256()
    for name in sorted(found):
        if found[name].is_file() and _counts(name):
            digest.update(name.encode() + b"\0" + found[name].read_bytes() + b"\0")
    return digest.hexdigest()


def _files_of(top: str) -> dict[str, Path]:
    """The files of a top-level package or module by their names below the folder that it is in.

    Files of railhil have the names that they have in a wheel.
    """
    if top == OURS:
        roots = {top: Path(railhil.__path__[0]), **{f"{top}/{name}": place_of(name) for name in railhil.AT_TOP}}
        return {f"{folder}/{name}": path for folder, root in roots.items() for name, path in _below(root)}
    spec = importlib.util.find_spec(top)
    if spec is None:
        return {}
    if spec.submodule_search_locations is None:
        return {Path(spec.origin).name: Path(spec.origin)} if spec.origin is not None else {}
    return {f"{top}/{name}": path for root in spec.submodule_search_locations for name, path in _below(Path(root))}


def _below(root: Path) -> Iterator[tuple[str, Path]]:
    """Files below a folder, through symbolic links, each folder once."""
    seen = set()
    for folder, folders, files in os.walk(root, followlinks=True):
        where = os.path.realpath(folder)
        if where in seen:
            folders.clear()
            continue
        seen.add(where)
        for name in files:
            path = Path(folder, name)
            yield path.relative_to(root).as_posix(), path


def _is_metadata(name: str) -> bool:
    """Whether a file of a distribution is about its installation."""
    first = name.partition("/")[0]
    return first == ".." or first.endswith((".dist-info", ".egg-info", ".pth")) or first.startswith("__editable__")


def _counts(name: str) -> bool:
    if name.startswith(f"{OURS}/"):
        return name.endswith(_SOURCES)
    return "__pycache__" not in name and not name.endswith(".pyc")
