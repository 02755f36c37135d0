"""An FMU of a train: checked against the file of its names, started, and stepped."""

from __future__ import annotations

import atexit
import tempfile
import weakref
from collections.abc import Mapping
from pathlib import Path
from shutil import rmtree
from typing import Any
from zipfile import BadZipFile, ZipFile

from railhil.common.errors import InputError, Sentence, Words
from railhil.common.extras import missing_library
from railhil.common.user_files import open_given
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.fmu.names import Named, Quantities, read_names
from railhil.scenarios.plant_fmu import FMU_BYTES_MAX, OPTION, PlantFmu

_VERSIONS = ("2.0", "3.0")
#: Largest content of an FMU, which is written to the temporary folder.
_UNPACKED_MAX = 2_000_000_000
_REALS = ("Real", "Float64")
_BOOLEANS = ("Boolean",)


def _library(command: str) -> Any:
    try:
        import fmpy
    except ImportError as error:
        raise missing_library(command, error, "fmi") from None
    return fmpy


class Fmu:
    """One instance of an FMU, from the start of its time.

    :param quantities: quantities exchanged with the plant.
    :param train: values of the train's keys, for the parameters that name one.
    :param step_s: the bench's step.
    :param alone: whether the plant needs no other instance.
    :raises InputError: the FMU cannot be the plant: version, kind, platform, a variable, its causality or unit, a
        parameter, or the step.
    """

    def __init__(
        self, named: PlantFmu, quantities: Quantities, train: Mapping[str, float], step_s: float, alone: bool = True
    ) -> None:
        fmpy = _library(f"railhil {OPTION}")
        self.file = Path(named.file)
        self.quantities = quantities
        self.names = read_names(Path(named.map), quantities)
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
        self._check_variables()
        self._check_step(step_s)
        simulation = self.description.coSimulation
        #: Whether a process can have only one instance.
        self.only_once = bool(simulation.canBeInstantiatedOnlyOncePerProcess)
        if self.only_once and not alone:
            found = Words("canBeInstantiatedOnlyOncePerProcess is true")
            raise InputError(self.file, "CoSimulation", found, "an instance for each unit of the train")
        #: Whether steps of other lengths than :param:`step_s` are possible.
        self.variable_step = bool(simulation.canHandleVariableCommunicationStepSize)
        self._folder = tempfile.mkdtemp(prefix="railhil-fmu-")
        weakref.finalize(self, rmtree, self._folder, True).atexit = False
        # weakref's own hook is lost in a forked process, because the handlers of this process are cleared there.
        atexit.register(rmtree, self._folder, True)
        self._start(fmpy, train)

    # -- checks ---------------------------------------------------------------------------------------------------

    def _check_size(self) -> None:
        try:
            with open_given(self.file, FMU_BYTES_MAX) as stream, ZipFile(stream) as archive:
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

    def _check_variables(self) -> None:
        known = {variable.name: variable for variable in self.description.modelVariables}
        self._variables = known
        for key, group, causality in (
            ("inputs", self.names.inputs, "input"),
            ("outputs", self.names.outputs, "output"),
        ):
            for quantity, named in group.items():
                variable = self._known(f"{key}.{quantity}", named.variable)
                if variable.causality != causality:
                    raise self._wrong(named.variable, "causality", variable.causality, causality)
                kinds = (*_REALS, *_BOOLEANS) if quantity in self.quantities.switches else _REALS
                if variable.type not in kinds:
                    raise self._wrong(named.variable, "type", variable.type, " or ".join(kinds))
                declared = variable.unit or getattr(variable.declaredType, "unit", None)
                if declared is not None and declared != named.unit:
                    raise self._wrong(named.variable, "unit", declared, f"{named.unit} ({self.names.file.name})")
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

    def _start(self, fmpy: Any, train: Mapping[str, float]) -> None:
        description = self.description
        try:
            fmpy.extract(str(self.file), unzipdir=self._folder)
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
            "unzipDirectory": self._folder,
            "modelIdentifier": description.coSimulation.modelIdentifier,
            "instanceName": "train",
        }
        values = {name: self._parameter(name, value, train) for name, value in self.names.parameters.items()}
        try:
            if description.fmiVersion == "2.0":
                from fmpy.fmi2 import FMU2Slave

                self._slave = FMU2Slave(**given)
                self._set, self._get = self._slave.setReal, self._slave.getReal
                self._slave.instantiate()
                self._slave.setupExperiment(startTime=0.0)
                self._set_all(values)
                self._slave.enterInitializationMode()
            else:
                from fmpy.fmi3 import FMU3Slave

                self._slave = FMU3Slave(**given)
                self._set, self._get = self._slave.setFloat64, self._slave.getFloat64
                self._slave.instantiate()
                self._set_all(values)
                self._slave.enterInitializationMode(startTime=0.0)
            self._slave.exitInitializationMode()
            self._bind()
            #: The outputs at the start.
            self.begun = self.read()
        except Exception as error:
            # A library that cannot be loaded raises it, too.
            cause = " ".join(str(error).split())
            allowed = Sentence("cannot be started as that of an FMU")
            raise InputError(self.file, "start", Words("cannot be started"), allowed, cause) from None

    def _set_all(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self._set([self._variables[name].valueReference], [value])

    def _parameter(self, name: str, value: float | str, train: Mapping[str, float]) -> float:
        if not isinstance(value, str):
            return float(value)
        if value not in train:
            raise InputError(self.names.file, f"parameters.{name}", value, ", ".join(train))
        return train[value]

    def _bind(self) -> None:
        """References and factors, in the order of the names."""

        def reals(group: Mapping[str, Named]) -> dict[str, Named]:
            return {name: one for name, one in group.items() if self._variables[one.variable].type in _REALS}

        inputs = reals(self.names.inputs)
        self._inputs = tuple(inputs)
        self._input_references = [self._variables[one.variable].valueReference for one in inputs.values()]
        self._input_factors = [one.factor for one in inputs.values()]
        self._outputs = [(one.factor, name) for name, one in self.names.outputs.items()]
        self._output_references = [self._variables[one.variable].valueReference for one in self.names.outputs.values()]
        self._switches = [
            (name, self._variables[one.variable].valueReference)
            for name, one in self.names.inputs.items()
            if name not in inputs
        ]

    def _check_step(self, step_s: float) -> None:
        """Refuse a step that the FMU declares impossible."""
        fixed = getattr(self.description.coSimulation, "fixedInternalStepSize", None)
        if fixed and abs(step_s / float(fixed) - round(step_s / float(fixed))) > 1e-6:
            raise InputError(self.file, "step", f"{float(fixed):g} s", f"one of which {step_s:g} s is a multiple")

    # -- use ------------------------------------------------------------------------------------------------------

    def read(self) -> dict[str, float]:
        """The outputs now, in our units."""
        values = self._get(self._output_references)
        return {name: value * factor for (factor, name), value in zip(self._outputs, values, strict=True)}

    def step(self, inputs: Mapping[str, float], step_s: float) -> dict[str, float]:
        """Set the inputs, make a step, and read the outputs.

        :raises PlantError: the FMU refuses it.
        """
        values = [inputs[name] / factor for name, factor in zip(self._inputs, self._input_factors, strict=True)]
        try:
            self._set(self._input_references, values)
            for name, reference in self._switches:
                self._slave.setBoolean([reference], [inputs[name] > 0.5])
            # FMI 3.0 answers with (events to handle, ended, returned early, time reached).
            answer = self._slave.doStep(self._time_s, step_s)
            if answer is not None and (answer[1] or answer[2]):
                raise PlantError("it ended the simulation" if answer[1] else f"it stopped at {answer[3]:g} s")
            self._time_s += step_s
            return self.read()
        except Exception as error:
            # The interface to native code may raise anything.
            cause = " ".join(str(error).split())
            raise PlantError(
                f"{self.file.name}: refuses the step of {step_s:g} s at {self._time_s:g} s: {cause}"
            ) from None
