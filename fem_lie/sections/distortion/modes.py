"""Modes of a section: its slowest vibrations in its plane, and the warping that goes with them.

A displacement ``a v`` in the plane of the section, with an amplitude that varies along the beam,
causes shear ``a′ v``. Axial displacements ``b ψ`` with ``b = a′`` relax it: ``∫G |∇ψ + v|²`` is a
minimum, and in thin walls zero (Vlasov; generalised beam theory, R. Schardt 1989). With the energy
per length ``½ (C a″² + B a²)``, ``C = ∫E ψ²`` without extension and bending of the beam and ``B``
the stiffness of the section in its plane, amplitudes decay along the beam as::

    exp(−s/ℓ) cos(s/ℓ),    ℓ = √2 (C/B)^¼.

Modes are eigenvectors of ``B`` and of the mass of the section, by subspace iteration. The softest
ones, in which walls tilt, are those that extend farthest along the beam; the next ones are bending
of walls.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from fem_lie._arrays import Array
from fem_lie.sections.distortion.fields import Relaxation, flat

_ITERATIONS = 8
_FURTHER = 6  # vectors of the subspace
_DEPENDENT = 0.02  # rest of a field after projection, relative to the field
_SEED = 7


class Modes(NamedTuple):
    """Modes of a section.

    Attributes:
        squares: Squared angular frequencies of infinitely long waves, shape (k,).
        lengths: Decay lengths, shape (k,).
        plane: Displacements in the plane, shape (k, n, 3).
        axial: Axial displacements that relax the shear of these, shape (k, n, 3).
    """

    squares: Array
    lengths: Array
    plane: Array
    axial: Array


def modes_of(relaxation: Relaxation, count: int) -> Modes:
    """The ``count`` modes of the lowest frequencies.

    Args:
        relaxation: The section.
        count: Number of modes, at least 1.
    """
    fields = relaxation.fields
    v = np.random.default_rng(_SEED).standard_normal((count + _FURTHER, len(fields.points), 3))
    for _ in range(_ITERATIONS):
        v = _in_plane(relaxation.solve(relaxation.weighted(v)))
        B = flat(v) @ (relaxation.stiffness @ flat(v).T)
        squares, vectors = eigh(0.5 * (B + B.T), relaxation.weighted(v) @ flat(v).T)
        v = np.einsum("kni,kj->jni", v, vectors)
    v, squares = v[:count], squares[:count]
    ψ = warping_of(relaxation, v)
    C = fields.interpolated(ψ)[..., 0] ** 2 @ (fields.weights * fields.young)
    return Modes(squares, np.sqrt(2.0) * (C / squares) ** 0.25, v, ψ)


def warping_of(relaxation: Relaxation, v: Array) -> Array:
    """Axial displacements that relax the shear of rates ``v`` along the beam, both (k, n, 3).

    They are without extension and bending: orthogonal in mass to 1, y and z.
    """
    fields = relaxation.fields
    stress = fields.stress(fields.strains_of_rates(v))
    ψ = relaxation.solve(-relaxation.forces(stress)) * np.array([1.0, 0.0, 0.0])
    return orthogonal(relaxation, ψ, fields.rigid[[0, 4, 5]])


def orthogonal(relaxation: Relaxation, u: Array, others: Array) -> Array:
    """``u`` (k, n, 3) without its projections in mass onto ``others`` (c, n, 3)."""
    weighted = relaxation.weighted(others)
    shares = np.linalg.solve(weighted @ flat(others).T, weighted @ flat(u).T)
    return np.asarray(u - np.einsum("ck,cni->kni", shares, others))


def orthonormal(relaxation: Relaxation, u: Array) -> Array:
    """Span of ``u`` (k, n, 3) with mean square 1 in mass, in its order, shape (≤ k, n, 3).

    Fields that depend on those before are left out.
    """
    fields = relaxation.fields
    found, mass = u[:0], float(fields.weights @ fields.density)
    for each in np.split(u, len(u)):
        rest = orthogonal(relaxation, each, found) if len(found) else each
        size, left = (np.sqrt(fields.products(a, a)[0, 0]) for a in (each, rest))
        if left > _DEPENDENT * size:
            found = np.concatenate([found, rest * (np.sqrt(mass) / left)])
    return found


def _in_plane(u: Array) -> Array:
    return u * np.array([0.0, 1.0, 1.0])
