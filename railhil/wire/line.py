"""Telegrams and enumerations of the system ``line`` that ``ato`` has not, made from ``dbc/line.toml``.

The others are in :mod:`railhil.wire.ato`.

Their fields are the raw integers on the wire; a field's name ends in its unit (``_ds``: 0.1 s, ``_4mmps``: 4 mm/s).
Declarations for type checkers are in ``line.pyi``, which ``setup.py`` writes.
"""

from importlib.resources import files
from pathlib import Path

from railhil.bus.made import telegrams_of
from railhil.dbc import own_ports, system_contract, wire_contract

_CONTRACT = system_contract(Path(str(files("railhil.dbc"))) / "line.toml")
globals().update(telegrams_of(own_ports(_CONTRACT, wire_contract()), __name__))
