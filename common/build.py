"""What this railhil and this Python were built as: pure or compiled, and CPython's own optimisations."""

from __future__ import annotations

import platform
import sysconfig
from importlib.util import find_spec

#: A module that the compiled build always holds (see setup.py).
_COMPILED = "railhil.bus.store"
#: Option of CPython's configure script or of its compiler -> name.
_FLAGS = {"--enable-optimizations": "PGO", "--with-lto": "LTO", "--with-pydebug": "debug"}


def railhil_build() -> str:
    """``compiled`` (mypyc) or ``pure``; with ``RAILHIL_PURE=1`` a compiled build is pure, too."""
    spec = find_spec(_COMPILED)
    return "compiled" if spec is not None and not (spec.origin or "").endswith(".py") else "pure"


def python_build() -> str:
    """Implementation and the optimisations it was built with: ``CPython, PGO, LTO`` or ``CPython, no PGO/LTO``."""
    options = sysconfig.get_config_var("CONFIG_ARGS") or ""
    found = [name for option, name in _FLAGS.items() if option in options]
    return ", ".join([platform.python_implementation(), *(found or ["no PGO/LTO"])])


def machine() -> dict[str, str]:
    """The entry ``machine`` of certificates and manifests."""
    return {
        "python": platform.python_version(),
        "python_build": python_build(),
        "railhil_build": railhil_build(),
        "system": platform.system(),
        "machine": platform.machine(),
    }
