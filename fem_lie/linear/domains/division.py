"""Division of cells, nodes and constraints among ranks, and the parts of the matrix.

Cells at the nodes of a constraint, or of a node pair that is in no cell, are one vertex of the
graph that is divided. All nodes of a constraint are then within one subdomain, which owns its
multiplier, and subdomains meet within bodies. Vertices are weighted by their unknowns, edges by the
unknowns that they share. SCOTCH divides the graph into equal parts with few edges between them.

petsc4py and DOLFINx offer no vertex weights. SCOTCH comes with PETSc, and its functions are called
by their addresses; it reports the size of its structures.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.ranks.shared_factors import Subdomains


class Part:
    """Unknowns of a subdomain, and the values of its matrix.

    Attributes:
        inside: Unknowns that no other subdomain has, multipliers included.
        interface: Its other unknowns.
        interfaces: Interface unknowns of all subdomains, ``size`` in number.
        at: Positions of this subdomain's interface unknowns among these.
        held: Held unknowns of the scene.
        values: Values in the pattern of the whole matrix; arbitrary for unknowns of other
            subdomains.
        motions: Rigid motions of all interface unknowns.
        made: Number of factorisations; ``solutions`` with them took ``iterations``.
    """

    def __init__(self, own: Flags, shared: Flags, multipliers: Flags, held: Flags) -> None:
        """Number the unknowns.

        Args:
            own: Whether a node is in the subdomain, shape (n,).
            shared: Whether several subdomains have a node, shape (n,).
            multipliers: Whether a multiplier is in the subdomain, shape (m,).
            held: Held unknowns of nodes, shape (n, 6).
        """
        free = ~held
        inside = (own & ~shared)[:, np.newaxis] & free
        of_nodes, of_constraints = inside.ravel(), multipliers
        self.inside: Indices = np.flatnonzero(np.append(of_nodes, of_constraints))
        self.interface: Indices = np.flatnonzero((own & shared)[:, np.newaxis] & free)
        self.interfaces: Indices = np.flatnonzero(shared[:, np.newaxis] & free)
        self.size = len(self.interfaces)
        self.at: Indices = np.searchsorted(self.interfaces, self.interface)
        self.held: Indices = np.flatnonzero(held)
        self.values: Array = np.empty(0)
        self.motions: Sequence[Array] = ()
        self.made = self.solutions = self.iterations = 0

    @property
    def statistics(self) -> Subdomains:
        """Statistics of the subdomain for results."""
        counts = self.made, self.solutions, self.iterations
        return Subdomains(MPI.COMM_WORLD.size, self.size, *counts)


IMBALANCE = 0.05
"""Admissible excess weight of a part over the mean, if cells are small enough."""

_QUALITY, _SEED = 1, 1


@cache
def _library() -> ctypes.CDLL:
    """The SCOTCH library to which PETSc is linked.

    Raises:
        RuntimeError: PETSc has none, or one with another integer type.
    """
    found = ctypes.CDLL(PETSc.__file__)
    if not hasattr(found, "SCOTCH_graphPart"):
        raise RuntimeError("subdomains need a PETSc that is linked with SCOTCH, got one without")
    if found.SCOTCH_numSizeof() != 4:
        raise RuntimeError("subdomains need SCOTCH with integers of 32 bits, got another one")
    return found


def _done(error: int, what: str) -> None:
    if error:
        raise RuntimeError(f"SCOTCH could not {what}")


def parts_of(edges: sp.csr_matrix, weights: Indices, count: int) -> Indices:
    """Part of each vertex, shape (n,).

    Args:
        edges: Symmetric integer weights of edges, without a diagonal, shape (n, n).
        weights: Positive weights of the vertices, shape (n,).
        count: Number of parts.
    """
    library, n = _library(), edges.shape[0]
    pointers, columns, load, weight = (
        np.ascontiguousarray(a, np.int32)
        for a in (edges.indptr, edges.indices, edges.data, weights)
    )
    part = np.zeros(n, dtype=np.int32)

    def at(array: Any, first: int = 0) -> ctypes.c_void_p:
        return ctypes.c_void_p(array.ctypes.data + 4 * first)

    graph = ctypes.create_string_buffer(library.SCOTCH_graphSizeof())
    strategy = ctypes.create_string_buffer(library.SCOTCH_stratSizeof())
    library.SCOTCH_randomSeed(_SEED)  # the same scene has the same parts in every run
    library.SCOTCH_randomReset()
    _done(library.SCOTCH_graphInit(graph), "make a graph")
    _done(library.SCOTCH_stratInit(strategy), "make a strategy")
    given = at(pointers), at(pointers, 1), at(weight), None, len(columns), at(columns), at(load)
    _done(library.SCOTCH_graphBuild(graph, 0, n, *given), "take the graph of cells and joints")
    balance = ctypes.c_double(IMBALANCE)
    _done(library.SCOTCH_stratGraphMapBuild(strategy, _QUALITY, count, balance), "find a strategy")
    _done(library.SCOTCH_graphPart(graph, count, strategy, at(part)), "divide the graph")
    library.SCOTCH_graphExit(graph)
    library.SCOTCH_stratExit(strategy)
    return part.astype(np.int64)


class Links(NamedTuple):
    """Nodes of cells, or of constraints.

    Attributes:
        which: Number of the cell or constraint of each entry, shape (k,).
        nodes: Node of each entry, shape (k,).
        size: Number of cells or constraints.
    """

    which: Indices
    nodes: Indices
    size: int

    def matrix(self, nodes: int) -> sp.csr_matrix:
        """Matrix with ones where the cell or constraint of a row has the node of a column."""
        ones = np.ones(len(self.which), dtype=np.int64)
        found = sp.csr_matrix((ones, (self.which, self.nodes)), shape=(self.size, nodes))
        found.data[:] = 1
        return found


class Division(NamedTuple):
    """All subdomains, equal on all ranks.

    Attributes:
        cells: Subdomain of each cell, (c,).
        constraints: Subdomain of each constraint, (m,).
        nodes: Whether a subdomain has a node, (n, domains).
    """

    cells: Indices
    constraints: Indices
    nodes: Flags

    @property
    def shared(self) -> Flags:
        """Whether several subdomains have a node, shape (n,)."""
        return np.asarray(self.nodes.sum(axis=1) > 1)


def divided(cells: Links, constraints: Links, others: Links, free: Indices, count: int) -> Division:
    """Divide cells and constraints into subdomains.

    Args:
        cells: Nodes of all cells; each node has at least one.
        constraints: Nodes of all constraints.
        others: Nodes of further couplings.
        free: Number of unknowns of each node, shape (n,).
        count: Number of subdomains.

    Raises:
        ValueError: Connected cells and constraints cannot be divided into so many.
    """
    n = len(free)
    C = cells.matrix(n)
    held = sp.vstack([constraints.matrix(n), others.matrix(n)], format="csr") @ C.T
    graph = sp.bmat([[None, held.T], [held, None]], format="csr")
    if held.shape[0] == 0:
        graph = sp.csr_matrix((cells.size,) * 2)
    groups, group = connected_components(graph, directed=False)
    group = group[: cells.size]
    used, group = np.unique(group, return_inverse=True)
    groups = len(used)
    if groups < count:
        raise ValueError(
            f"{count} subdomains need {count} parts between which there are no joints, got "
            f"{groups}: divide bodies between joints into more elements, or take fewer ranks"
        )
    P = sp.csr_matrix((np.ones(cells.size), (group, np.arange(cells.size)))) @ C
    P.data[:] = 1.0
    sharing = np.asarray(P.sum(axis=0)).ravel()
    weights = np.maximum(np.rint(12 * (P @ (free / sharing))), 1).astype(np.int64)
    edges = (P @ sp.diags(free.astype(float)) @ P.T).tocsr()
    edges.setdiag(0)
    edges.eliminate_zeros()
    edges.data = np.maximum(edges.data, 1.0)
    part = parts_of(edges, weights, count)
    return _of_parts(part[group], C, constraints, count)


def _of_parts(part: Indices, C: sp.csr_matrix, constraints: Links, count: int) -> Division:
    """Division from the subdomains of cells.

    Raises:
        ValueError: A subdomain has no cells.
    """
    empty = np.flatnonzero(np.bincount(part, minlength=count) == 0)
    if len(empty):
        raise ValueError(f"{len(empty)} of {count} subdomains would be empty: take fewer ranks")
    at = part[C.tocsc().indices[C.tocsc().indptr[:-1]]]  # domain of the first cell of each node
    domain = np.zeros(constraints.size, dtype=np.int64)
    domain[constraints.which] = at[constraints.nodes]
    D = C.T @ sp.csr_matrix((np.ones(len(part)), (np.arange(len(part)), part)))
    return Division(part, domain, D.toarray() > 0)
