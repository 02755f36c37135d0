"""Fixed point of the TMS320F28335 after TI's IQmath: int32, two's complement, value = raw / 2^Q, Q 1 to 30.

There are two profiles, which are never mixed: ``iq`` is the library of the C28x (:class:`C28`), ``iq-portable`` is TI's
open C library (:class:`Portable`); they agree on products, sums and shifts and differ in division, roots, integer parts
and functions. Each exists for one train (plain ``int``) and for N (int64 arrays) with equal results. All count wraps,
saturations and divisions by zero.
"""

from railhil.controller_node.arithmetic.iq.c28 import C28, C28Batch
from railhil.controller_node.arithmetic.iq.portable import Portable, PortableBatch

__all__ = ["C28", "C28Batch", "Portable", "PortableBatch"]
