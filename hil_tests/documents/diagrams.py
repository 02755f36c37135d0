"""Diagrams of the pages as SVG, drawn from the port table, a scenario's limits, and the frames of a short run.

Each function returns the whole text of a file. A picture has a background of its own and follows the scheme that the
reader's system asks for, so that it can be read in both, wherever it stands.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from html import escape
from pathlib import Path

from hil_tests.support.short_runs import RUN_2M_TOML
from hil_tests.support.slave_frames import slave_frame
from railhil.bench import local_run
from railhil.bus.mvb import master_tail
from railhil.dbc import Port
from railhil.dbc.contract import Signal
from railhil.record.framelog import read_log
from railhil.scenarios.load import load
from railhil.scenarios.system import system_named
from railhil.wire.ato import TrnSpeed

_WIDTH = 680
_LIGHT = """--paper:#fff;--ink:#1b1f24;--dim:#57606a;--line:#8c959f;
 --plant:#ddf4ff;--controller:#dafbe1;--supervisor:#fff3c4;--house:#f3f4f6"""
_DARK = """--paper:#16181c;--ink:#ececec;--dim:#a9adb3;--line:#7d838b;
 --plant:#12364f;--controller:#143d26;--supervisor:#4a3b0c;--house:#262a30"""
_STYLE = f"""
svg{{{_LIGHT}}}
@media (prefers-color-scheme:dark){{svg{{{_DARK}}}}}
text{{font:14px system-ui,sans-serif;fill:var(--ink)}} .dim{{fill:var(--dim)}} .bold{{font-weight:600}}
.mono{{font-family:ui-monospace,monospace}} .small{{font-size:12px}}
.middle{{text-anchor:middle}} .end{{text-anchor:end}}
rect,path{{stroke:var(--line);stroke-width:1.5;fill:none}}
.paper{{fill:var(--paper);stroke:none}} .dashed{{stroke-dasharray:5 4}}
.plant{{fill:var(--plant)}} .controller{{fill:var(--controller)}} .supervisor{{fill:var(--supervisor)}}
.house{{fill:var(--house)}}"""


class _Drawing:
    """Shapes and texts of one picture. Places and sizes are in px."""

    def __init__(self, height: float, title: str) -> None:
        self._height, self._title = height, title
        self._parts: list[str] = []

    def text(self, x: float, y: float, text: str, look: str = "") -> None:
        """``y`` is the base line."""
        self._parts.append(f'<text x="{x:g}" y="{y:g}" class="{look}">{escape(text)}</text>')

    def box(self, x: float, y: float, width: float, height: float, look: str, *, radius: float = 6) -> None:
        self._parts.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius:g}" class="{look}"/>'
        )

    def path(self, d: str, *, is_arrow: bool = False, look: str = "") -> None:
        heads = ' marker-end="url(#head)"' * is_arrow
        self._parts.append(f'<path d="{d}" class="{look}"{heads}/>')

    def svg(self) -> str:
        head = (
            '<marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
            'orient="auto-start-reverse"><path d="M0 0L10 5L0 10Z" style="fill:var(--line);stroke:none"/></marker>'
        )
        return "\n".join(
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {self._height:g}" role="img">',
                f"<title>{escape(self._title)}</title><style>{_STYLE}</style><defs>{head}</defs>",
                f'<rect class="paper" width="{_WIDTH}" height="{self._height:g}" rx="8"/>',
                *self._parts,
                "</svg>\n",
            )
        )


def _ports() -> Sequence[Port]:
    """Ports that have a period in every run."""
    return [port for port in system_named("ato").contract.ports if port.period_ns and not port.optional]


