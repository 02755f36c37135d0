"""The packing of a telegram class as source text: straight-line code for the signals of its port.

Every node packs or unpacks telegrams several times per tick, and a loop over the signals takes several times as long.
"""

from __future__ import annotations

from collections.abc import Sequence

from railhil.dbc import Signal


def codec_text(fields: Sequence[tuple[str, Signal]], data_bytes: int) -> str:
    """Functions ``encode`` and ``decode``, see :class:`railhil.bus.layout.Telegram`.

    :param fields: fields of the class with their signals, in order.
    :param data_bytes: length of the port's process data.
    """
    bits = data_bytes * 8
    return _encode_text(fields, bits) + "\n\n" + _decode_text(fields, bits)


def _encode_text(fields: Sequence[tuple[str, Signal]], bits: int) -> str:
    """A value fits if, after shifting into the unsigned range, no bits remain above its signal's length."""
    too_large, shifted = [], []
    for name, entry in fields:
        shift = bits - entry.first_bit - entry.length
        moved = f"raw_{name} + 0x{1 << entry.length - 1:X}" if entry.signed else f"raw_{name}"
        too_large.append(f"{moved} >> {entry.length}")
        value = f"(raw_{name} & 0x{(1 << entry.length) - 1:X})" if entry.signed else f"raw_{name}"
        shifted.append(f"{value} << {shift}" if shift else value)
    lines = [
        "def encode(telegram):",
        *(f"    raw_{name} = telegram.{name}" for name, _ in fields),
        "    if (",
        *_joined("or", too_large),
        "    ):",
        "        raise telegram.misfit()",
        "    word = (",
        *_joined("|", shifted),
        "    )",
        f"    return word.to_bytes({bits // 8})",
    ]
    return "\n".join(lines) + "\n"


def _joined(operator: str, words: Sequence[str]) -> list[str]:
    """An expression, a line for each operand; 0 without one."""
    return [f"        {f'{operator} ' if index else ''}{word}" for index, word in enumerate(words or ["0"])]


def _decode_text(fields: Sequence[tuple[str, Signal]], bits: int) -> str:
    """Two's complement: flip the sign bit, then subtract its weight."""
    lines = ["def decode(kind, data):", "    word = int.from_bytes(data)", "    return kind("]
    for name, entry in fields:
        shift = bits - entry.first_bit - entry.length
        value = f"word{f' >> {shift}' if shift else ''} & 0x{(1 << entry.length) - 1:X}"
        if entry.signed:
            sign = f"0x{1 << entry.length - 1:X}"
            value = f"({value} ^ {sign}) - {sign}"
        lines.append(f"        {value},  # {name}")
    lines.append("    )")
    return "\n".join(lines) + "\n"
