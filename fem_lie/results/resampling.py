"""Motion between recorded times: cubic interpolation, on SE(3) for nodes with frames.

**Frames.** Between ``H₀, v₀`` and ``H₁, v₁`` at a distance Δ, ``H(s) = H₀ exp(p(s))`` with the
cubic ``p`` that has ``p(0) = 0``, ``p(1) = ξ = log(H₀⁻¹ H₁)``, ``p′(0) = Δ v₀`` and
``p′(1) = Δ T(ξ)⁻¹ v₁``; the velocity is ``T(p) p′/Δ``. The interpolation is exact for a steady
screw motion and of fourth order otherwise. The same holds for nodes with a position and one
position gradient, whose length is interpolated linearly.

**Other nodes with a position** have convected axes that do not follow from their velocities. Their
position is the cubic Hermite interpolation in space, of fourth order; their axes rotate steadily
from one recorded state to the next, and their position gradients are linear in these axes, of
second order, because results do not record the rates of gradients.

**Modal coordinates** are interpolated by cubic Hermite polynomials.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.lie import node_types as node_types
from fem_lie.lie.node_types import MODAL, POSITION_GRADIENT, has_position

_OTHERWISE = ("times", "frames", "velocities", "iterations")

_SAME = 1e-9
"""Fraction of an interval within which two times are equal."""


def resampled(rows: Mapping[str, Array], kinds: Indices, times: npt.ArrayLike) -> dict[str, Array]:
    """Checked version of :func:`between`; see :meth:`fem_lie.Result.resampled`."""
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    kept = rows["times"]
    if len(kept) < 2 or not len(at):
        raise ValueError(f"expected times between two recorded ones, got {len(at)} and {len(kept)}")
    slack = _SAME * (kept[-1] - kept[0])
    if not (at.min() >= kept[0] - slack and at.max() <= kept[-1] + slack):
        raise ValueError(
            f"times must be within [{kept[0]:g}, {kept[-1]:g}], got {at.min():g} … {at.max():g}"
        )
    return between(rows, kinds, at)


def between(rows: Mapping[str, Array], kinds: Indices, at: Array) -> dict[str, Array]:
    """Arrays of results at times ``at`` (K,) within those of the rows.

    Args:
        rows: Times, frames, velocities, iterations by these names, and other arrays, which are
            interpolated linearly. Two rows with the same time are the sides of a jump, of which the
            later one counts.
        kinds: Node type of each node, :class:`~fem_lie.lie.node_types.NodeType`, shape (N,).
        at: Times; states that were recorded at them are returned unchanged.
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
        found["frames"][inside], found["velocities"][inside] = _motion(rows, kinds, row, part)
        for name in rows:
            if name not in _OTHERWISE:
                found[name][inside] = _linear(rows[name], row, part)
    return found


class _Interval(NamedTuple):
    """States of some nodes at both ends of K intervals, and the fraction of each interval.

    Attributes:
        H0: Nodal coordinates at the start, shape (K, n, 4, 3).
        v0: Recorded velocities at the start, shape (K, n, 6).
        H1: Nodal coordinates at the end.
        v1: Recorded velocities at the end.
        Δ: Lengths of the intervals, shape (K, 1, 1).
        s: Fraction of each, from 0 to 1, shape (K, 1, 1).
    """

    H0: Array
    v0: Array
    H1: Array
    v1: Array
    Δ: Array
    s: Array

    def linear(self, start: Array, end: Array) -> Array:
        """Linear interpolation of two arrays, shapes (K, n, ...)."""
        s = self.s.reshape(-1, *[1] * (start.ndim - 1))
        return np.asarray((1.0 - s) * start + s * end)

    def cubic(self, moved: Array, first: Array, last: Array) -> tuple[Array, Array]:
        """Cubic from zero to ``moved`` with the end rates ``first`` and ``last``; and its rate."""
        s, Δ = self.s, self.Δ
        first, last = Δ * first, Δ * last
        p = s**2 * (3 - 2 * s) * moved + s * (1 - s) ** 2 * first - s**2 * (1 - s) * last
        rate = 6 * s * (1 - s) * moved + (1 - s) * (1 - 3 * s) * first - s * (2 - 3 * s) * last
        return p, rate / Δ


def _motion(
    rows: Mapping[str, Array], kinds: Indices, row: Indices, part: Array
) -> tuple[Array, Array]:
    """Frames (K, N, 4, 3), velocities (K, N, 6) at fractions (K,) of the intervals after rows."""
    H, v = rows["frames"], rows["velocities"]
    found, rates = np.empty((len(row), *H.shape[1:])), np.empty((len(row), *v.shape[1:]))
    Δ, s = np.diff(rows["times"])[row, None, None], part[:, np.newaxis, np.newaxis]
    for own, way in (
        (kinds <= POSITION_GRADIENT, _on_screws),
        ((kinds > POSITION_GRADIENT) & (kinds != MODAL), _in_space),
        (kinds == MODAL, _of_modes),
    ):
        at, to = np.ix_(row, own), np.ix_(row + 1, own)
        if own.any():
            states = _Interval(H[at], v[at], H[to], v[to], Δ, s)
            found[:, own], rates[:, own] = way(states, kinds[own])
    return found, rates


