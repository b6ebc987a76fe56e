"""Shells with each cell cut into four: the new nodes, their frames, supports and forces."""

from __future__ import annotations

from copy import copy
from typing import NamedTuple

import basix
import numpy as np
from scipy.sparse import bsr_matrix, coo_matrix, csr_matrix

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.shells.assembly import assembly_of
from fem_lie.bodies.shells.placing import frames_with
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.shapes import tabulated
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.results.stresses.nodal_values import CellPoints, unit
from fem_lie.results.stresses.shell_stress import integration

_STRAIGHT = 0.9  # cosine
_STEP = 1e-5  # increment for numerical derivatives: over the length of the model, and in rad
_ADMITTED = 0.25  # least part of a motion, squared, that counts as admitted by supports


def border_shares(number: Indices, along: Array, length: Array) -> tuple[Array, Array]:
    """Length of border of each end of border edges, and whether it is straight there, (b, 2)."""
    count = int(number.max(initial=-1)) + 1
    flat, twice = number.ravel(), np.repeat(along, 2, axis=0)
    halves = np.repeat(0.5 * length, 2)
    share = np.asarray(np.bincount(flat, halves, minlength=count), dtype=np.float64)
    # directions of lines without orientation
    square = np.zeros((count, 3, 3))
    np.add.at(square, flat, np.einsum("bi,bj->bij", twice, twice))
    ahead = np.einsum("bi,bij,bj->b", twice, square[flat], twice) - 1.0
    two = np.bincount(flat, minlength=count)[flat] == 2
    straight = (two & (ahead > _STRAIGHT**2)).astype(np.float64)
    return share[number], straight.reshape(-1, 2)


_FIVE = 5

