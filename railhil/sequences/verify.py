"""Repeats sequences of ``railhil learn`` through the nodes of the bench: commands, scores and memories must agree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railhil.campaign.parts import RESULTS
from railhil.campaign.results_table import NotThePart, read_table
from railhil.campaign.results_table import row as row_of
from railhil.common.errors import InputError, Words
from railhil.record.hash_list import check_hash_list
from railhil.sequences.execute import MANIFEST, read_manifest
from railhil.sequences.one import sequence, through_nodes
from railhil.sequences.plan import make_plan
from railhil.sequences.table import row, schema


@dataclass(frozen=True, slots=True)
class Verified:
    """One run: the differences (column: without the bus, on the bench)."""

    seed: int
    run: int
    differences: Mapping[str, tuple[Any, Any]]


def code_changed(folder: Path) -> bool:
    """Whether the code has changed since, so that a difference need not be a defect. Raises InputError."""
    begun, request = read_manifest(folder)
    ours = make_plan(request).identity
    return any(begun.get(key) != ours[key] for key in ("law_sha256", "code_sha256", "learning_sha256", "system_sha256"))


def verify(folder: Path, sequences: int, draw: int) -> Iterator[Verified]:
    """Run some sequences again through the nodes and compare every run to the last digit.

    :param sequences: their number.
    :param draw: seed of the choice.
    :raises InputError: the folder has no finished work that can be repeated.
    """
    begun, request = read_manifest(folder)
    check_hash_list(folder, MANIFEST, None)
    plan = make_plan(request)
    for key in ("scenario_sha256", "parameters"):
        if begun.get(key) != plan.identity[key]:
            allowed = f"{plan.identity[key]}, what this installation would run"
            raise InputError(folder / MANIFEST, f"study.{key}", Words(str(begun.get(key))), allowed)
    try:
        table = read_table(folder / RESULTS, schema(plan.judging))
    except FileNotFoundError:
        raise InputError(folder, "", Words(f"no {RESULTS}"), "finished work (--resume finishes it)") from None
    except (OSError, NotThePart) as why:
        raise InputError(folder / RESULTS, "", Words(str(why)), "what railhil learn has written") from why
    for index in np.random.default_rng(draw).permutation(len(plan.seeds))[:sequences]:
        seed = plan.seeds[int(index)]
        for number, run in enumerate(sequence(plan.scenario, plan.specs(seed), through_nodes), 1):
            ours = row_of(table, int(index) * request.runs + number - 1)
            bench = row_of(row(seed, number, run, plan.judging), 0)
            apart = {name: (ours[name], value) for name, value in bench.items() if ours[name] != value}
            yield Verified(seed, number, apart)
