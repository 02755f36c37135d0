"""Where the fault catalogue of the systems of high-speed trains is."""

from pathlib import Path

CATALOGUE = Path(__file__).with_name("catalogue.toml")
