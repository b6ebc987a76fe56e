"""Sums over cells: nodes, a kernel and packed data, and the pattern of their matrix.

A cell is any set of nodes, in any order; cells may share nodes. Its kernel is a compiled function
of UFCx's signature, ``kernel(A, w, c, x, …)``: it reads the coordinates of the nodes at the head of
the cell's data ``w``, constants ``c`` and coordinates ``x`` of the cell, and adds a number, forces
or a matrix to ``A``. :class:`CellForm` sums DOLFINx forms, :class:`CellSum` any kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie import _compat
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.abilities import LinearisedStress
from fem_lie.forms.cell_forms import (
    CELLS,
    EXTENT,
    FIRST,
    WIDTH,
    C,
    FormArrays,
    W,
    X,
    add_blocks,
    add_forces,
    energy_of,
    of_cells,
)
from fem_lie.forms.term import Pairs, Term
from fem_lie.forms.wrapping import Entities


class Pattern(NamedTuple):
    """Sparsity pattern: pairs of nodes that share a cell.

    Attributes:
        indptr: Start of each node's row, shape (count + 1,).
        indices: Second node of each pair, increasing in each row, shape (nnz,).
        pair_index: Index of each pair of nodes of each cell, shape (m k k,).
    """

    indptr: Indices
    indices: Indices
    pair_index: Indices

    @classmethod
    def of(cls, cells: npt.NDArray[np.integer[Any]], count: int) -> Pattern:
        """Pattern of cells (m, k) on ``count`` nodes; each node is paired with itself."""
        first, second = cells.astype(np.int64)[:, :, np.newaxis], cells[:, np.newaxis]
        own = np.arange(count, dtype=np.int64) * (count + 1)
        found = (count * first + second).ravel()
        keys, pair_index = np.unique(np.concatenate([own, found]), return_inverse=True)
        indptr = np.searchsorted(keys // count, np.arange(count + 1))
        return cls(indptr, keys % count, pair_index.ravel()[count:].astype(np.int64))

    def restricted(self, cells: Indices, count: int) -> Pattern:
        """The same pattern for some of the ``count`` cells that it was made for."""
        return self._replace(pair_index=self.pair_index.reshape(count, -1)[cells].ravel())


class CellSum:
    """Kernel summed over cells.

    Attributes:
        cells: Nodes of each cell, shape (m, k).
        values: Data of each cell, at a fixed address, shape (m, any).
        arrays: Table for :func:`~fem_lie.forms.cell_forms.add_forces`.
        unknowns: Number of unknowns of a node in the kernel's matrices.
        used: Number of these with entries, the first ones.
        own_only: Whether matrices are summed over the cells of :meth:`choose` only.
    """

    unknowns: int = 6
    used: int = 6
    own_only: bool = False

    def __init__(
        self,
        cells: npt.NDArray[np.integer[Any]],
        kernel: int,
        values: Array,
        constants: Array,
        coordinates: Array,
        *,
        written: int = 0,
    ) -> None:
        """Store the data that the kernel reads.

        Args:
            cells: Nodes of each cell, shape (m, k).
            kernel: Address of the kernel.
            values: Data of each cell, whose first 12 k numbers are overwritten by nodal
                coordinates.
            constants: Constants, the same for all cells.
            coordinates: Coordinates of each cell, shape (m, any).
            written: Number of coefficients that are written for each cell, at least the nodal
                coordinates, and that ``values`` are without: the kernel reads a copy on the stack.
        """
        self.cells, rows = cells, 12 * cells.shape[1]
        self.values, self._x = (np.ascontiguousarray(a, np.float64) for a in (values, coordinates))
        self._constants = constants
        least = 0 if written else rows
        if self.values.shape != (len(cells), max(self.values.shape[1], least)):
            raise ValueError(
                f"cells of shape {cells.shape} need data of shape ({len(cells)}, ≥ {least}), got "
                f"{self.values.shape}"
            )
        row = [kernel, *cells.shape, 0, *_address_and_width(self.values), constants.ctypes.data]
        row += [*_address_and_width(self._x), written]
        self.table = FormArrays(np.array([row], dtype=np.int64), cells.ravel().astype(np.int64))
        self._plain: tuple[Indices, Indices] = (self.table[0], self.table[1])

    def add_vector(self, H: Array, out: Array) -> None:
        """Add forces at nodal coordinates ``H``, six per node, shape (6 count,)."""
        add_forces(H, self._plain, out)

    def add_matrix(self, H: Array, pattern: Pattern, index: Indices, out: Array) -> None:
        """Add matrices at coordinates ``H`` to blocks (any, ≥ u, ≥ u) at ``index`` of the pairs."""
        arrays, pairs = self._plain, pattern.pair_index
        if self.own_only:
            arrays, pairs = self._own, pairs.reshape(len(self.cells), -1)[self._chosen].ravel()
        size = self.unknowns
        add_blocks(H, arrays, pairs, index, size, min(size, self.used), out)

    def choose(self, cells: Flags) -> None:
        """Choose the cells of matrices while :attr:`own_only` is set, shape (m,)."""
        own = of_cells(self.table, np.split(cells, np.cumsum(self.table.rows[:-1, CELLS])))
        self._chosen, self._own = cells, (own.rows, own.nodes)

    def share(self, count: int) -> Array:
        """Fraction of the cells at each node that matrices include, shape (count, 1)."""
        if not self.own_only:
            return np.ones((count, 1))
        own, every = (
            np.bincount(cells.ravel(), minlength=count)
            for cells in (self.cells[self._chosen], self.cells)
        )
        return (own / np.maximum(every, 1))[:, np.newaxis]

    def matrix(self, H: Array, pattern: Pattern) -> Array:
        """Matrix at coordinates ``H`` in blocks of the pattern, shape (nnz, u, u)."""
        count = len(pattern.indices)
        blocks = np.zeros((count, self.unknowns, self.unknowns))
        self.add_matrix(H, pattern, np.arange(count), blocks)
        return blocks

    def scalar(self, H: Array) -> float:
        """Sum of a scalar kernel."""
        return float(energy_of(H, self._plain))


class CellTerm(Term):
    """Term of three sums over cells: energy, forces, matrix, which subclasses set."""

    _energy: CellSum
    _forces: CellSum
    _matrix: CellSum
    _pattern: Pattern

    @cached_property
    def pairs(self) -> Pairs:
        """First and second node of each block of the pattern."""
        count = len(self._pattern.indptr) - 1
        rows = np.repeat(np.arange(count), np.diff(self._pattern.indptr))
        return rows, self._pattern.indices.astype(np.int64)

    @property
    def matrices(self) -> Sequence[CellSum]:
        """Sum over cells of the tangent."""
        return (self._matrix,)

    @property
    def tables(self) -> tuple[FormArrays, FormArrays] | None:
        """Tables of forces and of energy."""
        return self._forces.table, self._energy.table

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at nodal coordinates ``H`` to ``out``, six per node."""
        self._forces.add_vector(H, out.reshape(-1))

    def energy(self, H: Array) -> float:
        """Stored energy at nodal coordinates ``H``, J."""
        return self._energy.scalar(H)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness at nodal coordinates ``H``, shape (nnz, 6, 6)."""
        return self._matrix.matrix(H, self._pattern)

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add the tangent stiffness to blocks ``K`` at ``index``."""
        self._matrix.add_matrix(H, self._pattern, index, K)


