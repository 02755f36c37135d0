"""Controllers that the user brings: code that gets readings in units once in a control period and answers commands.

The node around it is that of the system, with its guard, watch and handshake. Controllers outside it, which get frames,
are in :mod:`railhil.controller_node.foreign`.
"""
