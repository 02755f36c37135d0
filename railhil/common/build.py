"""The builds of this railhil and this Python: pure or compiled, and CPython's own optimisations."""

from __future__ import annotations

import platform
import sysconfig
from importlib.util import find_spec
from pathlib import Path

#: A module that the compiled build always holds (see setup.py).
_COMPILED = "railhil.bus.store"


def railhil_build() -> str:
    """``compiled`` (mypyc) or ``pure``; with ``RAILHIL_PURE=1`` a compiled build is pure, too."""
    spec = find_spec(_COMPILED)
    return "compiled" if spec is not None and not (spec.origin or "").endswith(".py") else "pure"


def python_build(configured: str | None = None, shared: bool | None = None) -> str:
    """The options of CPython's build that decide its speed: PGO (``--enable-optimizations``) and LTO.

    Debian builds CPython twice, and its program reports the configuration of the library's build: the options are then
    unknown.

    :param configured: the arguments of its ``configure``; None: the arguments of this interpreter.
    :param shared: whether the interpreter comes from a shared library; None: find out.
    """
    words = str(sysconfig.get_config_var("CONFIG_ARGS") or "") if configured is None else configured
    if "--enable-shared" in words and not (_from_library() if shared is None else shared):
        return "PGO and LTO not told"
    pgo = "PGO" if "--enable-optimizations" in words else "no PGO"
    return f"{pgo}, {'LTO' if '--with-lto' in words else 'no LTO'}"


def _from_library() -> bool:
    """Whether this interpreter is in libpython; True where that cannot be seen."""
    maps = Path("/proc/self/maps")
    return not maps.exists() or "/libpython" in maps.read_text(encoding="utf-8", errors="replace")


def machine() -> dict[str, str]:
    """The entry ``machine`` of certificates and manifests."""
    return {
        "python": platform.python_version(),
        "python_build": python_build(),
        "railhil_build": railhil_build(),
        "system": platform.system(),
        "machine": platform.machine(),
    }
