"""What impulses do at once: mass bordered by all joints."""

from __future__ import annotations

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array
from fem_lie.system.equations import Equations, Instant, Plan

_TINY = 1e-6
"""Part of a step within which stiffness does nothing."""

_SOFTNESS, _REFINED = 1e-9, 2
"""What joints yield, of what they do alone, for some follow from others; and times that solutions
are refined, after which nothing is left of that."""

_DENSE = 150
"""Unknowns up to which a dense matrix is factorised sooner."""


class Impulses:
    """Solutions of ``M x + Jᵀ λ = f, J x = g``, with a mass matrix that stays what it was."""

    def __init__(self, equations: Equations, step: float) -> None:
        """Find the mass matrix.

        Args:
            equations: Of the scene; their matrix is overwritten.
            step: Size of the steps.
        """
        unknowns = equations.unknowns
        self._equations, self._n, self._m = equations, 6 * unknowns.moving, unknowns.m
        none = np.zeros((unknowns.moving, 6))
        still = Instant(equations.start.frames, none, none, np.zeros(unknowns.m))
        equations.fill(still, None, Plan(none, at_rest=_TINY * step))
        n = self._n
        whole = sp.csr_matrix(equations.matrix.csr).copy()
        self.mass = whole[:n, :n].tocsc()
        self._weights = 1.0 / self.mass.diagonal()
        self._free = splu(self.mass) if unknowns.m == 0 else None

    def go_to(self, H: Array) -> None:
        """Factorise with the joints as they are at frames ``H``."""
        if self._free is not None:
            return
        J = self._equations.constraints(H).jacobian
        self._scale = 1.0 / np.sqrt(np.maximum(J.multiply(J) @ self._weights, 1e-300))
        J = sp.diags(self._scale) @ J
        soft = -_SOFTNESS * sp.identity(self._m)
        self._matrix = sp.bmat([[self.mass, J.T], [J, soft]], format="csc")
        self._true = sp.bmat([[self.mass, J.T], [J, None]], format="csr")
        self._small = self._n + self._m <= _DENSE
        if self._small:
            self._factors = la.lu_factor(self._matrix.toarray())
        else:
            self._sparse = splu(self._matrix)

    def _solved(self, b: Array) -> Array:
        if self._small:
            return np.asarray(la.lu_solve(self._factors, b))
        return np.asarray(self._sparse.solve(b))

    def solve(self, f: Array, g: Array | None = None) -> tuple[Array, Array]:
        """Solutions ``x`` and ``λ``.

        Args:
            f: Impulses on the nodes, shape (6 n,) or (6 n, k).
            g: Rates of the constraints, shape (m,) or (m, k); default: none.
        """
        if self._free is not None:
            return np.asarray(self._free.solve(f)), np.zeros((0, *f.shape[1:]))
        scale = self._scale.reshape(-1, *([1] * (f.ndim - 1)))
        rest = np.zeros((self._m, *f.shape[1:])) if g is None else scale * g
        b = np.concatenate([f, rest])
        x = self._solved(b)
        for _ in range(_REFINED):
            x = x + self._solved(b - self._true @ x)
        return x[: self._n], scale * x[self._n :]
