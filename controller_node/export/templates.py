"""The C files that are the same for every law except for some names."""

from __future__ import annotations

from importlib.resources import files

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
