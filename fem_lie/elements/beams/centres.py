"""Tension and shear centres of sections from their stiffness, and lines through them."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array


def tension_centres(stiffness: Array) -> Array:
    """Point ``(0, r₂, r₃)`` where an axial force does not bend the section, shape (m, 3), m.

    Args:
        stiffness: Section stiffness, shape (m, 6, 6).
    """
    coupling = np.stack([0 * stiffness[:, 0, 0], -stiffness[:, 0, 5], stiffness[:, 0, 4]], axis=1)
    return np.asarray(coupling / stiffness[:, 0, :1])


def centres_at_ends(stiffness: Array, ends: Array) -> Array:
    """``r_A`` and ``r_B`` in the frames of the nodes, shape (m, 2, 3).

    Args:
        stiffness: Section stiffness, shape (m, 6, 6).
        ends: Unloaded frames of both ends, shape (m, 2, 4, 3).
    """
    θ, r = lie.se3_relative(ends[:, 0], ends[:, 1])[:, 3:], tension_centres(stiffness)
    # half of T(θ/2) and T(−θ/2) are the means of exp(σθ) over both halves
    mean = 0.5 * (lie.so3_tangent(0.5 * θ) + lie.so3_tangent(-0.5 * θ))
    turns = lie.so3_exp(np.stack([0.5 * θ, -0.5 * θ], axis=1))
    return np.asarray(np.einsum("mkij,mjl,ml->mki", turns, mean, r))


def torsion_about_centres(stiffness: Array) -> Array:
    """Ratio of the torsional stiffness about the tension centre to that about the shear centre.

    If these centres are ``d`` apart, a section with shear twists about the shear centre; without
    shear it twists about the tension centre, with ``GJ + GA d²``. Shape (m,).

    Args:
        stiffness: Section stiffness, shape (m, 6, 6).
    """
    shear = stiffness[:, 1:3, 1:3]
    # stiffness about the tension centre does not depend on the position of the axis
    T = np.tile(np.eye(6), (len(stiffness), 1, 1))
    T[:, :3, 3:] = lie.hat(tension_centres(stiffness))
    D = T.swapaxes(1, 2) @ stiffness @ T
    coupling = D[:, 1:3, 3]
    released = np.einsum("mi,mij,mj->m", coupling, np.linalg.inv(shear), coupling)
    return np.asarray(D[:, 3, 3] / (D[:, 3, 3] - released))
