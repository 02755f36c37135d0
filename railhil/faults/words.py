"""The words of the fault language: what may happen at which place, with parameters, units, usual values and origin.

One table: the parser, the checks of a scenario and the documentation read it. Values are in base units (a share from 0
to 1, s, m, m/s); units of the text are in :mod:`railhil.faults.quantities`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from railhil.faults.model import LEVELS

#: Units of parameters: keys of :data:`railhil.faults.quantities.UNITS`.
SHARE, TIME, LENGTH, SPEED, NUMBER, COUNT, PPM, NAME = "share", "s", "m", "m/s", "1", "count", "ppm", "name"

#: What becomes of frames held back, and how a counter continues after its fault; the first is the usual one.
DELIVERY = ("drop", "deliver")
CONTINUING = ("correct", "last_valid", "last")


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value of a word.

    ``unit``: one of the above. ``usual``: its value if none is given; None: it must be given. ``keyword``: word written
    before it in the text (``jitter 20ms``); several parameters in a row may share one (``gemodel 5% 40%``); empty: its
    place says which it is. ``low``, ``high``: allowed values, inclusive.
    """

    name: str
    unit: str
    usual: float | str | None
    meaning: str
    keyword: str = ""
    low: float = float("-inf")
    high: float = float("inf")


@dataclass(frozen=True, slots=True)
class Word:
    """What may happen at a place.

    ``part``: for telegrams, what of them: ``whole``, ``counter``, ``checksum``, ``signal``; of the bus ``whole`` or
    ``line``. ``origin``: where the word comes from. ``after``: what may be said about its end, the usual one first.
    ``names``: places of its level that have it; empty: all. ``lasts``: whether it has a duration at all.
    """

    name: str
    level: str
    meaning: str
    origin: str
    parameters: tuple[Parameter, ...] = ()
    part: str = "whole"
    after: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    lasts: bool = True


#: Places by level, with what they are. Telegrams are named by their ports.
PLACES: dict[str, dict[str, str]] = {
    "train": {
        "mass": "mass with its load, and the inertial mass",
        "gradient": "grade of the line",
        "resistance": "running resistance (Davis)",
        "adhesion": "adhesion between wheel and rail",
        "power": "power of the train: without it there is no traction",
        "line_voltage": "line voltage",
        "pantograph": "pantograph: without it there is no traction",
        "main_breaker": "main breaker: without it there is no traction",
        "doors": "doors closed and locked",
        "parking_brake": "parking brake released",
        "safety_loop": "safety loop closed",
        "gain": "achieved share of a commanded acceleration",
        "lag": "time constant of traction and brake",
        "delay": "delay from a command to its force",
        "model": "the simulation itself",
    },
    "sensor": {
        "speed": "axle speed sensor",
        "position": "odometer",
        "balise": "balise reader",
    },
    "actuator": {
        "traction": "traction drive",
        "brake": "brake",
    },
    "command": {"notch": "notch command, where it leaves the controller, with correct check sequences and counter"},
    "clock": {"time": "time told by the plant (TIME_SYNC)", "wall": "real time: the plant's computer"},
    "node": {"controller": "controller's process", "plant": "plant's process", "supervisor": "supervisor's process"},
    "bus": {"": "the vehicle's bus; the bench's own telegrams are not affected"},
}
#: Lines of the bus.
LINES = ("a", "b")
#: The word that ends what is active at a place.
CLEAR = "ok"


def _share(meaning: str) -> Parameter:
    return Parameter("share", SHARE, 1.0, meaning, low=0.0, high=1.0)


_PX4 = "PX4 failure injection"
_NETEM = "Linux netem"
_CANOE = "CANoe interaction layer"
_CAN = "CAN, FMI-LS-BUS"
_POSIX = "POSIX"
_XIL = "ASAM XIL"
_RAIL = "railway"

