"""Assembly of all bodies of one kind as one term, and by DOLFINx.

There is one mesh and one call per residual for any number of bodies. Coefficients are packed once;
only the nodal frames are updated before each call, by one compiled loop.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.abilities import LinearisedStress, LocalUnknowns, ViscousForces
from fem_lie.forms.cell_forms import FormArrays
from fem_lie.forms.cell_sums import CellForm, CellSum, Pattern
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.forms.term import Pairs, Term, add_at

_EXTENSION, _UNSTRESSED = 1e-3, 1e-3
"""Extension whose forces are the reference for those without load, and the largest fraction: a
strain of 1e-6."""

_LOCAL_ITERATIONS, _SETTLED = 20, 1e-13
"""Newton's method for local unknowns of cells: most steps, and largest relative change at the end.
"""


@dataclass(frozen=True, eq=False)
class NodalInertia:
    """Constant mass matrix in (x, d₁, d₂, d₃), in the pattern of a :class:`BodyTerm`.

    Attributes:
        mass: Blocks, shape (nnz, r, r), of the first ``r`` coordinate vectors if others have no
            mass.
        damping: Blocks of mass-proportional damping, or ``None``.
        drilling: Rotary inertia of drilling rotations, blocks that :attr:`mass` does not contain,
            or ``None``.
    """

    mass: Array
    damping: Array | None = None
    drilling: Array | None = None


class BodyTerm(Term):
    """Elastic forces, tangent stiffness, energy and inertia of all bodies of one kind.

    Attributes:
        cells: Nodes of each cell, shape (m, k).
        count: Number of nodes.
        order: Node of this term for each node of the bodies, one body after the other.
        cell_order: Cell of this term for each cell of the bodies.
        indptr: Row starts of the pattern of node pairs, with ``indices``.
        inertia: Mass matrix in that pattern, or ``None`` without mass; shells compute it at each
            call, as statics has no use for it.
        around: Factors ``b_ik`` of each pair in that pattern, shape (nnz, 3), 1/m, if nodal axes
            are convected: the mean deformation around node i is ``Σ x_k ⊗ b_ik``.
        further_terms: Other terms on its nodes, such as springs and drilling.
    """

    label, of_bodies = "elements", True
    inertia: NodalInertia | None = None

    def __init__(
        self,
        cells: npt.NDArray[np.integer[Any]],
        order: Indices,
        cell_order: Indices,
        pattern: Pattern | None = None,
    ) -> None:
        """Take nodes and cells; for the arguments see the class.

        Args:
            cells: Nodes of each cell.
            order: See the class.
            cell_order: See the class.
            pattern: Pattern of more pairs than those of the cells; default: these.
        """
        self.cells, self.order, self.cell_order = cells, order, cell_order
        self.count = len(order)
        self.around: Array | None = None
        self.further_terms: list[Term] = []
        self._pattern = Pattern.of(cells, self.count) if pattern is None else pattern
        self.indptr, self.indices = self._pattern.indptr, self._pattern.indices

    @cached_property
    def pairs(self) -> Pairs:
        """First and second node of each block of the pattern."""
        rows = np.repeat(np.arange(self.count), np.diff(self.indptr))
        return rows, self.indices.astype(np.int64)

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        known = self.inertia
        return 0.0 if known is None else float(known.mass[:, 0, 0].sum())

    def summed(self, elements: Array) -> Array:
        """Sum element matrices (m, k, b, k, b) to blocks of the pattern, shape (nnz, b, b)."""
        size = elements.shape[2]
        blocks = np.zeros((len(self.indices), size, size))
        pairs = elements.transpose(0, 1, 3, 2, 4).reshape(-1, size, size)
        add_at(blocks, self._pattern.pair_index, pairs)
        return blocks

    @property
    def stress_values(self) -> Array:
        """Copy of the independent stress, flat; empty if there is none."""
        update = self.stress_update
        return np.empty(0) if update is None else update.linearised_values.copy()

    def reset(self, values: Array) -> None:
        """Restore the initial state; ``values`` are the initial :attr:`stress_values`."""
        if self.stress_update is not None:
            self.stress_update.restore(values)
        for term in self.further_terms:
            if term.stress_update is not None:
                term.stress_update.clear_stress()

    def set_eigenstrain(self, values: Array) -> None:
        """Set the eigenstrains of the bodies' cells, one body after the other, shape (m, s).

        Raises:
            NotImplementedError: The bodies have no eigenstrain.
        """
        raise NotImplementedError(
            f"{type(self).__name__} ({self.label}) has no eigenstrain: expected beams or shells"
        )


@compiled
def _gather_twists(v: Array, cells: npt.NDArray[np.int32], at: int, packed: Array) -> None:
    """Write the twists of each cell's nodes into its packed coefficients from column ``at`` on."""
    for e in range(cells.shape[0]):
        k = at
        for i in range(cells.shape[1]):
            for j in range(6):
                packed[e, k] = v[cells[e, i], j]
                k += 1