class LinearisedCellTerm(CellTerm, LinearisedStress):
    """Term of sums over cells with independent stress, ``_stress`` (m, any), in its matrix."""

    _stress: Array

    @property
    def stress_update(self) -> LinearisedStress:
        """Independent stress of all cells."""
        return self

    @property
    def linearised_values(self) -> Array:
        """Independent stress of all cells, flat."""
        return self._stress.ravel()

    def restore(self, values: Array) -> None:
        """Set the stress to an earlier copy of :attr:`linearised_values`."""
        self._stress[:] = values.reshape(self._stress.shape)

    def clear_stress(self) -> None:
        """Set the stress to zero."""
        self._stress[:] = 0.0

    def reset_stress(self, H: Array) -> None:
        """Set the stress to that of frames ``H``."""
        self.update_stress(H, np.zeros((len(self._pattern.indptr) - 1, 6)))


class CellForm(CellSum):
    """DOLFINx form with packed constants and coefficients; the state is the first coefficient.

    Forms with the same coefficients after those that are written for each cell share their values.
    """

    cells: npt.NDArray[np.int32]

    def __init__(
        self,
        form: fem.Form,
        kernel: Any,
        cells: npt.NDArray[np.int32],
        entities: Entities,
        written: int,
        other: CellForm | None = None,
    ) -> None:
        """Pack constants and coefficients.

        Args:
            form: Form with one integral.
            kernel: See :mod:`fem_lie.forms.kernels`.
            cells: Nodes of each entity's cell.
            entities: Cells, or facets, over which the form is integrated.
            written: Number of coefficients, the first ones, that are written for each cell.
            other: A form on the same cells, whose coordinates are shared, and whose coefficients
                are shared if they are the same.
        """
        self._form, self.cells, self._entities = form, cells, entities
        self._written, self._stored = written, _compat.coefficients_from(form, written)
        plain = all(map(_compat.has_plain_values, self._stored))
        self._sources = list(map(_compat.values_and_dofs, self._stored)) if plain else None
        constants = entities.constants(_compat.packed_constants(form))
        if other is None:
            mesh = form.mesh
            x = mesh.geometry.x[_compat.geometry_dofmap(mesh)[entities.cells]]
            x = x.reshape(len(cells), -1)
            values = self._packed()
        else:
            x, same = other._x, self._stored == other._stored
            values = other.values if same else self._packed()
        super().__init__(cells, int(kernel.address), values, constants, x, written=written)
        self._split(entities.sizes)

    def _packed(self) -> Array:
        """Packed coefficients without those that are written for each cell."""
        return _compat.packed_coefficients(self._form)[self._entities.order, self._written :]

    def _split(self, sizes: Indices) -> None:
        """Make one row of the table for each local number, with constants of its own."""
        first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        rows = np.repeat(self.table.rows, len(sizes), axis=0)
        rows[:, CELLS], rows[:, FIRST] = sizes, first * self.cells.shape[1]
        rows[:, [W, X]] += 8 * first[:, np.newaxis] * rows[:, [WIDTH, EXTENT]]
        rows[:, C] += self._constants.strides[0] * np.arange(len(sizes))
        self.table = FormArrays(rows, self.table.nodes)
        self._plain = (rows, self.table.nodes)

    def pack(self) -> None:
        """Pack all coefficients again, one after the other, as all take much memory."""
        if self._sources is None:
            self.values[:] = self._packed()
            return
        cells, at = self._entities.cells, 0
        for values, dofs in self._sources:
            end = at + dofs.shape[1] * values.shape[1]
            self.values[:, at:end] = values[dofs[cells]].reshape(len(cells), -1)
            at = end


def _address_and_width(array: Array) -> tuple[int, int]:
    """Address of an array, and length of its rows."""
    return array.ctypes.data, array.shape[1]
