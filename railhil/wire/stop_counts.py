"""The wire contract of the system ``stop``, and how many counts on the wire a unit of measure has."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from railhil.dbc import system_contract

TABLE = Path(str(files("railhil.dbc"))) / "stop.toml"
CONTRACT = system_contract(TABLE)
#: Samples of the speed in SPEED_RAW, and their spacing.
SAMPLES = 5
SAMPLE_S = 0.0032


def _counts(port: str, signal: str) -> float:
    return 1.0 / CONTRACT.port(port).signal(signal).scale


#: Counts per m, m/s and m/s2, and per second of a start instant.
MM = _counts("ODO", "OdoDistance")
START_PER_S = _counts("BRAKE_CMD", "CmdStart")
#: Counts in TRUTH per unit of measure.
TRUE_PER_UNIT = _counts("TRUTH", "TruePos")
#: Counts of a variance per m2.
VARIANCE_PER_M2 = _counts("ILC_STATUS", "MemoryVariance")
