"""CAN in the kernel: whether it is supported, which interfaces exist, and their state."""

from __future__ import annotations

import json
import platform
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

from railhil.live.doctor.machine import Finding, said_by, text_of

#: Type of a CAN interface in /sys/class/net (ARPHRD_CAN of linux/if_arp.h).
_CAN_TYPE = "280"
#: IFF_UP of linux/if.h.
_UP = 1
#: Holds the burst of one tick many times; the kernel's default of 10 is too small for a pause of the recorder.
_QUEUE_MIN = 100
_SUBJECT = "kernel CAN"
_WITHOUT = "use the hub, or `railhil vcan -- COMMAND`"
_MAKE_VCAN = "sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up"


def kernel_can(
    root: Path = Path("/"), release: str | None = None, refusal: Callable[[], str] | None = None
) -> list[Finding]:
    """Whether the kernel has CAN, and the state of each interface.

    :param refusal: reason for which no CAN socket can be opened, empty if one can; None: try it.
    """
    reason = (refusal or _refusal)()
    if reason:
        return [_without(reason, _module(root, release or platform.release()))]
    names = can_interfaces(root)
    found = [Finding(_SUBJECT, "yes", "" if names else f"no interface: {_MAKE_VCAN}")]
    return found + [interface(root, name) for name in names]


def can_interfaces(root: Path) -> list[str]:
    """Names of the CAN interfaces, including vcan."""
    return sorted(path.parent.name for path in root.glob("sys/class/net/*/type") if text_of(path) == _CAN_TYPE)


def interface(root: Path, name: str, details: Callable[[str], dict[str, Any]] | None = None) -> Finding:
    """State, bit rate and queue of one interface.

    :param details: returns the output of ``ip -details -json`` for an interface; replaced in the tests.
    """
    folder = root / "sys/class/net" / name
    is_up = int(text_of(folder / "flags") or "0", 16) & _UP
    queue = int(text_of(folder / "tx_queue_len") or "0")
    info = (details or _details)(name)
    kind, data = info.get("info_kind", ""), info.get("info_data") or {}
    bit_rate = (data.get("bittiming") or {}).get("bitrate")
    words = [kind or "CAN", "up" if is_up else "down"]
    words += [f"{bit_rate} bit/s"] if bit_rate else []
    words += [str(data["state"])] if is_up and "state" in data else []
    words.append(f"txqueuelen {queue}")
    advice = ""
    if not is_up:
        rate = "" if kind in ("vcan", "vxcan", "slcan") or bit_rate else " type can bitrate 500000"
        advice = f"sudo ip link set {name}{rate} up"
    elif data.get("state") == "BUS-OFF":
        advice = f"sudo ip link set {name} type can restart"
    elif kind == "can" and not data.get("restart_ms"):
        words.append("no restart after bus-off")
        advice = f"sudo ip link set {name} down && sudo ip link set {name} type can restart-ms 100 && " + (
            f"sudo ip link set {name} up"
        )
    elif queue < _QUEUE_MIN:
        advice = f"sudo ip link set {name} txqueuelen 1000"
    return Finding(f"interface {name}", ", ".join(words), advice)


def _details(name: str) -> dict[str, Any]:
    """``linkinfo`` of an interface; empty without the tool."""
    said = said_by("ip", "-details", "-json", "link", "show", "dev", name)
    try:
        links = json.loads(said or "[]")
    except ValueError:
        return {}
    return dict(links[0].get("linkinfo") or {}) if links else {}


def _refusal() -> str:
    """Reason for which no CAN socket can be opened; empty if one can."""
    if not hasattr(socket, "AF_CAN"):
        return "this Python has no AF_CAN"
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        return (error.strerror or str(error)).lower()
    return ""


def _without(reason: str, module: bool) -> Finding:
    if module:
        return Finding(_SUBJECT, f"no ({reason}), its module vcan is there", f"sudo modprobe vcan && {_MAKE_VCAN}")
    return Finding(_SUBJECT, f"no ({reason}), and no module vcan for this kernel", _WITHOUT)


def _module(root: Path, release: str) -> bool:
    """Whether the module is installed for the running kernel."""
    folder = root / "lib/modules" / release
    return any("/vcan.ko" in text_of(folder / name) for name in ("modules.dep", "modules.builtin"))
