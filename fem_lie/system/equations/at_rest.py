"""The matrix that finds accelerations, and impulses in joints."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.system.system import System


def fill_at_rest(system: System, H: Array, step: float) -> Array:
    """``M + h² K/4`` bordered by the constraints, into the KKT; returns their scale, (m,).

    Modes that the step does not resolve would start with accelerations that mean nothing to it.

    Args:
        system: The equations; the stress that is carried becomes the true one.
        H: Frames of all rows.
        step: ``h``.
    """
    tangent = system.tangent
    terms, still = system.terms, np.zeros((system.count, 6))
    kept = terms.room()
    terms.reset_stress(H)
    terms.add_forces(H, np.zeros(system.size), kept)
    # after the forces, which may find other pairs of nodes that touch
    tangent.clear()
    # both parts may be one: it is 4/h² times that until it is the sum
    inverse = 4.0 / step**2
    tangent.add_terms(H, kept)
    tangent.add_viscosity(
        H, still, 0.5 * step * inverse, lambda term, of: not (term.of_bodies or of.in_space)
    )
    tangent.add_mass(H, system.kinds, inverse)
    tangent.parts.add_K()
    tangent.A[:] /= inverse
    scale = tangent.constraint_scale(H)
    tangent.fill(tangent.A, H, scale)
    return scale
