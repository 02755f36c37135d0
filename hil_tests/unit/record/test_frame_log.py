"""The frame log: one that begins late (with the repeated PLT_IDENT) is no record, a full disk leaves no gap."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, PltIdent
from railhil.bus.telegrams import TimeSync
from railhil.common.errors import InputError
from railhil.judge.record import checked_record
from railhil.record.framelog import FrameLog, log_line
from railhil.scenarios.load import load


@pytest.fixture(scope="module")
def scenario_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("late") / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    local_run(load(str(path)), path.parent)
    return path


def test_a_log_that_begins_later_is_refused(scenario_file: Path, tmp_path: Path) -> None:
    lines = (scenario_file.parent / "frames.log").read_text().splitlines(keepends=True)
    late = tmp_path / "late.log"
    late.write_text("".join(lines[500:]))
    with pytest.raises(InputError, match=r"late.log: SUP_IDENT: no such telegram, expected a log .* from its start"):
        checked_record(str(late), str(scenario_file))


def test_the_plant_tells_again_what_runs(scenario_file: Path) -> None:
    """On its period behind TIME_SYNC, as in the handshake, with what the controller has told of itself."""
    trace = checked_record(str(scenario_file.parent / "frames.log"), str(scenario_file)).trace
    times_ns = list(trace.times_ns(PltIdent.PORT))
    assert times_ns == [0, *range(1_280_000_000, trace.end_ns + 1, 1_280_000_000)]
    assert len(times_ns) > 3
    behind = dict(zip(trace.order(TimeSync.PORT), trace.times_ns(TimeSync.PORT), strict=True))
    assert [behind.get(place - 1) for place in trace.order(PltIdent.PORT).tolist()] == [None, *times_ns[1:]]
    controller, period = trace.ident(CtlIdent), trace.contract.port(PltIdent.PORT).period_ns
    assert controller is not None
    assert period == 1_280_000_000
    for name, told in (
        ("Law", controller.law),
        ("Arithmetic", controller.arithmetic),
        ("Indexing", controller.indexing),
    ):
        assert trace.raw(PltIdent.PORT, f"Plt{name}").tolist() == [0, *[told] * (len(times_ns) - 1)]
    for name in ("ScenarioHash", "WireHash", "Seed", "Role", "Perturbed", "Pace", "Version"):
        assert len(set(trace.raw(PltIdent.PORT, f"Plt{name}").tolist())) == 1


@pytest.mark.parametrize("lines", [1, 3000, 20_000])
def test_log_on_a_full_disk_ends_with_a_whole_line_and_has_no_gap(tmp_path: Path, lines: int) -> None:
    """Room that appears later does not hide what could not be written before."""
    log, line = FrameLog(tmp_path), log_line(5_000_000, Frame(0x123, b"\1"))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_001, hard))
    try:
        with pytest.raises(OSError, match="File too large"):
            list(map(log.write, [line * lines] * (40_000 // lines)))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    for later in (lambda: log.write(line), log.close):
        with pytest.raises(OSError, match="File too large"):
            later()
    kept = log.path.read_text()
    assert len(kept) > 199_970
    assert kept == line * (len(kept) // len(line))
