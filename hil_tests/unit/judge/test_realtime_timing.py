"""Timing: where it was measured, what makes a run INVALID, and its entries in score.json and report."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.recordings import recorded_folder
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import SupCmd
from railhil.cli import commands
from railhil.common.command_line import parse
from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.judge.jitter import (
    EDGES_MS,
    LATE_MS,
    PAUSE_MS,
    PLANT,
    RECORDER,
    Jitter,
    RunTiming,
    arrivals_of,
    jitter_from,
    kept_pace,
    lockstep_timing,
    plant_timing,
    realtime_timing,
)
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.plant_sim.cycle_times import MISSED_NS, PlantTiming
from railhil.record.documents import read_score
from railhil.record.run_folder import TIMING, write_json
from railhil.record.trace import Trace, trace_of
from railhil.report.page import page
from railhil.run.conclusion import late_reason
from railhil.scenarios.load import load
from railhil.wire.ato import NotchCmd

SCHEDULING = {"plant": "SCHED_FIFO 40, memory locked", "supervisor": "normal scheduling"}


def late(cycles: int, count: int, by_ms: float = 6.0) -> Jitter:
    """Jitter of a run in which ``count`` of the cycles came ``by_ms`` late, the others 0.1 ms."""
    late_ms = np.full(cycles, 0.1)
    late_ms[:count] = by_ms
    return jitter_from(late_ms)


@pytest.mark.parametrize(
    ("verdict", "failure", "said"),
    [
        ("PASS", (), "timing: "),
        ("FAIL", ("invariant 4: x",), "timing: "),
        ("INVALID", ("record: x",), "record: x; timing: "),
        ("INVALID", ("run record_incomplete",), ""),
    ],
)
def test_a_late_run_says_so_beside_what_its_record_does_not_show(verdict: str, failure: tuple[str], said: str) -> None:
    found = Score(verdict, {}, {}, failure, "ended_complete")
    words = late_reason(found, RunTiming(PLANT, 1, 0, late(1000, 500)))
    assert words.startswith(said) if said else words == ""
    assert late_reason(found, RunTiming(PLANT, 1, 0, late(1000, 0))) == ""


def plant_table(folder: Path, jitter_ms: float, cycles: int = 100) -> None:
    """What a plant leaves that was this late in every cycle, with two of three polls of NOTCH_CMD answered."""
    timing = PlantTiming()
    for tick in range(cycles):
        timing.began(tick, round(jitter_ms * 1e6))
    timing.polled(0, "SUP_CMD", 1_500_000)
    for answer_ns in (250_000, MISSED_NS, 750_000):
        timing.polled(2, "NOTCH_CMD", answer_ns)
    timing.write(folder / TIMING)


# -- the rule ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("jitter", "valid", "words"),
    [
        (late(1000, 1), True, ""),
        (late(1000, 2), False, "timing: 0.20% of 1000 cycles more than 5 ms late, allowed 0.1%"),
        (late(19500, 19), True, ""),
        (late(19500, 20), False, "timing: 0.103% of 19500 cycles more than 5 ms late"),
        (late(1000, 1000, LATE_MS), True, ""),
        (late(1000, 1000, np.nextafter(LATE_MS, 9)), False, "timing: 100.00% of 1000 cycles"),
        # A pause of the host that is too short a share of a long run.
        (late(10**6, 1, PAUSE_MS), False, "timing: a cycle 150 ms late, allowed less than 150 ms"),
        # A pause of 200 ms in a tick of 10 ms.
        (late(10**6, 1, 190.0), False, "timing: a cycle 190 ms late, allowed less than 150 ms"),
        (late(10**6, 1, PAUSE_MS - 0.1), True, ""),
        (jitter_from(np.zeros(0)), False, "timing: 100.00% of 0 cycles"),
    ],
)
def test_more_than_a_thousandth_of_the_cycles_over_5_ms_late_is_invalid(
    jitter: Jitter, valid: bool, words: str
) -> None:
    assert jitter.valid is valid
    if not valid:
        assert jitter.sentence().startswith(words)


def test_figures_of_a_known_distribution() -> None:
    jitter = jitter_from(np.arange(1, 1001) / 1000.0)
    assert (jitter.cycles, jitter.max_ms, jitter.late_share) == (1000, 1.0, 0.0)
    assert (jitter.p50_ms, jitter.p99_ms, jitter.p999_ms) == pytest.approx((0.5005, 0.99001, 0.999001))


def test_every_cycle_is_in_the_histogram() -> None:
    jitter = jitter_from(np.array([0.0, 0.0005, 0.05, 0.05, 4.9, 5000.0]))
    assert sum(jitter.histogram) == 6
    assert len(jitter.histogram) == len(EDGES_MS) - 1
    bins = {(EDGES_MS[index], EDGES_MS[index + 1]): count for index, count in enumerate(jitter.histogram) if count}
    assert bins == {(0.001, 0.00158): 2, (0.0398, 0.0631): 2, (3.98, 6.31): 1, (631.0, 1000.0): 1}


# -- who measured -----------------------------------------------------------------------------------------------------


def test_the_plants_table_comes_back_as_it_was(tmp_path: Path) -> None:
    plant_table(tmp_path, 0.25)
    lines = (tmp_path / TIMING).read_text().splitlines()
    assert lines[:2] == ["tick,event,ns", "0,tick,250000"]
    assert lines[-2:] == ["2,NOTCH_CMD,-1", "2,NOTCH_CMD,750000"]
    measured = plant_timing(tmp_path / TIMING)
    assert measured is not None
    jitter, answers = measured
    assert (jitter.cycles, jitter.p50_ms, jitter.max_ms) == (100, 0.25, 0.25)
    notch, sup = answers
    assert (notch.port, notch.polls, notch.missed, notch.p50_ms, notch.max_ms) == ("NOTCH_CMD", 3, 1, 0.5, 0.75)
    assert (sup.port, sup.polls, sup.missed, sup.max_ms) == ("SUP_CMD", 1, 0, 1.5)


@pytest.mark.parametrize("text", [None, "tick,event,ns\n0,tick,x\n", "tick,event,ns\n0,tick\n"])
def test_without_a_whole_table_the_arrivals_stand_for_it(tmp_path: Path, text: str | None) -> None:
    if text is not None:
        (tmp_path / TIMING).write_text(text)
    arrivals = late(1000, 2)
    timing = realtime_timing(tmp_path, Trace(wire_contract()), arrivals, SCHEDULING)
    assert (timing.source, timing.jitter, timing.answers) == (RECORDER, arrivals, ())


@pytest.mark.parametrize(
    ("asked", "told", "kept", "said"),
    [
        (4.0, 4.0, 4.0, ""),
        # The telegram holds tenths, within its ends: what was asked for is exact.
        (0.25, 0.2, 0.25, ""),
        (1000.0, 25.5, 1000.0, ""),
        (0.01, 0.1, 0.01, ""),
        (4.0, 0.0, 4.0, ""),
        (1.0, 20.0, 20.0, "pace of the plant: 20 as TIME_SYNC says in tenths, not 1 (--rate)"),
        (1.0, 25.5, 25.5, "pace of the plant: 25.5 or faster as TIME_SYNC says in tenths, not 1 (--rate)"),
        (1.0, 0.1, 0.1, "pace of the plant: 0.1 or slower as TIME_SYNC says in tenths, not 1 (--rate)"),
    ],
)
def test_the_plants_pace_is_taken(asked: float, told: float, kept: float, said: str) -> None:
    assert kept_pace(asked, told) == (kept, said)


_LOCKSTEP = ["--pace", "lockstep"]


@pytest.mark.parametrize(
    "given", [["run", "--rate", "1", *_LOCKSTEP], ["run", "--no-rt", *_LOCKSTEP], ["compare", "--rate", "20"]]
)
def test_options_of_a_realtime_run_are_refused_in_lockstep(
    given: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        parse(commands.parser(), given)
    assert ended.value.code == 2
    line = f"railhil: argument {given[1]}: allowed only with --pace realtime (see railhil --help)\n"
    assert capsys.readouterr().err == line
    assert parse(commands.parser(), [*given, "--pace", "realtime"]).pace == "realtime"


@pytest.mark.parametrize(("plant_ms", "arrivals_late", "valid"), [(0.1, 500, True), (6.0, 0, False)])
def test_only_the_plants_own_lateness_counts(tmp_path: Path, plant_ms: float, arrivals_late: int, valid: bool) -> None:
    """A recorder that falls behind does not spoil a run, and one that keeps up does not save it."""
    plant_table(tmp_path, plant_ms)
    timing = realtime_timing(tmp_path, Trace(wire_contract()), late(1000, arrivals_late), SCHEDULING)
    assert timing.source == PLANT
    assert timing.jitter is not None
    assert timing.jitter.valid is valid
    assert timing.arrivals is not None
    assert timing.arrivals.valid is not valid
    assert (timing.polls, timing.missed_polls) == (4, 1)


def test_the_earliest_arrival_defines_zero() -> None:
    arrivals = arrivals_of([0, 1, 2, 4], [7_000_000, 16_900_000, 27_500_000, 47_000_000], 10_000_000)
    assert arrivals.cycles == 4
    assert arrivals.max_ms == pytest.approx(0.6)
    assert arrivals.p50_ms == pytest.approx(0.1)


# -- missed polls from the record -------------------------------------------------------------------------------------


def poll(port: str) -> Frame:
    entry = wire_contract().port(port)
    return master_frame(entry.f_code, entry.address)


def answer(telegram: NotchCmd | SupCmd) -> list[Frame]:
    return list(TelegramSource(wire_contract().port(telegram.PORT), False).frames(telegram.encode()))


def test_polls_without_an_answer_are_counted_from_the_record() -> None:
    whole = answer(NotchCmd(notch_256th=256))
    broken = [Frame(frame.can_id, bytes([frame.data[0] ^ 4]) + frame.data[1:], frame.flags) for frame in whole]
    notch, sup = poll("NOTCH_CMD"), poll("SUP_CMD")
    damaged_poll = Frame(notch.can_id, notch.data[:2] + bytes([notch.data[2] ^ 1]), notch.flags)
    frames = [
        notch, *whole,
        # Two polls in a row, the second answered; others in between do not matter.
        notch, notch, sup, *whole, *answer(SupCmd()),
        # An answer that nobody can accept; a duplicate; a poll that nobody can read; the last one, at the end.
        notch, *broken, notch, *whole, *whole, damaged_poll, sup,
    ]  # fmt: skip
    trace = trace_of(((index * 1000, frame) for index, frame in enumerate(frames)), wire_contract())
    assert (trace.polls, trace.missed_polls) == (7, 3)


# -- documents and report ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def lockstep(tmp_path_factory) -> Record:
    folder = tmp_path_factory.mktemp("timing")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    return recorded_folder(load(str(folder / "short.toml")), folder / "run")


@pytest.fixture
def document(tmp_path: Path) -> dict:
    """``run.timing`` of a realtime run that its plant has measured."""
    plant_table(tmp_path, 0.25)
    return realtime_timing(tmp_path, Trace(wire_contract()), late(100, 0), SCHEDULING).as_json()


def realtime(run: Record, timing: dict) -> Record:
    own = {**run.score_document["run"], "timing": timing}
    score = {**run.score_document, "run": own, "jitter": timing["lateness"]}
    return run.copy_with(certificate={**run.certificate, "pace": "realtime"}, score_document=score)


def words(text: str) -> str:
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


@pytest.mark.slow
def test_lockstep_has_no_timing_and_says_so(lockstep: Record) -> None:
    timing = lockstep.score_document["run"]["timing"]
    assert timing == lockstep_timing(lockstep.trace).as_json()
    assert set(timing) == {"source", "polls", "missed_polls"}
    assert timing["polls"] > 250
    assert timing["missed_polls"] == 0
    text = page([lockstep])
    assert "Timing lockstep: no timing, missed polls 0" in words(text)
    assert 'id="lateness"' not in text
    assert 'id="timing"' not in text


def test_report_of_a_realtime_run_shows_how_it_kept_time(lockstep: Record, document: dict) -> None:
    text = page([realtime(lockstep, document)])
    figure = re.search(r'<figure id="lateness">.*?</figure>', text, re.DOTALL)
    assert figure is not None
    shown = words(figure.group(0))
    for label in ("1 µs", "100 µs", "10 ms", "1000 ms", "cycles", "5 ms"):
        assert label in shown
    assert "ipfc 100 0.250 0.250 0.250 0.250 0.000% 4 1" in words(text)
    for sentence in (
        "lateness of 100 cycles: p50 0.250 ms, p99 0.250 ms, p99.9 0.250 ms, max 0.250 ms",
        "1 of 4 polls missed; NOTCH_CMD p50 0.500 ms, p99 0.745 ms, max 0.750 ms; SUP_CMD p50 1.500 ms",
        "plant: SCHED_FIFO 40, memory locked; supervisor: normal scheduling",
        "Measured by the plant",
    ):
        assert sentence in words(text)


def test_report_says_when_the_recorder_measured(lockstep: Record) -> None:
    arrivals = late(100, 0)
    timing = RunTiming(RECORDER, 9, 2, arrivals, arrivals, (), {"supervisor": "normal scheduling"}).as_json()
    shown = words(page([realtime(lockstep, timing)]))
    assert "Measured by the supervisor, by the arrival of each tick" in shown
    assert "2 of 9 polls missed" in shown
    assert "supervisor: normal scheduling; plant and controller were started elsewhere" in shown


@pytest.mark.slow
def test_several_runs_share_the_picture(lockstep: Record, document: dict) -> None:
    one = realtime(lockstep, document)
    two = one.copy_with(certificate={**one.certificate, "seed": 5})
    text = page([one, two, lockstep])
    assert text.count('<figure id="lateness">') == 1
    figure = words(text.partition('<figure id="lateness">')[2].partition("</figure>")[0])
    assert figure.count("ipfc") >= 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lateness": None}, "run.timing.lateness: found None, allowed a table"),
        ({"histogram": {"edges_ms": [1.0], "counts": [1]}}, "allowed rising edges above 0, a count between each two"),
        ({"histogram": {"edges_ms": [2.0, 1.0], "counts": [1]}}, "allowed rising edges above 0"),
        ({"histogram": {"edges_ms": [0.0, 1.0], "counts": [1]}}, "allowed rising edges above 0"),
        ({"missed_polls": "x"}, "run.timing.missed_polls: found 'x', allowed a whole number"),
        ({"scheduling": {"plant": 3}}, "run.timing.scheduling.plant: found 3, allowed a text"),
    ],
)
def test_damaged_timing_is_one_line(tmp_path: Path, document: dict, change: dict, message: str) -> None:
    score = {"telemetry": None, "run": {"sim_time_s": 1.0, "wall_time_s": 1.0, "timing": document}}
    write_json(tmp_path / "score.json", score)
    assert read_score(tmp_path) == json.loads(json.dumps(score))
    score["run"] = {**score["run"], "timing": {**document, **change}}
    write_json(tmp_path / "score.json", score)
    with pytest.raises(InputError) as caught:
        read_score(tmp_path)
    assert message in str(caught.value)
