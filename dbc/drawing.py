"""The docstring of a telegram class, made from its port: the layout as a drawing, and the meaning of each field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from railhil.dbc.contract import Port, Signal

#: A row of a drawing ends before it is wider than this.
_COLUMNS = 100


def described(port: Port) -> str:
    """The purpose of a port, the drawing of its telegram, and the meaning of each field."""
    layout = [f"    {line}".rstrip() for line in drawing(port).splitlines()]
    words = [f"{port.name}: {port.comment}.", "", "::", "", *layout, "", *map(_meaning, port.signals)]
    return "\n".join(words) + "\n"


def drawing(port: Port) -> str:
    """Layout of a telegram: for each signal a box with its field and type, above it its byte and most significant bit.

    A row shows at most 64 bits.
    """
    rows: list[list[_Box]] = []
    for start in range(0, port.data_bytes * 8, 64):
        rows.append([])
        for box in _boxes(port.signals, start, min(start + 64, port.data_bytes * 8)):
            if sum(_width(each) + 1 for each in (*rows[-1], box)) > _COLUMNS:
                rows.append([])
            rows[-1].append(box)
    return "\n".join(line for row in rows for line in _lines(row))


#: Place of the first bit, field, type; the last two are empty for bits without a signal.
_Box = tuple[str, str, str]


def _boxes(signals: Sequence[Signal], start: int, end: int) -> Iterator[_Box]:
    """The boxes between two bits."""
    bit = start
    for signal in sorted(signals, key=lambda each: each.first_bit):
        if start <= signal.first_bit < end:
            if signal.first_bit > bit:
                yield _place(bit), "", ""
            yield _place(signal.first_bit), signal.field_name, f"{'s' if signal.signed else 'u'}{signal.length}"
            bit = signal.first_bit + signal.length
    if bit < end:
        yield _place(bit), "", ""


def _place(bit: int) -> str:
    return f"{bit // 8}.{7 - bit % 8}"


def _width(box: _Box) -> int:
    return max(map(len, box)) + 2


def _lines(boxes: Sequence[_Box]) -> list[str]:
    widths = list(map(_width, boxes))
    edge = "".join(f"+{'-' * width}" for width in widths) + "+"
    sized = list(zip(boxes, widths, strict=True))
    places = "".join(f" {place:<{width}}" for (place, _, _), width in sized).rstrip()
    fields = "".join(f"|{name:^{width}}" for (_, name, _), width in sized) + "|"
    types = "".join(f"|{kind:^{width}}" for (_, _, kind), width in sized) + "|"
    return [places, edge, fields, types, edge]


def _meaning(signal: Signal) -> str:
    unit = "" if signal.unit == "1" else signal.unit
    count = f"1 is {signal.scale:g} {unit}".rstrip() if unit or signal.scale != 1.0 else ""
    values = ", ".join(f"{number} {text}" for number, text in signal.values.items())
    words = "; ".join(filter(None, (count, values, signal.comment)))
    return f"- ``{signal.field_name}``: {signal.name}" + (f"; {words}" if words else "")
