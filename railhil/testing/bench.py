"""The bench as a test sees it: runs on the bus of the session, their folders, their health."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil import library
from railhil.common.command_line import USUAL_SCENARIO
from railhil.common.errors import InputError, Words
from railhil.record.documents import CERTIFICATE
from railhil.record.hash_list import REPORT
from railhil.run.report import report_line
from railhil.run.spec import bus_of, checked_spec, spec_of, with_requirements
from railhil.scenarios.run_spec import RunSpec
from railhil.testing.live import Live
from railhil.testing.result import Run
from railhil.testing.settings import Settings

if TYPE_CHECKING:
    from railhil.hunt.outcome import HuntOutcome

#: Arguments of a run that a hunt takes, too.
_HUNTED = ("scenario", "controller", "arithmetic", "settings")
_USUAL: Mapping[str, Any] = {
    "controller": None,
    "arithmetic": None,
    "indexing": "time",
    "parameters": None,
    "settings": (),
    "faults": (),
    "memory": None,
    "run_number": 1,
}


class Bench:
    """Makes runs.

    :param usual: arguments of :meth:`run` that the test's markers give.
    :param beside: folder of the test's file: a scenario file there is found by its name.
    :param runs: folder for the run folders, which is made.
    :param name: of the first run folder.
    :param required: names and sentences by which each run is judged.
    """

    def __init__(
        self,
        settings: Settings,
        usual: Mapping[str, Any],
        beside: Path,
        runs: Path,
        name: str,
        required: Sequence[tuple[str, str]] = (),
    ) -> None:
        self.settings = settings
        self._required = tuple(required)
        #: Finished runs of this test, in their order.
        self.runs: list[Run] = []
        #: Finished hunts of this test, in their order.
        self.hunts: list[HuntOutcome] = []
        self._usual = usual
        self._beside = beside
        self._folder = runs
        self._name = name
        self._live: list[Live] = []

    def run(self, *, seed: int = 0, perturbed: bool = False, **spec: Any) -> Run:
        """One run to its end, recorded and judged.

        :param spec: further arguments of :func:`railhil.run`, such as ``scenario``, ``controller``, ``settings``,
            ``faults``; they override the marker ``railhil``.
        :raises InputError: an argument is not allowed; one line.
        :raises NeverBegan: the nodes refused the run, or no frame came.
        """
        given = self._given(seed, perturbed, spec)
        asked = self._judged(spec_of(given.pop("scenario"), pace=self.settings.pace, bus=self._kind, **given))
        made = self._on_target(asked)
        bus, foreign = self.settings.bus, self.settings.no_controller
        run = Run(library.run(made, bus=bus, no_controller=foreign, out=self._new_folder()))
        self.runs.append(run)
        return run

    def start(self, *, seed: int = 0, perturbed: bool = False, **spec: Any) -> Live:
        """A run whose clock the test holds; arguments as in :meth:`run`. Always in this process.

        :raises InputError: an argument is not allowed, or the session has a bus whose clock the test cannot hold.
        """
        if self.settings.bus != "local":
            found = self.settings.bus
            raise InputError("bench.start", "bus", found, "local: on a bus the test does not hold the clock")
        given = self._given(seed, perturbed, spec)
        asked = with_requirements(self._judged(spec_of(given.pop("scenario"), bus="local", **given)), ())
        made, scenario = checked_spec(self._on_target(asked))
        folder = self._new_folder()
        live = Live(made, scenario, folder, self.runs.append)
        self._live.append(live)
        return live

    def hunt(
        self,
        *,
        runs: int = 200,
        seed: int = 0,
        requirements: str | Path | Sequence[str | Path] = (),
        only: str | Sequence[str] = (),
        strategy: str = "auto",
        jobs: int = 1,
        **spec: Any,
    ) -> HuntOutcome:
        """A search for faults that violate a requirement, always in processes of this machine.

        :param requirements: files, also those beside the test's file, or names of systems; the rules of every run are
            always searched for. Further arguments are those of :func:`railhil.hunt`.
        :param spec: ``scenario``, ``controller``, ``arithmetic``, ``settings``; they override the marker ``railhil``.
        :raises InputError: an argument is not allowed, or the controller is a board or another program.
        """
        from railhil.hunt.outcome import hunt

        given = self._given(seed, False, spec)
        for name in ("target", "no_controller"):
            if getattr(self.settings, name):
                allowed = "a session whose controller is railhil's: a hunt makes its runs in this machine"
                raise InputError("bench.hunt", name.replace("_", "-"), getattr(self.settings, name), allowed)
        for name, usual in _USUAL.items():
            if name not in _HUNTED and given[name] != usual:
                raise InputError("bench.hunt", name, given[name], f"only {', '.join(_HUNTED)} of a run's arguments")
        files = [requirements] if isinstance(requirements, str | Path) else requirements
        beside = [self._beside / name if (self._beside / name).is_file() else name for name in files]
        found = hunt(
            **{name: given[name] for name in _HUNTED}, requirements=beside, only=only, runs=runs, seed=seed,
            strategy=strategy, jobs=jobs, out=self._new_folder(),
        )  # fmt: skip
        self.hunts.append(found)
        return found

    def _judged(self, spec: RunSpec) -> RunSpec:
        """The run, judged by the sentences that the test requires."""
        if not self._required:
            return spec
        from railhil.testing.required import required_tables

        return replace(spec, requirements=(*spec.requirements, *required_tables(self._required)))

    def _on_target(self, spec: RunSpec) -> RunSpec:
        """The run with its law, or its C controller, on the target of the session."""
        if not self.settings.target:
            return spec
        from railhil.testing.target import on_target

        return on_target(spec, self.settings.target, self._folder / "exports")

    @property
    def _kind(self) -> str:
        """The kind of bus in the description of a run."""
        return bus_of(self.settings.bus, "--railhil-bus")[0]

    def _given(self, seed: int, perturbed: bool, spec: Mapping[str, Any]) -> dict[str, Any]:
        """All arguments of :func:`railhil.run.spec.spec_of`, except bus and pace."""
        given = {"scenario": USUAL_SCENARIO, **_USUAL, **self._usual, **spec}
        if unknown := given.keys() - {"scenario", *_USUAL}:
            allowed = ", ".join(("seed", "perturbed", "scenario", *_USUAL))
            raise InputError("bench", sorted(unknown)[0], Words("no such argument"), allowed)
        scenario = str(given["scenario"])
        if scenario.endswith(".toml") and (self._beside / scenario).is_file():
            given["scenario"] = self._beside / scenario
        return {**given, "seed": seed, "perturbed": perturbed}

    def _new_folder(self) -> Path:
        """A folder of its own for the next run; the first has the test's name, others a number after it."""
        self._folder.mkdir(parents=True, exist_ok=True)
        serial = 1
        while True:
            folder = self._folder / (self._name if serial == 1 else f"{self._name}-{serial}")
            try:
                folder.mkdir()
            except FileExistsError:
                serial += 1
            else:
                return folder

    def close(self) -> None:
        """End the runs that have begun and not ended."""
        for live in self._live:
            live.close()

    @property
    def disturbances(self) -> list[str]:
        """One line for each run without faults in which frames were lost, refused or reordered."""
        found = [(run.folder, run.disturbed) for run in self.runs if not run.faults]
        return [f"{folder}: {_counted(causes)}" for folder, causes in found if causes]

    def facts(self) -> list[tuple[str, str]]:
        """Properties of the finished runs for the JUnit report; properties of the second run have ``.2`` after their
        names."""
        found = []
        for number, run in enumerate(self.runs, 1):
            end = "" if number == 1 else f".{number}"
            spec = run.spec
            own = {"controller": spec.law.label, "arithmetic": spec.law.arithmetic}
            own |= {key: run.certificate[key] for key in run.certificate.get("asked") or {} if key in own}
            facts = {
                "scenario": run.outcome.scenario.name,
                **own,
                "seed": spec.seed,
                "fault": "; ".join(spec.faults),
                "verdict": run.verdict,
                "frames_sha256": run.frames_sha256,
                "certificate": run.folder / CERTIFICATE,
            }
            found += [(name + end, str(value)) for name, value in facts.items() if value != ""]
        for number, hunt in enumerate(self.hunts, 1):
            end = "" if number == 1 else f".{number}"
            found += [(f"hunt{end}", repr(hunt))]
            found += [(f"hunt{end}.frames_sha256", case.frames_sha256) for case in hunt.cases]
        return found

    def reported(self, note: str) -> list[str]:
        """Write the report of each run, for a test that has failed; lines that attach it, and the least cases and the
        page of each hunt, to the test in a CI server.

        :param note: sentence in each report.
        """
        lines = []
        for hunt in self.hunts:
            files = [case.file for case in hunt.cases]
            lines += [repr(hunt), *(f"[[ATTACHMENT|{path.resolve()}]]" for path in (*files, hunt.folder / REPORT))]
        for run in self.runs:
            lines.append(f"run folder {run.folder}: {run.verdict} {'; '.join(run.reasons)}".rstrip())
            line = report_line([run.outcome], run.folder, [note])
            report = (run.folder / REPORT).resolve()
            lines.append(f"[[ATTACHMENT|{report}]]" if report.is_file() else line)
        return lines

    def keep_certificates(self) -> None:
        """Keep only the certificate of each run folder; ``railhil rerun`` makes the rest again from it."""
        for run in self.runs:
            for path in run.folder.iterdir():
                if path.name != CERTIFICATE:
                    shutil.rmtree(path) if path.is_dir() else path.unlink()


def _counted(causes: Mapping[str, int]) -> str:
    return ", ".join(f"{cause} {count}" for cause, count in causes.items())
