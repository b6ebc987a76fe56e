"""Low-rank parts of a matrix: dense blocks outside of its pattern, and corrections of factors.

A coupling of very many unknowns by few sums of them, ``U C Wᵀ`` with a small core ``C``, would be a
dense block. With the sums ``s`` and their forces ``t`` as unknowns the matrix stays sparse::

    [A   σU   0 ] [x]   [r]
    [σWᵀ  0  −σ ] [t] = [0]
    [0   −σ   C ] [s]   [0]

Corrections of a matrix with stored factors use the Sherman–Morrison–Woodbury formula::

    (S + Σ k u wᵀ)⁻¹ r = x − Z (diag(1/k) + W Z)⁻¹ W x,    x = S⁻¹ r,    Z = S⁻¹ U

Each column of ``Z`` is one more solution. It is stored until its ``u`` has rotated too far: a
matrix with the earlier ``u`` is as good for the iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeAlias

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._arrays import Array, Indices

MOST = 60
"""Largest number of rows; more belong into the matrix."""

_TURNED = 0.02
"""Relative change of ``u`` from which its column is solved for again."""

_Key: TypeAlias = tuple[bytes, int]
_Columns: TypeAlias = dict[_Key, tuple[Array, Array]]


class LowRank(NamedTuple):
    """``U C Wᵀ``, shape (n, n), a part of a matrix that is not in its pattern.

    Attributes:
        rows: Unknown of each entry of ``U`` and of ``W``, shape (l,).
        columns: Column of each entry, shape (l,).
        left: Entries of ``U``, shape (l,).
        right: Entries of ``W``, shape (l,).
        core: ``C``, shape (r, r).
        scale: ``σ``, which balances the sums and their forces, shape (r,).
    """

    rows: Indices
    columns: Indices
    left: Array
    right: Array
    core: Array
    scale: Array

    def matrix(self, size: int) -> sp.csr_matrix:
        """The part as a sparse matrix, shape (size, size)."""
        shape, indices = (size, len(self.core)), (self.rows, self.columns)
        U, W = (sp.csr_matrix((each, indices), shape=shape) for each in (self.left, self.right))
        return (U @ sp.csr_matrix(self.core) @ W.T).tocsr()

    def times(self, x: Array) -> Array:
        """``U C Wᵀ x``, shape (n,)."""
        sums = _spread(self.columns, self.right * x[self.rows], len(self.core))
        return _spread(self.rows, self.left * (self.core @ sums)[self.columns], len(x))


class Extended:
    """A matrix with the forces and sums of a low-rank part as further unknowns, in this order.

    Attributes:
        columns: Column of each entry, row by row.
        pointers: Row pointers.
    """

    def __init__(self, pointers: Indices, columns: Indices, part: LowRank) -> None:
        """Build the pattern, and the sources of its entries.

        Args:
            pointers: Row pointers of the matrix without the part.
            columns: Columns of the matrix without the part.
            part: The part; its rows and columns stay the same.
        """
        n, r, k = len(pointers) - 1, len(part.core), len(columns)
        keys, self._sums = np.unique(part.rows * r + part.columns, return_inverse=True)
        indices, ends = (keys // r, keys % r), np.cumsum([k, len(keys), len(keys), r, r * r])
        # entries are the numbers of their sources, from one: zeros would not be stored
        first = np.arange(1.0, ends[-1] + 1.0)
        own, left, right, ones, core = np.split(first, ends[:-1])
        A = sp.csr_matrix((own, columns, pointers), shape=(n, n))
        U = sp.csr_matrix((left, indices), shape=(n, r))
        W = sp.csr_matrix((right, indices), shape=(n, r))
        one, C = sp.diags(ones), sp.csr_matrix(core.reshape(r, r))
        whole = sp.bmat([[A, U, None], [W.T, None, one], [None, one, C]], format="csr")
        whole.sort_indices()
        self._from: Indices = whole.data.astype(np.int64) - 1
        self.columns: npt.NDArray[Any] = whole.indices.astype(PETSc.IntType)
        self.pointers: npt.NDArray[Any] = whole.indptr.astype(PETSc.IntType)

    def values(self, own: Array, part: LowRank) -> Array:
        """Entries, from the entries ``own`` of the matrix without the part."""
        σ = part.scale[part.columns]
        left, right = (np.bincount(self._sums, σ * each) for each in (part.left, part.right))
        return np.concatenate([own, left, right, -part.scale, part.core.ravel()])[self._from]


class LowRankCorrection(NamedTuple):
    """Correction ``Σ k u wᵀ`` with rows of few unknowns each, at least one.

    Attributes:
        first: First entry of each row, and the total at the end, shape (m + 1,).
        unknowns: Unknown of each entry, shape (l,).
        left: Entries of ``u``, shape (l,).
        right: Entries of ``w``, shape (l,).
        stiffness: ``k``, shape (m,).
    """

    first: Indices
    unknowns: Indices
    left: Array
    right: Array
    stiffness: Array

    def across(self, x: Array) -> Array:
        """``W x`` along the last axis, (…, n) to (m, …)."""
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
    """Columns ``Z`` for the stored factors."""

    def __init__(self) -> None:
        """Start without columns."""
        self._kept: _Columns = {}
        self._lefts: dict[_Key, Array] = {}

    def forget(self) -> None:
        """Delete the columns, as the factors change."""
        self._kept, self._lefts = {}, {}

    def correct(
        self, correction: LowRankCorrection, solve: Callable[[Array, Array], None], x: Array
    ) -> None:
        """Correct the solution ``x`` (n,) of the factors for all rows that were added to them.

        Args:
            correction: The rows.
            solve: Solves with the factors for its first argument into its second.
            x: Overwritten.
        """
        Z = self._columns(correction, solve, len(x))
        inner = np.diag(1.0 / correction.stiffness) + correction.across(Z)
        x -= np.linalg.solve(inner, correction.across(x)) @ Z

    def _columns(
        self, correction: LowRankCorrection, solve: Callable[[Array, Array], None], size: int
    ) -> Array:
        """``Zᵀ``, shape (m, n)."""
        kept: _Columns = {}
        Z = np.empty((len(correction.stiffness), size))
        for row, z in enumerate(Z):
            part = slice(correction.first[row], correction.first[row + 1])
            unknowns, left = correction.unknowns[part], correction.left[part]
            key, turn = unknowns.tobytes(), 0
            while (key, turn) in kept:
                turn += 1
            u, known = self._known((key, turn), left)
            if known is None:
                solve(_spread(unknowns, u, size), z)
            else:
                z[:] = known
            kept[key, turn] = u, z
        self._kept, self._lefts = kept, {}
        return Z

    def _known(self, key: _Key, left: Array) -> tuple[Array, Array | None]:
        """``u`` of a column, and the column if it is stored."""
        u, z = self._kept.get(key, (self._lefts.get(key), None))
        if u is None or np.linalg.norm(left - u) > _TURNED * np.linalg.norm(left):
            return left.copy(), None
        return u, z

    def saved_state(self) -> dict[str, Array]:
        """All ``u``, for a checkpoint."""
        unknowns = [np.frombuffer(key, dtype=np.int64) for key, _ in self._kept]
        none = np.empty(0, dtype=np.int64)
        return {
            "sizes": np.array([len(part) for part in unknowns], dtype=np.int64),
            "turns": np.array([turn for _, turn in self._kept], dtype=np.int64),
            "unknowns": np.concatenate([none, *unknowns]),
            "left": np.concatenate([np.empty(0), *(u for u, _ in self._kept.values())]),
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Solve for the columns of :meth:`saved_state` again when they are needed."""
        ends = np.cumsum(kept["sizes"])[:-1]
        keys = np.split(kept["unknowns"], ends)
        lefts = np.split(kept["left"], ends)
        turns = (int(turn) for turn in kept["turns"])
        known = zip(keys, turns, lefts, strict=False)
        self._lefts = {(key.tobytes(), turn): left for key, turn, left in known}
