"""Available tools: serial ports for slcan, Docker, the tools for a virtual machine."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from railhil.live.doctor.finding import Finding, and_so_on, said_by

#: What `railhil vcan` needs to fetch a user-mode kernel and to start it, and the Debian package of each.
_MACHINE_TOOLS = {"dpkg-deb": "dpkg", "setpriv": "util-linux"}
_SYSTEM_PATH = "/usr/local/sbin:/usr/sbin:/sbin"


def tools(root: Path = Path("/")) -> list[Finding]:
    """Serial ports, virtual machine, Docker."""
    return [*serial_ports(root), virtual_machine(), docker()]


def serial_ports(root: Path) -> list[Finding]:
    """Serial ports on which an slcan adapter may be."""
    patterns = ("dev/ttyACM*", "dev/ttyUSB*")
    ports = sorted(path for pattern in patterns for path in root.glob(pattern))
    if not ports:
        return [Finding("serial ports", "none of the kind that slcan adapters have (ttyACM, ttyUSB)")]
    names = and_so_on([f"/{path.relative_to(root)}" for path in ports])
    if all(os.access(path, os.R_OK | os.W_OK) for path in ports):
        return [Finding("serial ports", f"{names} (`-i slcan -c PORT -b 500000`)")]
    return [Finding("serial ports", f"{names}, not all readable", "sudo usermod -aG dialout $USER, then log in again")]


def virtual_machine(system_path: str = _SYSTEM_PATH) -> Finding:
    """Whether `railhil vcan` can start a kernel with vcan.

    :param system_path: directories with system tools that are not on a user's PATH.
    """
    path = os.pathsep.join((os.environ.get("PATH", ""), system_path))
    missing = [package for tool, package in _MACHINE_TOOLS.items() if shutil.which(tool, path=path) is None]
    if missing:
        return Finding("railhil vcan", f"tools missing: {', '.join(missing)}", f"sudo apt install {' '.join(missing)}")
    return Finding("railhil vcan", "its tools are there")


def docker() -> Finding:
    """Docker for the compose file and its test."""
    if shutil.which("docker") is None:
        return Finding("docker", "not installed", "sudo apt install docker.io docker-compose")
    engine = said_by("docker", "version", "--format", "{{.Server.Version}}")
    if engine is None:
        return Finding(
            "docker", "installed, no engine answers", "sudo systemctl start docker, or join the group docker"
        )
    if said_by("docker", "compose", "version") is None and shutil.which("docker-compose") is None:
        return Finding("docker", f"engine {engine.strip()}, no compose", "sudo apt install docker-compose")
    return Finding("docker", f"engine {engine.strip()} with compose")
