"""The plant's faulty sensors and balise reader alone, each at its edges."""

from __future__ import annotations

from math import exp
from typing import Any

from hil_tests.support.plant_faults import fault, made, said
from hil_tests.support.scripted import Scripted
from railhil.faults.model import Fault
from railhil.faults.sensors import Quantity, Reading
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.readings import BaliseReport, FaultyReader, FaultySensor, quantity_of
from railhil.wire.ato import TrnSpeed

QUANTITY = Quantity(100.0, -1000, 999)


def test_a_quantity_keeps_to_its_signal() -> None:
    assert quantity_of(TrnSpeed, "speed_01mmps", 1e4) == Quantity(1e4, -(1 << 23), (1 << 23) - 1)
    assert [QUANTITY.raw(value) for value in (1.234, -1.236, 9.99, 10.0, 99.0, -10.0, -99.0)] == [
        123, -124, 999, 999, 999, -1000, -1000,
    ]  # fmt: skip


def test_a_train_with_one_sensor_has_the_faults_of_all_units() -> None:
    injections = made(fault("sensor.speed", "off", units=(2,)))
    assert FaultySensor(injections, QUANTITY, 0.1, "speed")
    assert [bool(FaultySensor(injections, QUANTITY, 0.1, "speed", unit=unit)) for unit in (1, 2)] == [False, True]


def sensed(*faults: Fault, raw: list[int], tick_s: float = 0.1) -> list[Reading]:
    injections = Injections(list(enumerate(faults, 1)), 0, round(tick_s * 1e9))
    sensor = FaultySensor(injections, QUANTITY, tick_s, "speed")
    assert (sensor.reading, sensor.error) == (Reading(0, True), 0)
    found = []
    for tick, value in enumerate(raw):
        injections.look(tick, 0.0, 0.0)
        sensor.sample(value)
        assert sensor.error == sensor.reading.raw - value
        found.append(sensor.reading)
    return found


def raws(*faults: Fault, raw: list[int]) -> list[int]:
    return [reading.raw for reading in sensed(*faults, raw=raw)]


def test_words_of_a_sensor_at_their_edges() -> None:
    # The fault's own time counts from its beginning, anew each time.
    assert raws(fault("sensor.speed", "drift", 0.2, {"per_s": 1.0}), raw=[500] * 6) == [500, 500, 500, 510, 520, 530]
    assert raws(fault("sensor.speed", "delayed", 0.0, {"delay_s": 0.2}), raw=[1, 2, 3, 4]) == [1, 1, 1, 2]
    # From its beginning on it lags from the reading of that instant.
    share = 1 - exp(-0.1 / 0.4)
    slow = raws(fault("sensor.speed", "slow", 0.1, {"time_constant_s": 0.4}), raw=[0, 400, 800, 800])
    assert slow == [0, 400, round(400 + 400 * share), round(400 + 400 * share + (400 - 400 * share) * share)]
    assert raws(fault("sensor.speed", "wrong", 0.0, {"factor": -1.5}), raw=[100, 801]) == [-150, -1000]
    assert raws(fault("sensor.speed", "jump", 0.1, {"distance_m": 2.0}), raw=[100, 101, 900]) == [100, 301, 999]
    assert raws(fault("sensor.speed", "jump", 0.0, {"distance_m": -2.0}), raw=[100]) == [-100]
    # What is not valid stays so, whatever comes behind.
    off = fault("sensor.speed", "off")
    for what, values in (
        ("wrong", {"factor": 2.0}), ("offset", {"error": 1.0}), ("slow", {"time_constant_s": 1.0}), ("stuck", {}),
        ("delayed", {"delay_s": 0.1}),
    ):  # fmt: skip
        assert [one.valid for one in sensed(off, fault("sensor.speed", what, 0.0, values), raw=[1, 2])] == [False] * 2
    # A given one is valid again.
    assert sensed(off, fault("sensor.speed", "value", 0.0, {"value": 1.0}), raw=[5]) == [Reading(100, True)]


def test_a_fault_that_begins_again_begins_anew() -> None:
    """By ``ok`` and another one of its kind; each has its own memory."""
    stuck = fault("sensor.speed", "stuck", 0.1, duration_s=0.2)
    assert raws(stuck, fault("sensor.speed", "stuck", 0.4), raw=[1, 2, 3, 4, 5, 6]) == [1, 2, 2, 4, 5, 5]


