"""Orders of a law in double precision (:mod:`railhil.controller_node.arithmetic.float64`), as machine code.

Every sum and product is that of the law on one train, in the same order; a curve is computed by the interpreter between
two calls.
"""

from __future__ import annotations

from math import floor, inf
from typing import Any

from railhil.batch import compiled, lanes, orders
from railhil.batch.lanes import LANES
from railhil.batch.orders import (
    ABS,
    ADD,
    AT,
    CLIP,
    COPY,
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
    SUB,
    WHERE,
)


@compiled.side_by_side
def _simple(kind: int, s: Any, to: int, a: int, b: int) -> None:
    result, first, second = s[to : to + LANES], s[a : a + LANES], s[b : b + LANES]
    if kind == ADD:
        for i in range(LANES):
            result[i] = first[i] + second[i]
    elif kind == SUB:
        for i in range(LANES):
            result[i] = first[i] - second[i]
    elif kind in (PRODUCT, PRODUCT_SATURATED):
        for i in range(LANES):
            result[i] = first[i] * second[i]
    elif kind == NEG:
        for i in range(LANES):
            result[i] = -first[i]
    elif kind == ABS:
        for i in range(LANES):
            result[i] = abs(first[i])
    elif kind == COPY:
        for i in range(LANES):
            result[i] = first[i]
    elif kind == DIV:
        for i in range(LANES):
            quotient = first[i] / second[i]
            infinite = -inf if first[i] < 0.0 else inf
            result[i] = infinite if second[i] == 0.0 else quotient


@compiled.side_by_side
def _chosen(kind: int, s: Any, to: int, a: int, b: int, c: int) -> None:
    """As Python's ``min`` and ``max``: of two equal numbers the first."""
    result, first, second, third = s[to : to + LANES], s[a : a + LANES], s[b : b + LANES], s[c : c + LANES]
    if kind in (SAT, CLIP):
        for i in range(LANES):
            number = first[i]
            number = third[i] if third[i] > number else number
            result[i] = second[i] if second[i] < number else number
    elif kind == MINIMUM:
        for i in range(LANES):
            result[i] = second[i] if second[i] < first[i] else first[i]
    elif kind == MAXIMUM:
        for i in range(LANES):
            result[i] = second[i] if second[i] > first[i] else first[i]
    elif kind == GT:
        for i in range(LANES):
            result[i] = 1.0 if first[i] > second[i] else 0.0
    elif kind == WHERE:
        for i in range(LANES):
            result[i] = second[i] if first[i] != 0.0 else third[i]


@compiled.side_by_side
def _dot(s: Any, to: int, terms: Any, loose: Any, term: int, count: int) -> None:
    result = s[to : to + LANES]
    for i in range(LANES):
        result[i] = 0.0
    for place in range(term, term + count):
        value = s[terms[place, 2] : terms[place, 2] + LANES]
        if terms[place, 0] == 0:
            coefficient = loose[terms[place, 1]]
            for i in range(LANES):
                result[i] += coefficient * value[i]
        else:
            weight = s[terms[place, 1] : terms[place, 1] + LANES]
            for i in range(LANES):
                result[i] += weight[i] * value[i]


@compiled.aside
def _seldom(kind: int, s: Any, to: int, a: int, pool: Any, p: int, q: int) -> None:
    """Tables and rounding; an index is a whole number here too."""
    if kind == AT:
        for i in range(LANES):
            s[to + i] = pool[p + int(s[a + i]) + q]
    elif kind == INDEX:
        for i in range(LANES):
            s[to + i] = min(max(s[a + i], 0.0), float(p))
    elif kind == LOCATE:
        for i in range(LANES):
            low, high = 0, q
            while low < high:
                middle = (low + high) // 2
                if pool[p + middle] <= s[a + i]:
                    low = middle + 1
                else:
                    high = middle
            s[to + i] = min(max(low - 1, 0), q - 2)
    elif kind == QUANTISE:
        for i in range(LANES):
            number = s[a + i]
            if -inf < number < inf:
                number = floor(number * 2.0**p + 0.5) / 2.0**p
            s[to + i] = number


@compiled.cached(*(str(module.__file__) for module in (orders, lanes)), __file__)
def run_floats(given: Any, wire: Any, code: Any, terms: Any, loose: Any, pool: Any, scratch: Any) -> None:
    """Carry out the orders for all blocks.

    :param given: rows of the wire values, times LANES; ``wire``: their values, shape (values, blocks * LANES).
    :param scratch: rows of all blocks, shape (blocks, rows * LANES).
    """
    for block in range(scratch.shape[0]):
        s, first = scratch[block], block * LANES
        for number in range(given.size):
            for i in range(LANES):
                s[given[number] + i] = wire[number, first + i]
        for place in range(code.shape[0]):
            kind, to, a, b, c = code[place, 0], code[place, 1], code[place, 2], code[place, 3], code[place, 4]
            if kind == DOT:
                _dot(s, to, terms, loose, code[place, 7], a)
            elif kind in (AT, INDEX, LOCATE, QUANTISE):
                _seldom(kind, s, to, a, pool, code[place, 5], code[place, 6])
            elif kind in (SAT, CLIP, MINIMUM, MAXIMUM, GT, WHERE):
                _chosen(kind, s, to, a, b, c)
            else:
                _simple(kind, s, to, a, b)
