"""Faults that an operator injects by their text: which prepared one it is, and its values on their way."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence
from dataclasses import replace

from railhil.common.errors import InputError
from railhil.scenarios.operator_commands import OperatorCommand


class GivenValues:
    """Values on their way to the nodes: one octet in each SUP_CMD, then ``inject``.

    ``inject`` and ``clear`` of other faults may come in between; the collected octets are then sent again.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[int, bytes]] = deque()
        self._sent = 0

    @property
    def faults(self) -> list[int]:
        """Faults whose values are on their way."""
        return [fault for fault, _ in self._waiting]

    def add(self, fault: int, octets: bytes) -> None:
        """Send the values of a fault, and inject it."""
        self._waiting.append((fault, octets))

    def drop(self, fault: int) -> None:
        """Do not inject a fault."""
        self._waiting = deque(one for one in self._waiting if one[0] != fault)
        self._sent = 0

    def interrupted(self) -> None:
        """Another fault was ordered."""
        self._sent = 0

    def next(self, answer: int) -> OperatorCommand | None:
        """The order of a SUP_CMD."""
        if not self._waiting:
            return None
        fault, octets = self._waiting[0]
        if self._sent < len(octets):
            self._sent += 1
            return OperatorCommand(answer, "value", octets[self._sent - 1])
        self._waiting.popleft()
        self._sent = 0
        return OperatorCommand(answer, "inject", fault)


def prepared_for(
    text: str, faults: Sequence[str], injected: Collection[int]
) -> tuple[int, bytes, float | None, str] | str:
    """The prepared fault for an operator's text, found by its place, word and count, independent of its values.

    :param text: such as ``TRN_SPEED loss 5% for 3s``: it begins now.
    :param faults: of the run.
    :param injected: numbers of the faults that were injected.
    :returns: its number, the octets of its values (:func:`railhil.faults.operator_values.octets_of`), its duration in s
        (None: until it is cleared) and its new text; or why there is none, in one line.
    """
    # The language is loaded only when it is used.
    from railhil.faults.language import fault_text, parse, sameness, with_condition
    from railhil.faults.model import Draw
    from railhil.faults.operator_values import is_kind, octets_of

    try:
        wanted = parse(with_condition(text, "manual"), "page")
    except InputError as error:
        return str(error)
    if wanted.trigger.kind != "manual" or wanted.until:
        return f"{text}: in a run a fault begins now and lasts for some time: without @ and until"
    if any(isinstance(value, Draw) for value in wanted.values.values()):
        return f"{text}: in a run nothing is drawn: numbers only"
    known = enumerate(map(parse, faults), start=1)
    prepared = {number: one for number, one in known if one.trigger.kind == "manual" and is_kind(one, wanted)}
    if not prepared:
        return f"{text}: not prepared in this run: its list names what is; others are added before Start"
    fresh = [number for number in prepared if number not in injected]
    if not fresh:
        return f"{text}: as many faults of this kind as are prepared have been injected: each is injected once"
    exact = [number for number in fresh if sameness(prepared[number]) == sameness(wanted)]
    number = (exact or fresh)[0]
    made = replace(prepared[number], values=wanted.values)
    return number, octets_of(number, prepared[number], wanted), wanted.duration_s, fault_text(made)
