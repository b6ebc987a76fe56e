"""Motion between the times that were kept: cubics on SE(3).

Between ``H₀, v₀`` and ``H₁, v₁`` at a distance Δ, ``H(s) = H₀ exp(p(s))`` with the cubic ``p`` that
has ``p(0) = 0``, ``p(1) = ξ = log(H₀⁻¹ H₁)``, ``p′(0) = Δ v₀``, ``p′(1) = Δ T(ξ)⁻¹ v₁``; the
velocity is ``T(p) p′/Δ``. A steady screw motion is met exactly, any other to fourth order. The
length of a slope, which is no unit vector, is taken linearly.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices

_OTHERWISE = ("times", "frames", "velocities", "iterations")

_SAME = 1e-9
"""Part of an interval within which two times are the same."""


def resampled(rows: Mapping[str, Array], times: npt.ArrayLike) -> dict[str, Array]:
    """:func:`between` at times that are checked; see :meth:`fem_lie.Result.resampled`."""
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    kept = rows["times"]
    if len(kept) < 2 or not len(at):
        raise ValueError(f"wanted times between two that were kept, got {len(at)} and {len(kept)}")
    slack = _SAME * (kept[-1] - kept[0])
    if not (at.min() >= kept[0] - slack and at.max() <= kept[-1] + slack):
        raise ValueError(
            f"times must be within [{kept[0]:g}, {kept[-1]:g}], got {at.min():g} … {at.max():g}"
        )
    return between(rows, at)


def between(rows: Mapping[str, Array], at: Array) -> dict[str, Array]:
    """Arrays of results at times ``at`` (K,) within those of the rows.

    Args:
        rows: Times, frames, velocities, iterations by these names, and others, which are taken
            linearly; two rows of one time are the sides of a jump, of which the later one counts.
        at: Times; states that were kept at them are given as they are.
    """
    kept = rows["times"]
    row = np.clip(np.searchsorted(kept, at, side="right") - 1, 0, max(len(kept) - 2, 0))
    after = np.minimum(row + 1, len(kept) - 1)
    span = kept[after] - kept[row]
    part = np.divide(at - kept[row], span, out=np.zeros(len(at)), where=span > 0.0)
    part = np.where(part < _SAME, 0.0, np.where(part > 1.0 - _SAME, 1.0, part))
    nearest, inside = np.where(part < 1.0, row, after), (part > 0.0) & (part < 1.0)
    found = {name: values[nearest] for name, values in rows.items()}
    found["times"] = at.copy()
    row, part = row[inside], part[inside]
    if len(row):
        found["frames"][inside], found["velocities"][inside] = _motion(rows, row, part)
        for name in rows:
            if name not in _OTHERWISE:
                found[name][inside] = _linear(rows[name], row, part)
    return found


def _motion(rows: Mapping[str, Array], row: Indices, part: Array) -> tuple[Array, Array]:
    """Frames (K, N, 4, 3) and velocities (K, N, 6) in parts (K,) of the intervals after rows."""
    Δ, s = np.diff(rows["times"])[row, None, None], part[:, np.newaxis, np.newaxis]
    (H0, v0, stretch), (H1, v1, later) = (_with_unit_rows(rows, k) for k in (row, row + 1))
    ξ = lie.se3_relative(H0, H1)
    end = np.einsum("knij,knj->kni", lie.se3_tangent_inverse(ξ), v1)
    first, last = Δ * v0, Δ * end
    p = s**2 * (3 - 2 * s) * ξ + s * (1 - s) ** 2 * first - s**2 * (1 - s) * last
    rate = 6 * s * (1 - s) * ξ + (1 - s) * (1 - 3 * s) * first - s * (2 - 3 * s) * last
    frames = lie.se3_retract(H0, p)
    velocities = np.einsum("knij,knj->kni", lie.se3_tangent(p), rate / Δ)
    between_both = (1.0 - s) * stretch + s * later
    frames[:, :, 1] *= between_both
    velocities[:, :, :1] /= between_both
    return frames, velocities


def _with_unit_rows(rows: Mapping[str, Array], row: Indices) -> tuple[Array, Array, Array]:
    """Frames and velocities along unit vectors, and the length of the first: slopes have one."""
    H, v = rows["frames"][row].copy(), rows["velocities"][row].copy()
    stretch = np.linalg.norm(H[:, :, 1], axis=-1, keepdims=True)
    H[:, :, 1] /= stretch
    v[:, :, :1] *= stretch
    return H, v, stretch


def _linear(values: Array, row: Indices, part: Array) -> Array:
    s = part.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - s) * values[row] + s * values[row + 1])
