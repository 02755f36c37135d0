"""The words of the fault language: the kinds of faults at each place, with parameters, units, usual values and origin.

One table: the parser, the checks of a scenario and the documentation read it. The words of sensors and actuators come
from the classes of their kinds (:mod:`railhil.faults.sensors`, :mod:`railhil.faults.actuators`). Values are in base
units (a share from 0 to 1, s, m, m/s); units of the text are in :mod:`railhil.faults.notation`.
"""

from __future__ import annotations

from collections.abc import Iterable

from railhil.faults.actuators import ACTUATOR_KINDS
from railhil.faults.model import (
    CONTINUING,
    COUNT,
    DELIVERY,
    LENGTH,
    LEVELS,
    NAME,
    NUMBER,
    PPM,
    PX4,
    RAILWAY,
    SHARE,
    TIME,
    Parameter,
    Word,
)
from railhil.faults.sensors import SENSOR_KINDS

#: Places by level, with their descriptions. Telegrams are named by their ports.
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
        "holding_brake": "brake that holds the train at a stop",
        "emergency_brake": "emergency brake, where it has a force of its own",
        "door": "doors of the train, on both sides",
        "door_left": "doors of the train on the left",
        "door_right": "doors of the train on the right",
        "psd": "doors of the platform",
        "dwell": "exchange of passengers at a stop",
        "signal": "signals of the line",
        "authority": "movement authority that the track side gives",
        "atp": "train protection",
        "gain": "achieved share of a commanded acceleration",
        "lag": "time constant of traction and brake",
        "delay": "delay from a command to its force",
        "model": "the simulation itself",
    },
    "sensor": {
        "speed": "axle speed sensor",
        "position": "odometer",
        "balise": "balise reader",
        "docking_loop": "loop that measures the place of the standing train",
        "atp_speed": "axle speed sensor of the train protection",
        "atp_odometer": "odometer of the train protection",
    },
    "actuator": {
        "traction": "traction drive",
        "brake": "brake",
    },
    "command": {"notch": "notch command, where it leaves the controller, with correct check sequences and counter"},
    "clock": {"time": "time sent by the plant (TIME_SYNC)", "wall": "real time: the plant's computer"},
    "node": {"controller": "controller's process", "plant": "plant's process", "supervisor": "supervisor's process"},
    "bus": {"": "the vehicle's bus; the bench's own telegrams are not affected"},
}
#: Lines of the bus.
LINES = ("a", "b")
#: The word that ends the active faults at a place.
CLEAR = "ok"


#: Chooses one of several balises or signals; written ``only 12``, or as a number behind the place.
ONLY = Parameter("only", COUNT, 0.0, "one of them, by its number; 0: all", "only", 0.0, 1e6)


def _share(meaning: str) -> Parameter:
    return Parameter("share", SHARE, 1.0, meaning, low=0.0, high=1.0)


_NETEM = "Linux netem"
_CANOE = "CANoe interaction layer"
_CAN = "CAN, FMI-LS-BUS"
_POSIX = "POSIX"
_XIL = "ASAM XIL"

_DOORS = ("door", "door_left", "door_right", "psd")

_TRAIN = (
    Word("scale", "train", "multiplied", RAILWAY, (Parameter("factor", NUMBER, None, "factor", low=0.01, high=100.0),),
         names=("mass", "gradient", "resistance", "gain", "lag")),
    Word("longer", "train", "longer", RAILWAY,
         (Parameter("extra_s", TIME, None, "added to the delay", low=0.0, high=5.0),), names=("delay",)),
    Word("offset", "train", "shifted", RAILWAY,
         (Parameter("permil", NUMBER, None, "per mil of the grade", low=-100.0, high=100.0, example="5"),),
         names=("gradient",)),
    Word("low", "train", "wheels slip and slide", RAILWAY,
         (Parameter("coefficient", NUMBER, 0.05, "of adhesion", low=0.001, high=1.0),), names=("adhesion",)),
    Word("off", "train", "lowered, opened or open", PX4,
         names=("power", "pantograph", "main_breaker", "doors", "parking_brake", "safety_loop")),
    Word("low", "train", "the line voltage is low: below two thirds there is no traction (EN 50163)", RAILWAY,
         (Parameter("share", SHARE, 0.6, "share of the nominal voltage", low=0.0, high=1.2),), names=("line_voltage",)),
    Word("stuck_open", "train", "they do not close", RAILWAY, names=_DOORS),
    Word("slow", "train", "they take longer to open and to close", RAILWAY,
         (Parameter("factor", NUMBER, 3.0, "of the time", low=1.0, high=100.0),), names=_DOORS),
    Word("obstacle", "train", "closings meet an obstacle", RAILWAY,
         (Parameter("closings", COUNT, 1.0, "that meet it", low=1.0, high=100.0),), names=_DOORS, lasts=False),
    Word("not_locked", "train", "closed doors are not locked", RAILWAY, names=_DOORS),
    Word("isolated", "train", "locked by hand: they do not move", RAILWAY, names=_DOORS),
    Word("hold", "train", "it takes longer", RAILWAY,
         (Parameter("extra_s", TIME, 45.0, "added to it", low=0.0, high=1000.0),), names=("dwell",)),
    Word("red", "train", "they show red", RAILWAY, (ONLY,), names=("signal",)),
    Word("lost", "train", "none is received", RAILWAY, names=("authority",)),
    Word("dead", "train", "it does nothing any more", RAILWAY, names=("atp",)),
    Word("weak", "train", "only a share of its force", RAILWAY,
         (Parameter("share", SHARE, 0.5, "share of the force that is left", low=0.0, high=1.0),),
         names=("holding_brake", "emergency_brake")),
    Word("nan", "train", "the state is no longer a number: a defect of the bench", "numerics", names=("model",),
         lasts=False),
)  # fmt: skip

