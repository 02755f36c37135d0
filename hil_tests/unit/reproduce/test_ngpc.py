"""Tables and statements of the papers on high-speed trains, on made-up runs."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

from railhil.controller_node.laws import find
from railhil.reproduce.ngpc import PAPER, names
from railhil.reproduce.ngpc.names import ADAPTIVE, BP, ELM, EMERGENCY, LAWS, MULTI_MODEL, MUTATION, NORMAL
from railhil.reproduce.ngpc.runs import Drawable
from railhil.reproduce.ngpc.statements import statements
from railhil.reproduce.ngpc.tables import tables
from railhil.reproduce.paper import FOLLOWS, FOLLOWS_NOT, IN_PART, Measured, Results
from railhil.scenarios.load import load_any
from railhil.scenarios.system import system_named

SEEDS = (1, 2)
Figures = dict[str, float | None]
#: As the paper has it: the first of the laws is the best in everything.
RANK = {law: place for place, law in enumerate((ELM, MULTI_MODEL, ADAPTIVE, BP, *LAWS[4:]))}


def made(figure: Callable[[str, str, int], Figures], **beside: Figures) -> Results:
    """Runs with the figures of (situation, law, seed); of each record, models four times as good with the network."""
    runs = {
        names.key(situation, law, seed): figure(situation, law, seed)
        for situation in (NORMAL, EMERGENCY, MUTATION)
        for law in LAWS
        for seed in SEEDS
    }
    for seed in SEEDS:
        errors = (("linear", 0.8), ("integrated", 0.2))
        runs[names.record_key(seed)] = {
            names.model_error(kind, period_s): value for kind, value in errors for period_s in names.PERIODS_S
        }
    for law in LAWS:
        runs[names.effort_key(law)] = {names.CYCLES: 1000.0 * (1 + RANK[law])}
    runs |= beside
    return Results(SEEDS, {name: Measured(name, "PASS", (), "0" * 64, values) for name, values in runs.items()})


def as_published(situation: str, law: str, seed: int) -> Figures:
    error = 0.1 + 0.1 * RANK[law] + 0.01 * seed
    stop_m = 4390.0 + 10 * RANK[law] if situation == EMERGENCY else None
    found = dict.fromkeys((*names.RMSE.values(), names.WIDEST), error)
    return {**found, names.STOP_M: stop_m}


def test_each_run_has_its_scenario_and_its_law() -> None:
    planned = PAPER.planned(PAPER.seeds)
    assert len({one.key for one in planned}) == len(planned) == 5 * (3 * len(LAWS) + 1) + len(LAWS)
    for scenario, law in {(one.spec.scenario, one.spec.law.controller) for one in planned}:
        system_named(load_any(scenario).system).check_law(law, scenario, "law")


def test_statements_follow_from_runs_as_the_paper_has_them() -> None:
    found = statements(made(as_published))
    assert len(found) == 8
    assert {one.verdict for one in found} == {FOLLOWS}


def test_statements_do_not_follow_from_the_opposite() -> None:
    def worse(situation: str, law: str, seed: int) -> Figures:
        return {
            name: None if value is None else 10_000 - value
            for name, value in as_published(situation, law, seed).items()
        }

    slowest: Figures = {names.CYCLES: 1e6}
    verdicts = [one.verdict for one in statements(made(worse, **{names.effort_key(ELM): slowest}))]
    # The models are as before.
    assert verdicts == [FOLLOWS, *[FOLLOWS_NOT] * 7]


def test_least_effort_of_one_of_two_follows_in_part() -> None:
    quick: Figures = {names.CYCLES: 100.0}
    assert statements(made(as_published, **{names.effort_key(ADAPTIVE): quick}))[-1].verdict == IN_PART


@pytest.mark.slow
def test_each_situation_has_its_picture() -> None:
    found = made(as_published)
    place_m = np.linspace(209e3, 215e3, 50)
    drawn = Drawable(place_m, np.full(50, 300.0), np.full(50, 299.0), np.full(50, -1.0))
    runs = {name: replace(run, curves=drawn) for name, run in found.runs.items()}
    pictures = PAPER.figures(Results(SEEDS, runs))
    assert [one.name for one in pictures] == ["figures_8_9", "figures_10_11", "figures_12_13"]
    for one in pictures:
        assert all(f">{law}<" in one.svg for law in LAWS)


def test_readings_name_parameters_that_the_laws_have() -> None:
    law = find(ELM, system_named("hst1").laws)
    known = {item.name for item in fields(law.parameters_type)}
    named = re.findall(r"`([a-z_]+)(?: = [^`]*)?`", " ".join(f"{one.reading} {one.other}" for one in PAPER.readings()))
    assert set(named) <= known
    assert {"ident", "ident_error", "discretisation", "weighting", "reference_start"} <= set(named)


def test_a_law_that_never_stops() -> None:
    def endless(situation: str, law: str, seed: int) -> Figures:
        return {**as_published(situation, law, seed), names.STOP_M: None}

    said = {one.claim: one for one in statements(made(endless))}
    stop = next(one for claim, one in said.items() if "emergency stop takes" in claim)
    assert (stop.verdict, stop.measured) == (FOLLOWS_NOT, "- m.")


def test_printed_figures_stand_beside_the_measured_ones() -> None:
    modelling, tracking, stop, effort = tables(made(as_published))
    assert [line.published_shown for line in modelling.lines] == ["1.454", "0.1653", "8.80"]
    assert modelling.lines[2].measured == pytest.approx((4.0,) * 4)
    assert not tracking.is_published
    assert len(tracking.lines) == 3 * 2 * len(LAWS)
    assert tracking.lines[0].measured == pytest.approx((0.115, 0.11, 0.12))
    assert [line.published for line in stop.lines] == [4400.0, *[None] * (len(LAWS) - 1)]
    assert [line.published_shown for line in effort.lines] == ["5.47", "4.33"]
    assert [line.measured for line in effort.lines] == [(4.0,), (3.0,)]
