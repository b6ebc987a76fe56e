"""Solid bodies: hexahedra or tetrahedra with nodal positions and convected axes."""

from __future__ import annotations

import logging

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, whole
from fem_lie.bodies.body import Point, Where
from fem_lie.bodies.position_model import PositionBody
from fem_lie.bodies.solids.model import SolidMaterials, SolidModel
from fem_lie.elements.solids.element import SolidFormulation
from fem_lie.mesh.reading import volume_from_dolfinx
from fem_lie.mesh.volumes import VolumeMesh, brick
from fem_lie.sections.material import Damping
from fem_lie.sections.solid_materials import SolidMaterial

_log = logging.getLogger(__name__)


class Solid(PositionBody):
    """Solid of hexahedra or tetrahedra, of any hyperelastic material.

    Its nodes have positions. Their axes rotate with the adjacent cells when a state is accepted.
    The motion does not depend on these axes, but the matrix of a tumbling body changes less. Axes
    along which nodes are held, or to which joints are bound, do not rotate.

    Joints, springs, drives and moments act on a patch of nodes by :meth:`point`; forces and
    supports may act on nodes, too.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3)
        >>> block = fl.Solid.brick((1, 1, 2), rubber, cells=(1, 1, 2))
    """

    model: SolidModel

    def __init__(
        self,
        mesh: VolumeMesh | dolfinx.mesh.Mesh,
        material: SolidMaterials,
        *,
        degree: int | None = None,
        formulation: SolidFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Volume mesh, or a DOLFINx mesh.
            material: Material of all cells, or one for each named group, all of one law.
            degree: Degree of the interpolation, 1 or 2; default: that of the mesh.
            formulation: Finite element; default: :class:`~fem_lie.elements.MeanDilatation` for
                hexahedra of degree 1, else :class:`~fem_lie.elements.Isoparametric`.
            damping: Damping of motion, and of strain with one relaxation time; default: none.
            name: Name in messages and results.

        Raises:
            ValueError: The mesh has no volume cells or inverted cells, a cell has no material or
                another law, the element does not support the cells, tetrahedra of degree 1 would
                lock, or strains have several relaxation times.
            TypeError: An argument has an unexpected type.
        """
        if isinstance(mesh, dolfinx.mesh.Mesh):
            mesh = volume_from_dolfinx(mesh)
        instance(mesh, VolumeMesh, "Solid: mesh", "a VolumeMesh; see block(), read_gmsh_volume()")
        instance(formulation, SolidFormulation | None, "Solid: formulation", "an element or None")
        degree = mesh.degree if degree is None else whole(degree, "Solid: degree")
        if degree > 2:
            raise ValueError(f"Solid: degree must be 1 or 2, got {degree!r}")
        names = type(self).__name__, name
        damping = Damping.of_body(damping, "Solid")
        super().__init__(SolidModel(mesh, degree, material, formulation, damping, *names))
        if (mesh.cell, degree) == ("tetrahedron", 1):
            _log.warning(
                "%s has tetrahedra of degree 1, which are much too stiff in bending and lock with "
                "nearly incompressible material: Solid(…, degree=2) is not",
                self.label,
            )

    @classmethod
    def brick(
        cls,
        lengths: npt.ArrayLike,
        material: SolidMaterial,
        *,
        cells: tuple[int, int, int],
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        cell: str = "hexahedron",
        degree: int = 1,
        formulation: SolidFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Solid:
        """Box with edges along the axes, divided into equal cells.

        Its faces are "a=0", "a=1", "b=0", … with a, b and c along x, y and z, its edges the curves
        "a=0,b=0" and so on, its corners the points "000" to "111".

        Args:
            lengths: Lengths of its edges, shape (3,).
            material: See :class:`Solid`.
            cells: Numbers of cells along x, y and z.
            origin: Corner with the smallest coordinates.
            cell: ``"hexahedron"`` or ``"tetrahedron"``.
            degree: Degree of the interpolation.
            formulation: Finite element.
            damping: Damping of motion, and of strain with one relaxation time; default: none.
            name: Name in messages and results.
        """
        mesh = brick(lengths, cells, origin=origin, cell=cell)
        return cls(
            mesh, material, degree=degree, formulation=formulation, damping=damping, name=name
        )

    def point(
        self,
        where: Where,
        *,
        tolerance: float | None = None,
        axes: npt.ArrayLike | None = None,
    ) -> Point:
        """Point with a name, at a node or at a position; for a named set, its mean frame.

        The mean frame is for joints, springs, drives, motions and loads. Its position is the mean
        of those of the nodes, on a face weighted by their consistent areas; its rotation is the
        mean rotation of the set, which may deform. Forces on it are distributed to the nodes with
        the same weights.

        Args:
            where: As of any body; or the name of a face, curve, group of cells, or several points.
            tolerance: As of any body, to the closest node.
            axes: Unloaded axes of the frame of a set as rows, shape (3, 3); default: global axes.

        Raises:
            ValueError: As of any body; or the nodes of a set are collinear, the axes are not
                right-handed and orthonormal, or axes are given for a single node.
            TypeError: As of any body.
        """
        if not isinstance(where, str):
            if axes is not None:
                raise ValueError(f"axes are those of a named set of {self.label}, got {where!r}")
            return super().point(where, tolerance=tolerance)
        nodes = self.nodes(where)
        if len(nodes) == 1 and axes is None:
            return Point(self, int(nodes[0]), where)
        frame = self.model.mean_frame(where, np.eye(3) if axes is None else axes)
        return Point(self, int(nodes[0]), where, frame)
