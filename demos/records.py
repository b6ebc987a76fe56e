"""What the records of several demos have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import fem_lie as fl


def of_path(*paths: fl.stability.EquilibriumPath) -> dict[str, Any]:
    """What paths took, together: steps, iterations, seconds."""
    return {
        "load_steps": sum(path.load_steps for path in paths),
        "rejected_steps": sum(path.failed_steps for path in paths),
        "iterations": sum(path.total_iterations for path in paths),
        "seconds": sum(path.seconds for path in paths),
    }


def of_loading(result: fl.StaticResult) -> dict[str, Any]:
    """What it took to apply a load."""
    return {
        "load_steps": result.load_steps,
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
        "seconds": result.seconds,
    }


def of_motion(result: fl.Result, steps: int) -> dict[str, Any]:
    """What a motion took."""
    return {
        "iterations_per_step": float(result.iterations[-1] / steps),
        "seconds": result.seconds,
    }


def components(name: str, vector: Sequence[float]) -> dict[str, float]:
    """``name_x``, ``name_y``, ``name_z``."""
    return {f"{name}_{axis}": float(value) for axis, value in zip("xyz", vector, strict=True)}


def off_chord(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of points (T, n, 3) from the line through the first and the last, and its length.

    Returns:
        Shapes (T, n) and (T, 1).
    """
    chord = x[:, -1:] - x[:, :1]
    length = np.linalg.norm(chord, axis=2, keepdims=True)
    across = np.cross(x - x[:, :1], chord) / length
    return np.linalg.norm(across, axis=2), length[:, 0]


def deflection(result: fl.Result, bar: fl.Beam) -> float:
    """Largest distance of a bar's nodes from the line through its ends, over its length."""
    every = max(1, len(result.times) // 1000)
    x = result.frames[::every, result.info.body(bar.name).nodes, 0]
    return float(off_chord(x)[0].max() / bar.model.size)


def of_equal_steps(result: fl.Result) -> dict[str, Any]:
    """Steps, what they took, and what they keep, at the start and at the end."""
    steps = round(result.times[-1] / (result.times[1] - result.times[0]))
    record: dict[str, Any] = {
        "step": float(result.times[1] - result.times[0]),
        "duration": float(result.times[-1]),
        "steps": steps,
        "ms_per_step": 1e3 * result.seconds / steps,
        "iterations": int(result.iterations[-1]),
        "factorisations": result.factorisations,
        "energy_error": result.energy_error,
        "angular_momentum_error": result.angular_momentum_error,
        "elastic_energy_largest": float(result.elastic.max()),
        **of_motion(result, steps),
    }
    for name, row in (("start", 0), ("end", -1)):
        record[f"kinetic_energy_{name}"] = float(result.kinetic[row])
        record[f"elastic_energy_{name}"] = float(result.elastic[row])
        momentum = components("angular_momentum", result.angular_momentum[row])
        record |= {f"{key}_{name}": value for key, value in momentum.items()}
    return record


def bow(result: fl.Result, name: str) -> float:
    """Largest distance of a bar's nodes from the line through its ends, over the length of that."""
    away, length = off_chord(result.frames[:, result.info.body(name).nodes, 0])
    return float((away / length).max())
