"""Telegrams and enumerations of the bench itself, made from ``dbc/house.toml``: clock, orders, milestones, handshake.

Their fields are the raw integers on the wire. ``help(TimeSync)`` shows a layout. Declarations for type checkers are in
``telegrams.pyi``, which ``setup.py`` writes.
"""

from railhil.bus.made import telegrams_of
from railhil.dbc import house_contract

globals().update(telegrams_of(house_contract().ports, __name__))
