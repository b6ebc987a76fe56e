"""Overlap of polyhedra."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.contact.convex.manifold import set_manifolds
from fem_lie.contact.convex.table import PolyhedronPair, polyhedra_of, slots_of
from fem_lie.contact.sides.kinematics import set_gaps
from fem_lie.contact.sides.table import INACTIVE, Nodes, joined_sides


def overlap_of(pairs: Sequence[PolyhedronPair], nodes: Nodes, H: Array) -> tuple[float, float]:
    """The largest overlap of pairs, or 0, and the least size of the bodies in contact.

    Args:
        pairs: Pairs that may touch.
        nodes: Gives the numbers of the nodes of a body in the scene.
        H: Frames, shape (n, 4, 3).
    """
    polyhedra = polyhedra_of(pairs, nodes, None)
    slots = [slots_of(pair, nodes) for pair in pairs]
    a, b = (joined_sides(sides) for sides in zip(*slots, strict=True))
    count = len(a.radii)
    positions, kinds = np.repeat(np.arange(count), 2).reshape(-1, 2), np.full(count, INACTIVE)
    set_manifolds(H, polyhedra, positions, kinds, a, b, np.zeros((count, 3)))
    gaps = np.empty(count)
    set_gaps(H, a, b, positions, kinds, 0, gaps)
    sizes = np.append(polyhedra.centres.radii, a.radii[a.radii > 0.0])
    return max(0.0, -float(gaps.min())), float(sizes.min())
