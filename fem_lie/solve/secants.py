"""Corrections with a frozen matrix, improved by secants from earlier corrections of the step.

A correction ``g = A⁻¹ r`` with an old matrix ``A`` is wrong where the tangent stiffness has
changed. The applied corrections ``d`` are known to have changed ``g`` by ``Δg``; with the current
matrix the change would have been ``d`` itself. The part of ``g`` in the span of the ``Δg`` is
replaced accordingly::

    g − Σ γ Δg + Σ γ d,      |g − Σ γ Δg| minimal

in lengths of the model. This is Anderson mixing of the preconditioned residual, a quasi-Newton
method that satisfies as many secant equations as there are pairs. Lagrange multipliers enter the
equations linearly and follow; the minimised norm excludes them. No pair is kept beyond a step, so
that a run restarted from a checkpoint repeats bit for bit.

Sources: Anderson, J. ACM 12 (1965) 547; Fang & Saad, Numer. Linear Algebra Appl. 16 (2009) 197;
Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.ranks.shared_nodes import SharedNodes

_ALIKE = 1e-8
"""A change is left out if less than this fraction of its square is orthogonal to newer ones."""


class Secants:
    """Corrections of the current step and the changes that they caused.

    Attributes:
        measure: Norm weights of the unknowns, in lengths of the model; zero for multipliers; shape
            (n,).
    """

    def __init__(
        self,
        most: int,
        measure: Array,
        shared: SharedNodes | None = None,
        *,
        growth: float = 1.0,
    ) -> None:
        """Start without any pair.

        Args:
            most: Largest number of pairs.
            measure: Norm weights of the unknowns, in lengths of the model; zero for multipliers;
                shape (n,).
            shared: Nodes that other ranks have, too, if corrections are those of a part of a
                scene: six unknowns for each of its nodes come first.
            growth: Ratio of successive corrections above which all pairs are dropped.
        """
        self.measure, self._growth, self._shared = measure.copy(), growth, shared
        if shared is not None:
            own = self.measure[: 6 * len(shared.owned)].reshape(-1, 6)
            own[~shared.owned] = 0.0
        self._made, self._changed = np.zeros((2, most, len(measure)))
        self._last, self._count = np.zeros((2, len(measure))), -1

    def forget(self) -> None:
        """Drop all pairs: a new step or a new matrix begins."""
        self._count = -1

    def improve(self, g: Array) -> None:
        """Improve a correction (n,) in place; the caller applies it.

        If it is much larger than the previous one, the secants have misled the iteration, and all
        pairs are dropped.
        """
        made, changed, last = self._made, self._changed, self._last
        if self._count >= 0 and self._size(g) > self._growth * self._size(last[1]):
            self.forget()
        if self._count >= 0:
            # the newest pair comes first
            made[1:], changed[1:] = made[:-1].copy(), changed[:-1].copy()
            made[0], changed[0] = last[0], last[1] - g
        self._count = min(self._count + 1, len(made))
        last[1] = g
        if self._count > 0:
            products = _products(self.measure, changed[: self._count], g)
            if self._shared is not None:
                products = self._shared.total(products)
            _mix(products, made[: self._count], changed[: self._count], g)
        last[0] = g

    def _size(self, g: Array) -> float:
        """Largest entry of a correction (n,) of all ranks, in lengths of the model."""
        own = _largest(self.measure, g)
        return own if self._shared is None else self._shared.largest(own)


@compiled
def _largest(measure: Array, g: Array) -> float:
    found = 0.0
    for i in range(g.shape[0]):
        found = max(found, abs(g[i]) * measure[i])
    return found


@compiled
def _products(measure: Array, changed: Array, g: Array) -> Array:
    """Products of the changes (p, n), lower triangle, and with ``g`` (n,), last; (p, p + 1)."""
    p, n = changed.shape
    found = np.zeros((p, p + 1))
    for j in range(p):
        for k in range(j + 1):
            for i in range(n):
                found[j, k] += measure[i] ** 2 * changed[j, i] * changed[k, i]
        for i in range(n):
            found[j, p] += measure[i] ** 2 * changed[j, i] * g[i]
    return found


@compiled
def _mix(products: Array, made: Array, changed: Array, g: Array) -> None:
    """Replace in ``g`` (n,) the part spanned by ``changed`` (p, n) by the same sum of ``made``.

    Changes that are nearly linear combinations of newer ones are left out. ``products`` (p, p + 1)
    are those of :func:`_products`.
    """
    p, n = changed.shape
    L, b, kept = products[:, :p].copy(), products[:, p].copy(), np.zeros(p, dtype=np.bool_)
    # Cholesky factors, row by row
    for j in range(p):
        square = L[j, j]
        for k in range(j):
            if kept[k]:
                for i in range(k):
                    if kept[i]:
                        L[j, k] -= L[j, i] * L[k, i]
                L[j, k] /= L[k, k]
                L[j, j] -= L[j, k] ** 2
                b[j] -= L[j, k] * b[k]
        kept[j] = L[j, j] > _ALIKE * square
        if kept[j]:
            L[j, j] = np.sqrt(L[j, j])
            b[j] /= L[j, j]
    for j in range(p - 1, -1, -1):
        if kept[j]:
            for k in range(j + 1, p):
                if kept[k]:
                    b[j] -= L[k, j] * b[k]
            b[j] /= L[j, j]
            for i in range(n):
                g[i] += b[j] * (made[j, i] - changed[j, i])
