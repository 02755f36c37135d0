"""FMUs of a train, built here: one in C (FMI 2.0)."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

_SOURCE = Path(__file__).parents[1] / "data" / "fmu" / "train.c"
#: Name, causality, unit.
VARIABLES = (
    ("force", "input", "N"), ("allowed", "input", "1"), ("brake_min", "input", "N"), ("grade", "input", "permil"),
    ("s", "output", "m"), ("v", "output", "m/s"), ("effort", "output", "N"), ("mass", "parameter", ""),
    ("pole", "parameter", ""), ("a", "parameter", ""), ("b", "parameter", ""), ("c", "parameter", ""),
    ("per_permil", "parameter", ""), ("traction_max", "parameter", ""), ("brake_max", "parameter", ""),
    ("traction_power", "parameter", ""), ("brake_power", "parameter", ""),
    ("outside", "input", "N"), ("start_speed", "parameter", ""), ("start_effort", "parameter", ""),
)  # fmt: skip
MAP = """\
[inputs]
force_n = "force"
traction_allowed = "allowed"
brake_min_n = "brake_min"
grade_permil = "grade"
[outputs]
position_m = "s"
speed_mps = "v"
effort_n = "effort"
[parameters]
mass = "inertial_mass_kg"
pole = "pole_per_s"
a = "resistance_a_n"
b = "resistance_b_n_per_mps"
c = "resistance_c_n_per_mps2"
per_permil = "grade_n_per_permil"
traction_max = "traction_force_max_n"
brake_max = "brake_force_max_n"
traction_power = "traction_power_max_w"
brake_power = "brake_power_max_w"
"""
#: The same train for systems whose commands are accelerations: its mass is 1.
ACCELERATIONS = {name: (causality, "m/s2") for name, causality, unit in VARIABLES if unit == "N"}
_MAP_OF_ACCELERATIONS = """\
[inputs]
command_mps2 = "force"
outside_mps2 = "outside"
grade_permil = "grade"
[outputs]
position_m = "s"
speed_mps = "v"
drive_mps2 = "effort"
[parameters]
pole = "pole_per_s"
per_permil = "grade_mps2_per_permil"
start_speed = "start_speed_mps"
start_effort = "start_drive_mps2"
"""
MAP_OF_A_UNIT = f"""\
{_MAP_OF_ACCELERATIONS}a = "resistance_a_mps2"
b = "resistance_b_per_s"
c = "resistance_c_per_m"
traction_max = "traction_max_mps2"
brake_max = "braking_max_mps2"
traction_power = "power_w_per_kg"
"""
MAP_OF_A_STOP = _MAP_OF_ACCELERATIONS


def description(variable_step: bool = True, changes: Mapping[str, tuple[str, str]] = {}) -> str:
    """``modelDescription.xml`` of the train in C.

    :param changes: causality and unit of variables that are not as in :data:`VARIABLES`.
    """
    lines, outputs = [], []
    for number, (name, causality, unit) in enumerate(VARIABLES):
        causality, unit = changes.get(name, (causality, unit))
        kind = {"input": 'variability="continuous"', "output": 'variability="continuous"'}.get(
            causality, 'variability="fixed"' if causality == "parameter" else 'variability="continuous"'
        )
        start = ' start="0"' if causality in ("input", "parameter") else ""
        declared = f" unit={quoteattr(unit)}" if unit else ""
        lines.append(
            f'<ScalarVariable name="{name}" valueReference="{number}" causality="{causality}" {kind}>'
            f"<Real{start}{declared}/></ScalarVariable>"
        )
        outputs += [f'<Unknown index="{number + 1}"/>'] if causality == "output" else []
    units = "".join(
        f"<Unit name={quoteattr(unit)}/>"
        for unit in sorted({unit for *_, unit in VARIABLES} | {"km/h", "m/s2"})
        if unit
    )
    flag = str(variable_step).lower()
    return (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" modelName="train" guid="{train}" '
        'numberOfEventIndicators="0">'
        f'<CoSimulation modelIdentifier="train" canHandleVariableCommunicationStepSize="{flag}"/>'
        f"<UnitDefinitions>{units}</UnitDefinitions>"
        f"<ModelVariables>{''.join(lines)}</ModelVariables><ModelStructure><Outputs>{''.join(outputs)}</Outputs>"
        f"<InitialUnknowns>{''.join(outputs)}</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )


def compiled_train(folder: Path, *options: str, compiler: str = "gcc") -> Path:
    """The shared library of the train in C.

    :param options: of the compiler; with ``-DDRIFT`` no two runs are equal.
    """
    library = folder / "train.so"
    headers = Path(fmpy.__file__).parent / "c-code"
    command = [compiler, "-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-I", str(headers), str(_SOURCE)]
    subprocess.run(
        [*command, *options, "-o", str(library), "-lm"], check=True, capture_output=True, text=True, timeout=60
    )
    return library


def packed(fmu: Path, text: str, library: Path | None, names: str = MAP) -> Path:
    """Write an FMU, and the map beside it; returns its path."""
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr("modelDescription.xml", text)
        if library is not None:
            archive.write(library, f"binaries/{fmpy.platform}/train.so")
    fmu.with_suffix(".toml").write_text(names, encoding="utf-8")
    return fmu


#: The same train without limits of power, by pythonfmu (FMI 2.0) or PythonFMU3 (FMI 3.0).
PYTHON_TRAIN = """\
from {module} import {slave}, {kind} as Number, {causality} as Causality


