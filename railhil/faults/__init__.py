"""Faults: kind, place, time and duration of an injection, as text, as a table of a scenario file and as an object."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from railhil.faults.model import Fault

#: Source named in errors about a fault given on the command line.
FAULT = Path("--fault")


def parse_faults(texts: Iterable[str]) -> list[Fault]:
    """Each text as a fault, see :func:`railhil.faults.language.parse`.

    :raises InputError: a text is not in the language.
    """
    texts = list(texts)
    if not texts:
        return []
    # A run without faults does not load the language: it takes a tenth of the start of a node.
    from railhil.faults.language import parse

    return [parse(text) for text in texts]
