"""The hub: a software CAN switch in user space, for machines without a kernel CAN.

============ ==================================================================================
module       content
============ ==================================================================================
``wire``     the packet format (SocketCAN frame structs in batches, JSON hello)
``address``  channel names, listening and connecting (AF_UNIX SEQPACKET, TCP on loopback)
``link``     the client's end of a connection: whole packets, deadlines
``batches``  :class:`~railhil.bus.hub.batches.HubClient`, a client; ``failures`` what it raises
``client``   :class:`~railhil.bus.hub.client.HubBus`, the same as the python-can plugin ``railhil``
``joining``  how a client connects and says hello
``ports``    the hub's end of a connection: never blocks, bounded queue
``gateway``  another python-can bus as a port; ``portspec`` its name, ``backlog`` frames waiting for it
``guests``   clients that have not said hello yet
``membership`` who is connected, and which descriptors the loop watches
``switch``   the loop that carries packets from one port to all others
``bitlength`` length of a frame on the wire, stuff bits counted
``model``    optional bit rate and arbitration
``orders``   optional disturbances and the notices about them, for clients and hub
``disturbance`` their effect on the traffic; ``cancontroller``, ``lines`` the models of a client for it
``server``   the hub process; ``cli`` its command line
============ ==================================================================================

The hub is reliable and gives every client the same total order. Bit rate, arbitration, error counters, bus-off and
redundant lines only when requested; :mod:`railhil.bus.transports` has the list.
"""
