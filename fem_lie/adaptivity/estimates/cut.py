"""Shells with each cell cut into four: the new nodes, and local problems on patches of cells."""

from __future__ import annotations

from copy import copy
from typing import NamedTuple

import basix
import numpy as np
import scipy.sparse.linalg
from scipy.sparse import bsr_matrix, coo_matrix, csr_matrix

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.shells.assembly import assembly_of
from fem_lie.bodies.shells.placing import frames_with
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.shapes import tabulated
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.results.stresses.nodal_values import CellPoints, unit
from fem_lie.results.stresses.shell_stress import integration

_STRAIGHT = 0.9  # cosine


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
        held: Whether each new node is fixed, shape (new,).
    """

    shell: Shell
    fine: Shell
    separate: Shell
    ends: Indices
    sides: Indices
    border: Flags
    held: Flags

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
        clamped: Flags = np.asarray(shell.model.held[:, :_FIVE].all(axis=1))
        held = np.concatenate([clamped[ends].all(axis=1), np.zeros(middles, dtype=bool)])
        return cls(shell, fine, separate, ends, number, met == 1, held)


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


# --- external forces ---


def on_all_nodes(cut: Cut, frames: Array) -> Array:
    """External force and moment on each node of the refined shell, global components, (N, 6).

    Those on old nodes are in equilibrium: they are the residual of the cells, including supports.
    New nodes get their part of the forces on neighbouring old nodes.
    """
    shell = cut.shell
    coarse = assembly_of([shell.model])
    rows, forces = np.empty_like(frames), coarse.workspace()
    rows[coarse.order] = frames
    coarse.reset_stress(rows)
    coarse.add_forces(rows, forces)
    acts = _global(frames, forces[coarse.order])
    new, edges = _on_new_nodes(cut, acts), len(cut.ends)
    corners = shell.model.cut_mesh.cells
    for givers, taken in ((cut.ends, new[:edges]), (corners[: len(new) - edges], new[edges:])):
        each = np.repeat(taken / givers.shape[1], givers.shape[1], axis=0)
        np.subtract.at(acts, givers.ravel(), each)
    return np.concatenate([acts, new])


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


def _global(H: Array, wrench: Array) -> Array:
    pair = wrench.reshape(-1, 2, 3)
    return np.asarray(np.einsum("npi,nij->npj", pair, H[:, 1:]).reshape(-1, 6))


class Patches(NamedTuple):
    """Local problems, one for each cell: its corners and all new nodes adjacent to one of them.

    Attributes:
        patch: Problem of each node of all problems, sorted, shape (r,).
        nodes: Number of the node in the refined shell, sorted within a problem, shape (r,).
        total: Number of nodes of the refined shell.
    """

    patch: Indices
    nodes: Indices
    total: int

    @classmethod
    def of(cls, cut: Cut) -> Patches:
        """Local problems of a refined shell."""
        corners, (m, k) = cut.shell.model.cut_mesh.cells, cut.shell.model.cut_mesh.cells.shape
        n, N, edges = len(cut.shell.frames), len(cut.fine.frames), len(cut.ends)
        middles = np.arange(n + edges, N)
        about = [np.arange(n), cut.ends.ravel(), corners[: len(middles)].ravel()]
        nodes = [np.arange(n), np.repeat(n + np.arange(edges), 2), np.repeat(middles, k)]
        pairs = np.concatenate(about), np.concatenate(nodes)
        incident = csr_matrix((np.ones(len(pairs[0])), pairs), shape=(n, N))
        of_cells = csr_matrix((np.ones(m * k), (np.repeat(np.arange(m), k), corners.ravel())))
        found = np.unique(np.ravel_multi_index((of_cells @ incident).nonzero(), (m, N)))
        return cls(found // N, found % N, N)

    def solved(self, cells: Indices, stiffness: Array, rest: Array, free: Flags) -> Array:
        """Nodal motions of each fine cell in the problem of its parent, shape (4 m, k, 5).

        Args:
            cells: Nodes of the fine cells, shape (4 m, k).
            stiffness: Stiffness of the fine cells, shape (4 m, k 5, k 5).
            rest: Residual force at each node, shape (N, 5).
            free: Whether each degree of freedom is free, shape (N, 5).
        """
        K = _assembled(cells, stiffness, free)
        keys = self.patch * self.total + self.nodes
        starts, lengths = K.indptr[self.nodes], np.diff(K.indptr)[self.nodes]
        row = np.repeat(np.arange(len(keys)), lengths)
        first = np.repeat(np.cumsum(lengths) - lengths, lengths)
        block = starts[row] + np.arange(len(row)) - first
        target = self.patch[row] * self.total + K.indices[block]
        column = np.minimum(np.searchsorted(keys, target), len(keys) - 1)
        known = keys[column] == target  # other nodes are on the boundary of the patch
        counts = np.bincount(row[known], minlength=len(keys))
        matrix = bsr_matrix(
            (K.data[block[known]], column[known], np.append(0, np.cumsum(counts))),
            shape=(keys.size * _FIVE,) * 2,
        )
        forces = np.where(free, rest, 0.0)[self.nodes].ravel()
        solve = scipy.sparse.linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A")
        moved = solve.solve(forces).reshape(-1, _FIVE)
        parents = np.arange(len(cells))[:, np.newaxis] // 4
        return np.asarray(moved[np.searchsorted(keys, parents * self.total + cells)])


def _assembled(cells: Indices, stiffness: Array, free: Flags) -> bsr_matrix:
    """Sorted blocks of five by five; fixed degrees of freedom have a one on the diagonal."""
    size = free.size
    rows = (_FIVE * cells[..., np.newaxis] + np.arange(_FIVE)).reshape(len(cells), -1)
    loose = free.ravel()[rows]
    values = stiffness * (loose[:, :, np.newaxis] & loose[:, np.newaxis])
    i, j = np.broadcast_arrays(rows[..., np.newaxis], rows[:, np.newaxis])
    held = np.flatnonzero(~free.ravel())
    entries = np.concatenate([values.ravel(), np.ones(len(held))])
    entries_at = np.concatenate([i.ravel(), held]), np.concatenate([j.ravel(), held])
    K = coo_matrix((entries, entries_at), shape=(size, size)).tocsr().tobsr((_FIVE, _FIVE))
    K.sort_indices()
    return K
