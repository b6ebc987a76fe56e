"""Contact surface of a shell, which touches other shells, itself, balls and planes.

A shell occupies all points within half its thickness of the middle surface, with round edges. The
middle surface is interpolated by smooth patches, with the tangents of the nodal frames. The first
side of a contact consists of the Gauss points of each patch as balls, with their integration
weights (areas); the second side consists of patches. Each ball is repelled by the closest point on
the patches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Indices, flag, instance, positive, whole
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.shells.shell import Shell, require_one_type
from fem_lie.contact.pairs.patch_surfaces import PatchSurface, patches_of
from fem_lie.contact.sides.patches import Patches, set_nets
from fem_lie.contact.sides.table import Nodes

_PARTS = {
    ("triangle", 3): [[0, 1, 2]],
    ("quadrilateral", 4): [[0, 1, 2, 3]],
    ("triangle", 6): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [5, 3, 4]],
    ("quadrilateral", 9): [[0, 4, 5, 8], [4, 1, 8, 6], [5, 8, 2, 7], [8, 6, 7, 3]],
}
"""Corner nodes of the patches of a cell, by cell shape and number of nodes."""


@dataclass(frozen=True, eq=False)
class ShellSurface(PatchSurface):
    """Contact surface of a shell: both faces and the round edges.

    Contact forces are per area of the undeformed middle surface. They are integrated over the first
    of two shell surfaces, which should have the finer mesh. A surface that is given twice touches
    itself.

    A smooth surface has tangents that rotate with nodal frames, so its shell needs drilling
    rotations. A surface that is not smooth has bilinear patches between nodal positions, with kinks
    across edges. Its shell needs no drilling rotations unless the contact has friction, and
    conserving schemes support it.

    Attributes:
        shell: A shell of quadrilaterals or triangles.
        thickness: Thickness; default: that of its sections.
        gauss: Number of integration points along each axis of a patch; on triangles, points of the
            same order.
        smooth: Whether patches have tangents.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> sheet = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
        >>> surface = fl.contact.ShellSurface(sheet)
        >>> scene = fl.Scene()
        >>> _ = scene.add(sheet)
        >>> _ = scene.add(fl.contact.Contact(surface, surface, fl.contact.Penalty(1e9)))
        >>> scene.has_drilling(sheet)
        True
    """

    shell: Shell
    thickness: float | None = None
    gauss: int = 2
    smooth: bool = True

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.shell, Shell, "ShellSurface: shell", "a Shell")
        require_one_type(self.shell, "ShellSurface")
        if self.thickness is not None:
            positive(self.thickness, "ShellSurface: thickness")
        whole(self.gauss, "ShellSurface: gauss")
        flag(self.smooth, "ShellSurface: smooth")

    @property
    def sheet(self) -> bool:
        """True: faces of the sheet have friction springs of their own."""
        return True

    @property
    def points(self) -> Sequence[Point]:
        """All nodes of the shell."""
        return [Point(self.shell, node) for node in range(len(self.shell.frames))]

    def rotating(self, friction: bool) -> Sequence[Body]:
        """The shell, if contact forces have moments that need drilling rotations.

        Args:
            friction: Coefficient of friction.
        """
        return [self.shell] if self.smooth or friction else []

    def _parts(self, cells: Indices) -> Indices:
        """Corner nodes of all patches, shape (m, 3 or 4)."""
        parts = np.array(_PARTS[self.shell.model.mesh.cell, cells.shape[1]])
        return np.ascontiguousarray(cells[:, parts].reshape(-1, parts.shape[1]))

    @property
    def radii(self) -> Array:
        """Half of the thickness of each patch, shape (m,)."""
        cells = self.shell.model.connectivity
        parts = len(_PARTS[self.shell.model.mesh.cell, cells.shape[1]])
        thickness = self.shell.model.thickness if self.thickness is None else self.thickness
        return 0.5 * np.repeat(np.broadcast_to(thickness, len(cells)), parts)

    def patches(self, nodes: Nodes) -> Patches:
        """All patches in the initial configuration.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        own = self._parts(self.shell.model.connectivity)
        corners, straight = self._parts(self.shell.model.mesh.cells), not self.smooth
        found = patches_of(own, corners, self.radii, straight=straight)
        if self.smooth:
            found.tangents[:, : own.shape[1]] = _tangents(self.shell.frames, own)
        set_nets(self.shell.frames, found)
        numbers, known = found.nodes, nodes(self.shell)
        return found._replace(nodes=np.where(numbers < 0, numbers, known[numbers]))


def _tangents(frames: Array, cells: Indices) -> Array:
    """Tangents at corners in their frames, of the length of arcs, shape (m, 3 or 4, 2, 3)."""
    k = cells.shape[1]
    found = np.empty((len(cells), k, 2, 3))
    for i in range(k):
        H = frames[cells[:, i]]
        for a in range(2):
            if k == 3:
                other, sign = (i + 1 + a) % 3, 1.0
            else:
                other, sign = i ^ (1 + a), -1.0 if i & (1 + a) else 1.0
            chord = frames[cells[:, other], 0] - H[:, 0]
            local = np.einsum("mij,mj->mi", H[:, 1:], chord)
            length, off = np.linalg.norm(chord, axis=1), local[:, 2].copy()
            angle = np.arcsin(np.clip(np.abs(off) / length, 0.0, 1.0))
            local[:, 2] = 0.0
            arc = length / np.sinc(angle / np.pi)
            found[:, i, a] = sign * local * (arc / np.linalg.norm(local, axis=1))[:, np.newaxis]
    return found