# parts of a cell, from its corners, the midpoints of its edges in basix's order, its centre
_PARTS = {
    "triangle": [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    "quadrilateral": [[0, 4, 5, 8], [4, 1, 8, 6], [5, 8, 2, 7], [8, 6, 7, 3]],
}


class Cut(NamedTuple):
    """A shell and the refined shell with each cell cut into four; new nodes follow the old ones.

    Attributes:
        shell: The shell of m cells.
        fine: The refined shell of 4 m cells.
        separate: The refined shell with disconnected cells.
        ends: Nodes at the ends of cut edges, shape (e, 2).
        sides: Edges of each cell, shape (m, 3 or 4).
        border: Whether each edge belongs to a single cell, shape (e,).
    """

    shell: Shell
    fine: Shell
    separate: Shell
    ends: Indices
    sides: Indices
    border: Flags

    @classmethod
    def of(cls, shell: Shell) -> Cut:
        """Cut all cells of a shell."""
        mesh, n = shell.model.cut_mesh, len(shell.frames)
        pairs = np.array(basix.topology(basix.CellType[mesh.cell])[1])
        sides = np.sort(mesh.cells[:, pairs], axis=2)
        ends, number, met = np.unique(
            sides.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
        )
        number = number.reshape(sides.shape[:2])
        parts, m = np.array(_PARTS[mesh.cell]), len(mesh.cells)
        local, middles = [mesh.cells, n + number], 0
        if parts.max() == 8:
            middles = m
            local.append(n + len(ends) + np.arange(m)[:, np.newaxis])
        cells = np.concatenate(local, axis=1)[:, parts].reshape(4 * m, -1)
        x, d = shell.frames[:, 0], shell.frames[:, 3]
        corners = mesh.cells[: middles or 0]
        points = np.concatenate([x, x[ends].mean(axis=1), x[corners].mean(axis=1)])
        directors = unit(np.concatenate([d, d[ends].sum(axis=1), d[corners].sum(axis=1)]))
        shapes = shapes_of_parts(mesh.cell)
        normals = unit(np.einsum("pkc,mcj->mpkj", shapes, mesh.normals)).reshape(*cells.shape, 3)
        fine = copy(shell)
        fine.model.frames = frames_with(points, directors)
        fine.frames[:n] = shell.frames
        fine.model.mesh = fine.model.cut_mesh = SurfaceMesh(points, cells, mesh.cell, normals)
        fine.model.connectivity, fine.model.source, fine.model.has_mass = cells, None, False
        fine.model.stiffness = np.repeat(shell.model.stiffness, 4, axis=0)
        fine.model.axes = np.repeat(shell.model.axes, 4, axis=0)
        separate, own = copy(fine), np.arange(cells.size).reshape(cells.shape)
        separate.model.frames, separate.model.connectivity = fine.frames[cells.ravel()], own
        separate.model.mesh = separate.model.cut_mesh = SurfaceMesh(
            points[cells.ravel()], own, mesh.cell, normals
        )
        return cls(shell, fine, separate, ends, number, met == 1)

    @property
    def added(self) -> Indices:
        """New nodes of each cell, numbered from 0: on its edges, and in its middle, (m, 3 or 5)."""
        edges, m = len(self.ends), len(self.sides)
        if len(self.fine.frames) == len(self.shell.frames) + edges:
            return self.sides
        return np.column_stack([self.sides, edges + np.arange(m)])


def shapes_of_parts(cell: str) -> Array:
    """Shape functions of a cell at the corners of its four parts, shape (4, k, k)."""
    kind = basix.CellType[cell]
    X = np.array(basix.geometry(kind))
    edges = X[np.array(basix.topology(kind)[1])].mean(axis=1)
    at = np.concatenate([X, edges, X.mean(axis=0)[np.newaxis]])
    return np.asarray(tabulated(cell, 1, at)[0][np.array(_PARTS[cell])])


def areas_of(shell: Shell) -> Array:
    """Integration weights (areas) of the integration points, shape (m, g)."""
    mesh = shell.model.cut_mesh
    rule, weights = integration(shell)
    tangents = CellPoints.of(mesh, rule).tangents(mesh.points[mesh.cells])
    return np.asarray(weights * np.linalg.norm(np.cross(*np.moveaxis(tangents, 2, 0)), axis=-1))


# --- positions of new nodes ---


def on_all_nodes(cut: Cut, frames: Array) -> Array:
    """Frames of all nodes, shape (N, 4, 3), from those of the old ones, (n, 4, 3).

    New ones are on bent edges between their ends. Edges whose directors rotate relative to each
    other are curved, so that no shear arises.
    """
    n = len(frames)
    found = np.concatenate([frames, cut.fine.frames[n:]])
    found[n + cut.added] = _between(cut, frames[cut.shell.model.cut_mesh.cells])
    return found


def _between(cut: Cut, corners: Array) -> Array:
    """Frames of the new nodes of each cell, (m, c, 4, 3), from those of its corners, (m, k, 4, 3).

    In cells with a middle it is above the mean of the corners by half the sum over the edges.
    """
    mesh, n = cut.shell.model.cut_mesh, len(cut.shell.frames)
    a, b = np.moveaxis(np.array(basix.topology(basix.CellType[mesh.cell])[1]), 1, 0)
    unloaded, fine = cut.shell.frames[mesh.cells], cut.fine.frames[n + cut.sides]
    positions, up = _bulged(corners[:, a], corners[:, b])
    start, _ = _bulged(unloaded[:, a], unloaded[:, b])
    exact = np.einsum("mcj,mcj->mc", fine[:, :, 0] - start, fine[:, :, 3])
    positions = positions + exact[..., np.newaxis] * up
    if cut.added.shape[1] > len(a):
        above = positions - 0.5 * (corners[:, a, 0] + corners[:, b, 0])
        middle = corners[:, :, 0].mean(axis=1) + 0.5 * above.sum(axis=1)
        positions = np.concatenate([positions, middle[:, np.newaxis]], axis=1)
        up = np.concatenate([up, unit(corners[:, :, 3].sum(axis=1))[:, np.newaxis]], axis=1)
    found = frames_with(positions.reshape(-1, 3), up.reshape(-1, 3))
    return np.asarray(found.reshape(*up.shape[:2], 4, 3))


def _bulged(a: Array, b: Array) -> tuple[Array, Array]:
    """Midpoints and directors of edges between frames (..., 4, 3)."""
    up, along = unit(a[..., 3, :] + b[..., 3, :]), b[..., 0, :] - a[..., 0, :]
    turn = ((b[..., 3, :] - a[..., 3, :]) * along).sum(axis=-1, keepdims=True) / 8.0
    return 0.5 * (a[..., 0, :] + b[..., 0, :]) + turn * up, up


def interpolation(cut: Cut, H: Array) -> csr_matrix:
    """Derivative of the twists of new nodes in those of old ones, shape (5 new, 5 n).

    Args:
        cut: The refined shell.
        H: Frames of all its nodes.
    """
    cells, n = cut.shell.model.cut_mesh.cells, len(cut.shell.frames)
    at, corners = H[n + cut.added], H[cells]

    def moved(step: Array) -> Array:
        """Positions and directors in the frames at the start, (m, c, 6)."""
        found = lie.se3_retract(corners.reshape(-1, 4, 3), step.reshape(-1, 6))
        new = _between(cut, found.reshape(corners.shape))[:, :, [0, 3]]
        return np.asarray(np.einsum("mcij,mcpj->mcpi", at[:, :, 1:], new).reshape(*at.shape[:2], 6))

    columns = [
        (moved(step) - moved(-step)) / (2.0 * size)
        for step, size in unit_steps(cells.shape, cut.shell.model.size)
    ]
    change = np.stack(columns, axis=3)
    # a director d₃ changes by ω₂ d₁ − ω₁ d₂
    each = np.stack([*(change[:, :, i] for i in range(3)), -change[:, :, 4], change[:, :, 3]], 2)
    _, first = np.unique(cut.added, return_index=True)  # both cells at an edge have the same
    each = each.reshape(-1, *each.shape[2:])[first]
    rows = _FIVE * np.arange(len(first))[:, np.newaxis] + np.arange(_FIVE)
    return assembled(each, rows, unknowns(cells)[first // cut.added.shape[1]], _FIVE * n)


def unit_steps(shape: tuple[int, ...], size: float) -> list[tuple[Array, float]]:
    """Twists of the nodes of cells (m, k, 6) with one small component each, and its size.

    Args:
        shape: Numbers of cells m and of their nodes k.
        size: Length of the model; translations are small to it.
    """
    found = []
    for corner in range(shape[1]):
        for i in range(_FIVE):
            step = np.zeros((*shape, 6))
            step[:, corner, i] = _STEP * size if i < 3 else _STEP
            found.append((step, float(step[0, corner, i])))
    return found


def unknowns(cells: Indices) -> Indices:
    """Numbers of the unknowns of cells, five per node, shape (m, 5 k)."""
    found = _FIVE * cells[..., np.newaxis] + np.arange(_FIVE)
    return np.asarray(found.reshape(len(cells), -1))


def assembled(blocks: Array, rows: Indices, columns: Indices, width: int) -> csr_matrix:
    """Sum of blocks (b, p, q) in rows (b, p) and columns (b, q) of a matrix."""
    i, j = np.broadcast_arrays(rows[..., np.newaxis], columns[:, np.newaxis])
    entries = blocks.ravel(), (i.ravel(), j.ravel())
    return coo_matrix(entries, shape=(int(rows.max()) + 1, width)).tocsr()


# --- supports ---


def free_motions(cut: Cut, H: Array) -> csr_matrix:
    """Twists of all nodes that supports admit, as orthonormal columns, shape (5 N, free).

    A new node on a supported edge has the motions of either end. Edges on the border are supported,
    and edges inside unless both ends are on the border.

    Args:
        cut: The refined shell.
        H: Frames of all its nodes.
    """
    model, n = cut.shell.model, len(cut.shell.frames)
    axes = np.tile(np.eye(_FIVE), (len(H), 1, 1))
    free = np.ones((len(H), _FIVE), dtype=np.bool_)
    in_space = np.flatnonzero(np.isfinite(model.supports).all(axis=(1, 2)))
    axes[in_space, :3, :3] = H[in_space, 1:] @ np.swapaxes(model.supports[in_space], 1, 2)
    free[:n] = ~model.held[:, :_FIVE]
    on_border = np.zeros(n, dtype=np.bool_)
    on_border[cut.ends[cut.border]] = True
    edges = np.flatnonzero(cut.border | ~on_border[cut.ends].all(axis=1))
    for part, basis in ((slice(3), H[:, 1:]), (slice(3, _FIVE), H[:, 1:3])):
        known = np.swapaxes(basis[:n], 1, 2) @ axes[:n, part, part]
        admitted = (known * free[:n, np.newaxis, part]) @ np.swapaxes(known, 1, 2)
        own = basis[n + edges]
        both = own @ admitted[cut.ends[edges]].mean(axis=1) @ np.swapaxes(own, 1, 2)
        size, axes[n + edges, part, part] = np.linalg.eigh(both)
        free[n + edges, part] = size > _ADMITTED
    blocks = bsr_matrix((axes, np.arange(len(H)), np.arange(len(H) + 1)))
    return blocks.tocsc()[:, free.ravel()].tocsr()


# --- external forces ---


def on_new_nodes(cut: Cut, H: Array, motions: csr_matrix) -> Array:
    """External force and moment on each new node, components in its frame, shape (new, 5).

    Forces on old nodes are in equilibrium with the cells. New nodes get their part of the forces
    on neighbouring old nodes, without those of supports.

    Args:
        cut: The refined shell.
        H: Frames of all its nodes.
        motions: Motions that supports admit.
    """
    shell, n = cut.shell, len(cut.shell.frames)
    coarse = assembly_of([shell.model])
    rows, forces = np.empty_like(H[:n]), coarse.workspace()
    rows[coarse.order] = H[:n]
    coarse.reset_stress(rows)
    coarse.add_forces(rows, forces)
    acts, old = np.zeros((n, 6)), motions[: _FIVE * n]
    acts[:, :_FIVE] = (old @ (old.T @ forces[coarse.order, :_FIVE].ravel())).reshape(n, _FIVE)
    new = _on_new_nodes(cut, _turned(acts, np.swapaxes(H[:n, 1:], 1, 2)))
    return _turned(new, H[n:, 1:])[:, :_FIVE]


def _on_new_nodes(cut: Cut, acts: Array) -> Array:
    """External forces on new nodes, shape (new, 6), from those on old nodes, (n, 6)."""
    shell, count = cut.shell, len(acts)
    inner = np.ones(count, dtype=bool)
    inner[cut.ends[cut.border]] = False
    carried = _carried(shell, count)
    per_area = np.where(inner[:, np.newaxis], acts / carried[:, np.newaxis], np.nan)
    per_area = _beyond(shell, per_area)
    rest = acts - per_area * carried[:, np.newaxis]
    density = [_least(per_area[cut.ends])]
    if len(cut.fine.frames) > count + len(cut.ends):
        density.append(_least(per_area[shell.model.cut_mesh.cells]))
    fine = _carried(cut.fine, len(cut.fine.frames))[count:]
    found = np.concatenate(density) * fine[:, np.newaxis]
    found[np.flatnonzero(cut.border)] += _on_borders(shell, cut.ends[cut.border], rest)
    return found


def _on_borders(shell: Shell, ends: Indices, acts: Array) -> Array:
    """External forces on midpoints of border edges (b, 2), from those on nodes (n, 6), (b, 6).

    Corners, where two lines meet, do not contribute.
    """
    along = np.diff(shell.frames[ends, 0], axis=1)[:, 0]
    length = np.linalg.norm(along, axis=1)
    share, straight = border_shares(ends, along / length[:, np.newaxis], length)
    density = acts[ends] / share[..., np.newaxis]
    known = straight.astype(bool)
    density = np.where(known[..., np.newaxis], density, density[:, ::-1])
    density[~known.any(axis=1)] = 0.0
    return 0.5 * length[:, np.newaxis] * _least(density)


def _least(values: Array) -> Array:
    """The least magnitude of several (e, k, 6), zero where signs differ: excludes point forces."""
    low, high = values.min(axis=1), values.max(axis=1)
    return np.where(low > 0, low, np.where(high < 0, high, 0.0))


def _carried(shell: Shell, count: int) -> Array:
    """Tributary area of each node, shape (count,)."""
    mesh = shell.model.cut_mesh
    rule, _ = integration(shell)
    shares = areas_of(shell) @ tabulated(mesh.cell, 1, rule)[0]
    return np.asarray(np.bincount(mesh.cells.ravel(), shares.ravel(), minlength=count))


def _beyond(shell: Shell, values: Array) -> Array:
    """Values (n, 6) at all nodes; unknown ones are the mean over the cells around the node."""
    cells = shell.model.cut_mesh.cells
    known = np.isfinite(values)
    filled = np.where(known, values, 0.0)
    total = np.maximum(known[cells].sum(axis=1), 1)
    mean = filled[cells].sum(axis=1) / total
    any_known = known[cells].any(axis=1).astype(np.float64)
    out, count = np.zeros_like(filled), np.zeros_like(filled)
    for k in range(cells.shape[1]):
        np.add.at(out, cells[:, k], mean * any_known)
        np.add.at(count, cells[:, k], any_known)
    return np.where(known, filled, out / np.maximum(count, 1.0))


def _turned(wrench: Array, R: Array) -> Array:
    """Forces and moments (n, 6) multiplied by matrices (n, 3, 3)."""
    return np.asarray(np.einsum("nij,npj->npi", R, wrench.reshape(-1, 2, 3)).reshape(-1, 6))