_TRAIN = (
    Word("scale", "train", "multiplied", _RAIL, (Parameter("factor", NUMBER, None, "factor", low=0.01, high=100.0),),
         names=("mass", "gradient", "resistance", "gain", "lag")),
    Word("longer", "train", "longer", _RAIL,
         (Parameter("extra_s", TIME, None, "added to the delay", low=0.0, high=5.0),), names=("delay",)),
    Word("offset", "train", "shifted", _RAIL, (Parameter("permil", NUMBER, None, "per mil", low=-100.0, high=100.0),),
         names=("gradient",)),
    Word("low", "train", "wheels slip and slide", _RAIL,
         (Parameter("coefficient", NUMBER, 0.05, "of adhesion", low=0.001, high=1.0),), names=("adhesion",)),
    Word("off", "train", "lowered, opened or open", _PX4,
         names=("power", "pantograph", "main_breaker", "doors", "parking_brake", "safety_loop")),
    Word("low", "train", "the line voltage is low: below two thirds there is no traction (EN 50163)", _RAIL,
         (Parameter("share", SHARE, 0.6, "share of the nominal voltage", low=0.0, high=1.2),), names=("line_voltage",)),
    Word("nan", "train", "the state is no longer a number: a defect of the bench", "numerics", names=("model",),
         lasts=False),
)  # fmt: skip

_SENSOR = (
    Word("off", "sensor", "no value: the telegram's check variable says erroneous, the value is 0", _PX4),
    Word("stuck", "sensor", "the value of the first instant stays", _PX4, names=("speed", "position")),
    Word("garbage", "sensor", "random values over the whole range of the wire", _PX4, names=("speed", "position")),
    Word("wrong", "sensor", "multiplied by a wrong factor", _PX4,
         (Parameter("factor", NUMBER, 1.05, "factor", low=-100.0, high=100.0),), names=("speed", "position")),
    Word("slow", "sensor", "first-order lag", _PX4,
         (Parameter("time_constant_s", TIME, 1.0, "time constant", low=0.001, high=1000.0),),
         names=("speed", "position")),
    Word("delayed", "sensor", "the value of some time ago", _PX4,
         (Parameter("delay_s", TIME, 0.5, "delay", low=0.001, high=100.0),), names=("speed", "position")),
    Word("intermittent", "sensor", "off for some of the samples, at random", _PX4,
         (Parameter("share", SHARE, 0.5, "share of the samples that are off", low=0.0, high=1.0),)),
    Word("drift", "sensor", "an error that grows with time", "sensor models",
         (Parameter("per_s", NUMBER, 0.01, "growth per s, in m/s or m", low=-1000.0, high=1000.0),),
         names=("speed", "position")),
    Word("noise", "sensor", "normally distributed error", "sensor models",
         (Parameter("sigma", NUMBER, 0.1, "standard deviation, in m/s or m", low=0.0, high=1000.0),),
         names=("speed", "position")),
    Word("offset", "sensor", "constant error", "sensor models",
         (Parameter("error", NUMBER, None, "error, in m/s or m", low=-1e6, high=1e6),), names=("speed", "position")),
    Word("value", "sensor", "a fixed value, also a negative or impossible one", "sensor models",
         (Parameter("value", NUMBER, None, "value, in m/s or m", low=-1e6, high=1e6),), names=("speed", "position")),
    Word("jump", "sensor", "the count jumps once and goes on from there", _RAIL,
         (Parameter("distance_m", LENGTH, None, "distance", low=-1e6, high=1e6),), names=("position",), lasts=False),
    Word("missed", "sensor", "balises are not read", _RAIL, names=("balise",)),
    Word("doubled", "sensor", "balises are reported twice", _RAIL, names=("balise",)),
    Word("wrong", "sensor", "balises are reported at a wrong place", _RAIL,
         (Parameter("error_m", LENGTH, None, "error of the surveyed position", low=-1e6, high=1e6),),
         names=("balise",)),
)  # fmt: skip

_ACTUATOR = (
    Word("weak", "actuator", "only a share of its force", _RAIL,
         (Parameter("share", SHARE, 0.5, "share of the force that is left", low=0.0, high=1.0),)),
    Word("scale", "actuator", "multiplied: a train that is stronger or weaker than its data", _RAIL,
         (Parameter("factor", NUMBER, None, "factor", low=0.01, high=100.0),)),
    Word("off", "actuator", "no force", _PX4),
    Word("stuck", "actuator", "the force of the first instant stays", _PX4),
    Word("full", "actuator", "full force whatever is commanded (runaway)", _RAIL),
    Word("slow", "actuator", "its pole is slower", _PX4,
         (Parameter("factor", NUMBER, 0.5, "factor of the pole", low=0.001, high=1.0),)),
    Word("dead_time", "actuator", "commands act later", _RAIL,
         (Parameter("delay_s", TIME, 0.2, "dead time", low=0.001, high=100.0),)),
)  # fmt: skip

