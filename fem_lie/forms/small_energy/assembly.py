"""Cells of an element of the small-energy kernel, as a term."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.abilities import ViscousForces
from fem_lie.forms.assembly import BodyTerm
from fem_lie.forms.cell_sums import CellSum, LinearisedCellTerm
from fem_lie.forms.kernels.addresses import call_kernel, pointer
from fem_lie.forms.small_energy.element import Element


class CellFunctions(NamedTuple):
    """Compiled functions of an element, made with ``callback(CELL_SIGNATURE)``.

    Attributes:
        energy: Calls :func:`.cell.add_energy`.
        forces: Calls :func:`.cell.add_forces`.
        tangent: Calls :func:`.cell.add_tangent_at_stress`.
        stress: Calls :func:`.cell.update_stress`.
        viscous_forces: Calls :func:`.cell.add_viscous_forces`, if the element is viscous.
        viscous_tangent: Calls :func:`.cell.add_viscous_tangent`, if the element is viscous.
    """

    energy: Any
    forces: Any
    tangent: Any
    stress: Any
    viscous_forces: Any = None
    viscous_tangent: Any = None


class ElementCells(LinearisedCellTerm):
    """Cells of one element on any nodes, with linearised stress."""

    def _bind(
        self,
        of: Element,
        functions: CellFunctions,
        cells: Indices,
        data: Array,
        constants: Array | None = None,
    ) -> None:
        """Bind the functions to the data.

        Args:
            of: The element.
            functions: Compiled functions of the element.
            cells: Nodes of each cell, shape (m, k).
            data: Data of the cells, see :func:`.element.cell_data`.
            constants: Constants for the functions, see :func:`.element.packed`; default: none.
        """
        self._nodes, self._functions, head = cells, functions, 12 * cells.shape[1]
        self._values = np.hstack([np.zeros((len(cells), head)), data])
        self._data = self._values[:, head:]
        self._constants = np.zeros(1) if constants is None else constants
        self._packed = 0 if constants is None else self._constants.ctypes.data
        self._energy, self._forces, self._matrix = (
            self._sum(each) for each in (functions.energy, functions.forces, functions.tangent)
        )
        self._size = of.cells.points * of.cells.strains
        self._stress = self._values[:, -self._size - of.cells.points * len(of.cells.pairs) :]

    def _sum(self, function: Any) -> CellSum:
        none = np.zeros((len(self._nodes), 1))
        return CellSum(self._nodes, function.address, self._values, self._constants, none)

    def strains(self, H: Array) -> Array:
        """Strains of all cells at coordinates ``H`` of the nodes, shape (m, points · strains)."""
        kept, found = self.linearised_values.copy(), np.zeros((len(self._nodes), self._size))
        self._update(H, np.zeros((len(H), 6)), found)
        self.restore(kept)
        return found

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the linearised stress for the increments ``h`` (n, 6) from coordinates ``H``."""
        self._update(H, h.reshape(-1, 6), np.empty((len(self._nodes), self._size)))

    def _update(self, H: Array, h: Array, strains: Array) -> None:
        at = self._values.ctypes.data, self._values.shape[1], self._packed
        _update_cells(H, h, self._nodes, self._functions.stress.address, *at, strains)


class ElementAssembly(ElementCells, BodyTerm):
    """Assembly of the cells of one element on the nodes of its bodies.

    Attributes:
        cells: Nodes of each cell, shape (m, k).
    """

    def __init__(
        self,
        of: Element,
        functions: CellFunctions,
        cells: Indices,
        data: Array,
        count: int,
        constants: Array | None = None,
    ) -> None:
        """Bind the functions to the data.

        Args:
            of: The element.
            functions: Compiled functions of the element.
            cells: Nodes of each cell, shape (m, k).
            data: Data of the cells, see :func:`.element.cell_data`.
            count: Number of nodes.
            constants: Constants for the functions, see :func:`.element.packed`; default: none.

        Raises:
            ValueError: Cells have another number of nodes than the element.
        """
        if cells.ndim != 2 or cells.shape[1] != len(of.cells.types):
            raise ValueError(
                f"cells must have {len(of.cells.types)} nodes each, got shape {cells.shape}"
            )
        super().__init__(cells, np.arange(count), np.arange(len(cells)))
        self._element = of
        self._bind(of, functions, cells, data, constants)

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """Name of the energy, products of the element, and data of the cells, for fingerprints."""
        of = self._element.cells
        return (
            "sums of products",
            [of.terms.astype(np.float64), of.factors],
            [self._data[:, : -self._stress.shape[1]]],
        )


class ViscousElementAssembly(ElementAssembly, ViscousForces):
    """Assembly of the cells of an element with viscosity."""

    @property
    def viscosity(self) -> ViscousForces:
        """Viscous forces of all cells."""
        return self

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the viscous forces at coordinates ``H`` and twists ``v`` (n, 6) to ``out``."""
        at = self._values.ctypes.data, self._values.shape[1]
        _add_viscous(H, v, self._nodes, self._functions.viscous_forces.address, *at, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, None]:
        """Derivative in the twists (nnz, 6, 6); that in frames is neglected."""
        return self._sum(self._functions.viscous_tangent).matrix(H, self._pattern), None


@compiled
def _update_cells(
    H: Array,
    h: Array,
    cells: Indices,
    function: int,
    at: int,
    width: int,
    constants: int,
    strains: Array,
) -> None:
    """Update the stress of all cells, whose data start at address ``at``, ``width`` numbers each.

    ``constants``: address of packed constants, or zero.
    """
    k, size = cells.shape[1], strains.shape[1]
    moved_at, out_at = stack(6 * k), stack(size)
    moved, out = vector_at(moved_at, 6 * k), vector_at(out_at, size)
    third = moved_at if constants == 0 else pointer(constants)
    for e in range(cells.shape[0]):
        w = pointer(at + 8 * width * e)
        _copy_nodes(H, h, cells[e], vector_at(w, 12 * k), moved)
        call_kernel(function, out_at, w, third, moved_at)
        for i in range(size):
            strains[e, i] = out[i]


@compiled
def _add_viscous(
    H: Array, v: Array, cells: Indices, function: int, at: int, width: int, forces: Array
) -> None:
    """Add the viscous forces (nodes, 6) of all cells; see :func:`_update_cells`."""
    k = cells.shape[1]
    moved_at, out_at = stack(6 * k), stack(6 * k)
    moved, out = vector_at(moved_at, 6 * k), vector_at(out_at, 6 * k)
    for e in range(cells.shape[0]):
        w = pointer(at + 8 * width * e)
        _copy_nodes(H, v, cells[e], vector_at(w, 12 * k), moved)
        for i in range(6 * k):
            out[i] = 0.0
        call_kernel(function, out_at, w, moved_at, moved_at)
        for i in range(k):
            for j in range(6):
                forces[cells[e, i], j] += out[6 * i + j]


@compiled
def _copy_nodes(H: Array, h: Array, nodes: Indices, coordinates: Array, moved: Array) -> None:
    """Copy the coordinates of a cell's nodes, and their increments or twists."""
    for i in range(nodes.shape[0]):
        for a in range(4):
            for j in range(3):
                coordinates[12 * i + 3 * a + j] = H[nodes[i], a, j]
        for j in range(6):
            moved[6 * i + j] = h[nodes[i], j]
