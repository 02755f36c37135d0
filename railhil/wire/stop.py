"""Telegrams and enumerations of the system ``stop``, made from ``dbc/stop.toml``; declarations for type checkers are in
``stop.pyi``, which ``setup.py`` writes.

Lengths are in mm, speeds in mm/s, accelerations in mm/s2 (braking negative), times in 0.1 ms, unless the table says
otherwise.
"""

from railhil.bus.made import telegrams_of
from railhil.dbc import own_ports
from railhil.wire.stop_counts import CONTRACT

globals().update(telegrams_of(own_ports(CONTRACT), __name__))
