"""Numbers as decimal text: ``_atoIQ`` and ``_IQtoa`` of both profiles, for parameters and displays.

The two libraries differ and neither is fully documented; constants of a law are therefore emitted as integers.
"""

from __future__ import annotations

import re

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN

_DECIMAL = re.compile(r"(-?)([0-9]*)(?:\.([0-9]*))?")
_FORM = re.compile(r"%([0-9]{1,2})\.([0-9]{0,2})[fF]")
_WIDTH_MAX = 11
#: Digits of the largest int32.
_WHOLE_DIGITS_MAX = 10
#: 0.1 in Q31, rounded, as in the portable library.
_TENTH = 0x0CCCCCCD
_MASK = 2**32 - 1

#: Error numbers of ``_IQtoa``.
TOO_NARROW, ILLEGAL_FORM = 1, 2


def rounded_decimal(text: str, q: int) -> int:
    """Exact value of a decimal text in Q ``q``, rounded to nearest, ties away from zero; 0 for any other text.

    For a value whose integer part is outside int32 the result is some number outside int32.
    """
    found = _DECIMAL.fullmatch(text)
    if found is None:
        return 0
    # Any number of digits is allowed, which int() does not accept. A tie between two numbers has q + 1 decimals, so
    # further decimals cannot move a value across it; 10^10 is outside int32 in every format.
    sign, whole, fraction = found[1], found[2].lstrip("0"), (found[3] or "")[: q + 1]
    if len(whole) > _WHOLE_DIGITS_MAX:
        whole = "1" + "0" * _WHOLE_DIGITS_MAX
    unit: int = 10 ** len(fraction)
    size = ((int(whole + fraction or "0") << (q + 1)) + unit) // (2 * unit)
    return -size if sign else size


def portable_number(text: str, q: int) -> tuple[int, bool]:
    """Low 32 bits of the portable ``_atoIQ`` of a text, and whether it has saturated."""
    negative = text.startswith("-")
    digits = text[1:] if negative else text
    before, point, after = digits.partition(".")
    whole = 0
    for digit in before:
        if digit not in "0123456789":
            return 0, False
        whole = whole * 10 + int(digit)
        if whole > INT32_MAX >> q:
            return (INT32_MIN if negative else INT32_MAX), True
    if not point:
        return whole << q, False
    tenths = 0
    # Read backwards from the end to the last point.
    for digit in reversed(after.rpartition(".")[2]):
        if digit not in "0123456789":
            return 0, False
        tenths = (((tenths * _TENTH) >> 31) + int(digit) * _TENTH) & _MASK
    size = (whole << q) + (((tenths + (1 << (30 - q))) & _MASK) >> (31 - q))
    return (-size if negative else size), False


def _widths(form: str) -> tuple[int, int] | None:
    found = _FORM.fullmatch(form)
    if found is None or int(found[1]) > _WIDTH_MAX:
        return None
    return int(found[1]), int(found[2] or "0")


def _digits(size: int, q: int, count: int) -> str:
    """``count`` decimals of the fraction of size / 2^q, truncated."""
    fraction = size & ((1 << q) - 1)
    return f"{(fraction * 10**count) >> q:0{count}d}" if count else ""


def portable_decimal(form: str, a: int, q: int) -> tuple[int, str | None]:
    """``_IQtoa`` of the portable library: integer part padded with zeros to its width."""
    widths = _widths(form)
    if widths is None:
        return ILLEGAL_FORM, None
    size = abs(a)
    whole = f"{size >> q:0{widths[0]}d}" if widths[0] or size >> q else ""
    if len(whole) > widths[0]:
        return TOO_NARROW, None
    decimals = _digits(size, q, widths[1])
    return 0, f"{'-' if a < 0 else ''}{whole}{'.' if decimals else ''}{decimals}"


def c28_decimal(form: str, a: int, q: int) -> tuple[int, str | None]:
    """``_IQtoa`` of the C28x as we interpret its guide: no leading zeros, the second width includes the point."""
    widths = _widths(form)
    if widths is None:
        return ILLEGAL_FORM, None
    whole = str(abs(a) >> q)
    if a == INT32_MIN or len(whole) > widths[0]:
        return TOO_NARROW, None
    decimals = _digits(abs(a), q, max(widths[1] - 1, 0))
    return 0, f"{'-' if a < 0 else ''}{whole}{'.' if decimals else ''}{decimals}"
