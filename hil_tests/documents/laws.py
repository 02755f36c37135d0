"""Figures of docs/reference/laws.md, docs/reference/law_results.md and docs/explanation/paper_laws.md."""

from __future__ import annotations

import csv
from collections.abc import Sequence

import numpy as np

from hil_tests.documents import figures
from hil_tests.documents.figures import (
    LAWS,
    LVSHUN,
    Nominal,
    batch,
    cycles,
    equal_codes,
    median,
    memory_words,
    nominal,
    passed,
    row,
)
from hil_tests.support.paths import ROOT
from railhil.batch import Batch
from railhil.scenarios.load import load, names

#: Of the table of control periods, in ms.
PERIODS_MS = (200, 300, 500, 1000)


def constants(law: str, name: str) -> list[float]:
    """A vector of the law's table of constants."""
    lines = (ROOT / f"controller_node/ato/tables/{law}.csv").read_text("utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [float(one["value"]) for one in rows if one["name"].startswith(f"{name}[")]


def gains() -> Sequence[str]:
    """Gains U at the fitting points."""
    shown = {"step": ("ipfc", "step"), "step and ramp": ("tpfc1", "ramp"), "wavelets": ("ipfc", "wavelet")}
    return [
        row(basis, *(f"{gain:.4f}" for gain in constants(law, f"gains_{name}"))) for basis, (law, name) in shown.items()
    ]


def _five(run: Nominal) -> list[str]:
    return [
        f"{run['itae']:.1f}", f"{run['energy_kj']:.0f}", f"{run['time_error_s']:.4f}", f"{run['stop_error_m']:+.3f}",
        f"{run['comfort']:.3f}",
    ]  # fmt: skip


def pfc_nominal() -> Sequence[str]:
    """IPFC, TPFC1 and TPFC2 on the nominal run."""
    runs = {law: nominal(law) for law in ("ipfc", "tpfc1", "tpfc2")}
    return [row(f"`{law}`", *_five(run), run.telemetry["cycles"]["ram"]) for law, run in runs.items()]


_DIGITS = {"itae": 1, "energy_kj": 0, "punctuality_s": 4, "stop_error_m": 4, "comfort": 3}


def pfc_perturbed() -> Sequence[str]:
    """The same, perturbed, with the published figures."""
    published = {one.controller: one.values for one in load(LVSHUN).published}
    rows = []
    for law in ("ipfc", "tpfc1", "tpfc2"):
        result = batch(law)
        paper = {name: published[law][name] for name in _DIGITS}
        told = {name: f"{value:.{0 if name == 'itae' else _DIGITS[name]}f}" for name, value in paper.items()}
        cells = [f"{median(result, name):.{digits}f} ({told[name]})" for name, digits in _DIGITS.items()]
        rows.append(row(f"`{law}`", *cells, f"{passed(result) / 2:.0f} %"))
    return rows


def pfc_distance() -> Sequence[str]:
    """Set-points by distance."""
    rows = []
    for law in ("ipfc", "tpfc1", "tpfc2"):
        result = batch(law, indexing="distance")
        cells = [f"{median(result, name):.{digits}f}" for name, digits in _DIGITS.items()]
        rows.append(row(f"`{law}`", *cells, f"{passed(result) / 2:.0f} %"))
    return rows


#: The factor exp(-Ts / Tr) of TPFC1 and TPFC2, in place of the adapted one of IPFC.
CONSTANT = float(np.exp(-0.5))
_READINGS = {
    "`tpfc1`, published": ("tpfc1", {}),
    "`tpfc1`, `softening = 0.85` (the other choice)": ("tpfc1", {"softening": 0.85}),
    "`tpfc1`, ramp at all times (`ramp_slope_kmh_per_s = -1`)": ("tpfc1", {"ramp_slope_kmh_per_s": -1.0}),
    "`tpfc1`, step at all times (20)": ("tpfc1", {"ramp_slope_kmh_per_s": 20.0}),
    "`tpfc2`, published": ("tpfc2", {}),
    "`tpfc2`, `softening = 0.85` (the other choice)": ("tpfc2", {"softening": 0.85}),
    "`ipfc`, wavelets at all times, `softening_exponent = 1` (the other choice taken literally)": (
        "ipfc", {"wavelet_slope_kmh_per_s": -1.0, "softening_exponent": 1.0},
    ),
    "`ipfc`, published": ("ipfc", {}),
    "`ipfc`, `softening_max` and so alpha 0.607 throughout": (
        "ipfc", {"softening_max": CONSTANT, "softening_span": 0.0},
    ),
}  # fmt: skip


def readings() -> Sequence[str]:
    """Effect of the interpretations."""
    rows = []
    for name, (law, changed) in _READINGS.items():
        result = batch(law, arithmetic="float64", **changed)
        cells = [f"{median(result, score):.3f}" for score in ("punctuality_s", "stop_error_m", "comfort")]
        rows.append(row(name, f"{median(result, 'itae'):.0f}", *cells))
    return rows


def gap() -> Sequence[str]:
    """How much of the difference of IPFC and TPFC2 is softening: the other law's factor in each, in fixed point."""
    ipfc, tpfc2 = median(batch("ipfc"), "itae"), median(batch("tpfc2"), "itae")
    tpfc2_soft = median(batch("tpfc2", softening=0.85), "itae")
    ipfc_stiff = median(batch("ipfc", softening_max=CONSTANT, softening_span=0.0), "itae")
    shares = sorted(100 * change / (ipfc - tpfc2) for change in (tpfc2_soft - tpfc2, ipfc - ipfc_stiff))
    return (
        f"TPFC2 has an ITAE of {tpfc2:.0f}, with the factor of IPFC {tpfc2_soft:.0f};",
        f"IPFC {ipfc:.0f}, with that of TPFC2 {ipfc_stiff:.0f}",
        f"{shares[0]:.0f} to {shares[1]:.0f} % of the gap",
    )


def pfc_fixed() -> Sequence[str]:
    """Codes in fixed point and in float64."""
    steps = nominal("tpfc1").telemetry["steps"]
    return (f"equal in {equal_codes('tpfc1')} (TPFC1) and {equal_codes('tpfc2')} (TPFC2) of {steps} periods",)


def tdmc_fixed() -> Sequence[str]:
    """What TDMC costs."""
    return (f"{cycles('tdmc')} cycles and {memory_words('tdmc')[0]} words of RAM.",)


def fuzzy_fixed() -> Sequence[str]:
    """What fuzzy PID costs."""
    return (f"{cycles('fuzzy_pid')} cycles and {memory_words('fuzzy_pid')[0]} words of RAM;",)


def fuzzy_rules() -> Sequence[str]:
    """Gains that the rules do not move, and the shipped rules."""
    held = {f"{gain}_span": 0.0 for gain in ("proportional", "integral", "derivative")}
    rows = []
    for name, changed in (("gains held at their nominal values", held), ("symmetric (shipped)", {})):
        cells = []
        for scenario in (LVSHUN, "yizhuang_01"):
            run = batch("fuzzy_pid", scenario, "float64", seeds=range(1), perturbed=False, **changed)
            time_s, stop_m = (float(run.signed[key][0]) for key in ("time_error_s", "stop_error_m"))
            cells.append(f"{run.values['itae'][0]:.0f}, {time_s:+.3f} s, {stop_m:+.2f} m")
        rows.append(row(name, *cells))
    return rows


def tdmc_ramp() -> Sequence[str]:
    """The ramp of the correction of TDMC."""
    rows = []
    for ramp in (0.0, 0.1, 0.3, 0.6, 0.9):
        run = batch("tdmc", seeds=range(1), perturbed=False, correction_ramp=ramp)
        itae, time_s, stop_m = (
            float(values[0]) for values in (run.values["itae"], run.signed["time_error_s"], run.signed["stop_error_m"])
        )
        rows.append(
            row(f"**{ramp:g}**" if ramp == 0.6 else f"{ramp:g}", f"{itae:.0f}", f"{time_s:+.3f}", f"{stop_m:+.2f}")
        )
    return rows


def tdmc_fuzzy() -> Sequence[str]:
    """Nominal runs of TDMC and fuzzy PID."""
    where = ((LVSHUN, "time"), (LVSHUN, "distance"), *((f"yizhuang_{n}", "time") for n in ("01", "05", "11")))
    rows = []
    for law in ("tdmc", "fuzzy_pid"):
        for scenario, indexing in where:
            run = _single(law, scenario, indexing=indexing)
            scores, signed = run.values, run.signed
            rows.append(
                row(
                    law, scenario, indexing, f"{scores['itae'][0]:.0f}", f"{scores['energy_kj'][0]:.0f}",
                    f"{signed['time_error_s'][0]:+.3f}", f"{signed['stop_error_m'][0]:+.3f}",
                    f"{scores['comfort'][0]:.2f}",
                )
            )  # fmt: skip
    return rows


def _single(law: str, scenario: str, **given: object) -> Batch:
    """The run with seed 0 of the nominal train, in the batch: the same to the last digit."""
    return batch(law, scenario, seeds=range(1), perturbed=False, **given)  # type: ignore[arg-type]


def tdmc_fuzzy_perturbed() -> Sequence[str]:
    """Their medians."""
    digits = {"itae": 0, "energy_kj": 0, "punctuality_s": 3, "stop_error_m": 3, "comfort": 2}
    return [
        row(law, *(f"{median(batch(law), name):.{n}f}" for name, n in digits.items())) for law in ("tdmc", "fuzzy_pid")
    ]


def control_periods() -> Sequence[str]:
    """Every law at other control periods: ITAE, time and stop error; bold inside both limits."""
    rows = []
    for law in ("ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop"):
        cells = []
        for period_ms in PERIODS_MS:
            run = _single(law, LVSHUN, settings=[f"timing.control_period_ms={period_ms}"])
            time_s, stop_m = (run.signed[key][0] for key in ("time_error_s", "stop_error_m"))
            text = f"{run.values['itae'][0]:.0f} / {time_s:+.2f} / {stop_m:+.2f}"
            cells.append(f"**{text}**" if run.passed[0] else text)
        rows.append(row(f"`{law}`", *cells))
    return rows


#: The runs of the Yizhuang line between two stations.
YIZHUANG = tuple(name for name in names() if name.startswith("yizhuang_") and name[9:11].isdigit())


def _own_and_tuned(law: str) -> list[tuple[str, str, dict[str, object]]]:
    return [(f"`{law}`", "own", {}), ("", "tuned", {"file": figures.tuned(law)})]


def yizhuang_nominal() -> Sequence[str]:
    """Smallest to largest of the thirteen."""
    rows = []
    for law in LAWS:
        for name, which, given in _own_and_tuned(law):
            runs = [_single(law, scenario, **given) for scenario in YIZHUANG]
            stop, time_s = ([float(run.signed[key][0]) for run in runs] for key in ("stop_error_m", "time_error_s"))
            itae = [float(run.values["itae"][0]) for run in runs]
            count = sum(int(run.passed[0]) for run in runs)
            rows.append(
                row(
                    name, which, f"**{count}**" if count == len(YIZHUANG) else count,
                    f"{min(stop):+.2f}..{max(stop):+.2f}", f"{min(time_s):+.2f}..{max(time_s):+.2f}",
                    f"{min(itae):.0f}..{max(itae):.0f}",
                )
            )  # fmt: skip
    return rows


def yizhuang_perturbed() -> Sequence[str]:
    """Fifty perturbed runs of each."""
    rows = []
    for law in LAWS:
        for name, which, given in _own_and_tuned(law):
            runs = [batch(law, scenario, seeds=range(1000, 1050), **given) for scenario in YIZHUANG]  # type: ignore[arg-type]
            count = sum(map(passed, runs))
            together = {key: np.concatenate([run.values[key] for run in runs]) for key in _DIGITS}
            digits = 3 if law.startswith("ipfc_plus") else 2
            cells = [_quantiles(together[key], digits) for key in ("stop_error_m", "punctuality_s")]
            total = 50 * len(YIZHUANG)
            rows.append(
                row(
                    name,
                    which,
                    f"**{count}**" if count == total else count,
                    *cells,
                    f"{np.median(together['comfort']):.2f}",
                )
            )
    return rows


def _quantiles(values: np.ndarray[tuple[int], np.dtype[np.float64]], digits: int) -> str:
    worst = np.nan_to_num(np.abs(values), nan=np.inf)
    return f"{np.median(worst):.{digits}f} / {np.percentile(worst, 95):.{digits}f}"
