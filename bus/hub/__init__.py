"""The hub: a software CAN switch in user space, for machines without a kernel CAN.

================= ======================================================================================
module            content
================= ======================================================================================
``address``       channel names, listening and connecting (AF_UNIX SEQPACKET, TCP on loopback)
``connection``    the client's end of a connection: whole packets, deadlines, exceptions
``hello``         how a client joins: its settings, connecting, the hello
``batches``       :class:`~railhil.bus.hub.batches.HubClient`, a client; ``link`` a node's connection over it
``client``        :class:`~railhil.bus.hub.client.HubBus`, the same as the python-can plugin ``railhil``
``ports``         the hub's end of a connection: never blocks, bounded queue
``gateway``       another python-can bus as a port; ``portspec`` its name, ``gateway_queues`` its queues
``membership``    who is connected, who has not said hello yet, which descriptors the loop watches
``switch``        the loop that carries packets from one port to all others
``wire_model``    optional bit rate and arbitration, length of a frame on the wire
``disturbances``  optional disturbances and the notices about them, for clients and hub
``disturbed_bus`` their effect on the traffic; ``cancontroller`` the model of a client for it
``server``        the hub process; ``cli`` its command line
================= ======================================================================================

The hub is reliable and gives every client the same total order. Bit rate, arbitration, error counters, bus-off and
redundant lines only when requested; :mod:`railhil.bus.transports` has the list.
"""
