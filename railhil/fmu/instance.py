"""An FMU: checked against the names of its variables, started, and stepped."""

from __future__ import annotations

import atexit
import math
import tempfile
import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from shutil import rmtree
from typing import Any, NamedTuple
from zipfile import BadZipFile, ZipFile

from railhil.common.errors import InputError, Sentence, Words
from railhil.common.extras import missing_library
from railhil.common.user_files import open_given, refuse_unreadable
from railhil.fmu.names import RAW, Input, Named, Output, Quantities, equal_names, factors_of, read_names
from railhil.scenarios.plant_fmu import FMU_BYTES_MAX

_VERSIONS = ("2.0", "3.0")
#: Largest content of an FMU, which is written to the temporary folder.
_UNPACKED_MAX = 2_000_000_000
_REALS = ("Real", "Float64")
#: Range of each type of integers.
_INTEGERS = {
    "Integer": (-(1 << 31), (1 << 31) - 1),
    **{f"Int{bits}": (-(1 << bits - 1), (1 << bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": (0, (1 << bits) - 1) for bits in (8, 16, 32, 64)},
}
_BOOLEAN = "Boolean"
_NUMBERS = (*_REALS, "Float32", *_INTEGERS, _BOOLEAN)


def temporary_folder(owner: object) -> Path:
    """A folder that is removed with its owner, and when this process ends."""
    folder = Path(tempfile.mkdtemp(prefix="railhil-fmu-"))
    weakref.finalize(owner, rmtree, folder, True).atexit = False
    # weakref's own hook is lost in a forked process, because the handlers of this process are cleared there.
    atexit.register(rmtree, folder, True)
    return folder


class FmuError(Exception):
    """The FMU refuses a step, or a value does not fit its variable."""


class _Variable(NamedTuple):
    """A variable with a quantity: names of both, and the factor from the variable to the quantity."""

    quantity: str
    name: str
    reference: int
    factor: float


class _Group(NamedTuple):
    """Variables of one type, and the function that sets or gets them by their references."""

    type: str
    variables: tuple[_Variable, ...]
    references: list[int]
    call: Callable[..., Any]


def fmpy_for(command: str) -> Any:
    """FMPy.

    :param command: for an error: needs it.
    :raises InputError: it is not installed.
    """
    try:
        import fmpy
    except ImportError as error:
        raise missing_library(command, error, "fmi") from None
    return fmpy


class Fmu:
    """One instance of an FMU, from the start of its time.

    :param command: for an error: needs the FMU.
    :param file: of the FMU.
    :param names: file with the names of its variables; None: they have the names of the quantities.
    :param quantities: exchanged with the bench.
    :param numbers: values by name, for the parameters that the map sets to one.
    :param step_s: the bench's step.
    :param several: purpose of further instances in this process; empty: there are none.
    :param folder: empty, for its content; None: a temporary one, which is removed with the instance.
    :raises InputError: the FMU does not fit: version, kind, platform, a variable, its causality or unit, a parameter,
        or the step.
    """

    def __init__(
        self,
        command: str,
        file: Path,
        names: Path | None,
        quantities: Quantities,
        numbers: Mapping[str, float],
        step_s: float,
        *,
        several: str = "",
        folder: Path | None = None,
    ) -> None:
        fmpy = fmpy_for(command)
        self.file = file
        self.quantities = quantities
        given = None if names is None else read_names(names, quantities)
        self.step_s = step_s
        self._time_s = 0.0
        self._check_size()
        try:
            self.description = fmpy.read_model_description(str(self.file))
        except Exception as error:
            # The reader passes on the exceptions of XML, zip and its own checks.
            cause = " ".join(str(error).split())
            allowed = Sentence("cannot be read as that of an FMU")
            raise InputError(self.file, "modelDescription.xml", Words("cannot be read"), allowed, cause) from None
        self._check_kind(fmpy)
        self._variables = {variable.name: variable for variable in self.description.modelVariables}
        if given is None:
            wanted = [one.name for one in self._variables.values() if one.causality == "input"]
            given = equal_names(file, quantities, self._variables, wanted)
        self.names = given
        self._inputs = self._checked("inputs", self.names.inputs)
        self._outputs = self._checked("outputs", self.names.outputs)
        self._check_parameters()
        self._check_step(step_s)
        simulation = self.description.coSimulation
        #: Whether a process can have only one instance.
        self.only_once = bool(simulation.canBeInstantiatedOnlyOncePerProcess)
        if self.only_once and several:
            found = Words("canBeInstantiatedOnlyOncePerProcess is true")
            raise InputError(self.file, "CoSimulation", found, f"an instance for {several}")
        #: Whether steps of other lengths than :param:`step_s` are possible.
        self.variable_step = bool(simulation.canHandleVariableCommunicationStepSize)
        self._start(fmpy, numbers, str(temporary_folder(self) if folder is None else folder))

    # -- checks ---------------------------------------------------------------------------------------------------

    def _check_size(self) -> None:
        try:
            with (
                refuse_unreadable(self.file, "an FMU"),
                open_given(self.file, FMU_BYTES_MAX) as stream,
                ZipFile(stream) as archive,
            ):
                unpacked = sum(member.file_size for member in archive.infolist())
        except BadZipFile as error:
            raise InputError(self.file, "archive", Words("is no zip archive"), "an FMU", str(error)) from None
        if unpacked > _UNPACKED_MAX:
            found, allowed = (f"{size / 1e9:.3g} GB" for size in (unpacked, _UNPACKED_MAX))
            raise InputError(self.file, "archive", Words(f"{found} when unpacked"), f"an FMU of at most {allowed}")

    def _check_kind(self, fmpy: Any) -> None:
        description = self.description
        if description.fmiVersion not in _VERSIONS:
            raise InputError(self.file, "fmiVersion", description.fmiVersion, ", ".join(_VERSIONS))
        if description.coSimulation is None:
            raise InputError(self.file, "CoSimulation", Words(), "an FMU for co-simulation")
        wanted = fmpy.platform if description.fmiVersion == "2.0" else fmpy.platform_tuple
        found = fmpy.supported_platforms(str(self.file))
        if fmpy.platform not in found and wanted not in found:
            here = Words(f"only for {', '.join(found) or 'no platform'}")
            raise InputError(self.file, "binaries", here, f"one for {wanted}")

    def _checked(self, key: str, group: Mapping[str, Named]) -> list[tuple[str, _Variable]]:
        """The type of each variable, and the variable.

        :param key: table of the map.
        """
        return [self._check_variable(key, quantity, named) for quantity, named in group.items()]

    def _check_variable(self, key: str, quantity: str, named: Named) -> tuple[str, _Variable]:
        name = named.variable
        variable = self._known(f"{key}.{quantity}", name)
        causality = key.removesuffix("s")
        if variable.causality != causality:
            raise self._wrong(name, "causality", variable.causality, causality)
        if variable.dimensions:
            raise self._wrong(name, "dimensions", len(variable.dimensions), "0: one number")
        kinds = _NUMBERS if self.quantities.any_number else _REALS
        if quantity in self.quantities.switches:
            kinds = (*_REALS, _BOOLEAN)
        if variable.type not in kinds:
            raise self._wrong(name, "type", variable.type, " or ".join(kinds))
        known: Input | Output = self.quantities.tables[key][quantity]
        # The integers of FMI have no unit.
        is_raw = named.unit is None and known.raw is not None and variable.type in _INTEGERS
        unit = RAW if is_raw else named.unit or known.unit
        declared = variable.unit or getattr(variable.declaredType, "unit", None)
        if declared is not None and declared != unit:
            raise self._wrong(name, "unit", declared, f"{unit} ({self.names.file.name})")
        return variable.type, _Variable(quantity, name, variable.valueReference, factors_of(known)[unit])

    def _check_parameters(self) -> None:
        for name in self.names.parameters:
            variable = self._known(f"parameters.{name}", name)
            if variable.causality != "parameter" or variable.type not in _REALS:
                found = f"{variable.causality} {variable.type}"
                raise self._wrong(name, "causality", found, f"parameter {' or '.join(_REALS)}")

    def _known(self, key: str, name: str) -> Any:
        if name not in self._variables:
            raise InputError(self.names.file, key, name, f"a variable of {self.file.name}")
        return self._variables[name]

    def _wrong(self, variable: str, what: str, found: Any, allowed: str) -> InputError:
        return InputError(self.file, f"{variable}: {what}", found, allowed)

    # -- life -----------------------------------------------------------------------------------------------------

    def _start(self, fmpy: Any, numbers: Mapping[str, float], folder: str) -> None:
        description = self.description
        try:
            fmpy.extract(str(self.file), unzipdir=folder)
        except OSError:
            # The temporary folder cannot be written.
            raise
        except Exception as error:
            # The reader passes on the exceptions of zip and its own checks of names.
            cause = " ".join(str(error).split())
            allowed = Sentence("cannot be unpacked as that of an FMU")
            raise InputError(self.file, "archive", Words("cannot be unpacked"), allowed, cause) from None
        given = {
            "guid": description.guid,
            "unzipDirectory": folder,
            "modelIdentifier": description.coSimulation.modelIdentifier,
            "instanceName": self.file.stem,
        }
        values = {name: self._parameter(name, value, numbers) for name, value in self.names.parameters.items()}
        try:
            if description.fmiVersion == "2.0":
                from fmpy.fmi2 import FMU2Slave

                self._slave = FMU2Slave(**given)
                self._slave.instantiate()
                self._slave.setupExperiment(startTime=0.0)
                self._set_all(values)
                self._slave.enterInitializationMode()
            else:
                from fmpy.fmi3 import FMU3Slave

                self._slave = FMU3Slave(**given)
                self._slave.instantiate()
                self._set_all(values)
                self._slave.enterInitializationMode(startTime=0.0)
            self._slave.exitInitializationMode()
            self._setters, self._getters = self._groups("set", self._inputs), self._groups("get", self._outputs)
            #: The outputs at the start.
            self.begun = self.read()
        except Exception as error:
            # A library that cannot be loaded raises it, too.
            cause = " ".join(str(error).split())
            allowed = Sentence("cannot be started as that of an FMU")
            raise InputError(self.file, "start", Words("cannot be started"), allowed, cause) from None

    def _set_all(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            variable = self._variables[name]
            getattr(self._slave, f"set{variable.type}")([variable.valueReference], [value])

    def _parameter(self, name: str, value: float | str, numbers: Mapping[str, float]) -> float:
        if not isinstance(value, str):
            return float(value)
        if value not in numbers:
            raise InputError(self.names.file, f"parameters.{name}", value, ", ".join(numbers))
        return numbers[value]

    def _groups(self, verb: str, typed: list[tuple[str, _Variable]]) -> list[_Group]:
        """The variables by type; FMPy has a function for each type."""
        found: dict[str, list[_Variable]] = {}
        for kind, variable in typed:
            found.setdefault(kind, []).append(variable)
        return [
            _Group(kind, tuple(group), [one.reference for one in group], getattr(self._slave, f"{verb}{kind}"))
            for kind, group in found.items()
        ]

    def _check_step(self, step_s: float) -> None:
        """Refuse a step that the FMU declares impossible."""
        fixed = getattr(self.description.coSimulation, "fixedInternalStepSize", None)
        if fixed and abs(step_s / float(fixed) - round(step_s / float(fixed))) > 1e-6:
            raise InputError(self.file, "step", f"{float(fixed):g} s", f"one of which {step_s:g} s is a multiple")

    # -- use ------------------------------------------------------------------------------------------------------

    def read(self) -> dict[str, float]:
        """The outputs now, in our units."""
        return {
            one.quantity: value * one.factor
            for group in self._getters
            for one, value in zip(group.variables, group.call(group.references), strict=True)
        }

    def step(self, inputs: Mapping[str, float], step_s: float, time_s: float | None = None) -> dict[str, float]:
        """Set the inputs, make a step, and read the outputs.

        :param time_s: its beginning; None: the end of the last step.
        :raises FmuError: the FMU refuses it, or an input does not fit its variable.
        """
        self._time_s = self._time_s if time_s is None else time_s
        try:
            for group in self._setters:
                values = [inputs[one.quantity] / one.factor for one in group.variables]
                group.call(group.references, _converted(group, values))
            # FMI 3.0 answers with (events to handle, ended, returned early, time reached).
            answer = self._slave.doStep(self._time_s, step_s)
            if answer is not None and (answer[1] or answer[2]):
                raise FmuError("it ended the simulation" if answer[1] else f"it stopped at {answer[3]:g} s")
            self._time_s += step_s
            return self.read()
        except Exception as error:
            # The interface to native code may raise anything.
            cause = " ".join(str(error).split())
            raise FmuError(f"refuses the step of {step_s:g} s at {self._time_s:g} s: {cause}") from None


def _converted(group: _Group, values: list[float]) -> list[Any]:
    """Values as numbers of the group's type.

    :raises FmuError: one does not fit.
    """
    if group.type == _BOOLEAN:
        return [value > 0.5 for value in values]
    if group.type not in _INTEGERS:
        return values
    low, high = _INTEGERS[group.type]
    for one, value in zip(group.variables, values, strict=True):
        if not math.isfinite(value) or not low <= round(value) <= high:
            raise FmuError(f"{one.name}: {value:g} does not fit {group.type}, {low} to {high}")
    return [round(value) for value in values]
