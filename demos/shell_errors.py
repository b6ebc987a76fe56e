"""How far two results are from each other in the stress of a shell."""

from __future__ import annotations

import numpy as np

import fem_lie as fl


def stress_errors(
    found: fl.Result, full: fl.Result, shell: fl.Shell, thickness: float, steps: np.ndarray
) -> tuple[float, float]:
    """Largest errors of moments, and of stress on both surfaces, over the largest of each."""
    N, M = carried(found, shell, steps)
    N0, M0 = carried(full, shell, steps)
    ways = [side * 6.0 / thickness for side in (-1.0, 1.0)]
    stress, wanted = (np.array([n + way * m for way in ways]) for n, m in ((N, M), (N0, M0)))
    return largest(M - M0) / largest(M0), largest(stress - wanted) / largest(wanted)


def carried(result: fl.Result, shell: fl.Shell, steps: np.ndarray) -> tuple[np.ndarray, ...]:
    """Membrane forces and moments at all points, axes 11, 22, 12 first."""
    series = fl.post.resultant_series(result, shell, states=list(steps))
    return tuple(
        np.array([[each.raw(kind + axes) for each in series] for axes in ("11", "22", "12")])
        for kind in "NM"
    )


def largest(values: np.ndarray) -> float:
    """Of all, whatever their signs."""
    return float(np.abs(values).max())
