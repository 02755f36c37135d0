"""A run out and back: the leg changes at the turn-back, at standstill, and the position goes on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.lines import Driver, out_and_back
from railhil.bus.codes import Event
from railhil.plant_sim.ato.plant_readings import AxleSensors
from railhil.plant_sim.line.onboard import NO_REACTION
from railhil.plant_sim.line.train import LineTrain
from railhil.systems.ato.scenario.model import Uniform
from railhil.systems.line.scenario.model import LinePerturbations
from railhil.wire.ato import TrkInfo
from railhil.wire.line import StnInfo


def begun() -> Driver:
    line = out_and_back()
    return Driver(LineTrain(line, 0), line)


def test_a_train_turns_back_and_runs_to_its_first_stop() -> None:
    driver = begun()
    train = driver.train
    driver.run(lambda: train.tick >= train.ending.due_tick and train.ending.reached(train.tick, False) is not None)
    assert train.ending.reached(train.tick, False) is Event.ENDED_COMPLETE
    kinds = driver.kinds()
    assert kinds[kinds.index("turn_back") - 1] == "departure"
    assert kinds.count("turn_back") == 1
    assert "atp" not in kinds
    assert [event.balise.number for event in driver.events if event.balise] == [*range(1, 6), *range(21, 26)]


def test_the_profiles_are_those_of_the_leg() -> None:
    driver = begun()
    driver.run(lambda: driver.train.station_here == 1)
    before = driver.train.grade_permil
    driver.run(lambda: "turn_back" in driver.kinds())
    assert driver.train.true_speed_01mmps == 0
    assert (round(before, 3), round(driver.train.grade_permil, 3)) == (-8.0, 8.0)
    station, track = (driver.train.makers[port]() for port in (StnInfo.PORT, TrkInfo.PORT))
    assert isinstance(station, StnInfo)
    assert isinstance(track, TrkInfo)
    assert (station.leg, station.section, station.next_stop_mm) == (1, 2, 2_400_000)
    assert track.speed_limit_4mmps == round(60 / 3.6 * 250)
    assert track.target_mm == 2_400_000


def test_the_protection_of_the_next_leg_expects_its_balises() -> None:
    driver = begun()
    driver.run(lambda: driver.kinds().count("arrived") == 2)
    onboard = driver.train.onboard
    assert onboard is not None
    assert onboard.reaction == NO_REACTION
    # Just behind the last balise of the leg.
    assert onboard.demands.uncertainty_m < 0.6


def test_the_protection_learns_nothing_of_the_true_place_at_the_turn_back() -> None:
    driver = begun()
    driver.run(lambda: driver.train.station_here == 1)
    onboard = driver.train.onboard
    assert onboard is not None
    place = onboard._protection.place
    place.refer(place.estimated_m + 3.0, onboard._odometer_m(driver.train.position_01mm / 1e4), 4.0)
    width_m, estimated_m = place.most_m - place.least_m, 0.5 * (place.most_m + place.least_m)
    onboard.enter(1, driver.train.position_01mm / 1e4)
    assert place.most_m - place.least_m == pytest.approx(width_m)
    assert place.estimated_m == pytest.approx(estimated_m, abs=0.02)


def test_the_mass_changes_at_stops_only() -> None:
    perturbations = LinePerturbations(section_mass_factor=Uniform(0.8, 1.2), atp_wheel_factor=Uniform(0.99, 0.99))
    line = replace(out_and_back(), perturbations=perturbations)
    train = LineTrain(line, 3, drawn=True)
    driver = Driver(train, line)
    masses = set()

    def seen() -> bool:
        masses.add((train.journey.section, train._constants.mass_kg))
        return driver.kinds().count("arrived") == 2

    driver.run(seen)
    by_section = dict(masses)
    assert len(masses) == 3
    # Before the first departure the train has the load of the first section.
    assert by_section[-1] == by_section[0] != by_section[1]
    assert train.onboard is not None
    axle = train.onboard.sensors
    assert isinstance(axle, AxleSensors)
    assert axle.sensors.wheel_factor == 0.99
