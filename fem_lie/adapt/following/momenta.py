"""Velocities that have given momenta: the nearest to given ones, by the consistent mass.

::

    ½ (v − v̂)ᵀ M (v − v̂) → min,    Zᵀ M v = (p, l),    B v = what joints allow

``Z`` are the six rigid motions; the mass matrix ``M`` of twists is ``Lᵀ G L`` of the constant one
of (x, d₁, d₂, d₃).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array, Flags
from fem_lie.lie.kinds import push_all, rigid_motions
from fem_lie.lie.kinds.inertia import invariants
from fem_lie.system.equations import Equations

_SAME = 1e-15  # of the momenta
_LOST = 1e-13  # of the largest of conditions that others say, too
_NO_INERTIA = 1e-12
_ROUNDS = 3


def with_momenta(
    equations: Equations, H: Array, v: Array, momenta: Array, free: Flags, rates: Array
) -> Array:
    """Twists of all rows with given momenta.

    Args:
        equations: Of the scene.
        H: Frames of all rows.
        v: Twists of all rows, near to which others are looked for.
        momenta: Linear and angular about the origin, global components, shape (6,).
        free: Nodes that may change their twist, shape (n,).
        rates: Of all constraints, that they are to have, shape (m,).
    """
    n, held = equations.unknowns.moving, equations.unknowns.held
    open_ = (free[:, np.newaxis] & ~held).ravel()
    M = mass_matrix(equations, H)
    rigid = rigid_motions(equations.unknowns.kinds, H[:n], np.zeros(3)).reshape(6 * n, 6)
    P = np.asarray((M @ rigid).T)
    constraints = equations.constraints(H)
    C = sp.vstack([sp.csr_matrix(P), constraints.jacobian]).tocsr()[:, open_]
    own = M[open_][:, open_]
    # inertia of all unknowns as masses, and both momenta alike
    length = equations.unknowns.length
    units = (length / equations.unknowns.units)[open_]
    masses = own.diagonal() / units**2
    light = masses <= _NO_INERTIA * masses.max()
    factors = splu((own + sp.diags(np.where(light, masses.max() * units**2, 0.0))).tocsc())
    sizes = np.repeat([length, 1.0], 3)
    toward = factors.solve(C.toarray().T)
    S = C @ toward
    size = np.sqrt(np.maximum(np.diag(S), 1e-300))
    S = S / np.outer(size, size)
    found = v.copy()
    for _ in range(_ROUNDS):
        left = np.concatenate(
            [momenta - P @ found[:n].ravel(), rates - constraints.rates(found)[0]]
        )
        if np.abs(sizes * left[:6]).max() <= _SAME * np.abs(sizes * momenta).max():
            break
        weights, *_ = np.linalg.lstsq(S, left / size, rcond=_LOST)
        change = np.zeros(6 * n)
        change[open_] = toward @ (weights / size)
        found[:n] += change.reshape(n, 6)
    return found


def invariants_of(equations: Equations, H: Array, v: Array) -> tuple[float, Array]:
    """Kinetic energy, and both momenta, about the origin, shape (6,)."""
    unknowns = equations.unknowns
    rates, room = np.empty((2, unknowns.moving, 4, 3))
    energy, *momenta = invariants(
        unknowns.kinds, H, v[: unknowns.moving], *equations.tables.inertia, rates, room
    )
    return float(energy), np.array(momenta)


def mass_matrix(equations: Equations, H: Array) -> sp.csr_matrix:
    """Of the twists of all moving nodes, shape (6 n, 6 n)."""
    n, kinds = equations.unknowns.moving, equations.unknowns.kinds
    indptr, indices, G = equations.tables.inertia
    L = np.empty((6, n, 4, 3))
    for k in range(6):
        push_all(kinds, H, np.tile(np.eye(6)[k], (n, 1)), L[k])
    row = np.repeat(np.arange(n), np.diff(indptr))
    blocks = np.einsum("pzax,zab,qzbx->zpq", L[:, row], G, L[:, indices], optimize=True)
    return sp.bsr_matrix((blocks, indices, indptr), shape=(6 * n, 6 * n)).tocsr()
