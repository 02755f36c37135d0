"""Installed entry points of a group: the laws and systems that plug in."""

from __future__ import annotations

import importlib.metadata
import sys
from collections.abc import Mapping
from functools import cache
from typing import Any


def entries(group: str) -> Mapping[str, importlib.metadata.EntryPoint]:
    """Entry points of a group by name.

    All are looked up once for each ``sys.path``: the lookup reads the metadata of every installed distribution.
    """
    return _entries(group, tuple(sys.path))


@cache
def _entries(group: str, path: tuple[str, ...]) -> Mapping[str, importlib.metadata.EntryPoint]:
    return {entry.name: entry for entry in _every(path).select(group=group)}


@cache
def _every(path: tuple[str, ...]) -> Any:
    # EntryPoints, or what has the same select() in Python 3.11.
    return importlib.metadata.entry_points()
