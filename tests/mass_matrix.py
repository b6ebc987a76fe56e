"""Mass matrix in twists of a frame from its director mass matrix, independent of compiled code."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import fem_lie as fl
from fem_lie import lie


def mass_matrix_6x6(mass_matrix: npt.ArrayLike) -> fl.extend.Array:
    """Mass matrix of local velocities (translation, rotation): ``[[m I, −m ĉ], [m ĉ, J]]``.

    Args:
        mass_matrix: Mass matrix of (x, d₁, d₂, d₃), shape (4, 4).

    Returns:
        Symmetric matrix, shape (6, 6); J is about the frame's origin.
    """
    G = np.asarray(mass_matrix, dtype=np.float64)
    E = G[1:, 1:]
    M = np.empty((6, 6))
    M[:3, :3] = G[0, 0] * np.eye(3)
    M[3:, :3] = lie.hat(G[0, 1:])
    M[:3, 3:] = -M[3:, :3]
    M[3:, 3:] = np.trace(E) * np.eye(3) - E
    return M
