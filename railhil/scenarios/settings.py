"""``--set KEY=VALUE``: single keys of a scenario from the command line, a layer above its files.

``--set plan.stop_error_max_m=0.3 --set 'line.grade_permil=[[0, 5]]'``: the key is the dotted path of the scenario file,
the value is TOML (a bare word is a string); arrays are replaced as a whole. Settings are checked like a file, recorded
in certificate and command of a run, and covered by the scenario's SHA-256.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, short_repr
from railhil.faults import FAULT
from railhil.scenarios.tomlfile import parse_toml

#: Shown instead of a file name for a key from the command line.
SET = Path("--set")
#: Key of the sentences by which a run is judged, in its certificate and its ``score.json``.
REQUIREMENTS = "requirements"


def required(document: Mapping[str, Any], file: Path) -> tuple[Mapping[str, Any], ...]:
    """The tables under :data:`REQUIREMENTS` of a certificate, without a look at their sentences.

    :raises InputError: they are none.
    """
    found = document.get(REQUIREMENTS) or ()
    if not isinstance(found, list | tuple) or not all(isinstance(one, Mapping) for one in found):
        raise InputError(file, REQUIREMENTS, short_repr(found), "a list of tables, as railhil run has written")
    return tuple(found)


#: Keys that identify the scenario, and so cannot be set.
_FIXED = ("schema_version", "name", "extends")
#: Keys of references to files in third-party formats, by section.
FOREIGN = {"train": ("railtoolkit",), "line": ("railtoolkit", "ttobench", "railml"), "target": ()}
#: Keys that name files: relative to the working folder, so kept as absolute paths.
_FILES = ("file", *FOREIGN["train"], *FOREIGN["line"])
_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")


def normalise_setting(text: str, folder: Path = Path()) -> str:
    """An option's type: ``KEY=VALUE`` in a form that other programs can read again in any folder.

    :param folder: file names are relative to it.
    :raises InputError: it is not a valid setting.
    """
    key, value = _parse(text)
    last = key.rpartition(".")[2]
    if last in _FILES and isinstance(value, str) and (last != "file" or value.endswith(".toml")):
        return f"{key}={json.dumps(str((folder / value).resolve()))}"
    return text


def set_words(settings: Sequence[str]) -> list[str]:
    """The settings as words of a command line."""
    return [word for text in settings for word in (str(SET), text)]


def normalise_fault(text: str, source: str | Path = FAULT) -> str:
    """The canonical text of a fault.

    :param source: source named in errors.
    :raises InputError: it is not in the language.
    """
    # A run without faults does not load their language.
    from railhil.faults.language import fault_text, parse

    return fault_text(parse(text, source))


def fault_words(faults: Sequence[str]) -> list[str]:
    """The faults as words of a command line."""
    return [word for text in faults for word in (str(FAULT), text)]


def layer(settings: Sequence[str]) -> dict[str, Any]:
    """The settings as the table that a file would contain.

    :raises InputError: a text that is not a setting, or two contradictory ones.
    """
    top: dict[str, Any] = {}
    for text in settings:
        key, value = _parse(text)
        *above, last = key.split(".")
        table = top
        for name in above:
            table = table.setdefault(name, {})
            if not isinstance(table, dict):
                raise InputError(SET, key, value, f"a key below a table ({name} is set itself)")
        table[last] = value
    return top


def _parse(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not _KEY.fullmatch(key):
        raise InputError(SET, "", text, "KEY=VALUE, such as plan.stop_error_max_m=0.3")
    if key in _FIXED:
        raise InputError(SET, key, value.strip(), "a key that does not say which scenario it is")
    return key, _value(value.strip())


def _value(text: str) -> Any:
    try:
        table = parse_toml(f"value = {text}")
    except ValueError:
        return text
    # A text with a line break may contain more than a value.
    return table["value"] if len(table) == 1 else text
