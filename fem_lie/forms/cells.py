"""All cells of a scene for compiled loops: kernels by address, forces and energy of each cell.

DOLFINx assembles forms; a scheme that treats elements individually needs their contributions before
summation. Here the cells of all assemblies are one table of addresses: of the kernels of
:mod:`fem_lie.forms.kernels`, of their packed coefficients and constants, and of the coordinates of
the cells. One compiled loop evaluates all of them, whatever the elements.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numba
import numpy as np
from dolfinx import fem

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.packed_arrays import Integers1, Integers2
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.assembly import Assembly, BodyTerm
from fem_lie.forms.cell_forms import CELLS, EXTENT, KERNEL, NODES, C, X, own_coefficients
from fem_lie.forms.fixed_arrays import as_frames, as_sixes
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.kernels.addresses import call_kernel, integer_pointer, pointer
from fem_lie.forms.term import Term
from fem_lie.forms.wrapping import Entities

ENERGY, RESIDUAL, LOCAL, VISCOUS = 0, 1, 2, 3
NOTHING, COORDINATES, ITSELF = 0, 1, 2
"""Part of the energy evaluation that the force kernel has done."""


class CellArrays(NamedTuple):
    """Addresses of the data of ``M`` cells, with four kernels each.

    Attributes:
        kernel: Addresses of the kernels of energy, forces, change of local fields, viscous forces;
            0: none. Shape (M, 4), as of the next two.
        w: Address of the packed coefficients, which start with the frames of the nodes.
        c: Address of the constants.
        at: Offset in ``w`` of the local fields (first three) or of the twists (last), and of the
            energy for force kernels that compute it, shape (M, 4).
        x: Address of the coordinates of the cell, shape (M,).
        n_s: Number of local fields, shape (M,).
        unknowns: Unknowns per node, five or six, shape (M,).
        shares: What the force kernel computes of the energy: its coordinates, or the energy itself,
            see :data:`NOTHING`, shape (M,).
        first: Index of the first node of each cell in ``nodes``, shape (M + 1,).
        nodes: Nodes of the cells, in the numbering of all nodes.
    """

    kernel: Integers2
    w: Integers2
    c: Integers2
    at: Integers2
    x: Integers1
    n_s: Integers1
    unknowns: Integers1
    shares: Integers1
    first: Integers1
    nodes: Integers1


class _Form:
    """Form with packed coefficients at a fixed address."""

    def __init__(
        self, form: fem.Form, kernel: Any, entities: Entities, given: fem.Function | None
    ) -> None:
        self._form, self.kernel, self._index = form, int(kernel.address), entities.order
        self._constants = entities.constants(_compat.packed_constants(form))
        number = np.unique(entities.facets, return_inverse=True)[1]
        self.c: Indices = self._constants.ctypes.data + self._constants.strides[0] * number
        self.w = np.ascontiguousarray(self._packed())
        self.at = _compat.first_column(form, given)

    def _packed(self) -> Array:
        return _compat.packed_coefficients(self._form)[self._index]

    def pack(self) -> None:
        """Pack all coefficients again."""
        self.w[:] = self._packed()


class Cells:
    """Cells of all assemblies of a scene, and of the terms on their nodes.

    Attributes:
        table: Table of all cells.
        count: Number of cells.
        incidences: Number of pairs of a cell and one of its nodes.
    """

    def __init__(self, assemblies: Sequence[tuple[slice, BodyTerm]]) -> None:
        """Pack the data of all cells.

        Args:
            assemblies: Each assembly with its slice of all nodes.
        """
        self._forms: list[tuple[_Form, ...]] = []
        self._locals: list[tuple[Assembly, _Form]] = []
        self._coordinates: list[Array] = []
        self._of_sums: list[Array] = []
        parts = [self._rows_of_term(where.start, assembly) for where, assembly in assemblies]
        for where, assembly in assemblies:
            parts += [
                self._rows_of_term(where.start, term)
                for term in assembly.further_terms
                if not term.load
            ]
        nodes = [part.pop("nodes") for part in parts]
        sizes = np.concatenate([np.zeros(1), *(np.full(len(n), n.shape[1]) for n in nodes)])
        columns = {
            name: np.concatenate([_EMPTY[name], *(part[name] for part in parts)]) for name in _EMPTY
        }
        self.table = CellArrays(
            **columns,
            first=np.cumsum(sizes).astype(np.int64),
            nodes=np.concatenate([np.empty(0), *(n.ravel() for n in nodes)]).astype(np.int64),
        )
        self.count, self.incidences = len(self.table.x), len(self.table.nodes)

    def _rows_of_term(self, start: int, term: Term) -> dict[str, Indices]:
        """Columns of the table for one term."""
        if isinstance(term, Assembly):
            return self._rows(start, term)
        return self._rows_of_sums(start, term)

    def _rows(self, start: int, assembly: Assembly) -> dict[str, Indices]:
        """Columns of the table for one assembly of forms."""
        forms, count = assembly.forms, len(assembly.cells)
        forms.increment.x.array[:] = 0.0  # local fields are solved at the current frames
        shares, found = NOTHING, forms.local
        if forms.residual_kernel is kernels.residual_kernel:
            shares = COORDINATES
        elif forms.found_energy is not None:
            shares, found = ITSELF, forms.found_energy
        packed: list[_Form | None] = [
            _Form(
                forms.energy,
                kernels.energy_again_kernel if shares == COORDINATES else kernels.energy_kernel,
                forms.entities,
                forms.local,
            ),
            _Form(forms.residual, forms.residual_kernel, forms.entities, found),
            None,
            None,
        ]
        if forms.local is not None:
            packed[LOCAL] = _Form(
                forms.local_change, kernels.local_kernel, forms.entities, forms.local
            )
        if forms.viscous is not None:
            packed[VISCOUS] = _Form(
                forms.viscous, forms.viscous_kernels[0], forms.entities, forms.velocity
            )
        self._forms.append(tuple(form for form in packed if form is not None))
        mesh = forms.increment.function_space.mesh
        x = np.ascontiguousarray(
            mesh.geometry.x[_compat.geometry_dofmap(mesh)[forms.entities.cells]]
        )
        self._coordinates.append(x)
        steps = 8 * np.arange(count)
        filled = [_NONE if form is None else form for form in packed]
        if forms.local is not None:
            self._locals.append((assembly, filled[RESIDUAL]))
        return {
            "kernel": np.tile([form.kernel for form in filled], (count, 1)),
            "w": np.stack([form.w.ctypes.data + steps * form.w.shape[1] for form in filled], 1),
            "c": np.column_stack([np.broadcast_to(form.c, count) for form in filled]),
            "at": np.tile([form.at for form in filled], (count, 1)),
            "x": x.ctypes.data + steps * x[0].size,
            "n_s": np.full(count, 0 if forms.local is None else forms.local_size),
            "unknowns": np.full(count, forms.increment.function_space.dofmap.bs),
            "shares": np.full(count, shares),
            "nodes": start + assembly.cells.astype(np.int64),
        }

    def _rows_of_sums(self, start: int, term: Term) -> dict[str, Indices]:
        """Columns of the table for a term of sums over cells, with one form each."""
        tables = term.over_cells
        assert tables is not None, "refused before"
        (forces,), (energy,) = (table.rows for table in tables)
        count, w = int(forces[CELLS]), [own_coefficients(row) for row in (energy, forces)]
        self._of_sums += w
        none, steps = np.zeros((count, 2), dtype=np.int64), np.arange(count)
        return {
            "kernel": np.hstack([np.tile([energy[KERNEL], forces[KERNEL]], (count, 1)), none]),
            "w": np.column_stack([*(a.ctypes.data + steps * a.strides[0] for a in w), none]),
            "c": np.hstack([np.tile([energy[C], forces[C]], (count, 1)), none]),
            "at": np.hstack([none, none]),
            "x": forces[X] + 8 * forces[EXTENT] * steps,
            "n_s": none[:, 0],
            "unknowns": np.full(count, 6),
            "shares": np.full(count, NOTHING),
            "nodes": start + tables[0].nodes.reshape(count, int(forces[NODES])),
        }

    def pack(self) -> None:
        """Pack all coefficients again, after a change of eigenstrains."""
        for forms in self._forms:
            for form in forms:
                form.pack()

    def saved_state(self) -> dict[str, Array]:
        """Copies of the local fields of the cells."""
        return {
            str(k): form.w[:, form.at : form.at + assembly.forms.local_size].copy()
            for k, (assembly, form) in enumerate(self._locals)
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Set the local fields to the copies of :meth:`saved_state`."""
        at = 0
        for forms in self._forms:
            if len(forms) > LOCAL and forms[LOCAL].kernel == int(kernels.local_kernel.address):
                values = kept[str(at)]
                for form in forms[: LOCAL + 1]:
                    form.w[:, form.at : form.at + values.shape[1]] = values
                at += 1


