"""All bodies of one kind as one term on their nodes, and those that DOLFINx assembles.

Whatever the number of bodies there is one mesh and one call per residual. Coefficients are packed
once; only the nodal frames are written anew before each call, by one compiled loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.abilities import LinearisedStress, ViscousForces
from fem_lie.forms.cell_forms import FormTable
from fem_lie.forms.cell_sums import CellForm, CellSum, Pattern
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.forms.term import Pairs, Term, add_at


@dataclass(frozen=True, eq=False)
class NodalInertia:
    """Constant blocks of (x, d₁, d₂, d₃) in the pattern of a :class:`BodyTerm`.

    Attributes:
        mass: Shape (nnz, r, r), of the first ``r`` of these rows where others have none.
        damping: The same of mass-proportional damping, or ``None`` without.
    """

    mass: Array
    damping: Array | None = None


class BodyTerm(Term):
    """Elastic forces, tangent, energy and inertia of all bodies of one kind.

    Attributes:
        cells: Nodes of each cell, shape (m, k).
        count: Number of nodes.
        order: Node of this term for each node of the bodies, one body after the other.
        cell_order: Likewise its cells.
        indptr: Rows of the pattern of node pairs, with ``indices``.
        inertia: In that pattern, or ``None`` without mass.
        around: If the axes of its nodes are to follow the motion, factors ``b_ik`` of each pair in
            that pattern, shape (nnz, 3): around node i the mean deformation is ``Σ x_k ⊗ b_ik``.
        further_terms: Other terms on its nodes, such as springs and drilling.
    """

    label, of_bodies = "elements", True

    def __init__(
        self, cells: npt.NDArray[np.integer[Any]], order: Indices, cell_order: Indices
    ) -> None:
        """Find the pattern; for the arguments see the class."""
        self.cells, self.order, self.cell_order = cells, order, cell_order
        self.count = len(order)
        self.inertia: NodalInertia | None = None
        self.around: Array | None = None
        self.further_terms: list[Term] = []
        self._pattern = Pattern.of(cells, self.count)
        self.indptr, self.indices = self._pattern.indptr, self._pattern.indices

    @cached_property
    def pairs(self) -> Pairs:
        """Those of the pattern."""
        rows = np.repeat(np.arange(self.count), np.diff(self.indptr))
        return rows, self.indices.astype(np.int64)

    def summed(self, elements: Array) -> Array:
        """Blocks of element matrices (m, k, b, k, b) in the pattern, shape (nnz, b, b)."""
        size = elements.shape[2]
        blocks = np.zeros((len(self.indices), size, size))
        pairs = elements.transpose(0, 1, 3, 2, 4).reshape(-1, size, size)
        add_at(blocks, self._pattern.place, pairs)
        return blocks

    @property
    def carried_stress(self) -> Array:
        """A copy of its stress, flat; empty without."""
        update = self.stress_update
        return np.empty(0) if update is None else update.carried.copy()

    def reset(self, carried: Array) -> None:
        """Be as when it was made; ``carried``: :attr:`carried_stress` then."""
        if self.stress_update is not None:
            self.stress_update.restore(carried)
        for term in self.further_terms:
            if term.stress_update is not None:
                term.stress_update.clear_stress()

    def set_eigenstrain(self, values: Array) -> None:
        """Strains without stress of the bodies' cells, one body after the other.

        Raises:
            NotImplementedError: The bodies have no eigenstrain.
        """
        raise NotImplementedError(
            f"{type(self).__name__} ({self.label}) has no eigenstrain: expected bodies along lines"
        )


@compiled
def _gather_twists(v: Array, cells: npt.NDArray[np.int32], at: int, packed: Array) -> None:
    """Write the twists of each cell's nodes into its packed coefficients, from column ``at`` on."""
    for e in range(cells.shape[0]):
        k = at
        for i in range(cells.shape[1]):
            for j in range(6):
                packed[e, k] = v[cells[e, i], j]
                k += 1


