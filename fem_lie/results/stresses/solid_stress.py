"""Cauchy stress of solids in any state: at integration points, averaged at nodes, in files."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array, instance
from fem_lie._form_cache import compile_expression
from fem_lie.bodies.solids.solid import Solid
from fem_lie.elements.solids.element import QUADRATURE, Strains, cellwise
from fem_lie.elements.solids.stretch import StressFreeStretch
from fem_lie.forms.frames import NodalFrames
from fem_lie.mesh.shapes import nodes_of, rule, tabulated
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.results.states import States, nodes_in, require_states, state_number
from fem_lie.results.stresses.fields import Fields, check_name
from fem_lie.results.stresses.stress_free import strains_in
from fem_lie.scene import Scene
from fem_lie.sections.solid_materials import SolidMaterial

CellExpression: TypeAlias = Callable[[Strains, SolidMaterial, Sequence[Expr]], Expr]


@dataclass(frozen=True, eq=False, repr=False)
class SolidStresses(Fields):
    """Cauchy stress of a solid, force per current area, global components.

    Attributes:
        solid: The solid, with m cells and n nodes.
        frames: Coordinates of its nodes, shape (n, 4, 3).
        at_points: Stress at the integration points of the energy, shape (m, g, 3, 3).
        points: Current positions of these points, shape (m, g, 3).
        nodal: Stress extrapolated linearly to the nodes in each cell, and averaged there with the
            volumes of the cells as weights, shape (n, 3, 3).
    """

    solid: Solid
    frames: Array
    at_points: Array
    points: Array
    nodal: Array

    @property
    def _body(self) -> Solid:
        return self.solid

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities."""
        return tuple(_QUANTITIES)

    def raw(self, name: str) -> Array:
        """A quantity at the integration points, shape (m, g).

        Args:
            name: "von Mises" (``√(3/2 s:s)`` with the deviator s), "pressure" (``−tr σ/3``), or a
                component such as "xy".

        Raises:
            ValueError: There is no such quantity; likewise in the following methods.
        """
        return self._of(name, self.at_points)

    def mean(self, name: str) -> Array:
        """A quantity of the mean stress of each cell, shape (m,).

        Args:
            name: Name of the quantity, such as "von Mises".
        """
        volumes = _volumes(self.solid)
        total = np.einsum("mg,mgij->mij", volumes, self.at_points)
        return self._of(name, total / volumes.sum(axis=1)[:, np.newaxis, np.newaxis])

    def smooth(self, name: str) -> Array:
        """A quantity of the averaged stress, at the nodes, shape (n,).

        Args:
            name: Name of the quantity, such as "von Mises".
        """
        return self._of(name, self.nodal)

    def _of(self, name: str, stress: Array) -> Array:
        check_name(name, _QUANTITIES, self.solid.label)
        return _QUANTITIES[name](stress)

    @property
    def displacements(self) -> Array:
        """Displacements of the nodes, shape (n, 3)."""
        return np.asarray(self.frames[:, 0] - self.solid.model.positions)

    def function(self, name: str) -> fem.Function:
        """A quantity as a continuous DOLFINx function on the undeformed mesh, for VTX files.

        Args:
            name: ``"displacement"``, ``"stress"``, or as for :meth:`smooth`.

        Raises:
            ValueError: There is no such quantity.
        """
        given = {"displacement": self.displacements, "stress": self.nodal}
        values = given[name] if name in given else self.smooth(name)
        mesh, shape = self.solid.model.mesh.mesh, values.shape[1:]
        element = ("P", self.solid.model.degree, shape) if shape else ("P", self.solid.model.degree)
        f = fem.Function(fem.functionspace(mesh, element), name=name)
        rows = f.x.array.reshape(len(values), -1)
        rows[f.function_space.dofmap.list] = values.reshape(len(values), -1)[
            self.solid.model.connectivity
        ]
        return f

    # --- files and pictures ---

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write the deformed solid for ParaView, pyvista or meshio.

        Point data: ``displacement``, ``stress`` (nine components, row by row), ``von Mises`` and
        ``pressure``.

        Args:
            path: Name of the ``.vtu`` file.

        Raises:
            ValueError: The name does not end in ``.vtu``.
        """
        from fem_lie.pictures.vtk import write_volume

        data = {
            "displacement": self.displacements,
            "stress": self.nodal.reshape(-1, 9),
        }
        data |= {name: self.smooth(name) for name in ("von Mises", "pressure")}
        write_volume(path, self.solid.model.space, self.frames[:, 0], data)

    def picture(
        self,
        path: str | os.PathLike[str],
        name: str = "von Mises",
        *,
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the deformed solid, coloured by a quantity, and the outline of the undeformed one.

        Args:
            path: Name of the ``.png`` file.
            name: As for :meth:`smooth`.
            title: Title of the picture; default: what is drawn.
            units: Units of the axes and the colour scale.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: The name does not end in ``.png``, or there is no such quantity.
        """
        from fem_lie.pictures.bodies import DrawnSurface, draw_values

        skin = self.solid.model.boundary
        draw_values(
            path,
            DrawnSurface(skin, skin.nodes, self.solid.model.positions),
            self.frames[:, 0],
            self.smooth(name),
            f"{name} [{units.force}/{units.length}²]",
            Canvas(title or f"{name} of {self.solid.label}", units, view=view),
        )


