"""Recovered stress of cables and ANCF beams: polynomials in arc length through the best stress.

Curvatures of cubics are best at two Gauss points, axial forces of the cable at three; of an ANCF
element the mean stress is best, which its residual bending flexibility makes that of end forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.adaptivity.estimates.patches import Pairs, Patches, complete_powers, shared_nodes
from fem_lie.adaptivity.estimates.stress_fields import StressFields
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene

_POINTS = 4
"""Gauss points at which errors are integrated."""


def _gauss(count: int) -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + x), 0.5 * w


class _Lines(NamedTuple):
    """Elements along lines.

    Attributes:
        arc: Unloaded arc length at both ends of each element, shape (m, 2).
        line: Number of its line, shape (m,).
        around: Length of its line if that is closed, else infinite, shape (m,).
    """

    arc: Array
    line: Indices
    around: Array

    @classmethod
    def of(cls, body: CableBody | AncfBeam) -> _Lines:
        """Lines of a body."""
        model = body.model
        m = len(model.elements)
        found = cls(np.empty((m, 2)), np.empty(m, dtype=np.int64), np.full(m, np.inf))
        for k, (nodes, elements) in enumerate(successive(body)):
            ends = np.concatenate([[0.0], np.cumsum(model.lengths[elements])])
            forward = model.elements[elements, 0] == nodes[:-1]
            both = np.stack([ends[:-1], ends[1:]], axis=1)
            found.arc[elements] = np.where(forward[:, np.newaxis], both, both[:, ::-1])
            found.line[elements] = k
            if nodes[0] == nodes[-1]:
                found.around[elements] = ends[-1]
        return found

    def patches(self, sections: Array, nodes: Indices, at: Array, samples: Array) -> _LinePatches:
        """Fits whose degree is the number of samples per element.

        Args:
            sections: Section stiffness, shape (m, 6, 6).
            nodes: Both ends of the elements, shape (m, 2).
            at: Points of an element from 0 to 1 at which stress is recovered, shape (q,).
            samples: Points at which it is best, shape (g,).
        """
        known: Array = np.column_stack([sections.reshape(len(self.line), -1), self.line])
        pairs = Pairs.around_elements(shared_nodes(nodes, known), least=3)
        every, along = np.arange(len(self.line)), self._along
        powers = complete_powers(1, len(samples))
        fits = Patches.of(pairs, along(pairs.patches, pairs.elements, samples), powers)
        return _LinePatches(fits, fits.at(every, along(every, every, at)))

    def _along(self, cells: Indices, others: Indices, at: Array) -> Array:
        """Points of other elements from the middle of elements, in their lengths, (p, g, 1)."""
        start, end = self.arc[others].T[:, :, np.newaxis]
        away = start + at * (end - start) - self.arc[cells].mean(axis=1, keepdims=True)
        around = self.around[cells, np.newaxis]
        closed = np.isfinite(around)
        turns = np.round(away / np.where(closed, around, 1.0))
        away = np.where(closed, away - turns * np.where(closed, around, 0.0), away)
        size = np.abs(np.diff(self.arc[cells], axis=1))
        return np.asarray((away / size)[..., np.newaxis])


class _LinePatches(NamedTuple):
    """Fits along lines, and their monomials at the points of the elements, shape (m, q, t)."""

    fits: Patches
    here: Array

    def __call__(self, best: Array) -> Array:
        """Recovered stress (m, q, b) from the best one (m, g, b)."""
        return np.asarray(self.here @ self.fits.coefficients(best[self.fits.pairs.elements]))


def successive(body: Beam | AncfBeam | CableBody) -> list[tuple[Indices, Indices]]:
    """Nodes (k + 1,) and elements (k,) of each line of a body.

    Args:
        body: The body.
    """
    if isinstance(body, CableBody):
        return [(line.nodes, line.elements) for line in body.model.smooth_lines]
    chains, ends = body.model.chains, body.model.elements[:, :2]
    pieces = np.split(chains.order, chains.first[1:])
    return [(np.append(ends[cells, 0], ends[cells[-1], 1]), cells) for cells in pieces]


def cable_fields(
    result: Result | StaticResult, cable: CableBody, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Axial force and bending moments, in global components, of the elements and recovered ones.

    Raises:
        ValueError: The cable is not in that result, or its elements are no cubics.
    """
    model = cable.model
    formulation = model.formulation
    if not isinstance(formulation, HermiteCable):
        raise ValueError(
            f"the error in space is estimated for cables of cubics, those of {cable.label} are "
            f"{formulation}: use formulation=HermiteCable()"
        )
    nodes, ends = nodes_in(result.info, cable), model.elements[:, :2]
    D, lines = model.stiffness, _Lines.of(cable)
    (at, w), axial, bending = _gauss(_POINTS), _gauss(3)[0], _gauss(2)[0]
    fits = [lines.patches(D, ends, at, best) for best in (axial, bending)]
    EA, EI = (D[:, k, k][:, np.newaxis, np.newaxis] for k in (0, 4))
    unloaded = model.frames[ends]
    speeds = formulation.speeds(unloaded, model.lengths, at)
    weights = w * model.lengths[:, np.newaxis] * (1.0 if speeds is None else speeds)
    compliance = np.zeros((len(ends), 4, 4))
    compliance[:, 0, 0] = 1 / EA[:, 0, 0]
    compliance[:, [1, 2, 3], [1, 2, 3]] = 1 / EI[:, 0]
    found = []
    for k in steps:
        moved = result.frames[k][nodes][ends]

        def stress(along: Array, moved: Array = moved) -> tuple[Array, Array]:
            given = unloaded, moved, model.lengths, along
            N = formulation.axial_strain(*given)
            return EA * N[..., np.newaxis], EI * formulation.curvature(*given)

        own = np.concatenate(stress(at), axis=2)
        better = [fits[0](stress(axial)[0]), fits[1](stress(bending)[1])]
        found.append(StressFields(own, np.concatenate(better, axis=2), weights, compliance))
    return found


def ancf_beam_fields(
    result: Result | StaticResult, beam: AncfBeam, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Section forces and stress across the section, of the elements and recovered ones.

    Raises:
        ValueError: The beam is not in that result.
    """
    model, nodes = beam.model, nodes_in(result.info, beam)
    term = model.assemble([model])
    at, w = _gauss(_POINTS)
    stress, compliance = model.formulation.stress(
        model.stiffness, model.poisson, model.ends, model.lengths, at
    )
    recovered = _Lines.of(beam).patches(model.stiffness, model.elements[:, :2], at, np.array([0.5]))
    weights = w * model.lengths[:, np.newaxis]
    found = []
    for k in steps:
        strains = term.strains(np.ascontiguousarray(result.frames[k][nodes]))
        own = np.einsum("mqas,ms->mqa", stress, strains)
        best = np.einsum("q,mqa->ma", w, own)[:, np.newaxis]
        found.append(StressFields(own, recovered(best), weights, compliance))
    return found
