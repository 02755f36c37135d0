"""Libraries of the extras: one line when they are missing."""

from __future__ import annotations

import importlib
from types import ModuleType

from railhil.common.errors import InputError, Words


def need(module: str, extra: str) -> ModuleType:
    """Import a module of an extra.

    :raises InputError: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        found = Words(f"not installed ({error})")
        raise InputError("railhil campaign", f"module {module}", found, f"pip install 'railhil[{extra}]'") from error
