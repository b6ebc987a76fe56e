"""Shells with shear: positions and directors on surface meshes, five or six unknowns at a node."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from math import cos, degrees, pi, radians
from typing import Any, NamedTuple

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Indices, instance, number
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.mixed import MixedShellModel
from fem_lie.bodies.shells.model import ShellModel
from fem_lie.bodies.shells.placing import (
    Director,
    ShellSections,
    axes_along,
    given_directors,
    section_per_cell,
)
from fem_lie.bodies.shells.supports import SupportedSurface
from fem_lie.bodies.shells.surface_nodes import GivenShell
from fem_lie.elements.shells.element import DisplacementBased, HellingerReissner, ShellFormulation
from fem_lie.mesh.mixed_surfaces import MixedSurfaceMesh
from fem_lie.mesh.reading import surface_from_dolfinx
from fem_lie.mesh.surfaces import KINK_ANGLE, Surface
from fem_lie.sections.material import Damping
from fem_lie.sections.shell_section import ShellSection

_log = logging.getLogger(__name__)

_FACETS = radians(10.0)  # a circle of 18 cells


_DEFAULTS: dict[int, ShellFormulation] = {1: HellingerReissner(), 2: DisplacementBased()}
"""Finite element by the order of the cells."""


class ShellPart(NamedTuple):
    """Cells of one type of a shell.

    Attributes:
        shell: Shell of these cells, which is in no scene.
        nodes: Number in the whole shell of each of its nodes, shape (n,).
        points: Point of the mesh of the whole shell of each point of its mesh, shape (p,).
    """

    shell: Shell
    nodes: Indices
    points: Indices


class Shell(SupportedSurface):
    """Shear-deformable shell with an 8×8 section stiffness on a surface, with kinks and branches.

    A node has a position and a director, which is the third axis of its frame and need not be
    normal to the surface. Rotation about the director, the drilling rotation, is an unknown of
    shells with ``drilling=True`` only, see :mod:`fem_lie.elements.shells.drilling`. At a kink or
    branch, each smooth side has its own nodes and directors; they are rigidly attached to the node
    of the first side.

    Triangles and quadrilaterals may be mixed, see :class:`~fem_lie.mesh.MixedSurfaceMesh`: where
    they meet, they have the same unknowns. Stresses are those of cells of one type, of the shells
    of :attr:`parts`; contact, convected axes and adaptivity need cells of one type.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
        >>> _ = plate.clamp("a=0")
        >>> plate.model.connectivity.shape
        (4, 4)
    """

    model: ShellModel
    _numbers: Indices | slice = slice(None)
    """Number in the whole shell of each of its nodes."""
    _whole: Shell | None = None

    def __init__(
        self,
        mesh: Surface | dolfinx.mesh.Mesh,
        section: ShellSections,
        *,
        director: Director | None = None,
        along: npt.ArrayLike | Director | None = None,
        formulation: ShellFormulation | None = None,
        kink_angle: float = KINK_ANGLE,
        drilling: bool | None = None,
        convected_axes: bool = False,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes, with one director on each smooth side.

        Args:
            mesh: Surface mesh, of cells of one type or mixed, or a DOLFINx mesh, see
                :func:`~fem_lie.mesh.reading.surface_from_dolfinx`.
            section: One for all cells, one for each named group of cells, or a function of the
                centre of a cell, shape (3,), for variable thickness.
            director: Unit director as a function of the position, shape (3,), on the side of the
                cells' normals and within ``kink_angle`` of them; only for surfaces without kinks
                and branches. Default: mean normal of the cells on each smooth side.
            along: Direction of e₁ of the section axes before projection onto the surface: one
                vector, or a function of the centre of a cell; default: from the first to the second
                corner.
            formulation: Finite element; default: :class:`HellingerReissner`, for cells of second
                order :class:`DisplacementBased`.
            kink_angle: Largest angle between neighbouring cells of a smooth surface, rad.
            drilling: Whether nodes have the rotation about the director as a sixth unknown. Default
                ``None``: yes if a joint, link, prescribed motion or moment acts on the rotation of
                a node, or if the surface has kinks or branches.
            convected_axes: Rotate the frames about their directors with the mid-surface after each
                step. The motion does not depend on it, but the iteration matrix of a rotating shell
                stays valid longer. Only without drilling rotation.
            damping: Damping of motion, and of strain with one relaxation time; default: none.
            name: Name in messages and results.

        Raises:
            ValueError: A cell has no section, the element does not support the cells, a surface
                with ``drilling=False`` has a kink or branch, ``drilling`` and ``convected_axes``
                are both true, strains have several relaxation times, or a director is not finite,
                lies in the surface or points to the other side.
        """
        if isinstance(mesh, dolfinx.mesh.Mesh):
            mesh = surface_from_dolfinx(mesh)
        instance(mesh, Surface, "Shell: mesh", "a SurfaceMesh, as of fl.mesh.parametric_surface()")
        known = "a ShellSection, a dict of them by groups of cells or a function of the position"
        instance(section, ShellSection | Mapping | Callable, "Shell: section", known)
        instance(formulation, ShellFormulation | None, "Shell: formulation", "an element or None")
        number(kink_angle, "Shell: kink_angle")
        if director is not None:
            instance(director, Callable, "Shell: director", "a function of the position or None")
        instance(drilling, bool | None, "Shell: drilling", "True, False or None")
        instance(convected_axes, bool, "Shell: convected_axes", "True or False")
        if drilling and convected_axes:
            raise ValueError("expected convected_axes=True without drilling=True, got both")
        damping = Damping.of_body(damping, "Shell")
        formulation = _DEFAULTS[mesh.degree] if formulation is None else formulation
        for block in mesh.blocks:
            formulation.measures_for(block.cell, mesh.degree)
        centres = mesh.centres
        sections = section_per_cell(mesh, centres, section)
        axes = axes_along(mesh, centres, along)
        patches = mesh.patches(kink_angle if director is None else pi)
        directors = (
            patches.directors
            if director is None
            else given_directors(mesh, director, patches, kink_angle)
        )
        kind: Any = MixedShellModel if isinstance(mesh, MixedSurfaceMesh) else ShellModel
        given = GivenShell(
            mesh,
            patches,
            directors,
            sections,
            axes,
            formulation,
            drilling=False if convected_axes else drilling,
            convected_axes=convected_axes,
            damping=damping,
            class_name=type(self).__name__,
            name=name,
        )
        super().__init__(kind(given))
        for part in self.parts:
            _log_turns(part.shell.model, kink_angle)

    @property
    def parts(self) -> tuple[ShellPart, ...]:
        """Cells of each type as shells on the present nodes; this shell itself if it has one type.

        ``fl.post.resultants(result, part.shell)`` has the stresses of these cells.
        """
        return tuple(
            ShellPart(self._of(part.model, part.nodes), part.nodes, part.points)
            for part in self.model.present()
        )

    def _of(self, model: ShellModel, nodes: Indices) -> Shell:
        """Shell of some of its cells, or itself if they are all."""
        if model is self.model:
            return self
        part = type(self).__new__(type(self))
        Body.__init__(part, model)
        part._whole, part._numbers = self, nodes
        return part


