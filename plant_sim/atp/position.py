"""Position of the front as an interval, from balises and the protection's own odometer.

After a balise at ``b``, with the odometer ``s`` since, accuracy ``q`` and over- and under-reading ``o``, ``u``::

    d_est = b + s        d_max = b + s / (1 - u) + q        d_min = b + s / (1 + o) - q

Without a balise the interval grows. A balise that is not within the interval is ignored and counted.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable


class PositionInterval:
    """Interval of the front's position.

    :ivar estimated_m: by the last accepted balise and the odometer since.
    :ivar least_m: the front is at least here.
    :ivar most_m: and at most here.
    :ivar ignored: balises that were not within the interval of any surveyed one, in all.
    :ivar ignored_in_a_row: of them, those since the last accepted one.
    """

    __slots__ = (
        "_accuracy_m", "_from_m", "_from_odometer_m", "_least_share", "_most_share", "_own_accuracy_m", "_surveyed",
        "estimated_m", "ignored", "ignored_in_a_row", "least_m", "most_m",
    )  # fmt: skip

    def __init__(self, over_reading: float, under_reading: float, accuracy_m: float) -> None:
        self._least_share, self._most_share = 1.0 / (1.0 + over_reading), 1.0 / (1.0 - under_reading)
        self._own_accuracy_m = accuracy_m
        self._surveyed: dict[int, list[float]] = {}
        self.ignored = self.ignored_in_a_row = 0
        self.refer(0.0, 0.0, accuracy_m)

    def survey(self, balises: Iterable[tuple[int, float]]) -> None:
        """Take the balises ``(number, surveyed_m)`` of a track; a number may stand at several places."""
        surveyed: defaultdict[int, list[float]] = defaultdict(list)
        for number, at_m in balises:
            surveyed[number].append(at_m)
        self._surveyed = dict(surveyed)

    def refer(self, position_m: float, odometer_m: float, accuracy_m: float) -> None:
        """Count from a known position on; ``accuracy_m`` is at least that of a balise."""
        self._from_m, self._from_odometer_m = position_m, odometer_m
        self._accuracy_m = max(accuracy_m, self._own_accuracy_m)
        self.update(odometer_m)

    def update(self, odometer_m: float) -> None:
        """Find the interval at a count of the odometer."""
        since_m = odometer_m - self._from_odometer_m
        self.estimated_m = self._from_m + since_m
        self.least_m = self._from_m + since_m * self._least_share - self._accuracy_m
        self.most_m = self._from_m + since_m * self._most_share + self._accuracy_m

    def read(self, number: int, odometer_m: float) -> bool:
        """A balise that the front has passed at a count of the odometer; False: it is ignored."""
        self.update(odometer_m)
        for at_m in self._surveyed.get(number, ()):
            if self.least_m - self._own_accuracy_m <= at_m <= self.most_m + self._own_accuracy_m:
                self.ignored_in_a_row = 0
                self.refer(at_m, odometer_m, self._own_accuracy_m)
                return True
        self.ignored += 1
        self.ignored_in_a_row += 1
        return False