def test_random_words_of_a_sensor() -> None:
    injections = made(fault("sensor.speed", "garbage"), fault("sensor.speed", "intermittent", 0.0, {"share": 0.3}))
    sensor = FaultySensor(injections, QUANTITY, 0.1, "speed")
    garbage, intermittent = sensor._faults
    drawn: list[Any] = []
    garbage.source = type(  # type: ignore[assignment]
        "Source", (), {"integers": lambda self, low, high, endpoint: drawn.append((low, high, endpoint)) or 7}
    )()
    intermittent.source = Scripted((0.3, 0.2999))  # type: ignore[assignment]
    injections.look(0, 0.0, 0.0)
    sensor.sample(5)
    assert sensor.reading == Reading(7)
    sensor.sample(5)
    assert (sensor.reading, sensor.error) == (Reading(0, False), -5)
    assert drawn == [(-1000, 999, True)] * 2


def test_noise_is_of_its_standard_deviation() -> None:
    noise = fault("sensor.speed", "noise", 0.0, {"sigma": 2.0})
    drawn = made(noise).samples(made(noise).activities[0])
    sensor = FaultySensor(made(noise), QUANTITY, 0.1, "speed")
    sensor._faults[0].activity.active = True
    for _ in range(3):
        sensor.sample(5)
        assert sensor.reading == Reading(round((0.05 + 2.0 * drawn.standard_normal()) * 100))


def test_a_change_counts_when_it_is_sent() -> None:
    injections = made(fault("sensor.speed", "offset", 0.0, {"error": 1.0}), fault("sensor.speed", "off"))
    sensor = FaultySensor(injections, QUANTITY, 0.1, "speed")
    injections.look(0, 0.0, 0.0)
    sensor.sample(5)
    sensor.sample(6)
    assert said(injections) == []
    assert sensor.sent() == Reading(0, False)
    assert said(injections) == [(4, "6", "106"), (5, "106", "invalid")]
    # Once for each sample.
    sensor.sent()
    assert len(said(injections)) == 2
    assert bool(sensor)
    assert not FaultySensor(injections, QUANTITY, 0.1, "position")
    assert not FaultySensor(made(fault("sensor.speed", "ok")), QUANTITY, 0.1, "speed")


def test_reports_of_a_balise() -> None:
    balise = BaliseReport(7, 100.5)

    def reported(*faults: Fault) -> tuple[list[BaliseReport], list[tuple[int, str, str]]]:
        injections = made(*faults)
        injections.look(0, 0.0, 0.0)
        return FaultyReader(injections).reported(balise), said(injections)

    at = "sensor.balise"
    assert reported() == ([balise], [])
    assert reported(fault(at, "missed", 9.0)) == ([balise], [])
    assert reported(fault(at, "missed")) == ([], [(4, "7:100.5", "none")])
    assert reported(fault(at, "doubled")) == ([balise] * 2, [(4, "7:100.5", "7:100.5 7:100.5")])
    assert reported(fault(at, "wrong", 0.0, {"error_m": -2.0})) == (
        [BaliseReport(7, 98.5)], [(4, "7:100.5", "7:98.5")],
    )  # fmt: skip
    unread = BaliseReport(7, 0.0, valid=False)
    assert reported(fault(at, "off")) == ([unread], [(4, "7:100.5", "invalid")])
    assert reported(fault(at, "intermittent", 0.0, {"share": 1.0}))[0] == [unread]
    assert reported(fault(at, "intermittent", 0.0, {"share": 0.0})) == ([balise], [])
    # In the order of their numbers; one that changes nothing more is not noted.
    assert reported(fault(at, "off"), fault(at, "doubled"), fault(at, "off")) == (
        [unread] * 2, [(4, "7:100.5", "invalid"), (5, "invalid", "invalid invalid")],
    )  # fmt: skip
    assert reported(fault(at, "missed"), fault(at, "doubled")) == ([], [(4, "7:100.5", "none")])


def test_a_share_of_the_balises_is_not_read() -> None:
    injections = made(fault("sensor.balise", "intermittent", 0.0, {"share": 0.3}))
    injections.look(0, 0.0, 0.0)
    reader = FaultyReader(injections)
    reader._faults = [(injections.activities[0], Scripted((0.3, 0.2999)))]  # type: ignore[list-item]
    assert [reader.reported(BaliseReport(1, 2.0))[0].valid for _ in range(2)] == [True, False]
