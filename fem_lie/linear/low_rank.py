"""Changes of low rank beside a matrix whose factors are kept (Sherman, Morrison and Woodbury).

::

    (S + Σ k u wᵀ)⁻¹ r = x − Z (diag(1/k) + W Z)⁻¹ W x,    x = S⁻¹ r,    Z = S⁻¹ U

Each column of ``Z`` is one more solution. It is kept with its ``u`` until that has turned, for a
matrix with the former ``u`` is as good a one to iterate with.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices

MOST = 60
"""Rows beyond which they belong into the matrix."""

_TURNED = 0.02
"""Part of itself by which ``u`` may be another before its column is solved for again."""

_Key: TypeAlias = tuple[bytes, int]
_Columns: TypeAlias = dict[_Key, tuple[Array, Array]]


class Beside(NamedTuple):
    """``Σ k u wᵀ`` of rows of few unknowns each, at least one.

    Attributes:
        first: Of each row the first of its unknowns, and their number at the end, shape (m + 1,).
        unknowns: Shape (l,).
        left: ``u`` there, shape (l,).
        right: ``w``.
        stiffness: ``k``, shape (m,).
    """

    first: Indices
    unknowns: Indices
    left: Array
    right: Array
    stiffness: Array

    def across(self, x: Array) -> Array:
        """``W x`` for each of the last axis, (…, n) to (m, …)."""
        products = self.right * x[..., self.unknowns]
        return np.moveaxis(np.add.reduceat(products, self.first[:-1], axis=-1), -1, 0)

    def times(self, x: Array) -> Array:
        """``Σ k u (w·x)``, shape (n,)."""
        forces = np.repeat(self.stiffness * self.across(x), np.diff(self.first))
        return _spread(self.unknowns, self.left * forces, len(x))


def _spread(unknowns: Indices, values: Array, size: int) -> Array:
    """Sums of the values at each unknown, shape (size,)."""
    out: Array = np.zeros(size)
    np.add.at(out, unknowns, values)
    return out


class Columns:
    """Columns ``Z`` for the factors that are kept."""

    def __init__(self) -> None:
        """There are none."""
        self._kept: _Columns = {}
        self._lefts: dict[_Key, Array] = {}

    def forget(self) -> None:
        """With other factors."""
        self._kept, self._lefts = {}, {}

    def correct(self, beside: Beside, solve: Callable[[Array, Array], None], x: Array) -> None:
        """Make the solution ``x`` (n,) with the factors that with all rows beside them.

        Args:
            beside: The rows.
            solve: With the factors, for its first argument into its second.
            x: Overwritten.
        """
        Z = self._columns(beside, solve, len(x))
        inner = np.diag(1.0 / beside.stiffness) + beside.across(Z)
        x -= np.linalg.solve(inner, beside.across(x)) @ Z

    def _columns(self, beside: Beside, solve: Callable[[Array, Array], None], size: int) -> Array:
        """``Zᵀ``, shape (m, n)."""
        kept: _Columns = {}
        Z = np.empty((len(beside.stiffness), size))
        for row, z in enumerate(Z):
            part = slice(beside.first[row], beside.first[row + 1])
            unknowns, left = beside.unknowns[part], beside.left[part]
            place, turn = unknowns.tobytes(), 0
            while (place, turn) in kept:
                turn += 1
            u, known = self._known((place, turn), left)
            if known is None:
                solve(_spread(unknowns, u, size), z)
            else:
                z[:] = known
            kept[place, turn] = u, z
        self._kept, self._lefts = kept, {}
        return Z

    def _known(self, key: _Key, left: Array) -> tuple[Array, Array | None]:
        """``u`` of a column, and the column if it is kept."""
        u, z = self._kept.get(key, (self._lefts.get(key), None))
        if u is None or np.linalg.norm(left - u) > _TURNED * np.linalg.norm(left):
            return left.copy(), None
        return u, z

    def arrays(self) -> dict[str, Array]:
        """All ``u``, for a checkpoint."""
        unknowns = [np.frombuffer(place, dtype=np.int64) for place, _ in self._kept]
        none = np.empty(0, dtype=np.int64)
        return {
            "columns.sizes": np.array([len(part) for part in unknowns], dtype=np.int64),
            "columns.turns": np.array([turn for _, turn in self._kept], dtype=np.int64),
            "columns.unknowns": np.concatenate([none, *unknowns]),
            "columns.left": np.concatenate([np.empty(0), *(u for u, _ in self._kept.values())]),
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Have the columns of :meth:`arrays` again, when they are asked for."""
        ends = np.cumsum(kept["columns.sizes"])[:-1]
        places = np.split(kept["columns.unknowns"], ends)
        lefts = np.split(kept["columns.left"], ends)
        turns = (int(turn) for turn in kept["columns.turns"])
        known = zip(places, turns, lefts, strict=False)
        self._lefts = {(place.tobytes(), turn): left for place, turn, left in known}
