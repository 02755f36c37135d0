"""Tables and statements of the papers on high-speed trains, on made-up runs."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.controller_node.laws import find
from railhil.library import Outcome
from railhil.report.pictures import printed
from railhil.reproduce.comparison import FOLLOWS, FOLLOWS_NOT, IN_PART, OPEN
from railhil.reproduce.experiments import SingleRun
from railhil.reproduce.measurement import measure_paper
from railhil.reproduce.ngpc import PAPER, runs
from railhil.reproduce.ngpc.runs import (
    ADAPTIVE,
    BP,
    ELM,
    EMERGENCY,
    LAWS,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    SITUATIONS,
    WINDOWS_S,
)
from railhil.reproduce.paper import Entry, Measurement, Results
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.systems.high_speed.ride import Ride
from railhil.wire.power_units import wire

SEEDS = (1, 2)
UNITS_PORTS = (wire(3).truth.PORT,)
Figures = dict[str, float | None]
#: As the paper has it: the first of the laws is the best in everything.
RANK = {law: place for place, law in enumerate((ELM, MULTI_MODEL, ADAPTIVE, BP, *LAWS[4:]))}


def made_alone(one: Entry) -> Measurement:
    return measure_paper(replace(PAPER, plan=lambda seeds: [one], measure=scores), (3,)).runs[one.key]


def scores(outcome: Outcome) -> Figures:
    return dict(outcome.scores)


def made(figure: Callable[[str, str, int], Figures], **beside: Figures) -> Results:
    """Runs with the figures of (situation, law, seed); of each record, models four times as good with the network."""
    found = {
        key: figure(situation, law, seed)
        for situation in SITUATIONS
        for law in runs.list_laws(situation)
        for key, seed in zip(runs.list_runs(situation, law, SEEDS), SEEDS, strict=False)
    }
    for kind, law, loop in runs.UNITS:
        kn = 1.0 if loop == "mean" else 3.0
        units: Figures = {
            runs.UNITS_RMSE: 0.1 + 0.1 * RANK[law],
            runs.SPREAD: 0.1,
            runs.COUPLER_KN: kn if kind == "coupled" else None,
        }
        found |= {runs.name_units_run(kind, law, loop, seed): units for seed in SEEDS}
    for seed in SEEDS[:1]:
        errors = (("linear", 0.8), ("integrated", 0.2))
        found[runs.name_record(seed)] = {
            runs.name_model_error(kind, period_s): value for kind, value in errors for period_s in runs.PERIODS_S
        }
    for law in LAWS:
        found[runs.name_effort_run(law)] = {runs.CYCLES: 1000.0 * (1 + RANK[law])}
    found |= beside
    return Results(SEEDS, {name: Measurement(name, "PASS", (), "0" * 64, values) for name, values in found.items()})


def as_published(situation: str, law: str, seed: int) -> Figures:
    error = 0.1 + 0.1 * RANK[law] + 0.01 * seed
    stop_m = 4390.0 + 10 * RANK[law] if situation == EMERGENCY else None
    found = dict.fromkeys((*(one["rmse"] for one in SITUATIONS.values()), runs.WIDEST), error)
    return {**found, runs.STOP_M: stop_m}


def test_main_laws_make_the_long_journeys_with_every_seed() -> None:
    keys = {one.key for one in PAPER.plan(PAPER.text.seeds)}
    often = [(EMERGENCY, law) for law in LAWS] + [(at, law) for at in (NORMAL, MUTATION) for law in runs.MAIN]
    assert {runs.name_run(at, law, seed) for at, law in often for seed in PAPER.text.seeds} <= keys


def test_statements_follow_from_runs_as_the_paper_has_them() -> None:
    found = [one for one in PAPER.judge(made(as_published)) if "bands" not in one.claim]
    assert len(found) == 11
    assert {one.verdict for one in found} == {FOLLOWS}


def test_statements_do_not_follow_from_the_opposite() -> None:
    def worse(situation: str, law: str, seed: int) -> Figures:
        return {
            name: None if value is None else 10_000 - value
            for name, value in as_published(situation, law, seed).items()
        }

    slowest: Figures = {runs.CYCLES: 1e6}
    verdicts = [one.verdict for one in PAPER.judge(made(worse, **{runs.name_effort_run(ELM): slowest}))]
    # The models and the runs with three units are as before.
    assert verdicts == [FOLLOWS, *[FOLLOWS_NOT] * 9, FOLLOWS, FOLLOWS]


def test_least_effort_of_one_of_two_follows_in_part() -> None:
    quick: Figures = {runs.CYCLES: 100.0}
    assert PAPER.judge(made(as_published, **{runs.name_effort_run(ADAPTIVE): quick}))[7].verdict == IN_PART


def test_one_loop_must_have_less_coupler_force_with_every_seed() -> None:
    weak: Figures = {runs.UNITS_RMSE: 0.1, runs.SPREAD: 0.1, runs.COUPLER_KN: 1.9}
    found = made(as_published, **{runs.name_units_run("coupled", ELM, "unit", SEEDS[1]): weak})
    said = PAPER.judge(found)[-1]
    assert said.verdict == IN_PART
    assert "elm_ngpc 2.5 kN with three loops, 1.0 kN with one (1.9 to 3.0 times)" in said.measured
    units = next(table for table in PAPER.compare(found) if table.name == "units")
    line = next(line for line in units.lines if "force" in line.quantity and line.item.startswith("elm_ngpc, a loop"))
    assert line.measured == pytest.approx((2.45, 1.9, 3.0))
    assert line.remark == "2 runs"


@pytest.mark.slow
def test_each_situation_has_its_picture() -> None:
    found = made(as_published)
    place_m = np.linspace(209e3, 215e3, 50)
    flat = np.full(50, 80.0)
    ride = Ride(None, np.arange(50.0), place_m, flat, flat, flat, flat, flat, flat, None, None)
    with_curves = {name: replace(run, curves=ride) for name, run in found.runs.items()}
    pictures = printed(PAPER.draw(Results(SEEDS, with_curves)))
    assert [one.name for one in pictures] == ["figures_8_9", "figures_10_11", "figures_12_13"]
    for one in pictures:
        assert all(f">{law}<" in one.svg for law in runs.DRAWN)


def test_readings_name_parameters_that_the_laws_have() -> None:
    law = find(ELM, system_named("hst1").laws)
    known = {item.name for item in fields(law.parameters_type)}
    named = re.findall(
        r"`([a-z_]+)(?: = [^`]*)?`", " ".join(f"{one.reading} {one.other}" for one in PAPER.text.readings)
    )
    assert set(named) <= known
    assert {"ident", "ident_error", "discretisation", "weighting", "reference_start"} <= set(named)


def test_a_law_that_never_stops() -> None:
    def endless(situation: str, law: str, seed: int) -> Figures:
        return {**as_published(situation, law, seed), runs.STOP_M: None}

    said = {one.claim: one for one in PAPER.judge(made(endless))}
    stop = next(one for claim, one in said.items() if "emergency stop takes" in claim)
    assert (stop.verdict, stop.measured) == (FOLLOWS_NOT, "- m.")


def test_printed_figures_stand_beside_the_measured_ones() -> None:
    modelling, tracking, stop, _, _, effort = PAPER.compare(made(as_published))
    assert [line.published_text for line in modelling.lines] == ["1.454", "0.1653", "8.80"]
    assert modelling.lines[2].measured == pytest.approx((4.0,) * 4)
    assert not tracking.is_published
    assert tracking.lines[0].measured == pytest.approx((0.115, 0.11, 0.12))
    assert [line.published for line in stop.lines] == [4400.0, *[None] * (len(LAWS) - 1)]
    assert [line.published_text for line in effort.lines] == ["5.47", "4.33"]
    assert [line.measured for line in effort.lines] == [(4.0,), (3.0,)]


def test_the_bands_say_on_which_side_a_mean_is_outside() -> None:
    def of_pid(rmse_kmh: float) -> str:
        def figure(situation: str, law: str, seed: int) -> Figures:
            return {**as_published(situation, law, seed), runs.WHOLE: rmse_kmh}

        lines = next(table for table in PAPER.compare(made(figure)) if table.name == "bands").lines
        return next(line.remark for line in lines if line.item == "pid, allowed 0.17 to 0.22")

    assert [of_pid(x).removesuffix(" (2 runs)") for x in (0.16, 0.17, 0.22, 0.23)] == [
        "does not hold: below",
        "holds",
        "holds",
        "does not hold: above",
    ]


def test_runs_that_were_not_made_are_no_figures() -> None:
    whole = made(as_published)
    kept = {name: run for name, run in whole.runs.items() if name == runs.name_run(NORMAL, ELM, 2)}
    part = Results(SEEDS, kept)
    tracking = PAPER.compare(part)[1]
    assert tracking.lines[0].measured == pytest.approx((0.12, 0.12, 0.12))
    assert {line.item for line in tracking.lines} == {ELM}
    assert tracking.lines[0].remark == "1 run"
    assert {one.verdict for one in PAPER.judge(part)} == {OPEN}


def test_windows_of_the_mutation_are_those_of_its_scenario() -> None:
    faults = load_any(SITUATIONS[MUTATION]["scenario"]).faults
    assert {text.split(" @")[1] for text in faults} == {f"{at}s for {long}s" for at, long in WINDOWS_S}


@pytest.mark.slow
def test_a_run_without_a_bus_has_the_scores_of_the_nodes() -> None:
    """Also if only the ports of the scores are published."""
    for system, ports in (("hst_short", ("TRUTH",)), ("emu3_short", UNITS_PORTS)):
        spec = RunSpec(
            system, ("task.duration_s=20", "task.rmse_max_kmh=9"), LawSpec("pid", "float64"), seed=3, bus="local"
        )
        one = Entry("one", spec)
        found = [made_alone(way) for way in (one, replace(one, experiment=SingleRun(ports)))]
        assert found[0].values == found[1].values
        assert [bool(run.sha256) for run in found] == [True, False]


def test_stored_figures_are_read_again_and_only_those_of_the_same_run(tmp_path: Path) -> None:
    spec = RunSpec("hst_short", ("task.duration_s=8", "task.rmse_max_kmh=9"), LawSpec("pid", "float64"), bus="local")
    planned = [Entry(name, spec, experiment=SingleRun(("TRUTH",))) for name in ("first", "second")]
    paper = replace(PAPER, plan=lambda seeds: planned, measure=scores)
    first = measure_paper(paper, (1,), measured=tmp_path, only="first")
    assert list(first.runs) == ["first"]
    stored = tmp_path / "first.json"
    stored.write_text(stored.read_text().replace('"PASS"', '"FAIL"'))
    again = measure_paper(paper, (1,), measured=tmp_path, only="second")
    assert [run.verdict for run in again.runs.values()] == ["FAIL", "PASS"]
    assert again.runs["first"].values == first.runs["first"].values
    stored.write_text(stored.read_text().replace("hst_short", "emu3_short"))
    with pytest.raises(InputError, match=r"first.json: entry: found "):
        measure_paper(paper, (1,), measured=tmp_path)
