"""Choice of the package that factorises a matrix, from its graph, its fill and its values.

Measured with OpenBLAS on beams, nets, linkages, shells and solids of 18 to 50 000 unknowns
(``benchmarks/packages.py``): KLU is the fastest for chains, trees and rings; CHOLMOD is two to
three times as fast as others if a matrix is symmetric and positive definite, apart from few rows of
multipliers and frames; MUMPS is the fastest for all other large matrices. UMFPACK solves two to
three times as fast as MUMPS, which counts with many solutions per factorisation. KLU and UMFPACK
depart from their ordering because constraints leave zeros on the diagonal: for meshes with many
joints the fill becomes large. The graph does not show this reliably; the time of the first
factorisation does.

The cost of an elimination, fill and operations of a Cholesky factor, is computed from the graph.
Its vertices are nodes, weighted by their free unknowns, and constraints. The columns of the factor
are counted along the row subtrees of the elimination tree (J. W. H. Liu, SIAM J. Matrix Anal. Appl.
11 (1990) 134), for a minimum-degree ordering and one by nested dissection.
"""

from __future__ import annotations

import logging
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, NamedTuple

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.condensed.elimination import plan_of
from fem_lie.linear.condensed.schur import MOST
from fem_lie.linear.domains.interface import WAYS
from fem_lie.linear.packages import (
    Alone,
    ByChains,
    ByMinimumDegree,
    BySchurComplement,
    Domains,
    Method,
)
from fem_lie.linear.saddle_point import Incidences
from fem_lie.ranks.together import several

if TYPE_CHECKING:
    from fem_lie.linear.saddle_point import KKT

MINIMUM_DEGREE, DISSECTION = "amd", PETSc.Mat.OrderingType.ND
_WITHOUT_AMD = PETSc.Mat.OrderingType.QMD  # if PETSc was built without SuiteSparse


class Cost(NamedTuple):
    """Cost of an elimination.

    Attributes:
        fill: Entries of the factor.
        operations: Multiplications.
    """

    fill: float
    operations: float


class Graph(NamedTuple):
    """Graph of a matrix.

    Attributes:
        adjacency: Adjacency of vertices with unknowns, symmetric, with its diagonal.
        sizes: Number of unknowns of each vertex, shape (v,).
        constraints: Number of constraints, the last vertices.
    """

    adjacency: sp.csr_matrix
    sizes: Indices
    constraints: int

    @classmethod
    def of(cls, indptr: Indices, indices: Indices, incidences: Incidences, held: Flags) -> Graph:
        """Graph from node pairs, incidences of constraints, and held unknowns (n, 6)."""
        n, m = len(held), len(incidences.ptr) - 1
        nodes = sp.csr_matrix((np.ones(len(indices)), indices, indptr), shape=(n, n))
        touched = sp.csr_matrix(
            (np.ones(len(incidences.nodes)), incidences.nodes, incidences.ptr), shape=(m, n)
        )
        whole = sp.bmat(
            [[nodes + nodes.T + sp.eye(n), touched.T], [touched, sp.eye(m)]], format="csr"
        )
        sizes = np.append((~held).sum(axis=1), np.ones(m, dtype=np.int64))
        moves = sizes > 0
        adjacency = whole[moves][:, moves].tocsr()
        adjacency.sort_indices()
        return cls(adjacency, sizes[moves], m)

    @property
    def unknowns(self) -> int:
        """Number of free unknowns and constraints."""
        return int(self.sizes.sum())

    def cost(self, ordering: str) -> Cost:
        """Cost with one of PETSc's orderings."""
        order = _ordering(self.adjacency, ordering)
        columns = _columns(self.adjacency, order, self.sizes)
        return _cost(columns, self.sizes[order])

    @property
    def width(self) -> int:
        """Largest number of neighbours of a node when it is eliminated, without constraints.

        With the minimum-degree ordering it is one in trees and two in rings.
        """
        n = len(self.sizes) - self.constraints
        nodes = self.adjacency[:n, :n].tocsr()
        columns = _columns(nodes, _ordering(nodes, MINIMUM_DEGREE), np.ones(n, dtype=np.int64))
        return int(columns.max(initial=1.0)) - 1


def _columns(adjacency: sp.csr_matrix, order: Indices, sizes: Indices) -> Array:
    """Length of the first column of each vertex in the factor, in elimination order, (v,).

    Args:
        adjacency: Adjacency of the vertices.
        order: Elimination order, shape (v,).
        sizes: Number of unknowns of each vertex, shape (v,).
    """
    position = np.empty_like(order)
    position[order] = np.arange(len(order))
    columns: Array = sizes[order].astype(np.float64)
    _count(adjacency.indptr, adjacency.indices, order, position, sizes, columns)
    return columns


