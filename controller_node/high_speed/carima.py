"""GPC on an integrated model, A(q) D v(k) = B(q) D u(k-1) + e(k) with D = 1 - q: the comparators of 004.

The papers give neither their models nor their parameters (D10). Integral action replaces the estimate of xi. N = 3 and
Nu = 2 as for the other GPC laws; the cost is on the increments of the command.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.law import LawParameters, Sample
from railhil.controller_node.high_speed.predictor import first_row, predictions
from railhil.controller_node.high_speed.stability import Train, feedback_radius
from railhil.controller_node.vector.reals import Reals


@dataclass(frozen=True)
class CarimaParameters(LawParameters):
    """Parameters of GPC on an integrated model."""

    #: N and Nu, as for the other laws.
    horizon: Annotated[int, Field(ge=1, le=16)] = 3
    control_horizon: Literal[1, 2] = 2
    #: lambda, on the increments of the command.
    control_weight: Annotated[float, Field(ge=0, le=1000)] = 0.3


class Increments(NamedTuple, Generic[T]):
    """Weights of D u(k) = sum p_j (w(k+j) - v(k)) - F (v(k-1..k-3) - v(k)) - H D u(k-1), D u(k-2)."""

    p: tuple[T, ...]
    f: tuple[T, ...]
    h: tuple[T, ...]


def radius(law: Increments[float], train: Train, period_s: float) -> float:
    """Spectral radius of the closed loop."""
    h1, h2 = law.h
    on_speeds = (math.fsum(law.f) - math.fsum(law.p), *(-x for x in law.f))
    return feedback_radius(train, period_s, on_speeds, (1.0 - h1, h1 - h2, h2))


class Track(NamedTuple, Generic[T]):
    """``speeds``: v(k-1), v(k-2), v(k-3), v(k-4), m/s. ``commands``: u(k-1), ..., u(k-4), m/s^2."""

    speeds: tuple[T, ...]
    commands: tuple[T, ...]


def start_track(re: Reals[T], sample: Sample[T]) -> Track[T]:
    """A train that has run at its speed without a command."""
    return Track((sample.speed,) * 4, (re.zero,) * 4)


def falls(re: Reals[T], values: Sequence[T]) -> tuple[T, ...]:
    """Differences of neighbours, newest first: x(k-1) - x(k-2), ..."""
    return tuple(re.sub(new, old) for new, old in pairwise(values))


def increments(
    re: Reals[T], a: Sequence[T], b: Sequence[T], horizon: int, control_horizon: int, weight: T
) -> Increments[T]:
    """The law's weights for a model, from the Diophantine equations with A D in place of A.

    :param a: a1, a2, a3; ``b``: b0, b1, b2.
    """
    first = re.sub(a[0], re.one)
    middle = [re.sub(new, old) for new, old in zip(a[1:], a[:-1], strict=True)]
    found = predictions(re, (first, *middle, re.neg(a[-1])), b, horizon)
    p = first_row(re, found.g, control_horizon, weight)
    f = tuple(re.dot(p, column) for column in zip(*found.f, strict=True))
    h = tuple(re.dot(p, column) for column in zip(*found.h, strict=True))
    return Increments(p, f[1:], h)


def one_step_error(re: Reals[T], alpha: Sequence[T], b: Sequence[T], speed: T, track: Track[T]) -> T:
    """e(k) of the integrated model with A = (1 - q)(1 + alpha1 q + alpha2 q^2), m/s."""
    moves = falls(re, (speed, *track.speeds))
    changes = falls(re, moves)
    explained = re.dot(b, falls(re, track.commands))
    return re.sub(re.add(changes[0], re.dot(alpha, changes[1:3])), explained)


def command_of(re: Reals[T], found: Increments[T], sample: Sample[T], track: Track[T]) -> T:
    """u(k), limited."""
    now = sample.speed
    ahead = [re.sub(w, now) for w in sample.reference[1 : len(found.p) + 1]]
    behind = [re.sub(v, now) for v in track.speeds[:3]]
    change = re.sub(re.dot(found.p, ahead), re.dot(found.f, behind))
    change = re.sub(change, re.dot(found.h, falls(re, track.commands[: len(found.h) + 1])))
    return re.clip(re.add(track.commands[0], change), sample.lowest, sample.highest)


def tracked(track: Track[T], speed: T, command: T) -> Track[T]:
    """The regressors of the next sample."""
    return Track((speed, *track.speeds[:-1]), (command, *track.commands[:-1]))


def resent(track: Track[Any], command: Any) -> Track[Any]:
    """The regressors if another command than the law's was sent."""
    return track._replace(commands=(command, *track.commands[1:]))
