"""The ports of a fault, and the faults that cannot be injected on a transport or at a pace, with the reasons.

:data:`REFUSALS` is one table, for the check and the document.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from railhil.common.errors import InputError, Sentence, Words
from railhil.dbc import Contract, Port, Signal
from railhil.faults.language import fault_text
from railhil.faults.model import Fault, Word
from railhil.faults.truth import Truth
from railhil.faults.words import CLEAR, WORDS, kind_of_part, word_of

#: Transports: name and description.
TRANSPORTS = {
    "local": "all nodes in one process (`--bus local`, tests, campaigns through the nodes)",
    "hub": "railhil's hub, also as a gateway to other buses",
    "kernel": "SocketCAN: vcan, or a CAN interface of the kernel",
    "adapter": "any other interface of python-can, such as slcan",
    "board": "a controller that is not railhil's (`--no-controller`), on any of these",
    "batch": "the compiled batch of `campaign` and `tune`",
}
#: Transports without the hub's model of CAN controllers and lines; a board gets no reports of them.
_NOT_THE_HUB = tuple(name for name in TRANSPORTS if name != "hub")
PACES = ("lockstep", "realtime")


def looks_back(fault: Fault) -> bool:
    """Whether its effect depends on what passed its place before it began."""
    place = fault.place
    word = word_of(place.level, place.name, place.part, fault.what)
    return fault.trigger.kind == "telegram" or (word is not None and word.looks_back)


@dataclass(frozen=True, slots=True)
class Refusal:
    """Faults that cannot be injected; an empty field matches everything.

    ``names``: places of the level; ``parts``: as in :class:`railhil.faults.words.Word`; ``sources``: nodes at which the
    fault acts; ``unless_constant``: does not match faults for which :func:`is_constant` is true.
    """

    why: str
    levels: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    transports: tuple[str, ...] = ()
    unless_constant: bool = False
    paces: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def fits(self, word: Word, name: str) -> bool:
        """Whether it matches a word at a place, on any transport."""
        return (
            word.name != CLEAR
            and (not self.levels or word.level in self.levels)
            and (not self.words or word.name in self.words)
            and (not self.names or name in self.names)
            and (not self.parts or word.part in self.parts)
        )


#: The table; the first matching entry gives the reason.
REFUSALS: tuple[Refusal, ...] = (
    Refusal("only railhil's hub has two lines", ("bus",), parts=("line",), transports=_NOT_THE_HUB),
    Refusal(
        "only railhil's hub takes orders for its error counters",
        ("bus",),
        ("error_frames", "passive"),
        transports=_NOT_THE_HUB,
    ),
    Refusal("end the process by hand: nothing is left that could record it", ("node",), names=("supervisor",)),
    Refusal("only a controller can be made anew or answer late", ("node",), ("restart", "slow"), ("plant",)),
    Refusal("the plant is in the process of all others", ("node",), names=("plant",), transports=("local",)),
    Refusal("in lockstep all nodes stand still with the plant", ("node",), ("stop",), ("plant",), paces=("lockstep",)),
    Refusal("lockstep has no wall clock", ("clock",), names=("wall",), paces=("lockstep",)),
    Refusal(
        "the batch has no injectors: such runs go through the nodes",
        transports=("batch",),
        unless_constant=True,
    ),
    Refusal(
        "the controller is not railhil's: its connection has no injector",
        ("command", "telegram", "node", "bus"),
        transports=("board",),
        sources=("controller",),
    ),
)


#: Places of the train and words that a changed scenario can express.
MISMATCHES = (("mass", "scale"), ("resistance", "scale"), ("gradient", "scale"), ("gradient", "offset"))


def is_constant(fault: Fault) -> bool:
    """Whether a fault is a mismatch from the start to the end, which a changed scenario can express.

    The batch computes such faults with any drawn values; runs with any other fault go through the nodes.
    """
    begins = fault.trigger.kind == "time" and not fault.trigger.value and not fault.trigger.delay_s
    ends = fault.duration_s is not None or fault.count is not None or bool(fault.until)
    return fault.place.level == "train" and (fault.place.name, fault.what) in MISMATCHES and begins and not ends


def refusals(word: Word, name: str) -> Iterator[Refusal]:
    """All entries that match a word at a place."""
    return (entry for entry in REFUSALS if entry.fits(word, name))


def why_not(fault: Fault, transport: str, pace: str, sources: Sequence[str] = ()) -> str:
    """Reason for which a fault cannot be injected; empty if it can.

    :param transport: one of :data:`TRANSPORTS`.
    :param sources: nodes at which it acts.
    """
    place = fault.place
    part = kind_of_part(place.level, place.part)
    word = next(one for one in WORDS if (one.level, one.name, one.part) == (place.level, fault.what, part))
    for entry in refusals(word, place.name):
        on = not entry.transports or transport in entry.transports
        at = not entry.paces or pace in entry.paces
        if entry.unless_constant and is_constant(fault):
            continue
        if on and at and (not entry.sources or {*entry.sources} & {*sources}):
            return entry.why
    return ""


def check_injectable(fault: Fault, transports: Sequence[str], pace: str, sources: Sequence[str] = ()) -> None:
    """Refuse a fault that cannot be injected; none is ignored.

    :param transports: all that apply to the run.
    :param sources: nodes at which it acts.
    :raises InputError: it cannot.
    """
    for transport in transports:
        if why := why_not(fault, transport, pace, sources):
            found = Words(f"a run on {transport} in {pace}")
            allowed = Sentence(f"cannot be injected in {found}: {why}")
            raise InputError("faults", fault_text(fault, judging=False), found, allowed)


#: Ports of the bench itself, by which it observes and judges.
_BENCH = frozenset(("RUN_EVENT", "SUP_CMD", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT"))


def instruments(truth: Truth | None) -> frozenset[str]:
    """Names of the ports that no fault touches: the ports of the bench, and the truth of the system."""
    return _BENCH if truth is None else _BENCH | {truth.port, *truth.beside}


def port_names(fault: Fault, contract: Contract, units: Sequence[str], named: Mapping[str, str]) -> list[str]:
    """Names of the ports of a fault of a telegram or a command; they need not exist.

    With units the fault has the part of a port's name after the unit.

    :param units: first words of the ports of each unit.
    :param named: commands by name, each ``PORT.Signal``.
    """
    place = fault.place
    name = named.get(place.name, "").partition(".")[0] if place.level == "command" else place.name
    if not units or any(port.name == name for port in contract.ports):
        return [name]
    chosen = [units[number - 1] for number in fault.units if number <= len(units)] if fault.units else units
    return [f"{unit}_{name}" for unit in chosen]


def signal_of(fault: Fault, named: Mapping[str, str]) -> str:
    """Name of the signal that a fault changes; empty if it is none."""
    place = fault.place
    if place.level == "command":
        return named.get(place.name, "").partition(".")[2]
    return "" if place.part in ("counter", "checksum") else place.part


def life_signal(port: Port) -> Signal | None:
    """The life sign of a port; None: it has none."""
    return next((signal for signal in port.signals if signal.name.endswith("Life")), None)
