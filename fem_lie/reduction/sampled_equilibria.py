"""Equilibrium of a reduced-order body with forces and tangent stiffness of sampled cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance, numbers
from fem_lie._summary import Summarised
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduction.basis import Basis
from fem_lie.reduction.energy_sampling import CellSample, ReducedCells, ReducedNodes, summed
from fem_lie.reduction.linearised import equations_of
from fem_lie.results.states import Displaced
from fem_lie.scene import Scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.system.equations import Equations
from fem_lie.system.nodes.sums import load_tangent, load_vector

_MOST = 30

_CONVERGED = 1e-7  # norm of the last correction relative to the coordinates

_HELD = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class SampledEquilibria(Summarised, Displaced):
    """Equilibria of a reduced-order body.

    Attributes:
        coordinates: Modal coordinates ``η`` of each, shape (k, m).
        frames: Frames of all nodes, shape (k, n, 4, 3).
        iterations: Number of linear solutions from the start up to each equilibrium, shape (k,).
        info: The body.
    """

    coordinates: Array
    frames: Array
    iterations: Indices
    info: SceneInfo


class ReducedLoads:
    """Nodal loads, evaluated only at the nodes that they act on."""

    def __init__(self, equations: Equations, basis: Basis) -> None:
        """Find these nodes."""
        now = equations.system.lasting_loads
        acting = [each.reshape(len(each), -1).any(axis=1) for each in now]
        own_nodes = equations.unknowns.bodies[basis.body]
        own = np.flatnonzero(np.any(acting, axis=0)[own_nodes])
        self._nodes = ReducedNodes(basis, own)
        self._dead, self._moment, self._following = (each[own_nodes[own]] for each in now)
        self._kinds = equations.unknowns.kinds[own_nodes[own]]

    def forces_and_matrix(self, coordinates: Array) -> tuple[Array, Array]:
        """Reduced forces (m,) opposite to the loads, and their derivative (m, m)."""
        nodes, count = self._nodes, len(self._kinds)
        moved = nodes.at(coordinates)
        forces, K = np.zeros((count, 6)), np.zeros((count, 6, 6))
        load_vector(self._kinds, moved.frames, self._dead, self._moment, self._following, forces)
        load_tangent(self._kinds, moved.frames, -self._dead, self._moment, np.arange(count), K)
        motions = nodes.motions(moved)
        matrix = summed(motions, K @ motions) + nodes.bent(moved, -forces)
        return -nodes.pulled(moved, forces).sum(axis=0), matrix


def sampled_statics(
    scene: Scene, sample: CellSample, *, levels: Sequence[float] = (1.0,)
) -> SampledEquilibria:
    """Equilibria with motions ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)``, by Newton's method with sampled cells.

    The cost of an iteration is that of these cells and of the nodes with loads.

    Args:
        scene: A single clamped body, that of the sample, with loads on nodes.
        sample: Cells from :func:`ecsw`, with modes that are zero at clamps.
        levels: Load factors, one equilibrium after the other.

    Raises:
        ValueError: The scene has other bodies or joints, loads that depend on more than the frame
            of a node, or no loads; a mode moves fixed degrees of freedom.
        ConvergenceError: Newton's method did not converge.
    """
    instance(sample, CellSample, "sample", "cells with weights, of ecsw")
    steps = numbers(levels, "levels")
    if steps.ndim != 1 or not len(steps):
        raise ValueError(f"levels must be factors, one after the other, got {levels!r}")
    loads, cells = loads_of(scene, sample.basis), sample.reduced_cells()
    return equilibria(cells, loads, sample.basis, steps)


def equilibria(
    cells: ReducedCells, loads: ReducedLoads, basis: Basis, levels: Array
) -> SampledEquilibria:
    """Equilibria at all levels, each starting from the one before."""
    η: Array = np.zeros(len(basis))
    found, iterations = list[Array](), list[int]()
    for level in levels:
        η, needed = _newton(cells, loads, level, η)
        found.append(η)
        iterations.append(needed)
    coordinates = np.array(found)
    increments = np.einsum("km,mni->kni", coordinates, basis.modes)
    frames = np.asarray(lie.se3_retract(basis.body.frames, increments))
    counts = np.cumsum(iterations, dtype=np.int64)
    return SampledEquilibria(coordinates, frames, counts, SceneInfo.of([basis.body]))


def loads_of(scene: Scene, basis: Basis) -> ReducedLoads:
    """Loads on the nodes of the only body; errors as in :func:`sampled_statics`."""
    body, equations = equations_of(scene)
    unknowns, system = equations.unknowns, equations.system
    if body is not basis.body:
        raise ValueError(
            f"the basis belongs to {basis.body.label}, which is not the body of the scene"
        )
    if unknowns.total != unknowns.moving:
        raise ValueError(
            f"nodes of {body.label} are rigidly attached to others, which reduced forces do not "
            "support"
        )
    if unknowns.drilling:
        raise ValueError(f"{body.label} has drilling rotations, which sampled cells do not support")
    strains = system.load_cases.contents[1]
    if strains or any(not term.of_bodies or term.load for term in system.terms):
        raise ValueError(
            f"{body.label} has loads or springs other than nodal forces, which sampled cells do "
            "not support"
        )
    mode_vectors = basis.modes.transpose(1, 2, 0)
    held = unknowns.held[unknowns.bodies[body]]
    if body.model.separates_director:
        held = held & ~np.eye(6, dtype=bool)[5]
    if np.abs(mode_vectors[held]).max(initial=0.0) > _HELD * np.abs(mode_vectors).max():
        raise ValueError(f"modes move fixed nodes of {body.label}")
    loads = ReducedLoads(equations, basis)
    if not loads.forces_and_matrix(np.zeros(len(basis)))[0].any():
        raise ValueError("no load acts on the modes")
    return loads


def _newton(
    cells: ReducedCells, loads: ReducedLoads, level: float, start: Array
) -> tuple[Array, int]:
    """Coordinates in equilibrium with the loads times the level, and the number of solutions."""
    equilibrium = _Equilibrium(cells, loads, level, start)
    ended = iterate(equilibrium, _MOST)
    if not ended.converged:
        raise ConvergenceError(
            f"no equilibrium with {len(start)} modes after {_MOST} iterations: try levels in "
            "between"
        )
    return equilibrium.η, ended.iterations


class _Equilibrium(Iterated):
    """Equilibrium of a reduced-order body with sampled cells.

    Attributes:
        η: Modal coordinates, shape (m,).
    """

    def __init__(
        self, cells: ReducedCells, loads: ReducedLoads, level: float, start: Array
    ) -> None:
        self._cells, self._loads, self._level, self.η = cells, loads, level, start
        self._residual: Array
        self._tangent: Array

    def evaluate(self, iteration: int) -> bool:
        """Evaluate forces and their derivatives; residuals alone do not end the iteration."""
        inner, K = self._cells.forces_and_matrix(self.η)
        outer, change = self._loads.forces_and_matrix(self.η)
        self._residual = inner + self._level * outer
        self._tangent = K + self._level * change
        return False

    def refactorise(self, update: Refactorisation) -> None:
        """Nothing to do: the dense tangent is solved with as it is."""

    def correct(self) -> float:
        """Solve for a correction and apply it; returns its norm over that of the coordinates."""
        step = np.linalg.solve(self._tangent, self._residual)
        self.η = self.η - step
        moved = float(np.linalg.norm(step))
        return moved / max(float(np.linalg.norm(self.η)), np.finfo(float).tiny)

    def judge(self, size: float) -> Verdict:
        """Verdict by corrections: round-off of stretching forces exceeds small bending forces."""
        return Verdict.CONVERGED if size <= _CONVERGED else Verdict.GOES_ON
