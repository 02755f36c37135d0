"""Libraries of the extras: the command that installs missing ones for this kind of installation, and a library that is
not loaded.

python-can imports asammdf, and pandas with it, for MF4 files of its own. That takes half a second at the start of every
command and node of an installation with the extra ``mdf``.
"""

from __future__ import annotations

import importlib
import importlib.util
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from railhil.common.errors import InputError, Sentence, Words

_DISTRIBUTION = "railhil"
#: pipx puts this file into the environment of a program.
_PIPX = "pipx_metadata.json"


def install_command(extra: str) -> str:
    """The command that installs the libraries of an extra into the running environment.

    The libraries are named one by one, which works in a clone, for a wheel and with pipx.
    """
    # Loading this takes a tenth of the start of a command.
    from importlib.metadata import requires

    wanted = [text.partition(";") for text in requires(_DISTRIBUTION) or ()]
    names = [name.strip() for name, _, marker in wanted if f'extra == "{extra}"' in marker]
    if (Path(sys.prefix) / _PIPX).is_file():
        words = ["pipx", "inject", _DISTRIBUTION]
    elif importlib.util.find_spec("pip") is None:
        # An environment made by uv.
        words = ["uv", "pip", "install", "--python", sys.executable]
    else:
        words = [sys.executable, "-m", "pip", "install"]
    return shlex.join(words + names)


def missing_library(command: str, error: ImportError, extra: str) -> InputError:
    """The one-line message for a library that is missing or unusable."""
    absent = isinstance(error, ModuleNotFoundError)
    found = Words("not installed" if absent else f"an installation that cannot be used ({error})")
    problem = "not installed" if absent else f"the installation cannot be used ({error})"
    allowed = Sentence(f"{problem}; install it with {install_command(extra)}")
    return InputError(command, f"module {error.name or '?'}", found, allowed, f"the extra [{extra}]")


def need(module: str, extra: str, command: str = "railhil campaign") -> ModuleType:
    """Import a module of an extra.

    :param command: command that needs the module. :raises InputError: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise missing_library(command, error, extra) from error


_ASAMMDF = "asammdf"


@contextmanager
def without_asammdf() -> Iterator[None]:
    """Inside ``with``, asammdf cannot be imported, unless it or python-can has been already."""
    if "can" not in sys.modules and _ASAMMDF not in sys.modules:
        # None makes an import fail (reference of the language, 5.3.1).
        sys.modules[_ASAMMDF] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        allow_asammdf()


def allow_asammdf() -> None:
    """End :func:`without_asammdf`, for a command that needs asammdf."""
    if sys.modules.get(_ASAMMDF, ...) is None:
        del sys.modules[_ASAMMDF]
