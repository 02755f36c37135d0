"""Orders of a law in the fixed point of the C28x (:mod:`railhil.controller_node.arithmetic.iq`), as machine code.

A result is computed in 64 bits for all lanes of a block; whether one of them has left int32, or a limit was met, is
looked at once for the whole block, and only then counted train by train.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from railhil.batch import compiled, lanes, orders
from railhil.batch.lanes import LANES
from railhil.batch.orders import (
    ABS,
    ADD,
    AT,
    CLIP,
    COPY,
    CURVE,
    DIV,
    DOT,
    GT,
    INDEX,
    LOCATE,
    MAXIMUM,
    MINIMUM,
    NEG,
    PRODUCT,
    PRODUCT_SATURATED,
    QUANTISE,
    SAT,
    SHIFT_LEFT,
    SHIFT_RIGHT,
    SUB,
    WHERE,
)

_MIN, _MAX, _SIGN, _MASK, _HIGH = -(2**31), 2**31 - 1, 2**31, 2**32 - 1, -(2**32)
#: Rows of the counts.
WRAPS, SATURATIONS, ZERO_DIVISIONS = range(3)


@compiled.aside
def _wrap(s: Any, to: int, counts: Any, first: int) -> None:
    """Low 32 bits of a row; every train whose number changes has wrapped."""
    for i in range(LANES):
        exact = s[to + i]
        if not _MIN <= exact <= _MAX:
            s[to + i] = ((exact + _SIGN) & _MASK) - _SIGN
            counts[WRAPS, first + i] += 1


@compiled.aside
def _saturate(s: Any, to: int, counts: Any, first: int) -> None:
    for i in range(LANES):
        exact = s[to + i]
        if not _MIN <= exact <= _MAX:
            s[to + i] = _MAX if exact > 0 else _MIN
            counts[SATURATIONS, first + i] += 1


@compiled.aside
def _divide(s: Any, to: int, a: int, b: int, q: int, counts: Any, first: int) -> None:
    """``C28.div``."""
    for i in range(LANES):
        numerator, denominator = s[a + i], s[b + i]
        if denominator == 0:
            s[to + i] = _MAX
            counts[ZERO_DIVISIONS, first + i] += 1
            continue
        if denominator < 0:
            numerator, denominator = -numerator, -denominator
        quotient = ((numerator << (q + 1)) + denominator) // (2 * denominator)
        if not _MIN <= quotient <= _MAX:
            quotient = _MAX if quotient > 0 else _MIN
            counts[SATURATIONS, first + i] += 1
        s[to + i] = quotient


@compiled.aside
def _locate(s: Any, to: int, a: int, pool: Any, at: int, count: int) -> None:
    for i in range(LANES):
        low, high = 0, count
        while low < high:
            middle = (low + high) // 2
            if pool[at + middle] <= s[a + i]:
                low = middle + 1
            else:
                high = middle
        s[to + i] = min(max(low - 1, 0), count - 2)


@compiled.side_by_side_part
def _product(a: Any, b: Any) -> Any:
    """Product of two numbers of int32, which is said because the processor has a fast one for them."""
    return np.int64(np.int32(a)) * np.int64(np.int32(b))


@compiled.side_by_side
def _dot(s: Any, to: int, terms: Any, loose: Any, term: int, count: int, q: int, half: int) -> int:
    """Sum of products; not 0 if one of the sums has left int32."""
    result = s[to : to + LANES]
    for i in range(LANES):
        result[i] = 0
    for place in range(term, term + count):
        value = s[terms[place, 2] : terms[place, 2] + LANES]
        if terms[place, 0] == 0:
            coefficient = loose[terms[place, 1]]
            for i in range(LANES):
                result[i] += (_product(coefficient, value[i]) + half) >> q
        else:
            weight = s[terms[place, 1] : terms[place, 1] + LANES]
            for i in range(LANES):
                result[i] += (_product(weight[i], value[i]) + half) >> q
    beyond = 0
    for i in range(LANES):
        beyond |= (result[i] + _SIGN) & _HIGH
    return beyond


@compiled.side_by_side
def _simple(kind: int, s: Any, to: int, a: int, b: int, q: int, half: int) -> int:
    """Sums, products, shifts; not 0 if one of the results has left int32."""
    result, first, second = s[to : to + LANES], s[a : a + LANES], s[b : b + LANES]
    beyond = 0
    if kind == ADD:
        for i in range(LANES):
            exact = first[i] + second[i]
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind == SUB:
        for i in range(LANES):
            exact = first[i] - second[i]
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind in (PRODUCT, PRODUCT_SATURATED):
        for i in range(LANES):
            exact = (_product(first[i], second[i]) + half) >> q
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind == SHIFT_LEFT:
        for i in range(LANES):
            exact = first[i] << q
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind == QUANTISE:
        for i in range(LANES):
            exact = (first[i] + (1 << (q - 1))) >> q
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind == NEG:
        for i in range(LANES):
            exact = -first[i]
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    elif kind == ABS:
        for i in range(LANES):
            exact = abs(first[i])
            result[i] = exact
            beyond |= (exact + _SIGN) & _HIGH
    return beyond


@compiled.side_by_side
def _chosen(kind: int, s: Any, to: int, a: int, b: int, c: int, q: int) -> int:
    """Choices between numbers; not 0 if a format limit was met."""
    result, first, second, third = s[to : to + LANES], s[a : a + LANES], s[b : b + LANES], s[c : c + LANES]
    changed = 0
    if kind in (SAT, CLIP):
        for i in range(LANES):
            number = first[i]
            limited = second[i] if second[i] < number else number
            limited = third[i] if third[i] > limited else limited
            result[i] = limited
            changed |= limited ^ number
    elif kind == MINIMUM:
        for i in range(LANES):
            result[i] = first[i] if first[i] < second[i] else second[i]
    elif kind == MAXIMUM:
        for i in range(LANES):
            result[i] = first[i] if first[i] > second[i] else second[i]
    elif kind == GT:
        for i in range(LANES):
            result[i] = 1 if first[i] > second[i] else 0
    elif kind == WHERE:
        for i in range(LANES):
            result[i] = second[i] if first[i] != 0 else third[i]
    elif kind == COPY:
        for i in range(LANES):
            result[i] = first[i]
    elif kind == SHIFT_RIGHT:
        for i in range(LANES):
            result[i] = first[i] >> q
    elif kind == INDEX:
        for i in range(LANES):
            number = first[i]
            number = 0 if number < 0 else number
            result[i] = q if number > q else number
    return changed if kind == SAT else 0


@compiled.aside
def _from_table(kind: int, s: Any, to: int, a: int, pool: Any, at: int, number: int) -> None:
    if kind == AT:
        for i in range(LANES):
            s[to + i] = pool[at + s[a + i] + number]
    elif kind == CURVE:
        for i in range(LANES):
            argument = s[a + i]
            cell = max(min(argument >> number, 255), -257)
            # A table is read from its end for a negative place, in Python as in numpy.
            left = pool[at + (cell if cell >= 0 else cell + 257)]
            right = pool[at + (cell + 1 if cell >= -1 else cell + 258)]
            s[to + i] = left + (((right - left) * (argument - (cell << number))) >> number)


@compiled.cached(*(str(module.__file__) for module in (orders, lanes)), __file__)
def run_ints(given: Any, wire: Any, code: Any, terms: Any, loose: Any, pool: Any, scratch: Any, counts: Any) -> None:
    """Carry out the orders for all blocks.

    :param given: rows of the wire values, times LANES; ``wire``: their values, shape (values, blocks * LANES).
    :param scratch: rows of all blocks, shape (blocks, rows * LANES); ``counts``: events, shape (3, blocks * LANES).
    """
    for block in range(scratch.shape[0]):
        s, first = scratch[block], block * LANES
        for number in range(given.size):
            for i in range(LANES):
                s[given[number] + i] = wire[number, first + i]
        for place in range(code.shape[0]):
            kind, to, a, b, c = code[place, 0], code[place, 1], code[place, 2], code[place, 3], code[place, 4]
            p, q = code[place, 5], code[place, 6]
            if kind == DOT:
                if _dot(s, to, terms, loose, code[place, 7], a, p, q) != 0:
                    _wrap(s, to, counts, first)
            elif kind == DIV:
                _divide(s, to, a, b, p, counts, first)
            elif kind == LOCATE:
                _locate(s, to, a, pool, p, q)
            elif kind in (AT, CURVE):
                _from_table(kind, s, to, a, pool, p, q)
            elif ADD <= kind <= PRODUCT_SATURATED or kind in (SHIFT_LEFT, QUANTISE):
                if _simple(kind, s, to, a, b, p, q) != 0:
                    if kind == PRODUCT_SATURATED:
                        _saturate(s, to, counts, first)
                    else:
                        _wrap(s, to, counts, first)
            elif _chosen(kind, s, to, a, b, c, p) != 0:
                for i in range(LANES):
                    if s[to + i] != s[a + i]:
                        counts[SATURATIONS, first + i] += 1
