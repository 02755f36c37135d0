"""Work of hand-made records: traction, regenerated, and the share of the bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.dbc import wire_contract
from railhil.record.trace import Trace
from railhil.scenarios.load import load
from railhil.systems.ato.energy.record import energy_share_percent, regenerated_kj, traction_work_kj
from railhil.systems.ato.scenario.canonical import judged_sha256, scenario_sha256
from railhil.systems.ato.scenario.effort import force_limit_n
from railhil.systems.ato.scenario.model import Effort
from railhil.wire.ato import SimTruth

YIZHUANG = load("yizhuang_05")


def record(truth: Callable[[int], tuple[float, float, float]], twice_at_ms: int = -1) -> Trace:
    """SIM_TRUTH every 20 ms for 10 s; ``truth`` gives speed (m/s), traction and brake (kN)."""
    trace = Trace(wire_contract())
    for ms in range(0, 10_001, 20):
        speed_mps, traction_kn, brake_kn = truth(ms)
        telegram = SimTruth(
            speed_01mmps=round(speed_mps * 1e4), traction_20n=round(traction_kn * 50), brake_20n=round(brake_kn * 50)
        )
        for _ in range(2 if ms == twice_at_ms else 1):
            trace.add(SimTruth.PORT, ms * 1_000_000, telegram.encode())
    return trace


def test_traction_work_is_force_times_way() -> None:
    assert traction_work_kj(record(lambda ms: (10.0, 50.0, 0.0))) == pytest.approx(50.0 * 100.0)
    assert traction_work_kj(record(lambda ms: (ms / 1000, 50.0, 0.0))) == pytest.approx(50.0 * 50.0)


def test_work_is_counted_between_two_times_only() -> None:
    trace = record(lambda ms: (10.0, 50.0 if ms < 5000 else 20.0, 0.0))
    assert traction_work_kj(trace, 6.0, 8.0) == pytest.approx(20.0 * 20.0)
    assert traction_work_kj(trace, 6.0) == pytest.approx(20.0 * 40.0)
    assert traction_work_kj(trace, 20.0) == 0.0


def test_a_telegram_that_was_recorded_twice_counts_once() -> None:
    assert traction_work_kj(record(lambda ms: (10.0, 50.0, 0.0), twice_at_ms=400)) == pytest.approx(5000.0)


def test_the_electric_brake_limits_what_is_fed_back() -> None:
    weak, strong = record(lambda ms: (10.0, 0.0, 100.0)), record(lambda ms: (10.0, 0.0, 300.0))
    assert regenerated_kj(YIZHUANG, weak) == pytest.approx(0.7 * 100.0 * 100.0)
    assert regenerated_kj(YIZHUANG, strong) == pytest.approx(0.7 * 166.0 * 100.0)
    assert regenerated_kj(YIZHUANG, strong, 2.0, 4.0) == pytest.approx(0.7 * 166.0 * 20.0)


def test_the_efficiency_is_that_of_the_scenario() -> None:
    half = replace(YIZHUANG, energy=replace(YIZHUANG.energy, regenerative_efficiency=0.35))
    trace = record(lambda ms: (10.0, 0.0, 100.0))
    assert regenerated_kj(half, trace) == pytest.approx(0.35 * 100.0 * 100.0)


def test_a_train_without_an_electric_brake_has_no_regenerated_work() -> None:
    assert regenerated_kj(load("lvshun_tieshan"), record(lambda ms: (10.0, 0.0, 100.0))) is None


def test_the_electric_brake_of_yizhuang_is_that_of_the_publications() -> None:
    brake = YIZHUANG.train.electric_brake
    assert brake is not None
    for kmh, force_kn in ((0, 166.0), (60, 166.0), (77, 166.0), (78.5, 159.6), (80, 153.92)):
        assert float(force_limit_n(brake, kmh / 3.6)) == pytest.approx(force_kn * 1000, rel=1e-3)


def test_the_share_is_a_percentage_of_the_bound() -> None:
    assert energy_share_percent(122.0, 100.0) == pytest.approx(122.0)
    assert energy_share_percent(1.0, 0.0) == inf


def test_electric_brake_and_efficiency_change_no_hash() -> None:
    plain = replace(YIZHUANG, train=replace(YIZHUANG.train, electric_brake=None))
    other = replace(YIZHUANG, train=replace(YIZHUANG.train, electric_brake=Effort(1.0)))
    assert scenario_sha256(plain) == scenario_sha256(other) == YIZHUANG.sha256
    assert judged_sha256(plain) == judged_sha256(other)
    half = replace(YIZHUANG, energy=replace(YIZHUANG.energy, regenerative_efficiency=0.35))
    assert scenario_sha256(half) == YIZHUANG.sha256


def test_a_curve_of_the_electric_brake_that_falls_back_is_refused_by_its_key(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    rows = "train.electric_brake = { force_max_kn = 166, curve_kmh_kn = [[0, 166], [80, 150], [70, 155]] }"
    file.write_text(f'extends = "yizhuang_05"\nname = "mine"\ntitle = "Mine"\n{rows}\n')
    with pytest.raises(InputError, match=r"train\.electric_brake\.curve_kmh_kn\[2\]: found"):
        load(str(file))
