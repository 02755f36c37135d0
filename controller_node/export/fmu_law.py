"""The parts of an exported law for an FMU: its C, its inputs and its outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.export.bundle import Bundle, control_of
from railhil.controller_node.export.control import Wire
from railhil.controller_node.export.source import BODIES
from railhil.controller_node.export.text import template
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Input that tells whether other commands were sent than the law's.
OTHER_SENT = "other_sent"
_OTHER_SENT_WORDS = "1: the commands sent in the last control period were not the law's"
_COUNTERS = {"events.saturations": "saturations since the start", "events.zero_divisions": "divisions by zero"}
_NO_WIRE = Wire("")
#: C files of the FMU that do not depend on the version of FMI.
_SHARED = ("railhil_fmu_law.h", "railhil_fmu.h", "railhil_fmu.c")
#: Placeholders in the C of the frame, for integers and for real numbers.
INTEGERS = {
    "WHAT": "exported law", "TITLE": "exported control law",
    "VALUES": "integers in, integers out, words\n * of the C as they are",
    "TYPE": "Integer", "OTHER": "Real", "NUMBER": "int32_t",
}  # fmt: skip
REALS = {
    "WHAT": "controller", "TITLE": "controller", "VALUES": "real numbers in and out",
    "TYPE": "Real", "OTHER": "Integer", "NUMBER": "double",
}  # fmt: skip


class Variable(NamedTuple):
    """One variable of the FMU, an integer or, with a unit, a real number.

    ``place``: its number among the inputs, or among the words of the result; ``unit``: empty if it has none.
    """

    name: str
    place: int
    wire: Wire
    unit: str | None = None

    @property
    def limits(self) -> tuple[int, int] | None:
        """Smallest and largest value; None: the limits of the int32."""
        if self.wire.signal is None:
            return None
        low, high = self.wire.signal.raw_range
        return (low, high) if low > INT32_MIN and high < INT32_MAX else None


@dataclass(frozen=True, slots=True)
class FmuLaw:
    """An exported law, or a controller of the user, as the inside of an FMU.

    ``files``: C files by name; ``token``: goes into the binary and the description, different for different laws;
    ``keeps_state``: whether all of its state is in the instance.
    """

    name: str
    files: Mapping[str, str]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    period_ns: int
    token: str
    keeps_state: bool = True


def law_of(bundle: Bundle, scenario: AnyScenario, law: LawSpec, token: str) -> FmuLaw:
    """The law of an export; the number of the control period comes from the time."""
    control, name = control_of(scenario, law), bundle.source.name
    columns = [word.column for word in control.record if word.column != control.period_word]
    places = {column: f"input[{at}]" for at, column in enumerate(columns)} | {control.period_word: "k"}
    wires = {column: Wire(words) for column, words in _COUNTERS.items()} | dict(control.wires(scenario))
    outputs = tuple(
        Variable(column, at, wires.get(column, _NO_WIRE))
        for at, column in enumerate(bundle.source.columns)
        if column.startswith(("out.", "events."))
    )
    inputs = [Variable(column, at, wires.get(column, _NO_WIRE)) for at, column in enumerate(columns)]
    inputs.append(Variable(OTHER_SENT, len(inputs), Wire(_OTHER_SENT_WORDS)))
    words = INTEGERS | {
        "GIVEN": ", ".join(places[word.column] for word in control.given),
        "TOLD": ", ".join(places[word.column] for word in control.told),
        "INPUTS": str(len(inputs)),
        "OTHER_SENT": str(len(inputs) - 1),
        "TOKEN": token,
        "PERIOD_NS": str(scenario.timing.control_period_ns),
    }
    own = (f"{name}.c", f"{name}.h", BODIES[law.arithmetic].header, "railhil_result.h")
    files = {file: bundle.files[file] for file in own} | {file: template(file, name, **words) for file in _SHARED}
    return FmuLaw(name, files, tuple(inputs), outputs, scenario.timing.control_period_ns, token)
