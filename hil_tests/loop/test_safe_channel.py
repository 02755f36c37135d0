"""The safe channel (SDTv2) in the loop: attacks that plain telegrams do not notice, and the time to react."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import direct_run, local_run
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSource, source_identity
from railhil.common.errors import InputError
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import PlantNode, make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Safety, Scenario
from railhil.wire.ato import CtlCause, CtlMode, NotchCmd, NotchSdt, SpeedSdt, TrnSpeed, WatchCause, WatchLevel

#: The train is under traction.
ATTACK_TICK = 1000
#: Two telegrams of a safe port per this many ticks; after 256 telegrams the sequence counter repeats itself.
TICKS_PER_TELEGRAM = 2
COUNTER_TICKS = 256 * TICKS_PER_TELEGRAM
#: Beyond the ladder's own bounds: what the channel tolerates.
TOLERATED_S = 0.06


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return load(str(path))


@pytest.fixture(scope="module")
def safe(plain: Scenario) -> Scenario:
    return replace(plain, safety=Safety(sdt=True))


@pytest.mark.slow
def test_a_run_with_the_channel_is_a_run(safe: Scenario, tmp_path: Path) -> None:
    """On classic CAN and on CAN FD; nothing is refused (asserted for every run here)."""
    for fd in (False, True):
        (tmp_path / str(fd)).mkdir()
        run = local_run(safe, tmp_path / str(fd), fd=fd)
        assert run.ended is Event.ENDED_COMPLETE
        assert set(run.trace.raw(NotchCmd.PORT, "CtlMode")) == {CtlMode.RUNNING}
        assert run.trace.count(NotchSdt.PORT) == run.trace.count(NotchCmd.PORT)


def test_without_the_channel_its_ports_are_silent(plain: Scenario, tmp_path: Path) -> None:
    run = local_run(plain, tmp_path)
    assert run.trace.count(SpeedSdt.PORT) == run.trace.count(NotchSdt.PORT) == 0


# -- speed ------------------------------------------------------------------------------------------------------------


class SpeedAttack:
    """From :data:`ATTACK_TICK` on the controller gets other frames than those of TRN_SPEED and SPEED_SDT.

    :param change: the frames of a tick and those of all ticks so far -> the frames that arrive.
    """

    def __init__(self, change: Callable[[list[Frame], list[list[Frame]]], list[Frame]]) -> None:
        self._change = change
        self._ticks: list[list[Frame]] = []
        self._ids = {can_id for cls in (TrnSpeed, SpeedSdt) for can_id in cls.port().can_ids}

    def __call__(self, frame: Frame) -> list[Frame]:
        if frame.can_id not in self._ids:
            return [frame]
        if frame.can_id == TrnSpeed.port().address:
            self._ticks.append([])
        self._ticks[-1].append(frame)
        return [frame] if len(self._ticks) <= ATTACK_TICK else self._change([frame], self._ticks)


def replayed(frames: list[Frame], ticks: list[list[Frame]]) -> list[Frame]:
    """The frames of the moment when both counters were the same."""
    return [ticks[-1 - COUNTER_TICKS][len(ticks[-1]) - 1]]


def forged(frames: list[Frame], ticks: list[list[Frame]]) -> list[Frame]:
    """TRN_SPEED with right check sequence and life sign, and a speed that is 1 m/s too low."""
    if frames[0].can_id != TrnSpeed.port().address:
        return frames
    telegram = TrnSpeed.decode(frames[0].data[:4])
    telegram.speed_01mmps -= 10_000
    return TelegramSource(TrnSpeed.port()).frames(telegram.encode())


def masqueraded(frames: list[Frame], ticks: list[list[Frame]]) -> list[Frame]:
    """SPEED_SDT made by the source of another port: right in everything, but of another identity."""
    if frames[0].can_id == TrnSpeed.port().address:
        return frames
    if frames[0].can_id != SpeedSdt.port().can_ids[-1]:
        return []
    data = ticks[-1][1].data + ticks[-1][2].data
    stranger = SafeSource(source_identity(NotchSdt.port().address), SAFE_DATA_VERSION)
    for _ in range(data[11] + 1):
        data = stranger.secured(data)
    return TelegramSource(SpeedSdt.port()).frames(data)


def silenced(frames: list[Frame], ticks: list[list[Frame]]) -> list[Frame]:
    """Nothing of SPEED_SDT."""
    return frames if frames[0].can_id == TrnSpeed.port().address else []


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize(
    ("change", "counted"),
    [(replayed, "safe_time"), (forged, "safe_differs"), (masqueraded, "safe_crc"), (silenced, "")],
)
def test_a_speed_that_the_channel_does_not_confirm_stops_the_train(
    safe: Scenario,
    tmp_path: Path,
    change: Callable[[list[Frame], list[list[Frame]]], list[Frame]],
    counted: str,
) -> None:
    run = local_run(safe, tmp_path, wire=SpeedAttack(change))
    times_s, modes = run.trace.times_s(NotchCmd.PORT), run.trace.raw(NotchCmd.PORT, "CtlMode")
    bounds_s = {CtlMode.TRACTION_CUT: 0.07, CtlMode.SERVICE_BRAKE: 0.27, CtlMode.EMERGENCY: 1.02}
    for mode, bound_s in bounds_s.items():
        entered = modes >= mode
        # A forged speed that the train could have is taken once more before the next ones are refused as jumps.
        later_s = 0.3 if mode is CtlMode.EMERGENCY and change is forged else 0.0
        assert 0 < times_s[entered][0] - ATTACK_TICK / 100 <= bound_s + TOLERATED_S + later_s + 1e-9, mode
        # What is replayed or forged also contradicts what the train can do, and is then refused: either may be first.
        cause = run.trace.raw(NotchCmd.PORT, "CtlCause")[entered][0]
        assert cause in (CtlCause.SAFETY_CODE, CtlCause.SPEED_IMPLAUSIBLE, CtlCause.SPEED_AGE)
    assert not counted or run.counters["controller"][counted] > 0


# -- command ----------------------------------------------------------------------------------------------------------


class AnswerAttack:
    """After its death the controller's answers of before come again, at each poll the next one.

    :param back: how many answers before; a multiple of 256 has the same sequence counters.
    """

    def __init__(self, back: int) -> None:
        self._back = back
        self._answers: dict[int, list[list[Frame]]] = {}

    def __call__(self, answer: list[Frame]) -> list[Frame]:
        if not answer or answer[0].can_id not in (NotchCmd.port().address, NotchSdt.port().address):
            return answer
        old = self._answers.setdefault(answer[0].can_id, [])
        if len(old) * TICKS_PER_TELEGRAM < ATTACK_TICK:
            old.append(answer)
        else:
            old.append(old[-self._back])
        return old[-1]


def levels_of(scenario: Scenario, attack: Callable[[list[Frame]], list[Frame]]) -> tuple[list[int], PlantNode]:
    """Level of the train's watch from the attack on, tick by tick, for 2 s; 10 ms apart."""
    session, node = make_session(scenario, lambda line: None, RunSpec()), ControllerNode(scenario, LawSpec())
    plant = make_plant_node(scenario, RunSpec(), LocalBus([lambda frame: attack(node.handle(frame)), session.handle]))
    levels: list[int] = []
    advance = plant.plant.advance

    def advanced() -> None:
        advance()
        if plant.plant.tick > ATTACK_TICK:
            levels.append(plant.plant.watch_level)

    plant.plant.advance = advanced  # type: ignore[method-assign]
    plant.run()
    return levels, plant


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize("back", [16, 256])
def test_old_commands_of_a_dead_controller_do_not_keep_the_train_rolling(
    plain: Scenario, safe: Scenario, back: int
) -> None:
    levels, _ = levels_of(plain, AnswerAttack(back))
    assert set(levels[:200]) == {WatchLevel.NORMAL}, "the life sign of four bits notices nothing"
    levels, plant = levels_of(safe, AnswerAttack(back))
    for level, bound_ticks in (
        (WatchLevel.TRACTION_CUT, 7),
        (WatchLevel.SERVICE_BRAKE, 27),
        (WatchLevel.EMERGENCY, 102),
    ):
        assert next(tick for tick, found in enumerate(levels) if found >= level) <= bound_ticks
    assert plant.plant.watch_cause is WatchCause.SAFETY_CODE  # type: ignore[attr-defined]
    refused = plant.plant.refused
    assert refused["safe_time"] + refused.get("safe_out_of_sequence", 0) > 0


