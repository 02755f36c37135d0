"""Tables, drawings and vectors of docs/reference/wire.md, from the port table and the code of the bus."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from hil_tests.documents.figures import LVSHUN, row
from railhil.bus import mvb, packing
from railhil.bus.frame import Frame
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.mvb import (
    F_DEVICE_STATUS,
    TelegramSource,
    check_sequence,
    device_status_frame,
    master_frame,
    master_word,
)
from railhil.dbc import Signal, wire_contract
from railhil.scenarios.load import load
from railhil.wire.ato import CtlMode, CtlStat, NotchCmd

#: Device status of a controller that has nothing to report.
READY: Final = 0x1000
#: Answers of a controller that has nothing to say on itself, in the published run.
SIMPLEST: Final[tuple[Telegram, ...]] = (
    make_ident(Role.CONTROLLER, load(LVSHUN).sha256, pace="lockstep", contract=wire_contract()),
    NotchCmd(notch_256th=-384, mode=CtlMode.RUNNING, life=5),
    CtlStat(life=9),
)
#: What stands there instead of one value, by the signal.
_INSTEAD: Final = {
    "CtlScenarioHash": "as in PLT_IDENT",
    "CtlWireHash": "first 32 bits of the SHA-256 of the DBC, or as in PLT_IDENT",
    "CtlSeed": "any value: not compared",
    "CtlPace": "as in PLT_IDENT, or 0: not stated",
    "CtlVersion": "as in PLT_IDENT",
    "NotchCmd": "the command, 1/256 notch",
    "StepCount": "control steps so far, or 0",
}
#: What the value means, where the port table has a word for its own use, or none.
_MEANS: Final = {
    "CtlLaw": "not stated",
    "CtlArithmetic": "not stated",
    "CtlIndexing": "not stated",
    "TelemetryIndex": "no quantity",
    "TelemetryHeadroom": "no fixed point",
}
#: What is to be said beside the value.
_BESIDE: Final = {
    "CtlPerturbed": "; not compared",
    "EmergencyBrake": "; anything else applies the emergency brake",
}


def telegrams() -> Sequence[str]:
    """The ports that a controller receives or sends."""
    contract, bench_only = wire_contract(), ("SUP_CMD", "SUP_IDENT", "SIM_TRUTH")
    return [
        row(
            f"`{port.address:03X}`",
            port.name,
            port.f_code,
            " ".join(f"`{can_id:03X}`" for can_id in port.can_ids),
            f"{port.period_ns // 1_000_000}" if port.period_ns else "-",
            "controller, polled" if port.source == "controller" else port.source,
        )
        for port in sorted(contract.ports, key=lambda port: port.address)
        if port.name not in bench_only and not port.optional
    ]


def single() -> Sequence[str]:
    """The drawing of a telegram in one frame."""
    return [_drawings(mvb.__doc__)[0]]


def several() -> Sequence[str]:
    """The drawing of a trailer."""
    return [_drawings(mvb.__doc__)[1]]


def packets() -> Sequence[str]:
    """The hub's packets of classic frames."""
    return [next(one for one in _drawings(packing.__doc__) if "pad" in one)]


def _drawings(text: str | None) -> list[str]:
    """Drawings of a docstring: lines that are indented and have a frame."""
    found = re.findall(r"(?:^ {4,}.*[|+0-9].*\n)+", text or "", re.M)
    return [one.strip() for one in found if "+--" in one]


def vectors() -> Sequence[str]:
    """Check sequences of blocks of each length."""
    blocks = [
        bytes(2),
        READY.to_bytes(2),
        *(master_word(F_DEVICE_STATUS, 1), master_word(1, NotchCmd.port().address)),
        bytes.fromhex("deadbeef"),
        SIMPLEST[1].encode(),
        bytes.fromhex("0102030405060708"),
    ]
    return [row(f"`{block.hex(' ')}`", len(block), f"`{check_sequence(block):02x}`") for block in blocks]


def dialogue() -> Sequence[str]:
    """Polls and answers, octet by octet."""
    lines = [("poll of the device status of device 1", [master_frame(F_DEVICE_STATUS, 1)])]
    lines += [("ready, nothing to report", [device_status_frame(1, READY)])]
    for telegram in SIMPLEST:
        port = telegram.port()
        lines += [(f"poll of {port.name}", [master_frame(port.f_code, port.address)])]
        lines += [("answer", TelegramSource(port).frames(telegram.encode()))]
    return [_frame(what if not number else "", frame) for what, frames in lines for number, frame in enumerate(frames)]


def _frame(what: str, frame: Frame) -> str:
    return row(f"`{frame.can_id:03X}`", f"`{frame.data.hex(' ')}`", what)


def answers() -> Sequence[str]:
    """Signals of the answers, with their places and values in the simplest form; without those that are always 0."""
    return [line for telegram in SIMPLEST for line in _signals(telegram)]


def _signals(telegram: Telegram) -> Iterator[str]:
    port = telegram.port()
    for field, signal in telegram.signals():
        said = _said(signal, getattr(telegram, field))
        if said != "0":
            yield row(port.name, signal.name, f"{signal.byte}.{signal.msb}:{signal.length}", said)


def _said(signal: Signal, value: int) -> str:
    if signal.name.endswith("Life"):
        return "life sign"
    if signal.name in _INSTEAD:
        return _INSTEAD[signal.name]
    word = _MEANS.get(signal.name, signal.values.get(value, "") if value else "")
    return f"{value}{word and ': '}{word}{_BESIDE.get(signal.name, '')}"
