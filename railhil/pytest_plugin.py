"""The plugin for pytest: fixtures ``bench``, ``seed`` and ``railhil_config``, options, markers (docs/howto/testing.md).

pytest imports this module in every session of an environment with railhil: it loads nothing but pytest and modules that
need no library. The bench itself is loaded by the first test that asks for it.
"""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator
from typing import TYPE_CHECKING, Any

import pytest

from railhil.testing import requirements
from railhil.testing.settings import FLAG, OPTIONS, Settings, settings_from

if TYPE_CHECKING:
    from railhil.testing.bench import Bench
    from railhil.testing.required import Shown

_SETTINGS = pytest.StashKey[Settings]()
_BENCH = pytest.StashKey["Bench"]()
_FAILED = pytest.StashKey[bool]()
_MISUSED = pytest.StashKey[str]()
#: Argument of the marker ``requirement``.
_REQUIRES = "requires"
#: Arguments of the marker ``railhil``: the arguments of a run that a module's tests have in common.
_USUAL = ("scenario", "controller", "arithmetic", "indexing", "parameters", "settings", "faults")
_MARKERS = (
    f"railhil({', '.join(f'{name}=' for name in _USUAL)}): what the test's runs have in common",
    "requirement(id, ..., requires=): the test shows these requirements; requires: a sentence that its runs must keep",
    "needs_socketcan: needs kernel SocketCAN: vcan0, or --railhil-bus socketcan:...",
    "needs_adapter: needs an adapter: --railhil-bus INTERFACE:CHANNEL",
    "expect_loss: frames may be lost, refused or out of order in its runs",
)
#: Interfaces of python-can without an adapter.
_NO_ADAPTER = ("", "railhil", "virtual", "udp_multicast")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options, each also a key of the ini file."""
    group = parser.getgroup("railhil", "railhil, the bench for train controllers")
    for name, words in OPTIONS.items():
        action = {"action": "store_const", "const": "1"} if name == FLAG else {"metavar": name.upper()}
        group.addoption(f"--railhil-{name}", dest=_key(name), default=None, help=words, **action)
        parser.addini(_key(name), words)


def _key(name: str) -> str:
    return f"railhil_{name.replace('-', '_')}"


def pytest_configure(config: pytest.Config) -> None:
    """Markers, settings, and the fixture ``seed``, whose values are an option."""
    for line in _MARKERS:
        config.addinivalue_line("markers", line)

    def given(name: str) -> tuple[str, str]:
        """The command line overrides the environment, the environment the ini file."""
        key = _key(name)
        said = config.getoption(key)
        if said is not None:
            return str(said), f"--railhil-{name}"
        said = os.environ.get(key.upper(), "")
        return (said, key.upper()) if said else (str(config.getini(key) or ""), key)

    try:
        settings = config.stash[_SETTINGS] = settings_from(given, config.invocation_params.dir)
    except ValueError as error:
        raise pytest.UsageError(f"railhil: {error}") from None
    config.pluginmanager.register(_seeds(settings.seeds), "railhil_seeds")


def _seeds(seeds: tuple[int, ...]) -> object:
    """A plugin with the fixture ``seed``: like any fixture, a user's own one of this name takes its place."""

    class Seeds:
        @pytest.fixture(params=seeds, ids=[f"seed{seed}" for seed in seeds])
        def seed(self, request: pytest.FixtureRequest) -> int:
            """Seed of a run: the test is repeated for each of ``--railhil-seeds``."""
            return int(request.param)

    return Seeds()


@pytest.fixture(scope="session")
def railhil_config(pytestconfig: pytest.Config) -> Settings:
    """The settings of this session."""
    return pytestconfig.stash[_SETTINGS]


@pytest.fixture
def bench(
    request: pytest.FixtureRequest, railhil_config: Settings, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Bench]:
    """Makes runs; after the test it is checked that no frame was lost, refused or out of order in them."""
    from railhil.testing.bench import Bench

    item = request.node
    runs = railhil_config.runs or tmp_path_factory.mktemp("railhil")
    made = item.stash[_BENCH] = Bench(
        railhil_config, _usual(item), item.path.parent, runs, requirements.folder_name(item.nodeid), _required(item)
    )  # fmt: skip
    yield made
    made.close()
    disturbances = [] if item.get_closest_marker("expect_loss") else made.disturbances
    if item.stash.get(_FAILED, False) or disturbances:
        names = [name for mark in item.iter_markers(requirements.PROPERTY) for name in mark.args]
        shows = f", which shows requirement {', '.join(names)}" if names else ""
        for line in made.reported(f"Test {item.nodeid}{shows}: failed."):
            print(line)
    elif railhil_config.runs is None:
        made.keep_certificates()
    if disturbances:
        pytest.fail("; ".join(("frames were lost, refused or out of order", *disturbances)), pytrace=False)


def _usual(item: pytest.Item) -> dict[str, Any]:
    """Arguments of the markers ``railhil``; the test's own come before its module's."""
    found: dict[str, Any] = {}
    for mark in item.iter_markers("railhil"):
        found = {**mark.kwargs, **found}
    return found


def _required(item: pytest.Item) -> list[tuple[str, str]]:
    """Names and sentences of the markers ``requirement`` that require one."""
    marks = item.iter_markers(requirements.PROPERTY)
    return [(mark.args[0], mark.kwargs[_REQUIRES]) for mark in marks if _REQUIRES in mark.kwargs]


