"""The slowest modes by Ritz's method, from rigid motions and from their own vectors.

Round-off of the stiffness of elements is larger than a soft spring, and perturbs zero eigenvalues.
In that span the stiffness is free of it (:mod:`fem_lie.linear.spectra.pencil`). Free motions ``Z``,
``K Z = 0``, are eigenvectors with ``s = 0``. In quadratic problems each of these zeros is double if
the motion is undamped, and round-off splits a double zero by its square root; in terms of
velocities of ``Z`` instead of displacements, each zero occurs once less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.spectra.pencil import SHIFT, Complex, Pencil, RigidParts

_WIDE = 1.01  # least quotient of rates on both sides of a gap
_BESIDE = 1e-6  # largest relative error of a vector of rigid motion
_MIXED = 1e-2  # largest part of a vector that round-off mixes into it
_SPLIT = 1e-7  # relative size of parts of a vector that are round-off
_DEPENDENT = 1e-14  # squared
_UNDAMPED = 1e-12  # of the terms that cancel in the damping of a motion


@dataclass(frozen=True, eq=False)
class SlowMotions:
    """Eigenpairs with recomputed slow modes.

    Attributes:
        free: Motions without stiffness, with eigenvalue zero, shape (z, n).
        s: Other eigenvalues, shape (k,).
        vectors: Their eigenvectors, shape (k, n).
    """

    free: Array
    s: Complex
    vectors: Complex


def without_round_off(pencil: Pencil, s: Complex, vectors: Complex) -> SlowMotions:
    """Eigenpairs, of which the slow ones are recomputed with the split stiffness."""
    parts = pencil.parts
    assert parts is not None
    rigid = _orthonormal(pencil, parts.mechanisms(pencil.B))
    if not len(rigid):
        return SlowMotions(rigid, s, vectors)
    limit = _gap(np.abs(s), np.sqrt(SHIFT) * pencil.fastest)
    slow = np.abs(s) <= limit
    free, resisted = _split(pencil, parts, rigid)
    strained = _without_rigid(pencil, rigid, vectors[slow])
    basis, z = np.concatenate([free, resisted, strained]), len(free)
    K = np.asarray(pencil.work(basis, pencil.stiffness(basis)), dtype=np.float64)
    if pencil.C is None:
        rates, coordinates = _undamped(K, z, pencil.symmetric)
    else:
        C = pencil.work(basis, (pencil.C @ basis.T).T)
        size = pencil.work(np.abs(basis), (abs(pencil.C) @ np.abs(basis.T)).T)
        rates, coordinates = _damped(K, C, z, size.max(initial=0.0))
    found = coordinates @ basis
    kept = np.abs(rates) <= limit
    span = np.concatenate([free, found[kept].real, found[kept].imag])
    others = without(pencil, _orthonormal(pencil, span), s[~slow], vectors[~slow])
    return SlowMotions(
        free, np.concatenate([rates[kept], s[~slow]]), np.concatenate([found[kept], others])
    )


def _gap(rates: Array, limit: float) -> float:
    """A rate near a limit that lies between those of modes and is close to none.

    Without any stiffness the limit is zero, and all motions are slow.
    """
    if limit == 0.0:
        return np.inf
    sizes = np.sort(np.concatenate([rates, [1e-3 * limit, 1e3 * limit]]))
    wide = np.flatnonzero((sizes[:-1] <= limit) & (sizes[1:] > _WIDE * sizes[:-1]))
    return float(np.sqrt(sizes[wide[-1]] * sizes[wide[-1] + 1]))


def without(pencil: Pencil, slow: Array, s: Complex, vectors: Complex) -> Complex:
    """Faster modes without the part of slow ones that round-off mixes into them, (q, n).

    Their forces do no work on slow modes: ``Φ Q(s) (φ − Φᵀ a) = 0``.
    """
    own = [pencil.work(slow, term.real) for term in pencil.terms(slow.astype(np.complex128))]
    work = [pencil.work(slow, term) for term in pencil.terms(vectors)]
    powers = np.stack([s**2, s, np.ones_like(s)])
    Q = np.einsum("pk,pij->kij", powers, np.asarray(own, dtype=np.float64))
    r = np.einsum("pk,pik->ki", powers, np.asarray(work, dtype=np.complex128))
    # larger values are not round-off: a damped free motion has a second eigenvalue
    share = np.linalg.norm(pencil.work(vectors, (pencil.M @ slow.T).T), axis=1)
    mixed = share <= _MIXED * np.sqrt(pencil.kinetic(vectors))
    cleared = vectors.copy()
    cleared[mixed] -= np.linalg.solve(Q[mixed], r[mixed, :, np.newaxis])[:, :, 0] @ slow
    return cleared


def _without_rigid(pencil: Pencil, rigid: Array, vectors: Complex) -> Array:
    """Basis of the parts of vectors other than rigid motion and errors, shape (k, n)."""
    both = np.concatenate([vectors.real, vectors.imag])
    both = both / pencil.unknowns.largest(float(np.abs(both).max(initial=1e-300)))
    both = _unit(pencil, both, _SPLIT * np.sqrt(pencil.mass_unit))
    for _ in range(2):
        both = both - pencil.work(both, (pencil.M @ rigid.T).T) @ rigid
    return _orthonormal(pencil, _unit(pencil, both, _BESIDE))


def _split(pencil: Pencil, parts: RigidParts, rigid: Array) -> tuple[Array, Array]:
    """Rigid motions without stiffness, and the others."""
    if not len(rigid):
        return rigid, rigid
    _, values, turn = np.linalg.svd(pencil.work(rigid, (parts.rest @ rigid.T).T))
    motions = turn @ rigid
    free = values <= parts.round_off(motions)
    return motions[free], motions[~free]


def _undamped(K: Array, z: int, symmetric: bool) -> tuple[Complex, Complex]:
    """Eigenvalues of ``s² + K`` with ``Im s ≥ 0``, as :func:`_damped`."""
    solve = np.linalg.eigh if symmetric else np.linalg.eig
    squares, x = solve(0.5 * (K + K.T)[z:, z:] if symmetric else K[z:, z:])
    with np.errstate(divide="ignore", invalid="ignore"):
        free = np.where(squares != 0.0, K[:z, z:] @ x / squares, 0.0)
    s = np.sqrt((-squares).astype(np.complex128))
    return np.where(s.imag < 0.0, -s, s), np.concatenate([free, x]).T.astype(np.complex128)


def _damped(K: Array, C: Array, z: int, size: float) -> tuple[Complex, Complex]:
    """Eigenvalues of ``s² + s C + K``, without zeros of the first ``z`` coordinates.

    Args:
        K: Stiffness in coordinates of unit mass, shape (k, k).
        C: Damping matrix.
        z: Number of coordinates without stiffness.
        size: Size of the terms that cancel in ``C``.

    Returns:
        Eigenvalues, and coordinates of their vectors as rows.
    """
    n = len(K)
    unit = float(max(np.sqrt(np.abs(K).max(initial=0.0)), np.abs(C).max(initial=0.0))) or 1.0
    # unknowns are y, the last n - z coordinates, and v, rates of all
    A = np.zeros((2 * n - z, 2 * n - z))
    A[: n - z, n:] = np.eye(n - z)
    A[n - z :, : n - z], A[n - z :, n - z :] = -K[:, z:] / unit**2, -C / unit
    s, states = np.linalg.eig(A)
    # displacements of undamped free motions that grow with time
    still = np.linalg.svd(C[:z, :z], compute_uv=False) <= _UNDAMPED * size
    kept = np.argsort(np.abs(s), kind="stable")[int(still.sum()) :]
    s = s[kept].astype(np.complex128)
    states = states[:, kept].astype(np.complex128)
    rows = np.divide(states[n - z : n], s, out=np.zeros((z, len(s)), np.complex128), where=s != 0)
    coordinates = np.concatenate([rows, states[: n - z]]).T
    coordinates /= np.linalg.norm(coordinates, axis=1, keepdims=True)
    return np.asarray(unit * s, dtype=np.complex128), coordinates


def _unit(pencil: Pencil, vectors: Array, least: float) -> Array:
    """Rows scaled to length one; those not longer than ``least`` are left out."""
    size = np.sqrt(pencil.kinetic(vectors).clip(0.0))
    kept = size > least
    return np.asarray(vectors[kept] / size[kept, np.newaxis])


def _orthonormal(pencil: Pencil, vectors: Array) -> Array:
    """Basis (k, n) of the span of rows, with ``Φ M Φᵀ = 1``."""
    if not len(vectors):
        return vectors
    weight, base = np.linalg.eigh(pencil.work(vectors, (pencil.M @ vectors.T).T))
    kept = weight > _DEPENDENT * weight.max()
    return np.asarray((base[:, kept] / np.sqrt(weight[kept])).T @ vectors)
