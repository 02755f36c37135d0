"""A run whose clock the test holds, and the bench that makes it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil_tests.support.short_runs import RUN_72M_TOML
from railhil import library
from railhil.common.errors import InputError
from railhil.testing import Bench, Live, kmh
from railhil.testing.settings import Settings


@pytest.fixture(scope="module")
def scenarios(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenarios")
    (folder / "short.toml").write_text(RUN_72M_TOML)
    return folder


@pytest.fixture
def bench(scenarios: Path, tmp_path: Path) -> Iterator[Bench]:
    made = Bench(Settings(), {"scenario": "short.toml"}, scenarios, tmp_path / "runs", "a_test")
    yield made
    made.close()


@pytest.mark.long
@pytest.mark.slow
def test_a_run_that_nobody_disturbs_is_the_ordinary_one(bench: Bench, scenarios: Path) -> None:
    with bench.start(seed=5) as live:
        assert live.step(100)
        assert live.time_s == 1.0
        run = live.finish()
        assert not live.step()
    ordinary = library.run(scenarios / "short.toml", seed=5, out=scenarios / "ordinary")
    assert run is live.result is bench.runs[0]
    assert run.frames_sha256 == ordinary.frames_sha256
    assert (run.verdict, run.reasons, run.scores) == (ordinary.verdict, ordinary.reasons, ordinary.scores)
    assert run.events == ordinary.events != ()
    assert {path.name for path in run.folder.iterdir()} == {path.name for path in ordinary.folder.iterdir()}
    assert run.folder.name == "a_test"


@pytest.mark.slow
def test_waiting_for_speed_place_and_telegrams(bench: Bench) -> None:
    with bench.start() as live:
        assert live.read("NOTCH_CMD")["NotchCmd"] != 0
        begun_s = live.wait_until(speed=kmh(10), timeout_s=20)
        assert 2.7 < live.read("SIM_TRUTH")["TrueSpeed"] < 2.9
        assert live.wait_until(position=30.0, timeout_s=20) > begun_s
        live.wait_until(speed=lambda mps: mps > 4.5, timeout_s=20)
        live.expect("NOTCH_CMD", NotchCmd=lambda notch: notch < 0, CtlMode="running", within_s=5)
        live.wait_until(speed=kmh(10), timeout_s=20)
        assert live.read("SIM_TRUTH")["TrueSpeed"] == pytest.approx(kmh(10), abs=0.05), "reached from above"
        live.wait_until("RUN_EVENT", RunEvent="stopped", timeout_s=20)
        live.wait_until("TRN_SPEED", TrainSpeed=0, timeout_s=20)
    run = live.result
    assert run is not None
    assert (run.verdict, run.disturbed) == ("INVALID", {})
    assert run.reasons[0].startswith("ended by the test at simulation time ")


@pytest.mark.slow
@pytest.mark.faults
def test_the_record_shows_what_was_lost_as_well(bench: Bench) -> None:
    run = bench.run(faults=["TRN_SPEED loss @3s x2"])
    assert run.disturbed["lost TRN_SPEED (gap)"] == 2


@pytest.mark.slow
def test_what_does_not_come_is_said(bench: Bench) -> None:
    with bench.start() as live:
        with pytest.raises(AssertionError, match=r"not within 0.5 s of simulation time, at 0.50 s: true speed .* 50"):
            live.wait_until(speed=50, timeout_s=0.5)
        with pytest.raises(AssertionError, match=r"at 0.60 s: NOTCH_CMD: NotchCmd .* notch, CtlMode running"):
            live.expect("NOTCH_CMD", NotchCmd=lambda notch: notch > 100, CtlMode="running", within_s=0.1)
        with pytest.raises(ValueError, match=r"no port 'NOTCH_CMB' \(did you mean NOTCH_CMD\?\)"):
            live.expect("NOTCH_CMB", within_s=1)
        with pytest.raises(ValueError, match="no signal of NOTCH_CMD 'Notch'"):
            live.wait_until("NOTCH_CMD", Notch=1, timeout_s=1)
        with pytest.raises(ValueError, match="no value of CtlMode 'walking'"):
            live.expect("NOTCH_CMD", CtlMode="walking", within_s=1)
        with pytest.raises(ValueError, match="speed or position"):
            live.wait_until(timeout_s=1)
        with pytest.raises(AssertionError, match="the run has ended"):
            live.wait_until(position=1000, timeout_s=1000)
    run = live.result
    assert run is not None
    assert "ended by the test" not in "".join(run.reasons), "it came to its own end"


def test_a_test_that_fails_leaves_its_record(bench: Bench) -> None:
    def fails(live: Live) -> None:
        with live:
            live.advance(0.995)
            raise KeyError

    live = bench.start()
    with pytest.raises(KeyError):
        fails(live)
    assert live.time_s == 1.0
    (run,) = bench.runs
    assert (run.folder / "frames.log").stat().st_size > 1000
    assert run.verdict == "INVALID"


def test_a_run_that_never_began_leaves_none(bench: Bench) -> None:
    live = bench.start()
    bench.close()
    assert live.result is None
    assert bench.runs == []


def test_what_the_bench_refuses(bench: Bench, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="bench: law: no such argument, expected seed, "):
        bench.run(law="ipfc")
    with pytest.raises(InputError, match="controller: found 'pfc'"):
        bench.start(controller="pfc")
    over_hub = Bench(Settings(bus="hub"), {}, tmp_path, tmp_path, "hub")
    with pytest.raises(InputError, match="on a bus the test does not hold the clock"):
        over_hub.start()


@pytest.mark.slow
@pytest.mark.faults
def test_a_fault_by_hand_is_one_of_the_run(bench: Bench) -> None:
    """What has been seen before stays as it was; the run again from its description has the same bytes."""
    with bench.start() as live:
        live.wait_until(speed=kmh(10), timeout_s=20)
        before_s, before = live.time_s, live.read("SIM_TRUTH")
        live.inject("TRN_SPEED loss for 400ms")
        assert (live.time_s, live.read("SIM_TRUTH")) == (before_s, before)
        cut_s = live.expect("NOTCH_CMD", CtlMode="traction cut", within_s=0.5)
        live.inject("TRN_POS loss 50% @v<5km/h")
        run = live.finish()
    first, second = run.faults
    assert (first.fired, first.begun_s, first.effect_s) == (True, before_s + 0.01, before_s + 0.01)
    assert second.fired
    assert run.spec.faults == (f"TRN_SPEED loss @{before_s + 0.01:.10g}s for 400ms", "TRN_POS loss 50% @v<5km/h")
    assert run.reaction("TRACTION CUT").time_s == pytest.approx(cut_s, abs=0.011)
    assert library.run(run.spec).frames_sha256 == run.frames_sha256
    with pytest.raises(AssertionError, match="inject: the run has ended"):
        live.inject("TRN_SPEED loss")


@pytest.mark.slow
@pytest.mark.faults
def test_when_the_watches_react(bench: Bench) -> None:
    fault = "TRN_SPEED loss @5s for 200ms"
    run = bench.run(faults=[fault])
    cut = run.reaction("TRACTION CUT")
    assert cut.happened
    assert 0.05 < cut.after_s(fault) == cut.after_s(0) == cut.after_s(run.faults[0]) < 0.1
    assert run.reaction("hold").after_s(fault) < cut.after_s(fault)
    assert run.reaction("EMERGENCY").after_s(fault) == math.inf
    assert not run.reaction("EMERGENCY").happened
    with pytest.raises(ValueError, match=r"no level 'PANIC' of the watches, allowed HOLD, TRACTION CUT"):
        run.reaction("PANIC")
    with pytest.raises(ValueError, match="no fault 'TRN_SPEED loss' in this run"):
        cut.after_s("TRN_SPEED loss")
    never = bench.run(faults=["TRN_SPEED loss @5000s"])
    assert (never.verdict, never.faults[0].fired) == ("INVALID", False)
    with pytest.raises(AssertionError, match="never began"):
        never.reaction("HOLD").after_s(0)


def test_scores_of_a_train_that_did_not_stop_meet_no_limit(bench: Bench) -> None:
    with bench.start() as live:
        pass
    assert live.result is not None
    score = live.result.score
    assert not abs(score.stop_error_m) <= 1e9
    assert "stop_error_m" in dir(score)
    with pytest.raises(AttributeError, match="no score 'stop': this run has comfort"):
        score.stop  # noqa: B018
