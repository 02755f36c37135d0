"""Suites of users, run by pytest with railhil's plugin."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path

#: The plugin by name, for an environment whose installation is older than its entry point.
PLUGIN = () if entry_points(group="pytest11", name="railhil") else ("-p", "railhil.pytest_plugin")
#: Words of every command line: nothing of the surrounding session is used.
WORDS = (*PLUGIN, "-p", "no:cacheprovider")


def properties(junit: Path) -> Mapping[str, list[tuple[str, str]]]:
    """Properties of each test of a JUnit report, by the test's name."""
    cases = ET.parse(junit).iter("testcase")
    return {
        case.attrib["name"]: [(one.attrib["name"], one.attrib["value"]) for one in case.iter("property")]
        for case in cases
    }
