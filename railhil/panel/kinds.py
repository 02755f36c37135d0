"""Kinds of faults that an operator may give values of his own during a run, for the form of the page."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from typing import Any


def kinds_of(texts: Iterable[str]) -> list[dict[str, Any]]:
    """The kinds among the faults of a run that are triggered by hand, each once, in their order.

    ``name``: place and word; ``tail``: its count and what else is fixed; ``parameters``: name, meaning, ``keyword``
    before it (empty: none), ``value`` as prepared, ``usual`` value (empty: none), ``unit`` of a number without one,
    ``range`` (empty: any), all as texts of the fault language, and whether it is ``fixed`` (a name).
    """
    # The language is loaded only when somebody uses it.
    from railhil.faults.language import parse
    from railhil.faults.model import NAME, Fault, Parameter
    from railhil.faults.notation import UNITS, number_text, place_text, value_text
    from railhil.faults.operator_values import parameters_of

    def shown(fault: Fault, one: Parameter) -> dict[str, Any]:
        is_name = one.unit == NAME
        limits = [number_text(limit, one.unit) if isfinite(limit) else "" for limit in (one.low, one.high)]
        return {
            "name": one.name,
            "meaning": one.meaning,
            "keyword": one.keyword,
            "value": value_text(fault.values[one.name], one.unit),
            "usual": "" if one.usual is None else value_text(one.usual, one.unit),
            "unit": "" if is_name else next(iter(UNITS[one.unit])),
            "range": "" if is_name or not any(limits) else f"{limits[0]} to {limits[1]}".strip(),
            "fixed": is_name,
        }

    found: dict[tuple[str, str, str], dict[str, Any]] = {}
    for fault in map(parse, texts):
        if fault.trigger.kind != "manual" or not parameters_of(fault):
            continue
        names = [str(fault.values[one.name]) for one in parameters_of(fault) if one.unit == NAME]
        tail = [f"x{fault.count}"] if fault.count is not None else []
        tail += [f"after {fault.after}"] if fault.after else []
        tail += [f"units {','.join(map(str, fault.units))}"] if fault.units else []
        name = f"{place_text(fault.place)} {fault.what}"
        parameters = [shown(fault, one) for one in parameters_of(fault)]
        fixed = " ".join(tail)
        kind = {"name": name, "tail": fixed, "parameters": parameters}
        found.setdefault((name, fixed, " ".join(names)), kind)
    return list(found.values())
