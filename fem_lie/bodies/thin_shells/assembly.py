"""Assembly of all thin shells of one element, and the axes of their nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.elements.thin_shells import cells as kernels
from fem_lie.elements.thin_shells.bicubic import BicubicHermite, to_axes, unloaded
from fem_lie.elements.thin_shells.cell_tables import stress_at
from fem_lie.elements.thin_shells.nodal_coordinates import NODES, VECTORS
from fem_lie.forms.assembly import BodyTerm, NodalInertia
from fem_lie.forms.cell_sums import CellSum, LinearisedCellTerm
from fem_lie.lie.node_types.node_type import MIXED_DERIVATIVE, SURFACE_GRADIENT, set_axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)
from fem_lie.sections.material import Damping


@inlined
def _unit(a: Vector) -> Vector:
    return scaled(1.0 / np.sqrt(dot(a, a)), a)


@inlined
def surface_axes(along: Vector, across: Vector) -> tuple[Vector, Vector, Vector]:
    """Polar rotation of the directions of two surface gradients, and the normal."""
    a, b = _unit(along), _unit(across)
    # bisectors are perpendicular; axes of perpendicular gradients are along these
    inner, outer = _unit(plus(a, b)), _unit(minus(a, b))
    half = np.sqrt(0.5)
    first = combined(half, inner, half, outer)
    third = _unit(cross(a, b))
    return first, cross(third, first), third


@compiled
def rotate_surface_axes(coordinates: Array, moves: Flags) -> None:
    """Rotate the axes of all points with the surface, and copy positions to the second nodes.

    Args:
        coordinates: Coordinates of the SURFACE_GRADIENT nodes, then of the MIXED_DERIVATIVE nodes,
            shape (2 n, 4, 3).
        moves: Points whose axes rotate, shape (n,).
    """
    n = moves.shape[0]
    for i in range(n):
        store_row(coordinates[n + i], 0, load_row(coordinates[i], 0))
        if moves[i]:
            e1, e2, e3 = surface_axes(load_row(coordinates[i], 1), load_row(coordinates[n + i], 2))
            set_axes(SURFACE_GRADIENT, coordinates[i], e1, e2, e3)
            set_axes(MIXED_DERIVATIVE, coordinates[n + i], e1, e2, e3)


MEMBRANE_AND_BENDING = slice(0, 6)
"""Those of the eight section strains that a shell without shear has."""


class ThinShellData(Protocol):
    """Data of a thin shell that the assembly reads, see :class:`~fem_lie.ThinShell`."""

    frames: Array
    connectivity: Indices
    sizes: Array
    stiffness: Array
    axes: Array
    formulation: BicubicHermite
    damping: Damping
    has_mass: bool

    def hermite_vectors(self) -> Array:
        """Hermite vectors of each cell, shape (m, 16, 3)."""

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, 8, 4, 8, 4)."""


class ThinShellAssembly(LinearisedCellTerm, BodyTerm):
    """Assembly of thin shells of one element, with nodes and cells in the order of the bodies.

    Attributes:
        rule: Quadrature tables of the element.
        turned: Transformation of covariant strains at the points to the section axes, (m, g, 6, 6).
        stiffness: Section stiffness, shape (m, 6, 6).
    """

    def __init__(self, bodies: Sequence[ThinShellData]) -> None:
        """Pack the data of all cells; coincident nodes stay separate."""
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        pairs = zip(bodies, starts[:-1], strict=True)
        cells = np.concatenate([body.connectivity + start for body, start in pairs])
        super().__init__(cells, np.arange(starts[-1]), np.arange(len(cells)))
        element = bodies[0].formulation
        self.rule = rule = element.rule()
        sampled, strains, z = unloaded(
            rule, np.concatenate([body.hermite_vectors() for body in bodies])
        )
        self.turned, areas = to_axes(z, np.concatenate([body.axes for body in bodies]))
        section = np.concatenate([body.stiffness for body in bodies])
        self.stiffness = section[:, MEMBRANE_AND_BENDING, MEMBRANE_AND_BENDING]
        weighted = self.stiffness[:, np.newaxis] * (areas * element.weights())[..., None, None]
        D = np.einsum("mgia,mgij,mgjb->mgab", self.turned, weighted, self.turned)
        head, above = np.concatenate([body.sizes for body in bodies]), np.triu_indices(6)
        parts = (
            np.zeros((len(cells), 12 * NODES)),
            head,
            sampled,
            # components first, so that points are contiguous
            strains.transpose(0, 2, 1),
            D[:, :, above[0], above[1]].transpose(0, 2, 1),
            np.zeros_like(strains),
        )
        self._values = np.concatenate([part.reshape(len(cells), -1) for part in parts], axis=1)
        self._tables, nowhere = rule.packed(), np.zeros((len(cells), 1))

        def summed(kernel: int) -> CellSum:
            return CellSum(cells, kernel, self._values, self._tables, nowhere)

        self._energy = summed(kernels.energy_kernel.address)
        self._forces = summed(kernels.force_kernel.address)
        self._matrix = summed(kernels.tangent_kernel.address)
        self._points = strains.shape[1]
        at = stress_at(sampled.shape[1], self._points)
        self._stress = self._values[:, at:]
        storage = self._values.ctypes.data, self._values.shape[1]
        self._storage = cells, storage, int(self._tables.ctypes.data)
        self._contents = np.concatenate([head, sampled, D.reshape(len(cells), -1)], axis=1)
        if all(body.has_mass for body in bodies):
            self.inertia = self._nodal_inertia(bodies)

    def _nodal_inertia(self, bodies: Sequence[ThinShellData]) -> NodalInertia:
        parts = [body.element_inertia() for body in bodies]
        rates = [body.damping.mass for body in bodies]
        mass = self.summed(np.concatenate(parts))
        if not any(rates):
            return NodalInertia(mass)
        damped = [rate * part for rate, part in zip(rates, parts, strict=True)]
        return NodalInertia(mass, self.summed(np.concatenate(damped)))

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """Name of the energy, tables of the element, and data of the cells, for fingerprints."""
        return "bicubic Hermite thin shell", [self._tables.copy()], [self._contents]

    def strains(self, H: Array) -> Array:
        """Strains along the section axes at the quadrature points, shape (m, g, 6)."""
        found = np.empty((len(self.cells), 6, self._points))
        kernels.all_strains(H, *self._storage, found)
        return np.asarray(np.einsum("mgij,mjg->mgi", self.turned, found))

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the independent stress linearly for an increment ``h`` of all nodes."""
        kernels.update_stress(H, h.reshape(-1, 6), *self._storage)


def mass_matrices(formulation: BicubicHermite, q: Array, density: Array) -> Array:
    """Mass matrices ``∫ ρ Nₐ N_b dA`` of cells with vectors ``q`` (m, 16, 3), shape (m, 16, 16).

    Args:
        formulation: Finite element; one quadrature point more than its own is used per direction.
        q: Hermite vectors of the cells.
        density: Mass per area of each cell, shape (m,).
    """
    values, slopes, weights = formulation.surface_rule(1)
    r1, r2 = (np.einsum("ga,maj->mgj", slopes[:, k], q) for k in range(2))
    areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * weights * density[:, np.newaxis]
    assert values.shape[1] == VECTORS
    return np.asarray(np.einsum("mg,ga,gb->mab", areas, values, values, optimize=True))
