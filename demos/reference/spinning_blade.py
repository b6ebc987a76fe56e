"""Transfer matrix of a pre-bent, twisted blade that turns steadily, by intrinsic equations.

With twists ``V = (v, w)`` and stress resultants ``F = (N, M)`` in axes of the sections, momenta
``P = M V``, flexibility ``C`` and ``K = (e, k) = (e_1, k_0) + C F`` (D. H. Hodges, AIAA J. 41
(2003) 1131), with ``ad_K (v, w) = (k x v + e x w, k x w)``::

    V' = -ad_K V + d/dt C F,    F' = ad_K^T F + d/dt P - ad_V^T P

The steady state is a boundary value problem. Small vibrations about it, proportional to exp(s t),
are a linear system along the blade, whose matrix is multiplied up by the exponential integrator of
Magnus of order four. Eigenvalues are those for which forces at the clamp exist that leave the tip
free. No displacement, no rotation and no element is needed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_bvp
from scipy.linalg import expm

Array = np.ndarray
Along = Callable[[Array], Array]
_GAUSS = np.sqrt(3.0) / 6.0


def _cross(a: Array) -> Array:
    """Matrices of ``a x``, shape (n, 3, 3)."""
    return np.cross(a[:, np.newaxis], -np.eye(3))


def _motion(a: Array) -> Array:
    """``ad``: of twists (v, w) along (e, k), shape (n, 6, 6)."""
    found = np.zeros((len(a), 6, 6))
    found[:, :3, :3] = found[:, 3:, 3:] = _cross(a[:, 3:])
    found[:, :3, 3:] = _cross(a[:, :3])
    return found


def _dual(F: Array) -> Array:
    """Matrix of the change of ``ad* F`` with (e, k), shape (n, 6, 6)."""
    found = np.zeros((len(F), 6, 6))
    found[:, :3, 3:] = found[:, 3:, :3] = -_cross(F[:, :3])
    found[:, 3:, 3:] = -_cross(F[:, 3:])
    return found


class Blade:
    """A blade, clamped to a hub; forces are over the mass per length at the clamp."""

    def __init__(self, kinks: Array, flexibility: Along, mass: Along, curvature: Along) -> None:
        """Functions of arc lengths (n,): flexibility and mass (n, 6, 6), curvature (n, 3).

        They are smooth between ``kinks``, from 0 to the length of the blade.
        """
        unit = mass(kinks[:1])[0, 0, 0]
        self._kinks, self._length, self._curvature = kinks, kinks[-1], curvature
        self._mass, self._flexibility = lambda s: mass(s) / unit, lambda s: unit * flexibility(s)

    def _strained(self, s: Array, F: Array) -> Array:
        """``(e, k)``, shape (n, 6)."""
        rest = np.hstack([np.tile([1.0, 0, 0], (len(s), 1)), self._curvature(s)])
        return rest + np.einsum("nij,nj->ni", self._flexibility(s), F)

    def _slopes(self, s: Array, y: Array) -> Array:
        """Of the steady state."""
        V, F = y.T[:, :6], y.T[:, 6:]
        along, P = _motion(self._strained(s, F)), np.einsum("nij,nj->ni", self._mass(s), V)
        dF = np.einsum("nji,nj->ni", along, F) - np.einsum("nji,nj->ni", _motion(V), P)
        return np.hstack([-np.einsum("nij,nj->ni", along, V), dF]).T

    def steady(self, clamp: Array, between: int = 20) -> Callable[[Array], Array]:
        """Twist and forces (12, n) as a function of arc length, for a twist of the clamp (6,)."""
        parts = np.linspace(self._kinks[:-1], self._kinks[1:], between, endpoint=False, axis=1)
        s = np.append(parts.ravel(), self._length)
        start = np.zeros((12, len(s)))
        start[:6] = clamp[:, np.newaxis]
        start[:3] += np.cross(clamp[3:], np.outer(s, [1.0, 0, 0])).T

        def ends(a: Array, b: Array) -> Array:
            return np.hstack([a[:6] - clamp, b[6:]])

        found = solve_bvp(self._slopes, ends, s, start, tol=1e-7, max_nodes=20_000)
        assert found.success, found.message
        return found.sol

    def free_tip(self, steady: Callable[[Array], Array], λ: complex, steps: int) -> Array:
        """Forces at the tip per force at the clamp, of vibrations as exp(λ t), shape (6, 6)."""
        h = self._length / steps
        middle = h * (np.arange(steps) + 0.5)
        A, B = (self._matrix(steady, middle + k * _GAUSS * h, λ) for k in (-1.0, 1.0))
        Ω = 0.5 * h * (A + B) + 0.5 * _GAUSS * h**2 * (B @ A - A @ B)
        y = np.vstack([np.zeros((6, 6)), np.eye(6)]).astype(complex)
        for each in expm(Ω):
            y = each @ y
        return y[6:]

    def _matrix(self, steady: Callable[[Array], Array], s: Array, λ: complex) -> Array:
        """Of the linear system along the blade, shape (n, 12, 12)."""
        V, F = np.split(steady(s).T, 2, axis=1)
        C, M, along = self._flexibility(s), self._mass(s), _motion(self._strained(s, F))
        P, turning = np.einsum("nij,nj->ni", M, V), np.swapaxes(_motion(V), 1, 2)
        A = np.zeros((len(s), 12, 12), dtype=complex)
        A[:, :6, :6] = -along
        A[:, :6, 6:] = (λ * np.eye(6) + _motion(V)) @ C
        A[:, 6:, :6] = λ * M - turning @ M + _dual(P)
        A[:, 6:, 6:] = np.swapaxes(along, 1, 2) - _dual(F) @ C
        return A

    def eigenvalue(
        self, steady: Callable[[Array], Array], near: complex, steps: int = 400
    ) -> complex:
        """The one next to a first guess, by secants."""

        def measure(λ: complex) -> complex:
            return complex(np.linalg.det(self.free_tip(steady, λ, steps) / scale))

        scale = np.abs(self.free_tip(steady, near, steps)).max(axis=1, keepdims=True)
        a, b = near, near * (1.0 + 1e-4)
        fa, fb = measure(a), measure(b)
        while abs(b - a) > 1e-11 * abs(near):
            a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
            fb = measure(b)
        return b
