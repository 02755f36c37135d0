"""The complete result of an audit as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

from railhil.audit.result import Audit, Floor
from railhil.audit.shadow import Codes, QuantityError
from railhil.controller_node.telemetry import QuantityTelemetry
from railhil.judge.score import Score


def _range(row: QuantityTelemetry) -> dict[str, Any]:
    found = asdict(row)
    # JSON cannot represent infinity; the limit "infinite values" reports it.
    return found | {key: found[key] if isfinite(found[key] or 0.0) else None for key in ("minimum", "maximum")}


def _error(error: QuantityError) -> dict[str, Any]:
    found = asdict(error)
    for key in ("rms", "maximum", "bias"):
        value = found[key]
        found[f"{key}_lsb"] = None if value is None else error.lsb(value)
    return found


def _codes(found: Sequence[Codes]) -> dict[str, Any]:
    return {
        codes.command.name: {
            "q": codes.command.q,
            "unit": codes.command.unit,
            "steps": codes.steps,
            "equal": codes.equal,
            "largest": codes.largest,
            "equal_share": codes.equal_share,
        }
        for codes in found
    }


def _scores(score: Score) -> Any:
    return score.as_json()["scores"]


def _floor(floor: Floor | None) -> dict[str, Any] | None:
    if floor is None:
        return None
    errors = [_error(error) for error in floor.errors]
    return {"errors": errors, "commands": _codes(floor.codes), "scores": _scores(floor.score)}


def document(result: Audit) -> dict[str, Any]:
    """The document printed by ``--json``: numbers in the units of the quantities, ``_lsb`` in LSB of their formats.

    ``commands`` compares the codes of each command; ``largest`` is a raw difference, in Q ``q`` of ``unit``. A system's
    own examination has a key of its own (``standstill`` for ``ato``). ``effect`` is empty and ``effect_counters``
    (audited arithmetic, all runs) is null without perturbed runs; ``bounds`` and ``floor`` are null for an arithmetic
    without formats.
    """
    options, cost, effect = result.options, result.cost, result.effect
    return {
        "scenario": result.scenario.name,
        "scenario_sha256": result.scenario.sha256,
        "controller": options.law.controller,
        **options.law.how,
        "seed": options.seed,
        "runs": options.runs,
        "met": result.met,
        "bars": [asdict(bar) for bar in result.bars],
        "ranges": [_range(row) for row in result.ranges],
        "bounds": None if result.bounds is None else asdict(result.bounds),
        "errors": [_error(error) for error in result.errors],
        "commands": _codes(result.codes),
        "floor": _floor(result.floor),
        "scores": {options.law.arithmetic: _scores(result.score), "float64": _scores(result.reference_score)},
        "effect": [asdict(one) | {"difference": one.difference, "met": one.met} for one in effect.scores]
        if effect
        else [],
        "effect_counters": asdict(effect.counters) if effect else None,
        **({} if result.look is None else {result.look.key: dict(result.look.figures)}),
        "cost": asdict(cost)
        | {
            "cycles_flash": cost.cycles_flash,
            "ram_us": cost.ram_us,
            "flash_us": cost.flash_us,
            "share_flash": cost.share,
        },
        "coarse_constants": [
            {
                "name": constant.name,
                "q": constant.q,
                "value": constant.value,
                "raw": constant.raw,
                "relative_error": constant.relative_error,
            }
            for constant in result.coarse_constants
        ],
    }
