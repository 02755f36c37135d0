"""The port table ``ports.toml`` as frozen dataclasses, loaded once.

The table is the single source: telegram classes check their fields against it, ``railhil.dbc`` is written from it,
and its DBC's SHA-256 is what the nodes compare before a run.
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

#: Data bits of a slave frame by F_code 0..4 (IEC 61375-3-1, process data).
DATA_BITS = {0: 16, 1: 32, 2: 64, 3: 128, 4: 256}
#: Code points of a 2-bit check variable and of an ANTIVALENT2 flag.
CHECK_VALUES = {0: "erroneous", 1: "correct", 2: "forced", 3: "undefined"}
ANTIVALENT_VALUES = {0: "error", 1: "false", 2: "true", 3: "undefined"}
#: Version of the wire contract, sent in the handshake.
WIRE_VERSION = 4

_FOLDER = Path(__file__).parent
#: Names of the port table and of its DBC, here and in a run folder.
PORTS, DBC = "ports.toml", "railhil.dbc"
_AT = re.compile(r"^(\d+)\.([0-7]):(\d+)$")


class ContractError(Exception):
    """The port table or the DBC is unusable; one line: file, key, found, allowed."""

    #: Bad input; the number of :data:`railhil.common.exit_codes.USAGE`, which this room does not know.
    exit_code = 2


@dataclass(frozen=True, slots=True)
class Signal:
    """One signal of a telegram, Motorola (big-endian) order.

    ``byte`` and ``msb`` locate its most significant bit in the whole telegram, ``length`` is in bits;
    physical value = raw * ``scale`` in ``unit``.
    """

    name: str
    byte: int
    msb: int
    length: int
    signed: bool = False
    scale: float = 1.0
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    comment: str = ""
    check: str = ""
    values: Mapping[int, str] = field(default_factory=dict)

    @property
    def block(self) -> int:
        """Index of the 64-bit block that holds the signal."""
        return self.byte // 8

    @property
    def first_bit(self) -> int:
        """Bits between the start of the telegram and the signal."""
        return self.byte * 8 + 7 - self.msb

    @property
    def raw_range(self) -> tuple[int, int]:
        """Smallest and largest raw value that fits."""
        if self.signed:
            return -(1 << (self.length - 1)), (1 << (self.length - 1)) - 1
        return 0, (1 << self.length) - 1


@dataclass(frozen=True, slots=True)
class Port:
    """One MVB port: a logical address with one source, sent as one telegram.

    ``period_ns`` is 0 for telegrams without a period (events without repetition, the handshake).
    """

    name: str
    address: int
    f_code: int
    period_ns: int
    source: str
    mode: str
    comment: str
    signals: tuple[Signal, ...]

    @property
    def data_bytes(self) -> int:
        """Length of the process data in bytes (2, 4, 8, 16, 32)."""
        return DATA_BITS[self.f_code] // 8

    @property
    def blocks(self) -> int:
        """Number of 64-bit blocks, 1 for the single-frame telegrams F0 and F1."""
        return max(1, self.data_bytes // 8)

    @property
    def single_frame(self) -> bool:
        """F0 and F1 fit into one CAN frame with both check sequences."""
        return self.f_code < 2

    @property
    def can_ids(self) -> tuple[int, ...]:
        """CAN identifiers of the classic form, in sending order."""
        if self.single_frame:
            return (self.address,)
        return (*range(self.address, self.address + self.blocks), self.address + 4)

    @property
    def fd_id(self) -> int:
        """CAN identifier of the CAN FD form (the classic payloads in one frame)."""
        return self.address + 5


@dataclass(frozen=True, slots=True)
class Contract:
    """The whole port table. ``sha256`` is the hash of the DBC text, which carries every layout."""

    bit_rate: int
    poll_id: int
    device_status_id: int
    base_tick_ns: int
    ports: tuple[Port, ...]
    sha256: str

    def port(self, name: str) -> Port:
        """Port by name; KeyError for an unknown one."""
        for port in self.ports:
            if port.name == name:
                return port
        raise KeyError(name)

    @property
    def clock_port(self) -> Port:
        """The plant's fastest periodic port: it opens every tick, and its life sign counts ticks."""
        periodic = [p for p in self.ports if p.source == "plant" and p.mode == "publish"]
        return min(periodic, key=lambda port: (port.period_ns, port.address))


def _signal(file: str, port: str, entry: Mapping[str, Any], prefix: str) -> Signal:
    match = _AT.match(str(entry.get("at", "")))
    if match is None:
        raise ContractError(
            f"{file}: {port}.{entry.get('name')}.at: found {entry.get('at')!r}, allowed byte.msb:length"
        )
    check = entry.get("check", "")
    values = {"chk": CHECK_VALUES, "antivalent": ANTIVALENT_VALUES}.get(check) or {
        int(key): str(text) for key, text in entry.get("values", {}).items()
    }
    return Signal(
        name=str(entry["name"]).replace("{p}", prefix),
        byte=int(match[1]),
        msb=int(match[2]),
        length=int(match[3]),
        signed=bool(entry.get("signed", False)),
        scale=float(entry.get("scale", 1.0)),
        unit=str(entry.get("unit", "")),
        minimum=entry.get("min"),
        maximum=entry.get("max"),
        comment=str(entry.get("comment", "")),
        check=check,
        values=values,
    )


