"""Residual errors of beams: what is left of the balance of stress resultants in each element."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import legendre

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.adapt.estimates.estimate import ElementErrors
from fem_lie.bodies.beams.beam import Beam
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.stresses.element_forces import neighbours
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.scene import Scene


def beam_residual(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the balance of forces and moments in the frame of the section.

    What is left of it is::

        r = (N′ + κ × N + n,  M′ + κ × M + Γ × N + m)

    with the present strains Γ, κ, tangent included. What acts along the line, n and m, is what
    makes forces jump at nodes, over the length that carries it; inertia is in it. Where a single
    force may act, nothing is known of it but what the other end says.

    An element with g points of Gauss has its stress right there, and misses a multiple of
    Legendre's polynomial of degree g, ``τ′ = −r``. So of r the part of degree g − 1 counts, to
    which the derivative of its own stress adds nothing, and with its coefficient r̂::

        τ̂ = ℓ r̂ / (2 (2g − 1)),    η² = ℓ τ̂·D⁻¹τ̂ / (2g + 1),

    which is ``ℓ³ r·D⁻¹r / 12`` with one point. Jumps at nodes have no term of their own:
    an element that is right at its ends does no work on them.

    Raises:
        ValueError: See :func:`~fem_lie.results.stresses.section_forces.section_forces`; the energy
            of the element is no strain energy.
    """
    found = section_forces(result, beam, scene, steps=steps)
    return [_errors(found, k) for k in range(len(steps))]


def _errors(found: SectionForces, k: int) -> ElementErrors:
    beam, stress = found.beam, found.at_points(k)
    g, compliance = stress.shape[1], np.linalg.inv(beam.stiffness)
    x, w = legendre.leggauss(g)
    shape = legendre.legval(x, np.eye(g)[-1])
    balance = _turning(_rates(beam, found.frames[k], x), stress)
    residual = (g - 0.5) * np.einsum("q,q,mqb->mb", w, shape, balance)
    residual = residual + along_the_line(found, k, g - 1)
    missing = beam.lengths[:, np.newaxis] * residual / (2.0 * (2 * g - 1))
    squares = np.einsum("mi,mij,mj->m", missing, compliance, missing) * beam.lengths / (2 * g + 1)
    energy = np.einsum("q,mqi,mij,mqj,m->", 0.5 * w, stress, compliance, stress, beam.lengths)
    return ElementErrors(squares, float(energy))


def _turning(rates: Array, stress: Array) -> Array:
    """``(κ × N, κ × M + Γ × N)``, shape (m, q, 6)."""
    stretch, curvature, force = rates[..., :3], rates[..., 3:], stress[..., :3]
    moment = np.cross(curvature, stress[..., 3:]) + np.cross(stretch, force)
    return np.concatenate([np.cross(curvature, force), moment], axis=-1)


def _rates(beam: Beam, frames: Array, x: Array) -> Array:
    """``H⁻¹H′`` by unloaded arc length at points −1 ≤ x ≤ 1, shape (m, q, 6)."""
    ends, unloaded = frames[beam.elements], beam.frames[beam.elements]
    if beam.elements.shape[1] == 2:
        moved = lie.se3_relative(ends[:, 0], ends[:, 1]) / beam.lengths[:, np.newaxis]
        return np.repeat(moved[:, np.newaxis], len(x), axis=1)
    shapes = np.stack([0.5 * x * (x - 1), 0.5 * x * (x + 1), 1 - x * x], axis=1)
    slopes = np.stack([x - 0.5, x + 0.5, -2 * x], axis=1)
    arc = np.linalg.norm(np.einsum("qk,mkj->mqj", slopes, unloaded[:, :, 0]), axis=2)
    d = np.einsum("qk,mkij->mqij", shapes, ends[:, :, 1:])
    change = np.einsum("qk,mkij->mqij", slopes, ends)
    stretch = np.einsum("mqij,mqj->mqi", d, change[:, :, 0])
    turn = np.einsum("mqaj,mqbj->mqab", d, change[:, :, 1:])
    turn = 0.5 * (turn - np.swapaxes(turn, 2, 3))
    curvature = np.stack([turn[..., 2, 1], turn[..., 0, 2], turn[..., 1, 0]], axis=-1)
    # of directors that are orthonormal, as the element has them
    E = 0.5 * (np.eye(3) - np.einsum("mqij,mqkj->mqik", d, d))
    stretch = stretch + np.einsum("mqij,mqj->mqi", E, stretch)
    trace = np.trace(E, axis1=2, axis2=3)[..., np.newaxis]
    curvature = curvature + trace * curvature - np.einsum("mqij,mqj->mqi", E, curvature)
    return np.asarray(np.concatenate([stretch, curvature], axis=-1) / arc[..., np.newaxis])


def along_the_line(found: SectionForces, k: int, degree: int) -> Array:
    """Force and moment per length, its mean or, of degree 1, half of its change, shape (m, 6)."""
    beam = found.beam
    # what is viscous is no elastic stress
    ends = found.elements.at_ends(found.frames[k])
    rows = beam.frames[beam.elements[:, :2]]
    shares = beam.formulation.shares(rows, beam.lengths)
    before, behind = neighbours(beam.elements, found.single)
    carried = shares[before, 1] + shares[behind, 0]
    density = (ends[before, 1] - ends[behind, 0]) / carried[:, np.newaxis]
    known, count = np.zeros_like(ends), np.zeros((len(ends), 2))
    known[before, 1], known[behind, 0] = density, density
    count[before, 1], count[behind, 0] = 1.0, 1.0
    if degree == 0:
        each = np.maximum(count.sum(axis=1), 1.0)
        return np.asarray(known.sum(axis=1) / each[:, np.newaxis])
    both = count.min(axis=1, keepdims=True)
    return np.asarray(0.5 * both * (known[:, 1] - known[:, 0]))
