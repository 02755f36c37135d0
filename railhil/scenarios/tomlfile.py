"""TOML text as a table, with checks that tomllib leaves to its caller (excessive numbers and depths), and back."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from railhil.common.user_files import without_mark

#: Maximum nesting of tables and arrays; railhil's own files use four.
DEPTH_MAX = 32
#: Texts of each kind, comments, words, blanks, and all other characters one by one.
_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"""|'
    r"'''.*?'''"
    r'|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|#[^\n]*|[A-Za-z0-9_-]+|[^\S\n]+|.',
    re.DOTALL,
)


def parse_toml(text: str) -> dict[str, Any]:
    """The table of a TOML text.

    :raises ValueError: it is not TOML, begins with a byte order mark, nests deeper than :data:`DEPTH_MAX`, or has an
        integer of thousands of digits; the message is one line.
    """
    without_mark(text)
    # tomllib takes memory and time with the square of the parts of a key.
    if any(line.count(".") >= DEPTH_MAX for line in text.splitlines()) and _parts_of_a_key(text) > DEPTH_MAX:
        raise ValueError(_too_deep())
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:
        # The limit of Python's own conversion (sys.get_int_max_str_digits).
        raise ValueError("a whole number of thousands of digits") from None
    except RecursionError:
        raise ValueError(_too_deep()) from None
    level: list[Any] = [table]
    for _ in range(DEPTH_MAX):
        level = [inner for outer in level for inner in (outer.values() if isinstance(outer, dict) else outer)]
        level = [inner for inner in level if isinstance(inner, dict | list)]
        if not level:
            return table
    raise ValueError(_too_deep())


def _parts_of_a_key(text: str) -> int:
    """The largest number of parts, with dots between them, outside texts and comments."""
    most = parts = 0
    after_dot = False
    for found in _TOKEN.finditer(text):
        token = found[0]
        if token == ".":
            after_dot = True
        elif not token.isspace() or "\n" in token:
            parts = parts + 1 if after_dot else 1
            most, after_dot = max(most, parts), False
    return most


def _too_deep() -> str:
    return f"tables or arrays more than {DEPTH_MAX} deep"


def toml_value(value: Any) -> str:
    """A value as TOML: bool, text, number, a list of them, or a list of lists, each on a line of its own."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # Escapes of JSON are escapes of TOML.
        return json.dumps(value)
    if isinstance(value, list | tuple):
        items = [toml_value(item) for item in value]
        if value and isinstance(value[0], list | tuple):
            return "[\n" + "".join(f"  {row},\n" for row in items) + "]"
        return f"[{', '.join(items)}]"
    return repr(value)


def toml_table(title: str, values: Mapping[str, Any]) -> str:
    """A table as TOML, with a blank line before it.

    :param title: its name; that of an item of an array of tables in brackets.
    """
    return f"\n[{title}]\n" + "".join(f"{key} = {toml_value(value)}\n" for key, value in values.items())