def pytest_make_parametrize_id(val: object, argname: str) -> str | None:
    """Faults without spaces in the ids of tests."""
    return val.replace(" ", "_") if argname in ("fault", "faults") and isinstance(val, str) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """:raises pytest.UsageError: a marker is used wrongly, or the list of requirements cannot be read."""
    listed = _listed(config)
    for item in items:
        for mark in item.iter_markers():
            if problem := _misused(mark) or _unlisted(mark, listed):
                line = f"{item.nodeid}: marker {mark.name}: {problem}"
                if not hasattr(config, "workerinput"):
                    raise pytest.UsageError(line)
                # The processes of xdist cannot end the session: there, the test is an error.
                item.stash[_MISUSED] = line


def _listed(config: pytest.Config) -> list[str]:
    """The names of the list of requirements; none without a list.

    :raises pytest.UsageError: it cannot be read.
    """
    path = config.stash[_SETTINGS].requirements
    if path is None:
        return []
    from railhil.common.errors import InputError
    from railhil.judge.requirements.lists import read_list

    try:
        return [one.id for one in read_list(path)]
    except InputError as error:
        raise pytest.UsageError(f"railhil: {error}") from None


def _unlisted(mark: pytest.Mark, listed: list[str]) -> str:
    """What is wrong with a name that the list does not have; empty: nothing."""
    unknown = [name for name in mark.args if name not in listed] if listed and mark.name == "requirement" else []
    if not unknown:
        return ""
    from railhil.common.errors import did_you_mean

    hint = did_you_mean(unknown[0], listed)
    return f"{unknown[0]} is not in the list of requirements" + (f" ({hint})" if hint else "")


def _misused(mark: pytest.Mark) -> str:
    """Error in the arguments of a marker; empty if there is none."""
    if mark.name == "railhil":
        unknown = [name for name in mark.kwargs if name not in _USUAL]
        if mark.args or unknown or not mark.kwargs:
            found = ", ".join((*map(repr, mark.args), *(f"{name}=" for name in unknown))) or "nothing"
            return f"found {found}, allowed {', '.join(f'{name}=' for name in _USUAL)}"
    elif mark.name == "requirement":
        names_given = mark.args and all(isinstance(one, str) and one.strip() for one in mark.args)
        if not names_given or mark.kwargs.keys() - {_REQUIRES}:
            return 'allowed one or more names, such as requirement("ATO-12"), and requires= beside one'
        if (says := mark.kwargs.get(_REQUIRES)) is not None:
            if len(mark.args) > 1 or not isinstance(says, str):
                return "allowed requires= with a sentence, beside one name"
            from railhil.testing.required import problem_of

            return problem_of(mark.args[0], says)
    elif mark.name in ("needs_socketcan", "needs_adapter", "expect_loss") and (mark.args or mark.kwargs):
        return "allowed no arguments"
    return ""


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test if something that it needs is not there; the reason names it."""
    if line := item.stash.get(_MISUSED, ""):
        raise pytest.UsageError(line)
    settings = item.config.stash[_SETTINGS]
    if item.get_closest_marker("needs_adapter") and settings.interface in _NO_ADAPTER:
        pytest.skip(f"needs_adapter: the bus is {settings.bus} (--railhil-bus INTERFACE:CHANNEL)")
    if item.get_closest_marker("needs_socketcan") and settings.interface != "socketcan":
        from railhil.bus.select import vcan_available

        if not vcan_available():
            pytest.skip("needs_socketcan: this kernel has no vcan0 (railhil vcan, or --railhil-bus socketcan:can0)")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Fail a test of which a run violates a sentence that it requires, or in which none has shown it."""
    try:
        result = yield
    except BaseException:
        item.user_properties += [one.fact(has_failed=True) for one in _shown(item)]
        raise
    found = _shown(item)
    item.user_properties += [one.fact(has_failed=False) for one in found]
    if lines := [one.line for one in found if one.line]:
        pytest.fail("\n".join(lines), pytrace=False)
    return result


def _shown(item: pytest.Item) -> list[Shown]:
    """What the runs of a test have shown of the sentences that it requires."""
    required = dict.fromkeys(_required(item))
    if not required:
        return []
    from railhil.testing.required import shown

    bench = item.stash.get(_BENCH, None)
    return [shown(name, says, bench.runs if bench is not None else ()) for name, says in required]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Facts of the runs, for the JUnit report; from here they survive xdist and a failed fixture."""
    own = [(requirements.PROPERTY, name) for mark in item.iter_markers("requirement") for name in mark.args]
    bench = item.stash.get(_BENCH, None)
    facts = own + (bench.facts() if bench is not None else [])
    known = set(item.user_properties)
    item.user_properties += [fact for fact in facts if fact not in known]
    report = yield
    if report.failed:
        item.stash[_FAILED] = True
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """The table of requirements, if any test names one."""
    reports = (
        (outcome, report.nodeid, [(str(key), value) for key, value in report.user_properties])
        for outcome, group in terminalreporter.stats.items()
        for report in group
        if isinstance(report, pytest.TestReport)
    )
    found = requirements.requirements(reports)
    settings = config.stash[_SETTINGS]
    if settings.requirements is not None:
        found = requirements.with_list(found, _listed(config))
    if not found:
        return
    terminalreporter.section("requirements (railhil)")
    for line in requirements.lines(found):
        terminalreporter.write_line(line)
    if settings.runs is not None:
        terminalreporter.write_line(f"table: {requirements.write(found, settings.runs)}")
        if settings.requirements is not None:
            copy = requirements.write_list(found, settings.requirements, settings.runs)
            terminalreporter.write_line(f"list with results: {copy}")
