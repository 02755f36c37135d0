"""``railhil.hunt``: a hunt as a function, and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from railhil.charts.notebook import html_cell, html_paragraph
from railhil.common.command_line import USUAL_SCENARIO
from railhil.common.digits import count_of
from railhil.common.extras import need
from railhil.common.library_call import (
    FILES,
    JOBS,
    PATH,
    PATH_OR_NONE,
    SETTINGS,
    TEXTS,
    Kind,
    is_path,
    library_call,
)
from railhil.hunt.draws import draws_sentence
from railhil.hunt.found import FOUND
from railhil.hunt.show import summary_lines
from railhil.run.spec import Files, Settings, Texts, named_laws, requirement_names, settings_of, texts_of
from railhil.scenarios.load import stable_name

_YES_OR_NO = Kind("True or False", lambda value: isinstance(value, bool))


@dataclass(frozen=True, slots=True)
class Searched:
    """What the runs of a hunt made of one requirement.

    ``verdict``: violated, not found, or says nothing. ``margin``: the nearest, in ``unit``; None: no run has one.
    ``instant_s``: where that run has it. ``runs``: that were judged by it; ``antecedent_met``: in how many of them it
    said something. ``slack_s``: least time that a reaction left of the allowed time. ``violations``: runs.
    """

    id: str
    says: str
    verdict: str
    margin: float | None = None
    unit: str | None = None
    instant_s: float | None = None
    runs: int = 0
    antecedent_met: int = 0
    slack_s: float | None = None
    violations: int = 0

    @classmethod
    def from_summary(cls, entry: Mapping[str, Any]) -> Self:
        """As ``summary.json`` has it."""
        values = {name: entry[name] for name in cls.__slots__ if name in entry}
        return cls(**values, slack_s=entry.get("slack"))

    @property
    def violated(self) -> bool:
        """Whether a run has violated it."""
        return self.verdict == "violated"


@dataclass(frozen=True, slots=True)
class FoundCase:
    """The least case of a requirement: its faults, the seed of its run, the scenario file that repeats it, its run
    folder, how it violates the requirement, the hash of its frames, and its draws."""

    requirement: str
    faults: tuple[str, ...]
    seed: int
    file: Path
    folder: Path
    said: str
    frames_sha256: str
    draws: tuple[float, ...] = ()

    def __str__(self) -> str:
        by = "; ".join([*self.faults, *[draws_sentence(self.draws)] * bool(self.draws)]) or "no fault at all"
        return f"{self.requirement} by {by} ({self.file})"


@dataclass(frozen=True)
class HuntOutcome:
    """A finished hunt: ``summary`` is the content of its ``summary.json`` with the least cases as ``found``."""

    folder: Path
    summary: Mapping[str, Any]

    @property
    def violated(self) -> tuple[str, ...]:
        """Ids of the violated requirements; empty: none was found, which is not absence."""
        return tuple(name for name, one in self.requirements.items() if one.violated)

    @cached_property
    def requirements(self) -> Mapping[str, Searched]:
        """What was found of each requirement, by id."""
        return {one["id"]: Searched.from_summary(one) for one in self.summary["requirements"]}

    @cached_property
    def cases(self) -> tuple[FoundCase, ...]:
        """The least case of each class."""
        place = self.folder / FOUND
        return tuple(
            FoundCase(
                one["id"], tuple(one["faults"]), one["seed"], place / f"{one['name']}.toml", place / one["name"],
                one["says"], one["frames_sha256"], tuple(one["draws"]),
            )
            for one in self.summary["found"]
        )  # fmt: skip

    def __repr__(self) -> str:
        """In a line, the least cases first: an assertion shows its beginning."""
        found = "; ".join(map(str, self.cases)) or "not found"
        if self.cases:
            found = f"violated: {found}"
        runs = count_of(self.summary["runs"], "run")
        return f"<{found}; hunt of {self.summary['scenario']}, {runs}, seed {self.summary['seed']}; {self.folder}>"

    def _repr_html_(self) -> str:
        return html_cell(*map(html_paragraph, (*summary_lines(self.summary), *map(str, self.cases))))


def _is_named(controller: Any) -> bool:
    return is_path(controller) or callable(controller)


@library_call(
    "railhil.hunt",
    {
        "scenario": PATH,
        "requirements": FILES,
        "only": TEXTS,
        "controller": Kind(
            "the name of a law, FILE:NAME, or a function or class", lambda value: value is None or _is_named(value)
        ),
        "settings": SETTINGS,
        "shrink": _YES_OR_NO,
        "tighten": _YES_OR_NO,
        "jobs": JOBS,
        "out": PATH_OR_NONE,
    },
    {"--set": "settings"},
)
def hunt(
    scenario: str | Path = USUAL_SCENARIO,
    *,
    requirements: Files = (),
    only: Texts = (),
    controller: str | Path | Callable[..., Any] | None = None,
    arithmetic: str | None = None,
    settings: Settings = (),
    runs: int = 2000,
    seed: int = 0,
    strategy: str = "auto",
    shrink: bool = True,
    tighten: bool = False,
    jobs: int = 1,
    out: str | Path | None = None,
) -> HuntOutcome:
    """Search for faults that violate a requirement, and shrink them to the least ones (needs the extra ``campaign``).

    :param scenario: shipped name, or path of a TOML file.
    :param requirements: files of sentences, or names of systems that ship one; the rules of every run are always
        searched for.
    :param only: ids of requirements, or their beginnings; empty: all.
    :param controller: name of a law, text of a controller of your own such as ``mine.py:step``, or a function or class
        at the top of a file; None: the usual one of the scenario's system.
    :param arithmetic: of the law; None: the usual one.
    :param settings: keys of the scenario with other values: a mapping, or texts ``KEY=VALUE``.
    :param runs: of the search.
    :param seed: of the cases.
    :param strategy: how cases are made.
    :param shrink: whether the first violations are made smaller.
    :param tighten: whether the tightest bounds that held are stated, as ``summary["tight"]``.
    :param jobs: processes; -1: one per core. A script that begins a hunt when it is imported must not do so again in
        them (``if __name__ == "__main__"``).
    :param out: its folder (default ``runs/<utc>-<scenario>-hunt``); an incomplete hunt is resumed.
    :raises InputError: anything that is not allowed, in one line.
    """
    need("pyarrow", "campaign")
    from railhil.hunt.plan import Request
    from railhil.hunt.study import HUNT
    from railhil.study.call import make_study

    (text,), code = (("",), {}) if controller is None else named_laws(controller, "railhil.hunt", "controller")
    request = Request(
        scenario=stable_name(str(scenario)),
        settings=settings_of(settings),
        requirements=requirement_names(requirements),
        only=texts_of(only),
        controller=text,
        arithmetic=arithmetic or "",
        runs=runs,
        seed=seed,
        strategy=strategy,
        no_shrink=not shrink,
        tighten=tighten,
    )
    _, made = make_study(HUNT, request, jobs, out, code)
    return HuntOutcome(made.folder, made.summary)
