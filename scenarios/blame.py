"""Which key of a user's scenario is to blame when it breaks a file that it builds upon.

A check names the key that does not hold, and that may stand in a shipped file: who lowers the speed limit below a
shipped target curve is told of the curve. The shipped file holds by itself, so the key to name is the one without which
the scenario loads.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA, Layers, Without
from railhil.scenarios.settings import SET
from railhil.scenarios.validation import dotted

#: Loadings that are tried for one message.
_TRIES_MAX = 60


def blamed(layers: Layers, error: InputError, loads: Callable[[Without], bool]) -> InputError:
    """The error as it is to be told: on the file and key of the user that caused it, where there is one.

    :param loads: whether the scenario loads without one key of one of its files.
    """
    own = [(path, keys) for path, keys in layers.leaves() if _higher(path, Path(error.file))]
    section = error.key.partition(".")[0]
    # What is nearest to the key that does not hold comes first; then whole tables, then whole files.
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
    """Whether a file stands above the one that a check has named: the command line over all, own files over shipped."""
    if broken == SET or path == broken:
        return False
    return path == SET or (broken.is_relative_to(DATA) and not path.is_relative_to(DATA))
