"""Finds the key of a user's scenario that makes its base scenario invalid.

A check names the key that fails, which may be in a shipped file: a speed limit set below a shipped target curve would
be reported as an error of the curve. The shipped file is valid by itself, so the key to report is the one without which
the scenario loads.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA, Layers, Without
from railhil.scenarios.settings import SET
from railhil.scenarios.validation import dotted

#: Number of load attempts for one message.
_TRIES_MAX = 60


def blamed(layers: Layers, error: InputError, loads: Callable[[Without], bool]) -> InputError:
    """The error to report: with the user's file and key that caused it, if there is one.

    :param loads: tells whether the scenario loads without one key of one of its files.
    """
    own = [(path, keys) for path, keys in layers.leaves() if _higher(path, Path(error.file))]
    section = error.key.partition(".")[0]
    # Keys closest to the one that fails come first, then whole tables, then whole files.
    own.sort(key=lambda leaf: leaf[1][0] != section)
    tables = list(dict.fromkeys((path, keys[:1]) for path, keys in own))
    files = list(dict.fromkeys((path, ()) for path, _ in own))
    for path, keys in dict.fromkeys([*own, *tables, *files][:_TRIES_MAX]):
        if loads((path, keys)):
            found = layers.value(path, keys)
            allowed = f"what goes with {Path(error.file).name}"
            return InputError(path, dotted(keys), found, allowed, f"{error.key}: {error.difference}")
    return error


def _higher(path: Path, broken: Path) -> bool:
    """Whether a file has priority over the one named by a check: the command line over all files, own files over
    shipped ones."""
    if broken == SET or path == broken:
        return False
    return path == SET or (broken.is_relative_to(DATA) and not path.is_relative_to(DATA))
