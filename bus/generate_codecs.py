"""Write ``codecs.py`` from the telegram classes: ``python -m railhil.bus.generate_codecs`` (or ``make dbc``).

Every node packs or unpacks telegrams several times per tick, so each telegram class has its own straight-line code,
equivalent to :meth:`railhil.bus.layout.Telegram.encode` and ``decode``, which loop over the signals.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from railhil.bus import ident, safe_telegrams, telegrams
from railhil.bus.layout import Telegram, codec_key
from railhil.dbc import Signal

_HEAD = '''"""Packing of each telegram, bit by bit. Written by ``make dbc`` from the port table; do not edit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")
'''


def telegram_classes(*modules: ModuleType) -> list[type[Telegram]]:
    """Telegram classes defined in the modules, one for each port, in the order of definition."""
    classes = [kind for module in modules for kind in vars(module).values() if isinstance(kind, type)]
    own = [kind for kind in classes if issubclass(kind, Telegram) and "PORT" in vars(kind)]
    # A layout shared by several ports is also a class: the last class that names a port is the port's own.
    return list({kind.PORT: kind for kind in own}.values())


def codecs_text(classes: list[type[Telegram]]) -> str:
    """Text of ``codecs.py`` for some classes."""
    rows = [f'    "{codec_key(kind)}": (encode_{_name(kind)}, decode_{_name(kind)}),\n' for kind in classes]
    return (
        _HEAD
        + "".join(_encode(kind) + _decode(kind) for kind in classes)
        + "\n\n#: Encode and decode of each telegram class.\n"
        + "CODECS: dict[str, tuple[Callable[[Any], bytes], Callable[[Any, bytes], Any]]] = {\n"
        + "".join(rows)
        + "}\n"
    )


def _name(kind: type[Telegram]) -> str:
    return kind.PORT.lower()


def _shift(kind: type[Telegram], entry: Signal) -> int:
    return kind.port().data_bytes * 8 - entry.first_bit - entry.length


def _encode(kind: type[Telegram]) -> str:
    """A value fits if, after shifting into the unsigned range, no bits remain above its signal's length."""
    lines = [f"def encode_{_name(kind)}(telegram: Any) -> bytes:"]
    signals = kind.signals()
    lines += [f"    {name}: int = telegram.{name}" for name, _ in signals]
    for index, (name, entry) in enumerate(signals):
        moved = f"{name} + 0x{1 << entry.length - 1:X}" if entry.signed else name
        lines.append(f"    misfit {'|=' if index else '='} {moved} >> {entry.length}")
    lines += ["    if misfit:", "        raise telegram.misfit()"]
    for index, (name, entry) in enumerate(signals):
        shift = _shift(kind, entry)
        bits = f"{name} & 0x{(1 << entry.length) - 1:X}" if entry.signed else name
        if shift:
            bits = f"({bits}) << {shift}" if entry.signed else f"{bits} << {shift}"
        lines.append(f"    word{' |=' if index else ': int ='} {bits}")
    lines.append(f'    return word.to_bytes({kind.port().data_bytes}, "big")')
    return "\n\n" + "\n".join(lines) + "\n"


def _decode(kind: type[Telegram]) -> str:
    """Two's complement: flip the sign bit, then subtract its weight."""
    lines = [f"def decode_{_name(kind)}(made: Callable[..., T], data: bytes) -> T:"]
    lines += ["    word = int.from_bytes(data)", "    return made("]
    for name, entry in kind.signals():
        shift = _shift(kind, entry)
        value = f"word{f' >> {shift}' if shift else ''} & 0x{(1 << entry.length) - 1:X}"
        if entry.signed:
            sign = f"0x{1 << entry.length - 1:X}"
            value = f"({value} ^ {sign}) - {sign}"
        lines.append(f"        {value},  # {name}")
    lines.append("    )")
    return "\n\n" + "\n".join(lines) + "\n"


def main() -> None:
    """Write ``codecs.py`` beside this file."""
    target, classes = Path(__file__).with_name("codecs.py"), telegram_classes(telegrams, safe_telegrams, ident)
    target.write_text(codecs_text(classes), encoding="utf-8")
    print(f"{target.name}: {len(classes)} telegrams")


if __name__ == "__main__":
    main()
