"""Products whose sums are carried in extended precision, where the machine has one.

Stiff elements cancel in ``K φ`` of slow motions: of sums in double precision, round-off is left.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._arrays import Array

Extended = npt.NDArray[np.longdouble]


def product(A: sp.csr_matrix, vectors: Array | Extended) -> Extended:
    """``A φ`` of real rows ``φ``, shape (k, n)."""
    wide = vectors.T.astype(np.longdouble)
    return np.asarray((A.astype(np.longdouble) @ wide).T, dtype=np.longdouble)
