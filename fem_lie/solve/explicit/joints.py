r"""Joints in explicit steps: multipliers with block-diagonal inertia (RATTLE, on the group).

With the constraint Jacobian ``B`` on the twists of nodes a step is::

    p ← p − ½ h f(H₀) − B(H₀)ᵀ μ,    H₁ = H₀ moved for h with p,     Φ(H₁) = 0
    p ← p − ½ h f(H₁) − B(H₁)ᵀ ν,    B(H₁) v₁ = 0

The impulses ``μ`` and ``ν`` solve small systems with ``B M⁻¹ Bᵀ``; ``μ`` is iterated down to
round-off. The step is symmetric and variational like that without joints, position and velocity
constraints hold at its ends, and momenta are exact (Andersen, J. Comput. Phys. 52 (1983) 24).
Reported multipliers are those of the equations of motion there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from fem_lie._arrays import Array
from fem_lie._state import Stateful, attributes
from fem_lie.solve.convergence import constraint_scaling
from fem_lie.solve.explicit import nodes
from fem_lie.solve.explicit.stable import in_axes
from fem_lie.system.equations import Equations, TimeState

_MOST = 50
_FINE, _ROUND_OFF_LEVEL, _FALLS = 1e-15, 1e-11, 0.5
"""Constraint violations, over the length of the model, that are zero; that are round-off if they do
not decrease; and the ratio above which they do not."""


class _Rows(NamedTuple):
    """Constraints at frames: ``B`` and the factors of ``B M⁻¹ Bᵀ``, ``None`` without any."""

    B: sp.csr_matrix
    factors: SuperLU | None

    def solve(self, b: Array) -> Array:
        """Solution with ``B M⁻¹ Bᵀ``."""
        return b if self.factors is None else np.asarray(self.factors.solve(b))


class Joints(Stateful):
    """Keeps constraints closed in explicit steps.

    Attributes:
        left: Constraint violation after the last step, over the length of the model.
    """

    STATE = attributes("impulses")

    def __init__(self, equations: Equations, masses: nodes.Masses, decay: Array) -> None:
        """Set up without computing anything.

        Args:
            equations: Equations of the scene, with lumped inertia.
            masses: Lumped inertia of its nodes.
            decay: Decay of momenta over half a step, see :func:`.nodes.decay`.
        """
        self._decay = decay
        unknowns = equations.unknowns
        n, m = unknowns.moving, unknowns.m
        self._equations, self._masses, self._n = equations, (*masses,), n
        held = unknowns.held | (masses.ways == nodes.STILL)[:, np.newaxis]
        M = in_axes(masses)
        M[held], M.swapaxes(1, 2)[held] = 0.0, 0.0
        M[:, np.arange(6), np.arange(6)] += held
        inverse = np.linalg.inv(M)
        inverse[held], inverse.swapaxes(1, 2)[held] = 0.0, 0.0
        self._light = sp.bsr_matrix((inverse, np.arange(n), np.arange(n + 1))).tocsr()
        self._measure = constraint_scaling(unknowns)
        self._rest, self._none, self._one = np.zeros((n, 6)), np.zeros(m), np.ones(m)
        self._r, self._v = np.zeros(unknowns.size), np.zeros((n, 6))
        self.impulses, self.left = np.zeros(m), 0.0
        self._rows: _Rows | None = None

    @property
    def open(self) -> str:
        """Why the last step failed, for messages."""
        return f"joints were left open by {self.left:.2g} of the model; try a smaller step"

    def _at(self, H: Array) -> _Rows:
        B = self._equations.constraints(H).jacobian
        return _Rows(B, splu((B @ self._light @ B.T).tocsc()) if B.shape[0] else None)

    def _weigh(self, H: Array, v: Array) -> Array:
        """Forces and violations at frames ``H`` and twists ``v``, (6 n + m,)."""
        state = TimeState(H, v, self._rest, self._none)
        self._equations.residual(state, self._one, self._r)
        return self._r

    def _push(self, rows: _Rows, impulses: Array, H: Array, p: Array) -> None:
        nodes.kick(self._masses, H, rows.B.T @ impulses, 1.0, p)

    def step(self, h: float, H: Array, p: Array, r: Array, weigh: Callable[[], None]) -> bool:
        """Make a step in place; return whether the joints could be kept closed.

        Args:
            h: Step size.
            H: Frames of all nodes, ground and prescribed motions.
            p: Momenta, (n, 6).
            r: Forces at the start on entry, at the end on return, (≥ 6 n,).
            weigh: Evaluates these forces at the frames.
        """
        rows, shared = self._rows or self._at(H), self._equations.shared
        nodes.kick(self._masses, H, r, 0.5 * h, p)
        start, free, previous = H.copy(), p.copy(), np.inf
        for _ in range(_MOST):
            H[:], p[:] = start, free
            self._push(rows, self.impulses, H, p)
            nodes.decay(self._decay, p)
            nodes.drift(self._masses, p, h, H)
            nodes.decay(self._decay, p)
            if not shared.all(bool(np.isfinite(p).all() and np.isfinite(H).all())):
                self.left = np.inf
                if not shared.largest(float(np.abs(self.impulses).max(initial=0.0))):
                    return False
                # impulses of the last step, on long arms of light bodies, rotate them too far
                self.impulses[:] = 0.0
                continue
            wrong = self._equations.constraints(H).values
            self.left = shared.largest(float(np.abs(wrong * self._measure).max(initial=0.0)))
            at_round_off = self.left <= _ROUND_OFF_LEVEL and self.left > _FALLS * previous
            if self.left <= _FINE or at_round_off:
                weigh()
                self._rows = self._at(H)
                nodes.kick(self._masses, H, r, 0.5 * h, p)
                self.project(H, p)
                return True
            self.impulses += rows.solve(wrong) / h
            previous = self.left
        return False

    def project(self, H: Array, p: Array) -> None:
        """Remove the part of momenta that violates velocity constraints."""
        rows = self._rows or self._at(H)
        for _ in range(2):
            nodes.twists(self._masses, H, p, self._v)
            self._push(rows, rows.solve(rows.B @ self._v.ravel()), H, p)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore a state, and recompute the constraint rows at its frames."""
        super().restore(kept)
        self.restart()

    def restart(self) -> None:
        """Recompute the constraint rows at the current frames."""
        self._rows = None

    def forces(self, H: Array, v: Array) -> tuple[Array, Array]:
        """Accelerations, (n, 6), and multipliers, (m,), of the equations of motion."""
        rows, n = self._rows or self._at(H), self._n
        free = -(self._light @ self._weigh(H, v)[: 6 * n])
        twists = np.zeros((len(H), 6))
        twists[:n] = v
        _, second = self._equations.constraints(H).rates(twists)
        multipliers = rows.solve(rows.B @ free + second)
        return (free - self._light @ (rows.B.T @ multipliers)).reshape(n, 6), multipliers
