"""The export of a train's law: inputs are the readings of one train, the output is one notch.

It is the part ``export`` of the system ``ato``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.bus.sdt import SAFE_DATA_VERSION, source_identity
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.ato import balises, guard, odometer, plausibility, speed_monitors, speed_watch, track_info
from railhil.controller_node.ato import export_runs as notch_runs
from railhil.controller_node.ato.control_loop import NO_BALISE, POSITION_MAX_01MM, ControlLoop
from railhil.controller_node.ato.given import M_PER_01MM
from railhil.controller_node.ato.node import (
    ANSWERS,
    MAILBOXES,
    SAFE_ANSWERS,
    SAFE_MAILBOXES,
    ControllerNode,
    end_of_authority_01mm,
)
from railhil.controller_node.cost import cost_of
from railhil.controller_node.export.control import (
    Comments,
    Control,
    Define,
    Loop,
    Macro,
    Period,
    Play,
    Wire,
    Word,
)
from railhil.controller_node.export.text import wide
from railhil.controller_node.laws import law_class
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, BaliseReading
from railhil.controller_node.laws.note import SLOTS, slots
from railhil.controller_node.program.model import BALISE_INPUTS, Value
from railhil.controller_node.program.tracer import record
from railhil.dbc import Port, Signal, wire_contract
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import BalisePassed, CtlStat, NotchCmd, NotchSdt, SpeedSdt, TrkInfo, TrnPos, TrnSpeed

_BALISE_WORDS = ";\n * last balise: number (0: none yet), surveyed position, odometer reading when passed (0.1 mm)"
_AGES = "age of the last accepted TRN_SPEED"
_NS_PER_S = 1_000_000_000
#: Largest int of the target.
_INT_MAX = 2**15 - 1


def _signal(kind: type[Telegram], field: str) -> Signal:
    return dict(kind.signals())[field]


def _largest(kind: type[Telegram], field: str) -> int:
    return _signal(kind, field).raw_range[1]


def _lsb(kind: type[Telegram], field: str) -> int:
    """1 of a signal, in 0.1 mm or 0.1 mm/s."""
    return round(_signal(kind, field).scale / M_PER_01MM)


def _limits() -> list[Define]:
    """Limits of the watch that are the same in every scenario."""
    limits = {
        "SPEED_MAX_01MMPS": (guard.SPEED_MAX_01MMPS, "a higher one is none of a train"),
        "GOOD_AFTER_TRACTION_CUT": (speed_watch.GOOD_AFTER_TRACTION_CUT, "good telegrams in a row that end this level"),
        "GOOD_AFTER_SERVICE_BRAKE": (speed_watch.GOOD_AFTER_SERVICE_BRAKE, ""),
        "BAD_FOR_TRACTION_CUT": (speed_watch.BAD_FOR_TRACTION_CUT, "bad ones of the last RAILHIL_RECENT that cause it"),
        "RECENT": (speed_watch.RECENT, ""),
        "CHANNEL_WINDOW_MS": (speed_monitors.CHANNEL_WINDOW_MS, "in which RAILHIL_CHANNEL_BAD_MAX are permitted"),
        "DISORDER_MS": (speed_monitors.DISORDER_MS, "cost of an old telegram"),
        "DISORDER_MAX_MS": (speed_monitors.DISORDER_MAX_MS, "largest permitted cost"),
        "SAMPLE_MS": (plausibility.SAMPLE_MS, "between two checks of the motion"),
        "PAUSE_MAX_MS": (plausibility.PAUSE_MAX_MS, "after a longer one they begin again"),
        "RING": (plausibility.RING, "entries that are compared with the odometer"),
        "RING_EVERY": (plausibility.RING_EVERY, "samples from one to the next"),
        "POSITION_AGE_MAX_MS": (plausibility.POSITION_AGE_MAX_MS, "of a position that is carried forward"),
        "MORE_BRAKE_MS": (plausibility.MORE_BRAKE_MS, "of additional braking before an emergency"),
        "DEMAND_MIN": (plausibility.DEMAND_MIN, "0.1 mm/s2: a smaller one does not judge the brake"),
        "SHORTFALL": (plausibility.SHORTFALL, "permitted with any demand"),
        "DUE_MIN": (plausibility.DUE_MIN, "0.1 mm/s2: a smaller acceleration makes no change due"),
        "SLOW": (plausibility.SLOW, "0.1 mm/s: brake and runaway are not judged below it"),
        "GOOD_POSITIONS": (odometer.GOOD_RUN, "in a row, for trust in the odometer"),
        "POSITION_MAX_01MM": (POSITION_MAX_01MM, "largest position for the law"),
        "READING_MAX_01MM": (odometer.READING_MAX_01MM, "largest reading"),
    }
    return [Define(name, str(n) if n <= _INT_MAX else wide(n), words) for name, (n, words) in limits.items()]


def _motion(scenario: Scenario) -> list[Define]:
    """Thresholds and model of the checks of the motion, and of the monitors of the channel."""
    limits, latency = plausibility.MotionLimits.of(scenario), speed_monitors.Latency(scenario)
    track_cut_ns, track_brake_ns = track_info.ages_ns(scenario)
    return [
        Define("JUMP_01MMPS", wide(limits.jump_01mmps), "change of the speed by noise alone"),
        Define("SPEED_CHANGE_01MMPS2", wide(limits.accel_01mmps2), "a faster change is refused"),
        Define("STUCK_01MMPS", wide(limits.stuck_01mmps), "change that is due while the reading does not change"),
        Define("SCALE_ERROR_PERMIL", wide(limits.scale_permil), "disagreement of speed and odometer over 5 s"),
        Define("DISAGREEMENT_01MM", wide(limits.disagreement_01mm), "in addition"),
        Define("BRAKE_SHARE_PERMIL", wide(limits.brake_share_permil), "a brake below this does not answer"),
        Define("RUNAWAY_01MMPS", wide(limits.runaway_01mmps), "excess of the speed without traction"),
        Define("DECAY_Q16", wide(limits.decay_q16), "share of the way to the notch's force in 100 ms"),
        Define("NOTCH_01MMPS2", wide(limits.notch_01mmps2), "acceleration of one notch"),
        Define("BRAKE_01MMPS2", wide(limits.brake_01mmps2), "of the brake where it is weakest"),
        Define("TRACTION_01MMPS2", wide(limits.traction_01mmps2), "of the traction where it is strongest"),
        Define("WEAK_TRACTION_01MMPS2", wide(limits.weak_traction_01mmps2), "where it is weakest"),
        Define("DAVIS_A", wide(limits.davis_a), "resistance of the nominal train, 0.1 mm/s2"),
        Define("DAVIS_B_Q20", wide(limits.davis_b_q20)),
        Define("DAVIS_C_Q40", wide(limits.davis_c_q40)),
        Define("GRADE_Q16", wide(limits.grade_q16), "of a grade of 0.01 permil"),
        Define("NOTCH_TICKS", wide(latency.poll_ticks), "between two polls of NOTCH_CMD"),
        Define("LATENCY_MAX_TICKS", wide(latency.limit_ticks), "TRN_SPEED behind the polls"),
        Define("CHANNEL_BAD_MAX", wide(scenario.watch.channel_bad_max), "bad TRN_SPEED permitted in 10 s"),
        Define("TRACK_CUT_NS", wide(track_cut_ns), "TRK_INFO older than this cuts the traction"),
        Define("TRACK_BRAKE_NS", wide(track_brake_ns), "and brakes"),
        Define("OVERRUNS_MAX", wide(scenario.watch.overruns_max), "late control periods in a row"),
    ]


class _NotchLoop:
    """See :class:`railhil.controller_node.export.control.Loop`."""

    def __init__(self, loop: ControlLoop[int]) -> None:
        self._loop = loop

    @property
    def state(self) -> Any:
        return self._loop.state

    def step(self, given: Sequence[int]) -> tuple[Any, Any]:
        k, speed_01mmps, position_01mm, *balise = given
        return self._loop.step(k, speed_01mmps, position_01mm, BaliseReading(*balise) if balise else NO_BALISE)

    def sent(self, told: Sequence[int]) -> None:
        self._loop.sent(self._loop.arithmetic.from_raw(told[0], NOTCH_Q))


class NotchControl(Control):
    """See :class:`railhil.controller_node.export.control.Control`."""

    scenario: Scenario
    arithmetics = ("iq", "float32")
    period_word = "k"
    polls_begin = ControllerNode.polls_begin
    life_start = 0
    commands = ("out.notch",)
    folder = "railhil.controller_node.ato:c"
    sources = ("railhil_position.c", "railhil_motion.c", "railhil_guard.c", "railhil_telegrams.c")
    headers = ("railhil_position.h", "railhil_motion.h", "railhil_safe.h", "railhil_guard.h")

    def __init__(self, scenario: Scenario, law: LawSpec) -> None:
        super().__init__(scenario, law)
        self.programs = record(scenario, law, wide=law.arithmetic == "float32")
        self._notes = notes = law_class(law, scenario).notes
        self.formats = {"out.notch_raw": NOTCH_RAW_Q, "out.notch": NOTCH_Q}
        self.formats |= {f"out.notes[{i}]": note.q for i, note in enumerate(notes)}
        first = [Word(name, name, name) for name in ("k", "speed_01mmps", "position_01mm")]
        balise = [Word(name, name, name) for name in (BALISE_INPUTS if self.programs.track else ())]
        self.given, self.told = (*first, *balise), (Word("notch", "notch_code", "sent"),)
        self.record = (*first, *self.told, *balise)

    def comments(self, name: str) -> Comments:
        balise_words = _BALISE_WORDS if self.programs.track else ""
        return Comments(
            use=(
                f"In each control period call {name}_inputs, in the first one also {name}_start, then {name}_step.",
                f"The result is out.notch in 1/256 notch. If another notch is sent, pass it to {name}_sent.",
            ),
            inputs="Control period k, measured speed (0.1 mm/s) and position from the start of the run (0.1 mm)"
            + balise_words,
            sent="The notch (1/256) really sent since the last control period",
            status="CTL_STAT",
            what="notch",
            other="a notch other than the law's was",
            record="k,\n * speed in 0.1 mm/s, position in 0.1 mm, notch sent (1/256), and for a law with track inputs\n"
            " * the last balise: number, surveyed position, odometer reading when passed (0.1 mm)",
            constants="its scenario and its watch",
            units="codes in 1/256 notch",
            node="acceptance of speeds, reaction ladder, position, balises",
        )

    def member(self, leaf: str) -> str:
        return leaf.partition(".")[2]

    def input_unit(self, leaf: str, value: Value) -> str:
        """km/h for speeds, 0.1 mm for positions of the track inputs."""
        if not leaf.startswith("in.track."):
            return "km/h"
        return "0.1 mm" if leaf.endswith("_01mm") else ""

    def macros(self) -> list[Macro]:
        notes = self._notes
        found = slots(notes)

        def macro(signal: str, number: int) -> Macro:
            note = notes[number]
            words = ", ".join(filter(None, (note.name, note.title, f"1/2^{note.wire_q}", note.unit, *note.bits)))
            return Macro(signal, f"out.notes[{number}]", note.shift, note.limits, words)

        return [macro(signal, found[signal]) if signal in found else Macro(signal) for signal in SLOTS]

    @classmethod
    def wires(cls, scenario: Scenario) -> dict[str, Wire]:
        def length(words: str, quantity: str) -> Wire:
            return Wire(words, quantity=quantity, one=M_PER_01MM)

        notch = Wire.of(NotchCmd, "notch_256th", "notch")
        period_s = scenario.timing.control_period_ns / 1e9
        return {
            cls.period_word: Wire("number of the control period", quantity="time_s", one=period_s),
            "speed_01mmps": Wire.of(TrnSpeed, "speed_01mmps", "speed_mps"),
            "position_01mm": length(
                "position from the start of the run, 1 is 0.1 mm: ten times that of TRN_POS", "position_m"
            ),
            "balise": Wire("number of the last balise, 0: none yet", quantity="balise"),
            "balise_01mm": length("its surveyed position, 1 is 0.1 mm", "balise_m"),
            "balise_odometer_01mm": length("odometer reading when it was passed, 1 is 0.1 mm", "balise_odometer_m"),
            "sent": Wire("notch sent instead of out.notch, 1 is 1/256 notch", quantity="sent_notch", one=notch.one),
            "out.notch": notch,
        }

    def loop(self, number: Arithmetic[int]) -> Loop:
        return _NotchLoop(ControlLoop(self.scenario, self.law, number))

    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """Generated runs; no run of the bench is needed, because the set-points define the course of a run."""
        scenario, law = self.scenario, self.law
        runs = (
            notch_runs.following(scenario, ControlLoop(scenario, law, make(law.arithmetic))),
            notch_runs.settled(scenario, ControlLoop(scenario, law, make(law.arithmetic))),
            notch_runs.jumping(),
            notch_runs.limits(),
        )
        for periods in runs:
            yield (period._replace(given=period.given[: len(self.given)]) for period in periods)

    def ports(self) -> tuple[list[Port], list[Port]]:
        contract = self.contract
        if contract.clock_port.name != TrnSpeed.PORT:
            raise ValueError(f"clock port {contract.clock_port.name}: the C counts time by {TrnSpeed.PORT}")
        sides = (SAFE_MAILBOXES, SAFE_ANSWERS) if self.scenario.safety.sdt else (MAILBOXES, ANSWERS)
        received, sent = ([contract.port(telegram.PORT) for telegram in side] for side in sides)
        return received, sent

    def constants(self) -> list[Define]:
        """Thresholds of the watch, and tolerances and times of the position."""
        scenario, timing, sensors = self.scenario, self.scenario.timing, self.scenario.sensors
        schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, wire_contract())
        ladder = speed_watch.Ladder.of(scenario)
        cost = cost_of(self.programs, make(self.law.arithmetic), timing.control_period_ns)
        cycles = min(cost.cycles, _largest(CtlStat, "step_cycles"))
        needs_position = self.programs.track or self.law.over_distance
        exact = round((odometer.TOLERANCE_M + sensors.odometer_lsb_m) * 1e4) * _NS_PER_S
        speed_error = round((sensors.speed_lsb_mps / 2 + sensors.speed_noise_sigma_mps) * 1e4)
        in_time_ns = schedule.ticks(TrnPos.PORT) * timing.base_tick_ns
        return [
            Define("HOLD_MS", wide(ladder.hold_ms), f"{_AGES} above which this level is entered"),
            Define("TRACTION_CUT_MS", wide(ladder.traction_cut_ms)),
            Define("SERVICE_BRAKE_MS", wide(ladder.service_brake_ms)),
            Define("EMERGENCY_MS", wide(ladder.emergency_ms)),
            Define("SERVICE_CODE", wide(ladder.service_code), "full service brake"),
            Define("FULL_CODE", wide(ladder.full_code), "largest notch"),
            Define("RAMP_CODE_PER_S", wide(ladder.ramp_code_per_s), "jerk limit of the service brake"),
            Define("OVERSPEED_MARGIN_01MMPS", wide(ladder.overspeed_margin_01mmps), "above the limit of TRK_INFO"),
            Define("NEEDS_POSITION", str(int(needs_position)), "1: a lost position applies the service brake"),
            Define("LIMIT_01MMPS", f"INT32_C({_lsb(TrkInfo, 'speed_limit_4mmps')})", "1 of SpeedLimit"),
            Define("ODOMETER_01MM", wide(_lsb(TrnPos, "odometer_mm")), "1 of TrainPos"),
            Define("POSITION_IN_TIME_NS", wide(in_time_ns), "period of TRN_POS"),
            Define("RECKONING_MAX_NS", wide(odometer.RECKONING_MAX_NS), "longest time on a dead-reckoned position"),
            Define("FOLLOWING_NS", wide(odometer.FOLLOWING_NS), "time constant of its approach to the odometer"),
            Define("ODOMETER_EXACT", wide(exact), "tolerance at standstill, 1e-13 m"),
            Define("SPEED_ERROR_01MMPS", wide(speed_error), "resolution and noise of the speed"),
            Define("ACCEL_MAX_01MMPS2", wide(round(odometer.ACCEL_MAX_MPS2 * 1e4))),
            *_limits(),
            *self._end(),
            *_motion(scenario),
            Define("STEP_CYCLES", f"UINT32_C({cycles})", "estimated C28x cycles of a control period, at most 65535"),
            Define("OVERRUN_COUNT_MAX", str(_largest(CtlStat, "overruns"))),
            *self._safe_channel(schedule),
        ]

    def _end(self) -> list[Define]:
        """Constants for the position of balises, and for the end of authority of a law that gets them."""
        end_01mm = end_of_authority_01mm(self.scenario) if self.programs.track else 0
        return [
            Define("WHEEL_PARTS", wide(balises.WHEEL_PARTS), "the largest error of a wheel is one of so many parts"),
            Define(
                "BALISE_WORD_MM",
                wide(_largest(BalisePassed, "odometer_low_mm") + 1),
                "odometer readings of BALISE",
            ),
            Define("BALISE_ERROR_MM", wide(balises.BALISE_ERROR_MM), "largest error of a surveyed balise"),
            Define("TRACK", str(int(self.programs.track)), "1: the law is given balises"),
            Define("END_01MM", wide(end_01mm), "end of its authority"),
        ]

    def _safe_channel(self, schedule: Schedule) -> list[Define]:
        """Constants of the safe channel, if the scenario has one."""
        safety = self.scenario.safety
        if not safety.sdt:
            return [Define("SAFE", "0", "1: speeds and commands count only if safe telegrams confirm them")]
        ticks = schedule.ticks(SpeedSdt.PORT)
        low = _signal(SpeedSdt, "tick_low")
        low_max, high_max = low.raw_range[1], _largest(SpeedSdt, "tick_high")

        def identity(port: Port) -> str:
            return f"UINT32_C({source_identity(port.address):#x})"

        return [
            Define("SAFE", "1", "speeds and commands count only if safe telegrams confirm them"),
            Define("SAFE_RXSAFE", str(safety.n_rxsafe), "cycles without a fresh safe telegram that are tolerated"),
            Define("SAFE_CMTHR", str(safety.cmthr), "telegrams within which a second CRC error fails the channel"),
            Define("SAFE_PERIOD_NS", wide(ticks * schedule.base_tick_ns), "period of SPEED_SDT"),
            Define("SAFE_TICK_LOW_BITS", f"{low.length}u", "of the time in the safe telegrams"),
            Define("SAFE_TICK_LOW_MASK", f"UINT32_C({low_max:#x})"),
            Define("SAFE_TICK_MASK", f"UINT32_C({high_max << low.length | low_max:#x})", "of all of its bits"),
            Define("SAFE_LATE_TICKS", f"UINT32_C({safety.n_rxsafe * ticks})", "largest difference of its time"),
            Define("SAFE_SPEED_SID", identity(SpeedSdt.port()), "identity of its source"),
            Define("SAFE_NOTCH_SID", identity(NotchSdt.port()), "that of the source of NOTCH_SDT"),
            Define("SAFE_DATA_VERSION", str(SAFE_DATA_VERSION), "version of the data of both"),
        ]
