"""Python interpreters of this machine, and throw-away environments in which a wheel is installed like by a user."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import sysconfig
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil_tests.support.paths import ROOT
from railhil.machines.debian import cache_dir, cache_lock

#: Versions that the project supports.
VERSIONS = ("3.11", "3.12", "3.13")
RUNNING = f"{sys.version_info.major}.{sys.version_info.minor}"
#: The distribution's interpreter may have any version.
DEBIAN = "/usr/bin/python3"
_TIMEOUT_S = 600.0


class MissingCapabilityError(Exception):
    """A missing interpreter or package index; the text is one line."""


def project() -> dict[str, Any]:
    """``[project]`` of pyproject.toml."""
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return found


def _version_of(python: str | Path) -> str | None:
    words = [str(python), "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    except OSError:
        # It does not exist, or is not a program for this machine.
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def python_of(version: str) -> str:
    """An interpreter of a version (3.12): on the search path, pyenv's, Debian's.

    Raises:
        MissingCapabilityError: there is none.
    """
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv") / "versions"
    candidates = [shutil.which(f"python{version}"), *sorted(pyenv.glob(f"{version}*/bin/python")), DEBIAN]
    for candidate in candidates:
        # pyenv puts a command of each name on the path, also for versions that are not activated.
        if candidate is not None and _version_of(candidate) == version:
            return str(candidate)
    raise MissingCapabilityError(f"MISSING CAPABILITY Python {version}: not on the search path, with pyenv or Debian")


def debian_version() -> str | None:
    """Version of Debian's own interpreter, if the project supports it and it is not the running one."""
    own, running = Path(DEBIAN).resolve(), Path(getattr(sys, "_base_executable", sys.executable)).resolve()
    version = own.name.removeprefix("python")
    return version if version in VERSIONS and own.exists() and own != running else None


def _pip(*words: str | Path, python: str | Path | None = None) -> None:
    """Run pip for another interpreter, which does not need its own pip.

    Raises:
        MissingCapabilityError: it failed; most often no package index is reachable.
    """
    target = [] if python is None else ["--python", str(python)]
    command = [sys.executable, "-m", "pip", *target, "--disable-pip-version-check", "-q", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=_TIMEOUT_S, check=False)
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise MissingCapabilityError(f"MISSING CAPABILITY package index: pip {words[0]}: {last}")


def libraries_of(python: str, version: str) -> Path:
    """Folder with the project's dependencies for an interpreter, kept in the cache; the running interpreter uses its
    own.

    Raises:
        MissingCapabilityError: no package index can be reached.
    """
    if version == RUNNING:
        import pydantic  # any dependency: the others are in the same folder

        return Path(pydantic.__file__).parents[1]
    wanted = project()["dependencies"]
    key = hashlib.sha256("\n".join(wanted).encode()).hexdigest()[:12]
    folder = cache_dir() / "libraries" / f"{version}-{key}"
    with cache_lock("libraries"):
        if not folder.exists():
            new = folder.with_suffix(".new")
            shutil.rmtree(new, ignore_errors=True)
            _pip("install", "--only-binary", ":all:", "--target", new, *wanted, python=python)
            new.rename(folder)
    return folder


def downloaded(*requirements: str) -> list[Path]:
    """Wheels of other distributions from the package index, kept in the cache.

    Raises:
        MissingCapabilityError: no package index can be reached.
    """
    found = []
    with cache_lock("wheels"):
        for requirement in requirements:
            folder = cache_dir() / "wheels" / requirement
            if not list(folder.glob("*.whl")):
                _pip("download", "--no-deps", "--only-binary", ":all:", "--dest", folder, requirement)
            found.append(next(folder.glob("*.whl")))
    return found


@dataclass(frozen=True, slots=True)
class Environment:
    """A throw-away environment, and the empty folder in which its commands run."""

    bin: Path
    folder: Path

    @classmethod
    def make(cls, folder: Path, python: str, libraries: Path, *wheels: Path) -> Environment:
        """New environment with wheels installed; their dependencies come from ``libraries``, without pip."""
        subprocess.run([python, "-m", "venv", "--without-pip", str(folder / "venv")], check=True, timeout=_TIMEOUT_S)
        environment = cls(folder / "venv" / "bin", folder / "empty")
        environment.folder.mkdir()
        if wheels:
            _pip("install", "--no-deps", "--no-index", *wheels, python=environment.bin / "python")
        (environment.site_packages / "libraries.pth").write_text(f"import sys; sys.path.append({str(libraries)!r})\n")
        return environment

    def install_source(self, source: Path, *options: str) -> None:
        """``pip install`` of a folder, without a package index: setuptools is that of the libraries."""
        pip = [sys.executable, "-m", "pip", "--python", self.bin / "python", "--disable-pip-version-check", "install"]
        words = ["--no-deps", "--no-index", "--no-build-isolation", *options, source]
        done = subprocess.run([*pip, *words], capture_output=True, text=True, timeout=_TIMEOUT_S, check=False)
        assert done.returncode == 0, done.stdout + done.stderr

    @property
    def site_packages(self) -> Path:
        """Where the wheels are."""
        (found,) = (self.bin.parent / "lib").glob("python*/site-packages")
        return found

    def run(
        self,
        command: str,
        *arguments: str | Path,
        exit_code: int = 0,
        variables: Mapping[str, str] | None = None,
        cwd: Path | None = None,
    ) -> str:
        """Standard output of a command of this environment, which ends with ``exit_code``.

        :param variables: of its environment, beside those of this process.
        :param cwd: where it runs; None: in the empty folder.
        """
        done = self._done(command, *arguments, more=variables, cwd=cwd)
        assert done.returncode == exit_code, done.stdout + done.stderr
        return done.stdout

    def complaint(self, command: str, *arguments: str | Path) -> str:
        """Standard error of a command that refuses its input and prints nothing else."""
        done = self._done(command, *arguments)
        assert (done.returncode, done.stdout) == (2, ""), done.stdout + done.stderr
        return done.stderr

    def _done(
        self, command: str, *arguments: str | Path, more: Mapping[str, str] | None = None, cwd: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        hidden = {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"}
        variables = {name: value for name, value in os.environ.items() if name not in hidden} | dict(more or {})
        return subprocess.run(
            [self.bin / command, *arguments], cwd=cwd or self.folder, capture_output=True, text=True, timeout=300,
            check=False, env={**variables, "PATH": f"{self.bin}:{variables.get('PATH', '')}"},
        )  # fmt: skip


def base_python() -> str:
    """The running interpreter, outside its environment."""
    return str(Path(sysconfig.get_config_var("BINDIR"), f"python{RUNNING}"))
