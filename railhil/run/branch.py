"""Branches of a run: other faults from an instant on, without making the run again up to there.

A :class:`Trunk` is a run in a process of its own that stands still at an instant. Each branch of it is a run with its
own folder, whose bytes are those of the straight run with the same faults.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from multiprocessing import Pipe
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from railhil.bus.can_settings import LOCAL
from railhil.common.errors import InputError, Sentence
from railhil.common.library_call import PATH_OR_NONE, TEXTS, Kind, is_path, library_call
from railhil.faults.language import with_condition
from railhil.judge.record import Record
from railhil.judge.rerun import certified_run, repeatable
from railhil.record.run_folder import discard_folder, run_folder
from railhil.run.make import record_run, write_results
from railhil.run.report import as_recorded
from railhil.scenarios.given import NO_CODE, NamedCode
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.settings import normalise_fault

if TYPE_CHECKING:
    from railhil.judge.result import Result

#: Numerical libraries start no threads in a trunk.
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")

_PROCESS = "from railhil.run.trunk import main; main()"


class BranchLost(Exception):
    """The process of a trunk or of a branch has died."""

    exit_code = 4


def why_straight(spec: RunSpec) -> str:
    """Reason why no branch of a run can be a fork; empty: there is none."""
    if sys.platform != "linux":
        return f"processes cannot be forked safely on {sys.platform}"
    if spec.law.given is not None:
        return "the controller is one of your own"
    if spec.plant_fmu is not None:
        return "the plant is an FMU"
    if spec.orders:
        return "the run has orders of an operator"
    return ""


def branch_straight(
    spec: RunSpec, faults: Sequence[str], folder: str | Path | None, time_s: float, why: str = "", *, keep: bool = True
) -> Result:
    """The result of a branch, by a run from the start.

    :param faults: all of the run besides the scenario's own.
    :param why: reason why it is no fork, for the certificate.
    :raises InputError: the run is not allowed.
    """
    spec = replace(spec, faults=tuple(faults), bus=LOCAL, can={}, out=folder)
    result = record_run(spec, keep=False)
    result.branched_from = {"sha256": None, "lines": None, "instant_s": time_s, "straight": why}
    if keep:
        write_results(result)
    return result


def branched_run(folder: str | Path, code: NamedCode = NO_CODE) -> RunSpec:
    """The description of a recorded run, for branches of it.

    :param folder: run folder, or its certificate.
    :param code: that the command line names, for a run with code of the user.
    :raises InputError: it cannot be repeated with the same bytes, or its scenario has changed.
    """
    run = certified_run(str(folder), code)
    repeatable(run)
    spec = replace(run.spec, bus=LOCAL, can={}, out=None)
    found, wanted = spec.load().sha256, run.certificate.get("scenario_sha256")
    if found != wanted:
        allowed = Sentence("has changed since the record: a branch would not be one of this run")
        raise InputError(run.certificate_path, f"scenario {spec.scenario}", found, allowed)
    return spec


@library_call(
    "railhil.branch",
    {
        "run": Kind("a run or a run folder", lambda value: is_path(value) or isinstance(value, Record)),
        "at_s": Kind("a number of seconds", lambda value: isinstance(value, int | float)),
        "faults": TEXTS,
        "out": PATH_OR_NONE,
    },
    {"--fault": "faults"},
)
def branch(
    run: str | Path | Record, at_s: float, faults: str | Sequence[str], *, out: str | Path | None = None
) -> Record:
    """A recorded run again, with further faults from an instant on.

    :param run: with a folder.
    :param at_s: the instant, in s of simulation time; a fault without a condition begins there.
    :param faults: besides those of the run, one or several.
    :param out: folder of the new run; None: ``runs/<utc>-<scenario>-<controller>``.
    :raises InputError: the run cannot be repeated or ends before the instant, or a fault cannot be injected or begins
        before it.
    """
    spec = branched_run(run.log.parent if isinstance(run, Record) else run)
    texts = faults_from([faults] if isinstance(faults, str) else faults, at_s)
    with Trunk(spec) as trunk:
        trunk.advance(at_s)
        return as_recorded(trunk.branch((*spec.faults, *texts), out))


def faults_from(texts: Sequence[str], time_s: float) -> tuple[str, ...]:
    """Faults, of which those without a condition begin at an instant.

    :raises InputError: one is not in the language.
    """
    return tuple(normalise_fault(with_condition(text, f"{time_s:.10g}s")) for text in texts)


class Trunk:
    """A run that stands still at an instant, in a process of its own; a context manager.

    The process ends with this one, also if this one is killed, and with the thread that has made it.

    :param spec: the run; its bus and its folder are not used.
    :raises InputError: the run cannot be made.
    """

    def __init__(self, spec: RunSpec) -> None:
        self.spec = spec = replace(spec, bus=LOCAL, can={}, out=None)
        #: The instant from which branches have their own faults, in s.
        self.time_s = 0.0
        #: Reason why the last branch was a straight run; empty: it was a fork.
        self.straight = why_straight(spec)
        self._can_fork = not self.straight
        self._process: subprocess.Popen[bytes] | None = None
        if not self._can_fork:
            return
        self._pipe, theirs = Pipe()
        with theirs:
            words = [sys.executable, "-P", "-c", _PROCESS, str(theirs.fileno()), str(os.getpid())]
            self._process = subprocess.Popen(
                words, stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()], env={**os.environ, **_ONE_THREAD}
            )
        try:
            self._ask(spec)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        # A branch ends with its trunk: the connection then has no other end.
        with suppress(EOFError, OSError):
            while True:
                self._pipe.recv_bytes()
        self._pipe.close()

    def _ask(self, what: object) -> Any:
        try:
            self._pipe.send(what)
            found = self._pipe.recv()
        except (EOFError, OSError):
            raise BranchLost("the process of the branch has died") from None
        if isinstance(found, BaseException):
            raise found
        return found

    def advance(self, time_s: float) -> None:
        """Go on to an instant: what happens before it is the same in all later branches.

        :raises InputError: the run ends before it, or stands at a later one.
        """
        if self._process is not None:
            from railhil.run.trunk import Advance

            self._ask(Advance(time_s))
        elif time_s < self.time_s:
            raise InputError("branch", "instant", f"{time_s:g} s", f"{self.time_s:g} s or later")
        self.time_s = time_s

    def branch(
        self,
        faults: Sequence[str],
        folder: str | Path | None = None,
        *,
        keep: bool = True,
        settings: Sequence[str] = (),
    ) -> Result:
        """One run with these faults, which do not begin before the instant unless the trunk has them.

        :param faults: all of its run besides the scenario's own.
        :param folder: its run folder, new or empty; None: ``runs/<utc>-<scenario>-<controller>``.
        :param keep: whether the folder is to be complete and to stay; else it is removed.
        :param settings: further ones of its scenario, that change nothing before the instant (``noise_from``).
        :raises InputError: one of the faults cannot be injected, or begins earlier.
        """
        if not keep:
            with tempfile.TemporaryDirectory(prefix="railhil-") as private:
                return replace(self._branch(faults, Path(private) / "run", settings, keep=False), folder=None)
        return self._branch(faults, folder, settings, keep=True)

    def _branch(self, faults: Sequence[str], out: str | Path | None, settings: Sequence[str], *, keep: bool) -> Result:
        spec = replace(self.spec, settings=(*self.spec.settings, *settings))
        if self._process is None:
            return branch_straight(spec, faults, out, self.time_s, self.straight, keep=keep)
        from railhil.run.trunk import Branch, NoFork

        folder, made = run_folder(out, self.spec.load().name, self.spec.folder_controller)
        try:
            found = self._ask(Branch(tuple(faults), folder.resolve(), keep, spec.settings))
        except BaseException as error:
            if not isinstance(error, Exception):
                # The branch may still write.
                self.close()
            discard_folder(folder, made)
            raise
        if isinstance(found, NoFork):
            discard_folder(folder, made)
            self.straight = found.why
            return branch_straight(spec, faults, out, self.time_s, found.why, keep=keep)
        self.straight = ""
        result: Result = found
        return replace(result, folder=folder)
