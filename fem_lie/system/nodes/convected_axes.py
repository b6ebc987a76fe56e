"""Convected axes of nodes, which follow their neighbourhood or the mid-surface.

The axes of a position node only define the components of its equations. If they rotate with the
neighbourhood, forces and matrices are invariant under rigid motion. The mean deformation around
node i is ``F_i = Σ_k x_k ⊗ b_ik`` with constants from the elements; the axes are the initial ones
rotated by its rotation, from the polar decomposition. Velocities and their rates are transformed
from the old axes to the new ones. Bodies whose nodal coordinates determine the axes define a
:data:`~fem_lie.bodies.model.AxesUpdate` for them.

Convected drilling: frames of five-parameter shells that rotate with the mid-surface. The rotation
of a frame about its director has no effect in such a shell; a frame that follows the rigid motion
leaves the matrix constant in local axes. With ``F = d_γ·x,β`` in the axes of the node's frame in
the unloaded state, the frame lags behind the polar rotation of the mid-surface by ``ψ = atan2(F₂₁ −
F₁₂, F₁₁ + F₂₂)``. F is the sum over the cells at a node.
"""

from __future__ import annotations

from math import atan2, cos, sin
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.model import AxesUpdate
from fem_lie.bodies.shells.shell import Shell
from fem_lie.lie.node_types import NodeType, Written, change_axes
from fem_lie.lie.polar import (
    PlainSurroundings,
    Surroundings,
    convect_axes,
    find_reference_axes,
    mean_deformations,
)
from fem_lie.mesh.shapes import nodes_of, tabulated
from fem_lie.ranks.shared_nodes import SharedNodes
from fem_lie.system.nodes.numbering import Numbering

_NO_MOTION, _NOTHING = np.empty((0, 0, 6)), np.empty(0, dtype=np.int64)


class ConvectedAxes:
    """Convected axes of position nodes.

    Attributes:
        plain: Data for compiled functions.
    """

    def __init__(
        self, numbering: Numbering, held: Flags, joined: Indices, shared: SharedNodes
    ) -> None:
        """Collect the neighbourhoods of nodes from the elements.

        Args:
            numbering: Numbering of the nodes.
            held: Unknowns of the master nodes that are zero, shape (n, 6); axes of supported
                positions stay as they are.
            joined: Master nodes with joints, whose axes belong to these.
            shared: Nodes whose neighbourhood is on several ranks.
        """
        master, count = numbering.master_map.master, numbering.count
        rows, columns = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
        factors: list[Array] = [np.empty((0, 3))]
        for where, assembly in numbering.assemblies:
            if assembly.around is not None:
                first, second = assembly.pairs
                rows.append(master[where.start + first])
                columns.append(master[where.start + second])
                factors.append(assembly.around)
        r = np.concatenate(rows)
        order = np.argsort(r, kind="stable")
        indptr: Indices = np.searchsorted(r[order], np.arange(count + 1))
        moves: Flags = (np.diff(indptr) > 0) & ~held[:, :3].any(axis=1)
        moves[joined[joined < count]] = False
        self.plain: PlainSurroundings = (
            *Surroundings(
                nodes=np.flatnonzero(moves),
                indptr=indptr.astype(np.int64),
                indices=np.concatenate(columns)[order],
                b=np.concatenate(factors)[order],
                axes=np.empty((count, 3, 3)),
                given=np.empty((count if shared.several else 0, 3, 3)),
            ),
        )
        self._shared, self._given = shared, self.plain[-1]
        self._any = shared.any(self.plain[0].size > 0)
        if self:
            self._sum(numbering.frames)
            find_reference_axes(numbering.frames, self.plain)

    def __bool__(self) -> bool:
        """Whether there are convected axes."""
        return self._any

    def _sum(self, H: Array) -> None:
        """Sum the mean deformations over all ranks."""
        if self._shared.several:
            mean_deformations(H, self.plain, self._given)
            self._shared.sum(self._given)

    def rotate(self, H: Array) -> None:
        """Rotate the axes in the first rows of ``H`` (≥ n, 4, 3)."""
        self._sum(H)
        convect_axes(H, self.plain, _NO_MOTION, _NOTHING)

    def rotate_motion(self, H: Array, motion: Array, kinds: Indices, written: Written) -> None:
        """Rotate the axes, and transform the components of motions.

        Args:
            H: Frames, shape (≥ n, 4, 3).
            motion: Velocities, accelerations and so on, shape (k, n, 6).
            kinds: Type of each node, shape (n,).
            written: Representation of ``motion``; velocities of the nodes' groups have global
                components.
        """
        self._sum(H)
        convect_axes(H, self.plain, motion, np.flatnonzero(written.local))


