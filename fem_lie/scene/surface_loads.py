"""Loads on shells: on named curves and over the surface, fixed in space or following."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeVar, cast

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.membranes.membrane import Membrane
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.smooth_surface import SmoothSurface
from fem_lie.mesh.shapes import FaceRule
from fem_lie.scene.load import Carrier, Field, History, NodalLoad, at_points

OnShell = TypeVar("OnShell")
SHELL = Carrier(
    "shell", Shell | Membrane | SmoothSurface, "a Shell, ThinShell, AncfShell or Membrane"
)


@dataclass(frozen=True, eq=False)
class EdgeLoad(NodalLoad):
    """Force and moment per reference length on a named curve of a shell.

    Attributes:
        shell: The loaded shell; edges of thin shells take forces fixed in space only.
        curve: Name of the curve.
        force: Three components per length: global if fixed in space; if following, along the edge
            with the shell on its left, seen against the directors, outward across the edge, and
            along the director, all in the unloaded configuration; or a function of the unloaded
            position.
        moment: About these axes, or such a function; about the director it does no work on nodes
            without drilling rotation.
        history: Factor as a function of time.
        following: Whether the load rotates with the nodal frames. Frames without drilling rotation
            rotate with the directors and not about them.

    Example:
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
        >>> load = fl.loads.EdgeLoad(plate, "a=1", force=(0, 0, 10.0))
    """

    divisible = True
    carrier = SHELL.elsewhere("on beams: LineLoad or PointLoad, on solids: FaceLoad")

    shell: Shell | Membrane | SmoothSurface
    curve: str
    force: Field = (0.0, 0.0, 0.0)
    moment: Field = (0.0, 0.0, 0.0)
    history: History | None = None
    following: bool = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the curve missing or no edge."""
        super().check()
        if isinstance(self.shell, SmoothSurface):
            self.shell.model.edge_quadrature(self.curve)
        if self.following or callable(self.moment) or np.any(self.moment):
            self.shell.model.require_frames("a moment, or a follower load,")
        if not isinstance(self.shell, SmoothSurface):
            edges = self.shell.model.mesh.curve(self.curve)
            if self.following and not _senses(self.shell, edges).all():
                raise ValueError(
                    f"a follower load needs edges of one cell each; those of {self.curve!r} of "
                    f"{self.shell.label} are between cells and have no outer side"
                )
        self.nodal()

    def nodal(self) -> Array:
        """Consistent nodal forces and moments of the interpolation, shape (n, 6)."""
        if isinstance(self.shell, SmoothSurface):
            return on_positions(self._on_rows(self.shell))
        at = self.shell.model.edge_quadrature(self.curve)
        density = np.stack(
            [self._density("force", at.positions), self._density("moment", at.positions)], axis=2
        )
        shares = np.einsum("egk,eghj->ekhj", at.shares, density)
        if self.following:
            # components in the nodal frames, with which the axes of the edge rotate
            axes = self._axes(self.shell, at.nodes)
            local = np.einsum("eaij,ekaj->eaik", self.shell.frames[at.nodes, 1:], axes)
            shares = np.einsum("eaik,eahk->eahi", local, shares)
        values = np.zeros((len(self.shell.frames), 6))
        np.add.at(values, at.nodes, shares.reshape(*at.nodes.shape, 6))
        return values

    def _density(self, name: str, positions: Array) -> Array:
        what = f"{name} of the EdgeLoad on {self.shell.label}"
        return at_points(getattr(self, name), positions, what)

    def on_directors(self) -> Array:
        """Consistent forces on position gradients of a thin shell, shape (n, 3, 3)."""
        if isinstance(self.shell, SmoothSurface):
            return self._on_rows(self.shell)[:, 1:]
        return super().on_directors()

    def _on_rows(self, shell: SmoothSurface) -> Array:
        at = shell.model.edge_quadrature(self.curve)
        return shell.model.consistent_forces(at, self._density("force", at.positions))

    def _axes(self, shell: Shell | Membrane, edges: Indices) -> Array:
        """Tangent, outward normal and director at the nodes of each edge, (e, 3, 2 or 3, 3)."""
        director = shell.frames[edges, 3]
        chord = shell.frames[edges[:, 1], 0] - shell.frames[edges[:, 0], 0]
        chord = chord * _senses(shell, edges)[:, np.newaxis]
        outward = np.cross(chord[:, np.newaxis], director)
        outward /= np.linalg.norm(outward, axis=2, keepdims=True)
        return np.stack([np.cross(director, outward), outward, director], axis=1)


