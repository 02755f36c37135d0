"""Python for the processor of a Raspberry Pi (aarch64) on an x86-64 Debian: Debian's arm64 packages under qemu-user.

Nothing is installed for that processor: packages and wheels are unpacked into the cache, and the emulator is told where
they are. About eight times slower than this machine's own Python.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from hil_tests.machines import tools
from railhil.machines import debian

_PURPOSE = "Python for aarch64"
_SUITE, _PYTHON = "bookworm", "3.11"
_EMULATOR = "qemu-aarch64-static"
_COMPILER = "aarch64-linux-gnu-gcc"
_PLATFORMS = ("manylinux2014_aarch64", "manylinux_2_17_aarch64", "manylinux_2_28_aarch64")
_DOWNLOAD_TIMEOUT_S = 900.0


def _root() -> Path:
    """Debian for arm64 with Python and its headers, unpacked in the cache."""
    with debian.cache_lock("arm64"):
        root = debian.cache_dir() / f"arm64-{_SUITE}-headers"
        if root.exists():
            return root
        mirrors = [uri for uri, release, _ in tools.mirrors() if release == _SUITE]
        if not mirrors:
            raise debian.CapabilityError(f"{_PURPOSE}: this host's apt has no Debian mirror for {_SUITE}")
        debian.say(f"{_PURPOSE}: debootstrap {_SUITE} arm64 into {root.parent} (about half a minute)")
        with tempfile.TemporaryDirectory(dir=root.parent) as scratch:
            made = Path(scratch, "root")
            # Its packages are only unpacked: their scripts would need a kernel that starts arm64 programs.
            words = ["debootstrap", "--foreign", "--variant=minbase", "--arch=arm64"]
            words += ["--include=python3,libpython3-dev"]
            try:
                debian.run_tool([*words, _SUITE, str(made), mirrors[0]])
            except debian.MachineError as error:
                raise debian.CapabilityError(f"{_PURPOSE}: {error}") from error
            for package in sorted((made / "var/cache/apt/archives").glob("*.deb")):
                debian.run_tool(["dpkg-deb", "-x", str(package), str(made)])
            shutil.rmtree(made / "var/cache/apt")
            made.rename(root)
    return root


def _unpack_libraries(requirements: Sequence[str], site: Path) -> None:
    """The wheels for aarch64 of those requirements and of what they need, unpacked into ``site``."""
    with tempfile.TemporaryDirectory() as scratch:
        words = [sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:", "--dest", scratch]
        words += ["--implementation", "cp", "--python-version", _PYTHON]
        words += [word for name in _PLATFORMS for word in ("--platform", name)]
        words += ["--abi", "cp311", "--abi", "abi3", "--abi", "none", *requirements]
        try:
            debian.run_tool(words, timeout_s=_DOWNLOAD_TIMEOUT_S)
        except debian.MachineError as error:
            raise debian.CapabilityError(f"{_PURPOSE}: no wheels ({error})") from error
        for wheel in sorted(Path(scratch).glob("*.whl")):
            with zipfile.ZipFile(wheel) as archive:
                archive.extractall(site)


def cross_build() -> dict[str, str]:
    """Variables with which setuptools compiles for aarch64 on this machine.

    Raises:
        CapabilityError: this is another Python than the one for aarch64, or compiler or headers are not available here.
    """
    own = f"{sys.version_info.major}.{sys.version_info.minor}"
    if own != _PYTHON:
        raise debian.CapabilityError(f"{_PURPOSE}: found Python {own}, allowed {_PYTHON}, whose headers {_SUITE} has")
    debian.require_debian_root(_PURPOSE)
    # The C library's headers come with the compiler only where recommended packages do.
    packages = {_COMPILER: "gcc-aarch64-linux-gnu", "debootstrap": "debootstrap"}
    debian.install_commands(packages, _PURPOSE, beside=["libc6-dev-arm64-cross"])
    headers = _root() / "usr/include"
    return {
        "CC": _COMPILER,
        "LDSHARED": f"{_COMPILER} -shared",
        # Found before those of this machine's Python; the C library's are the compiler's own.
        "CFLAGS": f"-I{headers}/python{_PYTHON} -idirafter {headers}",
        "SETUPTOOLS_EXT_SUFFIX": f".cpython-{_PYTHON.replace('.', '')}-aarch64-linux-gnu.so",
        "_PYTHON_HOST_PLATFORM": "linux-aarch64",
    }


class Arm64Python:
    """A Python for aarch64 with the given libraries and wheels."""

    def __init__(self, requirements: Sequence[str], wheels: Sequence[Path], folder: Path) -> None:
        """Provide it; ``folder`` (empty) receives its libraries.

        Raises:
            CapabilityError: emulator, packages or wheels are not available here.
        """
        debian.require_debian_root(_PURPOSE)
        debian.install_commands({_EMULATOR: "qemu-user-static", "debootstrap": "debootstrap"}, _PURPOSE)
        self._root, self._site = _root(), folder
        _unpack_libraries(requirements, folder)
        for wheel in wheels:
            with zipfile.ZipFile(wheel) as archive:
                archive.extractall(folder)

    def start(self, arguments: Sequence[str], **environment: str) -> subprocess.Popen[str]:
        """Start it with its standard output as a pipe, with ``environment`` beside this process's."""
        variables = {**os.environ, **environment, "PYTHONHOME": str(self._root / "usr"), "PYTHONPATH": str(self._site)}
        # Emulated threads cost more than they bring.
        variables["OPENBLAS_NUM_THREADS"] = "1"
        python = str(self._root / f"usr/bin/python{_PYTHON}")
        emulated = [_EMULATOR, "-L", str(self._root), python]
        return subprocess.Popen([*emulated, *arguments], env=variables, stdout=subprocess.PIPE, text=True)