class _Part(NamedTuple):
    """A body with convected axes.

    Attributes:
        nodes: Master nodes of its nodes, (k,).
        follower: Function that rotates the axes.
        led: Positions in ``nodes`` of nodes that are attached to another node.
        offset: Frames of these in those of their master nodes.
        kept: Whether a master node keeps its axes, (k,).
    """

    nodes: Indices
    follower: AxesUpdate
    led: Indices
    offset: Array
    kept: Flags

    def followed(self, before: Array) -> Array:
        """Frames of the master nodes, ``before`` (k, 4, 3), with rotated axes."""
        found = before.copy()
        if len(self.led):
            found[self.led] = lie.se3_compose(before[self.led], self.offset)
        self.follower(found)
        found[self.kept] = before[self.kept]
        return found


class BodyAxes:
    """Convected axes that bodies define."""

    def __init__(self, numbering: Numbering, joined: Indices) -> None:
        """Collect the bodies.

        Args:
            numbering: Numbering of the nodes.
            joined: Master nodes with joints, which refer to the axes of their nodes.
        """
        master_map = numbering.master_map
        self._parts: list[_Part] = []
        for body, nodes in numbering.nodes.items():
            follower = body.model.axes_update()
            if follower is not None:
                master = master_map.master[nodes]
                led = master_map.masters[master] != nodes
                seen = np.isin(
                    body.model.node_types, (NodeType.POSITION_GRADIENT, NodeType.POSITION)
                )
                kept = led | (seen & np.isin(master, joined))
                offset = master_map.offset[nodes[led]]
                self._parts.append(_Part(master, follower, np.flatnonzero(led), offset, kept))

    def __bool__(self) -> bool:
        """Whether there are convected axes."""
        return bool(self._parts)

    def rotate(self, H: Array) -> None:
        """Rotate the axes in the first rows of ``H`` (≥ n, 4, 3)."""
        for part in self._parts:
            H[part.nodes] = part.followed(H[part.nodes])

    def rotate_motion(self, H: Array, motion: Array, kinds: Indices, written: Written) -> None:
        """Rotate the axes and transform components of motions, as :class:`ConvectedAxes` does."""
        for part in self._parts:
            before = H[part.nodes]
            after = part.followed(before)
            change_axes(kinds, part.nodes, before, after, written, motion)
            H[part.nodes] = after


@compiled
def _add_up(H: Array, cells: Indices, slopes: Array, sums: Array) -> None:
    """Add ``F₂₁ − F₁₂`` and ``F₁₁ + F₂₂`` of each node, shape (n, 2)."""
    gradient = np.empty((2, 3))
    for e in range(cells.shape[0]):
        for i in range(cells.shape[1]):
            node = cells[e, i]
            gradient[:] = 0.0
            for b in range(2):
                for k in range(cells.shape[1]):
                    for j in range(3):
                        gradient[b, j] += slopes[e, i, b, k] * H[cells[e, k], 0, j]
            d1, d2 = H[node, 1], H[node, 2]
            sums[node, 0] += np.dot(d2, gradient[0]) - np.dot(d1, gradient[1])
            sums[node, 1] += np.dot(d1, gradient[0]) + np.dot(d2, gradient[1])


@compiled
def _lag(sums: Array, moves: Flags, lag: Array) -> None:
    """Lag ψ of each node, shape (n,)."""
    for i in range(lag.shape[0]):
        lag[i] = atan2(sums[i, 0], sums[i, 1]) if moves[i] else 0.0