@dataclass(frozen=True, eq=False)
class SurfaceLoad(NodalLoad):
    """Base class of distributed forces on shells.

    Attributes:
        shell: The loaded shell.
        force: Three global components per area, volume or mass, or a function of the unloaded
            position.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    divisible = True
    carrier = SHELL.elsewhere("on beams: LineLoad, on solids: FaceLoad or BulkLoad")

    shell: Shell | Membrane | SmoothSurface
    force: Field
    cells: str | None = None
    history: History | None = None

    following = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the group of cells is missing."""
        super().check()
        self.nodal()

    def nodal(self) -> Array:
        """Consistent nodal forces of the interpolation, shape (n, 6)."""
        if isinstance(self.shell, SmoothSurface):
            return on_positions(self._on_rows(self.shell))
        values = np.zeros((len(self.shell.frames), 6))
        for load, shell, nodes in on_parts(self, self.shell):
            chosen = nodes_of(shell)[shell.model.cells_of(self.cells)]
            np.add.at(values[:, :3], nodes[chosen], load._scaled(shell, load._factors()))
        return values

    def on_directors(self) -> Array:
        """Consistent forces on position gradients of a thin shell, shape (n, 3, 3)."""
        if isinstance(self.shell, SmoothSurface):
            return self._on_rows(self.shell)[:, 1:]
        return super().on_directors()

    def _factors(self) -> Array:
        """Area density of a unit load on each cell of the shell, shape (m,)."""
        return np.ones(len(self.shell.model.cells_of()))

    def _on_rows(self, shell: SmoothSurface) -> Array:
        """Consistent forces on the nodal coordinates (position and gradients), shape (n, 4, 3)."""
        at = shell.model.cell_quadrature(self.cells)
        factors = self._factors()[at.cells, np.newaxis, np.newaxis]
        return shell.model.consistent_forces(at, factors * self._density(at.positions))

    def _density(self, positions: Array) -> Array:
        """Load at points of the unloaded surface (c, g, 3), same shape."""
        return at_points(self.force, positions, f"{type(self).__name__} on {self.shell.label}")

    def _scaled(self, shell: Shell | Membrane, factors: Array) -> Array:
        """Consistent nodal forces of the loaded cells times a factor of each cell, (c, k, 3)."""
        return factors[shell.model.cells_of(self.cells), np.newaxis, np.newaxis] * self._shares(
            shell
        )

    def _shares(self, shell: Shell | Membrane) -> Array:
        """Consistent nodal forces ``∫ N_i f dA`` of the loaded cells, shape (c, k, 3)."""
        rule = FaceRule.of(shell.model.mesh.cell, shell.model.mesh.degree)
        cells, x = nodes_of(shell)[shell.model.cells_of(self.cells)], shell.frames[:, 0]
        areas = np.linalg.norm(rule.normals(x, cells), axis=2)
        return np.einsum(
            "gk,mg,mgj->mkj", rule.values, areas, self._density(rule.positions(x, cells))
        )


@dataclass(frozen=True, eq=False)
class AreaLoad(SurfaceLoad):
    """Force per reference area on all of a shell or on some of its cells, fixed in space.

    Attributes:
        shell: The loaded shell.
        force: Three global components per area, or a function of the unloaded position.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
        >>> load = fl.AreaLoad(plate, (0, 0, -100.0))
    """


