"""Papers with one run of 4 s."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from railhil.library import Outcome
from railhil.reproduce.paper import FOLLOWS_NOT, OPEN, Line, Paper, Planned, Results, Statement, Table
from railhil.scenarios.run_spec import LawSpec, RunSpec

#: 2 m in 4 s.
SETTINGS = (
    "target.nodes_s_mps2=[[0, 0.5], [1.9, 0.5], [2.1, -0.5], [4, -0.5]]",
    "plan.distance_m=1.9983",
    "plan.running_time_s=4",
    "plan.overtime_max_s=1",
)
#: Their names and records, for the command.
PAPERS = {name: f"hil_tests.support.short_paper:{name.upper()}" for name in ("short", "late", "bare", "lost")}


def planned(seeds: Sequence[int]) -> list[Planned]:
    return [
        Planned(f"run-{seed}", RunSpec(settings=SETTINGS, law=LawSpec("tpfc1"), seed=seed, bus="local"), drawn=True)
        for seed in seeds
    ]


def measure(outcome: Outcome) -> Mapping[str, float | None]:
    return outcome.scores


def curves(outcome: Outcome) -> int:
    return len(outcome.signals["time_s"])


def tables(results: Results) -> list[Table]:
    keys = list(results.runs)
    lines = tuple(
        Line(item, "energy", "kJ", 1, published, (results.over(keys, "energy_kj"),))
        for item, published in (("tpfc1", 100.0), ("other", None))
    )
    return [Table("table_1", "Table 1", ("bench",), lines, "A note.")]


def statements(results: Results) -> list[Statement]:
    return [
        Statement("Table 1", "it takes 100 kJ.", "another energy.", FOLLOWS_NOT, "The run is short."),
        Statement("Sect. 1", "it is good.", "nothing.", OPEN),
    ]


def figures(results: Results) -> list[object]:
    return []


SHORT = Paper(
    name="short",
    title="A short run",
    source="Nobody, 2026",
    protocol=("One run.",),
    seeds=(3,),
    planned=planned,
    measure=measure,
    curves=curves,
    tables=tables,
    statements=statements,
    figures=figures,
)


def late(seeds: Sequence[int]) -> list[Planned]:
    return [replace(one, spec=replace(one.spec, faults=("TRN_SPEED loss 30% @1000s",))) for one in planned(seeds)]


def lost(seeds: Sequence[int]) -> list[Planned]:
    return [replace(one, spec=replace(one.spec, scenario="not there")) for one in planned(seeds)]


def no_library(results: Results) -> list[object]:
    raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")


#: Its run is INVALID: the fault never begins.
LATE = replace(SHORT, name="late", planned=late)
#: Its figures need a library that is not installed.
BARE = replace(SHORT, name="bare", figures=no_library)
#: There is no such scenario.
LOST = replace(SHORT, name="lost", planned=lost)
