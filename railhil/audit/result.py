"""Runs an audit from its options to its result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from railhil.audit.bars import Bar, Look, OwnLook, bars
from railhil.audit.bounds import Bounds, bounds_of
from railhil.audit.effect import Effect, effect
from railhil.audit.shadow import Codes, QuantityError, Watched, compare_codes, errors, floored, run_under, shadow_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.cost import Cost
from railhil.controller_node.laws import is_floating
from railhil.controller_node.laws.constant_table import coarse
from railhil.controller_node.telemetry import QuantityTelemetry
from railhil.judge.criteria import Criterion
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec


@dataclass(frozen=True, slots=True)
class Options:
    """Law, seed and number of perturbed runs of an audit; ``runs`` = 0 skips the perturbed runs."""

    law: LawSpec = field(default_factory=LawSpec)
    seed: int = 0
    runs: int = 200


@dataclass(frozen=True, slots=True)
class Floor:
    """The twin with floored products.

    ``errors`` and ``codes`` compare it with float64 on the inputs of the audited run; ``score`` is from a run of its
    own.
    """

    errors: list[QuantityError]
    codes: tuple[Codes, ...]
    score: Score


@dataclass(frozen=True, slots=True)
class Audit:
    """All findings of an audit.

    ``codes`` has one element for each command. ``bounds`` and ``floor`` are None for an arithmetic without formats,
    ``effect`` without perturbed runs, ``look`` for a system without an examination of its own.
    """

    scenario: AnyScenario
    options: Options
    ranges: Sequence[QuantityTelemetry]
    bounds: Bounds | None
    errors: list[QuantityError]
    codes: tuple[Codes, ...]
    floor: Floor | None
    score: Score
    reference_score: Score
    effect: Effect | None
    look: Look | None
    cost: Cost
    coarse_constants: tuple[Constant, ...]
    bars: list[Bar]

    @property
    def met(self) -> bool:
        """All limits are met."""
        return all(bar.met for bar in self.bars)

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """Criteria of the system's scores."""
        return judging_of(self.scenario).criteria


def audit(scenario: AnyScenario, options: Options) -> Audit:
    """Audit one law in one arithmetic on one scenario.

    :raises scenarios.errors.InputError: an unknown law, arithmetic or indexing.
    """
    law = options.law
    system = scenario.installed_system

    def fresh() -> Arithmetic[Any]:
        return make(law.arithmetic)

    def driven(arithmetic: Arithmetic[Any]) -> Score:
        return run_under(scenario, law, Watched(scenario, law, arithmetic), options.seed).score

    wide = fresh().wide
    twin = fresh() if is_floating(law.controller, system.laws) else None
    others = () if wide else (floored(fresh()),)
    shadow = shadow_run(scenario, law, fresh(), others=others, twin=twin, seed=options.seed)
    audited, reference = shadow.audited, shadow.reference
    floor = None
    if not wide:
        (along,) = shadow.others
        codes = compare_codes(along, reference)
        floor = Floor(errors(shadow.quantities, along, reference), codes, driven(floored(fresh())))
    own: OwnLook | None = system.optional_part("audit")
    look = own(scenario, law, fresh) if own is not None else None
    price = audited.controller.cost
    over_runs = effect(scenario, options.runs, law) if options.runs else None
    bounds = None if wide else bounds_of(audited.controller)
    found = errors(shadow.quantities, shadow.twin, reference)
    limits = system.optional_part("audit_limits")
    return Audit(
        scenario,
        options,
        audited.telemetry.rows,
        bounds,
        found,
        compare_codes(shadow.twin, reference),
        floor,
        shadow.run.score,
        driven(make("float64")),
        over_runs,
        look,
        price,
        () if wide else coarse(audited.controller.law.constants),
        bars(shadow, price, look=look, over_runs=over_runs, bounds=bounds, errors=found, limits=limits),
    )
