"""Inertia, damping and nodal loads of a scene, on master nodes."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit.packed_arrays import Frames, Numbers2, Sixes
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import MassMatrix
from fem_lie.bodies.rigid import RigidBody
from fem_lie.forms.assembly import NodalInertia
from fem_lie.forms.term import add_at
from fem_lie.lie.node_types import POSITION_GRADIENT, SURFACE_GRADIENT
from fem_lie.lie.node_types.floating import Floating, FloatingModes
from fem_lie.lie.node_types.inertia import Inertia, multiply
from fem_lie.system.nodes.numbering import Numbering

PlainLoads: TypeAlias = tuple[Frames, Numbers2, Sixes]
""":class:`Loads` as a plain tuple, which makes calls of compiled functions faster."""


class Loads(NamedTuple):
    """Nodal loads at one time.

    Attributes:
        dead: Force on (x, d₁, d₂, d₃) fixed in space, gravity included, shape (n, 4, 3).
        moment: Moment fixed in space, shape (n, 3).
        following: Force and moment in the nodal frames, shape (n, 6).
    """

    dead: Frames
    moment: Numbers2
    following: Sixes

    @property
    def plain(self) -> PlainLoads:
        """Plain tuple of the fields, which makes calls of compiled functions faster."""
        return (*self,)


def inertia_of(
    bodies: Iterable[Body],
    numbering: Numbering,
    kind: MassMatrix,
    lumped: Collection[Body] = (),
) -> tuple[Inertia, Inertia]:
    """Mass matrix and mass-proportional damping matrix on (x, d₁, d₂, d₃) of the master nodes.

    Args:
        bodies: Bodies of the scene.
        numbering: Numbering of their nodes.
        kind: Which mass matrix.
        lumped: Bodies whose mass matrix is lumped whatever ``kind`` is.

    Returns:
        The two matrices; the second has no rows if no body has such damping.

    Raises:
        ValueError: Elements have no inertia.
    """
    rows: list[Indices] = [np.empty(0, dtype=np.int64)]
    columns: list[Indices] = [np.empty(0, dtype=np.int64)]
    mass: list[Array] = []
    damping: list[Array] = []
    known = [assembly.inertia for _, assembly in numbering.assemblies]
    damps = any(own is not None and own.damping is not None for own in known)
    pairs = zip(numbering.members, numbering.assemblies, known, strict=True)
    for members, (where, assembly), own in pairs:
        if own is not None:
            r = np.repeat(np.arange(assembly.count), np.diff(assembly.indptr))
            rows.append(where.start + r)
            columns.append(where.start + assembly.indices)
            mass.append(_mass_of(own, kind))
            if damps:
                damping.append(np.zeros_like(mass[-1]) if own.damping is None else own.damping)
        else:
            raise ValueError(
                f"{', '.join(body.label for body in members)}: dynamics and gravity need the "
                "inertia of all sections, and the density of all materials: Section.from_stiffness("
                "..., mass=..., rotary=...), NeoHooke(E, nu, density), FormBody(..., inertia="
                "fl.extend.kinetic_energy(...))"
            )
    for body in bodies:
        if isinstance(body, RigidBody):
            rows.append(numbering.nodes[body])
            columns.append(numbering.nodes[body])
            mass.append(body.model.mass_matrix[np.newaxis])
            if damps:
                damping.append(np.zeros((1, 4, 4)))
    r, c = np.concatenate(rows), np.concatenate(columns)
    inertia = _on_masters(numbering, r, c, mass)
    damped = _on_masters(numbering, r, c, damping) if damps else Inertia.none()
    chosen = np.full(numbering.count, kind is MassMatrix.LUMPED)
    for body in lumped:
        chosen[numbering.master_map.master[numbering.nodes[body]]] = True
    if not chosen.any():
        return inertia, damped
    kinds = numbering.kinds
    return _lumped(inertia, kinds, chosen), _lumped(damped, kinds, chosen) if damps else damped


def total_mass(bodies: Iterable[Body], numbering: Numbering) -> float:
    """Mass of all bodies, kg.

    Args:
        bodies: Bodies of the scene.
        numbering: Numbering of their nodes.
    """
    rigid = (body.model.mass_matrix[0, 0] for body in bodies if isinstance(body, RigidBody))
    return float(sum(rigid) + sum(assembly.mass for _, assembly in numbering.assemblies))


def _mass_of(inertia: NodalInertia, kind: MassMatrix) -> Array:
    """Blocks of the mass matrix of an assembly."""
    if kind is MassMatrix.CONSISTENT or inertia.drilling is None:
        return inertia.mass
    return inertia.mass + inertia.drilling


def floating_of(numbering: Numbering) -> Floating:
    """Further inertia of bodies that deform within their frames.

    Raises:
        ValueError: Nodes of such a body are attached to others.
    """
    found: list[tuple[Indices, FloatingModes]] = []
    master_map = numbering.master_map
    for body, nodes in numbering.nodes.items():
        inside = body.model.floating_modes()
        if inside is not None:
            if not np.isin(nodes, master_map.masters).all():
                raise ValueError(
                    f"nodes of {body.label} cannot be attached to others: attach those to them, or "
                    "use a Fixed joint"
                )
            found.append((master_map.master[nodes], inside))
    return Floating.of(found)


def weight_of(mass: Inertia, count: int, gravity: Array) -> Array:
    """Force of gravity on (x, d₁, d₂, d₃) of the master nodes, shape (count, 4, 3)."""
    q = np.zeros((count, 4, 3))
    q[:, 0] = gravity
    weight = np.zeros_like(q)
    multiply(*mass, q, weight)
    return weight


def _on_masters(numbering: Numbering, r: Indices, c: Indices, given: list[Array]) -> Inertia:
    """Blocks ``Wᵀ G W`` of pairs of master nodes from blocks of pairs of all nodes, sorted."""
    master_map, count = numbering.master_map, numbering.count
    master = master_map.master
    W = None if master_map.trivial else master_map.linear()
    key, index = np.unique(master[r] * count + master[c], return_inverse=True)
    G, first = np.zeros((len(key), 4, 4)), 0
    for blocks in given:
        own = slice(first, first + len(blocks))
        first += len(blocks)
        if W is not None:
            left, right = (W[nodes[own], : blocks.shape[1]] for nodes in (r, c))
            blocks = left.transpose(0, 2, 1) @ blocks @ right
        add_at(G, index[own], blocks)
    return Inertia(np.searchsorted(key // count, np.arange(count + 1)), key % count, G)


def _lumped(inertia: Inertia, kinds: Indices, chosen: Flags) -> Inertia:
    """Mass matrix with one block for each of some nodes, for schemes that solve no equations.

    The blocks of a row are summed for frames and positions, so that mass, first moments and
    rigid-body inertia are conserved. Position gradients keep their diagonal, scaled as the mass of
    the positions. For nodes that are two points each row has the sum of magnitudes along it, which
    equals the sum where shape functions are positive. Momentum and angular momentum are as exact as
    with the consistent matrix.

    Args:
        inertia: Mass matrix of the moving nodes.
        kinds: Types of the nodes, shape (n,).
        chosen: Nodes whose blocks are lumped, shape (n,); inertia does not couple them with others.
    """
    count = len(kinds)
    rows, columns = inertia.pairs
    whole, own = np.zeros((2, count, 4, 4))
    np.add.at(whole, rows, inertia.blocks)
    np.add.at(own, rows[rows == columns], inertia.blocks[rows == columns])
    sizes = np.zeros((count, 4))
    np.add.at(sizes, rows, np.abs(inertia.blocks.diagonal(axis1=1, axis2=2)))
    points = kinds >= SURFACE_GRADIENT
    whole[points] = sizes[points][:, :, np.newaxis] * np.eye(4)
    sloped = (kinds >= POSITION_GRADIENT) & (kinds < SURFACE_GRADIENT)
    mass = own[sloped, 0, 0]
    gained = np.divide(whole[sloped, 0, 0], mass, out=np.zeros_like(mass), where=mass > 0.0)
    diagonal = gained[:, np.newaxis] * own[sloped].diagonal(axis1=1, axis2=2)
    whole[sloped] = diagonal[:, :, np.newaxis] * np.eye(4)
    nodes, others = np.flatnonzero(chosen), ~chosen[rows]
    r, c = np.concatenate([nodes, rows[others]]), np.concatenate([nodes, columns[others]])
    order = np.lexsort((c, r))
    blocks = np.concatenate([whole[nodes], inertia.blocks[others]])[order]
    return Inertia(np.searchsorted(r[order], np.arange(count + 1)), c[order], blocks)
