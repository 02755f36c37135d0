"""The exported law as a co-simulation FMU (FMI 2.0 or 3.0): its C with a frame around it, compiled for this machine."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from railhil.common.errors import InputError, Words, describe_os_error
from railhil.common.version import full_version
from railhil.controller_node.export.bundle import Bundle
from railhil.controller_node.export.fmu_law import INTEGERS, FmuLaw, Variable, law_of
from railhil.controller_node.export.text import template
from railhil.fmu.instance import fmpy_for
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Versions of FMI, the first is the default; each with the standard's headers.
_HEADERS = {
    "2.0": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "3.0": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
#: Options that the sources need of a compiler.
_OPTIONS = "-std=c99 -O2 -fwrapv -ffp-contract=off"
#: The parameters of the frame's functions are the standard's, used or not.
_FLAGS = (*_OPTIONS.split(), "-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror", "-fPIC", "-fvisibility=hidden")
#: Time of all entries of the archive, so that two exports have the same bytes.
_NO_TIME = (1980, 1, 1, 0, 0, 0)


def write_fmu(bundle: Bundle, scenario: AnyScenario, law: LawSpec, path: Path, fmi: str = "2.0") -> None:
    """Write the FMU of an export, with its sources and a binary for this platform.

    Inputs and outputs are the integers of the C functions; the number of the control period comes from the time.

    :param fmi: version, "2.0" or "3.0".
    :raises InputError: FMPy, whose copy of the standard's headers is used, or a C compiler is missing, or the file
        cannot be written.
    """
    fmpy = fmpy_for("railhil export-c --fmu")
    digest = hashlib.sha256("".join((fmi, *bundle.files.values())).encode())
    token = "{" + digest.hexdigest()[:32] + "}"
    inside = law_of(bundle, scenario, law, token)
    name = inside.name
    frame = f"railhil_fmi{fmi[0]}.c"
    sources = {
        **inside.files,
        frame: template(frame, name, **INTEGERS),
        **standard_headers(fmpy, fmi),
    }
    compiled = (f"{name}.c", "railhil_fmu.c", frame)
    library = _compiled(name, sources, compiled)
    platform = fmpy.platform if fmi == "2.0" else fmpy.platform_tuple
    entries = {
        "modelDescription.xml": description(inside, fmi, compiled),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
        f"binaries/{platform}/{name}{fmpy.sharedLibraryExtension}": library,
    }
    if fmi == "3.0":
        entries["sources/buildDescription.xml"] = build_description(inside, compiled, _OPTIONS)
        entries["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(inside)
    try:
        with zipfile.ZipFile(path, "w") as archive:
            for entry, content in entries.items():
                archive.writestr(zipfile.ZipInfo(entry, _NO_TIME), content, zipfile.ZIP_DEFLATED)
    except OSError as error:
        why = Words(f"cannot be written: {describe_os_error(error)}")
        raise InputError(path, "", why, "a file that can be written") from error


def standard_headers(fmpy: Any, fmi: str) -> dict[str, str]:
    """The headers of a version of FMI by name, from FMPy's copy."""
    headers = Path(fmpy.__file__).parent / "c-code"
    return {header: (headers / header).read_text(encoding="utf-8") for header in _HEADERS[fmi]}


