"""Reading of scenario files with their references: which file says what, and what wins.

A scenario may ``extends`` another scenario, and its ``[train]``, ``[line]`` and ``[target]`` may name a
``file``. Each of these is a layer; a key in a higher layer wins, tables are merged key by key, arrays are
replaced whole.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.scenarios.tomlfile import parsed_toml

DATA = Path(__file__).parent / "data"
_FOLDERS = {"train": "trains", "line": "lines", "target": "targets"}
#: References to files in a format of somebody else, by section.
_FOREIGN = {"train": ("railtoolkit",), "line": ("railtoolkit", "ttobench"), "target": ()}
_CHAIN_MAX = 8

Table = dict[str, Any]


class Layers:
    """The files behind one scenario, highest priority first, each with the part that it gives."""

    def __init__(self, path: Path) -> None:
        self._stack: list[tuple[Path, Table]] = []
        self._closed: set[str] = set()
        self._target_made_anew = False
        self._read_scenario(path)

    @property
    def main(self) -> Path:
        return self._stack[0][0]

    def merged(self) -> Table:
        """The scenario as one table, references resolved (``extends`` and ``file`` are gone)."""
        result: Table = {}
        for _, table in reversed(self._stack):
            _lay_over(result, table)
        return result

    def origin(self, *keys: str | int) -> Path:
        """The file that gives a key; for a missing key the one that should: the lowest that gives its table.

        Arrays are replaced whole, so for a key inside an array it is the highest file that has the array.
        """
        depths = [_depth(table, keys) for _, table in self._stack]
        deepest = max(depths)
        inside_array = any(isinstance(key, int) for key in keys[: deepest + 1])
        if deepest == len(keys) or inside_array:
            return self._stack[depths.index(deepest)][0]
        if deepest == 0:
            return self.main
        return self._stack[len(depths) - 1 - depths[::-1].index(deepest)][0]

    def _read_scenario(self, path: Path) -> None:
        for _ in range(_CHAIN_MAX):
            table = read_toml(path)
            base = table.pop("extends", None)
            self._add_scenario(path, table)
            if base is None:
                return
            path = self._reference(path, "extends", base, DATA / "runs")
        raise InputError(path, "extends", Words("a longer chain"), f"at most {_CHAIN_MAX} files in a chain")

    def _add_scenario(self, path: Path, table: Table) -> None:
        for section in self._closed:
            table.pop(section, None)
        self._stack.append((path, table))
        for section, folder in _FOLDERS.items():
            inner = table.get(section)
            if not isinstance(inner, dict):
                continue
            _absolute_foreign(path, section, inner)
            self._drop_nodes(section, inner)
            if any(key in inner for key in ("file", *_FOREIGN[section])):
                # A section that names a file starts anew: what an extended scenario says of it is left out.
                self._closed.add(section)
            if "file" in inner:
                there = self._reference(path, f"{section}.file", inner.pop("file"), DATA / folder)
                referred = read_toml(there)
                _absolute_foreign(there, section, referred)
                self._drop_nodes(section, referred)
                self._stack.append((there, {section: referred}))

    def _drop_nodes(self, section: str, table: Table) -> None:
        """A file that only says how to generate the target makes nodes of the files below it void."""
        if section == "target":
            if self._target_made_anew:
                table.pop("nodes_s_mps2", None)
            self._target_made_anew |= "generate" in table and "nodes_s_mps2" not in table

    @staticmethod
    def _reference(path: Path, key: str, value: object, shipped: Path) -> Path:
        if not isinstance(value, str) or not value:
            raise InputError(path, key, value, "a shipped name or a relative path to a .toml file")
        if value.endswith(".toml"):
            there = path.parent / value
            if not there.is_file():
                raise InputError(path, key, value, "a file that exists, relative to this one")
            return there
        there = shipped / f"{value}.toml"
        if not there.is_file():
            raise InputError(path, key, value, f"a .toml path or one of {', '.join(shipped_names(shipped))}")
        return there


def shipped_names(folder: Path) -> list[str]:
    """Names of the shipped files in a folder, sorted."""
    return sorted(entry.stem for entry in folder.glob("*.toml"))


def read_toml(path: Path) -> Table:
    """A TOML file as a table. Raises :class:`InputError` when it cannot be read or is not TOML."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(path, "", Words(error.strerror or "no readable file"), "a readable TOML file") from None
    except UnicodeDecodeError as error:
        raise InputError(path, "", Words(f"byte {error.start} that is not UTF-8"), "UTF-8 text") from None
    try:
        return parsed_toml(text)
    except ValueError as error:
        raise InputError(path, "", Words(str(error)), "TOML 1.0") from None


def _absolute_foreign(path: Path, section: str, table: Table) -> None:
    """Foreign files are named relative to the file that names them: their place is fixed here."""
    for key in _FOREIGN[section]:
        value = table.get(key)
        if isinstance(value, str):
            there = path.parent / value
            if not there.is_file():
                raise InputError(path, f"{section}.{key}", value, "a file that exists, relative to this one")
            table[key] = str(there)


def _lay_over(below: Table, above: Table) -> None:
    for key, value in above.items():
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _lay_over(below[key], value)
        else:
            below[key] = copy.deepcopy(value)


def _depth(table: Any, keys: tuple[str | int, ...]) -> int:
    """How many of ``keys`` can be followed into ``table``."""
    for count, key in enumerate(keys):
        in_list = isinstance(table, list) and isinstance(key, int) and key < len(table)
        if not in_list and not (isinstance(table, dict) and key in table):
            return count
        table = table[key]
    return len(keys)
