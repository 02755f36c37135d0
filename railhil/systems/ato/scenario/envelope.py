"""Highest speed over distance under limits that change along the line.

The acceleration is constant on each piece, so the square of the speed is linear in position there: the pass with
traction (forwards) and the pass with brakes (backwards) are polylines of ``u = v^2`` over ``x``, and the fastest
run is the lower of the two.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

#: Largest acceleration in m/s2 for the arguments (low_mps, high_mps, from_m, to_m).
Rate = Callable[[float, float, float, float], float]

#: Speed step within which the acceleration is held constant; steps start at whole multiples of it.
BAND_MPS = 2.0
_TINY = 1e-9


@dataclass(frozen=True, slots=True)
class Zone:
    """A stretch of line with one speed limit for the train's front."""

    from_m: float
    to_m: float
    limit_mps: float


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a pass: the squared speed goes linearly from ``from_u`` to ``to_u`` (m2/s2)."""

    from_m: float
    to_m: float
    from_u: float
    to_u: float

    def u(self, position_m: float) -> float:
        share = (position_m - self.from_m) / (self.to_m - self.from_m)
        return self.from_u + share * (self.to_u - self.from_u)


class CurveError(ValueError):
    """No target speed curve meets the requirements; the message says which limit prevents it."""


def make_pass(zones: list[Zone], rate: Rate, first: Piece | None = None) -> list[Piece]:
    """Pass through all zones from standstill with the largest rate, held down to each zone's limit.

    ``first`` is a piece already laid at the beginning. Zones are contiguous and in increasing order.
    """
    pieces = [first] if first else []
    x = first.to_m if first else zones[0].from_m
    v = first.to_u**0.5 if first else 0.0
    for zone in zones:
        v = min(v, zone.limit_mps)
        while zone.to_m - x > _TINY:
            holds = zone.limit_mps - v <= _TINY
            piece = Piece(x, zone.to_m, v * v, v * v) if holds else _band(x, v, zone, rate)
            pieces.append(piece)
            x, v = piece.to_m, piece.to_u**0.5
    return pieces


def _band(x: float, v: float, zone: Zone, rate: Rate) -> Piece:
    """One speed step; the rate must hold over its whole length, which depends on the rate."""
    high = min((int((v + _TINY) / BAND_MPS) + 1) * BAND_MPS, zone.limit_mps)
    accel = rate(v, high, x, x)
    for _ in range(20):
        end = min(x + (high * high - v * v) / (2 * accel), zone.to_m)
        fits = rate(v, high, x, end)
        if fits >= accel:
            break
        accel = fits
    return Piece(x, end, v * v, v * v + 2 * accel * (end - x))


def mirror(pieces: list[Piece], at_m: float) -> list[Piece]:
    """A pass seen from the other end: position ``x`` becomes ``at_m - x``, order reversed."""
    return [Piece(at_m - p.to_m, at_m - p.from_m, p.to_u, p.from_u) for p in reversed(pieces)]


def mirror_zones(zones: list[Zone], at_m: float) -> list[Zone]:
    """Zones seen from the other end."""
    return [Zone(at_m - z.to_m, at_m - z.from_m, z.limit_mps) for z in reversed(zones)]


def select_lower(forward: list[Piece], backward: list[Piece]) -> list[Piece]:
    """The lower of two passes over the same stretch, cut where they cross, equal slopes joined."""
    edges = sorted({p.from_m for p in (*forward, *backward)} | {forward[-1].to_m})
    result: list[Piece] = []
    i = j = 0
    for left, right in pairwise(edges):
        if right - left <= _TINY:
            continue
        middle = (left + right) / 2
        while forward[i].to_m < middle:
            i += 1
        while backward[j].to_m < middle:
            j += 1
        result += _select_lower_of_two(left, right, forward[i], backward[j])
    return _join(result)


def _select_lower_of_two(left: float, right: float, one: Piece, two: Piece) -> list[Piece]:
    at_left, at_right = one.u(left) - two.u(left), one.u(right) - two.u(right)
    if at_left * at_right >= 0:
        low = one if at_left + at_right <= 0 else two
        return [Piece(left, right, low.u(left), low.u(right))]
    cross = left + (right - left) * at_left / (at_left - at_right)
    before, after = (one, two) if at_left < 0 else (two, one)
    u = before.u(cross)
    halves = [Piece(left, cross, before.u(left), u), Piece(cross, right, u, after.u(right))]
    return [half for half in halves if half.to_m - half.from_m > _TINY]


def _join(pieces: list[Piece]) -> list[Piece]:
    result = pieces[:1]
    for piece in pieces[1:]:
        last = result[-1]
        if abs(_slope(last) - _slope(piece)) < _TINY:
            result[-1] = Piece(last.from_m, piece.to_m, last.from_u, piece.to_u)
        else:
            result.append(piece)
    return result


def _slope(piece: Piece) -> float:
    return (piece.to_u - piece.from_u) / (piece.to_m - piece.from_m)


def speed_knots(pieces: list[Piece]) -> list[tuple[float, float]]:
    """Knots ``(time_s, speed_mps)`` of the run, speed linear in time between them, from time 0."""
    time_s = 0.0
    knots = [(0.0, max(pieces[0].from_u, 0.0) ** 0.5)]
    for piece in pieces:
        speed = max(piece.to_u, 0.0) ** 0.5
        total = speed + knots[-1][1]
        if total <= 0:
            raise CurveError("the train does not move: two stops touch")
        time_s += 2 * (piece.to_m - piece.from_m) / total
        knots.append((time_s, speed))
    return knots
