"""Libraries of the extras, with a one-line message if they are missing."""

from __future__ import annotations

import importlib
from types import ModuleType

from railhil.common.extras import missing


def need(module: str, extra: str) -> ModuleType:
    """Import a module of an extra.

    :raises scenarios.errors.InputError: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise missing("railhil campaign", error, extra) from error