@compiled
def _turn_rows(a: Array, at: int, c: float, s: float) -> None:
    """Components ``at`` and ``at + 1`` in axes rotated about the third."""
    first = c * a[at] + s * a[at + 1]
    a[at + 1] = c * a[at + 1] - s * a[at]
    a[at] = first


@compiled
def _turn_frames(H: Array, lag: Array) -> None:
    for i in range(lag.shape[0]):
        if lag[i] != 0.0:
            c, s = cos(lag[i]), sin(lag[i])
            for j in range(3):
                _turn_rows(H[i, :, j], 1, c, s)


@compiled
def _turn_motion(motion: Array, kinds: Indices, local: Flags, lag: Array) -> None:
    for i in range(lag.shape[0]):
        if lag[i] != 0.0:
            c, s = cos(lag[i]), sin(lag[i])
            for k in range(motion.shape[0]):
                _turn_rows(motion[k, i], 3, c, s)
                # velocities of the group R³×SO(3) have global components
                if local[k] or not kinds[i] & 1:
                    _turn_rows(motion[k, i], 0, c, s)


class ConvectedDrilling:
    """Frames of five-parameter shells that rotate about their directors with the mid-surface."""

    def __init__(
        self, numbering: Numbering, held: Flags, joined: Indices, shared: SharedNodes
    ) -> None:
        """Store the derivatives of shape functions of the unloaded cells.

        Args:
            numbering: Numbering of the nodes.
            held: Unknowns of the master nodes that are zero, shape (n, 6); frames with a held
                rotation stay as they are.
            joined: Master nodes with joints, whose axes belong to these.
            shared: Nodes whose cells are on several ranks.
        """
        chosen = [
            body
            for body in numbering.nodes
            if isinstance(body, Shell) and body.model.convected_axes
        ]
        master = numbering.master_map.master
        self._parts = [
            (master[numbering.nodes[body][body.model.connectivity]], _slopes(body))
            for body in chosen
        ]
        self._lag, self._sums = np.zeros(numbering.count), np.zeros((numbering.count, 2))
        self._shared, self._any = shared, shared.any(bool(chosen))
        self._moves: Flags = np.zeros(numbering.count, dtype=bool)
        for cells, _ in self._parts:
            self._moves[cells] = True
        self._moves &= ~held[:, 3:5].any(axis=1)
        self._moves[joined[joined < numbering.count]] = False

    def __bool__(self) -> bool:
        """Whether there are convected frames."""
        return self._any

    def _find_lag(self, H: Array) -> None:
        """Find how far the frames lag behind the mid-surface."""
        self._sums[:] = 0.0
        for cells, slopes in self._parts:
            _add_up(H, cells, slopes, self._sums)
        self._shared.sum(self._sums)
        _lag(self._sums, self._moves, self._lag)

    def rotate(self, H: Array) -> None:
        """Rotate the frames in the first rows of ``H`` (≥ n, 4, 3)."""
        self._find_lag(H)
        _turn_frames(H, self._lag)

    def rotate_motion(self, H: Array, motion: Array, kinds: Indices, written: Written) -> None:
        """Rotate the frames, and transform the components of motions.

        Args:
            H: Frames, shape (≥ n, 4, 3).
            motion: Velocities, accelerations and so on, shape (k, n, 6).
            kinds: Group of each node, shape (n,).
            written: Representation of ``motion``.
        """
        self._find_lag(H)
        _turn_frames(H, self._lag)
        _turn_motion(motion, kinds, written.local, self._lag)


def _slopes(body: Shell) -> Array:
    """Derivatives of the shape functions at the nodes of a cell in their frames, (m, k, 2, k)."""
    cell, degree = body.model.mesh.cell, body.model.mesh.degree
    table = tabulated(cell, degree, nodes_of(cell, degree))[1:]
    x, frames = body.frames[body.model.connectivity, 0], body.frames[body.model.connectivity]
    tangents = np.einsum("aik,mkj->miaj", table, x)
    jacobian = np.einsum("miaj,mibj->miab", tangents, frames[:, :, 1:3])
    return np.asarray(np.einsum("miba,aik->mibk", np.linalg.inv(jacobian), table))
