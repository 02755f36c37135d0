"""Frames drawn by hypothesis."""

from __future__ import annotations

from hypothesis import strategies as st

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    """Every kind of frame that can occur on a CAN bus."""
    extended = draw(st.sampled_from([0, EXTENDED]))
    can_id = draw(st.integers(0, 0x1FFFFFFF if extended else 0x7FF))
    kind = draw(st.sampled_from([0, 0, REMOTE, ERROR, FD, FD | BRS]))
    if kind == REMOTE:
        return Frame(can_id, bytes(draw(st.integers(0, 8))), extended | kind)
    length = draw(st.sampled_from([*range(9), 12, 16, 20, 24, 32, 48, 64])) if kind & FD else draw(st.integers(0, 8))
    return Frame(can_id, draw(st.binary(min_size=length, max_size=length)), extended | kind)
