"""Reissner-Mindlin shells: the same strains as displacement, Hellinger-Reissner and Hu-Washizu.

Each formulation is a few lines of energy here; differentiation, condensation of the element's own
parameters, local frames and the carried stress are those of :mod:`fem_lie.kernel`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import _compat
from fem_lie._jit import Array
from fem_lie.elements import shell_strains as strains
from fem_lie.elements.shell_maps import FIVE
from fem_lie.elements.shell_modes import STRESSES, stress
from fem_lie.elements.shell_strains import Point, ShapeFunctions, Surface
from fem_lie.frames import NodalFrames
from fem_lie.kernel import FrameMap, LocalFrameForms, StrainEnergy

Measure = Callable[[Surface, Point], Expr]


@dataclass(frozen=True)
class ShellStrain:
    """Which strain measures a shell element has."""

    membrane: Measure = strains.membrane
    bending: Measure = strains.bending
    shear: Measure = strains.mitc4_shear


class ShellCells:
    """The cells of a shell: flat coordinates ``y``, unloaded state, geometry.

    Attributes:
        frames: Nodal frames, with the director as third.
        increment: Local-frame unknowns.
        y: Positions and directors of the nodes of each cell.
        strain: The eight Cartesian strains at the point of integration.
        dx: Measure of the mid-surface.
    """

    def __init__(
        self,
        frames: NodalFrames,
        measures: ShellStrain | None = None,
        *,
        quadrature_degree: int = 3,
        directions: Array | None = None,
        frame_map: FrameMap = FIVE,
    ) -> None:
        """Take the frames as they are for the unloaded state."""
        measures = ShellStrain() if measures is None else measures
        self.frames, self.frame_map = frames, frame_map
        V = frames.function.function_space
        self.mesh, cell = V.mesh, V.mesh.basix_cell()
        degree = V.ufl_element().degree
        self.increment = fem.Function(
            fem.functionspace(
                self.mesh, basix.ufl.element("Lagrange", cell, degree, shape=(frame_map.unknowns,))
            ),
            name="increment",
        )
        nodes = V.dofmap.list.shape[1]
        self.dx = ufl.Measure(
            "dx", domain=self.mesh, metadata={"quadrature_degree": quadrature_degree}
        )
        self.shapes = ShapeFunctions.of(cell, degree)
        unloaded = frames.frames[V.dofmap.list][:, :, [0, 3]].reshape(-1, 6 * nodes)
        self.y, self.unloaded = self.cellwise(unloaded), self.cellwise(unloaded)
        self.point = self._reference_coordinates()
        self.surface = self._surface(self.y)
        self.surface_0 = self._surface(self.unloaded)
        self.centre = (1 / 3, 1 / 3) if cell == basix.CellType.triangle else (0.5, 0.5)
        self.centroid = self._centroid()
        self.direction = self.cellwise(self._directions() if directions is None else directions)
        self.strain = self._strain(measures)

    def cellwise(self, values: Array) -> fem.Function:
        """DG0 function of given values per cell, shape ``(cells, …)``."""
        element = basix.ufl.element("DG", self.mesh.basix_cell(), 0, shape=values.shape[1:])
        f = fem.Function(fem.functionspace(self.mesh, element))
        f.x.array[:] = np.asarray(values, dtype=np.float64).ravel()
        return f

    def parameters(self, *sizes: int) -> fem.Function:
        """Element-local fields of given sizes, for condensation."""
        cell = self.mesh.basix_cell()
        parts = [basix.ufl.element("DG", cell, 0, shape=(size,)) for size in sizes]
        element = parts[0] if len(parts) == 1 else basix.ufl.mixed_element(parts)
        return fem.Function(fem.functionspace(self.mesh, element))

    def jacobian(self, p: Point) -> Expr:
        """``J_αi = X,α·e_i``, see :func:`fem_lie.elements.shell_strains.local_jacobian`."""
        return strains.local_jacobian(self.surface_0, p, self.direction)

    def forms(
        self, energy: ufl.Form | StrainEnergy, local: fem.Function | None = None
    ) -> LocalFrameForms:
        """Differentiate, compile and wrap."""
        state = self.frames.function
        return LocalFrameForms(
            energy, state, self.increment, self.frame_map, coordinates=self.y, local=local
        )

    def _strain(self, measures: ShellStrain) -> Expr:
        p = self.point
        inverse = self.at_points(ufl.inv(self.jacobian(p)))

        def of(s: Surface) -> Expr:
            parts = measures.membrane(s, p), measures.bending(s, p), measures.shear(s, p)
            return strains.to_local(inverse, *parts)

        return of(self.surface) - self.at_points(of(self.surface_0))

    def at_points(self, value: Expr) -> fem.Function:
        """What does not change with the state, evaluated once at the points of integration."""
        cell, degree = self.mesh.basix_cell(), self.dx.metadata()["quadrature_degree"]
        element = basix.ufl.quadrature_element(
            _compat.cell_name(self.mesh.ufl_domain()), value_shape=value.ufl_shape, degree=degree
        )
        f = fem.Function(fem.functionspace(self.mesh, element))
        points, _ = basix.make_quadrature(cell, degree)
        f.interpolate(fem.Expression(value, points))
        return f

    def _surface(self, y: fem.Function) -> Surface:
        def vector(start: int) -> Expr:
            return ufl.as_vector([y[start + j] for j in range(3)])

        nodes = range(0, y.ufl_shape[0], 6)
        return Surface(self.shapes, [vector(i) for i in nodes], [vector(i + 3) for i in nodes])

    def _reference_coordinates(self) -> tuple[Expr, Expr]:
        """FFCx has no reference coordinates: a function that is equal to them."""
        cell = self.mesh.basix_cell()
        element = basix.ufl.element("DG", cell, 1, shape=(2,))
        X = fem.Function(fem.functionspace(self.mesh, element))
        nodes = basix.geometry(cell)
        X.x.array[:] = np.tile(nodes.ravel(), X.x.array.size // nodes.size)
        return X[0], X[1]

    def _centroid(self) -> fem.Function:
        element = basix.ufl.element("DG", self.mesh.basix_cell(), 0, shape=(2,))
        V = fem.functionspace(self.mesh, element)
        w, one = ufl.TestFunction(V), ufl.as_vector([1.0, 1.0])
        moment = fem.assemble_vector(fem.form(ufl.inner(ufl.as_vector([*self.point]), w) * self.dx))
        area = fem.assemble_vector(fem.form(ufl.inner(one, w) * self.dx))
        f = fem.Function(V)
        f.x.array[:] = moment.array / area.array
        return f

    def _directions(self) -> Array:
        """``X,₁`` at the cells' centres."""
        weights = [
            self.shapes.combine([1.0 * (i == j) for j in range(self.nodes)], self.centre, 0)
            for i in range(self.nodes)
        ]
        positions = self.unloaded.x.array.reshape(-1, self.nodes, 6)[:, :, :3]
        return np.einsum("i,cij->cj", weights, positions)

    @property
    def nodes(self) -> int:
        """Nodes per cell."""
        return int(self.unloaded.ufl_shape[0]) // 6


