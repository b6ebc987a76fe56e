"""Stability of an equilibrium: free rigid motions, negative pivots, and the warning.

Rigid motions that nothing resists may be hidden by round-off in the factors. Nodes without
rotations represent a rigid rotation with round-off only, and so do the stiffness matrix and its
pivots: a singular matrix is factorised all the same, and gives displacements of round-off over
round-off. However, the rigid motions ``z`` of all parts that constraints allow are known, and
``zᵀ K z`` shows whether stress, loads, springs or contacts resist.
"""

from __future__ import annotations

import warnings
from enum import Enum, auto
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.direct import ConvergenceError, DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.pivots import inertia, negative_determinant
from fem_lie.linear.spectra.free_unknowns import free_unknowns
from fem_lie.linear.spectra.pencil import RigidParts

if TYPE_CHECKING:
    from fem_lie.results.equilibrium import StaticResult
    from fem_lie.system.equations import Equations

_MOTIONS = 4  # in which the tangent is tested for symmetry
_SYMMETRIC = 1e-6  # of the stiffness in these: round-off, and the skew part of residual forces
_SOFT = 1e-6  # compliance of constraints, over that of the stiffest spring

UNKNOWN = -1
"""Number of negative pivots where the matrix cannot be factorised, or rigid motions are free."""


def negative_pivots(equations: Equations, solver: DirectSolver) -> int:
    """Number of negative eigenvalues of the last factorised tangent stiffness.

    It is restricted to the constraints. Where it is not symmetric there: 1 if their number is odd,
    0 if it is even. It is −1 if the matrix cannot be factorised.
    """
    unknowns = equations.unknowns
    m, n = unknowns.constraints, 6 * unknowns.moving
    redundant = m > 0 and unknowns.may_be_redundant
    try:
        found = None if redundant else solver.negative_pivots()
        if found is None or not unknowns.has_potential:
            A = tangent(equations)
            conserves = unknowns.has_potential or _symmetric_along_constraints(equations, solver)
            if redundant:
                A = _softened(A, n)
            if not conserves:
                return int(negative_determinant(A, equations.shared) != bool(m % 2))
            found = inertia((0.5 * (A + A.T)).tocsr(), equations.shared)[0]
    except SingularMatrixError:
        return UNKNOWN
    return max(0, found - m)


def _symmetric_along_constraints(equations: Equations, solver: DirectSolver) -> bool:
    """Whether the last factorised tangent stiffness is symmetric for motions that are allowed.

    Loads without a potential in space may have one on the constraints: the moment about the axis of
    a hinge is such a load. The motions are those under random forces, which constraints allow.
    """
    unknowns = equations.unknowns
    weight, free = unknowns.units, np.flatnonzero(~unknowns.held.ravel())
    own = free_unknowns(equations.shared, free)
    given = np.random.default_rng(0).standard_normal((_MOTIONS, len(free)))
    found = []
    for force in own.of_owners(given):
        solver.right_hand_side[:] = 0.0
        solver.right_hand_side[free] = force / weight[free]
        solver.solve()
        found.append(solver.solution[free] / weight[free])
    motions: Array = np.array(found)
    for _ in range(2):  # the softest motion dominates all of them
        combination = np.linalg.pinv(own.triangle(own.owned(motions).T).T, rcond=_ROUND_OFF)
        motions = combination @ motions
    K = tangent(equations)[free][:, free]
    products = own.total(motions @ (K @ motions.T))
    return bool(np.abs(products - products.T).max() <= _SYMMETRIC * np.abs(products).max())


def tangent(equations: Equations) -> sp.csr_matrix:
    """The current matrix, reordered to physical dimensions of rows and columns."""
    units = sp.diags(equations.matrix.units)
    return (units @ tangent_csr(equations) @ units).tocsr()


def tangent_csr(equations: Equations) -> sp.csr_matrix:
    """A copy of the current matrix, in the unknowns' own units."""
    return equations.matrix.whole


def _softened(A: sp.csr_matrix, n: int) -> sp.csr_matrix:
    """The matrix with slightly compliant constraints after row ``n``, so that redundant ones count.

    These rows have the inertia of springs next to ``K``: as many negative pivots as rows.
    """
    stiffest = float(abs(A[:n, :n]).max()) or 1.0
    rows = A[n:, :n]
    give = _SOFT / stiffest * rows.multiply(rows).sum(axis=1).A1
    return sp.bmat([[A[:n, :n], A[:n, n:]], [rows, -sp.diags(give)]], format="csr")