class Assembly(BodyTerm, ViscousForces, LinearisedStress):
    """Bodies of one kind whose elements are forms of DOLFINx."""

    conserved = True
    cells: npt.NDArray[np.int32]

    def __init__(
        self,
        frames: NodalFrames,
        forms: LocalFrameForms,
        order: Indices,
        cell_order: Indices,
        eigenstrain: fem.Function | None,
    ) -> None:
        """Pack the forms and make the matrices.

        Args:
            frames: Frames in the unloaded configuration, in the nodes' order of DOLFINx.
            forms: The element in local frames.
            order: See the base class.
            cell_order: See the base class.
            eigenstrain: Strain without stress, a DG0 function that the forms contain, or ``None``
                without one.
        """
        cells = frames.function.function_space.dofmap.list
        super().__init__(cells, order, cell_order)
        self._frames, self._forms, self._eigenstrain = frames, forms, eigenstrain
        self._residual = CellForm(forms.residual, forms.residual_kernel, cells)
        known = self._residual
        self._energy = CellForm(forms.energy, kernels.energy_kernel, cells, known)
        self._tangent = CellForm(forms.tangent, kernels.tangent_kernel, cells, known)
        self._unknowns = forms.increment.function_space.dofmap.bs
        if forms.viscous is not None:
            assert forms.viscous_tangent is not None
            self._viscous = CellForm(forms.viscous, kernels.viscous_kernel, cells)
            self._viscous_tangent = CellForm(forms.viscous_tangent, kernels.tangent_kernel, cells)
            # those of the state, which come first, are apart
            self._velocity_at = forms.velocity_at - 12 * cells.shape[1]

    @property
    def viscosity(self) -> ViscousForces | None:
        """If the forms have it."""
        return None if self._forms.viscous is None else self

    @property
    def stress_update(self) -> LinearisedStress:
        """That of all cells."""
        return self

    @property
    def forms(self) -> LocalFrameForms:
        """Energy, forces and tangent, for those who call their kernels cell by cell."""
        return self._forms

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """What its energy is, see :attr:`~fem_lie.forms.local_forms.LocalFrameForms.contents`."""
        return self._forms.contents

    @property
    def matrices(self) -> Sequence[CellSum]:
        """See the base class."""
        return (self._tangent, self._viscous_tangent) if self.viscosity else (self._tangent,)

    @property
    def tables(self) -> tuple[FormTable, FormTable] | None:
        """Of forces and of energy, see :func:`~fem_lie.forms.cell_forms.add_cells`."""
        return self._residual.table, self._energy.table

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the elastic forces at frames ``H`` (count, 4, 3) to ``out``, six of each node."""
        self._residual.add_vector(H, out.reshape(-1))

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Likewise the viscous forces at twists ``v``, shape (count, 6)."""
        _gather_twists(v, self._viscous.cells, self._velocity_at, self._viscous.values)
        self._viscous.add_vector(H, out.reshape(-1))

    def energy(self, H: Array) -> float:
        """Stored energy at frames ``H``."""
        return self._energy.scalar(H)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Blocks (nnz, 6, 6) of the tangent at frames ``H``, with the carried stress."""
        return self._blocks(H, self._tangent)

    def add_tangent(self, H: Array, kept: Array, place: Indices, K: Array) -> None:
        """See the base class."""
        if self._unknowns == K.shape[1]:
            self._tangent.pack()
            self._tangent.add_matrix(H, self._pattern, place, K)
        else:
            super().add_tangent(H, kept, place, K)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Blocks (nnz, 6, 6) of the derivative in the twists; that in frames is left out."""
        return self._blocks(H, self._viscous_tangent), None

    def _blocks(self, H: Array, form: CellForm) -> Array:
        """Sum of the cells' matrices, with what they carry now, shape (nnz, u, u)."""
        form.pack()
        return form.matrix(H, self._pattern, self._unknowns)

    def set_eigenstrain(self, values: Array) -> None:
        """Strains without stress of the bodies' cells, one body after the other, shape (m, 6)."""
        assert self._eigenstrain is not None
        self._eigenstrain.x.array.reshape(-1, 6)[self.cell_order] = values
        self._residual.pack()
        self._energy.pack()

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (count, 6) from frames ``H``."""
        self._frames.frames[:] = H
        self._forms.increment.x.array[:] = h.reshape(-1)
        self._forms.carry()

    def clear_stress(self) -> None:
        """Make the carried stress zero."""
        if self._forms.stress is not None:
            self._forms.stress.x.array[:] = 0.0

    @property
    def carried(self) -> Array:
        """What is carried from iterate to iterate: stress, or the cells' own unknowns."""
        forms = self._forms
        function = forms.stress if forms.local is None else forms.local
        return np.empty(0) if function is None else function.x.array

    def restore(self, carried: Array) -> None:
        """Carry again what was carried when it was copied."""
        self.carried[:] = carried

    def reset(self, carried: Array) -> None:
        """See the base class."""
        super().reset(carried)
        self._forms.increment.x.array[:] = 0.0
        if self._eigenstrain is not None:
            self._eigenstrain.x.array[:] = 0.0
            self._residual.pack()
            self._energy.pack()

    def settle(self, H: Array) -> None:
        """Make the cells' own unknowns those of frames ``H``, if forces there depend on them.

        The elimination of unknowns in which the energy is quadratic is exact from anywhere, so that
        nothing is to be done for most elements.
        """

    def reset_stress(self, H: Array) -> None:
        """Make the carried stress the true one at frames ``H``."""
        self.carry(H, np.zeros((self.count, 6)))
