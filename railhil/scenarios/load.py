"""Load a scenario by its shipped name or from a TOML file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from railhil.common.errors import InputError, Words, did_you_mean, near_file, short_repr
from railhil.scenarios.layers import DATA, Layers, Without, shipped_name, shipped_names, short_name
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.sentence_rows import SENTENCES
from railhil.scenarios.settings import SET
from railhil.scenarios.system import DEFAULT, system_named
from railhil.scenarios.validation import join_keys

if TYPE_CHECKING:
    from railhil.systems.ato.scenario.model import Scenario

RUNS = DATA / "runs"


def names() -> list[str]:
    """Names of the shipped scenarios, sorted."""
    return shipped_names(RUNS)


def short_names() -> dict[str, str]:
    """Short name of each shipped scenario, by its whole name."""
    known = names()
    return {name: short_name(name, known) for name in known}


def load(name_or_path: str | Path, settings: Sequence[str] = (), faults: Sequence[str] = ()) -> Scenario:
    """Like :func:`load_any`, for code that works only with railhil's own system ``ato``.

    Raises :class:`~railhil.common.errors.InputError` also for a scenario of another system.
    """
    scenario = load_any(name_or_path, settings, faults)
    if scenario.system != DEFAULT:
        allowed = f"{DEFAULT}: nothing else has what this needs"
        raise InputError(find(name_or_path), "system", scenario.system, allowed)
    return cast("Scenario", scenario)


def load_any(name_or_path: str | Path, settings: Sequence[str] = (), faults: Sequence[str] = ()) -> AnyScenario:
    """The scenario of a shipped name (or the beginning of one), or of a path that ends in ``.toml``, of its system.

    :param settings: keys set in addition, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    :param faults: faults in addition to those of its files (:mod:`railhil.faults.language`).

    Raises :class:`~railhil.common.errors.InputError` (one line) for anything in the files that is not allowed.
    """
    path = find(name_or_path)
    layers = Layers(path, settings, faults=faults)

    def loads(without: Without) -> bool:
        try:
            _read(Layers(path, settings, without, faults))
        except InputError:
            return False
        return True

    try:
        return _read(layers)
    except InputError as error:
        raise invalid_key(layers, error, loads) from error.__cause__


def _read(layers: Layers) -> AnyScenario:
    name = layers.merge().get("system", DEFAULT)
    system = system_named(name if isinstance(name, str) else short_repr(name), layers.origin("system"))
    return system.scenario_kind.read(layers)


def find(name_or_path: str | Path) -> Path:
    """The file behind a scenario name or path. Raises :class:`InputError` when there is none."""
    text = str(name_or_path)
    if text.endswith(".toml"):
        path = Path(text)
        if not path.is_file():
            found = Words("is no regular file" if path.exists() else "does not exist")
            raise InputError(path, "", found, "a scenario file (TOML)", near_file(path))
        return path
    name = shipped_name(text, RUNS)
    if name is None:
        known = names()
        own = Path(f"{text}.toml")
        several = [other for other in known if text and other.startswith(text)]
        hint = None if several else did_you_mean(text, {*known, *short_names().values()})
        if own.is_file():
            hint = f"did you mean {own}?"
        names_allowed = f"one of {', '.join(several)}" if several else "a name that railhil scenarios lists"
        allowed = f"a path ending in .toml, or {names_allowed}"
        raise InputError("scenario", "name", text, allowed, hint)
    return RUNS / f"{name}.toml"


def sentences(name_or_path: str | Path, settings: Sequence[str] = ()) -> dict[str, Any]:
    """The tables of a scenario with which its runs are judged by sentences: ``requirement`` and ``define``; empty if it
    has no requirement.

    :raises InputError: a file cannot be read.
    """
    table = Layers(find(name_or_path), settings).merge()
    return {key: table[key] for key in SENTENCES if key in table} if table.get(SENTENCES[0]) else {}


def stable_name(name_or_path: str) -> str:
    """The name to record for a scenario: full name or absolute path, valid from any folder.

    Raises :class:`InputError` when there is none.
    """
    path = find(name_or_path)
    return str(path.resolve()) if name_or_path.endswith(".toml") else path.stem


#: Number of load attempts for one message.
_TRIES_MAX = 60


def invalid_key(layers: Layers, error: InputError, loads: Callable[[Without], bool]) -> InputError:
    """The error to report: with the user's file and key that caused it, if there is one.

    A check names the key that fails, which may be in a shipped file: a speed limit set below a shipped target curve
    would be reported as an error of the curve. The shipped file is valid by itself, so the key to report is the one
    whose removal lets the scenario load.

    :param loads: tells whether the scenario loads without one key of one of its files.
    """
    own = [(path, keys) for path, keys in layers.leaves() if _has_priority(path, Path(error.file))]
    section = error.key.partition(".")[0]
    # Keys closest to the one that fails come first, then whole tables, then whole files.
    own.sort(key=lambda leaf: leaf[1][0] != section)
    tables = list(dict.fromkeys((path, keys[:1]) for path, keys in own))
    files = list(dict.fromkeys((path, ()) for path, _ in own))
    for path, keys in dict.fromkeys([*own, *tables, *files][:_TRIES_MAX]):
        if loads((path, keys)):
            found = layers.value(path, keys)
            allowed = f"what goes with {Path(error.file).name}"
            return InputError(path, join_keys(keys), found, allowed, f"{error.key}: {error.difference}")
    return error


def _has_priority(path: Path, broken: Path) -> bool:
    """Whether a file has priority over the one named by a check: the command line over all files, own files over
    shipped ones."""
    if broken == SET or path == broken:
        return False
    return path == SET or (broken.is_relative_to(DATA) and not path.is_relative_to(DATA))
