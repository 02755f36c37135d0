"""Notes in CTL_STAT of the laws on the core of ``pfc``."""

from __future__ import annotations

from railhil.controller_node.laws.note import Note, flags

#: Softening factor, 0..1.
SOFTENING_Q = 30
#: Fuzzy satisfaction, 0..1.
SATISFACTION_Q = 24

#: Bits of the basis functions in use.
BASIS_STEP = 1
BASIS_WAVELET = 2
BASIS_RAMP = 4

BASIS_NOTE = flags("basis_in_use", "basis functions", ("step", "wavelet", "ramp"))
#: Alpha of eq. (27).
SOFTENING_NOTE = Note("softening_factor", "softening factor", SOFTENING_Q, symbol="α")
#: Mu of eq. (26).
SATISFACTION_NOTE = Note("satisfaction", "satisfaction", SATISFACTION_Q, symbol="μ")
