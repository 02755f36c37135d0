"""A line seen by a train that returns on it: its other cab leads."""

from __future__ import annotations

from railhil.scenarios.profiles import Profile, merge_profiles
from railhil.systems.ato.scenario.model import Balise, Line


def mirror_line(line: Line, length_m: float, train_length_m: float) -> Line:
    """The line in the positions of the return direction, 0 where the front stands before it returns.

    The train stands at the last stop, ``length_m``, and changes its cab, not its place: the new front is at
    ``length_m - train_length_m``. So every place ``x`` of the line becomes ``length_m - train_length_m - x``, and a
    stop at ``s`` becomes a stop at ``length_m - s``. Grades change their signs. The first rows reach back to the rear
    of the standing train, ``-train_length_m``. Balises keep their numbers, in the order of the return direction.

    :param length_m: position of the last stop, m; rows that begin at it or behind it are not used.
    """
    front_m = length_m - train_length_m
    return Line(
        name=line.name,
        # 0 - x, because -x of a level grade is a negative zero.
        grade_permil=_mirror(tuple((at_m, 0.0 - permil) for at_m, permil in line.grade_permil), front_m, length_m),
        speed_limit_mps=_mirror(line.speed_limit_mps, front_m, length_m),
        balises=tuple(
            Balise(balise.number, front_m - balise.surveyed_m, front_m - balise.true_m)
            for balise in reversed(line.balises)
        ),
    )


def _mirror(profile: Profile, front_m: float, length_m: float) -> Profile:
    """The rows in reverse order: each begins where it ended, the first one at the end of the line."""
    used = [row for row in profile if row[0] < length_m] or [profile[0]]
    ends = [row[0] for row in used[1:]] + [length_m]
    rows = zip(used, ends, strict=True)
    return merge_profiles(tuple((front_m - end_m, value) for (_, value), end_m in rows)[::-1])
