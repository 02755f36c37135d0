"""Functions whose source text the bench makes while it runs: compiled, and shown by tracebacks and debuggers.

The text is entered in :mod:`linecache` under a name such as ``<railhil telegram TRN_SPEED>``. A traceback prints its
lines; a debugger shows them, steps through them and stops at a breakpoint in them.
"""

from __future__ import annotations

import linecache
from collections.abc import Mapping
from functools import lru_cache
from types import CodeType
from typing import Any


def compile_source(title: str, text: str, names: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The functions that a text defines, by name.

    :param title: name of the text, for tracebacks and debuggers. A comma in it would keep pdb from stopping there.
    :param names: global names that the text uses; the functions see them and each other.
    """
    known = dict(names or {})
    defined: dict[str, Any] = dict(known)
    exec(_code(title, text), defined)  # noqa: S102
    return {name: value for name, value in defined.items() if name not in known and name != "__builtins__"}


@lru_cache(maxsize=256)
def _code(title: str, text: str) -> CodeType:
    """The code of a text; another text with the same title gets a number in its name."""
    name, count = f"<railhil {title}>", 1
    # The entry has no time of change: otherwise linecache would drop the text when it checks files for changes.
    entry = (len(text), None, text.splitlines(keepends=True), name)
    while linecache.cache.setdefault(name, entry) != entry:
        count += 1
        name = f"<railhil {title} {count}>"
        entry = (*entry[:3], name)
    return compile(text, name, "exec", dont_inherit=True)
