"""Faults on telegrams, nodes and the bus: injected at a node's connection, on every transport by the same code."""
