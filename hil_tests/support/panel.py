"""A short run for the tests of the panel, and a link that hands over its frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.live.bus_follower import Listener
from railhil.panel.bus_statistics import BusStatistics
from railhil.panel.layout import Rows, make_layout
from railhil.record.framelog import read_log
from railhil.scenarios.load import load
from railhil.scenarios.system import system_named


class Recorded:
    """A run of 2 m."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "short.toml"
        self.path.write_text(RUN_2M_TOML, encoding="utf-8")
        self.scenario = load(str(self.path))
        self.trace = local_run(self.scenario, folder).trace
        self.frames = [frame for _, frame in read_log(folder / "frames.log")]
        system = system_named(self.scenario.system)
        self.contract = system.contract
        self.layout = make_layout(self.scenario, system.contract, None)
        self.rows = Rows(self.scenario, self.layout).make(self.trace)

    def heard(self, frames: list[Frame], look: int) -> np.ndarray:
        """Rows of a listener that takes so many frames at a time."""
        heard = BusStatistics(self.contract)
        listener, last_s, found = Listener(self.scenario, self.contract, heard), -1.0, []
        made = Rows(self.scenario, self.layout)
        for start in range(0, len(frames), look):
            listener.take(frames[start : start + look])
            trace = heard.next_trace()
            rows = made.make(trace, last_s, listener.now_s) if listener.knows_time else made.make(trace)[:0]
            if len(rows):
                last_s = rows[-1, 0]
                found.append(rows)
        return np.concatenate(found)


class ScriptedLink:
    """A link that hands over lists of frames, and then is lost."""

    def __init__(self, *arrivals: list[Frame]) -> None:
        self.arrivals = list(arrivals)
        self.counters = {"rx_lost": 0}
        self.bus = None
        self.closed = False

    def receive(self, timeout_s: float) -> list[Frame]:
        assert timeout_s == 0.0
        if not self.arrivals:
            raise BusLost("gone")
        return self.arrivals.pop(0)

    def close(self) -> None:
        self.closed = True
