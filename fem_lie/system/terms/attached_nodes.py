"""Nodes of bodies as functions of their master nodes."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.forms.term import Pairs
from fem_lie.system.nodes.numbering import MasterMap, collect, expand, expand_twists


class AttachedNodes:
    """Nodes of bodies, each rigidly attached to its master node or a master node itself.

    Attributes:
        master: Master node of each, shape (k,).
        offset: Frame of each in that of its master node, shape (k, 4, 3).
        direct: Whether all are master nodes with consecutive numbers.
        where: Slice of the master nodes that they are then.
    """

    def __init__(self, where: slice, master_map: MasterMap) -> None:
        """Find the master nodes.

        Args:
            where: Slice of these nodes among all.
            master_map: Master node of each node.
        """
        self.master, self.offset = master_map.master[where], master_map.offset[where]
        numbers = np.arange(len(master_map.master))[where]
        self.direct = bool(np.isin(numbers, master_map.masters).all())
        if not self.direct:
            # Ad(C⁻¹): twist of a node from that of its master node
            self._turn = lie.se3_adjoint(lie.se3_inverse(self.offset))
        first = int(self.master[0]) if len(self.master) else 0
        self.where = slice(first, first + len(self.master))

    def frames(self, H: Array) -> Array:
        """Frames of these nodes, (k, 4, 3), from those of all master nodes."""
        if self.direct:
            return H[self.where]
        out = np.empty((len(self.master), 4, 3))
        expand(H, self.master, self.offset, out)
        return out

    def twists(self, v: Array) -> Array:
        """Twists of these nodes, (k, 6), from those of all master nodes."""
        if self.direct:
            return v[self.where]
        out = np.empty((len(self.master), 6))
        expand_twists(v, self.master, self.offset, out)
        return out

    def collect(self, forces: Array, out: Array) -> None:
        """Add forces on these nodes, (k, 6), to those on master nodes."""
        collect(forces, self.master, self.offset, out)

    def masters(self, pairs: Pairs) -> Pairs:
        """Master nodes of pairs of these nodes."""
        rows, columns = pairs
        return self.master[rows], self.master[columns]

    def blocks(self, blocks: Array, pairs: Pairs) -> Array:
        """Blocks of a matrix on these pairs in the twists of the master nodes."""
        if self.direct:
            return blocks
        r, c = pairs
        return np.asarray(self._turn[r].transpose(0, 2, 1) @ blocks @ self._turn[c])

    def rows(self, nodes: Indices, rows: Array) -> tuple[Indices, Array]:
        """Rows ``b`` (m, s, 6) on nodes (m, s), −1: none, transformed to master nodes."""
        if self.direct:
            return np.where(nodes >= 0, nodes + self.where.start, -1), rows
        turned = np.einsum("msk,mskl->msl", rows, self._turn[nodes])
        return np.where(nodes >= 0, self.master[nodes], -1), turned
