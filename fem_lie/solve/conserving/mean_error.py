"""Local error of one step of a conserving scheme, from quantities of the step itself.

In ``q = (x, d₁, d₂, d₃)`` these schemes are the trapezoidal rule. With the mean acceleration
``A = (V₁ − V)/h`` and the contribution ``g`` of dissipation to the mean velocity::

    q(exact) − q₁ = h²/12 (q̈ − q̈₁) − h g + O(h⁴)

up to the part across the constraints of joints and of rigid directors: the error is its projection
on admissible motions, orthogonal in the metric of inertia. The accelerations at the ends are
unknown, but the forces are known. So the residuals ρ of the equations of motion with ``A`` are
evaluated at both ends and compared in one frame::

    M d̃ = h²/12 (ρ₁ − ρ) − h Lᵀ G g          ρ = Lᵀ G A − forces + Bᵀ λ

with the joint forces λ of the step: their error is across the joints. No earlier step is needed,
and a load that jumps within the step contributes. As in generalised-α, one solution with the frozen
factors gives the error from the defect::

    S e + Bᵀ μ = m M d̃          B e = 0

(The error constant of the trapezoidal rule: Hairer, Nørsett & Wanner, Solving ODEs I, section II.1;
G-orthogonal projection of flat coordinates: Betsch & Leyendecker, IJNME 67 (2006) 499.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.node_types import POSITION_GRADIENT, pull_all_back
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.lie.node_types.node_type import axes
from fem_lie.lie.tuples import load, rotate, rotate_back
from fem_lie.solve.conserving.midpoint.products import accelerations, add_inertia
from fem_lie.solve.conserving.midpoint.reduced_bodies import PackedBodies
from fem_lie.solve.motion.step_log import LargestError, StepError
from fem_lie.system.equations import TimeState

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


class End(NamedTuple):
    """One end of a step.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions.
        V: Velocities of (x, d₁, d₂, d₃) and of products, (n + p, 4, 3).
        time: Time; on the side of the step at a discontinuity.
    """

    H: Array
    V: Array
    time: float


class MeanError:
    """Local errors of the steps of a run."""

    def __init__(self, equations: Equations, mass: Inertia, bodies: PackedBodies) -> None:
        """Set up for equations whose matrix is factorised elsewhere.

        Args:
            equations: Equations of the scene.
            mass: Mass matrix of all nodal coordinates, products last, (n + p).
            bodies: Reduced-order bodies.
        """
        unknowns, n = equations.unknowns, equations.unknowns.moving
        self._equations, self._size, self._kinds = equations, 6 * n, unknowns.kinds
        self._mass, self._bodies, self._moving = mass, bodies, n
        self._q = np.zeros((len(mass.indptr) - 1, 4, 3))
        self._twist, self._still = np.zeros((2, n, 6))
        self._r, self._ones = np.zeros(unknowns.size), np.ones(unknowns.m)
        self._inertia, self._largest = np.zeros((n, 6)), LargestError(equations)
        start = TimeState(equations.start.frames, self._twist, self._still, np.zeros(unknowns.m))
        self._found = equations.residual(start, self._ones, self._r)

    def load(
        self,
        h: float,
        start: End,
        end: End,
        delta: Array,
        multipliers: Array,
        mass: float,
        r: Array,
    ) -> None:
        """Right-hand side of the equations of the error, into ``r``.

        Args:
            h: Step size.
            start: Start of the step.
            end: End of the step; loads keep their values there.
            delta: Increments of all nodal coordinates, (n + p, 4, 3).
            multipliers: Lagrange multipliers of the step.
            mass: Factor of the mass matrix in the iteration matrix that will be used.
            r: Right-hand side, shape (size,), overwritten.
        """
        equations, size = self._equations, self._size
        A = np.asarray((end.V - start.V) / h, dtype=np.float64)
        before = self._residual(start, A, multipliers)[:size].copy()
        r[:] = self._residual(end, A, multipliers)
        forces = r[:size].reshape(-1, 6)
        factor = h * h / 12.0 * mass
        _compare(self._kinds, start.H, end.H, before.reshape(-1, 6), factor, forces)
        self._q[:] = delta - 0.5 * h * (start.V + end.V)
        self._add_inertia(end.H, -mass, forces)
        forces[equations.unknowns.held] = 0.0
        r[size:] = 0.0

    def _residual(self, at: End, A: Array, multipliers: Array) -> Array:
        """ρ, in the nodes' frames."""
        equations, twist, n = self._equations, self._twist, self._moving
        if equations.unknowns.time_dependent:
            equations.prescribed(at.time).act()
        twist[:] = 0.0
        pull_all_back(self._kinds, at.H, at.V[:n], 1.0, twist.reshape(-1))
        # the directors of a frame contain each part of the rotation twice
        twist[self._kinds < POSITION_GRADIENT, 3:] *= 0.5
        now = TimeState(at.H, twist, self._still, multipliers)
        equations.residual(now, self._ones, self._r, self._found)
        accelerations(self._kinds, self._bodies, at.H, twist, self._q)
        self._q[:] = A - self._q
        self._add_inertia(at.H, 1.0, self._r[: self._size].reshape(-1, 6))
        return self._r

    def _add_inertia(self, H: Array, factor: float, forces: Array) -> None:
        """Add ``factor Lᵀ G q`` of all parts of a divided scene at frames ``H``, (n, 6)."""
        own = self._inertia
        own[:] = 0.0
        add_inertia(self._kinds, self._mass, self._bodies, H, self._q, factor, own)
        self._equations.shared.sum(own)
        forces += own

    def of(self, dx: Array) -> StepError:
        """The error, from the solution of these equations, the same on all ranks."""
        return self._largest.of(dx[: self._size].reshape(-1, 6))


@compiled
def _compare(kinds: Indices, H: Array, H1: Array, before: Array, factor: float, r: Array) -> None:
    """``r = factor (r − before)``, (n, 6): forces along the axes of ``H1``, moments in the body.

    Both are O(h), so moments may be compared in body axes: in a bar that is ten thousand times
    stiffer in bending than in torsion, the rotation of bending moments then causes no twist.
    """
    for i in range(r.shape[0]):
        a1, a2, a3 = axes(kinds[i], H[i])
        b1, b2, b3 = axes(kinds[i], H1[i])
        for at in (0, 3):
            f = load(before[i], at)
            if at == 0 or kinds[i] >= POSITION_GRADIENT:
                f = rotate_back(b1, b2, b3, rotate(a1, a2, a3, f))
            for k in range(3):
                r[i, at + k] = factor * (r[i, at + k] - f[k])
