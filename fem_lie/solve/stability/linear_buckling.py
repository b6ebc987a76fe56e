"""Linear buckling: load factors as eigenvalues of stiffness and geometric stiffness.

The structure is assumed to deform little before it buckles. The stress of linear theory under the
full loads, applied in the unloaded configuration, gives the tangent stiffness ``K₀ + K_g``; at the
load factor λ it is ``K₀ + λ K_g``, which is singular at the critical load factors. No separate
geometric stiffness is derived: the tangent with a given stress is the one of each iteration of
statics.

Cables that are shorter than their line, and springs with a rest value of their own, strain a scene
without any load. Its unloaded configuration is then the equilibrium under this prestress, which is
part of ``K₀`` and does not grow with the loads: guys compress their mast.

Geometric stiffness is the derivative of the tangent stiffness by the load factor, with the stress,
the Lagrange multipliers and the loads of linear theory, in the unloaded configuration. A difference
of two tangents loses the digits by which ``λ K_g`` is smaller than ``K₀``. The load factor ``s`` of
the difference therefore makes both about equally large, whatever the size of the loads.

Loads must have a potential among the motions that supports and joints allow, because linear
buckling compares energies: its load factors are those of the symmetric part ``G`` of the geometric
stiffness. Non-conservative loads, such as follower forces or moments about fixed axes, add a skew
part ``S``, and then a mode φ of ``(K + λ G) φ = 0`` is not one of the structure. It depends on how
the loads act: a follower force on a guided end, end moments on fork supports and pressure on a ring
in its plane do have a potential among the free motions. Where ``S φ = 0`` the load factor is
correct, and none is lower: real eigenvalues of ``−K⁻¹ (G + S)`` do not exceed the largest of
``−K⁻¹ G`` (I. Bendixson, Acta Mathematica 25 (1902) 359). Flutter at a lower load requires an ``S``
that is not small compared to ``G``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie._arrays import Array, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.pencil import padded, pairs_of, solve_factorised
from fem_lie.parts.part_scene import divided
from fem_lie.ranks.together import all_stay
from fem_lie.results.mode_shapes import BucklingModes
from fem_lie.scene import Scene
from fem_lie.solve.progress_bars import Stopwatch, step_bar
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.statics.follow import check_proportion
from fem_lie.system.equations import Equations

_ALIKE = 3.0  # powers of two by which change and stiffness may differ
_ROUND_OFF = 2.0**-40  # over the stiffness: a smaller change is zero
_SCALINGS, _SHRINKINGS = 5, 10
_PROPORTIONAL = 1e-9  # relative deviation of a change from a straight line
_CONVERGED = 1e-5


class GeometricStiffness(NamedTuple):
    """Geometric stiffness ``s K_g`` of the free unknowns in their units.

    Attributes:
        symmetric: Symmetric part, shape (n, n).
        skew: Skew part, due to non-conservative loads, shape (n, n).
        factor: ``s``, a power of two.
    """

    symmetric: sp.csr_matrix
    skew: sp.csr_matrix
    factor: float

    @classmethod
    def of(cls, G: sp.csr_matrix, factor: float) -> GeometricStiffness:
        """Split the matrix ``s K_g``."""
        return cls((0.5 * (G + G.T)).tocsr(), (0.5 * (G - G.T)).tocsr(), factor)


def geometric_stiffness(
    model: StableEquilibrium, K: sp.csr_matrix, dx: Array
) -> GeometricStiffness:
    """Geometric stiffness of the loads of a scene.

    Args:
        model: The scene in its unloaded configuration.
        K: Its tangent stiffness there, shape (n, n).
        dx: Displacements and multipliers of linear theory at load factor 1.

    Raises:
        ValueError: The tangent stiffness has no derivative by the load factor.
    """
    state = model.linear_state(dx)

    def change(factor: float) -> sp.csr_matrix:
        return (model.stressed(state, factor) - K).tocsr()

    size = model.largest_entry
    factor, D = _alike(change, size, size(K), model.largest(dx))
    if not size(D):
        return GeometricStiffness.of(D, factor)
    E = change(-0.5 * factor)
    if size(D + 2.0 * E) <= _PROPORTIONAL * size(D):
        return GeometricStiffness.of(D, factor)
    return _extrapolated(change, size, (D, E), factor)


Change: TypeAlias = Callable[[float], sp.csr_matrix]
Size: TypeAlias = Callable[[sp.csr_matrix], float]


def _alike(
    change: Change, size: Size, stiffness: float, displacement: float
) -> tuple[float, sp.csr_matrix]:
    """A load factor at which the change is about as large as the stiffness, and the change.

    The change is zero if there is none at any load factor. The first load factor makes the
    displacements of linear theory as large as the model, or its rotations about one radian; if
    nothing moves, any will do.
    """
    factor = 2.0 ** -np.round(np.log2(displacement)) if displacement else 1.0
    D = change(factor)
    for _ in range(_SCALINGS):
        power = np.log2(max(size(D) / stiffness, _ROUND_OFF))
        if abs(power) <= _ALIKE:
            return float(factor), D
        factor *= 2.0 ** -np.round(power)
        D = change(factor)
    return float(factor), sp.csr_matrix(D.shape)


def _extrapolated(
    change: Change, size: Size, first_two: tuple[sp.csr_matrix, sp.csr_matrix], factor: float
) -> GeometricStiffness:
    """Derivative from changes at ``s`` and ``−s/2`` for decreasing s, with an error of third order.

    User-defined elements may have internal unknowns on which the tangent stiffness depends in any
    way.
    """
    D, E = first_two
    first, least, best = factor, np.inf, D
    before = sp.csr_matrix(D.shape)
    for _ in range(_SHRINKINGS):
        found = ((first / factor) * (D - 4.0 * E) / 3.0).tocsr()
        error = size(found - before) / size(found)
        if error > least and least <= _CONVERGED:
            break  # round-off starts to grow
        if error < least:
            least, best = error, found
        before, factor = found, factor / 16.0
        D, E = change(factor), change(-0.5 * factor)
    if least <= _CONVERGED:
        return GeometricStiffness.of(best, first)
    raise ValueError(
        "the tangent stiffness has no derivative in the load factor, which linear buckling expects "
        "of every element: follow the path by fl.follow_path"
    )


_TOLERANCE = 1e-10
_TRUE = 1e-4  # relative difference of an eigenvalue from the Rayleigh quotient of its vector
_TRIES = 4  # each requests twice as many eigenvalues, among which are spurious ones


def lowest_positive(
    model: StableEquilibrium,
    K: sp.csr_matrix,
    B: sp.csr_matrix,
    G: sp.csr_matrix,
    count: int,
    prefix: str,
) -> tuple[Array, Array]:
    """Lowest positive λ with ``(K + λ G) φ + Bᵀ μ = 0``, ``B φ = 0``, and φ, (k, n).

    There may be fewer than ``count``.
    """
    if not model.largest_entry(G):
        return np.empty(0), np.empty((0, K.shape[0]))
    problem = _Inverse(model, K, B, G, prefix)
    wanted, most = 2 * count + 4, model.equations.unknowns.degrees_of_freedom
    inverse, vectors = problem.largest(min(wanted, most))
    for _ in range(_TRIES):
        if len(inverse) >= count or wanted >= most:
            break
        wanted *= 2
        inverse, vectors = problem.largest(min(wanted, most))
    order = np.argsort(-inverse)[:count]
    return np.asarray(1.0 / inverse[order]), vectors[order]


class _Inverse:
    """The problem ``−G φ = (1/λ) K φ`` with constraints."""

    def __init__(
        self,
        model: StableEquilibrium,
        K: sp.csr_matrix,
        B: sp.csr_matrix,
        G: sp.csr_matrix,
        prefix: str,
    ) -> None:
        """Put the matrices of all ranks together."""
        self._K, self._G, self._prefix, self._unknowns = K, G, prefix, model.free_unknowns
        size = self._unknowns.mean(np.abs(self._unknowns.assembled(K.diagonal()[np.newaxis])[0]))
        rows = size * B
        bordered = sp.bmat([[K, rows.T], [rows, None]], format="csr") if B.shape[0] else K
        self._constrained = model.equations.shared.any(B.shape[0] > 0)
        self._matrices = [self._unknowns.matrix(A, K.shape[0]) for A in (padded(-G, B), bordered)]

    def largest(self, wanted: int) -> tuple[Array, Array]:
        """Largest positive ``1/λ``, and vectors as rows."""
        left, right = self._matrices
        solver = SLEPc.EPS().create(right.matrix.comm)
        solver.setOperators(left.matrix, right.matrix)
        types = SLEPc.EPS.ProblemType
        solver.setProblemType(types.GNHEP if self._constrained else types.GHEP)
        solver.setOptionsPrefix(self._prefix)
        # the largest moduli would all belong to members in tension, if there are many of them
        solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
        solver.setDimensions(wanted)
        solver.setTolerances(_TOLERANCE, 500)
        solve_factorised(solver, self._prefix, self._unknowns)
        found, pairs = pairs_of(solver, right, self._unknowns)
        positive = found.real > 1e-10 * np.abs(found.real).max(initial=0.0)
        values, vectors = found[positive].real, np.ascontiguousarray(pairs[positive].real)
        # constraints add defective zero eigenvalues, which round-off makes positive or negative
        products = [np.einsum("kn,kn->k", vectors, (A @ vectors.T).T) for A in (self._K, self._G)]
        energy, load = self._unknowns.total(np.array(products))
        true = np.abs(-load - values * energy) <= _TRUE * values * energy
        return np.asarray(values[true]), vectors[true]


_OF_MODES, _OF_ALL = 1e-6, 1e-2  # significant ratio of skew part to load stiffness
_TINY = 1e-300
_SEED, _REPEATS, _SETTLED = 1, 12, 1e-3


def check_potential(
    model: StableEquilibrium, K: sp.csr_matrix, G: GeometricStiffness, found: tuple[Array, Array]
) -> None:
    """Raise ``ValueError`` if the skew part of the geometric stiffness is significant.

    Args:
        model: The scene, whose tangent stiffness in the unloaded configuration is factorised.
        K: That stiffness of the free unknowns in their units, shape (n, n).
        G: The geometric stiffness.
        found: Load factors of its symmetric part, shape (k,), the lowest first, and their modes,
            shape (k, n).
    """
    factors, modes = found
    parts = [factors[k] * _response(model, K, G.skew, modes[k])[0] for k in range(len(factors))]
    least = factors[0] if len(factors) else 1.0 / max(energy_radius(model, K, G.symmetric), _TINY)
    of_all = float(least * energy_radius(model, K, G.skew))
    if of_all > _OF_ALL or max(parts, default=0.0) > _OF_MODES:
        raise ValueError(
            "linear buckling expects loads that have a potential among the free motions, got an "
            f"unsymmetric load stiffness, {max(of_all, *parts):.1e} of the symmetric one (follower "
            "forces, or moments about fixed axes): its load factors would be wrong. Follow "
            "the path by fl.follow_path, which finds divergence by the determinant, or find "
            "the load of flutter or divergence by fl.stability.flutter"
        )


def _response(
    model: StableEquilibrium, K: sp.csr_matrix, A: sp.csr_matrix, x: Array
) -> tuple[float, Array]:
    """``‖y‖`` for x of length one, with ``y = K⁻¹ A x`` and ``‖y‖² = yᵀ K y``; and y."""
    y = model.solve_free(model.free_unknowns.assembled((A @ x)[np.newaxis])[0])
    squares = [max(float(model.free_unknowns.total(z @ (K @ z))), 0.0) for z in (x, y)]
    return float(np.sqrt(squares[1] / squares[0])) if squares[0] else 0.0, y


def energy_radius(model: StableEquilibrium, K: sp.csr_matrix, A: sp.csr_matrix) -> float:
    """Largest ``|xᵀ A y|`` of free motions with ``xᵀ K x = yᵀ K y = 1``, ``A`` symmetric or skew.

    ``K⁻¹ A`` is normal in the inner product of ``K``, so that repeated products grow by the largest
    modulus of its eigenvalues: for a symmetric ``A`` this is one over the smallest load factor, of
    either sign.
    """
    if not model.largest_entry(A):
        return 0.0
    # a smooth start that satisfies constraints: motions of single nodes are not of interest
    start = np.random.default_rng(_SEED).standard_normal((1, K.shape[0]))
    x = model.solve_free(model.free_unknowns.of_owners(start)[0])
    value = 0.0
    for _ in range(_REPEATS):
        before, (value, x) = value, _response(model, K, A, x)
        if abs(value - before) <= _SETTLED * value:
            break
    return value


_MODES = 4  # by default
_STAGES = 5  # number of stages in the progress bar
_OTHER_SIGN = 100.0  # smallest ratio of spurious factors to those of reversed loads
_STRAINED = 0.05  # largest strain at the load factors for which linear theory is reliable


@all_stay("buckling")
def buckling(
    scene: Scene, count: int | None = None, *, petsc_options_prefix: str = "fem_lie_buckling_"
) -> BucklingModes:
    """Lowest positive load factors of linear buckling, and their modes.

    Args:
        scene: The scene, with its loads at factor 1.
        count: Number of modes; default: four, or all degrees of freedom if they are fewer.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Invalid scene, no load, loads that are not in proportion to the load factor, a
            structure without sufficient supports, elements without stress, loads without a
            potential among the motions that supports and joints allow, or more modes than degrees
            of freedom.
        ConvergenceError: There are fewer positive load factors than requested, and its ``result``
            holds them; or there is none, for example under tension.
    """
    check_proportion(scene)
    if count is not None:
        whole(count, "count")
    part = divided(scene, petsc_options_prefix)
    model = StableEquilibrium(scene, petsc_options_prefix, part)
    unknowns = model.equations.unknowns
    with model.equations.shared.errors(ValueError):
        _check_stress(model.equations)
    count = unknowns.mode_count(count, _MODES)
    watch = Stopwatch()
    model.check_start(0.0)
    with step_bar("buckling", "stage", _STAGES) as show:
        model.relax()
        _, load = model.forces()
        model.factorise(0.0)
        show("displacements")
        K, B = model.pencil()
        dx = model.solve_finely(load)
        show("geometric stiffness")
        G = geometric_stiffness(model, K, dx)
        K = (0.5 * (K + K.T)).tocsr()
        show("load factors and modes")
        given = K, B, G.symmetric
        factors, vectors = lowest_positive(model, *given, count, petsc_options_prefix)
        show("checks")
        check_potential(model, K, G, (factors, vectors))
        factors *= G.factor
        radius = energy_radius(model, K, G.symmetric) / G.factor
        show("")
    if not len(factors) or (
        factors[0] * radius > _OTHER_SIGN and factors[0] * model.largest_strain(dx) > _STRAINED
    ):
        raise ConvergenceError(_no_buckling(radius))
    shapes = np.array([model.increments(vector) for vector in vectors])
    shapes, rotation_only = model.all_nodes(shapes.reshape(-1, unknowns.moving, 6))
    modes = BucklingModes(
        factors=factors,
        shapes=shapes,
        rotation_only=rotation_only,
        frames=model.current_frames,
        size=model.diameter,
        info=model.whole.info,
        seconds=watch.seconds,
    )
    if len(factors) < count:
        raise ConvergenceError(
            f"SLEPc found {len(factors)} of {count} positive load factors: there may be no more; "
            "those of reversed loads do not count",
            modes,
        )
    return modes


def _check_stress(equations: Equations) -> None:
    """Raise ``ValueError`` if elements have no stress: their stiffness would not depend on it."""
    for where, assembly in equations.arrays.assemblies:
        if not assembly.stress_values.size:
            bodies = equations.unknowns.bodies.items()
            labels = [b.label for b, nodes in bodies if where.start <= nodes[0] < where.stop]
            raise ValueError(
                f"the elements of {', '.join(labels)} have no stress, which linear buckling is "
                "based on: write their energy as a StrainEnergy, not as a plain form, or follow "
                "the path by fl.follow_path"
            )


def _no_buckling(radius: float) -> str:
    """Message if the loads do not make the scene unstable.

    Args:
        radius: One over the smallest load factor, which is negative; 0 if there is none.
    """
    what = "these loads do not make the scene unstable at any positive load factor"
    if not radius:
        return f"{what}: they do not change its stiffness"
    return f"{what}: they are tensile; reversed loads do at {1.0 / radius:.3g} times their size"