class UnstableEquilibriumWarning(UserWarning):
    """An equilibrium is unstable, or was reached past a limit load: the structure snaps before."""


def warn_if_unstable(result: StaticResult) -> None:
    """Issue one warning for all states of a result.

    There is none for states in a rotating frame, in which an equilibrium with negative pivots may
    be stable, or for states that could not be tested.
    """
    if result.steady_rotation:
        return
    unstable = result.negative_pivots > 0
    sentences = []
    if unstable.any():
        factors = ", ".join(f"{factor:g}" for factor in result.factors[unstable][:4])
        more = ", …" if unstable.sum() > 4 else ""
        sentences.append(
            f"the equilibrium is unstable at load factor {factors}{more} (negative pivots "
            f"{', '.join(map(str, result.negative_pivots[unstable][:4]))}{more})"
        )
    if result.load_maxima:
        factors = ", ".join(f"{factor:.3g}" for factor in result.load_maxima)
        sentences.append(
            f"the load had a maximum near {factors} on the way, where the structure snaps"
        )
    if sentences:
        text = "; ".join(sentences)
        warnings.warn(
            f"{text}. fl.follow_path shows the whole path and its critical points",
            UnstableEquilibriumWarning,
            stacklevel=3,
        )


def maxima(factors: list[float]) -> tuple[float, ...]:
    """Load factors from which those of successive states decrease."""
    rise = np.diff([0.0, *factors]) > 0
    return tuple(factors[k] for k in np.flatnonzero(rise[:-1] & ~rise[1:]))


_ULPS = 1e-14  # over the sum of absolute values: less is round-off
POLISHED = 3
"""Further iterations of an equilibrium before its stiffness in rigid motions is tested."""

_BALANCED = 1e-9  # over norms of motion and forces: a smaller work is round-off

_ROUND_OFF = 1e-12  # forces over motions and the norm of the stiffness
_RESIDUAL = 10.0  # times the work of unbalanced forces: less is due to unfinished iteration


HELD = (
    "Is every body held by clamps or joints, with no motion left free? Contacts hold nothing as "
    "long as they are open"
)
"""Advice where a tangent stiffness is singular."""


class FreeRigidMotions(Enum):
    """What becomes of an equilibrium in which nothing resists a rigid motion.

    Attributes:
        REFUSED: It is one of many, which is an error.
        ALLOWED: It is kept: small vibrations about it have rigid motions.
    """

    REFUSED = auto()
    ALLOWED = auto()


class SingularStartError(ConvergenceError):
    """A step began with a singular matrix, or a motion is free: no other loading method helps."""


class FreeStartError(ConvergenceError):
    """No equilibrium was found, and rigid motions are free in the first state.

    Another loading method may still find one to which the structure moves, such as a pendulum.
    """


def _kernel(A: sp.csr_matrix, Z: Array) -> Array:
    """Combinations of the rows ``Z`` that ``A`` maps to round-off, as rows."""
    forces = A @ Z.T
    if not np.isfinite(forces).all():
        return Z[:0]
    _, _, V = np.linalg.svd(forces, full_matrices=False)
    rows = V @ Z
    sizes = np.abs(A @ rows.T).max(axis=0) / np.abs(rows).max(axis=1)
    return np.asarray(rows[sizes <= _ROUND_OFF * abs(A).max()])


