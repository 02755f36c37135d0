"""Figures of docs/explanation/ipfc_plus.md and docs/reference/ipfc_plus_results.md."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks import ablation, stopping
from hil_tests.documents.all_laws import MANY
from hil_tests.documents.figures import LVSHUN, WORN, batch, both, cycles, median, memory_words, p95, passed, row
from hil_tests.documents.laws import YIZHUANG
from hil_tests.loop.test_position_loop import Fault, changed, late, run_with, silent
from hil_tests.unit.controller_node.ato.test_ipfc_plus import faulty
from railhil.batch import Batch
from railhil.batch.statistics import estimate
from railhil.scenarios.load import load
from railhil.wire.ato import BalisePassed, CtlMode, NotchCmd, TrnPos

_LAWS = ("ipfc_plus", "ipfc_plus_stop")


def limits() -> Sequence[str]:
    """IPFC+ in both arithmetics, and IPFC."""
    shown = [batch("ipfc_plus", WORN, "float64"), batch("ipfc_plus", WORN), batch("ipfc", WORN)]
    plus, ipfc = shown[:2], shown[2]
    inside = [
        int(np.count_nonzero((run.values["stop_error_m"] <= 0.2) & (run.values["punctuality_s"] <= 0.3)))
        for run in shown
    ]
    return [
        row(
            "stop error m",
            "0.027 / 0.050",
            *(both(run, "stop_error_m", 3) for run in plus),
            both(ipfc, "stop_error_m", 1),
        ),
        row("time error s", "0.045 / 0.10", *(both(run, "punctuality_s", 3) for run in shown)),
        row("comfort m/s2 per km", "1.5", *(both(run, "comfort", 2) for run in shown)),
        row("ITAE km/h s2", "-", *(f"{median(run, 'itae'):.0f}" for run in shown)),
        row("energy MJ", "-", *(f"{median(run, 'energy_kj') / 1000:.1f}" for run in shown)),
        row("runs inside 0.2 m and 0.3 s", "all", *inside),
        row("runs inside 0.3 m and 0.3 s (PASS)", "all", *map(passed, shown)),
    ]


def worst() -> Sequence[str]:
    """The largest errors, and the Yizhuang runs."""
    plus = batch("ipfc_plus", WORN)
    runs = [batch("ipfc_plus", name, seeds=MANY[:200]) for name in YIZHUANG]
    assert {passed(run) for run in runs} == {200}
    stop, time_s = ([median(run, key) for run in runs] for key in ("stop_error_m", "punctuality_s"))
    largest = [max(run.values[key].max() for run in [plus]) for key in ("stop_error_m", "punctuality_s")]
    return (
        "The largest stop error is {:.2f} m, the largest time error {:.2f} s.".format(*largest),
        f"medians {min(stop):.3f} to {max(stop):.3f} m and {min(time_s):.3f} to {max(time_s):.3f} s.",
    )


def elements() -> Sequence[str]:
    """One element off at a time (``python -m benchmarks.ablation``)."""
    rows = []
    for element in ablation.ELEMENTS:
        found = ablation.without(load(WORN), element, 200, 1000)
        rows.append(
            row(
                element, "{:.3f} / {:.3f}".format(*found.stop_error_m), "{:.3f} / {:.3f}".format(*found.punctuality_s),
                "{:.2f} / {:.2f}".format(*found.comfort), f"{found.itae:.0f}", found.passed,
            )
        )  # fmt: skip
    return rows


@cache
def _row(
    scenario: str, law: str, runs: int, changes: tuple[tuple[str, object], ...], settings: tuple[str, ...]
) -> tuple[str, ...]:
    """As ``python -m benchmarks.stopping`` prints it: stop, of the law, time, comfort, travel, step, energy, PASS."""
    seeds = range(1000, 1000 + runs)
    found = stopping.batch(load(scenario, settings), law, "float64", seeds, dict(changes))
    return stopping.row(found, _floors(scenario, runs, settings)[1])


@cache
def _floors(scenario: str, runs: int, settings: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    return stopping.floors_m(load(scenario, settings), range(1000, 1000 + runs))


def sensors() -> Sequence[str]:
    """Ten thousand runs, and what nobody can beat."""
    fit, bounds = (stopping.both(one, 4) for one in _floors(WORN, len(MANY), ()))
    rows = [
        row("least possible with the fit of IPFC+", fit, *[""] * 7),
        row("least possible with the bounds", bounds, *[""] * 7),
    ]
    return rows + [row(f"`{law}`", *_row(WORN, law, len(MANY), (), ())[:8]) for law in _LAWS]


def intervals() -> Sequence[str]:
    """Intervals of the quantiles of the ten thousand runs, and fixed point."""
    stops = np.abs(batch("ipfc_plus_stop", WORN, "float64", seeds=MANY).values["stop_error_m"])
    middle, high = estimate(stops, 0.5), estimate(stops, 0.95)
    ranges = [f"{one.low:.4f} to {one.high:.4f}" for one in (middle, high)]
    fixed = both(batch("ipfc_plus_stop", WORN, seeds=MANY), "stop_error_m", 4)
    return (f"`ipfc_plus_stop` {ranges[0]} / {ranges[1]} m; in `iq` {fixed} m",)


def _span(values: Sequence[float], digits: int) -> str:
    low, high = f"{min(values):.{digits}f}", f"{max(values):.{digits}f}"
    return f"{low} to {high}"


def other_lines() -> Sequence[str]:
    """Both laws on the Yizhuang runs and with exact wheels, and what longer re-planning gives."""
    ride = {
        scenario: [
            _row(scenario, stopping.LAW, runs, tuple(changed.items()), ())[3].split(" / ")[0]
            for changed in ({}, {"replan_max_s": 10.0})
        ]
        for scenario, runs in ((WORN, 2000), ("yizhuang_01", 1000))
    }
    stop, plus = ([batch(law, name) for name in YIZHUANG] for law in ("ipfc_plus_stop", "ipfc_plus"))
    floor = [np.abs(stopping.floors_m(load(name), range(1000, 1200))[1]) for name in YIZHUANG]
    exact = [batch(law, LVSHUN, seeds=range(1000, 2000)) for law in ("ipfc_plus_stop", "ipfc_plus")]
    assert all(bool(run.passed.all()) and not run.wraps.any() for run in (*stop, *plus, *exact))
    for ours, theirs in zip(stop, plus, strict=True):
        assert median(ours, "comfort") < median(theirs, "comfort")

    def spans(runs: Sequence[Batch], key: str) -> str:
        return f"{_span([median(run, key) for run in runs], 3)} / {_span([p95(run, key) for run in runs], 3)}"

    pairs = zip(stop, plus, strict=True)
    energy = max(abs(median(ours, "energy_kj") / median(theirs, "energy_kj") - 1) for ours, theirs in pairs)
    least = [estimate(one, share).value for share in (0.5, 0.95) for one in floor]
    travel = [
        np.median([np.abs(np.diff(codes.astype(np.int64), prepend=0)).sum() / 256 for codes in run.commands or ()])
        for run in exact
    ]
    return (
        "comfort {} instead of {} on the first".format(*ride[WORN]),
        "{} instead of {} on the second".format(*ride["yizhuang_01"]),
        f"stop errors are {spans(stop, 'stop_error_m')} m (IPFC+ {spans(plus, 'stop_error_m')} m; least possible "
        f"{_span(least[:13], 3)} / {_span(least[13:], 3)} m)",
        f"time errors {spans(stop, 'punctuality_s')} s ({spans(plus, 'punctuality_s')} s)",
        f"energy within {100 * energy:.2f} % of IPFC+'s",
        f"(1000 runs, `iq`), {both(exact[0], 'stop_error_m', 4)} m ({both(exact[1], 'stop_error_m', 4)} m)",
        f"and {both(exact[0], 'punctuality_s', 3)} s ({both(exact[1], 'punctuality_s', 3)} s)",
        f"with {travel[0]:.1f} instead of {travel[1]:.1f} notches of travel",
    )


_CHANGED = {
    "nothing": (),
    "balises exact (`perturbations.balise_position_error_m=[0,0]`)": ("perturbations.balise_position_error_m=[0,0]",),
    "balises to 3 cm": ("perturbations.balise_position_error_m=[-0.03,0.03]",),
    "balises to 8 cm: the tolerance of the law is wrong": ("perturbations.balise_position_error_m=[-0.08,0.08]",),
    "a seventh balise at 2930 m (`line.balises=[...]`)": ("SEVENTH",),
    "no noise of the speed (`perturbations.speed_noise_sigma_kmh=[0,0]`)": (
        "perturbations.speed_noise_sigma_kmh=[0,0]",
    ),
    "odometer of 1 mm instead of 1 cm (`sensors.odometer_lsb_m=0.001`)": ("sensors.odometer_lsb_m=0.001",),
    "loop delay known (`perturbations.loop_delay_s=[0.11,0.11]`)": ("perturbations.loop_delay_s=[0.11,0.11]",),
    "actuator's pole known (`perturbations.actuator_pole_factor=[1,1]`)": ("perturbations.actuator_pole_factor=[1,1]",),
}


def _seventh() -> str:
    balises = [(one.number, one.surveyed_m) for one in load(WORN).line.balises] + [(7, 2930.0)]
    return "line.balises=[" + ", ".join(f"{{number={n}, surveyed_m={at}}}" for n, at in balises) + "]"


def sources() -> Sequence[str]:
    """What the stop error consists of."""
    rows = []
    for what, settings in _CHANGED.items():
        settings = tuple(_seventh() if one == "SEVENTH" else one for one in settings)
        plus, stop = (_row(WORN, law, 2000, (), settings) for law in _LAWS)
        rows.append(row(what, stopping.both(_floors(WORN, 2000, settings)[1], 4), plus[0], stop[0], stop[1]))
    return rows


def stop_elements() -> Sequence[str]:
    """One element of the end phase off at a time, on two lines."""
    shown = [(f"`{law}`", law, {}) for law in _LAWS]
    shown += [(name.replace(" before", ""), stopping.LAW, dict(changed)) for name, changed in stopping.ELEMENTS.items()]
    rows = []
    for name, law, parameters in shown:
        items = tuple(sorted(parameters.items()))
        there, other = _row(WORN, law, 2000, items, ()), _row("yizhuang_01", law, 1000, items, ())
        rows.append(row(name, *there[:3], *other[:3]))
    return rows


_FAULTS = {
    "last two balises missing": "the last two balises are missing",
    "balises at 600, 1500 and 2400 m missing": "three balises under way are missing",
    "speed reads 0 in four periods, one of them 3 s before the stop": "speed reads 0 now and then",
    "speed frozen for 3 s": "speed is frozen for 3 s",
    "notch held at 0 for the first 5 s": "held for 5 s",
    "traction cut for 5 s at full acceleration": "traction is cut for 5 s",
}


def faults() -> Sequence[str]:
    """Largest of six perturbed runs."""
    rows = []
    for name, fault in _FAULTS.items():
        scores = [faulty(fault, seed).score.values for seed in range(6)]
        largest = [max(one[key] or 0.0 for one in scores) for key in ("stop_error_m", "punctuality_s")]
        rows.append(row(name, *(f"{value:.2f}" for value in largest)))
    return rows


_BUS: dict[str, tuple[type[TrnPos] | type[BalisePassed], Fault]] = {
    "TRN_POS silent for 0.6 s at 60 s": (TrnPos, silent(60, 60.6)),
    "odometer 20 m short for 0.5 s at 170 s": (TrnPos, changed(170, 170.5, off_mm=-20_000)),
    "TRN_POS silent from 60 to 65 s": (TrnPos, silent(60, 65)),
    "every balise 2 s late": (BalisePassed, late(2)),
    "TRN_POS silent from 150 s on": (TrnPos, silent(150)),
    "odometer 20 m short from 170 s on": (TrnPos, changed(170, off_mm=-20_000)),
    "TRN_POS silent from 185 s on": (TrnPos, silent(185)),
}


def faults_on_the_bus() -> Sequence[str]:
    """Six runs, with the ladder."""
    rows = []
    for name, (kind, fault) in _BUS.items():
        stops, times, braked, ended = [], [], [], False
        for seed in range(6):
            with tempfile.TemporaryDirectory(prefix="railhil-documents-") as folder:
                run = run_with(Path(folder), kind, fault, load(WORN), seed=seed)
            at_s, modes = run.trace.times_s(NotchCmd.PORT), run.trace.raw(NotchCmd.PORT, "CtlMode")
            brake_s = at_s[modes == CtlMode.SERVICE_BRAKE]
            braked += [brake_s[0], brake_s[-1]] if len(brake_s) else []
            ended |= len(brake_s) > 0 and modes[-1] == CtlMode.SERVICE_BRAKE
            stops.append(run.score.signed["stop_error_m"] or 0.0)
            times.append(run.score.values["punctuality_s"] or 0.0)
        digits = 3 if max(map(abs, stops)) < 1 else 1 if max(map(abs, stops)) < 10 else 0
        ladder = "NORMAL"
        if braked:
            ladder = (
                "SERVICE BRAKE to the end" if ended else f"SERVICE BRAKE from {min(braked):.1f} to {max(braked):.1f} s"
            )
        rows.append(
            row(
                name, f"{min(stops):.{digits}f} to {max(stops):.{digits}f}",
                "-" if ended else f"up to {max(times):.2f}", ladder,
            )
        )  # fmt: skip
    return rows


def cost() -> Sequence[str]:
    """Cycles and memory of IPFC+."""
    ram, constants = memory_words("ipfc_plus")
    return (
        f"estimated {cycles('ipfc_plus')} C28x cycles a step in RAM (IPFC {cycles('ipfc')})",
        f"{ram} words of RAM, {constants} words of constants",
    )


def stop_cost() -> Sequence[str]:
    """Cycles and memory of IPFC+ with its end phase."""
    ram, constants = memory_words("ipfc_plus_stop")
    return (
        f"{cycles('ipfc_plus_stop')} C28x cycles a step in RAM (IPFC+ {cycles('ipfc_plus')}), {ram} words of RAM and "
        f"{constants} words of constants.",
    )
