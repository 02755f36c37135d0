"""The settings of a session of pytest: from its command line, the environment, or the ini file."""

from __future__ import annotations

import re
from argparse import ArgumentTypeError
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from railhil.common.command_line import seed_list

#: Option without ``--railhil-`` -> its line in the help. In the ini file it is ``railhil_...``, in the environment
#: ``RAILHIL_...``.
OPTIONS: Mapping[str, str] = {
    "bus": "local (default): all nodes in this process; auto, hub, or INTERFACE:CHANNEL[@BITRATE], such as "
    "socketcan:can0",
    "seeds": "values of the fixture seed, such as 0,1,5-9 (default 0)",
    "runs": "folder that keeps the run folders of all tests (default: pytest's temporary folder, and of a passed test "
    "only the certificates)",
    "pace": "lockstep (default) or realtime",
    "target": "emulated board on which the laws of the tests run, exported, such as qemu:cortex-m4f",
    "requirements": "list in ReqIF: each marker names one of it, its requirements without a test are "
    "told, and --railhil-runs gets a copy with the results",
    "no-controller": "the controller is a board or another program on the bus",
}
FLAG = "no-controller"
_BUS = re.compile(r"local|auto|hub|[\w.-]+:[^@\s]+(@\d+)?")
_TARGET = re.compile(r"qemu:[^@]+")
_SEEDS_MAX = 100_000
_TRUE, _FALSE = ("1", "true", "yes", "on"), ("", "0", "false", "no", "off")


@dataclass(frozen=True)
class Settings:
    """``runs``: None for pytest's temporary folder. ``target``: empty for laws in Python. ``requirements``: None: no
    list."""

    bus: str = "local"
    seeds: tuple[int, ...] = (0,)
    runs: Path | None = None
    pace: str = "lockstep"
    no_controller: bool = False
    target: str = ""
    requirements: Path | None = None

    @property
    def interface(self) -> str:
        """python-can's name of the interface; empty where railhil chooses the bus."""
        return self.bus.partition(":")[0] if ":" in self.bus else ""


def settings_from(given: Callable[[str], tuple[str, str]], folder: Path) -> Settings:
    """The settings of a session.

    :param given: name of an option -> its text and the user's name for it; the text is empty if the option was not
        given.
    :param folder: folder to which ``runs`` and ``requirements`` are relative.
    :raises ValueError: a setting is not allowed; one line.
    """
    said = {name: given(name) for name in OPTIONS}

    def refused(name: str, allowed: str) -> ValueError:
        text, where = said[name]
        return ValueError(f"{where}: found {text!r}, allowed {allowed}")

    bus = said["bus"][0] or "local"
    if not _BUS.fullmatch(bus):
        raise refused("bus", "local, auto, hub or INTERFACE:CHANNEL[@BITRATE]")
    pace = said["pace"][0] or "lockstep"
    if pace not in ("lockstep", "realtime"):
        raise refused("pace", "lockstep or realtime")
    if pace == "realtime" and bus == "local":
        raise refused("pace", "lockstep on the bus local (--railhil-bus hub runs in real time)")
    flag = said[FLAG][0].lower()
    if flag not in (*_TRUE, *_FALSE):
        raise refused(FLAG, f"{', '.join(_TRUE)} or {', '.join(_FALSE[1:])}")
    if flag in _TRUE and ":" not in bus:
        raise refused(FLAG, "nothing, or a bus beside it on which the board is (--railhil-bus INTERFACE:CHANNEL)")
    try:
        seeds = tuple(dict.fromkeys(seed_list(said["seeds"][0] or "0", _SEEDS_MAX)))
    except ArgumentTypeError as error:
        raise ValueError(f"{said['seeds'][1]}: {error}") from None
    runs = said["runs"][0]
    target = said["target"][0]
    if target and not _TARGET.fullmatch(target):
        raise refused("target", "qemu:BOARD, such as qemu:cortex-m4f")
    if target and flag in _TRUE:
        raise refused("target", f"nothing beside --railhil-{FLAG}")
    listed = said["requirements"][0]
    return Settings(
        bus, seeds, folder / runs if runs else None, pace, flag in _TRUE, target, folder / listed if listed else None
    )  # fmt: skip
