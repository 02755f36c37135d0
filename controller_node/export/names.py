"""Names and numbers in C: identifiers that differ in their first 31 characters, literals of int32."""

from __future__ import annotations

import re
from collections.abc import Iterable

from railhil.controller_node.arithmetic.base import INT32_MIN

#: Characters in which C99 requires a compiler to tell external names apart.
LENGTH_MAX = 31

#: Of C99, and what cl2000 adds.
_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    asm cregister far interrupt ioport near
"""
#: Parameters of every exported function, and functions that a C library has.
_TAKEN = "in out state events main abs labs"


def identifier(text: str) -> str:
    """A C identifier from a quantity's or constant's name: ``free[3][0]`` -> ``free_3_0``, ``-x`` -> ``minus_x``."""
    text = re.sub(r"^-+", lambda signs: "minus_" * len(signs.group()), text)
    text = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_") or "value"
    return f"n_{text}" if text[0].isdigit() else text


class Names:
    """Identifiers of one scope: each is given away once.

    :param prefix: stands before each of them.
    :param taken: are given away already.
    """

    def __init__(self, prefix: str = "", taken: Iterable[str] = ()) -> None:
        self._prefix = prefix
        self._used = {*_KEYWORDS.split(), *_TAKEN.split(), *taken}

    def new(self, text: str) -> str:
        """An identifier made from a text, other than all before it in the first 31 characters."""
        stem = self._prefix + identifier(text)
        name = stem[:LENGTH_MAX]
        count = 1
        while name in self._used:
            count += 1
            ending = f"_{count}"
            name = stem[: LENGTH_MAX - len(ending)] + ending
        self._used.add(name)
        return name


def literal(raw: int) -> str:
    """A number as int32: a bare literal is an ``int``, which has 16 bits on the target."""
    return "INT32_MIN" if raw == INT32_MIN else f"INT32_C({raw})"


def wide(value: int) -> str:
    """A number as int64."""
    return f"INT64_C({value})"


def comment(text: str) -> str:
    """Text that may stand in a C comment: one line, printable ASCII, nothing that ends the comment."""
    plain = "".join(character if " " <= character <= "~" else "?" for character in " ".join(text.split()))
    return plain.replace("*/", "*?").replace("/*", "?*")
