"""Tables that demos are compared with."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fem_lie import lie


def table(name: str) -> np.ndarray:
    """Its rows; the first column is the time."""
    return np.loadtxt(Path(__file__).with_name(f"{name}.csv"), delimiter=",")


def rotations(quaternions: np.ndarray) -> np.ndarray:
    """Rotation matrices of unit quaternions (w, x, y, z), shape (T, 3, 3)."""
    w, v = quaternions[:, :1], quaternions[:, 1:]
    sine = np.linalg.norm(v, axis=1, keepdims=True)
    return lie.so3_exp(2.0 * np.arctan2(sine, w) * v / np.where(sine > 0, sine, 1.0))
