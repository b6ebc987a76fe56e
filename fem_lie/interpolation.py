"""Motion between the times that were kept: cubics on SE(3).

Between ``H₀, v₀`` and ``H₁, v₁`` at a distance Δ, ``H(s) = H₀ exp(p(s))`` with the cubic ``p`` that
has ``p(0) = 0``, ``p(1) = ξ = log(H₀⁻¹ H₁)``, ``p′(0) = Δ v₀``, ``p′(1) = Δ T(ξ)⁻¹ v₁``; the
velocity is ``T(p) p′/Δ``. A steady screw motion is met exactly, any other to fourth order.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie.results import Array, Result

_OTHERWISE = ("times", "frames", "velocities", "iterations")


def resampled(result: Result, times: npt.ArrayLike) -> Result:
    """See :meth:`fem_lie.results.Result.resampled`."""
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    kept = result.times
    if len(kept) < 2 or not len(at):
        raise ValueError(f"wanted times between two that were kept, got {len(at)} and {len(kept)}")
    slack = 1e-9 * (kept[-1] - kept[0])
    if not (at.min() >= kept[0] - slack and at.max() <= kept[-1] + slack):
        raise ValueError(
            f"times must be within [{kept[0]:g}, {kept[-1]:g}], got {at.min():g} … {at.max():g}"
        )
    row = np.clip(np.searchsorted(kept, at, side="right") - 1, 0, len(kept) - 2)
    part = np.clip((at - kept[row]) / (kept[row + 1] - kept[row]), 0.0, 1.0)
    frames, velocities = motion(result, row, part)
    linear: dict[str, Any] = {
        field.name: _between(values, row, part)
        for field in fields(result)
        if field.name not in _OTHERWISE
        and isinstance(values := getattr(result, field.name), np.ndarray)
    }
    count = result.iterations[np.where(part < 1.0, row, row + 1)]
    own = {"times": at, "frames": frames, "velocities": velocities, "iterations": count}
    return replace(result, **linear, **own)


def motion(result: Result, row: npt.NDArray[np.int64], part: Array) -> tuple[Array, Array]:
    """Frames (K, N, 4, 3) and velocities (K, N, 6) in parts (K,) of the intervals after rows."""
    H, v, Δ = result.frames, result.velocities, np.diff(result.times)[row, None, None]
    s = part[:, np.newaxis, np.newaxis]
    ξ = lie.se3_relative(H[row], H[row + 1])
    end = np.einsum("knij,knj->kni", lie.se3_tangent_inverse(ξ), v[row + 1])
    first, last = Δ * v[row], Δ * end
    p = s**2 * (3 - 2 * s) * ξ + s * (1 - s) ** 2 * first - s**2 * (1 - s) * last
    rate = 6 * s * (1 - s) * ξ + (1 - s) * (1 - 3 * s) * first - s * (2 - 3 * s) * last
    frames = lie.se3_retract(H[row], p)
    velocities = np.einsum("knij,knj->kni", lie.se3_tangent(p), rate / Δ)
    return frames, velocities


def _between(values: Array, row: npt.NDArray[np.int64], part: Array) -> Array:
    s = part.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - s) * values[row] + s * values[row + 1])
