"""Elimination of the interior of subdomains, and BDDC or FETI-DP for their interface.

Each rank eliminates the interior of its subdomain. What remains is a dense matrix ``S = K_ΓΓ − K_ΓI
K_II⁻¹ K_IΓ`` on its interface, which includes its joints. The sum over subdomains is never
assembled: PETSc's ``MATIS`` has the parts, and ``PCBDDC`` makes a preconditioner of their symmetric
parts with deluxe scaling and adaptive primal unknowns (S. Zampini, SIAM J. Sci. Comput. 38 (2016)
S282). The iteration is with ``S`` itself, by conjugate gradients or, if it is not symmetric, GMRES.
"""

from __future__ import annotations

import logging
from typing import Any, NamedTuple, Protocol

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.domains.division import Part
from fem_lie.linear.domains.dual import Dual
from fem_lie.ranks.together import meet

SYMMETRIC = 1e-10
"""Largest asymmetry of a matrix that counts as symmetric, over its largest entry."""

FLOOR = 1e-6
"""Least eigenvalue over the largest of a subdomain's matrix with unit diagonal, for the
preconditioner.

With less, round-off makes the inverse in BDDC indefinite: with 1e-7 a net of bars on two subdomains
fails. With more, soft modes are lifted as well. Without scaling to a unit diagonal the bending
stiffness of bars and shells lies so far below the axial stiffness that no value suffices: with 1e-9
of the largest a static shell took 13.6, 27.5, 98 and 18.5 iterations in the same run, and with 1e-7
the net 30.
"""

SOFTEST = 1e-5
"""Least diagonal that is scaled to one, over the largest, unless PETSc's option
``interface_softest`` is set. With a threshold of 3 the antenna on 16 ranks took 14.2 iterations
with this and 35.2 with 1e-4.
"""

TOLERANCE = 1e-8
"""Relative tolerance of an iteration in the preconditioned residual."""

MOST = 300
"""Largest number of iterations of a solution."""

_log = logging.getLogger(__name__)


class Values(Protocol):
    """Scaling of the matrix, see :class:`~fem_lie.linear.equilibrated.Equilibrated`."""

    @property
    def csr(self) -> tuple[Array, Any, Any]:
        """Values, columns, row pointers."""

    @property
    def left(self) -> Array:
        """Factors by which rows are multiplied."""

    @property
    def right(self) -> Array:
        """Factors by which columns are multiplied."""


class Way(NamedTuple):
    """Method for an interface.

    Attributes:
        name: Name in messages.
        dual: Whether it iterates on multipliers, see :class:`~fem_lie.linear.domains.dual.Dual`.
        options: Default options of PETSc.
    """

    name: str
    dual: bool
    options: dict[str, object]


THRESHOLD = 1.2
"""Eigenvalues above this have primal unknowns, unless PETSc's option
``interface_pc_bddc_adaptive_threshold`` is set. From 4 to 16 subdomains of constant size iterations
grew by up to 36 % with this, and by up to 100 % with 3; set-up and solutions took as long.
"""

ADAPTIVE: dict[str, object] = {
    "pc_bddc_use_deluxe_scaling": True,
    "pc_bddc_adaptive_threshold": THRESHOLD,
}

OF_MULTIPLIERS = {**ADAPTIVE, "pc_bddc_deluxe_singlemat": True}

WAYS = {
    "bddc": Way("BDDC", False, ADAPTIVE),
    "fetidp": Way(
        "FETI-DP",
        True,
        {"fetidp_ksp_type": "cg"} | {f"fetidp_bddc_{n}": v for n, v in OF_MULTIPLIERS.items()},
    ),
}
"""Methods by their name in the option ``domains``."""


