"""Rigid motions of the connected pieces of a scene, and what stress makes of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.lie import kinds
from fem_lie.linear.spectra.rigid_parts import FREE, kernel
from fem_lie.system.system import System


class RigidMotions(NamedTuple):
    """Rigid motions of a piece that elements connect, of any types of nodes.

    Attributes:
        nodes: Of the piece, shape (n,).
        unknowns: Their free unknowns among all free ones, shape (k,).
        basis: Orthonormal rigid motions that what is held allows, shape (k, ≤ 6).
    """

    nodes: Indices
    unknowns: Indices
    basis: Array


def rigid_motions(system: System, H: Array, weight: Array) -> list[RigidMotions]:
    """Of all pieces in which there are any; unknowns are twists over ``weight``."""
    count = system.count
    # without elements each node is a piece of its own
    none = np.zeros(0, dtype=np.int64)
    pairs = (none, none), *system.elastic.pairs
    rows, columns = (np.concatenate([p[k] for p in pairs]) for k in (0, 1))
    graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    pieces, label = connected_components(graph, directed=False)
    number = np.cumsum(~system.held.ravel()) - 1
    held = system.held.copy()
    # shells of five parameters do not feel what is held of them
    drills = held & system.numbering.held & system.uncoupled[:, np.newaxis]
    drills[:, :5] = False
    found = []
    for piece in range(pieces):
        nodes = np.flatnonzero(label == piece)
        R = kinds.rigid_motions(system.kinds[nodes], H[nodes], H[nodes, 0].mean(axis=0))
        R *= np.repeat([system.length, 1.0], 3)
        for k in range(6):
            every = np.zeros((count, 6))
            every[nodes] = R[:, :, k]
            system.supports.turn(H, every)
            R[:, :, k] = every[nodes]
        R = R.reshape(-1, 6) / weight.reshape(-1, 6)[nodes].reshape(-1, 1)
        stuck = (held & ~drills)[nodes].ravel()
        allowed = kernel(R[stuck])
        free = ~held[nodes].ravel()
        unknowns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()[free]
        basis = _orthonormal(R[free] @ allowed)
        if basis.shape[1]:
            found.append(RigidMotions(nodes, number[unknowns], basis))
    return found


def _orthonormal(motions: Array) -> Array:
    """Basis of the columns, fewer where some move nothing, as a turn of a straight cable."""
    Q, R = np.linalg.qr(motions)
    sizes = np.abs(np.diagonal(R))
    if (sizes > FREE * sizes.max(initial=0.0)).all() and len(sizes) == motions.shape[1]:
        return np.asarray(Q)
    return np.asarray(scipy.linalg.orth(motions, rcond=FREE)) if motions.any() else Q[:, :0]


def stress_terms(forces: Array) -> Array:
    """Blocks of ``P``, shape (n, 6, 6), for internal forces (n, 6): ``P ψ = ad(ψ)ᵀ f``."""
    ad = lie.se3_ad(np.eye(6))
    return np.asarray(np.einsum("kji,nj->nik", ad, forces))
