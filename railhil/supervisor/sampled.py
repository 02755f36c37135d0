"""The last known values of signals at given instants."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from railhil.supervisor.trace import FloatArray, Trace


class Sampler:
    """Many signals come from one port: the telegrams that were the newest are searched once.

    :param time_s: the instants in s, shape (n,).
    """

    def __init__(self, trace: Trace, time_s: FloatArray) -> None:
        self._trace = trace
        self._time_s = time_s
        #: Place of the newest telegram at each instant, and whether there was one at all of them.
        self._places: dict[str, tuple[npt.NDArray[np.int64], bool]] = {}

    def of(self, port: str, values: FloatArray) -> FloatArray:
        """The last known one of the values of a port's telegrams at each instant, NaN before the first; shape (n,)."""
        known = self._places.get(port)
        if known is None:
            places = self._trace.times_s(port).searchsorted(self._time_s, "right") - 1
            known = self._places[port] = places, bool((places >= 0).all())
        places, always = known
        # -1 is the NaN at the end.
        return values[places] if always else np.append(values, np.nan)[places]

    def signal(self, port: str, signal: str) -> FloatArray:
        """As :meth:`of`, of a signal in its unit."""
        return self.of(port, self._trace.values(port, signal))
