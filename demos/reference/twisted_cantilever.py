"""Flutter of a cantilever under an end torque that follows its tangent, by a transfer matrix."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from scipy.optimize import brentq, minimize_scalar


def determinant(omega: float, torque: float, EI: tuple[float, float]) -> float:
    """Zero at frequencies of a shear-rigid cantilever with unit length and mass.

    Unknowns are (v, w, v', w', M_y, M_z, n_y, n_z) in fixed axes: deflections, slopes, moments and
    forces. With the torque T along the tangent, M_y = -EI_y w'' + T v', M_z = EI_z v'' + T w', and
    M' = n x t; at the end both are T times the tangent, and forces are zero.
    """
    A = np.zeros((8, 8))
    A[0, 2] = A[1, 3] = A[4, 7] = 1.0
    A[5, 6] = -1.0
    A[2, 5], A[2, 3] = 1.0 / EI[1], -torque / EI[1]
    A[3, 2], A[3, 4] = torque / EI[0], -1.0 / EI[0]
    A[6, 0] = A[7, 1] = -(omega**2)
    T = scipy.linalg.expm(A)
    ends = np.zeros((4, 8))
    ends[0, 4], ends[0, 2], ends[1, 5], ends[1, 3] = 1.0, -torque, 1.0, -torque
    ends[2, 6] = ends[3, 7] = 1.0
    return float(np.linalg.det(ends @ T[:, 4:]))


def flutter_torque(EI: tuple[float, float]) -> float:
    """Torque at which the two slowest frequencies become one: the determinant has a double zero."""
    slow, fast = (3.5160153 * np.sqrt(stiffness) for stiffness in sorted(EI))
    sign = np.sign(determinant(0.5 * (slow + fast), 0.0, EI))

    def largest(torque: float) -> float:
        found = minimize_scalar(
            lambda omega: -sign * determinant(omega, torque, EI),
            bounds=(slow, fast),
            method="bounded",
            options={"xatol": 1e-10},
        )
        return float(-found.fun)

    torque = 0.1
    while largest(torque) > 0.0:
        torque *= 1.1
    return float(brentq(largest, torque / 1.1, torque, xtol=1e-9))