def bench() -> str:
    """The processes, the bus with the telegrams of each source, and what stands around them."""
    roles = {
        "plant": ("Plant", "train, line, sensors"),
        "controller": ("Controller", "the law under test"),
        "supervisor": ("Supervisor", "records and judges"),
    }
    drawing = _Drawing(418, "The bench: plant, controller and supervisor on a bus")
    for number, (role, (name, purpose)) in enumerate(roles.items()):
        x = 16 + 220 * number
        drawing.box(x, 16, 200, 214, role)
        drawing.text(x + 12, 40, name, "bold")
        drawing.text(x + 12, 58, purpose, "dim")
        sent = [port for port in _ports() if port.source == role and port.mode != "event"]
        for line, port in enumerate(sorted(sent, key=lambda port: port.period_ns)):
            drawing.text(x + 12, 86 + 22 * line, port.name, "mono small")
            drawing.text(x + 188, 86 + 22 * line, f"{port.period_ns / 1e6:g} ms", "end small dim")
        drawing.path(f"M{x + 100} 230V268", is_arrow=True)
        drawing.path(f"M{x + 100} 268V232", is_arrow=True)
    drawing.box(16, 270, 640, 38, "house")
    drawing.text(336, 294, "CAN bus with MVB telegrams: railhil's pipes or hub, kernel vcan, or an adapter", "middle")
    below = (
        ("Panel", "a page with the live run", "house"),
        ("Your board", "instead of the controller", "controller dashed"),
        ("Run folder", "log, certificate, report", "house"),
    )
    for number, (name, purpose, look) in enumerate(below):
        x = 16 + 220 * number
        drawing.box(x, 346, 200, 56, look)
        drawing.text(x + 100, 370, name, "bold middle")
        drawing.text(x + 100, 390, purpose, "dim middle")
    drawing.path("M116 308V344", is_arrow=True)
    drawing.path("M336 344V310", is_arrow=True)
    drawing.path("M336 310V344", is_arrow=True)
    drawing.path("M656 200H672V374H658", is_arrow=True)
    return drawing.svg()


def telegram() -> str:
    """TRN_SPEED on CAN: its bytes for one speed, and the signals in them."""
    port = system_named("ato").contract.port("TRN_SPEED")
    data = TrnSpeed(speed_01mmps=123456, life=5).encode()
    frame = slave_frame(data) + master_tail(port.f_code, port.address)
    drawing = _Drawing(252, f"The telegram {port.name} as a CAN frame")
    drawing.text(16, 30, f"{port.name}: {port.comment.partition(';')[0]}", "bold")
    drawing.text(
        16, 52, f"CAN identifier {port.address:X} (hex), {port.period_ns / 1e6:g} ms, sent by the {port.source}", "dim"
    )
    left, byte_px = 16, 81
    for place, octet in enumerate(frame):
        drawing.text(left + byte_px * place, 80, f"byte {place}", "small dim")
        drawing.box(left + byte_px * place, 88, byte_px, 34, port.source, radius=0)
        drawing.text(left + byte_px * (place + 0.5), 110, f"{octet:02X}", "mono middle")

    def part(first_bit: int, bits: int, name: str, meaning: str, row: int) -> None:
        x, width = left + byte_px * first_bit / 8, byte_px * bits / 8
        drawing.path(f"M{x + 2} 128V134H{x + width - 2}V128")
        # Names of short signals go below each other.
        drawing.path(f"M{x + width / 2} 134V{142 + 18 * row}")
        look = "small" + (" middle" if row == 0 else "")
        drawing.text(x + width / 2 + (0 if row == 0 else 5), 156 + 18 * row - (0 if row == 0 else 8), name, look)
        if meaning:
            drawing.text(x + width / 2, 174, meaning, "small dim middle")

    def value(signal: Signal) -> str:
        bits = int.from_bytes(data) >> (8 * len(data) - signal.first_bit - signal.length)
        return f"{(bits & ((1 << signal.length) - 1)) * signal.scale:g} {signal.unit}"

    bits = 8 * len(data)
    for row, signal in enumerate(port.signals):
        meaning = f"{value(signal)}: a number of {signal.scale:g} {signal.unit}" if row == 0 else ""
        part(signal.first_bit, signal.length, signal.name, meaning, row=row and 5 - row)
    part(bits, 8, "check", "", 0)
    part(bits + 8, 16, "which port", "", 0)
    part(bits + 24, 8, "check", "", 0)
    drawing.text(
        left, 240, "A check sequence detects every error of up to three bits in what is before it.", "small dim"
    )
    return drawing.svg()


