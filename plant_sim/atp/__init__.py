"""Train protection: supervises speed and position against braking curves, independent of the controller.

Modelled after the published structure of SUBSET-026-3, 3.13. It is no implementation of it, and no conformity is
claimed.
"""
