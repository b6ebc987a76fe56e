"""Cells of a shell: flat coordinates, unloaded geometry, strains at quadrature points."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import basix.ufl
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem
from dolfinx import mesh as dolfinx_mesh
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie._form_cache import compile_expression, compile_form
from fem_lie.elements.shells import drilling as drilling_strain
from fem_lie.elements.shells import strains
from fem_lie.elements.shells.maps import FIVE, SIX
from fem_lie.elements.shells.measures import MITC4, StrainMeasures
from fem_lie.elements.shells.strains import ShapeFunctions, Surface
from fem_lie.elements.shells.stress_modes import StressModes
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms


@dataclass(frozen=True)
class Mixed:
    """Element-local unknowns of a mixed energy.

    Attributes:
        local: All local unknowns, for :meth:`ShellCells.forms`.
        groups: Groups of unknowns that the caller requested, in UFL.
        strain: The eight strains, in terms of nodes and intermediate unknowns.
        density: Energy density to be added to the caller's.
    """

    local: fem.Function
    groups: list[Expr]
    strain: Expr
    density: Expr | float


class ShellCells:
    """Flat coordinates, geometry and strains of the cells of a shell.

    The current frames are the unloaded state.

    Attributes:
        increment: Unknowns along nodal frames, five or six per node.
        y: Flat coordinates: positions and directors, or whole frames, of the nodes of each cell.
        strain: ``(E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂, γ₁, γ₂)`` at the quadrature point.
        drilling: Drilling strain ``c`` at that point, or ``None`` without drilling rotations.
        drilling_stiffness: Drilling stiffness γ, or ``None``.
        dx: Measure of the mid-surface.
        point: Reference coordinates of the quadrature point.
        centroid: Reference coordinates of the cell's centroid.
        frames: Nodal frames of the mesh.
        axes: Vector of each cell whose projection onto the surface is e₁, shape (cells, 3).
    """

    def __init__(
        self,
        frames: NodalFrames,
        measures: StrainMeasures = MITC4,
        *,
        drilling_stiffness: float | Array | None = None,
        directions: Array | None = None,
        relaxation: float = 0.0,
    ) -> None:
        """Evaluate the unloaded geometry.

        Args:
            frames: Nodal frames of a surface mesh, the director third.
            measures: Strain measures.
            drilling_stiffness: γ of :mod:`fem_lie.elements.shells.drilling`, force per length, one
                or one for each cell, shape (cells,), for nodes with drilling rotations.
            directions: Vector of each cell, shape (cells, 3), whose projection onto the surface is
                e₁ of strains and stresses; default: the first edge direction.
            relaxation: Relaxation time of Kelvin-Voigt damping; 0: none.

        Raises:
            ValueError: The strain measures are not for the cells or the degree of the frames.
        """
        V = frames.function.function_space
        self.frames, self.relaxation = frames, relaxation
        self.drilling_stiffness: Any = None
        self._map = FIVE if drilling_stiffness is None else SIX
        self._mesh: dolfinx_mesh.Mesh = V.mesh
        self._cell, degree = V.mesh.basix_cell(), V.ufl_element().degree
        quadrilateral = basix.CellType.quadrilateral
        if (self._cell, degree) != (measures.cell, measures.degree):
            raise ValueError(
                f"these strain measures are for cells of type {measures.cell.name} and degree "
                f"{measures.degree}, the frames are on cells of type {self._cell.name} and degree "
                f"{degree}"
            )
        element = basix.ufl.element("Lagrange", self._cell, degree, shape=(self._map.unknowns,))
        self.increment = fem.Function(fem.functionspace(self._mesh, element), name="increment")
        metadata = {"quadrature_degree": measures.quadrature_degree}
        self.dx = ufl.Measure("dx", domain=self._mesh, metadata=metadata)

        self._shapes = ShapeFunctions.of(self._cell, degree)
        nodal = frames.frames[V.dofmap.list]
        stored = nodal[:, :, [0, 3]] if drilling_stiffness is None else nodal
        self._per_node = stored.shape[2] * 3
        flat = stored.reshape(len(nodal), -1)
        self.y, unloaded = self.cellwise(flat), self.cellwise(flat)
        self._centre = (0.5, 0.5) if self._cell == quadrilateral else (1 / 3, 1 / 3)
        if directions is None:
            directions = self._shapes.combine(list(nodal[:, :, 0].swapaxes(0, 1)), self._centre, 0)
        self.axes = directions
        self._direction = self.cellwise(directions)
        self.point = self._reference_coordinates()
        self.centroid = self._centroid()

        self._skew = self.cellwise(self._skews(nodal[:, :, 0]))
        plain = self._surface(unloaded, ufl.Identity(2), ufl.Identity(2))
        self._jacobian = self.cellwise(np.zeros((len(nodal), 2, 2)))
        jacobian = strains.local_jacobian(plain, self._centre, self._direction)
        self._jacobian.interpolate(self._expression(jacobian, 0))
        here = self.at_points(strains.local_jacobian(plain, self.point, self._direction))
        self._inverse = self.at_points(ufl.inv(here))
        now, then = (self._surface(y, self._jacobian, here) for y in (self.y, unloaded))
        self._measures, self._now, self._then = measures, now, then
        self._strain_0 = self.at_points(self._cartesian(then))
        self._unloaded_strain = self._strain_0.x.array.reshape(len(nodal), -1, 8).copy()
        self.strain = self._cartesian(now) - self._strain_0
        self.drilling = None
        if drilling_stiffness is not None:
            self.drilling = self._drilling(nodal, now)
            each = np.broadcast_to(np.asarray(drilling_stiffness, dtype=np.float64), len(nodal))
            self.drilling_stiffness = self.cellwise(each)

    @property
    def jacobian(self) -> fem.Function:
        """Jacobian ``J_αi = X,α·e_i`` at the cells' centres."""
        return self._jacobian

    def set_eigenstrain(self, values: Array) -> None:
        """Set a stress-free strain of each cell, constant in the cell, shape (cells, 8)."""
        strain = self._unloaded_strain + values[:, np.newaxis]
        self._strain_0.x.array[:] = strain.ravel()

    def cellwise(self, values: Array) -> fem.Function:
        """DG0 function of given values per cell, shape ``(cells, …)``."""
        element = basix.ufl.element("DG", self._cell, 0, shape=values.shape[1:])
        f = fem.Function(fem.functionspace(self._mesh, element))
        f.x.array[:] = np.asarray(values, dtype=np.float64).ravel()
        return f

    def mixed(self, *sizes: int) -> Mixed:
        """Element-local unknowns of a mixed energy, with those of the strain measures.

        Args:
            sizes: Sizes of the groups of unknowns that the caller requests.
        """
        intermediate, drilling = self._measures.intermediate, self.drilling
        now = self._now
        modes = drilling_strain.stress_modes(self._cell, self.point)
        own = [] if drilling is None else [len(modes)]
        own += [2] if self._measures.bubble else []
        if intermediate is not None:
            start = intermediate(self._now).ufl_shape[0]
            own += [start, start]
        parts = [basix.ufl.element("DG", self._cell, 0, shape=(size,)) for size in (*sizes, *own)]
        element = parts[0] if len(parts) == 1 else basix.ufl.mixed_element(parts)
        local = fem.Function(fem.functionspace(self._mesh, element))
        groups = [local] if len(parts) == 1 else list(ufl.split(local))
        strain, density, rest = self.strain, 0.0, groups[len(sizes) :]
        if drilling is not None:
            density += drilling_strain.perturbed_lagrangian(
                rest.pop(0), modes, drilling, self.drilling_stiffness
            )
        if self._measures.bubble:
            now = replace(now, bubble=rest.pop(0))
            strain = self._cartesian(now) - self._strain_0
        if intermediate is not None:
            z, multiplier = rest
            strain = self._cartesian(replace(now, intermediate=z)) - self._strain_0
            density += ufl.inner(multiplier, z - intermediate(now))
            _, dofs = local.function_space.sub(len(groups) - 2).collapse()
            unloaded = self._expression(intermediate(self._then), 0)
            local.x.array[dofs] = unloaded.eval(self._mesh, self._all_cells()).ravel()
        return Mixed(local, groups[: len(sizes)], strain, density)

    @property
    def stresses(self) -> StressModes:
        """Stress fields of mixed elements.

        Raises:
            ValueError: There are none for these cells.
        """
        if self._measures.stresses is None:
            raise ValueError("there is no mixed element with these strain measures: use MITC4")
        return self._measures.stresses

    @property
    def has_bubble(self) -> bool:
        """Whether the cells have local unknowns that only mixed elements support."""
        return self._measures.bubble

    def stress(self, parameters: Expr) -> Expr:
        """Stress resultants ``(N, M, Q)`` at the point of integration, shape (8,)."""
        return self.stresses.field(list(parameters), self.point, self.centroid, self._jacobian)

    def _all_cells(self) -> npt.NDArray[np.int32]:
        return np.arange(len(self.y.function_space.dofmap.list), dtype=np.int32)

    def forms(
        self, energy: ufl.Form | StrainEnergy, local: fem.Function | None = None
    ) -> LocalFrameForms:
        """Differentiate, compile and wrap an energy in ``strain`` and ``drilling``.

        Args:
            energy: The energy.
            local: Element-local unknowns in it.
        """
        state = self.frames.function
        given = energy, state, self.increment, self._map
        return LocalFrameForms(*given, coordinates=self.y, local=local, relaxation=self.relaxation)

    def at_points(self, value: Expr) -> fem.Function:
        """Value that does not depend on the state, evaluated once at the quadrature points."""
        degree = self.dx.metadata()["quadrature_degree"]
        element = basix.ufl.quadrature_element(
            self._cell.name, value_shape=value.ufl_shape, degree=degree
        )
        f = fem.Function(fem.functionspace(self._mesh, element))
        f.interpolate(self._expression(value, degree))
        return f

    def _expression(self, value: Expr, degree: int) -> fem.Expression:
        return compile_expression(value, basix.make_quadrature(self._cell, degree)[0])

    def _surface(self, y: fem.Function, jacobian: Expr, here: Expr) -> Surface:
        step, count = self._per_node, self._shapes.count

        def vectors(start: int) -> list[Expr]:
            return [
                ufl.as_vector([y[step * i + start + j] for j in range(3)]) for i in range(count)
            ]

        return Surface(self._shapes, vectors(0), vectors(step - 3), jacobian, here, self._skew)

    def _cartesian(self, s: Surface) -> Expr:
        m, p = self._measures, self.point
        return strains.to_local(self._inverse, m.membrane(s, p), m.bending(s, p), m.shear(s, p))

    def _drilling(self, nodal: Array, now: Surface) -> Expr:
        """Drilling strain; unloaded nodal tangents ``a_i = R A_i`` are the axes of the centre."""
        positions = list(nodal[:, :, 0].swapaxes(0, 1))
        g1, g2 = (self._shapes.combine(positions, self._centre, k) for k in (0, 1))
        normal = np.cross(g1, g2)
        e2 = np.cross(normal, self._direction.x.array.reshape(-1, 3))
        e1 = np.cross(e2, normal)
        axes, unloaded = [], []
        for e in (e1, e2):
            unit = e / np.linalg.norm(e, axis=1)[:, np.newaxis]
            unloaded.append([self.cellwise(unit)] * self._shapes.count)
            local = np.einsum("cnkj,cj->cnk", nodal[:, :, 1:], unit)
            axes.append(self._turned(self.cellwise(local.reshape(len(nodal), -1))))
        p, inverse = self.point, self._inverse
        # not zero in a warped cell
        rest = self.at_points(drilling_strain.drilling(self._then, p, inverse, *unloaded))
        return drilling_strain.drilling(now, p, inverse, *axes) - rest

    def _turned(self, A: fem.Function) -> list[Expr]:
        """Nodal vectors ``R A``, from components of ``A`` in nodal frames."""

        def director(i: int, k: int) -> Expr:
            return ufl.as_vector([self.y[12 * i + 3 + 3 * k + j] for j in range(3)])

        return [
            sum(A[3 * i + k] * director(i, k) for k in range(3)) for i in range(self._shapes.count)
        ]

    def _skews(self, X: Array) -> Array:
        """Values of :attr:`Surface.skew`; zero except for four-node quadrilaterals."""
        if X.shape[1] != 4:
            return np.zeros((len(X), 2))
        edges = np.stack(
            [X[:, 1] - X[:, 0] + X[:, 3] - X[:, 2], X[:, 2] - X[:, 0] + X[:, 3] - X[:, 1]], axis=2
        )
        diagonal = X[:, 0] - X[:, 1] - X[:, 2] + X[:, 3]
        return np.einsum("caj,cj->ca", np.linalg.pinv(edges), diagonal)

    def _reference_coordinates(self) -> tuple[Expr, Expr]:
        """Functions equal to the reference coordinates, which FFCx does not provide."""
        element = basix.ufl.element("DG", self._cell, 1, shape=(2,))
        X = fem.Function(fem.functionspace(self._mesh, element))
        nodes = np.asarray(basix.geometry(self._cell))
        X.x.array[:] = np.tile(np.ravel(nodes), X.x.array.size // np.size(nodes))
        return X[0], X[1]

    def _centroid(self) -> fem.Function:
        f = self.cellwise(np.zeros((self.increment.function_space.dofmap.list.shape[0], 2)))
        w, one = ufl.TestFunction(f.function_space), ufl.as_vector([1.0, 1.0])
        moment = fem.assemble_vector(
            compile_form(ufl.inner(ufl.as_vector([*self.point]), w) * self.dx)
        )
        area = fem.assemble_vector(compile_form(ufl.inner(one, w) * self.dx))
        f.x.array[:] = moment.array / area.array
        return f
