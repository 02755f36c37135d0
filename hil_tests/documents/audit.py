"""Figures of docs/reference/audit_results.md."""

from __future__ import annotations

from collections.abc import Sequence

from hil_tests.documents.figures import LVSHUN, document, row

#: Digits of each score, of its difference, of what is allowed and of the largest difference of one run.
_DIGITS = {
    "ITAE, km/h s²": ("itae", 2, 2, 1, 1),
    "energy, kJ": ("energy_kj", 1, 1, 0, 0),
    "punctuality, s": ("punctuality_s", 4, 4, 2, 3),
    "stop error, m": ("stop_error_m", 4, 4, 2, 3),
    "comfort, m/s² per km": ("comfort", 4, 4, 3, 3),
}


def effect() -> Sequence[str]:
    """Medians of 200 perturbed runs in fixed point and in float64."""
    found = {one["score"]: one for one in document("audit", LVSHUN)["effect"]}
    rows = []
    for name, (key, digits, *others) in _DIGITS.items():
        one = found[key]
        values = (one["difference"], one["allowed"], one["largest_single"])
        told = [f"{value:{'+' if not n else ''}.{others[n]}f}" for n, value in enumerate(values)]
        rows.append(row(name, f"{one['audited']:.{digits}f}", f"{one['reference']:.{digits}f}", *told))
    return rows


def codes() -> Sequence[str]:
    """Notch codes equal to float64's, and the bias of the products."""
    found = document("audit", LVSHUN)
    assert found["met"]
    notch, floor = found["commands"]["notch"], found["floor"]
    bias = [
        next(one for one in part if one["name"] == "notch_raw")["bias_lsb"]
        for part in (found["errors"], floor["errors"])
    ]
    return (
        f"Of {notch['steps']} notch codes {100 * notch['equal_share']:.2f} % equal those",
        f"with floored products {100 * floor['commands']['notch']['equal_share']:.2f} % do",
        "goes from {:.2f} to {:.2f} LSB.".format(*bias),
    )