def solid_stresses(
    result: States, solid: Solid, state: int = -1, *, scene: Scene | None = None
) -> SolidStresses:
    """Cauchy stress of a solid in one state of a result.

    Args:
        result: A result of statics, of a path or of dynamics, of a scene with the solid.
        solid: The solid.
        state: Index of the state; default: the last.
        scene: The scene that was solved; needed if the solid has stress-free strains there, such
            as a :class:`~fem_lie.loads.Temperature`.

    Raises:
        ValueError: The solid is not in that result, there is no such state, or stress-free
            strains of the solid are not known.
        TypeError: An argument is not a result, or not a solid.
    """
    require_states(result)
    instance(solid, Solid, "solid_stresses: solid", "a Solid")
    number = state_number(state, len(result.frames))
    (strains,) = strains_in(result, solid, [number], scene)
    frames = result.frames[number]
    own = np.ascontiguousarray(frames[nodes_in(result.info, solid)])
    degree = solid.model.degree
    points, _ = rule(solid.model.mesh.cell, QUADRATURE[solid.model.mesh.cell, degree])
    at_points = CellValues(solid, Strains.cauchy, strains).at(points)(own)
    shapes = tabulated(solid.model.mesh.cell, degree, points)[0]
    positions = np.einsum("gk,mkj->mgj", shapes, own[solid.model.connectivity, 0])
    return SolidStresses(solid, own, at_points, positions, _averaged(solid, points, at_points))


class CellValues:
    """Values of an expression in the strains, the law and its parameters, in all cells."""

    def __init__(
        self, solid: Solid, expression: CellExpression, strains: Array | None = None
    ) -> None:
        """Build the expression.

        Args:
            solid: The solid.
            expression: From strains, constitutive law and parameters to UFL.
            strains: Stress-free strain of each cell, shape (m, 6); default: none.
        """
        self._solid, model = solid, solid.model
        mesh, degree = model.mesh.mesh, model.degree
        self._strains = model.formulation.strains(NodalFrames(mesh, degree), degree)
        if strains is not None:
            free = StressFreeStretch(mesh, solid.label)
            free.set(strains)
            self._strains = self._strains.from_stretched(free.inverse)
        parameters = [cellwise(mesh, column) for column in model.parameters.T]
        self._expression = expression(self._strains, model.material, parameters)

    def at(self, points: Array) -> Callable[[Array], Array]:
        """Function from nodal coordinates (n, 4, 3) to values at reference points, (m, g, …)."""
        compiled = compile_expression(self._expression, points)
        mesh, cells = self._solid.model.mesh.mesh, np.arange(self._solid.model.mesh.cells)

        def evaluate(frames: Array) -> Array:
            self._strains.set_nodes(frames[self._solid.model.connectivity])
            found = compiled.eval(mesh, cells.astype(np.int32))
            shape = len(cells), len(points), *self._expression.ufl_shape
            return np.asarray(found.reshape(shape))

        return evaluate


def _volumes(solid: Solid) -> Array:
    """Unloaded volume of each integration point of the energy, shape (m, g)."""
    model = solid.model
    points, w = rule(model.mesh.cell, QUADRATURE[model.mesh.cell, model.degree])
    slopes = tabulated(model.mesh.cell, model.degree, points)[1:]
    x = model.positions[model.connectivity]
    return np.asarray(w * np.abs(np.linalg.det(np.einsum("kgi,mij->mgkj", slopes, x))))


def _averaged(solid: Solid, points: Array, values: Array) -> Array:
    """Nodal stress from linear least-squares fits in each cell, shape (n, 3, 3)."""
    corners = nodes_of(solid.model.mesh.cell, solid.model.degree)
    if len(points) == 1:
        spread = np.ones((len(corners), 1))
    else:
        linear = [np.column_stack([np.ones(len(x)), x]) for x in (points, corners)]
        spread = linear[1] @ np.linalg.pinv(linear[0])
    volumes = solid.model.rule.volumes.sum(axis=1)
    shares = np.einsum("kg,mgij,m->mkij", spread, values, volumes, optimize=True)
    total, weight = np.zeros((len(solid.frames), 3, 3)), np.zeros(len(solid.frames))
    np.add.at(total, solid.model.connectivity, shares)
    np.add.at(weight, solid.model.connectivity, volumes[:, np.newaxis])
    return np.asarray(total / weight[:, np.newaxis, np.newaxis])


def _von_mises(stress: Array) -> Array:
    deviator = stress + _pressure(stress)[..., np.newaxis, np.newaxis] * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.einsum("...ij,...ij->...", deviator, deviator)))


def _pressure(stress: Array) -> Array:
    return np.asarray(-np.trace(stress, axis1=-2, axis2=-1) / 3)


def _component(i: int, j: int) -> Callable[[Array], Array]:
    return lambda stress: stress[..., i, j]


_QUANTITIES: dict[str, Callable[[Array], Array]] = {
    "von Mises": _von_mises,
    "pressure": _pressure,
    "xx": _component(0, 0),
    "yy": _component(1, 1),
    "zz": _component(2, 2),
    "xy": _component(0, 1),
    "xz": _component(0, 2),
    "yz": _component(1, 2),
}
