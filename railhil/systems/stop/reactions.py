"""Where the fault catalogue of precise stopping is."""

from pathlib import Path

CATALOGUE = Path(__file__).with_name("catalogue.toml")
