"""How many parameters the nodes of a shell have, and what its drilling is worth.

The rotation of a six-parameter node about its director is tied to that of the mid-surface by an
energy ``½ γ c²`` (:mod:`fem_lie.elements.shell_drilling`). γ is no property of the shell: a smaller
one changes nothing but the drilling itself, a large one makes thin shells lock. The default lies
below the scale of bending, ``G t³/h²``. Where a single node takes a moment about the normal, γ of
the cells around it is ``G t``: a point has no drilling stiffness in a continuum, a patch of the
size of the cells has ``G t h²``.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum, auto

import numpy as np

from fem_lie._jit import Array, Indices

FRACTION = 0.01
"""γ over ``G t³/h²``; from 1 to 1e-8 nothing changes (docs/six_parameters.md)."""

_SHEAR, _TWIST = 2, 5  # of the eight strains


class Parameters(Enum):
    """Unknowns of the nodes of a shell.

    ``AUTOMATIC``: five, or six where something needs the sixth: a joint, link, prescribed motion or
    moment that takes hold of the rotation of a node, a kink or a branch. ``FIVE``: a place and a
    director. ``FIVE_CARRIED``: the same, and the frames are turned about their directors as the
    mid-surface turns, after each time step: nothing depends on it but how long a matrix can be
    kept. ``SIX``: whole frames.
    """

    AUTOMATIC = auto()
    FIVE = auto()
    FIVE_CARRIED = auto()
    SIX = auto()


def drilling_stiffness(
    stiffness: Array, areas: Array, cells: Indices, bound: Iterable[int]
) -> Array:
    """γ of each cell, force per length, shape (m,).

    Args:
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        areas: Of the cells, shape (m,).
        cells: Nodes of each cell, shape (m, k).
        bound: Nodes that take moments about their normals alone.
    """
    membrane = stiffness[:, _SHEAR, _SHEAR]
    soft = FRACTION * 12.0 * stiffness[:, _TWIST, _TWIST] / areas
    around = np.isin(cells, list(bound)).any(axis=1)
    return np.where(around, membrane, np.minimum(soft, membrane))
