"""Predictions of a linear model and the gains of generalized predictive control, in closed form (004 eqs. 22 to 30).

Pure and straight-line, for any arithmetic without formats: identified models use them in each period.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.vector.reals import Reals


class Predictions(NamedTuple, Generic[T]):
    """Solution of 1 = E_j A + q^j F_j and E_j B = G_j + q^j H_j for j = 1..N (004 eq. 22).

    v(k+j) = G_j u(k+j-1) + F_j v(k) + H_j u(k-1) + E_j xi(k+j-1). ``e``: e_0..e_{N-1}, of which E_j has the first j;
    ``g``: g_0..g_{N-1}, likewise; ``f`` (N rows of as many as A has) and ``h`` (N rows of one fewer than B has);
    ``e_sum``, ``g_sum``: E_j(1) and s_j = G_j(1).
    """

    e: tuple[T, ...]
    g: tuple[T, ...]
    f: tuple[tuple[T, ...], ...]
    h: tuple[tuple[T, ...], ...]
    e_sum: tuple[T, ...]
    g_sum: tuple[T, ...]


def predictions(re: Reals[T], a: Sequence[T], b: Sequence[T], horizon: int) -> Predictions[T]:
    """The Diophantine equations, solved by recursion on the rows of F: e_j is the first coefficient of F_j.

    :param a: a1, a2, ... without the leading one; ``b``: b0, b1, ...
    """
    row = tuple(re.neg(x) for x in a)
    e, f = [re.one], [row]
    for _ in range(1, horizon):
        first = row[0]
        e.append(first)
        shifted = (*row[1:], re.zero)
        row = tuple(re.sub(old, re.mul(first, x)) for old, x in zip(shifted[:-1], a[:-1], strict=True))
        row = (*row, re.neg(re.mul(first, a[-1])))
        f.append(row)
    g = [_coefficient(re, e, b, i, i + 1) for i in range(horizon)]
    h = [tuple(_coefficient(re, e, b, j + m, j) for m in range(len(b) - 1)) for j in range(1, horizon + 1)]
    return Predictions(tuple(e), tuple(g), tuple(f), tuple(h), _running(re, e), _running(re, g))


def _coefficient(re: Reals[T], e: Sequence[T], b: Sequence[T], power: int, count: int) -> T:
    """Coefficient of q^power in (e_0 + ... + e_{count-1} q^{count-1}) * B."""
    pairs = [(i, power - i) for i in range(count) if 0 <= power - i < len(b)]
    terms = [b[m] if i == 0 else re.mul(e[i], b[m]) for i, m in pairs]
    return re.add(*terms) if terms else re.zero


def _running(re: Reals[T], values: Sequence[T]) -> tuple[T, ...]:
    sums = [values[0]]
    for value in values[1:]:
        sums.append(re.add(sums[-1], value))
    return tuple(sums)


def first_row(re: Reals[T], g: Sequence[T], control_horizon: int, weight: T, held: bool = False) -> tuple[T, ...]:
    """p_1..p_N: first row of (G'G + lambda I)^-1 G' (004 eq. 26), solved in closed form for one or two commands.

    :param held: D7: the last command is held after the control horizon; False: zero command (coasting), as printed.
    :raises ValueError: a control horizon other than 1 or 2.
    """
    if control_horizon not in (1, 2):
        raise ValueError(f"control horizon {control_horizon}, allowed 1 or 2")
    sums = _running(re, g)
    if control_horizon == 1:
        column = sums if held else tuple(g)
        scale = re.add(re.dot(column, column), weight)
        return tuple(re.div(x, scale) for x in column)
    first = tuple(g)
    later = sums if held else first
    second = (re.zero, *later[:-1])
    w11 = re.add(re.dot(first, first), weight)
    w12 = re.dot(first, second)
    w22 = re.add(re.dot(second, second), weight)
    determinant = re.sub(re.mul(w11, w22), re.mul(w12, w12))
    on_first, on_second = re.div(w22, determinant), re.div(w12, determinant)
    return tuple(re.sub(re.mul(on_first, x), re.mul(on_second, y)) for x, y in zip(first, second, strict=True))


class Weights(NamedTuple, Generic[T]):
    """Weights of the law u(k) = sum p_j r w(k+j) - F_p v(k) - H_p u(k-1) - M_p xi(k-1) (004 eqs. 26 and 27).

    ``w``: p_1 r..p_N r; ``f``: F_p; ``h``: H_p without its leading one; ``xi``: M_p; ``ramp``: weight of the
    reference's acceleration, 1 - sum p_j s_j, which removes the ramp error that a penalty on u^2 leaves.
    """

    w: tuple[T, ...]
    f: tuple[T, ...]
    h: tuple[T, ...]
    xi: T
    ramp: T


def weights(
    re: Reals[T], found: Predictions[T], p: Sequence[T], a_sum: T, b_sum: T, *, exact: bool = True
) -> Weights[T]:
    """The law's weights with the weighting polynomials of D6.

    ``exact``: kappa = (1 - sum p_j s_j) / B(1), M_p = sum p_j E_j(1) + kappa, r = 1 + A(1) kappa / sum p_j: both
    conditions of eq. (30) hold exactly. False: M_j = E_j(1), r = 1, with which they fail for lambda > 0.

    :param a_sum: A(1); ``b_sum``: B(1), not 0.
    """
    ramp = re.sub(re.one, re.dot(p, found.g_sum))
    xi = re.dot(p, found.e_sum)
    share = tuple(p)
    if exact:
        kappa = re.div(ramp, b_sum)
        xi = re.add(xi, kappa)
        ratio = re.add(re.one, re.div(re.mul(a_sum, kappa), re.add(*p)))
        share = tuple(re.mul(x, ratio) for x in p)
    f = tuple(re.dot(p, column) for column in zip(*found.f, strict=True))
    h = tuple(re.dot(p, column) for column in zip(*found.h, strict=True))
    return Weights(share, f, h, xi, ramp)
