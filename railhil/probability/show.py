"""What ``railhil probability`` prints: the probability with its interval, what it is over and what not, and causes."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.batch.decision import Decision
from railhil.common.digits import count_of
from railhil.probability.plan import LEAST
from railhil.scenarios.fault_list import name_fault_draws

if TYPE_CHECKING:
    from railhil.probability.plan import Plan

#: Causes with a smaller share are not named.
_CAUSE_MIN = 0.01
_CAUSES_MAX = 6


def lines(plan: Plan, summary: Mapping[str, Any], folder: Path) -> Iterator[str]:
    """The result, line by line."""
    law = plan.bench.base.law
    yield f"{summary['scenario']}, {law.label} {law.arithmetic}, {plan.requirement.id}; seed {summary['seed']}"
    yield from _probability(plan, summary)
    yield _over(plan, summary["draws_over"])
    if summary["silent"]:
        silent = count_of(summary["silent"], "run", spec=",")
        yield f"{silent} said nothing about the requirement: counted as not violated"
    yield from _causes(summary["causes"])
    least = summary["least"]
    if least is not None:
        yield f"the least disturbance: {least['size']:.2f} standard deviations of the draws ({folder / LEAST})"
        yield f"    railhil run {shlex.quote(str(folder / LEAST))} {least['options']}"
        yield f"    sha256 {least['sha256'][:12]}..."
        if decided := least.get("decided"):
            yield f"    {Decision.from_json(decided).sentence}"
    yield _verdict(plan, summary)


def _over(plan: Plan, names: Sequence[str]) -> str:
    """What the probability is over, and what not.

    :param names: of all draws, those of faults in the end.
    """
    faults = plan.scenario.faults
    values = len(name_fault_draws(faults))
    over = [f"the {count_of(len(names) - values, 'draw')} of [perturbations]"] if len(names) > values else []
    over += [f"{count_of(values, 'value')} of faults"] if values else []
    # The batch computes no fault that draws while it acts.
    over += ["the samples that faults draw while they act"] if faults and not plan.state.is_fast else []
    return (
        f"over: {', '.join(over)} and the noise of the speed sensor; not over: {'' if faults else 'faults, '}"
        "anything that the scenario does not draw. It is a statement about the model's distributions."
    )


def _probability(plan: Plan, summary: Mapping[str, Any]) -> Iterator[str]:
    says, runs = plan.requirement.says, count_of(summary["runs"], "run", spec=",")
    repetitions = count_of(len(summary["repetitions"]), "repetition")
    how = f"{repetitions} of subset simulation" if summary["repetitions"] else "brute force"
    if summary["low"] is None:
        found = f"P = {summary['p']:.2g}, no interval" if summary["p"] else "no violation found"
        yield f'P(not "{says}"): {found} in {runs}, {how}: below {summary["unresolved_below"]:.1g} was not resolved'
        return
    interval = f"{summary['p']:.2g} [{summary['low']:.2g}, {summary['high']:.2g}]"
    yield f'P(not "{says}") = {interval}   {summary["level"]:.0%}, {how}, {runs}'
    if summary["repetitions"]:
        yield f"    brute force for the same width: about {summary['runs_brute_equivalent']:,} runs"


def _causes(causes: Mapping[str, Any]) -> Iterator[str]:
    ordered = sorted(causes["draws"].items(), key=lambda item: -item[1]["share"])
    named = [(name, one["share"]) for name, one in ordered[:_CAUSES_MAX] if one["share"] >= _CAUSE_MIN]
    shown = [f"{name} {share:.0%}" for name, share in named]
    if causes["noise"] is not None:
        shown.append(f"noise {causes['noise']:.0%}")
    yield f"causes of the margin's variance: {', '.join(shown) or 'none of 1 % or more'}"
    unusual = sorted(
        ((name, one["squares_in_failures"]) for name, one in causes["draws"].items() if one["squares_in_failures"]),
        key=lambda item: -item[1],
    )
    if unusual:
        told = ", ".join(f"{name} x{square:.1f}" for name, square in unusual[:_CAUSES_MAX] if square > 1)
        yield f"mean square in the runs that violate it, against all runs: {told or 'no draw is unusual'}"


def _verdict(plan: Plan, summary: Mapping[str, Any]) -> str:
    at_most, low, high = summary["at_most"], summary["low"], summary["high"]
    if low is not None and low > at_most:
        return f"FAIL: P lies above {at_most:.3g}, the bound of --at-most"
    if not summary["is_resolved"]:
        reached = "" if summary["accuracy"] is None else f", reached {summary['accuracy']:.0%}"
        return f"NOT RESOLVED: wanted +-{plan.request.accuracy:.0%} of P{reached}; --max-runs allows more runs"
    if high > at_most:
        return f"NOT RESOLVED: {at_most:.3g}, the bound of --at-most, lies in the interval; --accuracy makes it shorter"
    return f"resolved to +-{summary['accuracy']:.0%} of P" + (f"; at most {at_most:.3g}" if at_most < 1 else "")
