"""Linear buckling: the load factors at which a structure that hardly deforms before is unstable.

The stress of linear theory under the full loads, carried in the unloaded configuration, makes the
tangent ``K₀ + K_g``; at the load factor λ it is ``K₀ + λ K_g``, and singular at the factors that
are sought. No geometric stiffness is derived for it: the tangent with a carried stress is what
every iteration of statics uses.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie._arrays import Array, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.slepc import padded, solve_factorised, to_petsc
from fem_lie.results.mode_shapes import BucklingModes
from fem_lie.scene import Scene
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.statics.follow import check_proportion
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system.equations import Equations

_TOLERANCE = 1e-10
_TRUE = 1e-4  # relative difference of an eigenvalue from the quotient of its vector
_LINEAR, _NONE = 1e-6, 1e-300  # a tangent is in proportion to its stress; none has changed
_TRIES = 4  # each asks for twice as many: load factors of the other sign come with them


def buckling(
    scene: Scene, count: int = 4, *, petsc_options_prefix: str = "fem_lie_buckling_"
) -> BucklingModes:
    """Lowest positive load factors of linear buckling, and their modes.

    Args:
        scene: What there is, with its loads at factor 1.
        count: Number of modes.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Bad scene, no load, loads that are not in proportion to the load factor, a
            structure that is not held, elements that carry no stress, or more modes than degrees of
            freedom.
        ConvergenceError: There are less positive load factors than were asked for; its ``result``
            holds those that were found, if any.
    """
    check_proportion(scene)
    whole(count, "count")
    model = StableEquilibrium(scene, petsc_options_prefix)
    unknowns = model.equations.unknowns
    _check_stress(model.equations)
    free = int((~unknowns.held).sum()) - unknowns.m
    if not 1 <= count <= free:
        raise ValueError(f"count must be 1 … {free}, the degrees of freedom, got {count}")
    watch = Stopwatch()
    model.check_start(0.0)
    K, B, G = _matrices(model)
    factors, vectors = _positive(K, B, G, count, petsc_options_prefix)
    shapes = np.array([model.increments(vector) for vector in vectors])
    equations = model.equations
    shapes, turns_only = model.all_nodes(shapes.reshape(-1, unknowns.moving, 6))
    modes = BucklingModes(
        factors=factors,
        shapes=shapes,
        turns_only=turns_only,
        frames=equations.report(equations.start.unloaded).frames.copy(),
        size=model.diameter,
        info=equations.info,
        seconds=watch.seconds,
    )
    if len(factors) < count:
        raise ConvergenceError(
            f"SLEPc found {len(factors)} of {count} positive load factors; the loads may pull",
            modes if len(factors) else None,
        )
    return modes


def _check_stress(equations: Equations) -> None:
    """Raise ``ValueError`` if elements carry none: their stiffness would not know of it."""
    for where, assembly in equations.tables.assemblies:
        if not assembly.carried.size:
            bodies = equations.unknowns.bodies.items()
            labels = [b.label for b, nodes in bodies if where.start <= nodes[0] < where.stop]
            raise ValueError(
                f"the elements of {', '.join(labels)} carry no stress, of which linear buckling is "
                "made: write their energy as a StrainEnergy, not as a plain form, or follow the "
                "path by fl.follow_path"
            )


def _matrices(model: StableEquilibrium) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix]:
    """``K₀``, the constraints and ``K_g`` of the free unknowns, in their units."""
    _, load = model.forces()
    model.factorise(0.0)
    K, B = model.pencil()
    dx = model.solve_finely(load)

    def geometric(times: float) -> sp.csr_matrix:
        G = (model.stressed(dx, times) - K) / times
        return (0.5 * (G + G.T)).tocsr()

    G = geometric(1.0)
    # in the difference of two tangents that are nearly the same, digits are lost
    finer = geometric(2.0 ** np.floor(np.log2(abs(K).max() / max(abs(G).max(), _NONE))))
    if abs(finer - G).max() <= _LINEAR * abs(G).max():
        G = finer
    return (0.5 * (K + K.T)).tocsr(), B, G


def _positive(
    K: sp.csr_matrix, B: sp.csr_matrix, G: sp.csr_matrix, count: int, prefix: str
) -> tuple[Array, Array]:
    """Lowest positive λ with ``(K + λ G) φ + Bᵀ μ = 0``, ``B φ = 0``, and φ, (k, n)."""
    n = K.shape[0]
    wanted, most = 2 * count + 4, n - B.shape[0]
    inverse, vectors = _largest(K, B, G, min(wanted, most), prefix)
    for _ in range(_TRIES):
        if len(inverse) >= count or wanted >= most:
            break
        wanted *= 2
        inverse, vectors = _largest(K, B, G, min(wanted, most), prefix)
    order = np.argsort(-inverse)[:count]
    return np.asarray(1.0 / inverse[order]), vectors[order]


def _largest(
    K: sp.csr_matrix, B: sp.csr_matrix, G: sp.csr_matrix, wanted: int, prefix: str
) -> tuple[Array, Array]:
    """Largest positive ``1/λ`` of ``−G φ = (1/λ) K φ``, among the largest of either sign."""
    n, solver = K.shape[0], SLEPc.EPS().create(PETSc.COMM_SELF)
    size = float(np.mean(np.abs(K.diagonal())))
    bordered = sp.bmat([[K, size * B.T], [size * B, None]], format="csr") if B.shape[0] else K
    solver.setOperators(to_petsc(padded(-G, B)), to_petsc(bordered))
    types = SLEPc.EPS.ProblemType
    solver.setProblemType(types.GNHEP if B.shape[0] else types.GHEP)
    solver.setOptionsPrefix(prefix)
    solver.setWhichEigenpairs(
        SLEPc.EPS.Which.LARGEST_MAGNITUDE if B.shape[0] else SLEPc.EPS.Which.LARGEST_REAL
    )
    solver.setDimensions(wanted)
    solver.setTolerances(_TOLERANCE, 500)
    solve_factorised(solver, prefix)
    values, vectors = _pairs(solver, n, bordered.shape[0])
    # constraints bring zeros that are defective, of which round-off makes numbers of either sign
    energy = np.einsum("kn,kn->k", vectors, vectors @ K)
    by_loads = -np.einsum("kn,kn->k", vectors, vectors @ G)
    true = np.abs(by_loads - values * energy) <= _TRUE * values * energy
    return values[true], vectors[true]


def _pairs(solver: Any, n: int, size: int) -> tuple[Array, Array]:
    """Converged pairs with a positive eigenvalue."""
    real, imaginary = (PETSc.Vec().createSeq(size) for _ in range(2))
    values, vectors = [], []
    for k in range(solver.getConverged()):
        values.append(solver.getEigenpair(k, real, imaginary).real)
        vectors.append(real.array[:n].copy())
    given = np.array(values)
    kept = given > 1e-10 * np.abs(given).max(initial=0.0)
    return given[kept], np.array(vectors).reshape(-1, n)[kept]
