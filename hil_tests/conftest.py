"""Fixtures of the bench's own tests; users of the bench may also import them."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from hil_tests.hashes import choose
from hil_tests.machines.tools import EMULATION
from hil_tests.support.browser import browser
from hil_tests.support.cli import Done, Railhil
from hil_tests.support.recordings import SharedRuns
from railhil import cli
from railhil.bench import Result, local_run
from railhil.bus.select import vcan_available
from railhil.common.version import full_version
from railhil.dossier.junit import CODE, VERSION
from railhil.judge.folder import code_sha256
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario

#: Its tests belong to distributions, and run where these are installed.
collect_ignore = ["data"]
#: Objects made, less those freed, between two collections.
_GARBAGE = 100_000
#: A slow test takes as long as so many others.
_SLOW_WEIGHT = 20
#: A slow test may have to compile first, or wait for another process that compiles: up to half a minute of processor
#: time. What takes so long on a busy machine is no endless loop.
_SLOW_TIMEOUT_S = 600
#: Cases of each test with ``long_after`` that were collected.
_CASES = pytest.StashKey[Counter[str]]()


def _outlives_its_terminal(number: int, frame: object) -> None:
    """A handler, unlike SIG_IGN, is not inherited by the programs that a test starts."""


def pytest_configure(config: pytest.Config) -> None:
    """Processes started by tests must ignore the user's python-can configuration, and must start quickly."""
    for name in ("CAN_INTERFACE", "CAN_CHANNEL", "CAN_BITRATE", "CAN_CONFIG"):
        os.environ.pop(name, None)
    # A test that starts make would get the options of the make that has started the tests.
    for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
        os.environ.pop(name, None)
    # The tests start hundreds of processes: without bytecode on disk each would recompile all modules.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    # As `nohup make test` has it; tests send it to what they start.
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        signal.signal(signal.SIGHUP, _outlives_its_terminal)
    # An example that takes long says that the machine is busy. The rest is what the user or hil_tests.mutation has set.
    settings.register_profile("untimed", settings(), deadline=None)
    settings.load_profile("untimed")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Thousands of tests stay for the whole session: the collector of garbage need not look at them again and again.
    Nor need it look as often as by default at the objects of a run, which come and go by the hundred."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(_GARBAGE)
        gc.enable()


def pytest_itemcollected(item: pytest.Item) -> None:
    """With ``long_after(N)`` the cases of a test after its first N are long."""
    mark = item.get_closest_marker("long_after")
    if mark is None or item.get_closest_marker("long") is not None:
        return
    cases = item.session.stash.setdefault(_CASES, Counter())
    test, _, _ = item.nodeid.partition("[")
    cases[test] += 1
    if cases[test] > mark.args[0]:
        item.add_marker(pytest.mark.long)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip by capability, naming it; begin with the files that take long where several workers share the files.
    With ``RAILHIL_SAMPLE=N DAY`` one of N tests only, those of the day (:func:`hil_tests.hashes.choose`)."""
    if sampled := os.environ.get("RAILHIL_SAMPLE"):
        share, day = sampled.split()
        chosen = choose([item.nodeid for item in items], int(share), day)
        config.hook.pytest_deselected(items=[item for item in items if item.nodeid not in chosen])
        items[:] = [item for item in items if item.nodeid in chosen]
    if not os.environ.get("REFERENCE_FMUS"):
        # Sources of somebody else, which no test downloads: https://github.com/modelica/Reference-FMUs.
        others = [item for item in items if item.get_closest_marker("needs_reference_fmus") is not None]
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if item not in others]
    if hasattr(config, "workerinput"):
        weights = Counter[Path]()
        for item in items:
            weights[item.path] += 1 if item.get_closest_marker("slow") is None else _SLOW_WEIGHT
        items.sort(key=lambda item: -weights[item.path])
    missing: dict[str, str] = {}
    if not vcan_available():
        missing["needs_socketcan"] = "MISSING CAPABILITY kernel SocketCAN with vcan0 (make test brings it up as root)"
    if shutil.which("docker") is None or not os.environ.get("DOCKER_HOST"):
        missing["needs_docker"] = "MISSING CAPABILITY Docker engine (make test brings it up as root)"
    if not os.environ.get("RAILHIL_REQUIRE_ALL") and not all(shutil.which(name) for name in ("gcc", "clang")):
        missing["needs_compiler"] = "MISSING CAPABILITY C compilers gcc and clang (make test installs them as root)"
    if not os.environ.get("RAILHIL_REQUIRE_ALL") and not all(shutil.which(name) for name in EMULATION):
        missing["needs_qemu"] = "MISSING CAPABILITY QEMU and gcc for Arm (make test installs them as root)"
    if browser() is None and not os.environ.get("RAILHIL_REQUIRE_ALL"):
        missing["needs_browser"] = "MISSING CAPABILITY Chromium (make test installs it as root)"
    if not all(shutil.which(name) for name in ("node", "npm")):
        missing["needs_node"] = "MISSING CAPABILITY node and npm"
    for item in items:
        takes_long = any(item.get_closest_marker(mark) is not None for mark in ("slow", "long"))
        if takes_long and item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(_SLOW_TIMEOUT_S))
        for mark, reason in missing.items():
            if item.get_closest_marker(mark) is not None:
                item.add_marker(pytest.mark.skip(reason=reason))
    if items and config.getoption("xmlpath", None):
        # The code under test, for `railhil dossier --validation`; a report has it at one test.
        items[0].user_properties += [(VERSION, full_version()), (CODE, code_sha256())]


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """If every capability is required, a skipped test is a failure, whatever its reason."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if os.environ.get("RAILHIL_REQUIRE_ALL") and reporter is not None and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(autouse=True)
def signals_as_found() -> Iterator[None]:
    """Restore signals: a command run inside the test process leaves them ignored, which the next test's children would
    inherit."""
    found = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in found.items():
        if signal.getsignal(number) is not handler:
            signal.signal(number, handler)


@pytest.fixture(scope="session")
def lvshun() -> Scenario:
    """The published scenario."""
    return load("lvshun_tieshan")


@pytest.fixture(scope="session")
def nominal(lvshun: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """A run of the published scenario without sockets, seed 2; read-only."""
    return local_run(lvshun, tmp_path_factory.mktemp("nominal"), RunSpec(seed=2))


@pytest.fixture(scope="session")
def published_run(lvshun: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedRuns]:
    """Recorded runs of the published scenario by seed and arithmetic, each made once for all workers; read-only."""
    folder = tmp_path_factory.getbasetemp()
    runs = SharedRuns(lvshun, folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder)
    yield runs
    assert runs.changed() == [], "a test, here or in another worker, has written into a run that all tests share"


@pytest.fixture
def here(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, signals_as_found: None
) -> Railhil:
    """The command in this process, in an empty folder: like in a separate process, but faster. Not for commands that
    become another program."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str | Path) -> Done:
        try:
            code = cli.main([str(word) for word in arguments])
        except SystemExit as end:
            code = int(end.code or 0)
        said = capsys.readouterr()
        return Done(code, said.out, said.err)

    return call


@pytest.fixture
def socket_folder() -> Iterator[Path]:
    """Folder with a path short enough for a Unix socket."""
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        yield Path(folder)
