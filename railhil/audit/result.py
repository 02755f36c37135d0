"""One audit from its options to its result, and the bars that the result is held against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from railhil.audit.bounds import Bounds, bounds_of
from railhil.audit.effect import Effect, effect
from railhil.audit.floor import floored
from railhil.audit.shadow import Codes, QuantityError, ShadowRun, Watched, compare_codes, errors, shadow_run
from railhil.audit.standstill import Standstill, standstill
from railhil.bench import coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.cost import Cost, cost_of
from railhil.controller_node.laws.constant_table import coarse
from railhil.controller_node.program.record import record
from railhil.controller_node.telemetry import QuantityTelemetry
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.supervisor.score import Score

#: Share of control periods in which the notch code must be float64's, and how far the others may be off (1/256 notch).
EQUAL_SHARE_MIN = 0.99
CODE_DIFFERENCE_MAX = 1


@dataclass(frozen=True, slots=True)
class Options:
    """What is audited, and how thoroughly: ``runs`` 0 leaves the perturbed runs out."""

    law: LawSpec = field(default_factory=LawSpec)
    seed: int = 0
    runs: int = 200


@dataclass(frozen=True, slots=True)
class Bar:
    """One demand: what was found, what is allowed, whether it is met."""

    name: str
    found: str
    allowed: str
    met: bool


@dataclass(frozen=True, slots=True)
class Floor:
    """The same run with floored products beside it, errors against float64, and its score when it drives."""

    errors: list[QuantityError]
    codes: Codes
    score: Score


@dataclass(frozen=True, slots=True)
class Result:
    """Everything that an audit found; ``bounds`` and ``floor`` are None for an arithmetic without formats,
    ``effect`` without perturbed runs."""

    scenario: Scenario
    options: Options
    ranges: Sequence[QuantityTelemetry]
    bounds: Bounds | None
    errors: list[QuantityError]
    codes: Codes
    floor: Floor | None
    score: Score
    reference_score: Score
    effect: Effect | None
    standstill: Standstill
    cost: Cost
    coarse_constants: tuple[Constant, ...]
    bars: list[Bar]

    @property
    def met(self) -> bool:
        """All demands are met."""
        return all(bar.met for bar in self.bars)


def audit(scenario: Scenario, options: Options) -> Result:
    """Audit a law in an arithmetic on a scenario.

    :raises scenarios.errors.InputError: an unknown law, arithmetic or indexing.
    """
    law = options.law

    def fresh() -> Arithmetic[Any]:
        return make(law.arithmetic)

    wide = fresh().wide
    formats = record(scenario, law)
    quantities = formats.quantities
    shadow = shadow_run(
        scenario,
        law,
        fresh(),
        quantities,
        others=() if wide else (floored(fresh()),),
        seed=options.seed,
    )

    def driven(arithmetic: Arithmetic[Any]) -> Score:
        loop = Watched(scenario, law, arithmetic, quantities)
        return coupled_run(scenario, loop.step, RunSpec(law=law, seed=options.seed)).score

    floor = None
    if not wide:
        along = shadow.others[0]
        codes = compare_codes(along, shadow.reference)
        floor = Floor(errors(quantities, along, shadow.reference), codes, driven(floored(fresh())))
    still = standstill(scenario, law.controller, fresh(), fresh())
    program = record(scenario, law, wide=True) if wide else formats
    price = cost_of(program, fresh(), scenario.timing.control_period_ns)
    over_runs = effect(scenario, options.runs, law) if options.runs else None
    bounds = None if wide else bounds_of(formats, shadow.audited.loop.law)
    return Result(
        scenario,
        options,
        shadow.audited.telemetry.rows,
        bounds,
        errors(quantities, shadow.audited, shadow.reference),
        compare_codes(shadow.audited, shadow.reference),
        floor,
        shadow.run.score,
        driven(make("float64")),
        over_runs,
        still,
        price,
        () if wide else coarse(shadow.audited.loop.law.constants),
        bars(shadow, still, price, over_runs, bounds),
    )


def bars(
    shadow: ShadowRun,
    still: Standstill,
    price: Cost,
    over_runs: Effect | None = None,
    bounds: Bounds | None = None,
) -> list[Bar]:
    """Hold the findings against what is demanded."""
    counters = shadow.audited.arithmetic.counters
    codes = compare_codes(shadow.audited, shadow.reference)
    found = [
        Bar("wraps in the run", f"{counters.wraps}", "0", not counters.wraps),
        Bar("divisions by zero", f"{counters.zero_divisions}", "0", not counters.zero_divisions),
        Bar("infinite values", f"{shadow.audited.not_finite}", "0", not shadow.audited.not_finite),
        Bar(
            "notch codes equal to float64's",
            f"{codes.equal_share:.2%} of {codes.steps}",
            f"at least {EQUAL_SHARE_MIN:.0%}",
            codes.equal_share >= EQUAL_SHARE_MIN,
        ),
        Bar(
            "largest difference of a code",
            f"{codes.largest}/256 notch",
            f"at most {CODE_DIFFERENCE_MAX}",
            codes.largest <= CODE_DIFFERENCE_MAX,
        ),
        Bar(
            f"changes of the notch in {still.seconds:g} s at rest",
            f"{still.changes}",
            "0",
            not still.changes,
        ),
        Bar(
            "held train after one reading of 1 mm/s: difference",
            f"{still.kicked_difference}/256 notch",
            f"at most {CODE_DIFFERENCE_MAX}",
            still.kicked_difference <= CODE_DIFFERENCE_MAX,
        ),
        Bar(
            "share of the control period, from flash",
            f"{price.share:.4%}",
            "below 100%",
            price.share < 1,
        ),
    ]
    if bounds is not None:
        found.insert(
            1,
            Bar("operations that may wrap for a reading on the wire", f"{bounds.may_wrap}", "0", not bounds.may_wrap),
        )
    if over_runs is None:
        return found
    counters = over_runs.counters
    found += [
        Bar("wraps in the perturbed runs", f"{counters.wraps}", "0", not counters.wraps),
        Bar("divisions by zero in the perturbed runs", f"{counters.zero_divisions}", "0", not counters.zero_divisions),
    ]
    for one in over_runs.scores:
        shown = "no run has it" if one.difference is None else f"{one.difference:+.4g} {one.unit}"
        if one.missing:
            shown += f", {one.missing} runs stop in one arithmetic only"
        found.append(Bar(f"median {one.score}", shown, f"within {one.allowed:.3g} {one.unit}", one.met))
    return found
