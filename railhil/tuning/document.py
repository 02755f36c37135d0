"""The parameter file that a search writes, in the format of :mod:`railhil.scenarios.parameters`."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import Any

from railhil.judge.criteria import limit_key
from railhil.judge.folder import code_sha256, made_by
from railhil.judge.rerun import code_changes
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.tomlfile import toml_table
from railhil.tuning import objective
from railhil.tuning.search import Found, Protocol
from railhil.tuning.trials import Tuning

_HEAD = "# Written by railhil tune. Parameters of the law that are not named here keep their defaults.\n"
_DIGITS = 6
#: Code on which the search depends, in addition to the bench's.
_OWN_CODE = ("batch", "bench.py", "tuning")


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _made_by(system: str, law: str) -> dict[str, str | None]:
    """:func:`railhil.judge.folder.made_by`, and the hash of the search's own code."""
    return made_by(system, law, code_sha256()) | {"tuning_sha256": code_sha256(_OWN_CODE)}


def changes(given: ParameterSet, system: str) -> list[str]:
    """One sentence for each part of the code that differs from the code that made a file; none for a file by hand."""
    return code_changes(given.notes, _made_by(system, given.law), "the search") if given.notes else []


def notes(protocol: Protocol, found: Found) -> dict[str, Any]:
    """Notes of the search about itself; without date or paths, so that the same search writes the same bytes."""
    own = _made_by(protocol.scenario.system, protocol.law.controller)
    return {
        "scenario_sha256": protocol.scenario.sha256,
        # TOML has no value for None.
        **{key: value for key, value in own.items() if value is not None},
        **protocol.law.how,
        "method": f"differential evolution of scipy {version('scipy')}",
        "search_seed": protocol.search_seed,
        "budget": protocol.budget,
        "population": protocol.population,
        "generations": protocol.generations,
        "evaluations": found.evaluations,
        "infeasible": found.infeasible,
        "at_bounds": protocol.box.at_bounds(found.values),
        "complete": found.complete,
        **({"laid_aside": found.laid_aside} if found.laid_aside else {}),
        "objective_version": objective.VERSION,
        "objective_default": _rounded(found.objective_default),
        "objective_tuned": _rounded(found.objective),
        "scale_of": Tuning.of(protocol.scenario.installed_system).scale_of,
    }


def document(protocol: Protocol, found: Found) -> str:
    """The file."""
    law, scenario, seeds = protocol.law.controller, protocol.scenario.name, frozenset(protocol.seeds)
    made = ParameterSet(law, found.values, Path(), scenario, seeds)
    terms = [*found.scale.limits, *found.scale.medians]
    scale = {limit_key(term.criterion): _rounded(term.divisor) for term in terms}
    return (
        _HEAD
        + made.text
        + toml_table("training.notes", notes(protocol, found))
        + toml_table("training.notes.scale", scale)
    )