_SENSOR = (
    *(kind.word for kind in SENSOR_KINDS),
    Word("missed", "sensor", "balises are not read", RAILWAY, (ONLY,), names=("balise",)),
    Word("doubled", "sensor", "balises are reported twice", RAILWAY, (ONLY,), names=("balise",)),
    Word("wrong", "sensor", "balises are reported at a wrong place", RAILWAY,
         (Parameter("error_m", LENGTH, None, "error of the surveyed position", low=-1e6, high=1e6, example="5m"), ONLY),
         names=("balise",)),
    Word("shifted", "sensor", "balises lie elsewhere than surveyed", RAILWAY,
         (Parameter("by_m", LENGTH, None, "distance, along the run", low=-1e3, high=1e3, example="2m"), ONLY),
         names=("balise",)),
    Word("wrong_number", "sensor", "balises are read with another number", RAILWAY,
         (Parameter("number", COUNT, None, "that is read", low=0.0, high=255.0), ONLY), names=("balise",)),
)  # fmt: skip

_ACTUATOR = tuple(kind.word for kind in ACTUATOR_KINDS)

_COMMAND = (
    Word("value", "command", "a fixed command, also one out of range", _CANOE,
         (Parameter("value", NUMBER, None, "value in the signal's unit", example="3"),)),
    Word("stuck", "command", "the command of the first instant stays", PX4),
    Word("offset", "command", "shifted", _CANOE, (Parameter("error", NUMBER, None, "error in the signal's unit"),)),
    Word("scale", "command", "multiplied", _CANOE, (Parameter("factor", NUMBER, None, "factor"),)),
    Word("random", "command", "random values over the whole range of the signal", _CANOE),
)  # fmt: skip

_CLOCK = (
    Word("step", "clock", "the time sent is wrong by a constant", "NTP",
         (Parameter("error_s", TIME, None, "error", low=-1e6, high=1e6),), names=("time",)),
    Word("drift", "clock", "the time sent drifts", "oscillators",
         (Parameter("rate_ppm", PPM, None, "rate", low=-1e5, high=1e5),), names=("time",)),
    Word("stuck", "clock", "the time sent stands still", PX4, names=("time",)),
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
         (Parameter("port", NAME, None, "the other port", example="NOTCH_CMD"),)),
    Word("truncate", "telegram", "the frames are shorter", _CAN,
         (Parameter("bytes", COUNT, 4.0, "bytes that are left", low=0.0, high=7.0),)),
    Word("replay", "telegram", "telegrams of some time ago instead of the present ones", "SDTv2",
         (Parameter("age_s", TIME, None, "how long ago", low=0.001, high=1000.0),), looks_back=True),
    Word("stuck", "telegram", "the telegram of the first instant is repeated, its counter included", PX4),
    Word("remote", "telegram", "remote frames instead of data frames", _CAN),
    Word("value", "telegram", "a fixed counter", _CANOE, (Parameter("value", COUNT, None, "counter", low=0.0),),
         "counter", CONTINUING, looks_back=True),
    Word("freeze", "telegram", "the counter stands", _CANOE, (), "counter", CONTINUING, looks_back=True),
    Word("random", "telegram", "a random counter", _CANOE, (), "counter", CONTINUING, looks_back=True),
    Word("offset", "telegram", "a wrong counter by a constant", _CANOE,
         (Parameter("offset", NUMBER, 1.0, "difference"),), "counter", CONTINUING, looks_back=True),
    Word("value", "telegram", "fixed check sequences", _CANOE,
         (Parameter("value", COUNT, None, "octet", low=0.0, high=255.0),), "checksum", looks_back=True),
    Word("freeze", "telegram", "the check sequences of the first instant", _CANOE, (), "checksum", looks_back=True),
    Word("random", "telegram", "random check sequences", _CANOE, (), "checksum", looks_back=True),
    Word("offset", "telegram", "check sequences wrong by a constant", _CANOE,
         (Parameter("offset", NUMBER, 1.0, "difference", low=-255.0, high=255.0),), "checksum", looks_back=True),
    Word("value", "telegram", "a fixed value of the signal", _CANOE,
         (Parameter("value", NUMBER, None, "in its unit", example="20"),), "signal"),
    Word("raw", "telegram", "a fixed raw value of the signal", _CANOE,
         (Parameter("value", NUMBER, None, "raw value", example="100"),), "signal"),
    Word("stuck", "telegram", "the signal of the first instant stays", PX4, (), "signal"),
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
    Word(CLEAR, level, "ends the active faults at this place", PX4, part=part, lasts=False)
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
    """Kind of the part of a place: ``whole``, ``counter``, ``checksum``, ``signal`` or ``line``."""
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