class FreeMotions:
    """Search for rigid motions that nothing resists."""

    def __init__(self, equations: Equations) -> None:
        """Set up for the equations of a scene."""
        self._equations, unknowns = equations, equations.unknowns
        self._weight = unknowns.units
        self._free = np.flatnonzero(~unknowns.held.ravel())
        self._unknowns = free_unknowns(equations.shared, self._free)

    def allowed(self, H: Array) -> Array:
        """Basis (z, free unknowns) of rigid motions that constraints allow at frames ``H``."""
        constraints = self._equations.constraints(H)
        none = sp.csr_matrix((len(self._free),) * 2)
        basis, unknowns = constraints.rigid_motions(self._weight).basis, self._unknowns
        B = (constraints.jacobian @ sp.diags(self._weight)).tocsr()[:, self._free]
        return RigidParts(none, none, none, basis, unknowns).mechanisms(B)

    def _stiffness(self) -> sp.csr_matrix:
        """The last assembled tangent stiffness of the free unknowns in their units."""
        free, W = self._free, sp.diags(self._weight[self._free])
        return (W @ tangent_csr(self._equations)[free][:, free] @ W).tocsr()

    def unresisted(self, Z: Array, r: Array) -> Array:
        """The motions of ``Z`` that the last assembled tangent stiffness does not resist.

        Args:
            Z: See :meth:`allowed`.
            r: Residual of the same state.
        """
        free, weight, K = self._free, self._weight[self._free], self._stiffness()
        product = self._unknowns.total(Z @ (K @ Z.T))
        stiffness, vectors = np.linalg.eigh(0.5 * (product + product.T))
        motions = vectors.T @ Z
        sizes = np.abs(motions)
        small = _ULPS * (sizes * (abs(K) @ sizes.T).T).sum(axis=1)
        small += _RESIDUAL * self._unknowns.owned(sizes) @ np.abs(weight * r[free])
        return np.asarray(motions[np.abs(stiffness) <= self._unknowns.total(small)])

    def symmetries(self, Z: Array) -> Array:
        """The motions of ``Z`` that change no energy, wherever the scene is, balanced or not.

        Those of the scene in space leave all forces in the nodes' frames as they are: ``K z = 0``.
        Those of a body in its own frame, such as the spin of a bar about the line between its
        hinges, have a zero force in all states: ``zᵀ K = 0``. None are sought on several ranks.

        Args:
            Z: See :meth:`allowed`.
        """
        if self._equations.shared.several:
            return Z[:0]
        K = self._stiffness()
        return max(_kernel(K, Z), _kernel(K.T, Z), key=len)

    def balanced(self, Z: Array, r: Array) -> bool:
        """Whether forces with residual ``r`` do no work along the motions of ``Z``."""
        own, f = self._unknowns.owned(Z), self._weight[self._free] * r[self._free]
        works = self._unknowns.total(own @ f)
        sizes = np.sqrt(self._unknowns.total((own**2).sum(axis=1)) * self._unknowns.total(f @ f))
        return bool((np.abs(works) <= _BALANCED * sizes).all())

    def message(self, motions: Array, factor: float) -> str:
        """Message on motions that are free in the equilibrium at a load factor."""
        return f"the equilibrium at load factor {factor:g} is one of many: {self.freedom(motions)}"

    def freedom(self, motions: Array) -> str:
        """A sentence on how many motions of which bodies are free."""
        unknowns, count = self._equations.unknowns, len(motions)
        moves = np.zeros(6 * unknowns.moving)
        moves[self._free] = np.abs(motions).max(axis=0)
        nodes = unknowns.masters[moves.reshape(-1, 6).max(axis=1) > 1e-6 * moves.max()]
        bodies = unknowns.bodies.items()
        names = ", ".join(body.label for body, own in bodies if np.isin(own, nodes).any())
        return (
            f"nothing resists {count} rigid motion{'s' * (count > 1)} of {names}"
            f"{self._largest(motions[0])}. {HELD}"
        )

    def _largest(self, motion: Array) -> str:
        """Part of a sentence on the node that moves most, on ranks that have the whole scene."""
        unknowns = self._equations.unknowns
        if self._equations.shared.several:
            return ""
        moves = np.zeros(6 * unknowns.moving)
        moves[self._free] = motion
        steps = np.linalg.norm(moves.reshape(-1, 6)[:, :3], axis=1)
        rotates = not steps.max() > _ULPS * np.abs(moves).max()
        if rotates:
            steps = np.linalg.norm(moves.reshape(-1, 6)[:, 3:], axis=1)
        node = unknowns.masters[int(steps.argmax())]
        body, own = next((body, own) for body, own in unknowns.bodies.items() if node in own)
        (number,) = np.flatnonzero(own == node)
        at = ", ".join(f"{x:.4g}" for x in body.frames[number, 0])
        what = "rotation" if rotates else "displacement"
        return f", with the largest {what} at '{body.name}.node {number}', at ({at}) before loading"