class Train({slave}):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        {clock}self.force = self.brake_min = self.s = self.v = self.effort = 0.0
        for name in ("force", "brake_min"):
            self.register_variable(Number(name, causality=Causality.input))
        for name in ("s", "v", "effort"):
            self.register_variable(Number(name, causality=Causality.output))

    def do_step(self, current_time, step_size):
        steady = min(self.force, -self.brake_min) if self.brake_min > 0 else self.force
        self.effort += (steady - self.effort) * min(1.0, 2 * step_size)
        before = self.v
        self.v = max(0.0, before + (self.effort - 3000.0 * (before > 0)) / 220000.0 * step_size)
        self.s += (before + self.v) / 2 * step_size
        return {result}
"""
PYTHON_MAP = """\
[inputs]
force_n = "force"
brake_min_n = "brake_min"
[outputs]
position_m = "s"
speed_mps = "v"
effort_n = "effort"
"""
_FLAVOURS = {
    "2.0": {"module": "pythonfmu", "slave": "Fmi2Slave", "kind": "Real", "causality": "Fmi2Causality",
            "variability": "Fmi2Variability", "whole": "Integer", "clock": "", "result": "True"},
    "3.0": {"module": "pythonfmu3", "slave": "Fmi3Slave", "kind": "Float64", "causality": "Fmi3Causality",
            "variability": "Fmi3Variability", "whole": "Int32",
            "clock": "self.time = 0.0\n        self.register_variable(Number('time', causality=Causality.independent))"
            "\n        ", "result": "Fmi3StepResult(status=Fmi3Status.ok, eventHandlingNeeded=False, "
            "terminateSimulation=False, earlyReturn=False)"},
}  # fmt: skip


def python_train(folder: Path, version: str) -> Path:
    """An FMU in Python of this FMI version, which needs the interpreter that runs it; its map is beside it."""
    return python_fmu(folder, version, PYTHON_TRAIN, "Train", PYTHON_MAP)


def python_fmu(folder: Path, version: str, text: str, name: str, names: str) -> Path:
    """An FMU in Python, of a text with places for what differs between the FMI versions.

    :param name: of its class.
    :param names: the map beside it.
    """
    text = text.format(**_FLAVOURS[version])
    if version == "3.0":
        text = f"from pythonfmu3 import Fmi3Status, Fmi3StepResult\n{text}"
    # Python keeps a module by its name: two of these in one process need two names.
    script = folder / f"{name.lower()}_of_fmi_{version[0]}.py"
    script.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", _FLAVOURS[version]["module"], "build", "-f", str(script), "-d", str(folder)]
    subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    fmu = folder / f"{name}.fmu"
    fmu.with_suffix(".toml").write_text(names, encoding="utf-8")
    return fmu


#: A P controller in Python, with the faults that a controller can have, by the number ``fault``.
PYTHON_CONTROLLER = """\
import os
import random
import signal