def ladder() -> str:
    """The reaction ladder of the controller's watch over the age of the speed."""
    watch = load("lvshun_tieshan").watch
    levels = (
        ("NORMAL", 0, "the law's notch"),
        ("HOLD", watch.hold_ms, "the last notch, or less"),
        ("TRACTION CUT", watch.traction_cut_ms, "no traction, braking kept"),
        ("SERVICE BRAKE", watch.service_brake_ms, "brakes until it stands or hears again"),
        ("EMERGENCY", watch.emergency_ms, "full brake until the end of the run"),
    )
    drawing = _Drawing(320, "Reaction ladder: what the controller does while its speed telegram is missing")
    drawing.text(16, 30, "No speed telegram for ...", "bold")
    drawing.text(16, 50, "the controller does (the scale of time is logarithmic):", "dim")
    low, high = math.log10(10), math.log10(3000)

    def place(ms: float) -> float:
        return 16 + (math.log10(max(ms, 10)) - low) / (high - low) * 648

    step = 44
    for number, (name, since_ms, reaction) in enumerate(levels):
        y = 270 - step * number
        end = place(levels[number + 1][1]) if number + 1 < len(levels) else 664
        drawing.box(
            place(since_ms), y - step + 6, end - place(since_ms), step - 6, ("controller", "supervisor")[number > 1]
        )
        if number:
            drawing.path(f"M{place(since_ms)} {y}V284", look="dashed")
            drawing.text(place(since_ms), 302, f"{since_ms} ms", "small middle")
        is_right = number > 1
        x = place(since_ms) - 10 if is_right else end + 10
        look = "end" if is_right else ""
        drawing.text(x, y - 24, name, f"{look} bold small")
        drawing.text(x, y - 8, reaction, f"{look} small dim")
    drawing.path("M16 284H664", is_arrow=True)
    return drawing.svg()


#: Ticks of 10 ms in the picture: one more than the period of most slow ports.
_TICKS = 17


def tick() -> str:
    """Which telegrams the bus carries in which tick, from the frames of a short run, in their order within a tick."""
    contract = system_named("ato").contract
    by_address = {port.address: port for port in _ports() if port.mode != "event"}
    with tempfile.TemporaryDirectory(prefix="railhil-") as name:
        path = Path(name) / "short.toml"
        path.write_text(RUN_2M_TOML, encoding="utf-8")
        scenario = load(str(path))
        local_run(scenario, Path(name))
        tick_ns = scenario.timing.base_tick_ns
        # The slowest port is due in this one.
        start_ns = max(port.period_ns for port in by_address.values())
        seen: dict[str, set[int]] = {}
        for time_ns, frame in read_log(Path(name) / "frames.log"):
            number, port = (time_ns - start_ns) // tick_ns, by_address.get(frame.can_id & ~7)
            if port is not None and 0 <= number < _TICKS:
                seen.setdefault(port.name, set()).add(number)
    rows = list(seen)
    drawing = _Drawing(96 + 26 * len(rows), "The telegrams of 17 ticks")
    drawing.text(16, 28, f"{_TICKS} ticks of {tick_ns / 1e6:g} ms, and the telegrams in each, in their order", "bold")
    left, wide = 130, 31
    for number in range(_TICKS):
        drawing.text(left + wide * (number + 0.5), 52, f"{number * tick_ns // 1_000_000}", "small dim middle")
    for row, port_name in enumerate(rows):
        y = 64 + 26 * row
        drawing.text(16, y + 15, port_name, "mono small")
        for number in seen[port_name]:
            drawing.box(left + wide * number + 3, y, wide - 6, 20, contract.port(port_name).source, radius=4)
    y = 64 + 26 * len(rows)
    for number, role in enumerate(("plant", "controller", "supervisor")):
        drawing.box(left + 170 * number, y + 8, 18, 14, role, radius=3)
        drawing.text(left + 170 * number + 26, y + 20, f"sent by the {role}", "small")
    drawing.text(16, y + 20, "time, ms", "small dim")
    return drawing.svg()


#: File in docs/pictures -> what draws it.
DIAGRAMS: Mapping[str, Callable[[], str]] = {
    "bench.svg": bench, "telegram.svg": telegram, "ladder.svg": ladder, "tick.svg": tick,
}  # fmt: skip
