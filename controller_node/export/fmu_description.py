"""The XML files of the FMU of a law, for FMI 2.0 and 3.0."""

from __future__ import annotations

from importlib.metadata import version
from xml.etree import ElementTree as ET

from railhil.controller_node.export.fmu_law import FmuLaw, Variable

#: Value references of the time and of the first word of the result, as in railhil_fmu.h.
_TIME, _RESULT = 999, 1000
_STEP_SIZE = "canHandleVariableCommunicationStepSize"


def description(law: FmuLaw, fmi: str, sources: tuple[str, ...]) -> bytes:
    """``modelDescription.xml``.

    Integers have no units in either version: the description of each says what 1 is.

    :param fmi: "2.0" or "3.0".
    :param sources: the C files.
    """
    second = fmi == "2.0"
    token = "guid" if second else "instantiationToken"
    root = ET.Element(
        "fmiModelDescription", {"fmiVersion": fmi, "modelName": law.name, token: law.token},
        generationTool=f"railhil {version('railhil')}", variableNamingConvention="structured",
    )  # fmt: skip
    state = "FMUstate" if second else "FMUState"
    simulation = {
        "modelIdentifier": law.name, _STEP_SIZE: "true", f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"
    }  # fmt: skip
    if second:
        root.set("numberOfEventIndicators", "0")
        files = ET.SubElement(ET.SubElement(root, "CoSimulation", simulation), "SourceFiles")
        for file in sources:
            ET.SubElement(files, "File", name=file)
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
    if second:
        ET.SubElement(ET.SubElement(parent, "ScalarVariable", attributes), "Integer", values)
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
