"""The laws of a line, one for each section: made before the first departure, aimed again at each departure.

A law sees only its section: control periods since the departure, positions from the stopping point of the departure
stop, balises by their number in the section. All laws run on one arithmetic, so its counters are those of the run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final

from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Counters
from railhil.controller_node.ato.control_loop import NO_BALISE, ControlLoop
from railhil.controller_node.ato.controller import COMMANDS, WIRE, Controller, ControlOutput
from railhil.controller_node.given.computing import SkeletonLaw
from railhil.controller_node.law_controller import CommandCode
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.line.memory import join_memories, section_memory
from railhil.controller_node.line.telemetry import SectionTelemetry
from railhil.controller_node.program.ranges import Interval
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import fastest_time_s, generate
from railhil.systems.ato.scenario.model import Scenario, TargetCurve
from railhil.systems.line.scenario.model import LineScenario, Mode
from railhil.systems.line.scenario.sections import (
    RUNNING_TIME_MAX_RATIO,
    choose_running_time,
    cut_section,
    make_target,
    section_scenario,
)

#: Reserve over the fastest curve from a halt, where no time is left.
HALT_RESERVE: Final = 1.05
_PER_M: Final = 10_000


@dataclass(frozen=True, slots=True)
class Aim:
    """What was chosen at a departure: ``timetable`` or the name of a profile, and the running time."""

    profile: str
    running_time_s: float


@mypyc_attr(allow_interpreted_subclasses=True)
class SectionControllers:
    """Controllers of all sections behind the interface of one (:class:`~..law_controller.LawController`).

    Made with the timetable's curves. :meth:`depart` chooses the running time of a section; where it is not the
    timetable's, or the law does not see where it stands, the section gets a new controller, at standstill.

    :param law: a law of the system and the way to run it.
    :param controller: computes the notch of every section instead of a law; None: the law.
    :raises InputError: a law cannot be made for a section.
    """

    loop: ClassVar[type[Any]] = ControlLoop
    commands: ClassVar[tuple[CommandCode, ...]] = COMMANDS
    wire: ClassVar[Mapping[str, Interval]] = WIRE

    def __init__(
        self,
        scenario: LineScenario,
        law: LawSpec,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
        controller: Any = None,
    ) -> None:
        self._scenario, self._law_spec, self._may_wrap = scenario, law, may_wrap
        self._given = controller
        own = getattr(controller, "arithmetic", None)
        self.arithmetic: Arithmetic[Any] = arithmetic or own or make(law.arithmetic)
        self._telemetry = SectionTelemetry()
        count = len(scenario.sections)
        #: Number of the section that the law drives, from 0; -1: before the first departure.
        self.index = -1
        # The controllers of the timetable, until they are used, and those that have driven.
        self._ready: list[Any] = [self._make(index, section_scenario(scenario, index)) for index in range(count)]
        self._lead: Any = self._ready[0]
        self._driven: dict[int, Any] = {}
        self._acting: Any = None
        # Section, curve and controller of a departure that is expected.
        self._prepared: tuple[int, TargetCurve, Any] | None = None
        #: The law's notes.
        self.notes: Any = self._lead.notes
        self._from_k = 0
        self._offset_01mm = 0
        self._stop_01mm = 0
        self._end_01mm = 0
        self._balises_01mm: tuple[int, ...] = ()
        self._balise_before: BaliseReading[int] = NO_BALISE
        self._balise_of: BaliseReading[int] = NO_BALISE
        self._balise: BaliseReading[int] = NO_BALISE

    def _make(self, index: int, section: Scenario) -> Any:
        if self._given is not None:
            return self._given
        spec = self._law_spec
        if spec.memory is not None:
            spec = replace(spec, memory=section_memory(spec.memory, index))
        number = self.arithmetic
        # The making of a law is not part of a control period.
        number.noted = None
        made = Controller(section, spec, number, may_wrap=self._may_wrap)
        made.telemetry = self._telemetry.join(made.telemetry)
        return made

    # -- one controller ------------------------------------------------------------------------------------------------

    @property
    def law(self) -> Any:
        """The law of the first section; that of a user's code computes for all of them."""
        return self._lead.law

    @property
    def program(self) -> Any:
        """Program of the first section's law."""
        return self._lead.program

    @property
    def cost(self) -> Any:
        """Cost of a control period, in the section where it is largest."""
        return max((made.cost for made in self._ready), key=lambda cost: int(cost.cycles))

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero in all sections."""
        return self.arithmetic.counters

    @property
    def telemetry(self) -> Any:
        """Quantities of the laws of all sections."""
        return self._telemetry if self._given is None else self._given.telemetry

    @property
    def state(self) -> Any:
        """State of the law that drives; None before its first step."""
        return None if self._acting is None else self._acting.state

    def kept(self) -> dict[str, Any] | None:
        """Key and values of the laws' memory, with an entry for each section; None for a law that keeps none.

        :raises InputError: a law has raised, or its answer cannot be stored in a file.
        """
        if self._given is not None:
            found: dict[str, Any] | None = self._given.kept()
            return found
        return join_memories(self._scenario, {index: made.kept() for index, made in self._driven.items()})

    # -- sections ------------------------------------------------------------------------------------------------------

    @property
    def sees_place(self) -> bool:
        """Whether the law uses its position, so that it sees where it really departs."""
        return bool(self._lead.law.track) or self._law_spec.over_distance

    @property
    def end_01mm(self) -> int:
        """Stopping point at the end of the section, in 0.1 mm of the odometer's origin."""
        return self._end_01mm

    def depart(
        self,
        index: int,
        k: int,
        place_01mm: int,
        odometer_01mm: int,
        balise: BaliseReading[int],
        mode: Mode = "timetable",
    ) -> Aim:
        """Begin a section at standstill.

        :param index: number of the section, from 0.
        :param k: the control period of the departure.
        :param place_01mm: estimate of the position in the run.
        :param balise: the last one passed, which belongs to the section before.
        :param mode: what the track side orders.
        """
        line = self._scenario
        aim, target = self._choose(index, k, place_01mm, mode)
        prepared, self._prepared = self._prepared, None
        made = self._take_ready(index) if target == line.sections[index].target else None
        if made is None and prepared is not None and prepared[:2] == (index, target):
            made = prepared[2]
        if made is None:
            made = self._make(index, section_scenario(line, index, target, aim.running_time_s))
        here = line.stops[line.sections[index].departure]
        self._begin(index, made, k, here.position_m, place_01mm, odometer_01mm, balise)
        return aim

    def prepare(self, index: int, k: int, place_01mm: int, mode: Mode = "timetable") -> None:
        """Make the controller of a departure that is expected, during the dwell; arguments as :meth:`depart`."""
        line = self._scenario
        aim, target = self._choose(index, k, place_01mm, mode)
        is_ready = target == line.sections[index].target and self._take_ready(index) is not None
        if not is_ready:
            made = self._make(index, section_scenario(line, index, target, aim.running_time_s))
            self._prepared = index, target, made

    def _choose(self, index: int, k: int, place_01mm: int, mode: Mode) -> tuple[Aim, TargetCurve]:
        """Running time and target curve of a departure."""
        line = self._scenario
        section = line.sections[index]
        stop_m = line.stops[section.arrival].position_m
        departure_s = k * line.timing.control_period_ns / 1e9
        profile, running_time_s, curve = choose_running_time(line, index, departure_s, mode)
        plain_m = stop_m - line.stops[section.departure].position_m
        distance_m = plain_m if self.sees_place else stop_m - place_01mm / _PER_M
        try:
            return Aim(profile, running_time_s), make_target(line, index, running_time_s, distance_m, curve)
        except CurveError:
            # No curve is as fast as that: the one of the timetable, as if nothing had been lost.
            return Aim("timetable", section.running_time_s), section.target

    def resume(self, index: int, k: int, place_01mm: int, odometer_01mm: int, balise: BaliseReading[int]) -> Aim | None:
        """Begin the rest of a section from a halt between two stops; arguments as :meth:`depart`.

        None: no curve leads to the stop.
        """
        line = self._scenario
        section = line.sections[index]
        there, from_m = line.stops[section.arrival], place_01mm / _PER_M
        distance_m = there.position_m - from_m
        track = cut_section(line.legs[section.leg], line.train, from_m, there.position_m, f"to {there.name}")
        left_s = (there.arrive_s or 0.0) - k * line.timing.control_period_ns / 1e9
        try:
            fastest_s = fastest_time_s(track, line.train, distance_m, line.route.generate)
            running_time_s = min(max(left_s, fastest_s * HALT_RESERVE), fastest_s * RUNNING_TIME_MAX_RATIO)
            target = generate(track, line.train, distance_m, running_time_s, line.route.generate)
        except CurveError:
            return None
        self._begin(
            index, self._make(index, self._rest(index, target, running_time_s, from_m)), k, from_m, place_01mm,
            odometer_01mm, balise,
        )  # fmt: skip
        return Aim("timetable", running_time_s)

    def _rest(self, index: int, target: TargetCurve, running_time_s: float, from_m: float) -> Scenario:
        """The rest of a section as a scenario, in coordinates that begin where the train stands."""
        line = self._scenario
        section = line.sections[index]
        there = line.stops[section.arrival]
        whole = section_scenario(line, index, target, running_time_s)
        track = cut_section(line.legs[section.leg], line.train, from_m, there.position_m, whole.line.name)
        return replace(whole, line=track, plan=replace(whole.plan, distance_m=there.position_m - from_m))

    def rejoin(self, index: int, odometer_01mm: int, place_01mm: int, balise: BaliseReading[int]) -> Aim:
        """Take over a moving train: the section as if it had begun at its time and place."""
        line = self._scenario
        section = line.sections[index]
        here = line.stops[section.departure]
        k = round((here.depart_s or 0.0) * 1e9) // line.timing.control_period_ns
        made = self._take_ready(index) or self._make(index, section_scenario(line, index))
        self._begin(index, made, k, here.position_m, place_01mm, odometer_01mm, balise)
        return Aim("timetable", section.running_time_s)

    def _take_ready(self, index: int) -> Any:
        """The controller of the timetable, once: a law that has driven does not begin again."""
        if self._given is not None:
            return self._given
        made = self._ready[index]
        return None if made.state is not None else made

    def _begin(
        self,
        index: int,
        made: Any,
        k: int,
        from_m: float,
        place_01mm: int,
        odometer_01mm: int,
        balise: BaliseReading[int],
    ) -> None:
        stop_01mm = round(from_m * _PER_M)
        if isinstance(made.law, SkeletonLaw) and made.law is not self._lead.law:
            made.law.share(self._lead.law)
        self.index, self._acting, self._driven[index] = index, made, made
        self._from_k = k
        self._stop_01mm = stop_01mm
        self._offset_01mm = odometer_01mm - (place_01mm - stop_01mm)
        line = self._scenario
        section = line.sections[index]
        self._end_01mm = round(line.stops[section.arrival].position_m * _PER_M)
        self._balises_01mm = tuple(
            round(one.surveyed_m * _PER_M) - stop_01mm
            for one in line.legs[section.leg].balises
            if from_m <= one.surveyed_m <= line.stops[section.arrival].position_m
        )
        self._balise_before = self._balise_of = balise
        self._balise = NO_BALISE

    def rest(self) -> None:
        """The law no longer drives: it is told nothing more."""
        self._acting = None

    def balise_of(self, balise: BaliseReading[int]) -> BaliseReading[int]:
        """A balise of the run as the law sees it; NO_BALISE if it was passed before the section.

        Its number is that of the balise of the section whose surveyed position is nearest, from 1.
        """
        if balise == self._balise_of:
            return self._balise
        self._balise_of = balise
        if balise == self._balise_before:
            return self._balise
        surveyed_01mm = balise.position_01mm - self._stop_01mm
        near = range(len(self._balises_01mm))
        index = min(near, key=lambda at: abs(self._balises_01mm[at] - surveyed_01mm), default=0)
        self._balise = BaliseReading(index % 255 + 1, surveyed_01mm, balise.odometer_01mm - self._offset_01mm)
        return self._balise

    def step(
        self, k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int] = NO_BALISE
    ) -> ControlOutput:
        """One control period of the section; arguments as :meth:`~..ato.controller.Controller.step`, for the run."""
        output: ControlOutput = self._acting.step(
            k - self._from_k, speed_01mmps, position_01mm - self._offset_01mm, self.balise_of(balise)
        )
        return output

    def sent(self, notch_code: int) -> None:
        """Tell the law that drives the notch really sent."""
        if self._acting is not None:
            self._acting.sent(notch_code)