from {module} import {slave}, {kind} as Number, {causality} as Causality, {variability} as Variability


class Controller({slave}):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        {clock}self.speed = self.set_point = self.command = self.fault = 0.0
        for name in ("speed", "set_point"):
            self.register_variable(Number(name, causality=Causality.input))
        self.register_variable(Number("command", causality=Causality.output))
        self.register_variable(Number("fault", causality=Causality.parameter, variability=Variability.tunable))

    def do_step(self, current_time, step_size):
        self.command = self.set_point - self.speed
        if self.fault == 1:
            self.command = float("nan")
        if self.fault == 2:
            raise ValueError("no more")
        if self.fault == 3:
            os.kill(os.getpid(), signal.SIGSEGV)
        while self.fault == 4:
            pass
        if self.fault == 5:
            self.command += random.random()
        return {result}
"""
CONTROLLER_MAP = """\
[inputs]
speed_mps = {{ variable = "speed", unit = "km/h" }}
set_point_mps = {{ variable = "set_point", unit = "km/h" }}
[outputs]
notch = "command"
[parameters]
fault = {fault}
"""


#: Passes an integer and a Boolean on, and counts its steps, and those with the Boolean true.
PYTHON_PASSING = """\
from {module} import {slave}, Boolean, {kind} as Number, {whole} as Whole
from {module} import {causality} as Causality, {variability} as Variability


class Passing({slave}):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        {clock}self.whole = self.whole_out = self.steps = self.true_steps = 0
        self.boolean = self.boolean_out = False
        self.register_variable(Whole("whole", causality=Causality.input, variability=Variability.discrete))
        self.register_variable(Boolean("boolean", causality=Causality.input, variability=Variability.discrete))
        for name in ("whole_out", "steps", "true_steps"):
            self.register_variable(Whole(name, causality=Causality.output, variability=Variability.discrete))
        self.register_variable(Boolean("boolean_out", causality=Causality.output, variability=Variability.discrete))

    def do_step(self, current_time, step_size):
        if abs(current_time - self.steps * step_size) > 1e-9:
            raise ValueError(f"step {{self.steps}} begins at {{current_time}} s")
        self.whole_out, self.boolean_out = self.whole, self.boolean
        self.steps += 1
        self.true_steps += self.boolean
        return {result}
"""


def reference_fmu(sources: Path, folder: Path, version: str) -> Path:
    """``Feedthrough`` of the Reference FMUs of the Modelica Association.

    :param sources: of https://github.com/modelica/Reference-FMUs.
    """
    number, model = version[0], sources / "Feedthrough"
    library = folder / "Feedthrough.so"
    files = [model / "model.c", *(sources / "src" / name for name in (f"fmi{number}Functions.c", "cosimulation.c"))]
    command = ["gcc", "-O2", "-fPIC", "-shared", f"-DFMI_VERSION={number}", "-DDISABLE_PREFIX"]
    command += [f"-I{sources / 'include'}", f"-I{model}", *map(str, files), "-o", str(library), "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    platform = fmpy.platform if version == "2.0" else fmpy.platform_tuple
    fmu = folder / f"Feedthrough{number}.fmu"
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.write(model / f"FMI{number}.xml", "modelDescription.xml")
        archive.write(library, f"binaries/{platform}/Feedthrough.so")
    return fmu