@dataclass(frozen=True, eq=False)
class VolumeLoad(SurfaceLoad):
    """Force per reference volume, fixed in space; it acts at the reference surface.

    Attributes:
        shell: The loaded shell.
        force: Three global components per volume, or a function of the unloaded position.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
        >>> load = fl.loads.VolumeLoad(plate, (0, 0, -1e4))
    """

    def _factors(self) -> Array:
        return self.shell.model.thickness


@dataclass(frozen=True, eq=False)
class MassLoad(SurfaceLoad):
    """Force per mass, fixed in space: gravity on part of a shell, or inertia in a moving frame.

    The force acts on the whole thickness, at the centre of mass of the section.

    Attributes:
        shell: The loaded shell.
        force: Three global components per mass, or a function of the unloaded position.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
        >>> load = fl.loads.MassLoad(plate, (0, 0, -9.81))
    """

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite, or the cells or the mass are missing."""
        super().check()
        if not self.shell.model.has_mass:
            raise ValueError(f"a force per mass needs mass, {self.shell.label} has none")

    def _factors(self) -> Array:
        density = self.shell.model.density
        return density if isinstance(self.shell, SmoothSurface) else density[:, 0, 0]

    def on_directors(self) -> Array:
        """Forces on d₃ of each node from the first moment of mass, shape (n, 3, 3)."""
        if isinstance(self.shell, SmoothSurface):
            return super().on_directors()
        values = np.zeros((len(self.shell.frames), 3, 3))
        for load, shell, nodes in on_parts(self, self.shell):
            chosen = nodes_of(shell)[shell.model.cells_of(self.cells)]
            np.add.at(
                values[:, 2], nodes[chosen], load._scaled(shell, shell.model.density[:, 0, 1])
            )
        return values


def on_positions(rows: Array) -> Array:
    """Nodal loads (n, 6) from forces on nodal coordinates (n, 4, 3): the forces on positions."""
    return np.concatenate([rows[:, 0], np.zeros((len(rows), 3))], axis=1)


def nodes_of(shell: Shell | Membrane) -> Indices:
    """Nodes of each cell, shape (m, k)."""
    return shell.model.connectivity


def on_parts(
    load: OnShell, shell: Shell | Membrane
) -> Iterator[tuple[OnShell, Shell | Membrane, Indices]]:
    """A load on the cells of each type of its shell: the load, these cells, and their nodes.

    Args:
        load: A load with an argument ``shell``.
        shell: Its shell.
    """
    for part in shell.parts:
        own: Any = load if part.shell is shell else replace(cast(Any, load), shell=part.shell)
        yield own, part.shell, part.nodes


def sides_of(shell: Shell | Membrane) -> Array:
    """Sign of each cell: 1 if x,₁ × x,₂ points to the side of the directors, else −1, (m,)."""
    rule, cells = FaceRule.of(shell.model.mesh.cell, shell.model.mesh.degree), nodes_of(shell)
    normals = rule.normals(shell.frames[:, 0], cells).sum(axis=1)
    directors = shell.model.mesh.normals.sum(axis=1)
    return np.sign(np.einsum("mj,mj->m", normals, directors))


def _senses(shell: Shell | Membrane, edges: Indices) -> Array:
    """1 or −1 for edges with their cell on the left or right, 0 for edges between cells, (e,)."""
    count = len(shell.frames)

    def keys(ends: Indices) -> tuple[Indices, Array]:
        forward = np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0)
        return count * ends.min(axis=1) + ends.max(axis=1), forward

    found, senses = [], []
    for part in shell.parts:
        round_ = part.points[part.shell.model.mesh.corners]
        pairs = np.stack([round_, np.roll(round_, -1, axis=1)], axis=2).reshape(-1, 2)
        key, forward = keys(pairs)
        found.append(key)
        senses.append(np.repeat(sides_of(part.shell), round_.shape[1]) * forward)
    known, number = np.unique(np.concatenate(found), return_inverse=True)
    total = np.bincount(number.ravel(), weights=np.concatenate(senses))
    sought, forward = keys(edges[:, :2])
    return np.asarray(forward * total[np.searchsorted(known, sought)])
