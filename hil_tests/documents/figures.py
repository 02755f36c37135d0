"""Runs of which several pages print figures, each made once; and how figures are written."""

from __future__ import annotations

import importlib
import json
import re
import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.support.paths import ROOT
from railhil.batch import Batch, Case
from railhil.batch.statistics import estimate
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import run_batch

LVSHUN = "lvshun_tieshan"
WORN = "lvshun_tieshan_worn_wheels"
#: The perturbed runs of most tables.
SEEDS = range(1000, 1200)
#: Laws in the order of the paper's table, then ours.
LAWS = ("ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop")
TUNED = ROOT / "controller_node/ato/tuned" / LVSHUN


def computed(name: str) -> Sequence[str]:
    """Rows or pieces of text with the true figures, by the function of this name: ``laws.nominal``.

    :raises ImportError, AttributeError: there is none.
    """
    module, _, function = name.partition(".")
    found: Sequence[str] = getattr(importlib.import_module(f"hil_tests.documents.{module}"), function)()
    return found


@dataclass(frozen=True)
class Nominal:
    """A run over the nodes, and what it says of its fixed point."""

    outcome: railhil.Outcome
    telemetry: Mapping[str, Any]

    def __getitem__(self, name: str) -> float:
        """A score, infinite without one; with its sign if it has one."""
        value = self.outcome.signed.get(name, self.outcome.scores.get(name))
        return float("inf") if value is None else value


@cache
def _nominal(scenario: str, law: str, arithmetic: str, given: tuple[tuple[str, Any], ...]) -> Nominal:
    with tempfile.TemporaryDirectory(prefix="railhil-documents-") as folder:
        out = Path(folder) / "run"
        outcome = railhil.run(scenario, controller=law, arithmetic=arithmetic, out=out, **dict(given))
        # Read now: the folder goes away.
        assert outcome.signals is not None
        return Nominal(outcome, json.loads((out / "telemetry.json").read_text("utf-8")))


def nominal(law: str = "ipfc", scenario: str = LVSHUN, arithmetic: str = "iq", **given: Any) -> Nominal:
    """A run as of ``railhil run``, with the arguments of :func:`railhil.run` that can be hashed."""
    return _nominal(scenario, law, arithmetic, tuple(sorted(given.items())))


@cache
def _batch(
    scenario: str, law: str, arithmetic: str, indexing: str, seeds: range, perturbed: bool, changed: Any, settings: Any
) -> Batch:
    parameters = load_parameters(changed) if isinstance(changed, Path) else None
    if changed and parameters is None:
        parameters = ParameterSet(law, dict(changed), Path(law))
    case = Case(load(scenario, settings), LawSpec(law, arithmetic, indexing, parameters=parameters), perturbed)
    return run_batch(case, seeds, keep_notches=True)


def batch(
    law: str,
    scenario: str = LVSHUN,
    arithmetic: str = "iq",
    *,
    indexing: str = "time",
    seeds: range = SEEDS,
    perturbed: bool = True,
    settings: Sequence[str] = (),
    file: Path | None = None,
    **parameters: Any,
) -> Batch:
    """Runs of a law, with some parameters changed or with those of a file."""
    changed = file or tuple(sorted(parameters.items()))
    return _batch(scenario, law, arithmetic, indexing, seeds, perturbed, changed, tuple(settings))


def tuned(law: str) -> Path:
    """The shipped file of its tuned parameters."""
    return TUNED / f"{law}.toml"


def _errors(result: Batch, name: str) -> NDArray[np.float64]:
    return np.abs(result.values[name])


def median(result: Batch, name: str) -> float:
    """Of a score, as in a campaign's table: a run that did not stop counts as infinitely bad."""
    return estimate(_errors(result, name), 0.5).value


def p95(result: Batch, name: str) -> float:
    """95th percentile of a score."""
    return estimate(_errors(result, name), 0.95).value


def both(result: Batch, name: str, digits: int) -> str:
    """Median and 95th percentile."""
    return f"{median(result, name):.{digits}f} / {p95(result, name):.{digits}f}"


def within(result: Batch, limit_m: float) -> float:
    """Percentage of the runs that stopped within so many metres."""
    return 100 * float(np.mean(np.nan_to_num(_errors(result, "stop_error_m"), nan=np.inf) <= limit_m))


def passed(result: Batch) -> int:
    """Number of runs with PASS."""
    return int(np.count_nonzero(result.passed))


def percent(result: Batch) -> str:
    """Percentage of runs with PASS."""
    return f"{100 * passed(result) / len(result.passed):g} %"


@cache
def document(*words: str) -> Any:
    """What a command prints with ``--json``; it may end with a verdict."""
    with tempfile.TemporaryDirectory(prefix="railhil-documents-") as folder:
        done = command(*words, "--json", cwd=Path(folder))
    assert done.exit_code in (0, 1), done.err
    return done.json


@cache
def memory_words(law: str) -> tuple[str, str]:
    """Words of RAM and of constants of an exported law, as ``railhil export-c`` prints them."""
    with tempfile.TemporaryDirectory(prefix="railhil-documents-") as folder:
        said = command("export-c", law, "--out", str(Path(folder) / law)).out
    found = re.search(r"(\d+) words of RAM, (\d+) words of constants", said)
    assert found is not None, said
    return found[1], found[2]


def tuning_notes(file: Path) -> Mapping[str, Any]:
    """What a parameter file says of how it was made."""
    notes: Mapping[str, Any] = tomllib.loads(file.read_text("utf-8"))["training"]["notes"]
    return notes


def cycles(law: str) -> int:
    """C28x cycles of a step with the program in RAM."""
    return int(nominal(law).telemetry["cycles"]["ram"])


def equal_codes(law: str, arithmetic: str = "iq") -> str:
    """Percentage of the notch codes equal to those of float64 (``railhil audit``)."""
    found = document("audit", LVSHUN, "--controller", law, "--arithmetic", arithmetic, "--runs", "0")
    return f"{100 * found['commands']['notch']['equal_share']:.2f} %"


def row(*cells: object) -> str:
    """A line of a table."""
    return " ".join(["|", *(f"{cell} |" if str(cell) else "|" for cell in cells)])
