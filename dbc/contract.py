"""The wire contract as frozen dataclasses: ports, their signals, and the numbers of the bus."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

#: Data bits of a slave frame by F_code 0..4 (IEC 61375-3-1, process data).
DATA_BITS = {0: 16, 1: 32, 2: 64, 3: 128, 4: 256}
#: Code points of a 2-bit check variable and of an ANTIVALENT2 flag.
CHECK_CORRECT = 1
CHECK_VALUES = {0: "erroneous", 1: "correct", 2: "forced", 3: "undefined"}
ANTIVALENT_VALUES = {0: "error", 1: "false", 2: "true", 3: "undefined"}

#: Names of the port table and of its DBC, here and in a run folder.
PORTS, DBC = "ports.toml", "railhil.dbc"
#: The table of the ports that every system has.
HOUSE = "house.toml"


def snake_case(name: str) -> str:
    """A name of the port table as a field or a C function has it: ``TrainPos`` is ``train_pos``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


class ContractError(Exception):
    """The port table or the DBC is unusable; one line: file, key, found, allowed."""

    #: Bad input; the value of :data:`railhil.common.exit_codes.USAGE`, which this package must not import.
    exit_code = 2


@dataclass(frozen=True, slots=True)
class Signal:
    """One signal of a telegram, Motorola (big-endian) order.

    ``byte`` and ``msb`` locate its most significant bit in the whole telegram, ``length`` is in bits;
    physical value = raw * ``scale`` in ``unit``.

    ``field_name`` and ``default``: its field in the telegram class, and the raw value there in a new telegram.
    ``codes``: name and members of the enumeration of its values, if it has one. No layout depends on these.
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
    field_name: str = field(default="", compare=False)
    default: int = field(default=0, compare=False)
    codes: tuple[str, Mapping[str, int]] | None = field(default=None, compare=False)

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

    ``period_ns`` is 0 for telegrams without a period (events without repetition, the handshake). ``telegram``: name of
    its telegram class; ``layout``: name of the class that it shares with other ports (empty: none).
    """

    name: str
    address: int
    f_code: int
    period_ns: int
    source: str
    mode: str
    comment: str
    signals: tuple[Signal, ...]
    #: Sent only in scenarios that ask for it.
    optional: bool = False
    telegram: str = field(default="", compare=False)
    layout: str = field(default="", compare=False)
    _signals: dict[str, Signal] = field(init=False, repr=False, compare=False)
    _cuts: dict[str, tuple[int, int, int]] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        # Whether the F code is one of them is checked later, with the file's name.
        bits = DATA_BITS.get(self.f_code, 0)
        cuts = {
            one.name: (bits - one.first_bit - one.length, (1 << one.length) - 1, one.raw_range[1])
            for one in self.signals
        }
        object.__setattr__(self, "_signals", {item.name: item for item in self.signals})
        object.__setattr__(self, "_cuts", cuts)

    def cut(self, name: str) -> tuple[int, int, int]:
        """Place of a signal in the telegram as one number: bits behind it, mask, largest raw value; KeyError for an
        unknown one."""
        return self._cuts[name]

    def signal(self, name: str) -> Signal:
        """Signal by name; KeyError for an unknown one."""
        return self._signals[name]

    def has(self, name: str) -> bool:
        """Whether the telegram has this signal."""
        return name in self._signals

    @property
    def codes(self) -> dict[str, Mapping[str, int]]:
        """The enumerations of its signals, each with its members."""
        return dict(signal.codes for signal in self.signals if signal.codes)

    @property
    def life(self) -> Signal | None:
        """The life sign: the signal whose name ends in Life; None: the telegram has none."""
        return next((one for one in self.signals if one.name.endswith("Life")), None)

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
    _ports: dict[str, Port] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_ports", {port.name: port for port in self.ports})

    def port(self, name: str) -> Port:
        """Port by name; KeyError for an unknown one."""
        return self._ports[name]

    def has(self, port: str, signal: str) -> bool:
        """Whether there is such a port, with such a signal."""
        found = self._ports.get(port)
        return found is not None and found.has(signal)

    @property
    def clock_port(self) -> Port:
        """The plant's fastest periodic port: it opens every tick, and its life sign counts ticks."""
        periodic = [p for p in self.ports if p.source == "plant" and p.mode == "publish"]
        return min(periodic, key=lambda port: (port.period_ns, port.address))