@pytest.mark.slow
@pytest.mark.faults
def test_a_forged_command_is_not_followed(plain: Scenario, safe: Scenario) -> None:
    """NOTCH_CMD with the next life sign and full traction; NOTCH_SDT says what the controller wants."""
    source = TelegramSource(NotchCmd.port())

    def attack(answer: list[Frame]) -> list[Frame]:
        if not answer or answer[0].can_id != NotchCmd.port().address:
            return answer
        command = NotchCmd.decode(answer[0].data[:4])
        return source.frames(NotchCmd(7 * 256, life=command.life).encode()) if command.life & 1 else answer

    _, plant = levels_of(plain, attack)
    assert set(plant.plant.refused) == {"accepted"}
    _, plant = levels_of(safe, attack)
    assert plant.plant.refused["safe_differs"] > 100


@pytest.mark.faults
def test_an_emergency_command_needs_no_confirmation(safe: Scenario) -> None:
    source = TelegramSource(NotchCmd.port())
    answers = 0

    def attack(answer: list[Frame]) -> list[Frame]:
        nonlocal answers
        if not answer or answer[0].can_id != NotchCmd.port().address:
            return answer
        answers += 1
        if answers * TICKS_PER_TELEGRAM < ATTACK_TICK:
            return answer
        command = NotchCmd.decode(answer[0].data[:4])
        return source.frames(NotchCmd(0, emergency=2, life=command.life).encode())

    levels, _ = levels_of(safe, attack)
    assert levels[0] == WatchLevel.EMERGENCY


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_a_controller_that_restarts_in_motion_brakes_and_is_believed(tmp_path: Path) -> None:
    """It does not know the time of the run; the train accepts its brake all the same, and is no emergency."""
    (tmp_path / "short.toml").write_text(RUN_72M_TOML)
    given = ("--set", "safety.sdt=true", "--fault", "controller restart @6s for 100ms")
    railhil("run", "short.toml", *given, "--bus", "local", "--no-report", "--out", "out", cwd=tmp_path)
    watches = json.loads((tmp_path / "out/score.json").read_text())["events"]["watches"]
    controller, train = watches["controller"]["worst"], watches["train"]["worst"]
    assert (controller["level"], controller["cause"]) == ("service_brake", "clock")
    assert (train["level"], train["cause"]) in (("traction_cut", "command_age"), ("service_brake", "command_age"))


# -- where there is none ----------------------------------------------------------------------------------------------


def test_what_has_no_safe_channel_says_so(safe: Scenario) -> None:
    with pytest.raises(InputError, match=r"safety\.sdt: found True, allowed false, or the run over a bus"):
        direct_run(safe)
    with pytest.raises(InputError, match=r"--task-period-ms: found 50, allowed 0 with safety\.sdt"):
        ControllerNode(safe, LawSpec(task_period_ms=50))
