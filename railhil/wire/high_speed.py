"""Telegrams and enumerations of the system ``hst1``, made from ``dbc/hst1.toml``; the telegrams of ``emu3`` are in
:func:`railhil.wire.power_units.wire`.

Declarations for type checkers are in ``high_speed.pyi``, which ``setup.py`` writes.
"""

from importlib.resources import files
from pathlib import Path

from railhil.bus.made import telegrams_of
from railhil.dbc import own_ports, system_contract

globals().update(telegrams_of(own_ports(system_contract(Path(str(files("railhil.dbc"))) / "hst1.toml")), __name__))
