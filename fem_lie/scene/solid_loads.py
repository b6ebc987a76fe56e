"""Loads on solids: tractions and pressure on faces, body forces."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, number
from fem_lie.bodies.solids.faces import Faces
from fem_lie.bodies.solids.solid import Solid
from fem_lie.elements.shells.pressure import SurfacePushes
from fem_lie.scene.load import Carrier, Field, History, Load, NodalLoad, Sum, at_points

SOLID = Carrier("solid", Solid, "a Solid")


@dataclass(frozen=True, eq=False)
class FaceLoad(NodalLoad):
    """Force per unloaded area on a named face of a solid, fixed in space.

    Attributes:
        solid: The loaded solid.
        face: Name of the face.
        force: Three global components per area, or a function of the unloaded position.
        history: Factor as a function of time.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0)
        >>> block = fl.Solid.brick((1, 1, 2), rubber, cells=(1, 1, 2))
        >>> scene = fl.Scene()
        >>> _ = scene.add(block)
        >>> load = scene.add(fl.loads.FaceLoad(block, "c=1", (0, 0, 1e3)))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = SOLID.elsewhere("on beams: LineLoad, on shells: AreaLoad or EdgeLoad")

    solid: Solid
    face: str
    force: Field
    history: History | None = None

    following = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the solid has no such face."""
        super().check()
        self.nodal()

    def nodal(self) -> Array:
        """Consistent nodal forces, shape (n, 6)."""
        faces, x = self.solid.model.facets(self.face), self.solid.model.positions
        rule = faces.rule
        areas = np.linalg.norm(rule.normals(x, faces.nodes), axis=2)
        what = f"FaceLoad on {self.solid.label}"
        density = at_points(self.force, rule.positions(x, faces.nodes), what)
        values = np.zeros((len(x), 6))
        shares = np.einsum("gk,fg,fgj->fkj", rule.values, areas, density)
        np.add.at(values[:, :3], faces.nodes, shares)
        return values


@dataclass(frozen=True, eq=False)
class FacePressure(Load):
    """Pressure on a named face of a solid: against the outward normal, per *current* area.

    Its load stiffness is in the matrix, which is symmetric where the face is closed or ends on
    supported edges.

    Attributes:
        solid: The loaded solid.
        face: Name of the face.
        pressure: Force per area; a positive pressure acts into the body.
        gradient: Gradient of the pressure in space, at current positions, global components; with
            it the pressure is ``pressure + gradient · x``: hydrostatic pressure.
        history: Factor as a function of time.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0)
        >>> block = fl.Solid.brick((1, 1, 2), rubber, cells=(1, 1, 2))
        >>> scene = fl.Scene()
        >>> _ = scene.add(block)
        >>> load = scene.add(fl.loads.FacePressure(block, "c=1", 1e3))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = SOLID.elsewhere("on beams: PressureLoad, on shells: SurfacePressure")
    components = MappingProxyType({"gradient": 3})

    solid: Solid
    face: str
    pressure: float
    gradient: npt.ArrayLike = (0.0, 0.0, 0.0)
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if it is not finite, there is no such face, or it is not outside."""
        number(self.pressure, f"pressure on {self.solid.label}")
        super().check()
        if not self._faces.outward.all():
            raise ValueError(
                f"pressure needs a face on the outside, but {self.face!r} of {self.solid.label} "
                "lies between cells"
            )

    @property
    def _faces(self) -> Faces:
        return self.solid.model.facets(self.face)

    def contribute(self, to: Sum) -> None:
        """Add the pressure term on the facets.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        faces = self._faces
        gradient = np.asarray(self.gradient, dtype=np.float64)
        values = -faces.outward[:, np.newaxis] * np.array([self.pressure, *gradient])
        to.add_term(SurfacePushes(to.nodes(self.solid)[faces.nodes], faces.rule, values))


@dataclass(frozen=True, eq=False)
class BulkLoad(NodalLoad):
    """Force per unloaded volume in a solid or in some of its cells, fixed in space.

    Attributes:
        solid: The loaded solid.
        force: Force per unloaded volume, global components, shape (3,), or a function that
            returns it for an unloaded position.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0)
        >>> block = fl.Solid.brick((1, 1, 2), rubber, cells=(1, 1, 2))
        >>> scene = fl.Scene()
        >>> _ = scene.add(block)
        >>> load = scene.add(fl.loads.BulkLoad(block, (0, 0, -1e4)))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = SOLID.elsewhere("on beams: LineLoad, on shells: VolumeLoad")

    solid: Solid
    force: Field
    cells: str | None = None
    history: History | None = None

    following = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the solid has no such cells."""
        super().check()
        self.nodal()

    def nodal(self) -> Array:
        """Consistent nodal forces, shape (n, 6)."""
        rule, chosen = self.solid.model.rule, self.solid.model.cells_of(self.cells)
        density = at_points(self.force, rule.positions[chosen], f"BulkLoad on {self.solid.label}")
        shares = np.einsum("gk,mg,mgj->mkj", rule.values, rule.volumes[chosen], density)
        values = np.zeros((len(self.solid.frames), 6))
        np.add.at(values[:, :3], self.solid.model.connectivity[chosen], shares)
        return values