_COMMAND = (
    Word("value", "command", "a fixed command, also one out of range", _CANOE,
         (Parameter("value", NUMBER, None, "value in the signal's unit"),)),
    Word("stuck", "command", "the command of the first instant stays", _PX4),
    Word("offset", "command", "shifted", _CANOE, (Parameter("error", NUMBER, None, "error in the signal's unit"),)),
    Word("scale", "command", "multiplied", _CANOE, (Parameter("factor", NUMBER, None, "factor"),)),
    Word("random", "command", "random values over the whole range of the signal", _CANOE),
)  # fmt: skip

_CLOCK = (
    Word("step", "clock", "the time told is wrong by a constant", "NTP",
         (Parameter("error_s", TIME, None, "error", low=-1e6, high=1e6),), names=("time",)),
    Word("drift", "clock", "the time told runs away", "oscillators",
         (Parameter("rate_ppm", PPM, None, "rate", low=-1e5, high=1e5),), names=("time",)),
    Word("stuck", "clock", "the time told stands still", _PX4, names=("time",)),
    Word("pause", "clock", "the plant's computer pauses once", _POSIX,
         (Parameter("pause_s", TIME, 0.2, "duration on the wall clock", low=0.001, high=60.0),), names=("wall",),
         lasts=False),
)  # fmt: skip

_TELEGRAM = (
    Word("loss", "telegram", "telegrams are lost", _NETEM,
         (_share("share of the telegrams that are lost"),
          Parameter("enter", SHARE, 0.0, "probability that a burst begins", "gemodel", 0.0, 1.0),
          Parameter("leave", SHARE, 1.0, "probability that a burst ends", "gemodel", 0.0, 1.0))),
    Word("delay", "telegram", "telegrams come later", _NETEM,
         (Parameter("delay_s", TIME, None, "delay", low=0.0, high=100.0),
          Parameter("jitter_s", TIME, 0.0, "largest deviation from it, uniformly distributed", "jitter", 0.0, 100.0)),
         after=("deliver", "drop")),
    Word("duplicate", "telegram", "telegrams come several times", _NETEM,
         (_share("share of the telegrams"), Parameter("copies", COUNT, 1.0, "further copies", "copies", 1.0, 100.0))),
    Word("corrupt", "telegram", "bits are flipped", _NETEM,
         (_share("share of the telegrams"),
          Parameter("bits", COUNT, 1.0, "flipped bits in one frame", "bits", 1.0, 64.0))),
    Word("reorder", "telegram", "telegrams are overtaken by later ones", _NETEM,
         (_share("share of the telegrams"),
          Parameter("gap", COUNT, 1.0, "number of telegrams of the port that overtake", "gap", 1.0, 1000.0)),
         after=("deliver", "drop")),
    Word("masquerade", "telegram", "the frames appear on the identifiers of another port", "AUTOSAR E2E, SDTv2",
         (Parameter("port", NAME, None, "the other port"),)),
    Word("truncate", "telegram", "the frames are shorter", _CAN,
         (Parameter("bytes", COUNT, 4.0, "bytes that are left", low=0.0, high=7.0),)),
    Word("replay", "telegram", "telegrams of some time ago instead of the present ones", "SDTv2",
         (Parameter("age_s", TIME, None, "how long ago", low=0.001, high=1000.0),)),
    Word("stuck", "telegram", "the telegram of the first instant is repeated, counter and all", _PX4),
    Word("remote", "telegram", "remote frames instead of data frames", _CAN),
    Word("value", "telegram", "a fixed counter", _CANOE, (Parameter("value", COUNT, None, "counter", low=0.0),),
         "counter", CONTINUING),
    Word("freeze", "telegram", "the counter stands", _CANOE, (), "counter", CONTINUING),
    Word("random", "telegram", "a random counter", _CANOE, (), "counter", CONTINUING),
    Word("offset", "telegram", "a wrong counter by a constant", _CANOE,
         (Parameter("offset", NUMBER, 1.0, "difference"),), "counter", CONTINUING),
    Word("value", "telegram", "fixed check sequences", _CANOE,
         (Parameter("value", COUNT, None, "octet", low=0.0, high=255.0),), "checksum"),
    Word("freeze", "telegram", "the check sequences of the first instant", _CANOE, (), "checksum"),
    Word("random", "telegram", "random check sequences", _CANOE, (), "checksum"),
    Word("offset", "telegram", "check sequences wrong by a constant", _CANOE,
         (Parameter("offset", NUMBER, 1.0, "difference", low=-255.0, high=255.0),), "checksum"),
    Word("value", "telegram", "a fixed value of the signal", _CANOE, (Parameter("value", NUMBER, None, "in its unit"),),
         "signal"),
    Word("raw", "telegram", "a fixed raw value of the signal", _CANOE,
         (Parameter("value", NUMBER, None, "raw value"),), "signal"),
    Word("stuck", "telegram", "the signal of the first instant stays", _PX4, (), "signal"),
    Word("offset", "telegram", "the signal is shifted", _CANOE, (Parameter("error", NUMBER, None, "in its unit"),),
         "signal"),
    Word("scale", "telegram", "the signal is multiplied", _CANOE, (Parameter("factor", NUMBER, None, "factor"),),
         "signal"),
    Word("random", "telegram", "random values over the whole range of the signal", _CANOE, (), "signal"),
)  # fmt: skip

