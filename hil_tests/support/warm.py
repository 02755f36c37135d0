"""A Python that has railhil loaded and forks for each command: a process of its own, without half a second of start-up.

The command gets what a new process would: working directory, environment, module path, standard streams, signals and
exit code. Processes that it starts itself are new ones, as ever. Only the start is not that of a user's command:
``anew`` of :func:`hil_tests.support.cli.railhil` and ``Started`` are for that.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import importlib
import json
import os
import runpy
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from pydantic import BaseModel

from hil_tests.support.paths import ROOT
from hil_tests.support.short_end import end_with
from railhil.systems.ato import ATO
from railhil.systems.high_speed import EMU3, HST1
from railhil.systems.line import LINE
from railhil.systems.stop import STOP

#: What commands load first of all. Nothing is called, so nothing is remembered that depends on the environment.
#: No module that a command runs as a program: Python would warn of one that is loaded already.
_LOADED = (
    "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg", "_pytest.config", "_pytest.pytester",
    "railhil.audit.result", "railhil.audit.tables", "railhil.bench", "railhil.campaign.report",
    "railhil.campaign.study", "railhil.cli.branch", "railhil.cli.commands", "railhil.cli.compare", "railhil.cli.export",
    "railhil.cli.faults", "railhil.cli.new", "railhil.cli.new_controller", "railhil.cli.plot", "railhil.cli.ports",
    "railhil.cli.replay", "railhil.cli.report", "railhil.cli.rerun", "railhil.cli.run", "railhil.cli.runs",
    "railhil.cli.scenarios", "railhil.cli.score", "railhil.cli.verify",
    "railhil.controller_node.export.bundle", "railhil.controller_node.given.worker", "railhil.hunt.study",
    "railhil.hunt.report", "railhil.library", "railhil.probability.study", "railhil.run.replay", "railhil.run.local",
    "railhil.run.trunk", "railhil.report.page", "railhil.report.pictures", "railhil.sequences.record",
    "railhil.systems.ato.scenario.train_files", "railhil.testing", "railhil.tuning.command",
    "railhil.controller_node.ato.laws.ipfc", "railhil.controller_node.ato.laws.ipfc_plus",
)  # fmt: skip
#: Parts of a system that a run, its judgement and its report load.
_PARTS = (
    "scenarios", "plant", "faulty_plant", "controller", "judging", "pictures", "picture", "given", "task", "interface",
    "export",
)  # fmt: skip
_SERVE = f"import {end_with.__module__}; from {__name__} import serve; serve()"


def run_module(
    module: str, words: Sequence[str], *, environment: Mapping[str, str], cwd: Path | None = None, text: str = ""
) -> subprocess.CompletedProcess[str]:
    """``python -m MODULE WORDS``; the time that it may take is that of the test.

    :param text: its standard input.
    """
    with tempfile.TemporaryDirectory(prefix="railhil-warm-") as folder:
        streams = [Path(folder) / name for name in ("in", "out", "err")]
        streams[0].write_text(text, encoding="utf-8")
        request = {
            "module": module, "words": list(words), "streams": [str(path) for path in streams],
            "environment": dict(environment), "cwd": str(cwd or Path.cwd()),
        }  # fmt: skip
        code = _server().ask(json.dumps(request))
        out, err = (path.read_text(encoding="utf-8") for path in streams[1:])
    return subprocess.CompletedProcess([module, *words], code, out, err)


class _Server:
    """The process that forks, as seen by the tests."""

    def __init__(self) -> None:
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        self._process = subprocess.Popen(
            [sys.executable, "-c", _SERVE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT,
            env=environment, start_new_session=True,
        )  # fmt: skip

    def ask(self, request: str) -> int:
        """Exit code of the command (negative: of the signal that ended it)."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            print(request, file=self._process.stdin, flush=True)
            return int(self._process.stdout.readline())
        except BaseException:
            # The test is over before the command is, so the next one needs another server.
            _server.cache_clear()
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            raise

    def close(self) -> None:
        """End it, so that its processor time counts as that of the tests."""
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.wait()


@cache
def _server() -> _Server:
    server = _Server()
    atexit.register(server.close)
    return server


def serve() -> None:
    """Fork for each line of standard input; answer with the exit code."""
    answers = os.fdopen(os.dup(1), "w")
    for name in _LOADED:
        importlib.import_module(name)
    for system in (ATO, STOP, HST1, EMU3, LINE):
        for reference in (getattr(system, part, None) for part in _PARTS):
            importlib.import_module((reference or __name__).partition(":")[0])
    _complete(BaseModel)
    gc.freeze()
    for line in sys.stdin:
        child = os.fork()
        if not child:
            _become(**json.loads(line))
            return
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        print(code, file=answers, flush=True)


def _complete(model: type[BaseModel]) -> None:
    """Let pydantic make the schemas of the models below one, which it would at their first use."""
    for kind in model.__subclasses__():
        kind.model_rebuild()
        _complete(kind)


def _become(module: str, words: list[str], streams: list[str], environment: dict[str, str], cwd: str) -> None:
    """What the interpreter does before it runs a module. An exception is left to it, and so is every end but one with a
    number."""
    for number, path in enumerate(streams):
        opened = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        os.dup2(opened, number)
        os.close(opened)
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    given = [path for path in environment.get("PYTHONPATH", "").split(os.pathsep) if path]
    sys.path[:] = [cwd, *given, *sys.path[1:]]
    importlib.invalidate_caches()
    sys.argv[1:] = words
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            end_with(end.code or 0)
        raise
    end_with(0)
