"""Layers along the edges of plates and shells, as wide as these are thick, that no cell shows.

Where no couple about its normal acts on an edge, the twisting moment ``M_ντ`` vanishes there; in a
thin shell it does so within a layer of the width ``λ = √(B/S)``, with the stiffnesses B of twist
and S of shear, t/√10 if it is homogeneous: ``M = m exp(−x/λ)`` and ``Q = M′``. Cells that are wider
than that end with some ``M_ντ = m`` instead. What they miss is, per length of the edge::

    ∫ M²/B + Q²/S dx = m² λ / B

(D. N. Arnold & R. S. Falk, SIAM J. Numer. Anal. 27 (1990) 281, on the layer.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from fem_lie._arrays import Array, Indices
from fem_lie.adapt.estimates.cut.borders import border_shares
from fem_lie.bodies.shells.shell import Shell
from fem_lie.results.stresses.nodal_values import slopes_along
from fem_lie.results.stresses.shell_stress import StressPlaces

_TWIST, _SHEAR = 5, 6  # of stress along and across an edge


@dataclass(frozen=True, eq=False)
class EdgeLayers:
    """What does not change with the state, of b edges without another side.

    Attributes:
        edges: Numbers (m c) of the edges, shape (b,).
        sides: 1 where the second axis of the edge points outward, −1 elsewhere, shape (b,).
        couples: From stress at the points of integration, (m g 8,), to the couple per length about
            the normal that holds the edge, shape (b, m g 8).
        factors: Length of the edge times ``λ/B``, zero at corners, shape (b,).
    """

    edges: Indices
    sides: Array
    couples: csr_matrix
    factors: Array

    @classmethod
    def of(
        cls, shell: Shell, places: StressPlaces, ends: Indices, edges: Indices, turns: Array
    ) -> EdgeLayers:
        """Those of a shell.

        Args:
            shell: The shell.
            places: Where its stress is.
            ends: Both ends of the c edges of a cell, among its nodes, shape (c, 2).
            edges: Those without another side, numbers in (m c).
            turns: From stress along the sections to stress along edges, shape (m, c, 8, 8).
        """
        mesh, c = shell.own_mesh, len(ends)
        cell, side = np.divmod(edges, c)
        nodes, x = mesh.cells[cell], mesh.points
        pair = np.take_along_axis(nodes, ends[side], axis=1)
        pair.sort(axis=1)  # the direction of the axes
        along = x[pair[:, 1]] - x[pair[:, 0]]
        length = np.linalg.norm(along, axis=1)
        along /= length[:, np.newaxis]
        outward = x[pair].mean(axis=1) - x[nodes].mean(axis=1)
        second = np.cross(mesh.normals[cell].mean(axis=1), along)
        sides = np.sign(np.einsum("bj,bj->b", second, outward))
        number = np.take_along_axis(places.patches.number[cell], ends[side], axis=1)
        share, straight = border_shares(number, along, length)
        weight = np.divide(straight, share, out=np.zeros_like(share), where=straight > 0)
        weight /= np.maximum(straight.sum(axis=1, keepdims=True), 1.0)
        couples = sum(_couples(shell, places, number[:, k], along, weight[:, k]) for k in range(2))
        turn = turns[cell, side]
        D = turn @ shell.stiffness[cell] @ np.swapaxes(turn, 1, 2)
        twist, shear = D[:, _TWIST, _TWIST], D[:, _SHEAR, _SHEAR]
        factors = length * straight.any(axis=1) / np.sqrt(twist * shear)
        return cls(edges, sides, couples, factors)

    def squares(self, stress: Array, at_edges: Array, jumps: Array) -> Array:
        """What the cells miss besides what jumps say, shape (m,).

        Args:
            stress: At the points of integration, shape (m, g, 8).
            at_edges: At the middles of edges, in their axes, shape (m, c, 8).
            jumps: There, shape (m, c, 8).
        """
        m, c = at_edges.shape[:2]
        cell = self.edges // c
        own = self.sides * at_edges.reshape(-1, 8)[self.edges, _TWIST]
        missed = np.abs(own - self.couples @ stress.ravel())
        smooth = 0.5 * np.abs(jumps[cell, :, _TWIST]).max(axis=1)
        square = self.factors * np.maximum(missed - smooth, 0.0) ** 2
        return np.asarray(np.bincount(cell, square, minlength=m), dtype=np.float64)


def _couples(
    shell: Shell, places: StressPlaces, number: Indices, along: Array, weight: Array
) -> csr_matrix:
    """``∫ M_ij N,i τ_j + Q_i τ_i N`` with the shape function N of one end each, times a weight."""
    m, k = places.patches.number.shape
    g = places.areas.shape[1]
    corner = np.argsort(places.patches.number.ravel(), kind="stable")
    sorted_ = places.patches.number.ravel()[corner]
    first, last = np.searchsorted(sorted_, number), np.searchsorted(sorted_, number, "right")
    row = np.repeat(np.arange(len(number)), last - first)
    offset = np.arange(len(row)) - np.repeat(np.cumsum(last - first) - (last - first), last - first)
    cell, node = np.divmod(corner[first[row] + offset], k)
    mesh = shell.own_mesh
    tangents = places.points.tangents(mesh.points[mesh.cells])[cell]
    slopes = np.broadcast_to(
        np.moveaxis(places.points.slopes[:, :, node], 2, 0).swapaxes(1, 2)[..., np.newaxis],
        (len(row), g, 2, 1),
    )
    N1, N2 = np.moveaxis(slopes_along(places.section[cell], tangents, slopes)[..., 0], -1, 0)
    N = places.points.shapes[:, node].T
    t1, t2 = np.einsum("pgij,pj->ipg", places.section[cell][:, :, :2], along[row])
    found = np.stack([N1 * t1, N2 * t2, N1 * t2 + N2 * t1, N * t1, N * t2], axis=-1)
    found *= (places.areas[cell] * weight[row][:, np.newaxis])[..., np.newaxis]
    columns = (cell[:, np.newaxis] * g + np.arange(g))[..., np.newaxis] * 8 + np.arange(3, 8)
    rows = np.broadcast_to(row[:, np.newaxis, np.newaxis], columns.shape)
    shape = (len(number), m * g * 8)
    return csr_matrix((found.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
