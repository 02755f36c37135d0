"""The C files that are the same for every law but for some names."""

from __future__ import annotations

from importlib.resources import files


def template(file: str, law: str, **places: str) -> str:
    """Text of a file in ``c/``.

    :param law: its name in C, in the place of ``@LAW@``, in capitals of ``@PREFIX@``.
    :param places: what else stands between two @.
    """
    text = files("railhil.controller_node.export").joinpath("c", file).read_text(encoding="ascii")
    for name, words in {"LAW": law, "PREFIX": law.upper(), **places}.items():
        text = text.replace(f"@{name}@", words)
    return text