def _ordering(adjacency: sp.csr_matrix, name: str) -> Indices:
    """Elimination order of the vertices, shape (v,)."""
    if not adjacency.shape[0]:
        return np.empty(0, dtype=np.int64)
    csr = (
        adjacency.indptr.astype(PETSc.IntType),
        adjacency.indices.astype(PETSc.IntType),
        adjacency.data,
    )
    matrix = PETSc.Mat().createAIJ(adjacency.shape, csr=csr, comm=PETSc.COMM_SELF)
    try:
        rows, _ = matrix.getOrdering(name)
    except PETSc.Error:
        if name != MINIMUM_DEGREE:
            raise
        rows, _ = matrix.getOrdering(_WITHOUT_AMD)
    return np.asarray(rows.getIndices(), dtype=np.int64)


@compiled
def _count(
    pointers: Indices,
    neighbours: Indices,
    order: Indices,
    position: Indices,
    sizes: Indices,
    columns: Array,
) -> None:
    """Add to the unknowns of each vertex those of all vertices that its elimination couples.

    Args:
        pointers: Row pointers of the graph.
        neighbours: Column indices of the graph.
        order: Elimination order, shape (v,).
        position: Position of each vertex in it.
        sizes: Number of unknowns of each vertex.
        columns: Column lengths in elimination order, shape (v,), updated.
    """
    n = len(order)
    parent, seen = np.full(n, -1), np.full(n, -1)
    for k in range(n):
        seen[k] = k
        for p in range(pointers[order[k]], pointers[order[k] + 1]):
            j = position[neighbours[p]]
            while j < k and seen[j] != k:
                if parent[j] < 0:
                    parent[j] = k
                columns[j] += sizes[order[k]]
                seen[j] = k
                j = parent[j]


def _cost(columns: Array, sizes: Indices) -> Cost:
    """Sum the cost over all unknowns; the columns of a vertex decrease in length by one each.

    Args:
        columns: Length of the first column of each vertex, shape (v,).
        sizes: Number of unknowns of each vertex.
    """
    first, s = columns, sizes
    below = s * (s - 1) / 2.0  # 0 + 1 + … + (s − 1)
    squares = (s - 1) * s * (2 * s - 1) / 6.0
    fill = (s * first - below).sum()
    operations = (s * first**2 - 2.0 * first * below + squares).sum()
    return Cost(float(fill), float(operations))


LARGE = 20_000
"""Number of nodes from which chains are eliminated before a package factorises the rest."""

CHAINS = ByChains("lu", "mumps"), Method("lu", "mumps"), Method("lu", "umfpack")
"""Methods for large nets and trusses, most nodes of which are within cables and bars."""

SMALL = 300
"""Number of unknowns up to which KLU is the fastest, for any ordering and symmetric or not."""

_CHAIN = 2  # largest width of a chain, a tree or a ring
_FILLS = 1e9  # operations from which several ranks factorise together
_SCHUR = 2e7  # operations from which a Schur complement costs less than unsymmetric factors
_COSTLY = 5e9  # operations from which UMFPACK is slower in total
_JOINTED, _LEAVES = 0.02, 2e7  # constraints over unknowns, operations: UMFPACK minds both
_WORSE = 2.0  # operations by minimum degree over those by dissection, UMFPACK's over MUMPS'
_NEARLY = 1.3  # the same, up to which a faster search for the ordering is worth more
_UNKNOWN, _OPERATION = 1e-6, 1.2e-9  # seconds for each, if the package keeps the ordering

_DOMAINS, _PACKAGE = "domains", "pc_factor_mat_solver_type"
_KINDS = {"cholmod": ("cholesky",), "mumps": ("cholesky", "lu")}  # other packages have LU only

_log = logging.getLogger(__name__)


class Solutions(Enum):
    """Number of solutions per factorisation."""

    FEW = "few solutions each"
    MANY = "many solutions each"


class SkewPart(IntEnum):
    """What happens to the skew-symmetric part of a matrix before it is factorised.

    ``KEPT``: the matrix is factorised as it is. ``DROPPED_IF_SMALL``: it is dropped
    if it is so small that an iteration does not notice it (:data:`~.equilibrated.SMALL_SKEW`), so
    that a symmetric package factorises the rest where that costs less: not in scenes of at most
    :data:`SMALL` unknowns. The equations are solved to the same tolerance with both.
    """

    KEPT = 0
    DROPPED_IF_SMALL = 1


class Choice(NamedTuple):
    """Methods in the order in which they are tried.

    Attributes:
        methods: The methods.
        seconds: Expected processor time of the first factorisation; ``None``: unknown.
    """

    methods: tuple[Method, ...]
    seconds: float | None = None


def choose(kkt: KKT, prefix: str, solutions: Solutions) -> Choice:
    """The fastest methods for a matrix.

    Args:
        kkt: The matrix, of which the pattern counts; symmetric methods are skipped while its values
            are unsymmetric.
        prefix: Prefix of PETSc's options.
        solutions: Number of solutions per factorisation.

    Raises:
        ValueError: The option asks for impossible subdomains.
    """
    if kkt.shared.several:
        return _on_parts(kkt)
    if asked := _on_domains(prefix) or _by_option(prefix):
        return Choice(asked)
    if len(kkt.indptr) > LARGE and 2 * len(plan_of(kkt).order) > len(kkt.indptr):
        return _logged(Choice(CHAINS), kkt, "most nodes are within chains")
    free = int((~kkt.unit_rows).sum())
    if free <= SMALL:
        return _logged(Choice((Alone("lu", "klu"),)), kkt, f"{free} unknowns are few")
    return _by_fill(kkt, solutions)


