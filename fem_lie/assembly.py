"""All bodies of one kind, assembled together by DOLFINx, seen as vectors and blocks on nodes.

Whatever the number of bodies there is one mesh and one call per residual. Coefficients are packed
once; only the nodal frames are written anew before each call, by one compiled loop.
"""

from __future__ import annotations

import dolfinx
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la

from fem_lie._jit import Array, Indices, compiled
from fem_lie.frames import NodalFrames
from fem_lie.kernel import LocalFrameForms


@compiled
def _gather(H: Array, cells: npt.NDArray[np.int32], packed: Array) -> None:
    """Write the frames of each cell's nodes at the head of its packed coefficients."""
    for e in range(cells.shape[0]):
        k = 0
        for i in range(cells.shape[1]):
            for a in range(4):
                for j in range(3):
                    packed[e, k] = H[cells[e, i], a, j]
                    k += 1


class _Packed:
    """A form with its constants and coefficients packed; the state comes first in them."""

    def __init__(self, form: fem.Form, cells: npt.NDArray[np.int32]) -> None:
        self.form, self.cells = form._cpp_object, cells
        self.constants = dolfinx.cpp.fem.pack_constants(self.form)
        self.coefficients = dolfinx.cpp.fem.pack_coefficients(self.form)
        (self.values,) = self.coefficients.values()  # there is one integral
        self._cpp = dolfinx.cpp.fem

    def add_vector(self, H: Array, out: Array) -> None:
        _gather(H, self.cells, self.values)
        self._cpp.assemble_vector(out, self.form, self.constants, self.coefficients)

    def scalar(self, H: Array) -> float:
        _gather(H, self.cells, self.values)
        value = self._cpp.assemble_scalar(self.form, self.constants, self.coefficients)
        return float(value)


class Assembly:
    """Elastic forces, tangent, energy and inertia of all bodies of one kind.

    A kind of element derives from it and builds its forms in ``__init__`` from its bodies.

    Attributes:
        count: Number of nodes.
        order: Node of this assembly for each node of the bodies, one body after the other.
        indptr: Rows of the pattern of node pairs, with ``indices``.
        inertia: Constant blocks ``G`` of that pattern, shape (nnz, 4, 4), or ``None`` without mass.
    """

    def __init__(
        self,
        frames: NodalFrames,
        forms: LocalFrameForms,
        order: Indices,
        inertia: Array | None,
    ) -> None:
        """Pack the forms and make the matrix.

        Args:
            frames: Frames in the unloaded configuration, in the nodes' order of DOLFINx.
            forms: The element in local frames.
            order: See the class.
            inertia: See the class.
        """
        self.order, self.inertia = order, inertia
        self.count = len(order)
        self._frames, self._forms = frames, forms
        cells = frames.function.function_space.dofmap.list
        self._residual = _Packed(forms.residual, cells)
        self._energy = _Packed(forms.energy, cells)
        self._matrix = fem.create_matrix(forms.tangent)
        self.indptr, self.indices = self._matrix.indptr, self._matrix.indices

    def add_forces(self, H: Array, out: Array) -> None:
        """Add the elastic forces at frames ``H`` (count, 4, 3) to ``out``, shape (6 count,)."""
        self._residual.add_vector(H, out)

    def energy(self, H: Array) -> float:
        """Stored energy at frames ``H``."""
        return self._energy.scalar(H)

    def tangent(self, H: Array) -> Array:
        """Blocks (nnz, 6, 6) of the tangent at frames ``H``, with the carried stress."""
        self._frames.frames[:] = H
        self._matrix.set_value(np.float64(0.0))
        fem.assemble_matrix(self._matrix, self._forms.tangent)
        return np.asarray(self._matrix.data, dtype=np.float64).reshape(-1, 6, 6)

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (6 count,) from frames ``H``."""
        self._frames.frames[:] = H
        self._forms.increment.x.array[:] = h
        self._forms.carry()

    def reset_stress(self, H: Array) -> None:
        """Make the carried stress the true one at frames ``H``."""
        self.carry(H, np.zeros(6 * self.count))


def consistent_inertia(density: fem.Function, weight: ufl.core.expr.Expr) -> la.MatrixCSR:
    """Consistent matrix ``∫ weight density N_i N_j dx`` of (x, d₁, d₂, d₃), blocks of 4.

    Args:
        density: Gram matrix per length of each cell, a DG0 function of shape (4, 4).
        weight: Factor of the measure, e.g. arc length over chord.
    """
    mesh = density.function_space.mesh
    V = fem.functionspace(mesh, ("Lagrange", 1, (4,)))
    u, w = ufl.TrialFunction(V), ufl.TestFunction(V)
    matrix = fem.assemble_matrix(fem.form(weight * ufl.inner(density * u, w) * ufl.dx))
    return matrix