def _checked(file: str, port: Port) -> Port:
    """The port, after the rules of the CAN mapping: address grid, room, no overlap, no signal across blocks."""
    if port.address % 8 or not 0x100 <= port.address <= 0x3F8:
        raise ContractError(
            f"{file}: {port.name}.address: found {port.address:#x}, allowed multiples of 8, 0x100..0x3f8"
        )
    if port.f_code not in DATA_BITS:
        raise ContractError(f"{file}: {port.name}.f_code: found {port.f_code}, allowed 0..4")
    if port.source not in ("plant", "controller", "supervisor"):
        raise ContractError(f"{file}: {port.name}.source: found {port.source!r}, allowed plant, controller, supervisor")
    if port.mode not in ("publish", "poll", "event"):
        raise ContractError(f"{file}: {port.name}.mode: found {port.mode!r}, allowed publish, poll, event")
    taken: set[int] = set()
    for signal in port.signals:
        bits = set(range(signal.first_bit, signal.first_bit + signal.length))
        if bits & taken:
            raise ContractError(
                f"{file}: {port.name}.{signal.name}.at: found bits of another signal, allowed free bits"
            )
        if max(bits) >= port.data_bytes * 8 or min(bits) // 64 != max(bits) // 64:
            raise ContractError(
                f"{file}: {port.name}.{signal.name}.at: found bits {min(bits)}..{max(bits)}, "
                f"allowed inside one 64-bit block of {port.data_bytes} bytes"
            )
        taken |= bits
    return port


def load_contract(path: Path = _FOLDER / PORTS, check_dbc: bool = True) -> Contract:
    """Read the port table and, unless told otherwise, check it against the DBC file beside it.

    :raises ContractError: one line with file, key, found and allowed; also when the DBC beside the table does not
        say the same (a foreign or outdated DBC).
    """
    from railhil.dbc.generate import dbc_text

    file = path.name
    draft = _read(path, "")
    digest = hashlib.sha256(dbc_text(draft).encode()).hexdigest()
    dbc_path = path.with_name(DBC)
    found = hashlib.sha256(dbc_path.read_bytes()).hexdigest() if dbc_path.exists() else "no file"
    if check_dbc and found != digest:
        raise ContractError(
            f"{dbc_path.name}: sha256: found {found[:16]}, allowed {digest[:16]} (from {file}; `make dbc` writes it)"
        )
    return replace(draft, sha256=digest)


def _read(path: Path, sha256: str) -> Contract:
    """The port table in a file. Raises ContractError."""
    file = path.name
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ContractError(f"{file}: {error}") from error
    try:
        return _made(file, table, sha256)
    except KeyError as error:
        raise ContractError(f"{file}: key {error}: found nothing, allowed a value: the key is required") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise ContractError(f"{file}: {error}; allowed a port table like that of railhil") from error


def _made(file: str, table: Mapping[str, Any], sha256: str) -> Contract:
    """The contract that a parsed port table says."""
    ports: list[Port] = []
    for entry in table["port"]:
        name = str(entry["name"])
        entries = entry["signals"]
        if isinstance(entries, str):
            entries = table["shared"][entries]
        prefix = name.split("_")[0].capitalize()
        port = Port(
            name=name,
            address=int(entry["address"]),
            f_code=int(entry["f_code"]),
            period_ns=int(entry["period_ms"]) * 1_000_000,
            source=str(entry["source"]),
            mode=str(entry["mode"]),
            comment=str(entry["comment"]),
            signals=tuple(_signal(file, name, item, prefix) for item in entries),
        )
        ports.append(_checked(file, port))
    bus = table["bus"]
    return Contract(
        bit_rate=int(bus["bit_rate"]),
        poll_id=int(bus["poll_id"]),
        device_status_id=int(bus["device_status_id"]),
        base_tick_ns=int(bus["base_tick_ms"]) * 1_000_000,
        ports=tuple(sorted(ports, key=lambda port: port.address)),
        sha256=sha256,
    )


def recorded_contract(folder: Path, sha256: str | None) -> Contract:
    """The contract that a record was made with: of its folder, else this version's, else an earlier one's.

    :param folder: run folder; its port table and DBC, if it has them, are :data:`PORTS` and :data:`DBC`.
    :param sha256: of the DBC, as the certificate says; None when nothing says it.
    :raises ContractError: the folder's DBC is another, or no version of railhil had the one that is asked for.
    """
    if (folder / PORTS).is_file() and (folder / DBC).is_file():
        found = hashlib.sha256((folder / DBC).read_bytes()).hexdigest()
        if sha256 not in (None, found):
            raise ContractError(f"{folder / DBC}: sha256: found {found}, allowed {sha256}, as in the certificate")
        return _read(folder / PORTS, found)
    if sha256 in (None, wire_contract().sha256):
        return wire_contract()
    earlier = _FOLDER / "history" / f"{sha256}.toml"
    if not earlier.is_file():
        allowed = f"one of a version of railhil, or {PORTS} and {DBC} in the folder"
        raise ContractError(f"{folder}: DBC: found sha256 {sha256}, allowed {allowed}")
    return _read(earlier, str(sha256))


@cache
def wire_contract() -> Contract:
    """The contract of this installation, loaded at first use (so that a broken file is reported by the command)."""
    return load_contract()
