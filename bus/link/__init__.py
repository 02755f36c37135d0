"""A node's connection to the bus: frames out, frames in, over any python-can interface.

The same node code runs on the hub, on SocketCAN and on a serial adapter; :func:`open_link` chooses the matching link
by the table of :mod:`railhil.bus.transports`.

================= ============================= ==============================================================
interface         link                          an interface that fails
================= ============================= ==============================================================
the hub           :mod:`railhil.bus.hub.link`     ends the node: the run is gone with it
``socketcan``     :mod:`railhil.bus.link.kernel`  is waited for (:mod:`railhil.bus.link.base`) and opened again
``slcan``         :mod:`railhil.bus.link.slcan`   is waited for and opened again
``udp_multicast`` :mod:`railhil.bus.link.single`  is waited for and opened again; own frames are kept from the node
any other         :mod:`railhil.bus.link.single`  is waited for and opened again
================= ============================= ==============================================================
"""

from railhil.bus.link.base import Endpoint, Link, Timeouts
from railhil.bus.link.opening import open_link

__all__ = ["Endpoint", "Link", "Timeouts", "open_link"]
