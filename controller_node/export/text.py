"""Text of C files: identifiers that differ in their first 31 characters, numbers, comments, files with placeholders."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import as_file, files

from railhil.controller_node.arithmetic.base import INT32_MIN
from railhil.controller_node.program.model import identifier

#: Number of initial characters of an external name that C99 requires a compiler to distinguish.
LENGTH_MAX = 31

#: Keywords of C99, and those that cl2000 adds.
_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    asm cregister far interrupt ioport near
"""
#: Parameters of the exported functions, and functions of the C library.
_TAKEN = "in out state events main abs labs"


class Names:
    """Unique identifiers of one scope.

    :param prefix: of each identifier.
    :param taken: identifiers that are already in use.
    """

    def __init__(self, prefix: str = "", taken: Iterable[str] = ()) -> None:
        self._prefix = prefix
        self._used = {*_KEYWORDS.split(), *_TAKEN.split(), *taken}

    def new(self, text: str) -> str:
        """An identifier made from a text; its first 31 characters differ from all earlier ones."""
        stem = self._prefix + identifier(text)
        name = stem[:LENGTH_MAX]
        count = 1
        while name in self._used:
            count += 1
            ending = f"_{count}"
            name = stem[: LENGTH_MAX - len(ending)] + ending
        self._used.add(name)
        return name


def names_defined(text: str) -> frozenset[str]:
    """Macros, members of enumerations and types that a C text defines."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    found = {*re.findall(r"#define (\w+)", text), *re.findall(r"\} (\w+);", text)}
    for members in re.findall(r"\benum \{([^}]*)\}", re.sub(r"^#.*$", "", text, flags=re.MULTILINE)):
        found.update(re.findall(r"(?:^|,)\s*(\w+)", members))
    return frozenset(found)


@cache
def names_of_files(folder: str) -> frozenset[str]:
    """The same for all C files of a folder and of those in it.

    :param folder: package:folder.
    """
    package, _, path = folder.partition(":")
    with as_file(files(package).joinpath(path)) as top:
        return names_defined("\n".join(file.read_text(encoding="ascii") for file in sorted(top.rglob("*.[ch]"))))


def literal(raw: int) -> str:
    """A number as int32: a bare literal is an ``int``, which has 16 bits on the target."""
    return "INT32_MIN" if raw == INT32_MIN else f"INT32_C({raw})"


def wide(value: int) -> str:
    """A number as int64."""
    return f"INT64_C({value})"


def header(guard: str, words: Sequence[str], includes: Sequence[str], body: Sequence[str]) -> str:
    """A header file.

    :param guard: macro that marks it as included.
    :param words: lines of the comment at its top.
    :param includes: files that it includes.
    :param body: its lines, the last of them empty.
    """
    first, *rest = words
    return "\n".join(
        [
            f"/* {first}",
            *(f" * {line}".rstrip() for line in rest),
            " */",
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            *(f"#include {file}" if file.startswith("<") else f'#include "{file}"' for file in includes),
            "",
            *body,
            "#endif",
            "",
        ]
    )


def comment(text: str) -> str:
    """Text made safe for a C comment: one line, printable ASCII, no start or end of a comment."""
    plain = "".join(character if " " <= character <= "~" else "?" for character in " ".join(text.split()))
    return plain.replace("*/", "*?").replace("/*", "?*")


#: Folder of the files common to every kind of control, package:folder.
SHARED = "railhil.controller_node.export:c"


def template(file: str, law: str, folder: str = SHARED, **places: str) -> str:
    """Text of a file with its placeholders replaced.

    :param law: name of the law in C; replaces ``@LAW@`` and, in capitals, ``@PREFIX@``.
    :param folder: package:folder.
    :param places: replacements for the other ``@NAME@`` placeholders.
    """
    package, _, path = folder.partition(":")
    text = files(package).joinpath(path, file).read_text(encoding="ascii")
    for name, words in {"LAW": law, "PREFIX": law.upper(), **places}.items():
        text = text.replace(f"@{name}@", words)
    return text
