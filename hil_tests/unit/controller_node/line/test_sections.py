"""The laws of the sections: what each of them sees, which controller drives, and what is reported of all of them."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import pytest

from hil_tests.unit.controller_node.line.world import four_stops
from railhil.controller_node.ato.control_loop import NO_BALISE
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.given.python import PythonObject
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.line.memory import join_memories, section_memory
from railhil.controller_node.line.place import Place
from railhil.controller_node.line.sections import SectionControllers
from railhil.controller_node.line.telemetry import SectionTelemetry
from railhil.controller_node.program.model import Quantity, Value
from railhil.controller_node.telemetry import Telemetry
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.target import Target

K = 60
BEFORE = BaliseReading(5, 12_000_100, 12_060_000)


class Seen:
    """A controller that notes its inputs."""

    notes = ()
    arithmetic = None

    def __init__(self) -> None:
        self.steps: list[tuple[Any, ...]] = []
        self.codes: list[int] = []
        self.law = object()
        self.law = type("NoLaw", (), {"track": True})()
        self.state = None

    def step(self, *given: Any) -> Any:
        self.steps.append(given)

    def sent(self, code: int) -> None:
        self.codes.append(code)


@lru_cache
def made(law: str = "ipfc_plus", regulation: str = "retime") -> SectionControllers:
    line = four_stops()
    return SectionControllers(replace(line, route=replace(line.route, regulation=regulation)), LawSpec(law))  # type: ignore[arg-type]


def test_a_law_sees_its_section_from_the_stopping_point_of_the_departure_stop() -> None:
    seen = Seen()
    sections = SectionControllers(four_stops(), LawSpec("ipfc_plus"), controller=seen)
    # The train stands 0.02 m beyond B at 1200 m; its odometer reads 6 m more.
    sections.depart(1, 335, 12_000_200, 12_060_200, BEFORE)
    sections.step(335, 0, 12_060_200, BEFORE)
    sections.step(345, 50_000, 12_160_200, BaliseReading(6, 33_300_000, 12_150_000))
    sections.step(346, 50_000, 12_170_200, BaliseReading(7, 33_800_000, 12_165_000))
    assert seen.steps == [
        (0, 0, 200, NO_BALISE),
        (10, 50_000, 100_200, BaliseReading(8, 21_300_000, 90_000)),
        (11, 50_000, 110_200, BaliseReading(9, 21_800_000, 105_000)),
    ]


def test_a_law_is_told_the_notch_only_while_it_drives() -> None:
    seen = Seen()
    sections = SectionControllers(four_stops(), LawSpec("ipfc_plus"), controller=seen)
    sections.sent(3)
    sections.depart(0, K, 0, 0, NO_BALISE)
    sections.sent(4)
    sections.rest()
    sections.sent(5)
    assert seen.codes == [4]


def test_the_first_section_steps_as_the_controller_of_its_own_scenario() -> None:
    from railhil.systems.line.scenario.sections import section_scenario

    sections = SectionControllers(four_stops(), LawSpec("ipfc_plus"))
    alone = Controller(section_scenario(four_stops(), 0), LawSpec("ipfc_plus"))
    sections.depart(0, K, 0, 0, NO_BALISE)
    for k in range(20):
        speed, place = 300 * k, 75 * k * k
        output = sections.step(K + k, speed, place)
        assert output == alone.step(k, speed, place)
    assert sections.telemetry.rows == alone.telemetry.rows
    assert sections.state is not None


def test_an_undisturbed_departure_drives_with_the_controller_that_was_ready() -> None:
    sections = SectionControllers(four_stops(), LawSpec("ipfc_plus"))
    ready = sections._ready[0]
    assert sections.depart(0, K, 0, 0, NO_BALISE).running_time_s == 107
    assert sections._acting is ready


def test_a_late_departure_is_aimed_at_the_arrival_of_the_timetable() -> None:
    sections = made()
    aim = sections.depart(1, 2 * 170, 12_000_000, 12_000_000, BEFORE)
    assert (aim.profile, aim.running_time_s) == ("timetable", 170)
    assert Target(sections._acting._loop._scenario.target).stop_time_s == pytest.approx(170)


def test_a_departure_that_was_expected_drives_with_the_controller_made_in_the_dwell() -> None:
    sections = SectionControllers(four_stops(), LawSpec("ipfc_plus"))
    sections.prepare(1, 2 * 170, 12_000_000)
    prepared = sections._prepared
    assert prepared is not None
    sections.depart(1, 2 * 170, 12_000_000, 12_000_000, BEFORE)
    assert sections._acting is prepared[2]
    assert sections._prepared is None
    sections.prepare(0, K, 0)
    assert sections._prepared is None


def test_a_law_without_position_is_aimed_at_the_distance_left() -> None:
    sections = made("ipfc")
    sections.depart(1, 2 * 167, 11_995_000, 12_000_000, BEFORE)
    target = Target(sections._acting._loop._scenario.target)
    assert target.stop_position_m == pytest.approx(2220.5)
    sections = made()
    sections.depart(1, 2 * 167, 11_995_000, 12_000_000, BEFORE)
    assert Target(sections._acting._loop._scenario.target).stop_position_m == pytest.approx(2220)


def test_without_regulation_every_departure_has_the_running_time_of_the_timetable() -> None:
    aim = made("ipfc_plus", "none").depart(1, 2 * 172, 12_000_000, 12_000_000, BEFORE)
    assert aim.running_time_s == 173


def test_from_a_halt_the_law_gets_a_curve_to_the_stop() -> None:
    sections = made()
    aim = sections.resume(1, 2 * 250, 20_000_000, 20_000_000, BEFORE)
    assert aim is not None
    target = Target(sections._acting._loop._scenario.target)
    assert (target.stop_position_m, target.stop_time_s) == (pytest.approx(1420), pytest.approx(aim.running_time_s))
    assert sections.resume(1, 2 * 250, 34_199_900, 34_199_900, BEFORE) is None


def test_the_estimate_leaves_out_a_shifted_balise_but_not_two_that_agree() -> None:
    place = Place()
    place.take(BaliseReading(1, 1_000_000, 1_001_000))
    assert place.at(1_011_000) == 1_010_000
    place.take(BaliseReading(2, 1_120_000, 1_101_000))
    assert (place.refused, place.at(1_101_000)) == (1, 1_100_000)
    place.take(BaliseReading(3, 1_220_000, 1_201_000))
    assert (place.refused, place.at(1_201_000)) == (1, 1_220_000)


def test_laws_with_other_quantities_are_reported_together() -> None:
    telemetry = SectionTelemetry()
    names = (("speed", "error"), ("speed", "trim"), ("speed", "error"))
    value = Value(0, 20)
    parts = [telemetry.join(Telemetry([Quantity(name, 20, "km/h", value) for name in row])) for row in names]
    assert parts[0] is parts[2]
    assert parts[0] is not parts[1]
    assert [quantity.name for quantity in telemetry.quantities] == ["speed", "error", "trim"]
    from railhil.controller_node.arithmetic import make

    number = make("iq")
    for part, values in ((parts[0], [5, 7]), (parts[1], [-9, 1])):
        number.noted = list(values)
        part.take(number)
    rows = telemetry.rows
    assert [(row.minimum_raw, row.maximum_raw, row.steps) for row in rows] == [(-9, 5, 2), (7, 7, 1), (1, 1, 1)]
    assert telemetry.steps == 2


def test_the_memory_of_a_line_has_an_entry_for_each_section(tmp_path: Any) -> None:
    kept = {
        index: {"key": f"section {index}", "values": {"gain": index}, "used": "A", "refused": []} for index in (0, 1)
    }
    joined = join_memories(four_stops(), kept)
    assert joined is not None
    record = MemoryRecord("learner", joined["key"], 1, 1, joined["values"])
    memory = Memory("learner", (MemoryPlace("A", record),), tmp_path)
    for index in (0, 1):
        newest = section_memory(memory, index).newest
        assert newest is not None
        assert (newest.key, newest.values) == (f"section {index}", {"gain": index})
    assert section_memory(memory, 2).stored[0].fault == "values"
    assert join_memories(four_stops(), {0: None}) is None


def test_code_of_the_user_computes_the_notch_of_every_section() -> None:
    def compute(reading: Any) -> float:
        return float(4 * (reading.set_point_mps - reading.speed_mps))

    given = PythonObject(compute)
    node = given.make_node(four_stops(), RunSpec(law=LawSpec.of_given(given)), fd=False, bit_rate=None)
    sections = node.controller
    codes = []
    for index, k in ((0, 60), (1, 334)):
        sections.depart(index, k, 12_000_000 * index, 12_000_000 * index, NO_BALISE)
        codes += [sections.step(k + later, 0, 12_000_000 * index).notch_code for later in (0, 4)]
    assert codes[0] == codes[2] == 0
    assert min(codes[1], codes[3]) > 0
