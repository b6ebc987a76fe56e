"""Recovered stress of beams: polynomials between ends that are in equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.adapt.estimates.stress_fields import StressFields
from fem_lie.bodies.beams.beam import Beam
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.stresses.element_forces import without_jumps
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.scene import Scene


def beam_fields(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the elements, and the one recovered from it, in some states.

    Forces at the ends of elements are in equilibrium with all that acts on nodes and joints, and so
    of higher order than ``σ = D ε``; in local frames they are components of one smooth field. The
    recovered stress is a polynomial in each element, of the degree of its number g of points: it
    has those forces at both ends, without the jumps of distributed loads, and with g = 2 the mean
    of the element's own stress. The superconvergent patch of Zienkiewicz & Zhu (IJNME 33 (1992)
    1331) is here the element itself.

    Raises:
        ValueError: See :func:`~fem_lie.results.stresses.section_forces.section_forces`; the energy
            of the element is no strain energy.
    """
    found = section_forces(result, beam, scene, steps=steps)
    return [_fields(found, k) for k in range(len(steps))]


def _fields(found: SectionForces, k: int) -> StressFields:
    beam, stress = found.beam, found.at_points(k)
    # what is viscous is no elastic stress
    ends = found.elements.at_ends(found.frames[k])[np.newaxis]
    ends = without_jumps(beam, ends, found.single)[0]
    g = stress.shape[1]
    x, w = np.polynomial.legendre.leggauss(g + 1)
    at = 0.5 * (1.0 + x)
    own, (start, end) = _polynomial(stress, at), np.swapaxes(ends, 0, 1)[:, :, np.newaxis]
    recovered = start + at[:, np.newaxis] * (end - start)
    if g > 1:
        missing = 1.5 * (stress.mean(axis=1) - ends.mean(axis=1))[:, np.newaxis]
        recovered = recovered + missing * (4.0 * at * (1.0 - at))[:, np.newaxis]
    weights = 0.5 * w * beam.lengths[:, np.newaxis]
    return StressFields(own, recovered, weights, np.linalg.inv(beam.stiffness))


def _polynomial(values: Array, at: Array) -> Array:
    """Values (m, g, 6) at the points of Gauss, at other places ``at`` (q,) from 0 to 1."""
    x, _ = np.polynomial.legendre.leggauss(values.shape[1])
    points = np.vander(0.5 * (1.0 + x), increasing=True)
    places = np.vander(at, values.shape[1], increasing=True)
    return np.asarray(np.einsum("qg,mgi->mqi", places @ np.linalg.inv(points), values))
