"""Debian packages that tests need and the bench does not (compilers, QEMU, can-utils, Chromium, ssh-keygen), and where
this host has them from.

Each function refuses with :class:`railhil.machines.debian.CapabilityError` what it cannot have.
"""

from __future__ import annotations

from collections.abc import Mapping

from railhil.machines import debian

#: Names under which systems have Chromium.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")

#: Programs that build for emulated boards and run them, and the packages that have them.
EMULATION = {
    "qemu-system-arm": "qemu-system-arm",
    "qemu-system-aarch64": "qemu-system-arm",
    "arm-none-eabi-gcc": "gcc-arm-none-eabi",
    "aarch64-linux-gnu-gcc": "gcc-aarch64-linux-gnu",
}


def _install_missing(packages: Mapping[str, str], purpose: str) -> None:
    """Install the packages of missing commands. A host that has all of them need not be Debian's.

    Raises:
        CapabilityError: they are missing and cannot be had.
    """
    if not all(debian.find_command(command) for command in packages):
        debian.require_debian_root(purpose)
        debian.install_commands(packages, purpose)


def install_compilers() -> None:
    """Ensure that gcc, clang and make are installed for the exported C, with the C library's headers and the libraries
    of the sanitizers.

    Raises:
        CapabilityError: they are missing and cannot be had.
    """
    purpose = "exported C"
    commands = {"gcc": "build-essential", "make": "build-essential", "clang": "clang"}
    missing = {package for command, package in commands.items() if debian.find_command(command) is None}
    try:
        debian.run_tool(
            ["sh", "-c", "echo 'int main(void) { return 0; }' | clang -fsanitize=undefined -x c -o /dev/null -"]
        )
    except debian.MachineError:
        missing.add("libclang-rt-dev")
    if missing:
        debian.require_debian_root(purpose)
        debian.install_packages(missing, purpose)


def install_emulation() -> None:
    """Ensure that QEMU for Arm and gcc for Cortex-M and Cortex-A are installed, with their C libraries.

    Raises:
        CapabilityError: they are missing and cannot be had.
    """
    packages = {*EMULATION.values(), "libnewlib-arm-none-eabi", "libc6-dev-arm64-cross"}
    if not all(debian.find_command(command) for command in EMULATION):
        debian.require_debian_root("emulated boards")
        debian.install_packages(packages, "emulated boards")


def install_can_tools() -> None:
    """Ensure that can-utils and iproute2 are installed, which the tests on kernel SocketCAN use to listen, send and
    switch interfaces.

    Raises:
        CapabilityError: they are missing and cannot be had.
    """
    packages = {"candump": "can-utils", "ip": "iproute2", "setpriv": "util-linux"}
    _install_missing(packages, "tests on kernel SocketCAN")


def install_browser() -> None:
    """Ensure that Chromium is installed, which opens the report.

    Raises:
        CapabilityError: it is missing and cannot be had.
    """
    if not any(debian.find_command(command) for command in BROWSERS):
        debian.require_debian_root("report")
        debian.install_commands({"chromium": "chromium"}, "report")


def install_ssh() -> None:
    """Ensure that ssh-keygen is installed, which signs and checks lists of hashes.

    Raises:
        CapabilityError: it is missing and cannot be had.
    """
    _install_missing({"ssh-keygen": "openssh-client"}, "signed evidence")


def mirrors() -> list[tuple[str, str, str]]:
    """Debian's own package sources of the host: ``(uri, release, components)``, main archive first.

    Raises:
        MachineError: apt does not answer.
    """
    text = debian.run_tool(
        ["apt-get", "indextargets", "--format", "$(ORIGIN)|$(REPO_URI)|$(RELEASE)|$(COMPONENT)",
         "Identifier: Packages"]
    )  # fmt: skip
    rows = [line.split("|") for line in text.splitlines() if line.startswith("Debian|")]
    return sorted({(uri, release, part) for _, uri, release, part in rows}, key=lambda row: (len(row[1]), row))
