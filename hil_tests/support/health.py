"""Checks the health of the bus after every test: fixtures imported by the ``conftest.py`` of a folder of runs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from railhil.bench import Result
from railhil.testing.result import disturbed_run


def disturbed_runs(folder: Path) -> dict[str, dict[str, int]]:
    """Counters of lost, refused or reordered frames in all run folders below a folder, by their path."""
    files = sorted(folder.rglob("score.json"))
    found = {str(file.parent.relative_to(folder)): disturbed_run(file.parent) for file in files}
    return {name: counters for name, counters in found.items() if counters}


#: What the runs in this process have refused since the last test of such a folder began, including those made by
#: fixtures. Not the runs themselves: in folders without this check hundreds follow, of a megabyte and more each.
_REFUSED: list[dict[str, int]] = []


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Runs of tests in other folders do not count for this test."""
    _REFUSED.clear()


@pytest.fixture(scope="session", autouse=True)
def noted_runs() -> Iterator[None]:
    """Record what every run of this process has refused when it is created."""
    make = Result.__init__
    if make.__name__ == "noted":
        # Another folder's conftest.py has brought it already.
        yield
        return

    def noted(run: Result, *given: object, **named: object) -> None:
        make(run, *given, **named)  # type: ignore[arg-type]
        _REFUSED.append(run.refused)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Result, "__init__", noted)
        yield


@pytest.fixture(autouse=True)
def healthy(
    noted_runs: None, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[None]:
    """After every test: none of its runs has lost, refused or reordered frames, except in tests of such faults.

    Its runs are those in this process and those whose folders are below a folder passed to the test.
    """
    yield
    found = [*_REFUSED]
    _REFUSED.clear()
    if request.node.get_closest_marker("faults") is not None:
        return
    assert not any(found), found
    given = {value for value in request.node.funcargs.values() if isinstance(value, Path) and value.is_dir()}
    for folder in given:
        if folder.is_relative_to(tmp_path_factory.getbasetemp()):
            assert disturbed_runs(folder) == {}, folder