def _on_parts(kkt: KKT) -> Choice:
    """Choice for the sum of the matrices of all ranks, by the cost of all parts; collective."""
    nodes, within = kkt.shared.total(np.array([len(kkt.indptr), len(plan_of(kkt).order)]))
    if 2 * within > nodes:  # of any size, as what is left makes messages
        return _logged(Choice(CHAINS[:2]), kkt, "divided among ranks, most nodes are within chains")
    graph = Graph.of(kkt.indptr, kkt.indices, kkt.incidences, kkt.held)
    own = np.array([graph.cost(ordering).operations for ordering in (MINIMUM_DEGREE, DISSECTION)])
    degree, dissection = kkt.shared.total(own)
    kind = ByMinimumDegree if degree <= _NEARLY * dissection else Method
    why = f"divided among ranks, operations {degree:.1e} by degree, {dissection:.1e} by dissection"
    return _logged(Choice((kind("cholesky", "mumps"), kind("lu", "mumps"))), kkt, why)


def _by_fill(kkt: KKT, solutions: Solutions) -> Choice:
    """Choice by the cost of elimination."""
    graph = Graph.of(kkt.indptr, kkt.indices, kkt.incidences, kkt.held)
    n, m = graph.unknowns, graph.constraints
    degree, dissection = graph.cost(MINIMUM_DEGREE), graph.cost(DISSECTION)
    least = min(degree, dissection, key=lambda cost: cost.operations)
    why = f"{n} unknowns, {m} of them multipliers, fill {least.fill:.1e}, {solutions.value}"
    if graph.width <= _CHAIN:
        return _logged(Choice((Alone("lu", "klu"),)), kkt, why)
    kind = Method if least.operations > _FILLS else Alone
    general: tuple[Method, ...] = (kind("lu", "mumps"),)
    ordered = degree.operations < min(_COSTLY, _WORSE * dissection.operations)
    regular = m <= _JOINTED * n or least.operations < _LEAVES
    if solutions is Solutions.MANY and ordered and regular:
        general = kind("lu", "umfpack"), *general
    symmetric: tuple[Method, ...] = (kind("cholesky", "mumps"),)
    if len(general) > 1 and m:
        symmetric = ()  # solutions count, and MUMPS' take longer
    if m <= MOST and least.operations > _SCHUR:
        symmetric = BySchurComplement("cholesky", "cholmod"), *symmetric
    if m == 0:
        symmetric = kind("cholesky", "cholmod"), *symmetric
    seconds = _UNKNOWN * n + _OPERATION * least.operations
    return _logged(Choice((*symmetric, *general), seconds), kkt, why)


def _logged(choice: Choice, kkt: KKT, why: str) -> Choice:
    names = ", ".join(f"{each.package} ({each.kind})" for each in choice.methods)
    _log.info("matrix of %d rows by %s: %s", len(kkt.units), names, why)
    return choice


def _by_option(prefix: str) -> tuple[Method, ...]:
    """Package of PETSc's option ``-<prefix>pc_factor_mat_solver_type``, if it is set.

    Raises:
        ValueError: PETSc was built without it.
    """
    options = PETSc.Options(prefix)
    if not options.hasName(_PACKAGE):
        return ()
    package = options.getString(_PACKAGE)
    found = tuple(Method(kind, package) for kind in _KINDS.get(package, ("lu",)))
    try:
        probe = PETSc.PC().create(PETSc.COMM_SELF)
        probe.setType(found[0].kind)
        probe.setOperators(_one())
        probe.setFactorSolverType(package)
        probe.setFactorSetUpSolverType()
    except PETSc.Error as error:
        raise ValueError(
            f"-{prefix}{_PACKAGE}: this PETSc has no {found[0].kind} of {package!r}"
        ) from error
    return found


def _one() -> PETSc.Mat:
    """The matrix 1."""
    csr = np.array([0, 1], PETSc.IntType), np.zeros(1, PETSc.IntType), np.ones(1)
    return PETSc.Mat().createAIJ((1, 1), csr=csr, comm=PETSc.COMM_SELF)


def _on_domains(prefix: str) -> tuple[Method, ...]:
    """Subdomains, one per rank, if PETSc's option ``-<prefix>domains`` asks for them.

    Raises:
        ValueError: There is no such method, or only one rank.
    """
    options = PETSc.Options(prefix)
    if not options.hasName(_DOMAINS):
        return ()
    way = options.getString(_DOMAINS)
    if way not in WAYS:
        raise ValueError(f"-{prefix}domains: expected {' or '.join(WAYS)}, got {way!r}")
    if not several():
        raise ValueError(
            f"-{prefix}domains {way}: each rank has one subdomain; expected several ranks, "
            "got one: mpirun -n N"
        )
    return (Domains(way, way),)
