"""Equilibrium and small vibrations of a body in a reduction basis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, whole
from fem_lie._summary import Summarised
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduction.basis import Basis
from fem_lie.reduction.linearised import LinearisedBody, ReducedForces
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.states import Displaced
from fem_lie.scene import Scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.refactorisation import Refactorisation


def reduced_frequencies(
    scene: Scene, basis: Basis, count: int, *, at: StaticResult | None = None
) -> Array:
    """The lowest angular frequencies of a body in a reduction basis, (count,).

    The full equations linearised about the state, see
    :func:`~fem_lie.solve.stability.vibrations.vibrations`, are projected with ``h = Φ η``. In
    steady rotation the stress of the equilibrium stiffens modes that were computed at rest;
    gyroscopic and centrifugal forces are those of the full mass matrix.

    Args:
        scene: A single body, that of the basis.
        basis: The modes.
        count: Number of frequencies, rad per time.
        at: Equilibrium of the scene, also of a steady rotation; default: the initial configuration.

    Raises:
        ValueError: The basis is of another body, or has too few modes; the state is no equilibrium.
    """
    instance(basis, Basis, "basis", "a Basis")
    whole(count, "count")
    if count > len(basis):
        raise ValueError(f"count must be at most {len(basis)}, the number of modes, got {count}")
    found = LinearisedBody(scene, at)
    if found.body is not basis.body:
        raise ValueError(
            f"the basis belongs to {basis.body.label}, which is not the body of the scene"
        )
    V = found.unknowns_of(basis.modes).T
    V, _ = np.linalg.qr(V)
    pencil, m = found.pencil, len(basis)
    M, K = V.T @ (pencil.M @ V), V.T @ (pencil.K @ V)
    C = np.zeros_like(M) if pencil.C is None else V.T @ (pencil.C @ V)
    A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])
    B = scipy.linalg.block_diag(np.eye(m), M)
    rates = np.abs(scipy.linalg.eigvals(A, B).imag)
    return np.asarray(np.sort(rates)[::2][:count])


_MOST = 30
_CONVERGED = 1e-9  # relative to the first residual
_STEP = 1e-6  # increment for the numerical derivative, relative to the size of the body


@dataclass(frozen=True, eq=False, repr=False)
class ReducedEquilibrium(Summarised, Displaced):
    """An equilibrium of a reduced-order body.

    Attributes:
        coordinates: Modal coordinates ``η``, shape (m,).
        frames: Frames of all nodes, shape (n, 4, 3).
        error: Estimate of the largest distance of a node from its position in the full model: the
            displacement of the body at rest due to the residual forces.
        iterations: Number of linear solutions in all load steps.
        info: The body.
    """

    coordinates: Array
    frames: Array
    error: float
    iterations: int
    info: SceneInfo


def reduced_statics(scene: Scene, basis: Basis, *, load_steps: int = 1) -> ReducedEquilibrium:
    """Equilibrium with motions ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)`` under the full loads, by Newton's method.

    Forces are those of all cells: there are few unknowns, but the residual costs as much as in the
    full model.

    Args:
        scene: A single clamped body along a line, that of the basis, with loads.
        basis: Modes that are zero at clamps.
        load_steps: Number of equal load steps.

    Raises:
        ValueError: The scene has other bodies or joints; no load acts.
        ConvergenceError: Newton's method did not converge.
    """
    instance(basis, Basis, "basis", "a Basis")
    whole(load_steps, "load_steps")
    reduced = ReducedForces(scene, basis)
    coordinates: Array = np.zeros(len(basis))
    iterations = 0
    reduced.load(1.0)
    size = float(np.linalg.norm(reduced.residual(coordinates)))
    if size == 0.0:
        raise ValueError("no load acts on the modes")
    for part in range(1, load_steps + 1):
        reduced.load(part / load_steps)
        coordinates, needed = _newton(reduced, coordinates, size)
        iterations += needed
    error = _beyond(scene, reduced.forces(coordinates))
    info = SceneInfo.of([basis.body])
    return ReducedEquilibrium(coordinates, reduced.frames(coordinates), error, iterations, info)


def _beyond(scene: Scene, forces: Array) -> float:
    """Largest displacement of the body at rest due to forces (n, 6)."""
    rest = LinearisedBody(scene, None, loaded=True)
    vector = scipy.sparse.linalg.spsolve(rest.pencil.K.tocsc(), (forces * rest.weight)[rest.free])
    moved = rest.modes_of(vector[np.newaxis])[0, :, :3]
    return float(np.linalg.norm(moved, axis=1).max())


def _newton(reduced: ReducedForces, coordinates: Array, size: float) -> tuple[Array, int]:
    """Coordinates at which the residual is round-off of ``size``, and the number of iterations."""
    equilibrium = _Equilibrium(reduced, coordinates.copy(), _CONVERGED * size)
    ended = iterate(equilibrium, _MOST)
    if not ended.converged:
        raise ConvergenceError(
            f"no equilibrium with {len(coordinates)} modes after {_MOST} iterations: try more "
            "load_steps"
        )
    return equilibrium.found, ended.iterations


class _Equilibrium(Iterated):
    """Equilibrium of a reduced-order body; it converges to round-off.

    Attributes:
        found: Modal coordinates, shape (m,).
    """

    def __init__(self, reduced: ReducedForces, start: Array, bound: float) -> None:
        self._reduced, self.found, self._bound = reduced, start, bound
        self._residual: Array
        self._tangent: Array

    def evaluate(self, iteration: int) -> bool:
        self._residual = self._reduced.residual(self.found)
        return bool(np.linalg.norm(self._residual) <= self._bound)

    def refactorise(self, update: Refactorisation) -> None:
        self._tangent = _matrix(self._reduced, self.found)

    def correct(self) -> float:
        """Solve for a correction and apply it; returns its norm."""
        step = np.linalg.solve(self._tangent, self._residual)
        self.found -= step
        return float(np.linalg.norm(step))

    def judge(self, size: float) -> Verdict:
        return Verdict.GOES_ON


def _matrix(reduced: ReducedForces, at: Array) -> Array:
    """Derivative of the residual by central differences, (m, m)."""
    reach = np.abs(reduced.basis.modes).max(axis=(1, 2))
    steps = np.diag(_STEP * reduced.basis.body.model.size / reach)
    columns = [
        (reduced.residual(at + step) - reduced.residual(at - step)) / (2.0 * step.sum())
        for step in steps
    ]
    return np.array(columns).T
