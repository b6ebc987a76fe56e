"""Nodes of a shell on a surface mesh: supports, drilling rotations, named sets."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from fem_lie._arrays import Array, log_coincident
from fem_lie.bodies.model import HeldRotation
from fem_lie.bodies.shells.placing import frames_with
from fem_lie.bodies.surface_model import SurfaceModel
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.lie.motions import Group
from fem_lie.mesh.patches import Patches
from fem_lie.mesh.surfaces import Surface
from fem_lie.sections.material import Damping
from fem_lie.sections.shell_section import ShellSection

Mesh = TypeVar("Mesh", bound=Surface)


@dataclass(frozen=True)
class GivenShell(Generic[Mesh]):
    """A surface and what a shell has on it.

    Attributes:
        mesh: Surface mesh.
        patches: Smooth sides of the surface, and the nodes of each cell.
        directors: Director of each node, shape (n, 3).
        sections: Section of each cell.
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: Finite element.
        drilling: Whether nodes have a drilling rotation; ``None``: only if something needs it.
        convected_axes: Whether frames rotate about their directors with the mid-surface.
        damping: Damping of motion and of strain.
        class_name: Name of the class of the body.
        name: Name in messages and results.
    """

    mesh: Mesh
    patches: Patches
    directors: Array
    sections: Sequence[ShellSection]
    axes: Array
    formulation: ShellFormulation
    drilling: bool | None
    convected_axes: bool
    damping: Damping
    class_name: str
    name: str


class SurfaceNodes(SurfaceModel):
    """Nodes of a shell with shear, whatever types of cells are on them.

    Attributes:
        formulation: Finite element of the cells.
        drilling: Whether nodes have a drilling rotation; ``None``: only if something needs it.
        convected_axes: Whether frames rotate about their directors with the mid-surface.
        damping: Damping of motion and of strain.
    """

    group = Group.R3xSO3

    def __init__(self, given: GivenShell[Any]) -> None:
        """Create the nodes.

        Args:
            given: The surface and what is on it.

        Raises:
            ValueError: A surface with ``drilling=False`` has a kink or branch.
        """
        mesh, patches, formulation = given.mesh, given.patches, given.formulation
        self.mesh, self.formulation = mesh, formulation
        self.drilling, self.convected_axes = given.drilling, given.convected_axes
        self.damping = given.damping
        super().__init__(
            frames_with(mesh.points[patches.masters], given.directors),
            class_name=given.class_name,
            size=float(np.linalg.norm(np.ptp(mesh.points, axis=0))),
            points={key: int(p[0]) for key, p in mesh.named_points.items() if len(p) == 1},
            masters=patches.masters,
            name=given.name,
        )
        log_coincident(self.label, mesh.points)
        self._has_kinks = bool(len(patches.split))
        if formulation.whole_frames:
            self._refuse_with_five(type(formulation).__name__)
        if self._has_kinks:
            self._refuse_with_five(f"the kink or branch at {mesh.points[patches.split[0]]}")

    @property
    def separates_director(self) -> bool:  # type: ignore[override]
        """Whether statics moves the director before it drills."""
        return not self.formulation.whole_frames

    def hold_along(self, node: int, along: Array) -> None:
        """Hold one more translation of a node, along axes that are fixed in space.

        Args:
            node: Number of the node.
            along: Unit vector, global components, shape (3,).
        """
        held, axes = self.held[node], self.supports[node]
        own = axes if np.isfinite(axes[0, 0]) else self.frames[node, 1:]
        before = own[held[:3]]
        rest = along - before.T @ (before @ along)
        if np.linalg.norm(rest) <= 1e-9:
            return  # already held, as where a diaphragm meets a plane of symmetry
        known = np.vstack([before, rest / np.linalg.norm(rest)])
        # the others are any that are perpendicular
        free = np.linalg.svd(known)[2][len(known) :]
        self.supports[node] = np.vstack([known, free])
        held[:3] = np.arange(3) < len(known)

    def hold_rotations(self, node: int, normal: Array) -> None:
        """Rotate the frame of a node and hold rotations out of a plane, and the drilling rotation.

        Args:
            node: Number of the node.
            normal: Unit normal of the plane, perpendicular to the director, shape (3,).

        Raises:
            ValueError: The node is on another such plane that is not perpendicular.
        """
        H, held = self.frames[node], self.held[node]
        if held.all():
            return
        if held[4] and abs(H[2] @ normal) < 1.0 - 1e-6:
            raise ValueError(
                f"node {node} of {self.label} is on planes of symmetry that are not perpendicular"
            )
        tilt = 3 if held[4] else 4
        if tilt == 4:
            # the director stays as it is to the last digit
            e1 = normal - (normal @ H[3]) * H[3]
            H[1] = e1 / np.linalg.norm(e1)
            H[2] = np.cross(H[3], H[1])
            # cells of another type have nodes of their own there
            twins = (self.masters == node) & (self.frames[:, 3] == H[3]).all(axis=1)
            self.frames[twins] = H
        held[tilt] = held[5] = True

    def hold_axis(self, node: int, axis: Array) -> None:
        """Let the director of a node rotate about one axis only; about none if it has another one.

        Args:
            node: Number of the node.
            axis: Unit vector perpendicular to the director, global components, shape (3,).
        """
        if not self.held[node, 4]:
            self.hold_rotations(node, axis)
        elif abs(self.frames[node, 1] @ axis) < 1.0 - 1e-6:
            self.held[node, 3:] = True

    def hold_normal(self, node: int, normal: Array) -> None:
        """Hold the translation of a node along the normal of :meth:`hold_rotations`."""
        H, held = self.frames[node], self.held[node]
        if np.isfinite(self.supports[node, 0, 0]):
            self.hold_along(node, normal)
        else:
            held[int(np.abs(H[1:3] @ normal).argmax())] = True

    def has_drilling(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether nodes have a drilling rotation, given the rotations that joints and loads need.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.

        Raises:
            ValueError: The shell has ``drilling=False``, and one of them needs it.
        """
        needed = [hold for hold in holds if hold.needed]
        for hold in needed:
            if not (self._tilts(hold) and self.drilling is False):
                self._refuse_with_five(hold.what)
        if self.drilling is not None:
            return self.drilling
        return self._has_kinks or bool(needed) or self.formulation.whole_frames

    def drilling_for(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether nodes have a drilling rotation for these holds, and its stiffness, shape (m,).

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        drills = self.has_drilling(holds)
        return drills, self.drilling_stiffness(holds) if drills else None

    def drilling_stiffness(self, holds: Sequence[HeldRotation]) -> Array:
        """Drilling stiffness γ of each cell, :mod:`fem_lie.elements.shells.drilling`, (m,), N/m.

        Moments that a rigid part applies to several nodes act by forces, and do not raise γ.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        bound: dict[int, set[Hashable]] = {}
        for hold in holds:
            if not self._tilts(hold):
                bound.setdefault(int(self.masters[hold.node]), set()).add(hold.other)
        held_by = Counter(other for others in bound.values() for other in others)
        return self.drilling_around(
            [node for node, others in bound.items() if any(held_by[other] == 1 for other in others)]
        )

    @abstractmethod
    def drilling_around(self, points: Sequence[int]) -> Array:
        """Drilling stiffness of each cell, shape (m,), N/m.

        Args:
            points: Points of the mesh with moments about their normals only.
        """

    def _tilts(self, hold: HeldRotation) -> bool:
        """Whether a moment about ``hold.axis`` is perpendicular to the director of its node."""
        axis = hold.axis
        if axis is None:
            return False
        return bool(abs(axis @ self.frames[hold.node, 3]) < 1e-9 * np.linalg.norm(axis))

    def _refuse_with_five(self, what: str) -> None:
        if self.drilling is False:
            raise ValueError(
                f"{what} needs nodes that rotate about all axes, but {self.label} has "
                "drilling=False: omit it, or pass drilling=True (Spherical and InPlane joints at "
                "a node itself need no drilling rotation)"
            )
