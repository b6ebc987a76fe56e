"""Equilibrium of a body in few shapes with the forces and the matrix of few cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, instance, numbers
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import equations_of
from fem_lie.reduce.ecsw import CellSample, CellsInShapes, NodesInShapes, summed
from fem_lie.scene import Scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.refactorisation import Update
from fem_lie.system.equations import Equations
from fem_lie.system.nodes.sums import load_tangent, load_vector

_MOST = 30

_CONVERGED = 1e-7  # of the coordinates: how far the last solution may have moved them

_HELD = 1e-6


class SampledEquilibria(NamedTuple):
    """Equilibria in few shapes.

    Attributes:
        coordinates: ``η`` of each, shape (k, m).
        frames: Of all nodes, shape (k, n, 4, 3).
        iterations: In all.
    """

    coordinates: Array
    frames: Array
    iterations: int


class LoadsInShapes:
    """Nodal loads, at the nodes that they act on and nowhere else."""

    def __init__(self, equations: Equations, basis: Basis) -> None:
        """Find these nodes."""
        now = equations.system.lasting_loads
        acting = [each.reshape(len(each), -1).any(axis=1) for each in now]
        place = equations.unknowns.bodies[basis.body]
        own = np.flatnonzero(np.any(acting, axis=0)[place])
        self._nodes = NodesInShapes(basis, own)
        self._dead, self._moment, self._following = (each[place[own]] for each in now)
        self._kinds = equations.unknowns.kinds[place[own]]

    def forces_and_matrix(self, coordinates: Array) -> tuple[Array, Array]:
        """Forces (m,) that oppose the loads, and their derivative (m, m)."""
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
    """Equilibria of motions ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)``, by Newton's method on a sample of cells.

    An iteration takes time for these cells and the nodes with loads.

    Args:
        scene: One body, that of the sample, held by clamps, with loads on nodes.
        sample: Of :func:`ecsw`; its shapes leave clamps where they are.
        levels: Factors of the loads, one equilibrium after the other.

    Raises:
        ValueError: The scene has other bodies or joints, loads that depend on more than the frame
            of a node, or none; the shapes move what is held.
        ConvergenceError: No equilibrium was found.
    """
    instance(sample, CellSample, "sample", "cells with weights, of ecsw")
    steps = numbers(levels, "levels")
    if steps.ndim != 1 or not len(steps):
        raise ValueError(f"levels must be factors, one after the other, got {levels!r}")
    loads, cells = loads_of(scene, sample.basis), sample.in_shapes()
    return equilibria(cells, loads, sample.basis, steps)


def equilibria(
    cells: CellsInShapes, loads: LoadsInShapes, basis: Basis, levels: Array
) -> SampledEquilibria:
    """At all levels, each from the one before."""
    η: Array = np.zeros(len(basis))
    found, iterations = list[Array](), 0
    for level in levels:
        η, needed = _newton(cells, loads, level, η)
        found.append(η)
        iterations += needed
    coordinates = np.array(found)
    increments = np.einsum("km,mni->kni", coordinates, basis.shapes)
    frames = np.asarray(lie.se3_retract(basis.body.frames, increments))
    return SampledEquilibria(coordinates, frames, iterations)


def loads_of(scene: Scene, basis: Basis) -> LoadsInShapes:
    """Loads on the nodes of the only body, or ``ValueError`` as :func:`sampled_statics` says."""
    body, equations = equations_of(scene)
    unknowns, system = equations.unknowns, equations.system
    if body is not basis.body:
        raise ValueError(f"the basis is of {basis.body.label}, which is not the body of the scene")
    if unknowns.total != unknowns.moving:
        raise ValueError(f"nodes of {body.label} follow others: forces in few shapes need none")
    if unknowns.drilling:
        raise ValueError(f"{body.label} has six parameters: cells in few shapes have five")
    strains = system.load_cases.contents[1]
    if strains or any(not term.of_bodies or term.load for term in system.terms):
        raise ValueError(
            f"{body.label} has loads or springs that are more than forces on nodes: forces in few "
            "shapes know no others"
        )
    shapes = basis.shapes.transpose(1, 2, 0)
    held = unknowns.held[unknowns.bodies[body]]
    if body.uncoupled:
        held = held & ~np.eye(6, dtype=bool)[5]
    if np.abs(shapes[held]).max(initial=0.0) > _HELD * np.abs(shapes).max():
        raise ValueError(f"shapes move nodes of {body.label} that are held")
    loads = LoadsInShapes(equations, basis)
    if not loads.forces_and_matrix(np.zeros(len(basis)))[0].any():
        raise ValueError("no load acts on the shapes: there is nothing to find")
    return loads


def _newton(
    cells: CellsInShapes, loads: LoadsInShapes, level: float, start: Array
) -> tuple[Array, int]:
    """Coordinates where loads times the level are balanced, and how many solutions it took."""
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
        η: Coordinates, shape (m,).
    """

    def __init__(
        self, cells: CellsInShapes, loads: LoadsInShapes, level: float, start: Array
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

    def refactorise(self, update: Update) -> None:
        """Nothing to do: the dense tangent is solved with as it is."""

    def correct(self) -> float:
        """Solve for a correction and apply it; returns its norm over that of the coordinates."""
        step = np.linalg.solve(self._tangent, self._residual)
        self.η = self.η - step
        moved = float(np.linalg.norm(step))
        return moved / max(float(np.linalg.norm(self.η)), np.finfo(float).tiny)

    def judge(self, size: float) -> Verdict:
        """By corrections: round-off of forces that stretch is large beside those that bend."""
        return Verdict.CONVERGED if size <= _CONVERGED else Verdict.GOES_ON
