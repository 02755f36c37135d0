"""The whole plant on a line, moved as in a recorded run: no telegram of a controller changes a bit of what its train
protection demands or shows."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.replayed_line import Recording, first_difference, play, random_bytes, random_values
from railhil.plant_sim.atp.readings import Authority
from railhil.plant_sim.line.braked import BrakedTrain
from railhil.plant_sim.line.onboard import Onboard
from railhil.scenarios.load import load_any
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import NotchCmd
from railhil.wire.line import DoorCmd

#: Columns of :attr:`Recording.demands`.
_STATUS, _PERMITTED = 4, 7


def line() -> LineScenario:
    found = load_any(str(TEST_DATA / "tiny_line.toml"))
    assert isinstance(found, LineScenario)
    return found


@pytest.fixture(scope="module")
def recorded() -> Recording:
    with pytest.MonkeyPatch.context() as patch:
        return play(patch, line())


@pytest.mark.slow
def test_a_recorded_run_shows_the_protection_at_work(recorded: Recording) -> None:
    assert len({row[_STATUS] for row in recorded.demands}) > 1
    assert len({row[_PERMITTED] for row in recorded.demands}) > 100
    assert {world.is_held for world in recorded.worlds} == {True, False}
    assert len({world.journey["section"] for world in recorded.worlds}) == 3
    assert len({world.doors for world in recorded.worlds}) > 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_random_bytes_for_every_telegram_of_the_controller_change_no_bit_of_its_demands(
    recorded: Recording, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    replayed = play(monkeypatch, line(), recorded, random_bytes(Random(seed)))
    # Some of them pass the checks of the train all the same.
    assert 0 < replayed.passed[NotchCmd.PORT] < recorded.passed[NotchCmd.PORT] / 10
    assert 0 < replayed.passed[DoorCmd.PORT] < recorded.passed[DoorCmd.PORT] / 2
    assert not first_difference(recorded, replayed)


@pytest.mark.slow
def test_random_commands_that_the_train_accepts_change_no_bit_of_its_demands(
    recorded: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    replayed = play(monkeypatch, line(), recorded, random_values(Random(3)))
    assert replayed.passed == recorded.passed
    assert not first_difference(recorded, replayed)


def _is_held(train: Any, given: list[Any]) -> None:
    """A train that is held when the controller says so."""
    given[5] = train._hold_commanded


def _speed(train: Any, given: list[Any]) -> None:
    """A speed with a little of what the controller demands."""
    given[2] += 1e-3 * train.gate.notch_256th / 256


def _authority(train: Any, given: list[Any]) -> None:
    """An authority that ends a little later when the controller names a later stop."""
    given[3] = Authority(given[3].eoa_m + 1e-9 * train._order[1], given[3].svl_m, given[3].red_signal)


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("reads", [_is_held, _speed, _authority], ids=["brake", "notch", "station"])
def test_a_protection_that_read_a_value_of_the_controller_would_be_found(
    reads: Callable[[Any, list[Any]], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    look = BrakedTrain._look

    def look_at(train: BrakedTrain, onboard: Onboard) -> None:
        plain = onboard.look

        def changed(*given: Any) -> bool:
            values = list(given)
            reads(train, values)
            return plain(*values)

        onboard.look = changed  # type: ignore[method-assign]
        look(train, onboard)
        del onboard.look

    monkeypatch.setattr(BrakedTrain, "_look", look_at)
    recorded = play(monkeypatch, line())
    assert not first_difference(recorded, play(monkeypatch, line(), recorded))
    assert first_difference(recorded, play(monkeypatch, line(), recorded, random_values(Random(3))))