def _on_screws(given: _Interval, kinds: Indices) -> tuple[Array, Array]:
    """Frames, and positions with one gradient, whose direction is one of an orthonormal frame."""
    H0, v0, stretch = _with_unit_rows(given.H0, given.v0)
    H1, v1, later = _with_unit_rows(given.H1, given.v1)
    ξ = lie.se3_relative(H0, H1)
    end = np.einsum("knij,knj->kni", lie.se3_tangent_inverse(ξ), v1)
    p, rate = given.cubic(ξ, v0, end)
    frames = lie.se3_retract(H0, p)
    velocities = np.einsum("knij,knj->kni", lie.se3_tangent(p), rate)
    length = given.linear(stretch, later)
    frames[:, :, 1] *= length
    velocities[:, :, :1] /= length
    return frames, velocities


def _with_unit_rows(H: Array, v: Array) -> tuple[Array, Array, Array]:
    """Frames and velocities along unit vectors, and the length of the position gradient."""
    H, v = H.copy(), v.copy()
    stretch = np.linalg.norm(H[:, :, 1], axis=-1, keepdims=True)
    H[:, :, 1] /= stretch
    v[:, :, :1] *= stretch
    return H, v, stretch


def _in_space(given: _Interval, kinds: Indices) -> tuple[Array, Array]:
    """Positions, and position gradients along convected axes, which rotate steadily."""
    H0, H1 = given.H0, given.H1
    axes, later = (_axes(kinds, H) for H in (H0, H1))
    local, new = (np.einsum("knri,knai->knra", H, e) for H, e in ((H0, axes), (H1, later)))
    turned = lie.so3_log(np.einsum("knai,knbi->knab", axes, later))
    R = lie.so3_exp(given.s * turned)
    now = np.einsum("knba,knbi->knai", R, axes)
    H = np.einsum("knra,knai->knri", given.linear(local, new), now)
    own = has_position(kinds)
    u0, u1 = _in_global(H0[:, own], given.v0[:, own]), _in_global(H1[:, own], given.v1[:, own])
    moved, rate = given.cubic(H1[:, own, 0] - H0[:, own, 0], u0[..., 0, :], u1[..., 0, :])
    H[:, :, 0] = given.linear(H0[:, :, 0], H1[:, :, 0])
    H[:, own, 0] = H0[:, own, 0] + moved
    _set_axes(kinds, H, now)
    v = np.zeros_like(given.v0)
    for at, w in ((slice(0, 3), rate), (slice(3, 6), given.linear(u0, u1)[..., 1, :])):
        v[:, own, at] = np.linalg.solve(H[:, own, 1:].swapaxes(-1, -2), w[..., np.newaxis])[..., 0]
    return H, v


def _of_modes(given: _Interval, kinds: Indices) -> tuple[Array, Array]:
    """Modal coordinates: six numbers in rows 1 and 2, whose rates are recorded."""
    H, shape = given.linear(given.H0, given.H1), given.v0.shape
    z, z1 = (np.reshape(rows[:, :, 1:3], shape) for rows in (given.H0, given.H1))
    moved, rate = given.cubic(z1 - z, given.v0, given.v1)
    H[:, :, 1:3] = (z + moved).reshape(*shape[:2], 2, 3)
    return H, rate


def _axes(kinds: Indices, H: Array) -> Array:
    """Axes of nodes in K states as rows, shape (K, n, 3, 3)."""
    many = np.tile(kinds, len(H))
    flat = node_types.all_axes(many, np.ascontiguousarray(H).reshape(-1, 4, 3))
    return flat.reshape(*H.shape[:2], 3, 3)


def _set_axes(kinds: Indices, H: Array, axes: Array) -> None:
    """Write axes, given as rows, into the nodal rows of K states."""
    for k in range(len(H)):
        node_types.set_all_axes(kinds, H[k], np.ascontiguousarray(axes[k]))


def _in_global(H: Array, v: Array) -> Array:
    """Translational and angular velocity in global components, shape (K, n, 2, 3)."""
    along = v.reshape(*v.shape[:2], 2, 3)
    return np.asarray(np.einsum("knai,knij->knaj", along, H[:, :, 1:]))


def _linear(values: Array, row: Indices, part: Array) -> Array:
    s = part.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - s) * values[row] + s * values[row + 1])