class Interface:
    """Exact preconditioner of PETSc on all ranks together."""

    def __init__(self, part: Part, own: Values, prefix: str, way: str) -> None:
        """Find the sources of entries.

        Args:
            part: Part of this rank.
            own: The equilibrated matrix.
            prefix: Prefix of PETSc's options; those of the iteration have ``interface_`` after it.
            way: One of :data:`WAYS`.

        Raises:
            ValueError: The option ``softest`` is not in (0, 1].
        """
        self._part, self._own, self._way = part, own, WAYS[way]
        self._prefix = f"{prefix}interface_"
        self._softest = PETSc.Options(self._prefix).getReal("softest", SOFTEST)
        if not 0.0 < self._softest <= 1.0:
            raise ValueError(f"{self._prefix}softest must be in (0, 1], got {self._softest}")
        self.ksp: PETSc.KSP | None = None
        self._dual: Dual | None = None
        numbers = PETSc.LGMap().create(part.at.astype(np.int32), comm=PETSc.COMM_WORLD)
        self._numbers = numbers

    # --- matrices ---

    def setUp(self, pc: PETSc.PC) -> None:
        """Eliminate the interior, and build the preconditioner of the interface.

        Raises:
            MemoryError: There is not enough memory for the factors of a subdomain; on all ranks.
            PETSc.Error: The interface is singular.
        """
        meet("subdomains")
        S = self._eliminated()
        symmetric, world = 0.5 * (S + S.T), MPI.COMM_WORLD
        both = np.array([np.abs(S - symmetric).max(initial=0.0), np.abs(S).max(initial=0.0)])
        world.Allreduce(MPI.IN_PLACE, both, op=MPI.MAX)
        of_motion = both[0] > SYMMETRIC * both[1]
        self._drop()
        self._P = self._summed(_positive(symmetric, self._softest), symmetric=True)
        self._P.setNearNullSpace(self._rigid_motions())
        self._A = self._summed(S if of_motion else symmetric, symmetric=not of_motion)
        self._b, self._x = self._A.createVecs()
        self.ksp = self._solver(symmetric=not of_motion)
        self.ksp.setUp()
        self._part.made += 1
        summary = self._way.name, world.size, self._part.size
        _log.info("%s on %d subdomains, %d unknowns on interfaces", *summary)

    def _drop(self) -> None:
        """Free the objects of the previous matrix, on all ranks together."""
        if self.ksp is not None:
            self.ksp.destroy()
            self._A.destroy()
            self._P.destroy()
            PETSc.garbage_cleanup(PETSc.COMM_WORLD)

    def _eliminated(self) -> Array:
        """Dense matrix of the subdomain's interface."""
        part, (_, columns, pointers) = self._part, self._own.csr
        n = len(self._own.left)
        K = sp.csr_matrix((part.values, columns, pointers), shape=(n, n))
        own = np.concatenate([part.inside, part.interface])
        K = sp.diags(self._own.left[own]) @ K[own][:, own] @ sp.diags(self._own.right[own])
        count = len(part.inside)
        inside, self._to = K[:count][:, :count], K[:count][:, count:].tocsr()
        self._fro = K[count:][:, :count].tocsr()
        direct = _factorised(inside.tocsr())
        if MPI.COMM_WORLD.allreduce(direct is None, op=MPI.LOR) or direct is None:
            raise MemoryError("not enough memory to factorise the interior of a subdomain")
        self._direct = direct
        self._y, self._z = self._direct.getOperators()[0].createVecs()
        S: Array = K[count:][:, count:].toarray()
        for k in range(S.shape[1]):
            S[:, k] -= self._fro @ self._within(self._to[:, k].toarray().ravel())
        return S

    def _within(self, b: Array) -> Array:
        """``K_II⁻¹ b``."""
        if not len(b):
            return b
        self._y.array[:] = b
        self._direct.solve(self._y, self._z)
        return np.asarray(self._z.array).copy()

    def _summed(self, S: Array, *, symmetric: bool) -> PETSc.Mat:
        """Sum over subdomains, as parts."""
        count = S.shape[0]
        pointers = np.arange(count + 1, dtype=PETSc.IntType) * count
        columns = np.tile(np.arange(count, dtype=PETSc.IntType), count)
        local = PETSc.Mat().createAIJ(
            (count, count), csr=(pointers, columns, S.ravel()), comm=PETSc.COMM_SELF
        )
        world, size = MPI.COMM_WORLD, self._part.size
        rows = (world.rank + 1) * size // world.size - world.rank * size // world.size
        A = PETSc.Mat().create(PETSc.COMM_WORLD)
        A.setSizes(((rows, size),) * 2)
        A.setType("is")
        A.setLGMap(self._numbers, self._numbers)
        A.setISLocalMat(local)
        A.assemble()
        if symmetric:
            A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
            A.setOption(PETSc.Mat.Option.SPD, True)
        return A

    def _rigid_motions(self) -> PETSc.NullSpace:
        """Rigid motions of the interface in the scaled unknowns, orthonormal."""
        scaled = np.array(self._part.motions) / self._own.right[self._part.interfaces]
        first, end = self._P.getOwnershipRange()
        vectors = []
        for motion in np.linalg.qr(scaled.T)[0].T:
            vectors.append(self._P.createVecRight())
            vectors[-1].array[:] = motion[first:end]
        return PETSc.NullSpace().create(vectors=vectors, comm=PETSc.COMM_WORLD)

    def _solver(self, *, symmetric: bool) -> PETSc.KSP:
        """Iterative solver with its options."""
        ksp, prefix = PETSc.KSP().create(PETSc.COMM_WORLD), self._prefix
        _default(prefix, self._way.options)
        ksp.setOperators(self._A, self._P)
        self._dual = Dual(self._P, prefix, MOST) if self._way.dual else None
        if self._dual is None:
            ksp.setType("cg" if symmetric else "gmres")
            ksp.getPC().setType("bddc")
        else:  # the preconditioner of these iterations is another iteration
            ksp.setType("fcg" if symmetric else "fgmres")
            ksp.getPC().setType("python")
            ksp.getPC().setPythonContext(self._dual)
            prefix += "around_"
        ksp.setOptionsPrefix(prefix)
        if not symmetric:
            ksp.setGMRESRestart(MOST)
        ksp.setTolerances(rtol=TOLERANCE, max_it=MOST)
        ksp.setFromOptions()
        return ksp

    # --- solutions ---

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve, with the same vectors on all ranks."""
        assert self.ksp is not None
        part, given, world = self._part, b.array_r, MPI.COMM_WORLD
        own = self._within(given[part.inside])
        left = np.zeros(part.size)
        left[part.at] = self._fro @ own
        world.Allreduce(MPI.IN_PLACE, left)
        first, end = self._b.getOwnershipRange()
        self._b.array[:] = (given[part.interfaces] - left)[first:end]
        self.ksp.solve(self._b, self._x)
        self._count()
        found = np.zeros(part.size)
        counts = world.allgather(end - first)
        world.Allgatherv(np.asarray(self._x.array), (found, counts))
        whole = np.zeros(len(given))
        whole[part.inside] = own - self._within(self._to @ found[part.at])
        world.Allreduce(MPI.IN_PLACE, whole)
        whole[part.interfaces] = found
        whole[part.held] = given[part.held]
        x.array[:] = whole

    def _count(self) -> None:
        assert self.ksp is not None
        took, reason = self.ksp.getIterationNumber(), self.ksp.getConvergedReason()
        if self._dual is not None:
            took = self._dual.taken()
        self._part.iterations += took
        self._part.solutions += 1
        _log.debug("%s on %d subdomains: %d iterations", self._way.name, MPI.COMM_WORLD.size, took)
        if reason <= 0:  # the solver checks the residual of the result
            _log.info("%s has not converged: %d iterations", self._way.name, took)


def _positive(S: Array, softest: float) -> Array:
    """Matrix with eigenvalues of at least :data:`FLOOR`: a floating subdomain has zeros."""
    diagonal = np.abs(S.diagonal())
    scale = np.sqrt(np.maximum(diagonal, softest * diagonal.max(initial=np.finfo(float).tiny)))
    scales = np.outer(scale, scale)
    values, vectors = np.linalg.eigh(S / scales)
    least = FLOOR * np.abs(values).max(initial=0.0)
    return np.asarray((vectors * np.maximum(values, least)) @ vectors.T) * scales


def _factorised(inside: sp.csr_matrix) -> PETSc.KSP | None:
    """Factors of the interior of a subdomain with its joints; ``None`` for lack of memory.

    UMFPACK factorises singular matrices as well: a solution then has a residual.
    """
    pattern = inside.indptr.astype(PETSc.IntType), inside.indices.astype(PETSc.IntType)
    matrix = PETSc.Mat().createAIJ(inside.shape, csr=(*pattern, inside.data), comm=PETSc.COMM_SELF)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(matrix)
    ksp.setType(PETSc.KSP.Type.PREONLY)
    ksp.getPC().setType(PETSc.PC.Type.LU)
    ksp.getPC().setFactorSolverType("umfpack")
    try:
        ksp.setUp()
    except PETSc.Error:
        return None
    return ksp


def _default(prefix: str, options: dict[str, object]) -> None:
    given = PETSc.Options(prefix)
    for name, value in options.items():
        if name not in given:
            given[name] = value
