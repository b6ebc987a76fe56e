"""Weighted graphs in equal parts with few edges between them, by SCOTCH.

petsc4py and DOLFINx offer no weights of vertices. SCOTCH is there with PETSc and is called by
the addresses of its functions; structures are memory of a size that it tells.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Indices

IMBALANCE = 0.05
"""By which a part may be heavier than the mean, if cells are small enough."""

_QUALITY, _SEED = 1, 1


@cache
def _library() -> ctypes.CDLL:
    """That which PETSc is linked with.

    Raises:
        RuntimeError: PETSc has none, or one with other integers.
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
        edges: Symmetric integers, without a diagonal, shape (n, n).
        weights: Of the vertices, positive, shape (n,).
        count: Of parts.
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
