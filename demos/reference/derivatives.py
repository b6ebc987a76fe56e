"""Whether forms are the derivatives of an energy, by differences, and feel no rigid motion."""

from __future__ import annotations

import numpy as np
from dolfinx import fem

import fem_lie as fl
from fem_lie import lie


def checks(q: fl.NodalFrames, forms: fl.extend.LocalFrameForms, seed: int = 1) -> dict[str, float]:
    """Errors of derivatives and of invariance on a random large deformation, relative."""
    rng = np.random.default_rng(seed)
    n = len(q.frames)
    start = lie.se3_retract(q.frames, rng.normal(size=(n, 6)) * ([0.3] * 3 + [1.0] * 3))

    def at(frames: np.ndarray, form: str) -> np.ndarray:
        q.frames[:] = frames
        if form == "energy":
            return np.array(fem.assemble_scalar(forms.energy))
        if form == "residual":
            return fem.assemble_vector(forms.residual).array
        q.increment.x.array[:] = 0.0
        forms.update_stress()  # by no increment: the linearised stress is the true one
        return fem.assemble_matrix(forms.tangent).to_dense()

    def differences(form: str, step: float) -> np.ndarray:
        """Derivative in all increments, of fourth order."""
        columns = []
        for unit in np.eye(6 * n).reshape(-1, n, 6):
            f = [at(lie.se3_retract(start, k * step * unit), form) for k in (-2, -1, 1, 2)]
            columns.append((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step))
        return np.array(columns).T

    residual, tangent = at(start, "residual"), at(start, "tangent")
    far = lie.frame(1000.0 * np.array([0.6, 0.0, 0.8]), lie.so3_exp([600.0, -640.0, 480.0]))
    moved = lie.se3_compose(far, start)
    return {
        "gradient_error": error(differences("energy", 1e-3), residual),
        "tangent_error": error(differences("residual", 1e-3), tangent),
        "invariance_error": max(
            error(at(moved, "residual"), residual), error(at(moved, "tangent"), tangent)
        ),
        "residual_largest": float(np.abs(residual).max()),
        "tangent_largest": float(np.abs(tangent).max()),
    }


def error(values: np.ndarray, reference: np.ndarray) -> float:
    return float(np.abs(values - reference).max() / np.abs(reference).max())
