"""How wrong one step of a Lie-group integrator is, from what the step itself has computed.

The increment of the exact motion from the same start is, with ``v̇₁`` at the end of the step::

    d(exact) = h v + ½ h² v̇ + (h²/6) (v̇₁ − v̇) + (h³/12) ad(v) v̇ + O(h⁴)

and :func:`defects` is that minus the scheme's ``d``: third order, ratio to the true error → 1 for a
free body. The bracket is that of the group: all of it on SE(3), that of the rotations on R³×SO(3);
the Cayley map has ``−h³ v̂³/12`` more. (The series of the logarithm: Iserles, Munthe-Kaas, Nørsett &
Zanna, Acta Numerica 9 (2000) 215; its difference from a scheme: Arnold, Brüls & Cardona, Numer.
Math. 129 (2015) 149.)

A body that is held cannot err so: what is across the joints is no error, since positions satisfy
the constraints, and stiff bodies resist. With the iteration matrix ``S`` and its factor
``m = ∂v̇₁/∂d`` of the mass matrix, subtracting the scheme's equations from the exact ones leaves::

    S e + Bᵀ μ = m M d̃          B e = 0          (d̃: the defect)

so one solution with the kept factors turns the defect into the error ``e``, of all schemes whose
end of a step satisfies the equations of motion. Waves that a step does not resolve are filtered
by it, as in stiff ordinary differential equations (Hairer & Wanner, Solving ODEs II, section IV.8).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.kinds import bend, from_group, push_all
from fem_lie.solve.motion.step_error import StepError, add_inertia_forces, largest

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


@compiled
def defects(
    h: float, kinds: Indices, H1: Array, before: Array, d: Array, vdot1: Array, out: Array
) -> None:
    """Exact increments minus ``d``, in the nodes' frames at the end of the step; (n, 6).

    Args:
        h: Step size.
        kinds: What each node is.
        H1: Frames at the end of the step.
        before: ``v`` and ``v̇`` of the group at its start, shape (≥ 2, n, 6).
        d: Increments of the step.
        vdot1: ``v̇`` at its end.
        out: Overwritten.
    """
    bent = np.empty(6)
    for i in range(kinds.shape[0]):
        v, vdot = before[0, i], before[1, i]
        for k in range(6):
            jump = vdot1[i, k] - vdot[k]
            out[i, k] = h * v[k] + h * h * (0.5 * vdot[k] + jump / 6.0) - d[i, k]
        bend(kinds[i], v, vdot, bent)
        for k in range(6):
            out[i, k] += h * h * h / 12.0 * bent[k]
        from_group(kinds[i], H1[i], out[i])


class TimeError:
    """The error of each step of one run.

    Attributes:
        defect: :func:`defects` of the last step.
    """

    def __init__(self, equations: Equations) -> None:
        """For equations whose matrix is factorised elsewhere."""
        n, held = equations.unknowns.moving, equations.unknowns.held
        self._equations, self._kinds = equations, equations.unknowns.kinds
        self._q = np.zeros((n, 4, 3))
        self._held = held if held.any() else None
        self.defect = np.zeros((n, 6))

    def load(
        self, h: float, before: Array, H1: Array, d: Array, vdot1: Array, mass: float, r: Array
    ) -> None:
        """Right-hand side of the equations of the error, into ``r``.

        Args:
            h: Step size.
            before: ``v`` and ``v̇`` of the group at its start, shape (≥ 2, n, 6).
            H1: Frames at its end.
            d: Its increments.
            vdot1: ``v̇`` at its end.
            mass: Factor of the mass matrix in the iteration matrix that will be used.
            r: Shape (size,), overwritten.
        """
        n = len(self.defect)
        defects(h, self._kinds, H1, before, d, vdot1, self.defect)
        push_all(self._kinds, H1, self.defect, self._q)
        r[:] = 0.0
        forces = r[: 6 * n].reshape(n, 6)
        add_inertia_forces(self._equations, H1, self._q, mass, forces)
        self._equations.supports.turn(H1, forces)
        if self._held is not None:
            forces[self._held] = 0.0

    def of(self, dx: Array) -> StepError:
        """The error, from the solution of these equations."""
        parts = dx[: self.defect.size].reshape(-1, 6)
        return StepError(*largest(parts, self._equations.unknowns.lengths))
