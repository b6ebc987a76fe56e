"""Stability of equilibrium from the factorisation and the spectrum of the tangent stiffness.

At equilibrium under conservative loads the tangent stiffness in local increments is symmetric. The
number of negative pivots of its ``L D Lᵀ`` is that of its negative eigenvalues (Sylvester's law of
inertia): the equilibrium is stable if it is zero. The saddle-point matrix with m independent
constraints has m further negative pivots. (J. M. T. Thompson & G. W. Hunt, A General Theory of
Elastic Stability, 1973.)

For non-conservative loads, such as moments about fixed axes, the sign of the determinant counts,
and the mode is the null vector of the unsymmetric tangent, see :mod:`fem_lie.linear.pivots`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.pivots import inertia
from fem_lie.linear.spectra.free_unknowns import free_unknowns
from fem_lie.linear.spectra.pencil import Pencil, RigidParts
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.parts.part_scene import ScenePart
from fem_lie.results.gathering import WholeScene
from fem_lie.scene import Scene
from fem_lie.solve.stability.vibrations import largest_elongation, node_lengths, scaled
from fem_lie.solve.statics.follow import SceneEquilibrium
from fem_lie.solve.statics.unstable import HELD, FreeMotions, tangent_csr
from fem_lie.system.equations import LinearState, Plan

_SEED, _REPEATS = 1, 30  # of the inverse iteration: seed of its first vector, and its length
_LOOSE = 1e-14  # over the largest stiffness
_ROUND_OFF = 1e-12  # of forces without loads, over the largest stiffness
_PRESTRESS = "prestress deforms the scene without its loads"
_BY_STATICS = (
    "Use load steps, fl.statics(scene, levels=...), whose negative_pivots say from which level on "
    "the equilibrium is unstable"
)
_REFINED = 2  # number of refinements of a solution, with residuals in higher precision


class StableEquilibrium(SceneEquilibrium):
    """Scene along its path, with the inertia (signs of eigenvalues) of its tangent stiffness.

    Attributes:
        weight: Units of the unknowns of the nodes: lengths and radians, shape (6 n,).
        unknowns: The free unknowns, of which this rank may have a part.
    """

    def __init__(
        self,
        scene: Scene,
        prefix: str,
        part: ScenePart | None = None,
        *,
        linearised_stress: bool = True,
    ) -> None:
        """Build the equations.

        Args:
            scene: The scene.
            prefix: Prefix of the linear solver's options.
            part: What this rank has of the scene, if it is divided.
            linearised_stress: Iterate on the stress by linearised updates; otherwise plain Newton.
        """
        super().__init__(scene, prefix, part)
        self._linearised_stress, self._at_start = linearised_stress, self._multipliers.copy()
        self.weight = self.equations.unknowns.units
        self._free = np.flatnonzero(~self.equations.unknowns.held.ravel())
        self.free_unknowns = free_unknowns(self.equations.shared, self._free)

    def factorise(self, factor: float) -> None:
        """Factorise the tangent stiffness, and count its negative eigenvalues."""
        if not self._linearised_stress:
            self._forces_known = False
            self.equations.history_variables.update_stress(self._H)
        super().factorise(factor)

    def solve_raw(self, b: Array) -> Array:
        """Solve with the last tangent in its own unknowns, along fixed axes at some supports."""
        self._solver.right_hand_side[:] = b
        self._solver.solve()
        return self._solver.solution.copy()

    def check_start(self, factor: float) -> None:
        """Raise ``ValueError`` if the tangent stiffness is singular in the current state."""
        self._fill(factor)
        A = tangent_csr(self.equations)
        size: Array = A.diagonal()
        self._shared.sum(size[: 6 * self._moving].reshape(-1, 6))
        scale = sp.diags(1.0 / np.sqrt(np.maximum(np.abs(size), 1e-300)))
        if self._shared.any(self.equations.unknowns.m > 0):
            scale = sp.diags(self.equations.matrix.units)
        try:
            zero = inertia((0.5 * scale @ (A + A.T) @ scale).tocsr(), self._shared)[1]
        except SingularMatrixError:
            zero = 1
        loose = self._loose_motions()
        if zero or loose:
            search = FreeMotions(self.equations)
            free = search.unresisted(search.allowed(self._H), np.zeros(6 * self._moving))
            why = f": {search.freedom(free)}" if len(free) else f". {HELD}"
            raise ValueError(
                f"the path has no start: the tangent at load factor {factor:g} is singular{why}"
            )

    def relax(self) -> None:
        """Move to the equilibrium without loads, if cables or springs have a prestress.

        Raises:
            ConvergenceError: There is none near the initial configuration, or it is unstable.
        """
        internal, _ = self.forces()
        self._fill(0.0)
        forces = np.abs(self.weight * internal[: 6 * self._moving])[self._free]
        largest = self._shared.largest(float(forces.max(initial=0.0)))
        if largest <= _ROUND_OFF * self.largest_entry(self.pencil()[0]):
            return
        if not self._converges(0.0):
            raise ConvergenceError(f"{_PRESTRESS}, and no equilibrium is near it. {_BY_STATICS}")
        self.factorise(0.0)
        if self.negative_pivots():
            raise ConvergenceError(f"{_PRESTRESS}, and it buckles without loads. {_BY_STATICS}")

    def _loose_motions(self) -> int:
        """Number of motions without strain that joints allow and nothing resists."""
        K, B = self.pencil()
        motions = self.equations.constraints(self._H).rigid_motions(self.weight)
        basis = motions.basis[:, motions.of_frames]
        Z = RigidParts(K, K, K, basis, self.free_unknowns).mechanisms(B)
        if not len(Z):
            return 0
        products = self.free_unknowns.total(0.5 * Z @ ((K + K.T) @ Z.T))
        resists = np.abs(np.linalg.eigvalsh(products))
        return int((resists <= _LOOSE * self.largest_entry(K)).sum())

    def pencil(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Tangent stiffness of the free unknowns in their units, and normalised constraint rows."""
        A, n, free = tangent_csr(self.equations), 6 * self._moving, self._free
        weights = sp.diags(self.weight[free])
        K = (weights @ A[free][:, free] @ weights).tocsr()
        B = (A[n:][:, free] @ weights).tocsr()
        # their scale is that for the solution of increments
        length = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        length[length == 0.0] = 1.0  # a redundant constraint on held unknowns only
        return K, (sp.diags(1.0 / length) @ B).tocsr()

    def critical_modes(self, factor: float, count: int, prefix: str) -> tuple[Array, Array]:
        """Smallest eigenvalues of the tangent stiffness, and increments of nodes, shape (k, n, 6).

        For non-conservative loads it is one, of least absolute value, and its right eigenvector.
        """
        if not self.equations.unknowns.has_potential:
            value, x = self.smallest(factor)
            return np.array([value]), self.increments(x)[np.newaxis]
        self._fill(factor)
        K, B = self.pencil()
        K = (0.5 * (K + K.T)).tocsr()
        count = min(count, K.shape[0] - B.shape[0])
        ones = np.ones((1, K.shape[0]))
        unit = sp.diags(self.free_unknowns.owned(ones)[0], format="csr")
        s, vectors, _ = smallest(
            Pencil(unit, None, K, B, None, self.free_unknowns), count, 0.0, prefix
        )
        values = -(s**2).real
        return values, np.array([self.increments(vector.real) for vector in vectors])

    def smallest(self, factor: float) -> tuple[float, Array]:
        """Eigenvalue of least absolute value of the tangent, and its vector of free unknowns.

        Both are in the units of the unknowns.
        """
        self.factorise(factor)
        value, x = self.inverse_iteration(None, _REPEATS)
        return value, x[self._free]

    def inverse_iteration(self, start: Array | None, repeats: int) -> tuple[float, Array]:
        """Eigenvalue of least absolute value of the last factorised tangent stiffness.

        Args:
            start: Initial guess of its vector, shape (6 n,); ``None``: none.
            repeats: Number of linear solutions.

        Returns:
            The eigenvalue and its unit vector, shape (6 n,), in the units of the unknowns.
        """
        n = len(self.weight)
        if start is None:
            free = ~self.equations.unknowns.held.ravel()
            start = np.random.default_rng(_SEED).standard_normal(n) * free
            self._shared.take_from_owners(start.reshape(-1, 6))
        value, right = np.nan, np.zeros(self.equations.unknowns.size)
        x: Array = start
        for _ in range(repeats):
            x = np.asarray(x / self._norm(x))
            right[:n] = x / self.weight
            y = self.solve_raw(right)[:n] / self.weight
            value, x = 1.0 / self.dot(self._of_owned(x), y.reshape(-1, 6)), y
        return value, np.asarray(x / self._norm(x))

    def _of_owned(self, x: Array) -> Array:
        """Unknowns of the nodes (6 n,) as rows, with zeros at nodes that other ranks own."""
        return x.reshape(-1, 6) * self._shared.owned[:, np.newaxis]

    def _norm(self, x: Array) -> float:
        own = self._of_owned(x)
        return float(np.sqrt(self.dot(own, own)))

    def increments(self, vector: Array) -> Array:
        """Local increments of the nodes, (n, 6), from a vector of free unknowns in their units."""
        h = np.zeros(6 * self._moving)
        h[self._free] = self.weight[self._free] * vector
        found = h.reshape(-1, 6)
        self.equations.supports.rotate_back(self._H, found)
        return found

    def solve_free(self, b: Array) -> Array:
        """Solve with the last tangent for free unknowns in their units, shape (free,)."""
        right = np.zeros(self.equations.unknowns.size)
        right[self._free] = b / self.weight[self._free]
        return np.asarray(self.solve_raw(right)[self._free] / self.weight[self._free])

    def largest(self, dx: Array) -> float:
        """Largest translation over the diameter, or rotation, of increments ``dx``."""
        return self.maximum(self.twists(dx)) / self.diameter

    @cached_property
    def whole(self) -> WholeScene:
        """The whole scene, for results."""
        return WholeScene(self.equations.info, self.equations.part)

    def frames(self, H: Array) -> Array:
        """A copy of the frames of all nodes of the whole scene, from those of the equations."""
        return self.whole.on_all(self.equations.report(H).frames[np.newaxis])[0].copy()

    def largest_entry(self, A: sp.csr_matrix) -> float:
        """Largest entry of the matrices (n, n) of all parts."""
        return self._shared.largest(float(abs(A).max()) if A.nnz else 0.0)

    def largest_strain(self, dx: Array) -> float:
        """Largest elongation of a cell edge over its length due to increments ``dx``."""
        report = self.equations.report(self._H, dx[: 6 * self._moving].reshape(-1, 6))
        bodies = self.equations.unknowns.bodies
        return self._shared.largest(largest_elongation(bodies, report.frames, report.twists))

    def solve_finely(self, b: Array) -> Array:
        """Solve with the last tangent, refined by residuals in higher than double precision.

        The axial forces of slender members are small compared to their axial stiffness times their
        displacements, and a plain solution loses as many digits of them.
        """
        A, x = (
            tangent_csr(self.equations).astype(np.longdouble),
            np.zeros(len(b), dtype=np.longdouble),
        )
        own = b.copy()
        own[: 6 * self._moving] = self._of_owned(b[: 6 * self._moving]).ravel()
        for _ in range(1 + _REFINED):
            left = own - A @ x
            self._shared.sum(left[: 6 * self._moving].reshape(-1, 6))
            x += self.solve_raw(left.astype(np.float64))
        found = np.asarray(x, dtype=np.float64)
        self.equations.supports.rotate_back(self._H, found[: 6 * self._moving].reshape(-1, 6))
        return found

    def linear_state(self, dx: Array) -> LinearState:
        """Stress and forces of linear theory along increments ``dx`` from the current state."""
        self._forces_known, self._at_start = False, self._multipliers.copy()
        self._find(0.0)
        return self.equations.linear_state(self._H, dx, self._found)

    def stressed(self, state: LinearState, factor: float) -> sp.csr_matrix:
        """Tangent with ``factor`` times stress, forces, multipliers and loads of linear theory.

        The nodes stay where they are.
        """
        self._forces_known = False
        state.apply(factor)
        self._multipliers[:] = self._at_start + self._scale * factor * state.multipliers
        self._find(factor)
        state.add_forces(factor, self._found)
        self.equations.fill(self._now, self._found, Plan(self._zero, self._scale))
        state.apply(0.0)
        return self.pencil()[0]

    @property
    def current_frames(self) -> Array:
        """Frames of all nodes of the whole scene in the current state, shape (N, 4, 3)."""
        return self.frames(self._H)

    def all_nodes(self, shapes: Array) -> tuple[Array, Flags]:
        """Scaled increments of all nodes of the whole scene, and which modes only rotate.

        Args:
            shapes: Increments of the master nodes of the part, shape (k, n, 6).
        """
        unknowns = self.equations.unknowns
        own = np.array([self.equations.report(self._H, shape).twists for shape in shapes])
        twists = self.whole.on_all(own.reshape(len(shapes), unknowns.total, 6))
        lengths = node_lengths(self.whole.bodies(unknowns.bodies))
        found = [scaled(shape, lengths) for shape in twists]
        moved = np.array([shape for shape, _ in found]).reshape(-1, *twists.shape[1:])
        return moved, np.array([turns for _, turns in found], dtype=np.bool_)
