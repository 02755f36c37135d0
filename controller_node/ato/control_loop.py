"""A law with its set-points and its state on one arithmetic: wire values in, the law's outputs out."""

from __future__ import annotations

from typing import Any, Final

from railhil.common.command_line import INDEXINGS
from railhil.common.errors import InputError
from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.setpoint import SetPoints
from railhil.controller_node.compiled_law import Values
from railhil.controller_node.law_loop import LawLoop, starting
from railhil.controller_node.laws import law_class, load
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading, LawInputs, LawOutputs, TrackInputs
from railhil.controller_node.program.model import BALISE_INPUTS, Kind
from railhil.controller_node.program.tracer import FormatError, Tracer
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

#: km/h per 0.1 mm/s, scaled by 2^40: the single product that converts the wire's speed to Q20 is exact to 1e-9.
_KMH_PER_01MMPS: Final = Constant("kmh_per_01mmps", 3.6e-4, 40, "unit conversion")

#: Limit of the positions passed to the law (0.1 mm, 200 km), so that they and their differences fit into 32 bits. A law
#: that uses the position is refused for a longer run.
POSITION_MAX_01MM: Final = 2_000_000_000


def limited_01mm(position_mm: int) -> int:
    """A position from the wire, as passed to the law."""
    position_01mm = position_mm * 10
    if -POSITION_MAX_01MM <= position_01mm <= POSITION_MAX_01MM:
        return position_01mm
    return POSITION_MAX_01MM if position_01mm > 0 else -POSITION_MAX_01MM


#: Before the first balise.
NO_BALISE: Final[BaliseReading[int]] = BaliseReading(0, 0, 0)


@mypyc_attr(allow_interpreted_subclasses=True)
class ControlLoop(LawLoop[T]):
    """Law, set-points and state on one arithmetic; operands belong to the arithmetic, wire values are whole numbers.

    :param arithmetic: a fresh one; the one named by ``law`` is ignored.
    :raises scenarios.errors.InputError: an unknown law or indexing, a law that cannot be made for this scenario or
        does not work with this indexing, parameters or a memory of another law.
    """

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec,
        arithmetic: Arithmetic[T],
    ) -> None:
        name, indexing = law.controller, law.indexing
        kind = load(name) if law.given is None else law_class(law, scenario)
        if indexing in INDEXINGS and indexing not in kind.indexings:
            raise InputError("indexing", name, indexing, f"{' or '.join(kind.indexings)} with this law")
        longest_m = POSITION_MAX_01MM / 1e4 / scenario.wheel_factor_max
        distance_m = scenario.plan.distance_m
        if (kind.track or law.over_distance) and distance_m > longest_m:
            allowed = f"at most {longest_m:g} m for {name} with set-points by {indexing}: it uses the position"
            raise InputError(scenario.name, "plan.distance_m", distance_m, allowed)
        period_s, notch_max = scenario.timing.control_period_ns / 1e9, scenario.train.notch_max
        super().__init__(scenario, law, arithmetic, kind, f"{period_s:g} s and {notch_max:g} notches")
        with starting(name, kind, self.made_for):
            # A horizon may be too large for the memory.
            self.set_points = SetPoints(arithmetic, scenario, indexing, self.law.horizon)
        self._kmh = arithmetic.const(_KMH_PER_01MMPS)

    def inputs(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any] = NO_BALISE
    ) -> LawInputs[T]:
        """Wire values (integers) and set-points as inputs of the law."""
        ar = self.arithmetic
        product = ar.mpy(ar.from_raw(speed_01mmps, 0), self._kmh, _KMH_PER_01MMPS.q - SPEED_Q)
        speed = ar.note("speed", product, SPEED_Q, "km/h")
        position = ar.from_raw(position_01mm, 0)
        set_point, preview = self.set_points.at(k, position)
        set_point = ar.note("set_point", set_point, SPEED_Q, "km/h")
        if not self.law.track:
            return LawInputs(speed, set_point, preview)
        reading = BaliseReading(*(ar.from_raw(value, 0) for value in balise))
        return LawInputs(speed, set_point, preview, TrackInputs(k, position, reading))

    def step(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any] = NO_BALISE
    ) -> tuple[LawInputs[T], LawOutputs[T]]:
        """One control period; the first one also makes the law's state."""
        if self.compiled is not None:
            done = self._step_compiled(k, speed_01mmps, position_01mm, balise)
            if done is not None:
                return done
        inputs = self.inputs(k, speed_01mmps, position_01mm, balise)
        if self.state is None:
            self.state = self.law.start(inputs)
        self.state, outputs = self.law.step(self.state, inputs)
        return inputs, outputs

    def _step_compiled(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any]
    ) -> tuple[LawInputs[T], LawOutputs[T]] | None:
        ar = self.arithmetic
        position = ar.from_raw(position_01mm, 0)
        wire: Values = (k, ar.from_raw(speed_01mmps, 0), position)
        track: TrackInputs[T] | tuple[()] = ()
        if self.law.track:
            reading = BaliseReading(*[ar.from_raw(value, 0) for value in balise])
            wire, track = (*wire, *reading), TrackInputs(k, position, reading)
        done = self.step_compiled(wire)
        if done is None:
            return None
        given, (notch_raw, notch, *notes) = done
        inputs = LawInputs(given[0], given[1], given[2 : 2 + self.law.horizon], track)
        return inputs, LawOutputs(notch_raw, notch, tuple(notes))

    def sent(self, notch: T) -> None:
        """Pass the law the notch (Q ``NOTCH_Q``) that was really sent since its last step."""
        self.state = self.law.with_sent(self.state, notch)

    def compute_answer(self, state: Any, inputs: Any) -> tuple[Any, Any]:
        """The law's step.

        :raises FormatError: its notes differ from its declaration.
        """
        after, outputs = super().compute_answer(state, inputs)
        declared = self.law.notes
        if len(outputs.notes) != len(declared):
            raise FormatError(f"step answers {len(outputs.notes)} notes, the law declares {len(declared)}")
        for note, value in zip(declared, outputs.notes, strict=True):
            if not self.arithmetic.wide and value.q is not None and value.q != note.q:
                raise FormatError(f"note {note.name} is Q{value.q}, declared Q{note.q}")
        return after, outputs

    def trace_inputs(self, tracer: Tracer) -> Any:
        """Number of the period, speed, position and, for a law with ``track``, the last balise."""
        k = tracer.input("k", None, Kind.INDEX)
        speed, position = tracer.input("speed_01mmps", 0), tracer.input("position_01mm", 0)
        balise: BaliseReading[Any] = NO_BALISE
        if self.law.track:
            balise = BaliseReading(*(tracer.input(name, 0) for name in BALISE_INPUTS))
        return self.inputs(k, speed, position, balise)

    def trace_commands(self, tracer: Tracer) -> Any:
        """The notch."""
        return tracer.input("notch", NOTCH_Q)
