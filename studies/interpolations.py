"""Interpolations of rotation and motion between two nodes, judged by four laws and by their order.

With the interpolation ``I(H₁, H₂; ξ)`` of the frames of two nodes, ``H = (R, x)``:

==============  =====================================  ==========================================
law             formula                                what it means
==============  =====================================  ==========================================
orthonormal     ``RᵀR = 1``                            the section stays rigid
objective       ``I(Q H₁, Q H₂) = Q I(H₁, H₂)``        rigid motions Q leave strains as they are
tensorial       ``I(Q H₁ Q⁻¹, …) = Q I Q⁻¹``           components in another basis, of space and
                for rotations Q                        sections, are those of the same tensor
intrinsic       ``I(H₁ B, H₂ B) = I(H₁, H₂) B``        any line and axes of the section may be the
                                                       reference, moved by B
==============  =====================================  ==========================================

(G. Jelenić & M. A. Crisfield, CMAME 171 (1999) 141; O. A. Bauchau & S. Han, Multibody Syst. Dyn. 31
(2014) 339.) A fifth law is independence of the path: incremental rotation vectors, in which an
interpolated rotation is the product of those of all load steps (A. Ibrahimbegović, CMAME 122 (1995)
11), do not return on a closed path of both nodes; it has twenty steps.

Numbers are largest violations over random pairs of frames about 1 rad and one length apart, in rad
and lengths. ``error`` is the distance in the middle of an arc of a helix, the motion of constant
strain, from that arc over its length, for 0.5 rad, and ``order`` the rate at which the distance
falls with the length; it has none where the arc is exact.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from demos.command_line import run
from fem_lie.lie import (
    frame,
    rotation,
    se3_compose,
    se3_exp,
    se3_inverse,
    se3_relative,
    so3_exp,
    so3_log,
)

Interpolation = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
SAMPLES, STEPS, ROUND_OFF = 200, 20, 1e-13


def apart(rotations: Callable[[np.ndarray, np.ndarray, float], np.ndarray]) -> Interpolation:
    """Rotations interpolated somehow, positions linearly."""

    def both(A: np.ndarray, B: np.ndarray, ξ: float) -> np.ndarray:
        return frame((1 - ξ) * A[0] + ξ * B[0], rotations(rotation(A), rotation(B), ξ))

    return both


def polar(M: np.ndarray) -> np.ndarray:
    """Nearest rotation."""
    U, _, V = np.linalg.svd(M)
    return U @ V


def cardan(R: np.ndarray) -> np.ndarray:
    """Angles of ``R = R_x(a) R_y(b) R_z(c)``."""
    return np.array(
        [np.arctan2(-R[1, 2], R[2, 2]), np.arcsin(R[0, 2]), np.arctan2(-R[0, 1], R[0, 0])]
    )


def by_cardan(A: np.ndarray, B: np.ndarray, ξ: float) -> np.ndarray:
    """Interpolated Cardan angles."""
    a, b, c = (1 - ξ) * cardan(A) + ξ * cardan(B)
    e = np.eye(3)
    return so3_exp(a * e[0]) @ so3_exp(b * e[1]) @ so3_exp(c * e[2])


def geodesic(A: np.ndarray, B: np.ndarray, ξ: float) -> np.ndarray:
    """Interpolated relative motion, ``H₁ exp(ξ log(H₁⁻¹ H₂))``."""
    return se3_compose(A, se3_exp(ξ * se3_relative(A, B)))


INTERPOLATIONS: dict[str, Interpolation] = {
    "cardan_angles": apart(by_cardan),
    "rotation_vectors": apart(lambda A, B, ξ: so3_exp((1 - ξ) * so3_log(A) + ξ * so3_log(B))),
    "directors": apart(lambda A, B, ξ: (1 - ξ) * A + ξ * B),
    "directors_polar": apart(lambda A, B, ξ: polar((1 - ξ) * A + ξ * B)),
    "relative_rotation": apart(lambda A, B, ξ: A @ so3_exp(ξ * so3_log(A.T @ B))),
    "relative_motion": geodesic,
}
"""``relative_motion`` is that of ``GeodesicBeam``, ``directors`` that of ``DirectorBeam``."""


def violations(interpolate: Interpolation) -> dict[str, float]:
    """Largest violation of each law at random frames."""
    rng, found = np.random.default_rng(2), {}
    laws = "orthonormal", "objective", "tensorial", "intrinsic"
    found = dict.fromkeys(laws, 0.0)
    for _ in range(SAMPLES):
        start, way, Q, B = se3_exp(0.6 * rng.normal(size=(4, 6)))
        end, ξ = se3_compose(start, way), rng.uniform(0.2, 0.8)
        middle = interpolate(start, end, ξ)
        R, basis = rotation(middle), frame(np.zeros(3), rotation(Q))

        def based(H: np.ndarray, basis: np.ndarray = basis) -> np.ndarray:
            return se3_compose(se3_compose(basis, H), se3_inverse(basis))

        off = {
            "orthonormal": R.T @ R - np.eye(3),
            "objective": interpolate(se3_compose(Q, start), se3_compose(Q, end), ξ)
            - se3_compose(Q, middle),
            "tensorial": interpolate(based(start), based(end), ξ) - based(middle),
            "intrinsic": interpolate(se3_compose(start, B), se3_compose(end, B), ξ)
            - se3_compose(middle, B),
        }
        for law, each in off.items():
            found[law] = max(found[law], float(np.abs(each).max()))
    return found


def path_dependence() -> float:
    """Rotation vector that incremental interpolation retains after a closed path."""
    axes = np.eye(3)
    ends, middle = [np.eye(3), np.eye(3)], np.eye(3)
    for k in range(STEPS):
        t = 2 * np.pi * np.array([k, k + 1]) / STEPS
        for node, size in enumerate((0.6, 1.2)):
            before, after = (
                so3_exp(size * ((1 - np.cos(s)) * axes[0] + np.sin(s) * axes[node + 1])) for s in t
            )
            ends[node] = after @ before.T
        increments = [so3_log(end) for end in ends]
        middle = so3_exp(0.5 * (increments[0] + increments[1])) @ middle
    return float(np.linalg.norm(so3_log(middle)))


def helix_error(interpolate: Interpolation, angle: float) -> float:
    """Distance of the interpolated middle of an arc of a helix from the helix, over its length."""
    d = angle * np.array([1.0, 0.3, 0.1, 0.4, 0.2, 1.0]) / np.linalg.norm([0.4, 0.2, 1.0])
    start = se3_exp(np.array([0.3, 0.2, 0.1, 0.5, -0.4, 0.3]))
    middle = se3_compose(start, se3_exp(d / 2))
    found = interpolate(start, se3_compose(start, se3_exp(d)), 0.5)
    return float(np.linalg.norm(found - middle) / np.linalg.norm(d[:3]))


def main() -> dict[str, Any]:
    """Violations, errors and orders by interpolation."""
    record: dict[str, Any] = {}
    for name, interpolate in INTERPOLATIONS.items():
        coarse, fine = (helix_error(interpolate, angle) for angle in (0.5, 0.25))
        record[name] = violations(interpolate) | {"error": coarse}
        if coarse > ROUND_OFF:
            record[name]["order"] = float(np.log2(coarse / fine) + 1)
    return record | {"incremental_rotation_vectors": {"path_dependence": path_dependence()}}


if __name__ == "__main__":
    run(main, show=True)
