"""Faults: what a run injects, where, when and for how long, as text, as a table of a scenario file and as an object."""
