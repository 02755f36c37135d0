"""Libraries of the extras: the command that installs missing ones for this kind of installation, and a library that is
not loaded.

python-can imports asammdf, and pandas with it, for MF4 files of its own. That takes half a second at the start of every
command and node of an installation with the extra ``mdf``.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import shlex
import sys
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from railhil.common.errors import InputError, Sentence, Words

_DISTRIBUTION = "railhil"
#: pipx puts this file into the environment of a program.
_PIPX = "pipx_metadata.json"


def install_command(*extras: str, only: Collection[str] = ()) -> str:
    """The command that installs the libraries of these extras into the running environment.

    The libraries are named one by one, which works in a clone, for a wheel and with pipx.

    :param only: requirements to be named; empty: all.
    """
    names = [name for name in _requirements(extras) if not only or name in only]
    if (Path(sys.prefix) / _PIPX).is_file():
        words = ["pipx", "inject", _DISTRIBUTION]
    elif importlib.util.find_spec("pip") is None:
        # An environment made by uv.
        words = ["uv", "pip", "install", "--python", sys.executable]
    else:
        words = [sys.executable, "-m", "pip", "install"]
    return shlex.join(words + names)


def _requirements(extras: Sequence[str]) -> list[str]:
    """The requirements of these extras, each once."""
    # Loading this takes a tenth of the start of a command.
    from importlib.metadata import requires

    wanted = [text.partition(";") for text in requires(_DISTRIBUTION) or ()]
    return list(
        dict.fromkeys(name.strip() for extra in extras for name, _, marker in wanted if f'extra == "{extra}"' in marker)
    )


def _distribution_of(requirement: str) -> str:
    return re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]


def _normalised(distribution: str) -> str:
    """The name as the package index compares it."""
    return re.sub(r"[-_.]+", "-", distribution).lower()


def _missing(extras: Sequence[str], module: str) -> list[str]:
    """Requirements of these extras that are not installed, and that of the module which could not be imported."""
    from importlib.metadata import PackageNotFoundError, distribution, packages_distributions

    owners = {_normalised(name) for name in packages_distributions().get(module.partition(".")[0], [])}

    def is_missing(requirement: str) -> bool:
        name = _distribution_of(requirement)
        try:
            distribution(name)
        except PackageNotFoundError:
            return True
        return _normalised(name) in owners

    wanted = _requirements(extras)
    # A library that one of them needs may be the missing one: then all are installed again.
    return [requirement for requirement in wanted if is_missing(requirement)] or wanted


def missing_library(command: str, error: ImportError, *extras: str) -> InputError:
    """The one-line message for a library that is missing or unusable: all that is missing of these extras, and one
    command that installs it.

    :param extras: all that the command needs for what it was asked to do.
    """
    missing = _missing(extras, error.name or "")
    names = [_distribution_of(requirement) for requirement in missing]
    said = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)
    is_absent = isinstance(error, ModuleNotFoundError)
    problem = "not installed" if is_absent else f"not installed, or cannot be used ({error})"
    verb, them = ("are", "them") if len(names) > 1 else ("is", "it")
    sentence = Sentence(f"{said} {verb} {problem}; install {them} with {install_command(*extras, only=missing)}")
    hint = f"the extra{'s' * (len(extras) > 1)} {', '.join(f'[{extra}]' for extra in extras)}"
    return InputError(command, "", Words("not installed"), sentence, hint)


def need(module: str, *extras: str, command: str = "railhil campaign") -> ModuleType:
    """Import a module of the first of these extras; the others are needed, too.

    :param command: command that needs the module. :raises InputError: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise missing_library(command, error, *extras) from error


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
