"""Reads scenario files with their references, and determines which file gives each value.

A scenario may ``extends`` another scenario, ``without`` some of its keys, and its ``[train]``, ``[line]`` and
``[target]`` may name a ``file``. Each of these is a layer; a key in a higher layer takes precedence, tables are merged
key by key, arrays are replaced as a whole.

Published results and sentences about chosen values belong to the file that gives them. If the run is another one, the
results are left out. If a file above it, or ``--set``, gives other values, the sentences name their file.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.user_files import given_text, refuse_unreadable
from railhil.faults import FAULT
from railhil.scenarios.sentence_rows import SENTENCES, list_rows, name_rows
from railhil.scenarios.settings import FOREIGN, SET, layer
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import Keys, join_keys

if TYPE_CHECKING:
    from railhil.scenarios.system import System
    from railhil.scenarios.task import TaskScenario
    from railhil.systems.ato.scenario.model import Scenario

DATA = Path(__file__).parent / "data"
_FOLDERS = {"train": "trains", "line": "lines", "target": "targets"}
_CHAIN_MAX = 8

#: A section with all of these keys is complete: another train or line, which inherits nothing.
COMPLETE = {
    "train": ("name", "mass_t", "length_m", "davis", "traction", "brake", "actuator_pole_per_s"),
    "line": ("name", "grade_permil", "speed_limit_kmh"),
    "target": (),
}
#: Keys that identify the scenario and its base, and so are never left out.
_KEPT = ("extends", "name", "title", "schema_version")

Table = dict[str, Any]
#: Keys that change nothing of a run: they explain the scenario, or are for those that make many runs of it.
_EXPLAINING = (*_KEPT, "assumptions", "published", *SENTENCES, "hunt")
#: A file and a key in it that is left out; without keys, the whole file except its reference to the base.
Without = tuple[Path, tuple[str, ...]]


@dataclass(slots=True)
class _Dropped:
    """A key that is not inherited: the file that says so, its place in the stack, whether a lower file has the key."""

    file: Path
    place: int
    given: bool = False


class Layers:
    """The files of one scenario, highest priority first, each with the part that it supplies.

    :param settings: keys from the command line (:mod:`railhil.scenarios.settings`), with priority over all files.
    :param without: one key to be ignored.
    :param faults: texts in addition to the rows of ``fault`` of the files.
    """

    def __init__(
        self,
        path: Path,
        settings: Sequence[str] = (),
        without: Without | None = None,
        faults: Sequence[str] = (),
    ) -> None:
        self.main = path
        self._faults = list(faults)
        self._without = without
        self._stack: list[tuple[Path, Table]] = []
        #: Complete scenario files as written.
        self._written: list[tuple[Path, Table]] = []
        #: Section that inherits nothing -> place in the stack of the file that closes it.
        self._closed: dict[str, int] = {}
        #: Section of which a lower file gives something that is not inherited -> place of the file that replaces it.
        self._replaced: dict[str, int] = {}
        self._target_made_anew: int | None = None
        #: Keys that are not inherited.
        self._dropped: dict[tuple[str, ...], _Dropped] = {}
        if settings:
            self._add_scenario(SET, self._leave_out(SET, layer(settings)))
        self._read_scenario(path)

    def leaves(self) -> Iterator[tuple[Path, tuple[str, ...]]]:
        """Every key of the scenario files and of the command line, as written there, with the file that gives it."""
        for path, table in self._written:
            yield from ((path, keys) for keys in _leaves(table) if keys[0] not in _KEPT)

    def value(self, path: Path, keys: tuple[str, ...]) -> object:
        """The value that a file gives for a key; for a table a description in words."""
        found: Any = dict(self._written)[path]
        for key in keys:
            found = found[key]
        return Words(f"keys {', '.join(found)}") if isinstance(found, dict) else found

    def merge(self) -> Table:
        """The scenario as one table, references resolved (``extends`` and ``file`` are gone)."""
        result = _merge(self._stack)
        list_rows(result)
        rows = result.get("fault", [])
        if self._faults and isinstance(rows, list):
            result["fault"] = [*rows, *self._faults]
        return result

    def origin(self, *keys: str | int) -> Path:
        """The file that gives a key; for a missing key the lowest file that gives its table, where it belongs.

        Arrays are replaced as a whole, so for a key inside an array it is the highest file with that array.
        """
        if keys[:1] == ("fault",) and len(keys) > 1 and self._is_given(keys[1]):
            return FAULT
        outside = next((count for count, key in enumerate(keys) if isinstance(key, int)), len(keys))
        depths = [_depth(table, keys[:outside]) for _, table in self._stack]
        deepest = max(depths)
        if deepest == outside:
            return self._stack[depths.index(deepest)][0]
        if deepest == 0:
            return self.main
        return self._stack[len(depths) - 1 - depths[::-1].index(deepest)][0]

    def refuse(self, keys: Keys, found: object, allowed: str) -> InputError:
        """The error for the value of a key."""
        return InputError(self.origin(*keys), join_keys(keys), found, allowed)

    def refer(self, keys: Keys, value: object, folder: Path) -> Path:
        """The file that a key names: a shipped name, or a path relative to the file that gives the key.

        :param folder: of the shipped files.
        :raises InputError: there is no such file.
        """
        return self._reference(self.origin(*keys), join_keys(keys), value, folder)

    def place(self, *keys: str) -> int:
        """Place of the highest file that gives a key, 0 for the highest of all; 0 also if none gives it."""
        return next((place for place, (_, table) in enumerate(self._stack) if _depth(table, keys) == len(keys)), 0)

    def changes_since(self, *keys: str) -> tuple[Path, list[tuple[str, ...]]]:
        """Changes by files and settings above the file that gives a key, without explaining keys.

        :returns: that file, and the keys that it or a file below it gives and that have another value above.
        """
        place = self.place(*keys)
        above, below = _merge(self._stack[:place]), _merge(self._stack[place:])
        other: list[tuple[str, ...]] = [(section,) for section, by in self._replaced.items() if by < place]
        other += [keys for keys, dropped in self._dropped.items() if dropped.place < place]
        for leaf in _leaves(above):
            explains = leaf[0] in _EXPLAINING or leaf[-1] == "assumptions"
            if explains or (leaf[0],) in other or _depth(below, leaf) < len(leaf):
                continue
            # An empty table changes nothing.
            if _get_value(above, leaf) not in ({}, _get_value(below, leaf)):
                other.append(leaf)
        return self._stack[place][0], other

    def _is_given(self, row: str | int) -> bool:
        """Whether a row of ``fault`` was given in addition to the files."""
        rows: object = next((table["fault"] for _, table in self._stack if "fault" in table), [])
        return isinstance(row, int) and isinstance(rows, list) and row >= len(rows)

    def _read_scenario(self, path: Path) -> None:
        for _ in range(_CHAIN_MAX):
            table = self._leave_out(path, read_toml(path))
            base, without = table.pop("extends", None), table.pop("without", None)
            self._add_scenario(path, table)
            if without is not None:
                self._drop(path, base, without)
            if base is None:
                self._check_dropped()
                return
            path = self._reference(path, "extends", base, DATA / "runs")
        raise InputError(path, "extends", Words("makes the chain longer"), f"at most {_CHAIN_MAX} files in a chain")

    def _drop(self, path: Path, base: object, without: object) -> None:
        """Note the keys that a file does not inherit."""
        if not isinstance(without, list) or not all(isinstance(key, str) and key for key in without):
            raise InputError(path, "without", without, 'an array of keys of the base, such as ["plan.overtime_max_s"]')
        if base is None:
            raise InputError(path, "without", without, "only beside extends, whose keys it leaves out")
        for key in without:
            self._dropped.setdefault(tuple(key.split(".")), _Dropped(path, len(self._stack) - 1))

    def _check_dropped(self) -> None:
        for keys, dropped in self._dropped.items():
            if not dropped.given:
                raise InputError(dropped.file, "without", ".".join(keys), "a key that the extended scenario gives")

    def _leave_out(self, path: Path, table: Table) -> Table:
        """The content of a scenario file without the key that is left out."""
        self._written.append((path, copy.deepcopy(table)))
        if self._without is None or self._without[0] != path:
            return table
        *above, last = self._without[1] or (None,)
        if last is None:
            return {key: value for key, value in table.items() if key in _KEPT}
        inner = table
        for key in above:
            inner = inner[str(key)]
        inner.pop(last, None)
        return table

    def _add_scenario(self, path: Path, table: Table) -> None:
        name_rows(table)
        for section in self._closed:
            if table.pop(section, None):
                self._replaced.setdefault(section, self._closed[section])
        self._remove_dropped(table)
        self._stack.append((path, table))
        for section, folder in _FOLDERS.items():
            inner = table.get(section)
            if not isinstance(inner, dict):
                continue
            _resolve_foreign(path, section, inner)
            self._drop_nodes(section, inner)
            complete = COMPLETE[section]
            if any(key in inner for key in ("file", *FOREIGN[section])) or (complete and {*complete} <= {*inner}):
                # A section that names a file, or is complete, inherits nothing: the same section of an extended
                # scenario is ignored.
                self._closed.setdefault(section, len(self._stack) - 1)
            if "file" in inner:
                there = self._reference(path, f"{section}.file", inner.pop("file"), DATA / folder)
                referred = read_toml(there)
                lower = {section: referred}
                self._remove_dropped(lower)
                _resolve_foreign(there, section, referred)
                self._drop_nodes(section, referred)
                self._stack.append((there, lower))

    def _remove_dropped(self, table: Table) -> None:
        """Remove the keys that a file above does not inherit."""
        for keys, dropped in self._dropped.items():
            if _depth(table, keys) == len(keys):
                dropped.given = True
                del _get_value(table, keys[:-1])[keys[-1]]

    def _drop_nodes(self, section: str, table: Table) -> None:
        """If a file only tells how to generate the target, ignore nodes of the files below it."""
        if section == "target":
            if self._target_made_anew is not None:
                if table.pop("nodes_s_mps2", None):
                    self._replaced.setdefault(section, self._target_made_anew)
            elif "generate" in table and "nodes_s_mps2" not in table:
                self._target_made_anew = len(self._stack) - 1

    @staticmethod
    def _reference(path: Path, key: str, value: object, shipped: Path) -> Path:
        if not isinstance(value, str) or not value:
            raise InputError(path, key, value, "a shipped name or a relative path to a .toml file")
        if value.endswith(".toml"):
            there = path.parent / value
            if not there.is_file():
                raise InputError(path, key, value, "a file that exists, relative to this one")
            return there
        name = shipped_name(value, shipped)
        if name is None:
            known = shipped_names(shipped)
            raise InputError(path, key, value, f"a .toml path or one of {', '.join(known)}", did_you_mean(value, known))
        return shipped / f"{name}.toml"


def shipped_names(folder: Path) -> list[str]:
    """Names of the shipped files in a folder, sorted."""
    return sorted(entry.stem for entry in folder.glob("*.toml"))


def shipped_name(text: str, folder: Path) -> str | None:
    """Full name of the shipped file that matches a name or the beginning of one; None unless exactly one does."""
    names = shipped_names(folder)
    begun = [name for name in names if text and name.startswith(text)]
    return text if text in names else begun[0] if len(begun) == 1 else None


def short_name(name: str, names: Sequence[str]) -> str:
    """The fewest leading words of a name that are unambiguous: ``yizhuang_05`` for
    ``yizhuang_05_yizhuang_qiao_...``."""
    words = name.split("_")
    for count in range(1, len(words)):
        begin = "_".join(words[:count])
        if sum(other.startswith(begin) for other in names) == 1:
            return begin
    return name


def read_toml(path: Path) -> Table:
    """A TOML file as a table. Raises :class:`InputError` when it cannot be read or is not TOML."""
    with refuse_unreadable(path, "TOML 1.0 in UTF-8"):
        return parse_toml(given_text(path))


def _resolve_foreign(path: Path, section: str, table: Table) -> None:
    """Make paths of third-party files absolute: they are relative to the file that names them."""
    for key in FOREIGN[section]:
        value = table.get(key)
        if isinstance(value, str):
            there = path.parent / value
            if not there.is_file():
                raise InputError(path, f"{section}.{key}", value, "a file that exists, relative to this one")
            table[key] = str(there)


def _merge(stack: Sequence[tuple[Path, Table]]) -> Table:
    result: Table = {}
    for _, table in reversed(stack):
        _lay_over(result, table)
    return result


def _get_value(table: Any, keys: tuple[str, ...]) -> Any:
    for key in keys:
        table = table[key]
    return table


def _lay_over(below: Table, above: Table) -> None:
    for key, value in above.items():
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _lay_over(below[key], value)
        else:
            below[key] = copy.deepcopy(value)


def _leaves(table: Table, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, value in table.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, (*above, key))
        else:
            yield (*above, key)


def _depth(table: Any, keys: tuple[str | int, ...]) -> int:
    """How many of ``keys`` can be followed into ``table``."""
    for count, key in enumerate(keys):
        in_list = isinstance(table, list) and isinstance(key, int) and key < len(table)
        if not in_list and not (isinstance(table, dict) and key in table):
            return count
        table = table[key]
    return len(keys)


S = TypeVar("S", bound="Scenario | TaskScenario")
_SHOWN_MAX = 6


def add_own_words(scenario: S, layers: Layers, read: Callable[[Layers], S], run: Callable[[S], object]) -> S:
    """The scenario without the published results of another run, and with sentences about what it changes.

    :param read: reads a scenario.
    :param run: the part that defines the run of published results; equal for the same run.
    """
    assumptions, published = list(scenario.assumptions), scenario.published
    of, other = layers.changes_since("assumptions")
    for section in ("train", "line"):
        # Their sentences come from the files that describe them, and are left out with these.
        _, inside = layers.changes_since(section, "assumptions")
        other += [keys for keys in inside if keys[0] == section and len(keys) > 1 and keys not in other]
    if assumptions and other:
        title = ", and the title," if layers.place("title") >= layers.place("assumptions") else ""
        assumptions.append(f"changed here: {_join_names(other)}; sentences about them{title} are those of {of.stem}")
    if published and layers.place("published"):
        of, other = layers.changes_since("published")
        try:
            is_same = run(read(Layers(of))) == run(scenario)
        except InputError:
            # A file with the keys that several scenarios share; it is no scenario by itself.
            is_same = not other
        if not is_same:
            published = ()
            assumptions.append(f"the published results of {of.stem} are left out: this is another run")
    return replace(scenario, assumptions=tuple(assumptions), published=published)


def _join_names(changed: list[tuple[str, ...]]) -> str:
    names = [".".join(keys) for keys in changed]
    more = f" and {len(names) - _SHOWN_MAX} more" if len(names) > _SHOWN_MAX else ""
    return ", ".join(names[:_SHOWN_MAX]) + more


def faults_of_rows(
    rows: Sequence[Mapping[str, Any] | str],
    system: System,
    origin: Callable[[int], Path],
    marks: Mapping[str, Sequence[float | None]] | None = None,
) -> tuple[str, ...]:
    """See :func:`railhil.scenarios.fault_list.fault_texts`."""
    if not rows:
        return ()
    # Loading it takes a tenth of the start of a node, and every node reads the scenario.
    from railhil.scenarios.fault_list import fault_texts

    return fault_texts(rows, system, origin, marks or {})
