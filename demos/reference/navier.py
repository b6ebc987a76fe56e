"""Navier's double series for a simply supported square plate with shear, under a uniform load."""

from __future__ import annotations

import numpy as np

import fem_lie as fl

SIDE = 1.0


def navier(
    section: fl.ShellSection, load: float, x: float, y: float, terms: int = 199
) -> dict[str, float]:
    """Deflection and resultants at a position.

    Args:
        section: Specially orthotropic.
        load: Force per area.
        x: Place.
        y: Place.
        terms: Largest m and n.
    """
    D, S = section.stiffness[3:6, 3:6], np.diag(section.stiffness)[6:]
    odd = np.arange(1, terms + 1, 2)
    m, n = (index.ravel() for index in np.meshgrid(odd, odd, indexing="ij"))
    amplitude = load * 16 / (np.pi**2 * m * n)
    α, β = np.pi * m / SIDE, np.pi * n / SIDE
    A = np.empty((len(m), 3, 3))
    A[:, 0, 0] = S[0] * α**2 + S[1] * β**2
    A[:, 0, 1] = A[:, 1, 0] = S[0] * α
    A[:, 0, 2] = A[:, 2, 0] = S[1] * β
    A[:, 1, 1] = D[0, 0] * α**2 + D[2, 2] * β**2 + S[0]
    A[:, 1, 2] = A[:, 2, 1] = (D[0, 1] + D[2, 2]) * α * β
    A[:, 2, 2] = D[2, 2] * α**2 + D[1, 1] * β**2 + S[1]
    right = np.stack([amplitude, 0 * amplitude, 0 * amplitude], axis=1)
    W, X, Y = np.linalg.solve(A, right[..., np.newaxis])[..., 0].T
    sx, cx, sy, cy = np.sin(α * x), np.cos(α * x), np.sin(β * y), np.cos(β * y)
    return {
        "w": float(W @ (sx * sy)),
        "M11": -float((D[0, 0] * α * X + D[0, 1] * β * Y) @ (sx * sy)),
        "M22": -float((D[0, 1] * α * X + D[1, 1] * β * Y) @ (sx * sy)),
        "M12": float(D[2, 2] * (β * X + α * Y) @ (cx * cy)),
        "Q1": float(S[0] * (X + α * W) @ (cx * sy)),
        "Q2": float(S[1] * (Y + β * W) @ (sx * cy)),
    }
