"""Faults: what a run injects, where, when and for how long, as text, as a table of a scenario file and as an object."""

from pathlib import Path

#: What errors name as the source of a fault given on the command line.
FAULT = Path("--fault")
