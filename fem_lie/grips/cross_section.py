"""A place on the axis of a beam of places and three slopes, with the frame of its section.

As :mod:`.surface`, where ``r_y`` and ``r_z`` are the derivatives along the surface: the frame's
second axis is along ``r_y``, the first is normal to the section, which is the normal there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind
from fem_lie.grips.surface import bend_surface, locate_surface


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    locate_surface(X, data, H, J)
    normal = H[3].copy()
    H[3] = H[2]
    H[2] = H[1]
    H[1] = normal
    for i in range(X.shape[0]):
        for part in range(0, 6, 3):
            normal_rows = J[i, part + 2].copy()
            J[i, part + 2] = J[i, part + 1]
            J[i, part + 1] = J[i, part]
            J[i, part] = normal_rows


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    given = np.empty(6)
    for part in range(0, 6, 3):
        given[part], given[part + 1], given[part + 2] = f[part + 1], f[part + 2], f[part]
    bend_surface(X, data, given, K)


ON_SECTION = GripKind(_locate, _bend, summed=True, turns=True)


def on_section(nodes: Sequence[int], shares: Array) -> Grip:
    """A place between nodes, those with places first.

    Args:
        nodes: SURFACE nodes, then as many CROSSING ones.
        shares: Of their two straight rows in the place, ``r_y`` and ``r_z``, shape (k, 2, 3).
    """
    return Grip(ON_SECTION, tuple(map(int, nodes)), tuple(map(float, shares.ravel())))
