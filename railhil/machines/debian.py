"""Services of a Debian host for a machine with CAN: packages, a cache directory, and a clear refusal.

If a machine is not available (no root, not Debian, no package mirror), its command says so in one line and ends with
:data:`EXIT_NO_CAPABILITY`. A caller can thus tell "this host cannot do it" from "it was done and failed".
"""

from __future__ import annotations

import fcntl
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

#: Automake's code for a skipped test.
EXIT_NO_CAPABILITY = 77
#: Code of ``timeout(1)`` for a command that was stopped.
EXIT_TIMEOUT = 124
#: Code of ``timeout(1)`` and ``docker run`` for "the wrapper failed, not the command".
EXIT_MACHINE_FAILED = 125

_APT_TIMEOUT_S = 900.0
_APT_OPTIONS = ("-o", "DPkg::Lock::Timeout=300", "-o", "Acquire::Retries=1")
_PATH_OF_ROOT = "/usr/local/sbin:/usr/sbin:/sbin"


class CapabilityError(Exception):
    """The host does not have the capability; the text is one line that names the missing part."""


class MachineError(Exception):
    """The machine was available but did not work; the text is one line that names the log."""


def find_command(name: str) -> str | None:
    """Path of a command, including the directories that are only on root's search path."""
    return shutil.which(name) or shutil.which(name, path=_PATH_OF_ROOT)


def cache_dir() -> Path:
    """Directory for downloads that are kept after a test run: ``$RAILHIL_CACHE``, else ``railhil`` in the XDG cache."""
    chosen = os.environ.get("RAILHIL_CACHE")
    if not chosen:
        home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
        chosen = str(Path(home) / "railhil")
    path = Path(chosen).resolve()
    path.mkdir(parents=True, exist_ok=True)
    return path


@contextmanager
def cache_lock(name: str) -> Iterator[None]:
    """Allow only one process at a time to fill the part ``name`` of the cache."""
    with (cache_dir() / f"{name}.lock").open("w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def require_debian(purpose: str) -> None:
    """Refuse unless this is an x86-64 Debian.

    Raises:
        CapabilityError: with the first condition that is not met.
    """
    if platform.machine() != "x86_64":
        raise CapabilityError(f"{purpose} needs an x86_64 host, this one is {platform.machine()}")
    if not Path("/etc/debian_version").exists() or find_command("apt-get") is None:
        raise CapabilityError(f"{purpose} needs Debian (no /etc/debian_version with apt-get on this host)")


def require_debian_root(purpose: str) -> None:
    """Refuse unless this is root on an x86-64 Debian.

    Raises:
        CapabilityError: with the first condition that is not met.
    """
    require_debian(purpose)
    if os.geteuid() != 0:
        raise CapabilityError(f"{purpose} needs root, this is user id {os.geteuid()}")


def environment() -> dict[str, str]:
    """This process's environment with root's command directories on the search path."""
    return {**os.environ, "PATH": f"{os.environ.get('PATH', '/usr/bin:/bin')}:{_PATH_OF_ROOT}"}


def guarded(name: str, action: Callable[[], int]) -> int:
    """Exit code of a machine's command line: the result of ``action``, or one line and the code of the failure."""
    try:
        return action()
    except CapabilityError as error:
        say(f"{name}: {error}")
        return EXIT_NO_CAPABILITY
    except subprocess.TimeoutExpired as error:
        say(f"{name}: {error.cmd[0]} was stopped after {error.timeout:.0f} s")
        return EXIT_TIMEOUT
    except (MachineError, OSError) as error:
        say(f"{name}: {error}")
        return EXIT_MACHINE_FAILED


def run_tool(
    arguments: Sequence[str],
    cwd: Path | None = None,
    timeout_s: float = _APT_TIMEOUT_S,
    environment_too: Mapping[str, str] | None = None,
) -> str:
    """Standard output of a tool that must succeed, with ``environment_too`` in addition to this process's variables.

    Raises:
        MachineError: the tool failed or took longer than ``timeout_s``; the text has its last line.
    """
    variables = {**environment(), "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C", **(environment_too or {})}
    try:
        done = subprocess.run(
            list(arguments), cwd=cwd, env=variables, stdin=subprocess.DEVNULL, timeout=timeout_s,
            capture_output=True, text=True, errors="replace", check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise MachineError(f"{arguments[0]}: {error}") from error
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()
        raise MachineError(f"{' '.join(arguments[:2])} ended with {done.returncode}: {lines[-1]}")
    return done.stdout


def with_package_lists(action: Callable[[], str], purpose: str) -> str:
    """Result of an apt action, tried again after ``apt-get update`` when the lists are missing or old; one process at
    a time.

    Raises:
        CapabilityError: it also fails with fresh lists, so no mirror is reachable or the package is unknown.
    """
    with cache_lock("apt"):
        try:
            return action()
        except MachineError:
            update = ["apt-get", *_APT_OPTIONS, "-qq", "update"]
        try:
            run_tool(update)
            return action()
        except MachineError as error:
            raise CapabilityError(f"{purpose}: no package from the Debian mirror ({error})") from error


def install_commands(packages: Mapping[str, str], purpose: str, beside: Iterable[str] = ()) -> None:
    """Install the Debian packages of those commands (``command -> package``) that the host does not have.

    :param beside: packages without a command, installed when a command is missing.

    Raises:
        CapabilityError: a package is not available.
    """
    missing = {package for command, package in packages.items() if find_command(command) is None}
    if missing:
        install_packages({*missing, *beside}, purpose)


def install_packages(packages: Iterable[str], purpose: str) -> None:
    """Install Debian packages.

    Raises:
        CapabilityError: a package is not available.
    """
    names = sorted(packages)
    say(f"{purpose}: installing {', '.join(names)}")
    install = ["apt-get", *_APT_OPTIONS, "-y", "--no-install-recommends", "install", *names]
    with_package_lists(lambda: run_tool(install), purpose)


def download_package(package: str, folder: Path, purpose: str) -> Path:
    """Fetch a Debian package without installing it.

    Raises:
        CapabilityError: the package is not available.
    """
    with_package_lists(lambda: run_tool(["apt-get", *_APT_OPTIONS, "download", package], cwd=folder), purpose)
    found = sorted(folder.glob(f"{package}_*.deb"))
    if not found:
        raise CapabilityError(f"{purpose}: apt-get download {package} left no package file")
    return found[-1]


def say(line: str) -> None:
    """One line about the machine itself, on standard error: standard output belongs to the command."""
    print(line, file=sys.stderr, flush=True)
