"""Borders of surfaces: what nodes carry of them, and where they go straight on."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices

_STRAIGHT = 0.9  # cosine


def border_shares(number: Indices, along: Array, length: Array) -> tuple[Array, Array]:
    """Length of border that each end carries, and whether it goes on straight there, (b, 2)."""
    count = int(number.max(initial=-1)) + 1
    flat, twice = number.ravel(), np.repeat(along, 2, axis=0)
    halves = np.repeat(0.5 * length, 2)
    share = np.asarray(np.bincount(flat, halves, minlength=count), dtype=np.float64)
    # directions of lines, whatever their sense
    square = np.zeros((count, 3, 3))
    np.add.at(square, flat, np.einsum("bi,bj->bij", twice, twice))
    ahead = np.einsum("bi,bij,bj->b", twice, square[flat], twice) - 1.0
    two = np.bincount(flat, minlength=count)[flat] == 2
    straight = (two & (ahead > _STRAIGHT**2)).astype(np.float64)
    return share[number], straight.reshape(-1, 2)
