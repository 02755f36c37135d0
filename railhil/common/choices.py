"""Allowed values of the options that say how a law is run; their order gives their codes in the handshake, so new ones
come last."""

from __future__ import annotations

ARITHMETICS = ("float64", "float32", "iq", "iq-portable", "float32-truncated")
#: What the set-points of a law are indexed by.
INDEXINGS = ("time", "distance")
PACES = ("lockstep", "realtime")
#: Which bus a run uses: chosen by python-can's options, its configuration and the machine, or none at all.
BUSES = ("auto", "local")
#: Scenario and law of a run that names none.
USUAL_SCENARIO, USUAL_LAW = "lvshun_tieshan", "ipfc"
