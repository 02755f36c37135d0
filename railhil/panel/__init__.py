"""The live panel: a page on loopback that shows a run while it is made, or a recorded one.

A process of its own that only listens on the bus, never in plant or controller; orders of the operator go to the
supervisor (:mod:`railhil.record.operator_commands`), which sends them with SUP_CMD.
"""
