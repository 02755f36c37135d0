"""What this railhil and this Python were built as: pure or compiled, and CPython's own optimisations."""

from __future__ import annotations

import platform
import sysconfig
from importlib.util import find_spec

#: A module that the compiled build always holds (see setup.py).
_COMPILED = "railhil.bus.store"


def railhil_build() -> str:
    """``compiled`` (mypyc) or ``pure``; with ``RAILHIL_PURE=1`` a compiled build is pure, too."""
    spec = find_spec(_COMPILED)
    return "compiled" if spec is not None and not (spec.origin or "").endswith(".py") else "pure"


def python_build(configured: str | None = None) -> str:
    """How CPython was compiled, as far as it decides its speed: PGO (``--enable-optimizations``) and LTO.

    :param configured: the arguments of its ``configure``; None: those of this interpreter.
    """
    words = str(sysconfig.get_config_var("CONFIG_ARGS") or "") if configured is None else configured
    pgo = "PGO" if "--enable-optimizations" in words else "no PGO"
    return f"{pgo}, {'LTO' if '--with-lto' in words else 'no LTO'}"


def machine() -> dict[str, str]:
    """The entry ``machine`` of certificates and manifests."""
    return {
        "python": platform.python_version(),
        "python_build": python_build(),
        "railhil_build": railhil_build(),
        "system": platform.system(),
        "machine": platform.machine(),
    }
