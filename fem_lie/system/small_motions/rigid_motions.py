"""Rigid motions of the connected pieces of a scene, and what stress makes of them."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.lie import kinds
from fem_lie.lie.kinds import SLOPE
from fem_lie.linear.rigid_parts import FREE
from fem_lie.system.system import System


def rigid_motions(system: System, H: Array, weight: Array) -> list[tuple[Indices, Array]]:
    """See :class:`RigidParts`; unknowns are free ones, and twists those times ``weight``."""
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
        if (system.kinds[nodes] >= SLOPE).any():
            # axes that do not turn about themselves feel that of a stressed piece
            continue
        R = kinds.rigid_motions(system.kinds[nodes], H[nodes], H[nodes, 0].mean(axis=0))
        R *= np.repeat([system.length, 1.0], 3)
        for k in range(6):
            every = np.zeros((count, 6))
            every[nodes] = R[:, :, k]
            system.supports.turn(H, every)
            R[:, :, k] = every[nodes]
        R = R.reshape(-1, 6) / weight.reshape(-1, 6)[nodes].reshape(-1, 1)
        stuck = (held & ~drills)[nodes].ravel()
        allowed = scipy.linalg.null_space(R[stuck], rcond=FREE) if stuck.any() else np.eye(6)
        free = ~held[nodes].ravel()
        unknowns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()[free]
        if allowed.shape[1]:
            found.append((number[unknowns], np.linalg.qr(R[free] @ allowed)[0]))
    return found


def stress_terms(forces: Array) -> Array:
    """Blocks of ``P``, shape (n, 6, 6), for internal forces (n, 6): ``P ψ = ad(ψ)ᵀ f``."""
    ad = lie.se3_ad(np.eye(6))
    return np.asarray(np.einsum("kji,nj->nik", ad, forces))
