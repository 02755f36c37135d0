"""Papers with one run of 4 s."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from railhil.charts.figure import Chart, Figure
from railhil.library import Outcome
from railhil.reproduce.comparison import Line, Statement, Table
from railhil.reproduce.paper import Entry, Paper, Results, Text
from railhil.scenarios.run_spec import LawSpec, RunSpec

#: 2 m in 4 s.
SETTINGS = (
    "target.nodes_s_mps2=[[0, 0.5], [1.9, 0.5], [2.1, -0.5], [4, -0.5]]",
    "plan.distance_m=1.9983",
    "plan.running_time_s=4",
    "plan.overtime_max_s=1",
)
#: Their names and records, for the command.
PAPERS = {name: f"hil_tests.support.short_paper:{name.upper()}" for name in ("short", "late", "lost")}


TEXT = Text(
    title="A short run",
    source="Nobody, 2026",
    protocol=("One run.",),
    seeds=(3,),
    tables={"table_1": {"title": "Table 1", "note": "A note."}},
    statements={
        "energy": {"at": "Table 1", "claim": "it takes 100 kJ.", "why": "The run is short."},
        "quality": {"at": "Sect. 1", "claim": "it is good."},
    },
)


def plan(seeds: Sequence[int]) -> list[Entry]:
    return [
        Entry(f"run-{seed}", RunSpec(settings=SETTINGS, law=LawSpec("tpfc1"), seed=seed, bus="local"), drawn=True)
        for seed in seeds
    ]


def measure(outcome: Outcome) -> Mapping[str, float | None]:
    return outcome.scores


def curves(outcome: Outcome) -> int:
    return len(outcome.signals["time_s"])


def compare(results: Results) -> list[Table]:
    keys = list(results.runs)
    lines = tuple(
        Line(item, "energy", "kJ", 1, published, (results.reduce(keys, "energy_kj"),))
        for item, published in (("tpfc1", 100.0), ("other", None))
    )
    return [TEXT.table("table_1", ("bench",), lines)]


def judge(results: Results) -> list[Statement]:
    return [
        TEXT.judge("energy", results, [], "another energy.", [False]),
        TEXT.judge("quality", results, [], "nothing.", []),
    ]


def draw(results: Results) -> list[Figure]:
    return [Figure("figure_1", "Figure 1", "Nothing is drawn.", [Chart()])]


SHORT = Paper(
    name="short",
    text=TEXT,
    plan=plan,
    measure=measure,
    compare=compare,
    judge=judge,
    draw=draw,
    curves=curves,
)


def late(seeds: Sequence[int]) -> list[Entry]:
    return [replace(one, spec=replace(one.spec, faults=("TRN_SPEED loss 30% @1000s",))) for one in plan(seeds)]


def lost(seeds: Sequence[int]) -> list[Entry]:
    return [replace(one, spec=replace(one.spec, scenario="not there")) for one in plan(seeds)]


#: Its run is INVALID: the fault never begins.
LATE = replace(SHORT, name="late", plan=late)
#: There is no such scenario.
LOST = replace(SHORT, name="lost", plan=lost)
