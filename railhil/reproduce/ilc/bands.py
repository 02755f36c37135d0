"""Bands of railhil's specification (section 8, and the bars of ours) and whether the measured figures keep them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from railhil.controller_node.laws.stopping.taps import taps
from railhil.reproduce.ilc import names
from railhil.reproduce.ilc.faults import DETECTED, RECOVERED, SEEN, value_name
from railhil.reproduce.ilc.names import (
    CONVERGED,
    LAST_RMS_HELD,
    MEAN,
    PAPER_CASE,
    RMS,
    WITHIN_30,
    of_last,
    of_run,
)
from railhil.reproduce.paper import Results

#: A figure of the results; None: it was not measured.
_Figure = Callable[[Results], float | None]


@dataclass(frozen=True, slots=True)
class Band:
    """Least and greatest allowed value of a figure; None: there is none.

    ``at``: item of the list; ``what``: the figure; ``needs``: entries of the protocol.
    """

    at: str
    what: str
    unit: str
    digits: int
    least: float | None
    most: float | None
    needs: tuple[str, ...]
    value: _Figure

    @property
    def text(self) -> str:
        """The band in words."""
        if self.least is None:
            return f"at most {self.most:g}"
        return f"at least {self.least:g}" if self.most is None else f"{self.least:g} to {self.most:g}"

    def is_measured(self, results: Results) -> bool:
        """Whether the entries were made."""
        return all(key in results.runs for key in self.needs)

    def holds(self, results: Results) -> bool:
        """Whether the figure is in the band; no value is not."""
        found = self.value(results)
        if found is None:
            return False
        return (self.least is None or found >= self.least) and (self.most is None or found <= self.most)

    def verdict(self, results: Results) -> str:
        """In words, also the side on which a figure is outside."""
        if not self.is_measured(results):
            return "not made"
        if self.holds(results):
            return "holds"
        found = self.value(results)
        if found is None:
            return "does not hold: no value"
        return f"does not hold: {'below' if self.least is not None and found < self.least else 'above'}"


def _noise(results: Results) -> float:
    """Share of the power of white noise that the packet lets pass, from the weights that the law has."""
    return sum(weight * weight for weight in taps("packet_symmetric_63"))


def _of(key: str, name: str) -> _Figure:
    return lambda results: results.value(key, name)


def _percent(key: str, name: str) -> _Figure:
    def found(results: Results) -> float | None:
        value = results.value(key, name)
        return None if value is None else 100 * value

    return found


def _ratio(key: str, name: str, other: str, by: str) -> _Figure:
    def found(results: Results) -> float | None:
        value, divisor = results.value(key, name), results.value(other, by)
        return None if value is None or not divisor else value / divisor

    return found


def _memory(figure: str, join: Callable[[list[float]], float]) -> _Figure:
    def found(results: Results) -> float | None:
        values = [results.value(names.MEMORY, value_name(fault, figure)) for fault in DETECTED]
        known = [value for value in values if value is not None]
        return join(known) if len(known) == len(values) else None

    return found


def _acceptance() -> Iterator[Band]:
    none, rms, mean = names.filter_key(names.NONE), of_last(RMS), of_last(MEAN)
    fast, wild, percent = names.gamma_key(1.5), names.gamma_key(2.0), names.scatter_key(0.01)
    ours = names.OURS_FIXED
    yield Band("1", "packet, noise power", "", 4, 0.12, 0.13, (), _noise)
    yield Band("3", "packet, mean error", "m", 3, 0.10, 0.15, (PAPER_CASE,), _of(PAPER_CASE, mean))
    within = _percent(PAPER_CASE, of_last(WITHIN_30))
    yield Band("3", "packet, within 0.3 m", "%", 1, 90.0, None, (PAPER_CASE,), within)
    yield Band("3", "packet, runs, median", "", 0, 4.0, 6.0, (PAPER_CASE,), _of(PAPER_CASE, CONVERGED))
    yield Band("3", "no filter, mean error", "m", 3, 0.18, 0.26, (none,), _of(none, mean))
    gain = _ratio(none, mean, PAPER_CASE, mean)
    yield Band("3", "mean error without filter by that with it", "", 2, 1.4, None, (none, PAPER_CASE), gain)
    slower = _ratio(fast, rms, PAPER_CASE, rms)
    yield Band("4", "rms with gamma 1.5 by that with 0.5", "", 2, 1.6, 2.2, (fast, PAPER_CASE), slower)
    # The clamps keep it from growing without bound.
    never = _percent(wild, of_last(WITHIN_30))
    yield Band("4", "gamma 2 must not converge: within 0.3 m", "%", 1, None, 1.0, (wild,), never)
    yield Band("5", "gain 1 % from run to run, mean error", "m", 2, 1.5, 2.0, (percent,), _of(percent, mean))
    yield Band("6", "re-aim, observer, balises: rms", "m", 3, None, 0.08, (ours,), _of(ours, names.of_all(RMS)))
    seen = _memory(SEEN, lambda values: 100 * min(values))
    yield Band("7", "memory faults that are seen", "%", 0, 100.0, None, (names.MEMORY,), seen)
    most = _memory(RECOVERED, max)
    yield Band("7", "runs until recovered, median, slowest fault", "", 0, None, 5.0, (names.MEMORY,), most)


def _bars() -> Iterator[Band]:
    rms, ours = of_last(RMS), names.OURS
    yield Band("run 1", "observer, balises: rms", "m", 4, None, 0.05, (ours,), _of(ours, of_run(RMS, 1)))
    yield Band("learned", "observer, balises: rms", "m", 4, None, 0.026, (ours,), _of(ours, rms))
    bare, loss, slide = names.NO_BALISES, names.LOSS, names.SLIDE
    yield Band("learned", "without balises: rms", "m", 4, None, 0.066, (bare,), _of(bare, rms))
    yield Band("learned", "15 % loss below 2 m/s: rms", "m", 4, None, 0.035, (loss,), _of(loss, rms))
    poisoned = _ratio(slide, LAST_RMS_HELD, ours, rms)
    title = "10 % slide runs: rms of the others by that without slides"
    yield Band("learned", title, "", 2, None, 1.2, (slide, ours), poisoned)


ACCEPTANCE, BARS = tuple(_acceptance()), tuple(_bars())
