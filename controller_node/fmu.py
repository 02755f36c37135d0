"""A controller that is an FMU (Functional Mock-up Interface 2.0 and 3.0, co-simulation)."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from railhil.common.errors import InputError, Sentence, Words
from railhil.controller_node.export.bundle import control_kind
from railhil.controller_node.export.fmu_law import OTHER_SENT
from railhil.controller_node.given.computing import Computer, Terms, checked_answer
from railhil.controller_node.given.worker import WorkerController
from railhil.fmu.determinism import outputs_sha256, twice
from railhil.fmu.instance import Fmu, FmuError, temporary_folder
from railhil.fmu.names import Input, Output, Quantities
from railhil.scenarios.given import FINDINGS, FMU_OPTION
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: An FMU, and the file with the names of its variables.
_TEXT = re.compile(r"(?P<file>.+\.fmu)(?::(?P<names>.+\.toml))?")
_OUT, _SENT = "out.", "sent"
_TIME = "time_s"
#: Control periods of each of the two runs that are compared.
_PERIODS = 1000
#: Values in the check of determinism by unit, for quantities of which it has no other.
_OTHERS = {"m/s": 20.0, "m": 1000.0, "notch": 3.0}


class Word(NamedTuple):
    """A raw integer of the wire: the reading or command whose integer it is, and the value of 1 in its unit."""

    quantity: str
    one: float


def words_of(scenario: AnyScenario) -> dict[str, Word]:
    """The raw integers that a map may name, by the names that an exported law has for them."""
    wires = control_kind(scenario.installed_system).wires(scenario)
    return {name: Word(wire.quantity, wire.one) for name, wire in wires.items() if wire.quantity}


def quantities_of(terms: Terms, words: Mapping[str, Word]) -> Quantities:
    """Readings and commands in their units, and the raw integers of the wire.

    :raises KeyError: an integer of none of them.
    """
    inputs = {one.name: Input(one.unit or "1", 0.0, _OTHERS.get(one.unit, 1.0)) for one in terms.readings}
    outputs = {one.name: Output(one.unit or "1") for one in terms.commands}
    for name, word in words.items():
        if name in inputs:
            # A system whose readings have the names of their integers.
            inputs[name] = inputs[name]._replace(raw=word.one)
        elif word.quantity in inputs:
            inputs[name] = Input("1", 0.0, 1.0)
        elif word.quantity in outputs:
            outputs[name] = Output("1")
        else:
            raise KeyError(f"{name}: no reading or command {word.quantity}")
    if any(name.startswith(_SENT) for name in words):
        inputs[OTHER_SENT] = Input("1", 0.0, 1.0)
    return Quantities(inputs, outputs, any_number=True)


class FmuController(WorkerController):
    """``FILE.fmu``, and perhaps the file with the names of its variables: else ``FILE.toml``, if there is one, or the
    names of the readings and commands."""

    form: ClassVar[str] = "FILE.fmu[:NAMES.toml]"

    def __init__(self, text: str) -> None:
        super().__init__(text)
        found = _TEXT.fullmatch(text)
        assert found is not None
        self._file = Path(found["file"])
        beside = self._file.with_suffix(".toml")
        self._names = Path(found["names"]) if found["names"] else beside if beside.is_file() else None
        self.name = re.sub(r"[^A-Za-z0-9_+-]+", "_", self._file.stem)
        self._words: Mapping[str, Word] = {}

    @classmethod
    def reads(cls, text: str) -> bool:
        return _TEXT.fullmatch(text) is not None

    def files(self) -> tuple[Path, ...]:
        return (self._file,) if self._names is None else (self._file, self._names)

    def make_node(self, scenario: AnyScenario, run: RunSpec, *, fd: bool, bit_rate: int | None) -> Any:
        self._words = words_of(scenario)
        return super().make_node(scenario, run, fd=fd, bit_rate=bit_rate)

    def start(self, terms: Terms, patience_s: float) -> Computer:
        # The process that unpacks the FMU may end at any time.
        folder = temporary_folder(self)
        words = json.dumps({name: list(word) for name, word in self._words.items()})
        self.arguments = [str(self._file), str(self._names or ""), str(folder), words]
        return super().start(terms, patience_s)

    @staticmethod
    def load(arguments: Sequence[str], terms: Terms) -> Computer:
        file, names, folder, text = arguments
        words = {name: Word(*word) for name, word in json.loads(text).items()}
        return FmuComputer(Path(file), Path(names) if names else None, Path(folder), terms, words)

    def check(self, scenario: AnyScenario, run: RunSpec) -> str:
        """Whether it is deterministic: two processes with one instance each, given the same readings.

        Returns a note if it is not; empty if it is.

        :raises InputError: the FMU cannot be the controller.
        """
        self._words = words_of(scenario)
        terms = self.terms_of(scenario, run)
        computers = [self.start(terms, run.patience_s / 2) for _ in range(2)]
        try:
            same, why = twice([partial(_outputs_sha256, computer, terms) for computer in computers], InputError)
        finally:
            for computer in computers:
                computer.close()
        self.findings = dict(zip(FINDINGS, (same, why) if why else (same,), strict=False))
        return "" if same else f"the run may not be repeatable: {self._file}: {why}"


def _outputs_sha256(computer: Computer, terms: Terms) -> str:
    """Of one run of the check; the time goes on as in a run."""
    period = 0

    def step(values: dict[str, float]) -> Sequence[float]:
        nonlocal period
        if _TIME in values:
            values[_TIME] = period * terms.period_s
        period += 1
        return computer.compute(list(values.values()))

    return outputs_sha256(
        step, {one.name: quantities_of(terms, {}).inputs[one.name] for one in terms.readings}, _PERIODS
    )


class FmuComputer:
    """The FMU in its process, see :class:`~railhil.controller_node.given.computing.Computer`.

    A step of the FMU is a control period. A control period in which nothing was computed is a step with the inputs of
    the last one.

    :param folder: empty, for its content.
    :raises InputError: the FMU cannot be the controller.
    """

    def __init__(self, file: Path, names: Path | None, folder: Path, terms: Terms, words: Mapping[str, Word]) -> None:
        self._file, self._terms, self._words = file, terms, words
        period_s, quantities = terms.period_s, quantities_of(terms, words)
        command = f"railhil run {FMU_OPTION}"
        self._fmu = Fmu(command, file, names, quantities, {"period_s": period_s}, period_s, folder=folder)
        self._places = {one.name: place for place, one in enumerate(terms.readings)}
        self._answers = [self._answer(one.name) for one in terms.commands]
        #: Number of the next control period, and the inputs of the last.
        self._next, self._last = 0, dict[str, float]()
        #: Integer of each command in the last answer, by the word for the one really sent.
        self._sent: dict[str, int] = {}

    def _answer(self, command: str) -> tuple[str, float]:
        """The output that is a command, or its integer on the wire, and the value of 1.

        :raises InputError: there is none, or both are.
        """
        names = self._fmu.names
        words = {command: 1.0} | {
            name: word.one for name, word in self._words.items() if name.startswith(_OUT) and word.quantity == command
        }
        found = [name for name in words if name in names.outputs]
        if len(found) != 1:
            what = Words("missing") if not found else Words(f"beside {found[0]}")
            allowed = f"the name of an output of {self._file.name}, for one of {' and '.join(words)}"
            raise InputError(names.file, f"outputs.{found[-1] if found else command}", what, allowed)
        return found[0], words[found[0]]

    def compute(self, readings: Sequence[float]) -> Sequence[float]:
        period_s, k = self._terms.period_s, self._next
        if _TIME in self._places:
            k = round(readings[self._places[_TIME]] / period_s)
        given = {name: self._given(name, readings) for name in self._fmu.names.inputs}
        try:
            for missed in range(self._next, k):
                self._fmu.step(self._last or given, period_s, missed * period_s)
            found = self._fmu.step(given, period_s, k * period_s)
        except FmuError as error:
            raise InputError(self._file, "", Words(), Sentence(str(error))) from None
        self._next, self._last = k + 1, given | {OTHER_SENT: 0.0}
        values = [found[name] * one for name, one in self._answers]
        answer = checked_answer(str(self._file), self._terms, values)
        commands = {one.name: value for one, value in zip(self._terms.commands, answer, strict=True)}
        self._sent = {
            name: round(commands[command] / word.one)
            for name, word in self._words.items()
            if name.startswith(_SENT) and (command := word.quantity.removeprefix(f"{_SENT}_")) in commands
        }
        return answer

    def _given(self, name: str, readings: Sequence[float]) -> float:
        """Value of an input, from the readings."""
        if name in self._places:
            return readings[self._places[name]]
        if name == OTHER_SENT:
            return float(any(self._integer(word, readings) != sent for word, sent in self._sent.items()))
        return float(self._integer(name, readings))

    def _integer(self, name: str, readings: Sequence[float]) -> int:
        word = self._words[name]
        return round(readings[self._places[word.quantity]] / word.one)

    def close(self) -> None:
        """Nothing is outside of this process."""