Law = Callable[[Expr], Expr]


def linear_law(stiffness: Expr) -> Law:
    """``½ ε·Dε`` with the section stiffness ``D``, shape (8, 8)."""
    return lambda e: 0.5 * ufl.inner(e, stiffness * e)


def displacement(cells: ShellCells, law: Law) -> LocalFrameForms:
    """``∫ W(ε)``: with the measures of :class:`ShellStrain` the MITC4 element."""
    return cells.forms(StrainEnergy(cells.strain, law, cells.dx))


def hellinger_reissner(cells: ShellCells, compliance: Expr) -> LocalFrameForms:
    """``∫ S·ε − ½ S·D⁻¹S`` with 14 stress parameters per cell.

    Args:
        cells: Four-node quadrilaterals.
        compliance: ``D⁻¹``, shape (8, 8).
    """
    s = cells.parameters(STRESSES)
    S = stress(list(s), cells.point, cells.centroid, cells.jacobian(cells.centre))
    energy = (ufl.inner(S, cells.strain) - 0.5 * ufl.inner(S, compliance * S)) * cells.dx
    return cells.forms(energy, s)


def hu_washizu(cells: ShellCells, law: Law) -> LocalFrameForms:
    """``∫ W(e) + S·(ε − e)`` with 14 stress and 14 strain parameters per cell.

    Args:
        cells: Four-node quadrilaterals.
        law: Energy per area, any UFL function of the eight strains.
    """
    local = cells.parameters(STRESSES, STRESSES)
    s, a = ufl.split(local)
    J = cells.jacobian(cells.centre)
    S = stress(list(s), cells.point, cells.centroid, J)
    e = stress(list(a), cells.point, cells.centroid, J)
    return cells.forms((law(e) + ufl.inner(S, cells.strain - e)) * cells.dx, local)
