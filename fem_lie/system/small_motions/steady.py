"""The equations of a scene linearised about a steady motion, of which rest is one."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.lie.kinds import at_rest
from fem_lie.system.instant import Instant
from fem_lie.system.system import System


def linearised(
    system: System, H: Array, v: Array, weights: Array, *, elements: bool = True
) -> tuple[Array, Array, Array]:
    """Mass, damping and stiffness of small motions about steady motion, blocks of ``kkt``.

    All nodes move with constant local velocities ``v``, those of one rigid motion, and a little
    aside: ``H exp(h)``. Then ``δv = ḣ + ad(v) h``, ``δv̇ = ḧ + ad(v) ḣ`` and

        M ḧ + (C + M ad(v)) ḣ + (∂r/∂h + C ad(v)) h + Bᵀ δλ = 0,    M = ∂r/∂a, C = ∂r/∂v.

    Viscous stress does not feel the rigid motion and enters with ``ḣ`` alone. Elastic stress is the
    carried one: see ``terms.reset_stress``.

    Args:
        system: The equations.
        H: Frames of all rows.
        v: Local velocities of the moving nodes, shape (n, 6).
        weights: Multipliers, shape (m,).
        elements: Whether the stiffness of elements and pressure is taken in.

    Returns:
        Three arrays of shape (nnz, 6, 6).
    """
    tangent = system.tangent
    scale, r, forces = np.ones(system.m), np.empty(system.size), system.room()
    twists = at_rest(system.kinds)  # derivatives in the rates of twists, on any group
    now = Instant(H, v, np.zeros_like(v), weights)
    system.residual(now, scale, r, forces)
    loads = forces.on_rows, system.loads.moment
    tangent.keep_apart()
    tangent.clear()
    tangent.add_inertia(now, twists, loads, (1.0, 0.0))
    M = tangent.A.copy()
    tangent.clear()
    tangent.add_inertia(now, twists, loads, (0.0, 1.0))
    tangent.add_viscosity(H, v, 1.0, lambda _, viscosity: viscosity.in_space)
    tangent.add_terms(H, forces.own, lambda term: elements or not term.of_bodies)
    tangent.add_geometric(H, weights)
    system.follow_motion(forces)
    ad = lie.se3_ad(v)[tangent.kkt.indices]
    K = tangent.parts.K + tangent.A @ ad
    tangent.add_viscosity(H, v, 1.0, lambda _, viscosity: not viscosity.in_space)
    return M, tangent.A + M @ ad, K


def fill_steady(system: System, H: Array, v: Array, weights: Array, scale: Array) -> None:
    """Stiffness of :func:`linearised`, bordered by the scaled constraints, into the KKT."""
    _, _, K = linearised(system, H, v, weights)
    system.tangent.fill(K, H, scale)