_NODE = (
    Word("kill", "node", "killed (SIGKILL)", _POSIX, lasts=False),
    Word("stop", "node", "stopped and continued (SIGSTOP, SIGCONT)", _POSIX, after=DELIVERY),
    Word("restart", "node", "made anew, silent in between", _POSIX),
    Word("slow", "node", "answers late", _POSIX,
         (Parameter("delay_s", TIME, None, "how late", low=0.001, high=100.0),), after=("deliver", "drop")),
)  # fmt: skip

_BUS = (
    Word("error_frames", "bus", "error frames disturb frames of plant and controller, which are repeated", _CAN,
         (Parameter("share", SHARE, 0.01, "share of the disturbed frames", low=0.0, high=1.0),)),
    Word("passive", "bus", "plant and controller are error-passive", _CAN),
    Word("off", "bus", "bus-off: nobody sends", _CAN, after=DELIVERY),
    Word("down", "bus", "interface down, cable out", _CAN, after=DELIVERY),
    Word("full", "bus", "transmit queue full (ENOBUFS)", "Linux SocketCAN", after=DELIVERY),
    Word("load", "bus", "foreign frames load the bus", _CAN,
         (Parameter("share", SHARE, 0.6, "share of the bus", low=0.0, high=1.0),)),
    Word("open", "bus", "the line is open at the controller", _XIL, (), "line"),
    Word("loose", "bus", "the line has a loose contact at the controller", _XIL,
         (Parameter("share", SHARE, 0.5, "share of the instants without contact", low=0.0, high=1.0),), "line"),
    Word("short", "bus", "the line is short-circuited: dead for all", _XIL, (), "line"),
)  # fmt: skip

_CLEARING = tuple(
    Word(CLEAR, level, "ends what is active at this place", _PX4, part=part, lasts=False)
    for level in LEVELS
    for part in {"telegram": ("whole", "counter", "checksum", "signal"), "bus": ("whole", "line")}.get(
        level, ("whole",)
    )
)

#: All words.
WORDS: tuple[Word, ...] = (
    *_TRAIN, *_SENSOR, *_ACTUATOR, *_COMMAND, *_CLOCK, *_TELEGRAM, *_NODE, *_BUS, *_CLEARING
)  # fmt: skip


def kind_of_part(level: str, part: str) -> str:
    """What the part of a place is: ``whole``, ``counter``, ``checksum``, ``signal`` or ``line``."""
    if not part:
        return "whole"
    if level == "bus":
        return "line"
    return part if part in ("counter", "checksum") else "signal"


def words_at(level: str, name: str, part: str) -> list[Word]:
    """All words of a place."""
    kind = kind_of_part(level, part)
    return [
        word for word in WORDS if word.level == level and word.part == kind and (not word.names or name in word.names)
    ]


def word_of(level: str, name: str, part: str, what: str) -> Word | None:
    """The word at a place; None: it has no such word."""
    return next((word for word in words_at(level, name, part) if word.name == what), None)


def levels_of(words: Iterable[Word] = WORDS) -> dict[str, list[Word]]:
    """The words by level, in the order of the table."""
    found: dict[str, list[Word]] = {}
    for word in words:
        found.setdefault(word.level, []).append(word)
    return found