class _No:
    """Placeholder for a form that does not exist."""

    kernel, at = 0, 0
    w, c = np.zeros((1, 0)), 0


_NONE: Any = _No()
_EMPTY: dict[str, Indices] = {
    name: np.empty(shape, dtype=np.int64)
    for name, shape in (
        ("kernel", (0, 4)),
        ("w", (0, 4)),
        ("c", (0, 4)),
        ("at", (0, 4)),
        ("x", (0,)),
        ("n_s", (0,)),
        ("unknowns", (0,)),
        ("shares", (0,)),
    )
}


@uncounted
def _frames_into(H: Array, more: Array, nodes: Indices, w: Array) -> None:
    """Frames ``H + more`` of a cell relative to the position of its first node.

    Energies do not depend on that position.
    """
    at, origin = 0, nodes[0]
    for i in range(nodes.shape[0]):
        node = nodes[i]
        for j in range(3):
            # differences of the large parts are exact, those of the small ones have all digits
            w[at] = (H[node, 0, j] - H[origin, 0, j]) + (more[node, 0, j] - more[origin, 0, j])
            at += 1
        for k in range(1, 4):
            for j in range(3):
                w[at] = H[node, k, j] + more[node, k, j]
                at += 1


@inlined
def _header(c: int) -> Indices:
    """Header of a form, see :mod:`fem_lie.forms.kernels.in_local_frames`."""
    return numba.carray(integer_pointer(c), (kernels.HEADER_SIZE,))


