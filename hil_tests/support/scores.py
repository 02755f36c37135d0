"""Made-up scores, for code that only displays or compares them."""

from __future__ import annotations

from dataclasses import replace

from railhil.judge.criteria import limited, scores
from railhil.judge.score import Score
from railhil.systems.ato.judge.criteria import CRITERIA, OVERSPEED


def made_score(
    verdict: str,
    itae: float | None,
    energy_kj: float | None,
    time_error_s: float | None,
    stop_error_m: float | None,
    comfort: float | None,
    failures: tuple[str, ...] = (),
) -> Score:
    """A score with these figures, the errors with their signs."""
    measured = {
        "itae": itae,
        "energy_kj": energy_kj,
        "punctuality_s": time_error_s,
        "stop_error_m": stop_error_m,
        "comfort": comfort,
    }
    return Score(verdict, *scores(measured, CRITERIA), failures, "ended_complete", {OVERSPEED.key: 0.0})


def with_values(score: Score, **changes: float | None) -> Score:
    """The score with other values; a signed value is changed together with its signed form."""
    signed = {one.signed: changes[one.key] for one in limited(CRITERIA) if one.signed and one.key in changes}
    return replace(score, values={**score.values, **changes}, signed={**score.signed, **signed})
