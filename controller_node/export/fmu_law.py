"""The parts of an exported law for an FMU: its C, its inputs and its outputs, in fixed point or in single precision."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.export.bundle import Bundle, control_of
from railhil.controller_node.export.control import Wire
from railhil.controller_node.export.interface import wires_of
from railhil.controller_node.export.text import Names, template
from railhil.controller_node.vector.law import Interface
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Input that tells whether other commands were sent than the law's.
OTHER_SENT = "other_sent"
_OTHER_SENT_WORDS = "1: the commands sent in the last control period were not the law's"
_COUNTERS = {"events.saturations": "saturations since the start", "events.zero_divisions": "divisions by zero"}
_NO_WIRE = Wire("")
#: C files of the FMU that do not depend on the version of FMI.
_SHARED = ("railhil_fmu.h", "railhil_fmu.c")


class Variable(NamedTuple):
    """One integer of the FMU. ``place``: its number among the inputs, or among the words of the result."""

    name: str
    place: int
    wire: Wire

    @property
    def limits(self) -> tuple[int, int] | None:
        """Smallest and largest value; None: the limits of the int32."""
        if self.wire.signal is None:
            return None
        low, high = self.wire.signal.raw_range
        return (low, high) if low > INT32_MIN and high < INT32_MAX else None


@dataclass(frozen=True, slots=True)
class FmuLaw:
    """An exported law as the inside of an FMU.

    ``files``: C files by name; ``token``: goes into the binary and the description, different for different laws.
    """

    name: str
    files: Mapping[str, str]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    period_ns: int
    token: str


def law_in_fixed_point(bundle: Bundle, scenario: AnyScenario, law: LawSpec, token: str) -> FmuLaw:
    """The law of an export in fixed point; the number of the control period comes from the time."""
    control = control_of(scenario, law)
    columns = [word.column for word in control.record if word.column != control.period_word]
    places = {column: f"input[{at}]" for at, column in enumerate(columns)} | {control.period_word: "k"}
    inside = template(
        "railhil_fmu_iq.h",
        bundle.source.name,
        GIVEN=", ".join(places[word.column] for word in control.given),
        TOLD=", ".join(places[word.column] for word in control.told),
    )
    wires = {column: Wire(words) for column, words in _COUNTERS.items()} | dict(control.wires())
    told = tuple(
        Variable(column, at, wires.get(column, _NO_WIRE))
        for at, column in enumerate(bundle.source.columns)
        if column.startswith(("out.", "events."))
    )
    files = {**bundle.files, "railhil_fmu_law.h": inside}
    return _law(bundle.source.name, files, "railhil_iq.h", columns, told, wires, scenario, token)


def law_in_single_precision(bundle: Bundle, scenario: AnyScenario, token: str) -> FmuLaw:
    """The law of an export in single precision; all of its integers are raw values of their signals."""
    interface: Interface = scenario.installed_system.part("interface")
    readings, commands = Names(), Names()
    given = [readings.new(item.name) for item in interface.readings]
    told = [commands.new(item.name) for item in interface.commands]
    wires = wires_of(interface, given, told)
    answers = [f"out.{name}" for name in told]
    for note in interface.notes:
        answers.append(f"out.{commands.new(note.name)}")
        status = interface.status_of(note)
        # This integer is not limited to the range of its signal.
        wires[answers[-1]] = _NO_WIRE if status is None else Wire(Wire.of(status, note.field).words)
    inside = template(
        "railhil_fmu_f32.h",
        bundle.source.name,
        SENT=str(len(given)),
        COMMANDS=str(len(told)),
        WORDS=str(len(answers)),
    )
    outputs = tuple(Variable(column, at, wires[column]) for at, column in enumerate(answers))
    columns = [*given, *(f"sent.{name}" for name in told)]
    files = {**bundle.files, "railhil_fmu_law.h": inside}
    return _law(bundle.source.name, files, "railhil_f32.h", columns, outputs, wires, scenario, token)


def _law(
    name: str,
    files: Mapping[str, str],
    arithmetic: str,
    columns: list[str],
    outputs: tuple[Variable, ...],
    wires: Mapping[str, Wire],
    scenario: AnyScenario,
    token: str,
) -> FmuLaw:
    inputs = [Variable(column, at, wires.get(column, _NO_WIRE)) for at, column in enumerate(columns)]
    inputs.append(Variable(OTHER_SENT, len(inputs), Wire(_OTHER_SENT_WORDS)))
    places = {
        "INPUTS": str(len(inputs)),
        "OTHER_SENT": str(len(inputs) - 1),
        "TOKEN": token,
        "PERIOD_NS": str(scenario.timing.control_period_ns),
    }
    own = (f"{name}.c", f"{name}.h", arithmetic, "railhil_fmu_law.h")
    return FmuLaw(
        name,
        {file: files[file] for file in own} | {file: template(file, name, **places) for file in _SHARED},
        tuple(inputs),
        outputs,
        scenario.timing.control_period_ns,
        token,
    )