def _is_of_user(thing: object) -> bool:
    """Whether a function, a class, or the class of an object is not of the package."""
    return thing is not None and not str(thing.__module__).startswith("fem_lie.")


class Assembly(BodyTerm, ViscousForces, LinearisedStress, LocalUnknowns):
    """Bodies of one kind whose elements are DOLFINx forms.

    The pattern is that of all cells of the mesh, also if the forms are over some cells or facets.
    A virtual work without energy is a load.
    """

    conserved = True
    cells: npt.NDArray[np.int32]

    def __init__(
        self,
        frames: NodalFrames,
        forms: LocalFrameForms,
        order: Indices,
        cell_order: Indices,
        eigenstrain: Callable[[Array], None] | None,
    ) -> None:
        """Pack the forms and allocate the matrices.

        Args:
            frames: Frames in the unloaded configuration, in DOLFINx's order of nodes.
            forms: Forms of the element in local frames.
            order: See :class:`BodyTerm`.
            cell_order: See :class:`BodyTerm`.
            eigenstrain: Sets the eigenstrains of all cells of the mesh, shape (m, s), in the forms;
                ``None`` without.
        """
        every, entities = frames.function.function_space.dofmap.list, forms.entities
        cells, pattern = every[entities.cells], Pattern.of(every, len(order))
        super().__init__(cells, order, cell_order, pattern.restricted(entities.cells, len(every)))
        self._frames, self._forms, self._set_strains = frames, forms, eigenstrain
        self._strained: Array = np.empty((0, 0))
        self._nonlinear = not forms.local_is_linear
        if not forms.has_energy:
            self.load = self.turning = True
            self.conserved, self.label = False, "virtual work"

        def sum_of(
            form: fem.Form, kernel: Any, known: CellForm | None = None, further: int = 0
        ) -> CellForm:
            written = 12 * cells.shape[1] + further
            return CellForm(form, kernel, cells, entities, written, known)

        # the kernel of forces solves for the change of local fields
        self._residual = sum_of(forms.residual, forms.residual_kernel, None, forms.local_size)
        known = self._residual
        if forms.has_energy:
            self._energy = sum_of(forms.energy, kernels.energy_kernel, known)
        self._tangent = sum_of(forms.tangent, kernels.tangent_kernel, known)
        self._tangent.unknowns = forms.increment.function_space.dofmap.bs
        if forms.viscous is not None:
            assert forms.viscous_tangent is not None
            of_forces, of_tangent = forms.viscous_kernels
            self._viscous = sum_of(forms.viscous, of_forces)
            self._viscous_tangent = sum_of(forms.viscous_tangent, of_tangent)
            self._viscous_tangent.unknowns = self._tangent.unknowns
            # coefficients of the state, which come first, are not stored
            self._velocity_at = forms.velocity_at - 12 * cells.shape[1]

    def require_no_stress(self, formulation: object, law: object = None) -> None:
        """Raise an error if an element or law of a user has forces in the unloaded configuration.

        Elements and laws of the package are not checked here: tests do that.

        Args:
            formulation: The element.
            law: Function or class of the material, if it may be the user's.

        Raises:
            ValueError: There are.
        """
        element, material = _is_of_user(formulation), _is_of_user(law)
        if (element or material) and (found := self.initial_stress()):
            name = type(formulation).__name__ if element else getattr(law, "__name__", "the law")
            remedy = (
                "Subtract the strains of that configuration from those in the energy: "
                "strain - fem_lie.extend.present_values(strain, mesh, degree)"
                if element
                else "An energy of C must have zero derivative at C = 1, as "
                "tr C - 3 - ln det C, where tr C - 3 alone has not"
            )
            raise ValueError(
                f"{name}: the {'element' if element else 'material'} has forces in the unloaded "
                f"configuration ({found}): bodies would be under stress before they are loaded. "
                f"{remedy}"
            )

    def initial_stress(self) -> str:
        """Size of the forces in the unloaded configuration; empty if they are round-off.

        They are compared with those of a uniform extension.
        """
        kept, forces = self.linearised_values.copy(), np.zeros((2, self.count, 6))
        for extension, out in zip((0.0, _EXTENSION), forces, strict=True):
            H = self._frames.frames.copy()
            H[:, 0] *= 1.0 + extension
            self.reset_stress(H)
            self.add_forces(H, out)
        self.restore(kept)
        initial, extended = np.abs(forces).max(axis=(1, 2), initial=0.0)
        if initial <= _UNSTRESSED * extended:
            return ""
        return f"up to {initial:.3g}; an extension by {_EXTENSION:g} has {extended:.3g}"

    @property
    def viscosity(self) -> ViscousForces | None:
        """Viscous forces, if the forms have any."""
        return None if self._forms.viscous is None else self

    @property
    def stress_update(self) -> LinearisedStress:
        """Independent stress of all cells."""
        return self

    @property
    def forms(self) -> LocalFrameForms:
        """Energy, forces and tangent, for schemes that call kernels cell by cell."""
        return self._forms

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """Contents of the energy, :attr:`~fem_lie.forms.local_forms.LocalFrameForms.contents`."""
        return self._forms.contents

    @property
    def matrices(self) -> Sequence[CellSum]:
        """Sums over cells of the tangent, and of the viscous tangent if there is one."""
        return (self._tangent, self._viscous_tangent) if self.viscosity else (self._tangent,)

    @property
    def tables(self) -> tuple[FormArrays, FormArrays] | None:
        """Tables of forces and of energy, see :func:`~fem_lie.forms.cell_forms.add_forces`.

        ``None`` with local unknowns, which are packed at each call, and without energy.
        """
        if self._forms.local is not None or not self._forms.has_energy:
            return None
        return self._residual.table, self._energy.table

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the elastic forces at frames ``H`` (count, 4, 3) to ``out``, six per node."""
        if self._forms.local is not None:
            self._residual.pack()
        self._residual.add_vector(H, out.reshape(-1))

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the viscous forces at frames ``H`` and twists ``v`` (count, 6) to ``out``."""
        _gather_twists(v, self._viscous.cells, self._velocity_at, self._viscous.values)
        self._viscous.add_vector(H, out.reshape(-1))

    def energy(self, H: Array) -> float:
        """Stored energy at frames ``H``; local unknowns are first solved for these frames."""
        if not self._forms.has_energy:
            return 0.0
        if self._forms.local is not None:
            self.reset_stress(H)
            self._energy.pack()
        return self._energy.scalar(H)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness (nnz, 6, 6) at frames ``H``, with the current independent stress."""
        return self._blocks(H, self._tangent)

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add the tangent stiffness at frames ``H`` to blocks ``K`` at ``index``."""
        self._tangent.pack()
        self._tangent.add_matrix(H, self._pattern, index, K)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Derivative in the twists (nnz, 6, 6); that in frames is neglected."""
        return self._blocks(H, self._viscous_tangent), None

    def _blocks(self, H: Array, form: CellForm) -> Array:
        """Sum of the cells' matrices with the current coefficients, shape (nnz, u, u)."""
        form.pack()
        return form.matrix(H, self._pattern)

    def set_eigenstrain(self, values: Array) -> None:
        """Set the eigenstrains of the bodies' cells, one body after the other, shape (m, s)."""
        assert self._set_strains is not None
        self._strained = np.empty_like(values)
        self._strained[self.cell_order] = values
        self._set_strains(self._strained)
        self._residual.pack()
        self._energy.pack()

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the independent stress for the increment ``h`` (count, 6) from frames ``H``."""
        frames = self._frames.frames
        before = frames.copy()  # users' own frames stay where they are
        frames[:], self._forms.increment.x.array[:] = H, h.reshape(-1)
        self._forms.update_stress()
        frames[:] = before

    def clear_stress(self) -> None:
        """Set the independent stress to zero."""
        if self._forms.stress is not None:
            self._forms.stress.x.array[:] = 0.0

    @property
    def linearised_values(self) -> Array:
        """Values updated between iterates: stress, or local unknowns of the cells, flat."""
        forms = self._forms
        function = forms.stress if forms.local is None else forms.local
        return np.empty(0) if function is None else function.x.array

    def restore(self, values: Array) -> None:
        """Set the values to an earlier copy of :attr:`linearised_values`."""
        self.linearised_values[:] = values

    def reset(self, values: Array) -> None:
        """Restore the initial state, without eigenstrain."""
        super().reset(values)
        self._forms.increment.x.array[:] = 0.0
        if len(self._strained):
            self.set_eigenstrain(np.zeros_like(self._strained))

    @property
    def local(self) -> LocalUnknowns | None:
        """Local unknowns, if forces depend on them; else condensation is exact."""
        return self if self._nonlinear else None

    def condense(self, H: Array) -> None:
        """Solve for the local unknowns of the cells at frames ``H``."""
        self.reset_stress(H)

    def reset_stress(self, H: Array) -> None:
        """Set the independent stress to that of frames ``H``, or solve for the local unknowns.

        Nonlinear equations are solved by Newton's method in each cell.
        """
        still = np.zeros((self.count, 6))
        for _ in range(_LOCAL_ITERATIONS if self._nonlinear else 1):
            before = self.linearised_values.copy()
            self.update_stress(H, still)
            change = np.abs(self.linearised_values - before).max(initial=0.0)
            if change <= _SETTLED * np.abs(before).max(initial=0.0):
                return
