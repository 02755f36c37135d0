"""Packed classic frames (:mod:`railhil.bus.hub.wire`) as columns. A module of its own: a hub has no use for numpy."""

from __future__ import annotations

from typing import Final

import numpy as np

#: ``struct can_frame``: identifier with its flags, length of the data in bytes, data with zeros behind.
PACKED: Final = np.dtype(
    {"names": ["can_id", "length", "data"], "formats": ["=u4", "u1", "(8,)u1"], "offsets": [0, 4, 8], "itemsize": 16}
)
