"""Numbers as text with enough digits: rounding must not turn one statement into another."""

from __future__ import annotations

from collections.abc import Mapping

#: Significant digits that give a float exactly.
_DIGITS_MAX = 17


def text_beside_limit(value: float, limit: float, digits: int, sign: str = "", kind: str = "f") -> str:
    """A value beside its limit, with enough digits to show on which side of the limit it is.

    >>> text_beside_limit(0.30004, 0.3, 3, "+"), text_beside_limit(0.4, 0.3, 3)
    ('+0.30004', '0.400')

    :param limit: with a ``sign``, of the magnitude.
    :param digits: smallest number of decimals, or of significant digits with ``kind`` g.
    :param sign: ``+``: the sign is always shown.
    """

    def side(of: float) -> int:
        size = abs(of) if sign else of
        return int(size > limit) - int(size < limit)

    for more in range(digits, _DIGITS_MAX):
        text = f"{value:{sign}.{more}{kind}}"
        if side(float(text)) == side(value):
            return text
    return f"{value:{sign}.{_DIGITS_MAX}g}"


def count_of(count: int, noun: str, nouns: str = "", spec: str = "") -> str:
    """A number of things, the noun in the singular for one of them.

    >>> count_of(1, "run"), count_of(2, "entry", "entries"), count_of(1500, "run", spec=",")
    ('1 run', '2 entries', '1,500 runs')

    :param nouns: the plural, unless it is the noun with an s.
    :param spec: format of the number.
    """
    return f"{count:{spec}} {noun if count == 1 else nouns or noun + 's'}"


def rounded(values: Mapping[str, float | None]) -> str:
    """Named figures for a reader.

    >>> rounded({"stop_error_m": 0.006300000000010186, "late_s": None})
    'stop_error_m=0.0063, late_s=None'
    """
    return ", ".join(f"{name}={value if value is None else format(value, '.6g')}" for name, value in values.items())


def percent(share: float, digits: int = 2) -> str:
    """A share of runs in per cent: 100 only for all of them, 0 only for none.

    >>> percent(20_000 / 20_001), percent(1.0), percent(0.5)
    ('99.995%', '100.00%', '50.00%')
    """
    if share in (0.0, 1.0):
        return f"{share:.{digits}%}"
    for more in range(digits, _DIGITS_MAX):
        text = f"{share:.{more}%}"
        if 0.0 < float(text.removesuffix("%")) < 100.0:
            return text
    return f"{100 * share:.{_DIGITS_MAX}g}%"
