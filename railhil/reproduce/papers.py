"""The papers that ``railhil reproduce`` knows."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module

from railhil.reproduce.paper import Paper

#: Name of each paper, in the order of the list, and its record, ``module:object``.
PAPERS: Mapping[str, str] = {
    "ipfc": "railhil.reproduce.ipfc:PAPER",
    "ngpc": "railhil.reproduce.ngpc:PAPER",
    "ilc": "railhil.reproduce.ilc:PAPER",
}


def paper_named(name: str, papers: Mapping[str, str] = PAPERS) -> Paper:
    """A paper by its name, which must be one of ``papers``."""
    module, _, record = papers[name].partition(":")
    found: Paper = getattr(import_module(module), record)
    return found