def whole_of(shell: Shell) -> Shell:
    """The shell of which this is one of the parts, or itself."""
    return shell if shell._whole is None else shell._whole


def numbers_in_whole(shell: Shell) -> Indices | slice:
    """Numbers of the nodes of a part in the whole shell; all of a shell that is no part."""
    return shell._numbers


def require_one_type(shell: Shell, what: str) -> None:
    """Raise ``ValueError`` if a shell has cells of several types.

    Args:
        shell: The shell.
        what: What needs one type of cells.
    """
    parts = shell.parts
    if len(parts) > 1:
        cells = " and ".join(f"{part.shell.model.mesh.cell}s" for part in parts)
        raise ValueError(
            f"{what} needs cells of one type, but {shell.label} has {cells}: mesh it with one "
            "of them; stresses are those of each of shell.parts"
        )


def _log_turns(model: ShellModel, kink_angle: float) -> None:
    """Log the largest angle between normals of cells and the director that they share."""
    directors, normals = model.frames[model.connectivity, 3], model.mesh.normals
    cosine = np.einsum("mkj,mkj->mk", directors, normals)
    if cosine.min() < cos(_FACETS):
        position = model.frames[model.connectivity.ravel()[cosine.argmin()], 0]
        _log.info(
            "%s: normals of cells are up to %.0f° off their common director, at %s; neighbours "
            "within kink_angle = %.0f° of each other count as smooth",
            *(model.label, degrees(np.arccos(cosine.min())), position, degrees(kink_angle)),
        )
