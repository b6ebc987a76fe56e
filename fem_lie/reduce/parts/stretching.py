"""What shapes do to each other's strain: tension stiffens bending, and bending draws ends together.

The third derivative ``C`` of the full body's energy in its shapes is found by differences of its
forces. Many energies ``½ eᵀ K e`` with ``e_a = z_a + ½ Q_abc z_b z_c`` have this derivative; they
differ in which of three shapes takes up what the others draw. What is known is that slender bodies
bend without stretching: in shapes in which ``K`` and the squares of nodes' *rotations* are diagonal
stretching is stiffer than bending by far, and ``Q = C / (k_a + k_b + k_c)`` is the least ``Q`` that
gives ``C``. (With mass in the place of rotations short waves of bending are as stiff as long ones
of stretching, and a soft cantilever bends by a fifth too much at a tenth of its length.)

Third derivatives alone would make slender bodies buckle by bending; with the fourth ones of the
full energy they would lock, for shapes that shorten every part of a line as its bending wants are
not among them.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.system.equations import Instant

_STRAIGHT = 1e-3  # what displacements over the body's size count beside rotations
_STEP = 4e-3  # of the body's size: how large shapes are in differences
_WEIGHTS = {1.0: 4.0 / 3.0, 2.0: -1.0 / 12.0}
"""Of ``f(k s) + f(−k s)`` in the second derivative along ``s``, of fourth order where ``f(0) = 0``.

Plain differences leave 1e-8 of it in round-off or in higher terms, whatever the step."""


def quadratic_strains(rest: BesideRest, frame: Array, shapes: Array, K: Array) -> Array:
    """The ``Q`` (m, m, m) of :class:`~fem_lie.ReducedBody`.

    Args:
        rest: The full body alone.
        frame: Within which shapes are seen, (4, 3).
        shapes: Displacement and rotation of all its nodes, components along the frame, (m, n, 6).
        K: Stiffness in them, (m, m).
    """
    C = _third_derivative(_Within(rest, frame, shapes))
    flat = shapes * np.repeat([_STRAIGHT / rest.body.size, 1.0], 3)
    k, V, back = _principal_shapes(K, flat.reshape(len(flat), -1))
    own = np.einsum("abc,ai,bj,ck->ijk", C, V, V, V, optimize=True)
    own /= k[:, np.newaxis, np.newaxis] + k[:, np.newaxis] + k
    return np.asarray(np.einsum("ijk,ai,jb,kc->abc", own, V, back, back, optimize=True))


def _principal_shapes(K: Array, rows: Array) -> tuple[Array, Array, Array]:
    """``k``, ``V`` and ``V⁻¹`` with ``VᵀKV = k`` and ``VᵀRV = 1``, ``R = rows rowsᵀ`` (m, m).

    Stretching is 1e8 times as stiff as bending in ``R``, whose eigenvalues would leave as many
    digits less; singular values of ``rows`` are their square roots.
    """
    L = np.linalg.cholesky(K)
    U, s, _ = np.linalg.svd(scipy.linalg.solve_triangular(L, rows, lower=True), full_matrices=False)
    V = scipy.linalg.solve_triangular(L, U / s, lower=True, trans="T")
    return 1.0 / s**2, np.asarray(V), (s[:, np.newaxis] * U.T) @ L.T


class _Within:
    """Forces of the full body whose frame stays, at the origin, where positions have all digits."""

    def __init__(self, rest: BesideRest, frame: Array, shapes: Array) -> None:
        self._equations, body, leads = rest.equations, rest.body, rest.leads
        self._shapes = shapes[:, leads]
        self._inside = lie.se3_compose(lie.se3_inverse(frame), body.frames[leads])
        self._r = np.empty(self._equations.unknowns.size)
        self._still = np.zeros((len(leads), 6))
        reach = np.abs(shapes * np.repeat([1.0, body.size], 3)).max(axis=(1, 2))
        self.steps = np.diag(_STEP * body.size / reach)

    def forces(self, z: Array) -> Array:
        """Forces on coordinates, (m,)."""
        h = np.einsum("m,mni->ni", z, self._shapes)
        turned = lie.so3_exp(h[:, 3:])
        H = self._inside.copy()
        H[:, 0] += h[:, :3]
        H[:, 1:] = np.einsum("nij,nkj->nki", turned, H[:, 1:])
        axes = H[:, 1:].copy()
        frames = self._equations.start.frames.copy()
        frames[: len(H)] = H
        state = Instant(frames, self._still, self._still, np.zeros(0))
        self._equations.residual(state, np.zeros(0), self._r)
        f = self._r.reshape(-1, 2, 3)
        force, moment = np.einsum("nki,nhk->hni", axes, f)
        moment = np.einsum("nij,ni->nj", lie.so3_tangent(-h[:, 3:]), moment)
        dual = np.concatenate([force, moment], axis=1)
        return np.asarray(np.einsum("mni,ni->m", self._shapes, dual))


def _second_derivative(within: _Within, step: Array) -> Array:
    """Of the forces along ``step``, (m,)."""
    pairs = (w * (within.forces(k * step) + within.forces(-k * step)) for k, w in _WEIGHTS.items())
    return np.asarray(sum(pairs), dtype=np.float64)


def _third_derivative(within: _Within) -> Array:
    """Of the energy, (m, m, m), symmetric."""
    steps = within.steps
    m = len(steps)
    own = [_second_derivative(within, step) for step in steps]
    C: Array = np.empty((m, m, m))
    for b in range(m):
        C[:, b, b] = own[b]
        for c in range(b):
            both = _second_derivative(within, steps[b] + steps[c])
            C[:, b, c] = C[:, c, b] = 0.5 * (both - own[b] - own[c])
    sizes = steps.diagonal()
    C /= sizes[:, np.newaxis] * sizes
    return np.asarray((C + C.transpose(1, 2, 0) + C.transpose(2, 0, 1)) / 3.0, np.float64)
