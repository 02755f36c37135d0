"""Suites of users, run by pytest with railhil's plugin."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from hil_tests.support.warm import run_module

#: The plugin by name, for an environment whose installation is older than its entry point.
PLUGIN = () if entry_points(group="pytest11", name="railhil") else ("-p", "railhil.pytest_plugin")
#: Words of every command line: nothing of the surrounding session is used.
WORDS = (*PLUGIN, "-p", "no:cacheprovider")


def run_suite(folder: Path, *words: str) -> pytest.RunResult:
    """pytest in a folder, in a process of its own: what it loads and unloads must not be that of the tests."""
    hidden = ("PYTEST_", "COLUMNS")
    environment = {name: value for name, value in os.environ.items() if not name.startswith(hidden)}
    environment["PYTEST_DEBUG_TEMPROOT"] = str(folder.parent)
    done = run_module("pytest", [*WORDS, *words], environment=environment, cwd=folder)
    return pytest.RunResult(done.returncode, done.stdout.splitlines(), done.stderr.splitlines(), 0.0)


def properties(junit: Path) -> Mapping[str, list[tuple[str, str]]]:
    """Properties of each test of a JUnit report, by the test's name."""
    cases = ET.parse(junit).iter("testcase")
    return {
        case.attrib["name"]: [(one.attrib["name"], one.attrib["value"]) for one in case.iter("property")]
        for case in cases
    }