def _compiled(name: str, sources: Mapping[str, str], compiled: tuple[str, ...]) -> bytes:
    """The shared library of the sources, by the compiler in ``CC``, else gcc, else cc."""
    compiler = os.environ.get("CC") or shutil.which("gcc") or shutil.which("cc")
    if not compiler:
        raise InputError("railhil export-c", "--fmu", Words("no C compiler"), "gcc, cc, or one in CC")
    with tempfile.TemporaryDirectory(prefix="railhil-fmu-") as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text, encoding="utf-8")
        # Names without a folder, so that none gets into the library.
        command = [compiler, *_FLAGS, "-shared", "-o", f"{name}.lib", *compiled, "-lm"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        except OSError as error:
            raise InputError("environment", "CC", compiler, f"a C compiler ({describe_os_error(error)})") from None
        if done.returncode:
            said = Words(done.stderr.strip().partition("\n")[0] or f"exit code {done.returncode}")
            raise InputError("railhil export-c --fmu", compiler, said, "a C99 compiler that accepts the export")
        return Path(folder, f"{name}.lib").read_bytes()


#: Value references of the time and of the first word of the result, as in railhil_fmu.h.
_TIME, _RESULT = 999, 1000
_STEP_SIZE = "canHandleVariableCommunicationStepSize"


def description(law: FmuLaw, fmi: str, sources: tuple[str, ...]) -> bytes:
    """``modelDescription.xml``.

    Integers have no units in either version: the description of each gives the value of 1.

    :param fmi: "2.0" or "3.0".
    :param sources: the C files in it, none: only the binary is.
    """
    second = fmi == "2.0"
    token = "guid" if second else "instantiationToken"
    root = ET.Element(
        "fmiModelDescription", {"fmiVersion": fmi, "modelName": law.name, token: law.token},
        generationTool=f"railhil {full_version()}", variableNamingConvention="structured",
    )  # fmt: skip
    state = "FMUstate" if second else "FMUState"
    simulation = {"modelIdentifier": law.name, _STEP_SIZE: "true"}
    if law.keeps_state:
        simulation |= {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    else:
        simulation["canBeInstantiatedOnlyOncePerProcess"] = "true"
    if second:
        root.set("numberOfEventIndicators", "0")
        kind = ET.SubElement(root, "CoSimulation", simulation)
        if sources:
            files = ET.SubElement(kind, "SourceFiles")
            for file in sources:
                ET.SubElement(files, "File", name=file)
        names = sorted({one.unit for one in (*law.inputs, *law.outputs) if one.unit})
        if names:
            units = ET.SubElement(root, "UnitDefinitions")
            for unit in names:
                ET.SubElement(units, "Unit", name=unit)
    else:
        ET.SubElement(root, "CoSimulation", simulation)
        ET.SubElement(ET.SubElement(ET.SubElement(root, "UnitDefinitions"), "Unit", name="s"), "BaseUnit", s="1")
    ET.SubElement(root, "DefaultExperiment", startTime="0", stepSize=f"{law.period_ns / 1e9:g}")
    variables = ET.SubElement(root, "ModelVariables")
    if not second:
        time = {"name": "time", "valueReference": str(_TIME), "causality": "independent", "variability": "continuous"}
        ET.SubElement(variables, "Float64", time, unit="s")
    for one in law.inputs:
        _variable(variables, one, second, one.place, "input")
    for one in law.outputs:
        _variable(variables, one, second, _RESULT + one.place, "output")
    structure = ET.SubElement(root, "ModelStructure")
    if second:
        outputs = ET.SubElement(structure, "Outputs")
        for index in range(len(law.inputs) + 1, len(law.inputs) + len(law.outputs) + 1):
            ET.SubElement(outputs, "Unknown", index=str(index))
    else:
        for one in law.outputs:
            ET.SubElement(structure, "Output", valueReference=str(_RESULT + one.place))
    return _text(root)


def _variable(parent: ET.Element, one: Variable, second: bool, reference: int, causality: str) -> None:
    attributes = {"name": one.name, "valueReference": str(reference), "causality": causality, "variability": "discrete"}
    if one.wire.words:
        attributes["description"] = one.wire.words
    if causality == "output":
        attributes["initial"] = "exact"
    values = {"start": "0"}
    if one.limits is not None:
        values |= {"min": str(one.limits[0]), "max": str(one.limits[1])}
    if one.unit:
        values["unit"] = one.unit
    if second:
        kind = "Integer" if one.unit is None else "Real"
        ET.SubElement(ET.SubElement(parent, "ScalarVariable", attributes), kind, values)
    else:
        ET.SubElement(parent, "Int32", attributes | values)


def terminals(law: FmuLaw) -> bytes:
    """``terminalsAndIcons.xml`` of FMI 3.0: a terminal for each telegram, with the variables that are its signals."""
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    found: dict[str, ET.Element] = {}
    parent = ET.SubElement(root, "Terminals")
    for one in (*law.inputs, *law.outputs):
        port, signal = one.wire.port, one.wire.signal
        if signal is None:
            continue
        if port not in found:
            found[port] = ET.SubElement(
                parent, "Terminal", name=port, matchingRule="plug", terminalKind="railhil.telegram"
            )
        ET.SubElement(
            found[port], "TerminalMemberVariable", variableName=one.name, memberName=signal.name, variableKind="signal"
        )
    if not found:
        root.remove(parent)
    return _text(root)


def build_description(law: FmuLaw, sources: tuple[str, ...], options: str) -> bytes:
    """``buildDescription.xml`` of FMI 3.0: how the sources are compiled."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=law.name)
    files = ET.SubElement(configuration, "SourceFileSet", language="C99", compiler="gcc", compilerOptions=options)
    for file in sources:
        ET.SubElement(files, "SourceFile", name=file)
    ET.SubElement(configuration, "Library", name="m", external="true")
    return _text(root)


def _text(root: ET.Element) -> bytes:
    ET.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root) + b"\n"
