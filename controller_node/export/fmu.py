"""The exported law as an FMI 2.0 co-simulation FMU: its C with a frame around it, compiled for this machine."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree as ET

from railhil.common.errors import InputError, Words
from railhil.common.extras import missing
from railhil.controller_node.export.bundle import Bundle, control_of
from railhil.controller_node.export.templates import template
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Input that says whether other commands were sent than the law's.
OTHER_SENT = "other_sent"
#: Value reference of the first word of the result, as in railhil_fmi2.c.
_RESULT = 1000
_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")
_FLAGS = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-fwrapv", "-fPIC", "-shared")
#: Time of all entries of the archive, so that two exports have the same bytes.
_NO_TIME = (1980, 1, 1, 0, 0, 0)


def write_fmu(bundle: Bundle, scenario: AnyScenario, law: LawSpec, path: Path) -> None:
    """Write the FMU of an export, with its sources and a binary for this platform.

    Inputs and outputs are the integers of the C functions; the number of the control period comes from the time.

    :raises InputError: FMPy, whose copy of the standard's headers is used, or a C compiler is missing, or the file
        cannot be written.
    """
    try:
        import fmpy
    except ImportError as error:
        raise missing("railhil export-c --fmu", error, "fmi") from None
    control = control_of(scenario, law)
    name = bundle.source.name
    inputs = [word.column for word in control.record if word.column != control.period_word]
    inputs.append(OTHER_SENT)
    places = {column: f"input[{at}]" for at, column in enumerate(inputs)} | {control.period_word: "k"}
    guid = "{" + hashlib.sha256("".join(bundle.files.values()).encode()).hexdigest()[:32] + "}"
    frame = template(
        "railhil_fmi2.c",
        name,
        INPUTS=str(len(inputs)),
        OTHER_SENT=str(len(inputs) - 1),
        GUID=guid,
        GIVEN=", ".join(places[word.column] for word in control.given),
        TOLD=", ".join(places[word.column] for word in control.told),
    )
    headers = Path(fmpy.__file__).parent / "c-code"
    sources = {
        f"{name}.c": bundle.files[f"{name}.c"],
        f"{name}.h": bundle.files[f"{name}.h"],
        "railhil_iq.h": bundle.files["railhil_iq.h"],
        "railhil_fmi2.c": frame,
        **{header: (headers / header).read_text(encoding="utf-8") for header in _HEADERS},
    }
    period_s = scenario.timing.control_period_ns / 1e9
    described = _description(name, guid, inputs, bundle.source.columns, period_s)
    library = _compiled(name, sources)
    try:
        with zipfile.ZipFile(path, "w") as archive:
            for entry, content in (
                ("modelDescription.xml", described),
                *((f"sources/{file}", text.encode()) for file, text in sources.items()),
                (f"binaries/{fmpy.platform}/{name}{fmpy.sharedLibraryExtension}", library),
            ):
                archive.writestr(zipfile.ZipInfo(entry, _NO_TIME), content, zipfile.ZIP_DEFLATED)
    except OSError as error:
        raise InputError(path, "", Words(error.strerror or str(error)), "a file that can be written") from error


def _compiled(name: str, sources: Mapping[str, str]) -> bytes:
    """The shared library of the sources, by the compiler in ``CC``, else gcc, else cc."""
    compiler = os.environ.get("CC") or shutil.which("gcc") or shutil.which("cc")
    if not compiler:
        raise InputError("railhil export-c", "--fmu", Words("no C compiler"), "gcc, cc, or one in CC")
    with tempfile.TemporaryDirectory(prefix="railhil-fmu-") as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text, encoding="utf-8")
        # Names without a folder, so that none gets into the library.
        command = [compiler, *_FLAGS, "-o", f"{name}.lib", f"{name}.c", "railhil_fmi2.c", "-lm"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        except OSError as error:
            raise InputError("environment", "CC", compiler, f"a C compiler ({error.strerror})") from None
        if done.returncode:
            said = Words(done.stderr.strip().partition("\n")[0] or f"exit code {done.returncode}")
            raise InputError("railhil export-c --fmu", compiler, said, "a C99 compiler that accepts the export")
        return Path(folder, f"{name}.lib").read_bytes()


def _description(name: str, guid: str, inputs: list[str], columns: tuple[str, ...], period_s: float) -> bytes:
    """``modelDescription.xml``."""
    root = ET.Element(
        "fmiModelDescription", fmiVersion="2.0", modelName=name, guid=guid, numberOfEventIndicators="0",
        generationTool=f"railhil {version('railhil')}", variableNamingConvention="structured",
    )  # fmt: skip
    simulation = ET.SubElement(
        root, "CoSimulation", modelIdentifier=name, canHandleVariableCommunicationStepSize="true"
    )
    files = ET.SubElement(simulation, "SourceFiles")
    for file in (f"{name}.c", "railhil_fmi2.c"):
        ET.SubElement(files, "File", name=file)
    ET.SubElement(root, "DefaultExperiment", startTime="0", stepSize=f"{period_s:g}")
    variables = ET.SubElement(root, "ModelVariables")
    for at, column in enumerate(inputs):
        given = {"name": column, "valueReference": str(at), "causality": "input", "variability": "discrete"}
        ET.SubElement(ET.SubElement(variables, "ScalarVariable", given), "Integer", start="0")
    told = [(at, column) for at, column in enumerate(columns) if column.startswith(("out.", "events."))]
    for at, column in told:
        found = {"name": column, "valueReference": str(_RESULT + at), "causality": "output", "variability": "discrete"}
        ET.SubElement(ET.SubElement(variables, "ScalarVariable", found | {"initial": "exact"}), "Integer", start="0")
    outputs = ET.SubElement(ET.SubElement(root, "ModelStructure"), "Outputs")
    for index in range(len(inputs) + 1, len(inputs) + len(told) + 1):
        ET.SubElement(outputs, "Unknown", index=str(index))
    ET.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root) + b"\n"
