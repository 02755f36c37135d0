"""The monitors of the speed channel: its latency in ticks, events against time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from railhil.controller_node.ato.speed_monitors import CHANNEL_WINDOW_MS, DISORDER_MAX_MS, DISORDER_MS, Debt, Latency
from railhil.scenarios.load import load
from railhil.wire.ato import NotchCmd, TrnSpeed

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000


def with_periods(speed_ms: int, notch_ms: int, traction_cut_ms: int = SCENARIO.watch.traction_cut_ms) -> Latency:
    periods = {TrnSpeed.PORT: speed_ms * MS, NotchCmd.PORT: notch_ms * MS}
    timing = replace(SCENARIO.timing, port_period_ns=periods)
    watch = replace(SCENARIO.watch, traction_cut_ms=traction_cut_ms)
    return Latency(replace(SCENARIO, timing=timing, watch=watch))


# -- latency ----------------------------------------------------------------------------------------------------------


def test_published_numbers() -> None:
    assert (CHANNEL_WINDOW_MS, DISORDER_MS, DISORDER_MAX_MS) == (10_000, 20, 80)


@pytest.mark.parametrize(("speed_ms", "notch_ms", "limit_ticks"), [(10, 20, 8), (50, 30, 11), (40, 80, 14)])
def test_the_latency_without_telegrams_against_its_definition(speed_ms: int, notch_ms: int, limit_ticks: int) -> None:
    """Telegrams after the first poll, then only polls: latency in ticks, modulo 16 telegrams."""
    for telegrams in (0, 1):
        latency = with_periods(speed_ms, notch_ms)
        assert latency.limit_ticks == limit_ticks
        assert latency.poll_ticks == notch_ms // 10
        latency.received(5)
        assert not latency.polled()
        for life in range(telegrams):
            latency.received(6 + life)
        turn = 16 * speed_ms // 10
        behind = [notch_ms // 10 * count - speed_ms // 10 * telegrams for count in range(1, 60)]
        if behind[0] < 0:
            # Ahead is the new normal.
            behind = [ticks - behind[0] for ticks in behind]
        assert [latency.polled() for _ in behind] == [ticks % turn > limit_ticks for ticks in behind]


def test_the_first_telegram_may_come_after_the_first_poll() -> None:
    latency = Latency(SCENARIO)
    latency.polled()
    for life in (0, 1):
        latency.received(life)
    # 2 ticks a poll, less one for the second telegram: 1, 3, 5, 7, 9.
    assert [latency.polled() for _ in range(5)] == [False] * 4 + [True]


def test_telegrams_ahead_by_one_tick_are_the_new_normal() -> None:
    latency = Latency(SCENARIO)
    latency.polled()
    for life in (1, 2, 3):
        latency.received(life)
    assert [latency.polled() for _ in range(5)] == [False] * 5
    latency.received(4)
    assert latency.polled()


def test_an_old_telegram_makes_the_next_poll_normal() -> None:
    latency = Latency(SCENARIO)
    assert [latency.polled() for _ in range(6)] == [False] * 5 + [True]
    assert [latency.doubt(), latency.doubt(), latency.doubt()] == [False, True, True]
    assert [latency.polled() for _ in range(6)] == [False] * 5 + [True]
    latency.received(1)
    assert not latency.doubt()


def test_the_limit_is_rounded_down_to_ticks() -> None:
    own_ticks = 2
    for traction_cut_ms, ticks in ((60, 6), (69, 6), (1_000_009, 100_000)):
        assert with_periods(10, 20, traction_cut_ms).limit_ticks == ticks + own_ticks


def delayed(latency: Latency, ticks: int, delay: int, *, begin: int = 100, drift_ppm: float = 0.0) -> list[int]:
    """Ticks of the polls that find the telegrams stale; from ``begin`` on each telegram is late by ``delay`` ticks."""
    stale, life, sent = [], 0, 0
    for tick in range(ticks):
        due = tick - (delay if tick >= begin else 0)
        arrived = min(max(due, sent), round(due * (1 + drift_ppm / 1e6)) if drift_ppm else due)
        while sent <= arrived:
            latency.received(life % 16)
            life, sent = life + 1, sent + 1
        if tick % 2 == 0 and latency.polled():
            stale.append(tick)
    return stale


@pytest.mark.parametrize(("delay_ms", "is_stale"), [(0, False), (20, False), (60, False), (90, True), (150, True)])
def test_a_delay_is_seen_though_the_telegrams_come_one_after_another(delay_ms: int, is_stale: bool) -> None:
    stale = delayed(Latency(SCENARIO), 1000, delay_ms // 10)
    assert bool(stale) == is_stale
    # To the end: a delay is not taken for normal.
    assert not is_stale or stale[-1] == 998


def test_a_delay_is_measured_modulo_a_turn_of_the_life_sign() -> None:
    assert delayed(Latency(SCENARIO), 1000, 16)[-1:] != [998]
    assert delayed(Latency(SCENARIO), 1000, 16 + 10)[-1:] == [998]


@pytest.mark.parametrize("drift_ppm", [-100.0, 100.0])
def test_clocks_that_drift_are_no_delay(drift_ppm: float) -> None:
    assert delayed(Latency(SCENARIO), 19_500, 0, drift_ppm=drift_ppm) == []


def test_jitter_and_lost_polls_are_no_delay() -> None:
    latency = Latency(SCENARIO)
    for tick in range(2000):
        if tick % 3 == 0:
            # Three at once.
            for life in range(tick, tick + 3):
                latency.received(life % 16)
        if tick % 2 == 0 and not 500 < tick < 620:
            assert not latency.polled(), tick


def test_ports_on_other_periods() -> None:
    timing = replace(SCENARIO.timing, port_period_ns={TrnSpeed.PORT: 50 * MS, NotchCmd.PORT: 30 * MS})
    latency = Latency(replace(SCENARIO, timing=timing))
    for tick in range(600):
        if tick % 5 == 0:
            latency.received(tick // 5 % 16)
        if tick % 3 == 0:
            assert not latency.polled()


# -- events against time ---------------------------------------------------------------------------------------------


def test_events_against_time() -> None:
    debt = Debt(10, 30)
    assert [debt.add(at_ms) for at_ms in (100, 100, 100, 100, 100)] == [False, False, False, True, True]
    # Never more than twice the limit, and paid by time.
    assert [debt.add(100) for _ in range(5)] == [True] * 5
    assert not debt.add(140)
    # A clock that was set back pays nothing.
    assert debt.add(0)
    assert all(not debt.add(10 * count) for count in range(10, 60))


def test_the_debt_at_its_edges() -> None:
    # Nothing is paid at the same instant, nothing owed at the beginning.
    debt = Debt(10, 30)
    assert [debt.add(at_ms) for at_ms in (0, 0, 0, 0)] == [False, False, False, True]
    debt = Debt(10, 29)
    assert [debt.add(at_ms) for at_ms in (100, 100, 100)] == [False, False, True]
    # A clock that runs backwards neither pays nor costs.
    debt = Debt(10, 30)
    assert [debt.add(at_ms) for at_ms in (100, 99, 98, 98)] == [False, False, False, True]
    # Time does not pay in advance.
    debt = Debt(10, 9)
    assert [debt.add(at_ms) for at_ms in (100, 500)] == [True, True]


def test_time_pays_at_its_rate() -> None:
    """30 events are permitted, each paid in a third of a second and 1/3 ms."""
    debt = Debt(10_000, 300_000, 30)
    assert [debt.add(0) for _ in range(31)] == [*[False] * 30, True]
    # One too many: at 666 ms less than two are paid, at 1 s three.
    assert debt.add(666)
    assert not debt.add(1000)
