"""A deployable truss of rigid bars: its posture over the time; and how far bars are bent."""

from __future__ import annotations

import numpy as np

import fem_lie as fl
from fem_lie import lie

SIDE, LONGERON = 2.0, 4.0
START, END = np.radians([5.0, 90.0])
DEPLOYMENT = 20.0
SQUARE = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def angle(t: float) -> float:
    """Angle of deployment by the cosine law."""
    return float(START + (END - START) * 0.5 * (1 - np.cos(np.pi * t / DEPLOYMENT)))


def turned(t: float) -> float:
    """What the driven feet follow: rotation of the longeron about y."""
    return START - angle(t)


def corners(level: int, q: float) -> np.ndarray:
    """The corners of a frame, 0 being the clamped one, if bars were rigid."""
    return SQUARE + LONGERON * np.array([level % 2 * np.cos(q), 0.0, level * np.sin(q)])


def off_posture(
    result: fl.Result | fl.StaticResult, frames: list[list[fl.extend.Point]], time: float
) -> float:
    """Largest distance of a corner at the end, ``time``, from where rigid bars would have it."""
    return max(
        float(np.linalg.norm(result.position(point)[-1] - position))
        for level, frame in enumerate(frames)
        for point, position in zip(frame, corners(level, angle(time)), strict=True)
        if not point.is_ground
    )


def bending(
    result: fl.Result | fl.StaticResult, bars: list[fl.Beam], radius: float
) -> tuple[float, float]:
    """Largest distance of an axis from its chord over the length, and largest strain of a fibre."""
    nodes = np.array([result.info.body(bar.name).nodes for bar in bars])
    x = result.frames[:, nodes, 0]
    chord = x[:, :, -1:] - x[:, :, :1]
    length = np.linalg.norm(chord, axis=-1, keepdims=True)
    away = np.linalg.norm(np.cross(x - x[:, :, :1], chord / length), axis=-1)
    deflection = away.max(axis=2) / length[:, :, 0, 0]
    rest = np.array([bar.model.lengths for bar in bars])[..., np.newaxis]
    strain = 0.0
    for frames in result.frames[:, nodes]:
        moved = lie.se3_relative(frames[:, :-1], frames[:, 1:]) / rest
        fibre = np.abs(moved[..., 0] - 1.0) + radius * np.linalg.norm(moved[..., 4:], axis=-1)
        strain = max(strain, float(fibre.max()))
    return float(deflection.max()), strain
