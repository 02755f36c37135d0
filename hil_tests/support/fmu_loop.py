"""An exported law as an FMU in FMPy's loop, FMI 2.0 and 3.0."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave


class Loop:
    """An instance at the beginning of a run. ``inputs``, ``outputs``: names of its integers."""

    def __init__(self, fmu: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(fmu))
        variables = self.description.modelVariables
        self.references = {one.name: one.valueReference for one in variables}
        self.inputs = [one.name for one in variables if one.causality == "input"]
        self.outputs = [one.name for one in variables if one.causality == "output"]
        self.period_s = float(self.description.defaultExperiment.stepSize)
        self.slave = (FMU2Slave if self.second else FMU3Slave)(
            guid=self.description.guid, unzipDirectory=fmpy.extract(str(fmu), str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName="law",
        )  # fmt: skip
        self.slave.instantiate()
        if self.second:
            self.slave.setupExperiment(startTime=0.0)
            self.slave.enterInitializationMode()
            self._set, self._get = self.slave.setInteger, self.slave.getInteger
        else:
            self.slave.enterInitializationMode(startTime=0.0)
            self._set, self._get = self.slave.setInt32, self.slave.getInt32
        self.slave.exitInitializationMode()

    @property
    def second(self) -> bool:
        """Whether it is of FMI 2.0."""
        return bool(self.description.fmiVersion == "2.0")

    def set(self, values: Mapping[str, int]) -> None:
        self._set([self.references[name] for name in values], list(values.values()))

    def get(self) -> dict[str, int]:
        found = self._get([self.references[name] for name in self.outputs])
        return dict(zip(self.outputs, found, strict=True))


def members(fmu: Path) -> dict[str, tuple[str, str]]:
    """Variables of an FMU of FMI 3.0 that are raw integers of the bus: name -> port and signal, by its terminals."""
    with zipfile.ZipFile(fmu) as archive:
        root = ET.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    return {
        member.attrib["variableName"]: (terminal.attrib["name"], member.attrib["memberName"])
        for terminal in root.iter("Terminal")
        for member in terminal
    }
