"""The limits of an audit ("bars"): the value found and the value allowed for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from railhil.audit.bounds import Bounds
from railhil.audit.effect import Effect
from railhil.audit.shadow import Codes, QuantityError, ShadowRun, compare_codes
from railhil.common.digits import count_of, percent, text_beside_limit
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.cost import Cost
from railhil.scenarios.run_spec import LawSpec

#: Share of control periods in which a command's code must equal float64's, and how far the others may differ, raw.
EQUAL_SHARE_MIN = 0.99
CODE_DIFFERENCE_MAX = 1


@dataclass(frozen=True, slots=True)
class Bar:
    """One limit: the value found, the value allowed, and whether the limit is met."""

    name: str
    found: str
    allowed: str
    met: bool


@dataclass(frozen=True, slots=True)
class Look:
    """Result of a system's own examination.

    ``figures`` are its values in the JSON document, under ``key``; ``title`` and ``text`` are printed on the terminal;
    ``bars`` are its limits.
    """

    key: str
    title: str
    text: str
    figures: Mapping[str, Any]
    bars: tuple[Bar, ...]


#: The part ``audit`` of a system. Arguments: scenario, law, and a function that makes a fresh audited arithmetic.
OwnLook = Callable[[Any, LawSpec, Callable[[], Arithmetic[Any]]], Look]


def _codes_bars(codes: Codes) -> list[Bar]:
    command = codes.command
    return [
        Bar(
            f"{command.name} codes equal to float64's",
            f"{percent(codes.equal_share)} of {codes.steps}",
            f"at least {EQUAL_SHARE_MIN:.0%}",
            codes.equal_share >= EQUAL_SHARE_MIN,
        ),
        Bar(
            f"largest difference of a {command.name} code",
            command.shown(codes.largest),
            f"at most {CODE_DIFFERENCE_MAX}",
            codes.largest <= CODE_DIFFERENCE_MAX,
        ),
    ]


def _error_bar(error: QuantityError, most: float) -> Bar:
    """The limit of one quantity's error, in its unit."""
    shown = "no value"
    if error.maximum is not None:
        shown = f"{text_beside_limit(error.maximum, most, 2, kind='g')} {error.unit}"
    met = error.maximum is not None and error.maximum <= most
    return Bar(f"largest difference of {error.name} from float64's", shown, f"at most {most:g} {error.unit}", met)


def _effect_bars(over_runs: Effect) -> list[Bar]:
    counters = over_runs.counters
    found = [
        Bar("wraps in the perturbed runs", f"{counters.wraps}", "0", not counters.wraps),
        Bar("divisions by zero in the perturbed runs", f"{counters.zero_divisions}", "0", not counters.zero_divisions),
    ]
    for one in over_runs.scores:
        shown = (
            "no run has it"
            if one.difference is None
            else f"{text_beside_limit(one.difference, one.allowed, 4, '+', 'g')} {one.unit}"
        )
        if one.missing:
            shown += f", {count_of(one.missing, 'run has', 'runs have')} it in one arithmetic only"
        found.append(Bar(f"median {one.score}", shown, f"within {one.allowed:.3g} {one.unit}", one.met))
    return found


def bars(
    shadow: ShadowRun,
    price: Cost,
    *,
    look: Look | None = None,
    over_runs: Effect | None = None,
    bounds: Bounds | None = None,
    errors: Sequence[QuantityError] = (),
    limits: Mapping[str, float] | None = None,
) -> list[Bar]:
    """Compare the findings with their limits; an examination that was skipped has no limit here.

    :param errors: of the quantities against float64.
    :param limits: largest error of some quantities (``accel`` for ``accel[0]``, ...), the system's ``audit_limits``.
    """
    counters = shadow.audited.arithmetic.counters
    not_finite = shadow.audited.not_finite
    found = [Bar("wraps in the run", f"{counters.wraps}", "0", not counters.wraps)]
    if bounds is not None:
        name = "operations that may wrap for a reading on the wire"
        found.append(Bar(name, f"{bounds.may_wrap}", "0", not bounds.may_wrap))
    found += [
        Bar("divisions by zero", f"{counters.zero_divisions}", "0", not counters.zero_divisions),
        Bar("infinite values", f"{not_finite}", "0", not not_finite),
    ]
    for codes in compare_codes(shadow.twin, shadow.reference):
        found += _codes_bars(codes)
    found += [
        _error_bar(error, most)
        for name, most in (limits or {}).items()
        for error in errors
        if error.name.split("[")[0] == name
    ]
    found += look.bars if look is not None else ()
    found.append(
        Bar(
            "share of the control period, from flash",
            f"{text_beside_limit(100 * price.share, 100, 4)}%",
            "below 100%",
            price.share < 1,
        )
    )
    found += _effect_bars(over_runs) if over_runs is not None else []
    return found
