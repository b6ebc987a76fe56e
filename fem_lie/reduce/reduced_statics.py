"""Equilibrium and small vibrations of a body in a reduced basis."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest, InShapes
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.refactorisation import Update


def reduced_frequencies(
    scene: Scene, basis: Basis, count: int, *, at: StaticResult | None = None
) -> Array:
    """The lowest angular frequencies of motions that have the shapes of a basis, (count,).

    The full equations beside the state, see :func:`~fem_lie.solve.stability.vibrations.vibrations`,
    with ``h = Φ η``: of steady rotation the stress of its equilibrium stiffens the shapes made at
    rest, and gyroscopic and centrifugal forces are those of the full mass matrix.

    Args:
        scene: One body, the basis' own.
        basis: The shapes.
        count: How many, rad per time.
        at: Equilibrium of the scene, of a steady rotation, too; default: the initial frames.

    Raises:
        ValueError: The basis is of another body, or has too few shapes; the state is no
            equilibrium.
    """
    instance(basis, Basis, "basis", "a Basis")
    whole(count, "count")
    if count > len(basis):
        raise ValueError(f"count must be at most {len(basis)}, the number of shapes, got {count}")
    found = BesideRest(scene, at)
    if found.body is not basis.body:
        raise ValueError(f"the basis is of {basis.body.label}, which is not the body of the scene")
    V = found.vectors(basis.shapes).T
    V, _ = np.linalg.qr(V)
    pencil, m = found.pencil, len(basis)
    M, K = V.T @ (pencil.M @ V), V.T @ (pencil.K @ V)
    C = np.zeros_like(M) if pencil.C is None else V.T @ (pencil.C @ V)
    A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])
    B = scipy.linalg.block_diag(np.eye(m), M)
    rates = np.abs(scipy.linalg.eigvals(A, B).imag)
    return np.asarray(np.sort(rates)[::2][:count])


_MOST = 30
_CONVERGED = 1e-9  # of the first residual
_STEP = 1e-6  # of the body's size: differences that give the matrix


class ReducedEquilibrium(NamedTuple):
    """An equilibrium in few shapes.

    Attributes:
        coordinates: ``η``, shape (m,).
        frames: Of all nodes, shape (n, 4, 3).
        error: Estimate of the largest distance of a node from its place with all unknowns: the
            displacement that forces which shapes do not see would make of the body at rest.
        iterations: In all.
    """

    coordinates: Array
    frames: Array
    error: float
    iterations: int


def reduced_statics(scene: Scene, basis: Basis, *, load_steps: int = 1) -> ReducedEquilibrium:
    """Equilibrium under the full loads of motions ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)``, by Newton's method.

    Forces are those of all cells: the unknowns are few, the work of a residual is not.

    Args:
        scene: One body along a line, the basis' own, held by clamps, with loads.
        basis: Shapes that leave clamps where they are.
        load_steps: In how many equal parts the loads are put on.

    Raises:
        ValueError: The scene has other bodies or joints; no load acts.
        ConvergenceError: No equilibrium was found.
    """
    instance(basis, Basis, "basis", "a Basis")
    whole(load_steps, "load_steps")
    reduced = InShapes(scene, basis)
    coordinates: Array = np.zeros(len(basis))
    iterations = 0
    reduced.load(1.0)
    size = float(np.linalg.norm(reduced.residual(coordinates)))
    if size == 0.0:
        raise ValueError("no load acts on the shapes: there is nothing to find")
    for part in range(1, load_steps + 1):
        reduced.load(part / load_steps)
        coordinates, needed = _newton(reduced, coordinates, size)
        iterations += needed
    error = _beyond(scene, reduced.forces(coordinates))
    return ReducedEquilibrium(coordinates, reduced.frames(coordinates), error, iterations)


def _beyond(scene: Scene, forces: Array) -> float:
    """Largest displacement by forces (n, 6) of the body at its initial frames."""
    rest = BesideRest(scene, None, loaded=True)
    vector = scipy.sparse.linalg.spsolve(rest.pencil.K.tocsc(), (forces * rest.weight)[rest.free])
    moved = rest.shapes(vector[np.newaxis])[0, :, :3]
    return float(np.linalg.norm(moved, axis=1).max())


def _newton(reduced: InShapes, coordinates: Array, size: float) -> tuple[Array, int]:
    """Coordinates where the residual is round-off of ``size``, and how often it took."""
    equilibrium = _Equilibrium(reduced, coordinates.copy(), _CONVERGED * size)
    ended = iterate(equilibrium, _MOST)
    if not ended.converged:
        raise ConvergenceError(
            f"no equilibrium with {len(coordinates)} modes after {_MOST} iterations: try more "
            "load_steps"
        )
    return equilibrium.found, ended.iterations


class _Equilibrium(Iterated):
    """Equilibrium of a reduced-order body: the residual is round-off.

    Attributes:
        found: Coordinates, shape (m,).
    """

    def __init__(self, reduced: InShapes, start: Array, bound: float) -> None:
        self._reduced, self.found, self._bound = reduced, start, bound
        self._residual: Array
        self._tangent: Array

    def evaluate(self, iteration: int) -> bool:
        self._residual = self._reduced.residual(self.found)
        return bool(np.linalg.norm(self._residual) <= self._bound)

    def refactorise(self, update: Update) -> None:
        self._tangent = _matrix(self._reduced, self.found)

    def correct(self) -> float:
        """Solve for a correction and apply it; returns its norm."""
        step = np.linalg.solve(self._tangent, self._residual)
        self.found -= step
        return float(np.linalg.norm(step))

    def judge(self, size: float) -> Verdict:
        return Verdict.GOES_ON


def _matrix(reduced: InShapes, at: Array) -> Array:
    """Derivative of the residual by central differences, (m, m)."""
    reach = np.abs(reduced.basis.shapes).max(axis=(1, 2))
    steps = np.diag(_STEP * reduced.basis.body.size / reach)
    columns = [
        (reduced.residual(at + step) - reduced.residual(at - step)) / (2.0 * step.sum())
        for step in steps
    ]
    return np.array(columns).T
