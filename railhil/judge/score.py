"""The score of a run: what each system makes of scenario and record (:attr:`railhil.judge.judging.Judging.score`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from railhil.common.digits import rounded
from railhil.judge.criteria import Criterion
from railhil.judge.stops import ScoredStop

if TYPE_CHECKING:
    from railhil.judge.requirements.outcome import Outcome


@dataclass(frozen=True, slots=True)
class Score:
    """Scores of one run by the keys of its criteria; ``None`` if the run ended before (a train that did not stop has no
    stop error).

    ``signed``: the scores that have a sign; positive ``time_error_s`` is late, positive ``stop_error_m`` is past the
    stopping point. ``extras``: the system's own figures by the keys of :attr:`Judging.extras`. ``stops``: the stops
    that the scenario requires, in its order, with their results; empty for a record that does not show a complete run.
    ``requirements``: what the record makes of the sentences that it is judged by.
    """

    verdict: str
    values: Mapping[str, float | None]
    signed: Mapping[str, float | None]
    failures: tuple[str, ...]
    ended: str
    extras: Mapping[str, float] = field(default_factory=dict)
    stops: tuple[ScoredStop, ...] = ()
    requirements: tuple[Outcome, ...] = ()

    @property
    def listed_stops(self) -> tuple[ScoredStop, ...]:
        """The stops of a run with several; a single stop is fully covered by the criteria."""
        return self.stops if len(self.stops) > 1 else ()

    def with_sign(self, criterion: Criterion) -> float | None:
        """Value of a criterion, with its sign if it has one."""
        return self.values[criterion.key] if criterion.signed is None else self.signed[criterion.signed]

    def in_words(self, criteria: Sequence[Criterion]) -> str:
        """The values of some criteria with their units; empty if there are none."""
        found = []
        for criterion in criteria:
            if (value := self.with_sign(criterion)) is not None:
                sign = "+" if criterion.signed else ""
                found.append(f"{criterion.title} {value:{sign}.{criterion.digits}f} {criterion.unit}")
        return ", ".join(found)

    def __repr__(self) -> str:
        """Rounded: a table or an error message shows it."""
        values = {**self.values, **self.signed, **self.extras}
        return f"Score({', '.join((self.verdict, rounded(values), self.ended, *self.failures))})"

    def as_json(self) -> dict[str, object]:
        """The part of ``score.json`` that comes from the log alone."""
        return {
            "verdict": self.verdict,
            "scores": dict(self.values),
            "signed": dict(self.signed),
            **self.extras,
            "failures": list(self.failures),
            "ended": self.ended,
            "stops": [stop.as_json() for stop in self.stops],
            **({"requirements": [one.as_json() for one in self.requirements]} if self.requirements else {}),
        }