@uncounted
def _take_coordinates(w: Indices, c: Indices) -> None:
    """Copy the coordinates of a cell from the force kernel's data to the energy kernel's.

    The last change of local fields does not affect them.
    """
    given, taken = _header(c[RESIDUAL]), _header(c[ENERGY])
    count = given[kernels.N_Y]
    source = vector_at(pointer(w[RESIDUAL] + 8 * given[kernels.AT_Y]), count)
    target = vector_at(pointer(w[ENERGY] + 8 * taken[kernels.AT_Y]), count)
    for i in range(count):
        target[i] = source[i]


@uncounted
def evaluate(cells: CellArrays, H: Array, more: Array, F: Array, W: Array) -> None:
    """Forces ``F`` along nodal axes (p, 6), and energies ``W`` (M,), at ``H + more``.

    Local fields are solved by one step of Newton's method, exact if the energy is quadratic in
    them.
    """
    kernel, w, c, at, x, n_s, unknowns, shares, first, nodes = cells
    H, more, F = as_frames(H), as_frames(more), as_sixes(F)
    size = 1
    for e in range(x.shape[0]):
        size = max(size, 6 * (first[e + 1] - first[e]), n_s[e])
    buffer = stack(size)
    out = vector_at(buffer, size)
    for e in range(x.shape[0]):
        mine = nodes[first[e] : first[e + 1]]
        count, b = mine.shape[0], unknowns[e]
        for k in range(RESIDUAL if shares[e] else ENERGY, LOCAL + 1):
            if kernel[e, k] != 0:
                _frames_into(H, more, mine, vector_at(pointer(w[e, k]), 12 * count))
        if n_s[e] > 0:
            for i in range(n_s[e]):
                out[i] = 0.0
            call_kernel(
                kernel[e, LOCAL], buffer, pointer(w[e, LOCAL]), pointer(c[e, LOCAL]), pointer(x[e])
            )
            for k in range(LOCAL + 1):
                s = vector_at(pointer(w[e, k] + 8 * at[e, k]), n_s[e])
                for i in range(n_s[e]):
                    s[i] += out[i]
        for i in range(b * count):
            out[i] = 0.0
        call_kernel(
            kernel[e, RESIDUAL],
            buffer,
            pointer(w[e, RESIDUAL]),
            pointer(c[e, RESIDUAL]),
            pointer(x[e]),
        )
        for i in range(count):
            row = F[first[e] + i]
            row[5] = 0.0
            for k in range(b):
                row[k] = out[b * i + k]
        if shares[e] == ITSELF:
            W[e] = pointer(w[e, RESIDUAL])[at[e, RESIDUAL]]
            continue
        if shares[e] == COORDINATES:
            _take_coordinates(w[e], c[e])
        out[0] = 0.0
        call_kernel(
            kernel[e, ENERGY], buffer, pointer(w[e, ENERGY]), pointer(c[e, ENERGY]), pointer(x[e])
        )
        W[e] = out[0]


@compiled
def viscous_forces(cells: CellArrays, H: Array, v: Array, F: Array) -> None:
    """Viscous forces ``F`` (p, 6) at frames ``H`` and twists ``v`` (N, 6)."""
    kernel, w, c, at, x, _, unknowns, _, first, nodes = cells
    size = 1
    for e in range(x.shape[0]):
        size = max(size, 6 * (first[e + 1] - first[e]))
    buffer = stack(size)
    out, zero = numba.carray(buffer, (size,)), np.zeros_like(H)
    for e in range(x.shape[0]):
        mine = nodes[first[e] : first[e + 1]]
        count, b = mine.shape[0], unknowns[e]
        F[first[e] : first[e + 1]] = 0.0
        if kernel[e, VISCOUS] == 0:
            continue
        _frames_into(H, zero, mine, numba.carray(pointer(w[e, VISCOUS]), (12 * count,)))
        twists = numba.carray(pointer(w[e, VISCOUS] + 8 * at[e, VISCOUS]), (count, b))
        for i in range(count):
            for k in range(b):
                twists[i, k] = v[mine[i], k]
        out[: b * count] = 0.0
        call_kernel(
            kernel[e, VISCOUS],
            buffer,
            pointer(w[e, VISCOUS]),
            pointer(c[e, VISCOUS]),
            pointer(x[e]),
        )
        for i in range(count):
            for k in range(b):
                F[first[e] + i, k] = out[b * i + k]
