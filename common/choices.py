"""Words that say how a law is run; their order is that of their codes in the handshake, so new ones come last."""

from __future__ import annotations

ARITHMETICS = ("float64", "float32", "iq", "iq-portable", "float32-truncated")
#: Over what the set-points of a law run.
INDEXINGS = ("time", "distance")
PACES = ("lockstep", "realtime")
#: Which bus a run takes: what python-can's options, its configuration and the machine say, or none at all.
BUSES = ("auto", "local")
