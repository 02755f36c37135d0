"""The C files that are the same for every law but for some names."""

from __future__ import annotations

from importlib.resources import files

#: Folder of those that every way of control has, package:folder.
SHARED = "railhil.controller_node.export:c"


def template(file: str, law: str, folder: str = SHARED, **places: str) -> str:
    """Text of a file.

    :param law: its name in C, in the place of ``@LAW@``, in capitals of ``@PREFIX@``.
    :param folder: package:folder.
    :param places: what else stands between two @.
    """
    package, _, path = folder.partition(":")
    text = files(package).joinpath(path, file).read_text(encoding="ascii")
    for name, words in {"LAW": law, "PREFIX": law.upper(), **places}.items():
        text = text.replace(f"@{name}@", words)
    return text
