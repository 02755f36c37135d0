"""Telegrams and enumerations of the system ``ato``, made from ``dbc/ports.toml``.

Their fields are the raw integers on the wire; a field's name ends in its unit (``_01mm``: 0.1 mm, ``_256th``: 1/256).
``help(TrnSpeed)`` shows a layout. Declarations for type checkers are in ``ato.pyi``, which ``setup.py`` writes.
"""

from railhil.bus.made import telegrams_of
from railhil.dbc import own_ports, wire_contract

globals().update(telegrams_of(own_ports(wire_contract()), __name__))
