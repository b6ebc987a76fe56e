"""The eigenvalues of least absolute value of a constrained quadratic problem, by SLEPc.

``(s² M + s C + K) φ + Bᵀ μ = 0``, ``B φ = 0``. Bordered by ``B`` the problem has infinite
eigenvalues; shift-and-invert makes them zero, and Krylov methods do not see them. (V. Hernandez,
J. E. Roman & V. Vidal, ACM Trans. Math. Softw. 31 (2005) 351; C. Campos & J. E. Roman, SIAM J. Sci.
Comput. 38 (2016) S385.)
"""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
import scipy.sparse.linalg
from slepc4py import SLEPc

from fem_lie._arrays import Array
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.rigid_parts import RigidParts
from fem_lie.linear.slepc import Complex, padded, pairs_of, set_up, to_petsc

_SHIFT = (
    1e-10  # over the largest ratio of stiffness to mass: rigid motion must not make it singular
)
_ROUND_OFF = 1e-12  # squares below this part of that ratio, and of what cancels in them, are zero
_SLOW = 1e-8  # squares below this part of that ratio are computed anew
_BESIDE = 1e-4  # of a vector that is rigid motion but for errors
_FOLLOWS = 1e-14  # squared
_SPLIT = 1e-7  # of the unit of s: round-off parts a double zero by its root
_SYMMETRIC = 1e-9
_FAR = 10.0  # how much larger than the unit of s they may be
_SPARE = 8  # pairs more than wanted: the nearest to the shift are not quite the smallest


@dataclass(frozen=True, eq=False)
class Pencil:
    """Matrices of the free unknowns, all in the unit of energy (times powers of time).

    Attributes:
        M: Mass, shape (n, n).
        C: Damping and gyroscopic coupling, or ``None``.
        K: Stiffness.
        B: Constraints, shape (m, n).
        parts: What of the stiffness is not felt by rigid motion, if that is known.
    """

    M: sp.csr_matrix
    C: sp.csr_matrix | None
    K: sp.csr_matrix
    B: sp.csr_matrix
    parts: RigidParts | None = None

    def smallest(self, count: int, floor: float, prefix: str) -> tuple[Complex, Complex, Array]:
        """Eigenvalues with ``Im s ≥ 0``, vectors (count, n) and relative residuals.

        Args:
            count: How many.
            floor: A rate that matters, such as that of a rotation; 0 if there is none.
            prefix: Of SLEPc's options.

        Raises:
            ConvergenceError: SLEPc found less.
        """
        fast = self._fastest()
        if self.C is None:
            shift = _SHIFT * fast**2 or 1.0
            squares, vectors = self._linear(count, shift, prefix)
            wanted = np.sort(np.abs(squares))[:count].max(initial=0.0)
            if 0.0 < wanted < shift:
                # seen from so far away, multiple eigenvalues are hard to tell apart
                squares, vectors = self._linear(count, 0.1 * wanted, prefix)
            if self.parts is not None and self._symmetric:
                squares, vectors = self._refined(squares, vectors, fast)
            s = np.sqrt(-squares.astype(np.complex128))
            s = np.where(s.imag < 0, -s, s)
            s[np.argsort(np.abs(s), kind="stable")[: len(self._unresisted())]] = 0.0
        else:
            rate = max(np.sqrt(_SHIFT) * fast, floor) or 1.0
            s, vectors = self._quadratic(count, rate, prefix)
            wanted = np.sort(np.abs(s))[: 2 * count].max(initial=0.0)
            if wanted > _FAR * rate:
                # seen from so far away, they are not accurate
                s, vectors = self._quadratic(count, wanted, prefix)
                rate = wanted
            still = np.abs(s) <= np.maximum(self._noise(vectors, fast), _SPLIT * rate)
            still |= self._rigid(vectors)
            s = np.where(still, s, self._sharpened(s, vectors, fast))
            s, vectors = _one_of_each_pair(s, vectors, still)
        s = np.where(np.abs(s) <= self._noise(vectors, fast), 0.0, s)
        order = np.argsort(np.abs(s), kind="stable")[:count]
        if len(order) < count:
            raise ConvergenceError(
                f"SLEPc found {len(order)} of {count} modes; ask for fewer, or see its options "
                f"under the prefix {prefix!r}"
            )
        s, vectors = s[order], vectors[order]
        return s, vectors, self._residuals(s, vectors)

    def _fastest(self) -> float:
        """Largest ratio of stiffness to mass of one unknown, square root: a rate."""
        mass, stiffness = self.M.diagonal(), np.abs(self.K.diagonal())
        ratio = stiffness[mass > 0] / mass[mass > 0]
        return float(np.sqrt(ratio.max(initial=0.0)))

    def _noise(self, vectors: Complex, fast: float) -> Array:
        """Rates that round-off can make of zero, for each vector."""
        if self.parts is None:
            size = np.abs(vectors)
            noise = _ROUND_OFF * (size * (abs(self.K) @ size.T).T).sum(axis=1)
        else:
            noise = self.parts.round_off(vectors.real) + self.parts.round_off(vectors.imag)
        mass = (vectors.conj() * (self.M @ vectors.T).T).sum(axis=1).real
        ratio = np.divide(noise, mass, out=np.full(len(mass), np.inf), where=mass > 0)
        return np.asarray(np.sqrt(np.minimum(ratio, _ROUND_OFF * fast**2)))

    def _refined(self, squares: Complex, vectors: Complex, fast: float) -> tuple[Complex, Complex]:
        """The slow ones anew, in the span of their vectors, by the stiffness without round-off."""
        assert self.parts is not None
        slow = np.abs(squares) <= _SLOW * fast**2
        if not slow.any():
            return squares, vectors
        rigid = _orthonormal(self.parts.mechanisms(self.B), self.M)
        both = np.concatenate([vectors[slow].real, vectors[slow].imag])
        both = _unit(both / np.abs(both).max(), self.M / self.M.diagonal().max(), _SPLIT)
        both = _unit(both, self.M, 0.0)
        for _ in range(2):
            both = both - both @ (self.M @ rigid.T) @ rigid
        both = _unit(both, self.M, _BESIDE)
        basis = np.concatenate([rigid, _orthonormal(both, self.M)])
        stiff = self.parts.stiffness(basis)
        found, turn = np.linalg.eigh(0.5 * (stiff + stiff.T))
        return (
            np.concatenate([found.astype(np.complex128), squares[~slow]]),
            np.concatenate([(turn.T @ basis).astype(np.complex128), vectors[~slow]]),
        )

    def _unresisted(self) -> Array:
        """Motions without strain that nothing else resists, either, shape (z, n)."""
        n = self.M.shape[0]
        if self.parts is None:
            return np.empty((0, n))
        Z = _orthonormal(self.parts.mechanisms(self.B), self.M)
        if not len(Z):
            return np.empty((0, n))
        values, turn = np.linalg.eigh(Z @ (self.parts.rest @ Z.T))
        return np.asarray((turn.T @ Z)[np.abs(values) <= self.parts.round_off(turn.T @ Z)])

    def _rigid(self, vectors: Complex) -> npt.NDArray[np.bool_]:
        """Which are motions that nothing resists, but for their own errors."""
        Z = self._unresisted()
        left = vectors - (vectors @ (self.M @ Z.T)) @ Z
        sizes = [(x.conj() * (self.M @ x.T).T).sum(axis=1).real for x in (left, vectors)]
        return np.asarray(sizes[0] <= _BESIDE**2 * sizes[1])

    def _sharpened(self, s: Complex, vectors: Complex, fast: float) -> Complex:
        """The slow ones from ``φᵀ Q(s) φ = 0``, by the stiffness without round-off."""
        assert self.C is not None
        if self.parts is None or not self._symmetric:
            return s
        found = s.copy()
        for k in np.flatnonzero(np.abs(s) ** 2 <= _SLOW * fast**2):
            x, y = vectors[k].real, vectors[k].imag
            p = self.parts.stiffness(np.stack([x, y]))
            stiff = p[0, 0] - p[1, 1] + 1j * (p[0, 1] + p[1, 0])
            mass, damping = (vectors[k] @ (A @ vectors[k]) for A in (self.M, self.C))
            roots = np.roots([mass, damping, stiff])
            found[k] = roots[np.abs(roots - s[k]).argmin()]
        return found

    @property
    def _symmetric(self) -> bool:
        asymmetry = abs(self.K - self.K.T).max()
        return bool(asymmetry <= _SYMMETRIC * abs(self.K).max())

    def _linear(self, count: int, shift: float, prefix: str) -> tuple[Complex, Complex]:
        """Eigenvalues ``−s²`` of ``K φ + Bᵀ μ = −s² M φ``."""
        K, M = self._bordered(self.K, shift), padded(self.M, self.B)
        solver = SLEPc.EPS().create(PETSc.COMM_SELF)
        solver.setOperators(to_petsc(K), to_petsc(M))
        types = SLEPc.EPS.ProblemType
        solver.setProblemType(types.GHEP if self._symmetric else types.GNHEP)
        solver.setTarget(-shift)
        set_up(solver, min(count + _SPARE, K.shape[0]), SLEPc.EPS, prefix)
        return pairs_of(solver, K, self.M.shape[0])

    def _quadratic(self, count: int, rate: float, prefix: str) -> tuple[Complex, Complex]:
        """Eigenvalues ``s``, scaled by a rate so that those wanted are about one."""
        assert self.C is not None
        shift = 1e-2
        # about one, too: what is very small has been found
        size = np.abs(self.K.diagonal()).max(initial=0.0) + rate**2 * self.M.diagonal().max()
        unit = 2.0 ** -np.round(np.log2(size))
        K = unit * self._bordered(self.K, rate**2)
        C, M = (padded(unit * rate**k * part, self.B) for k, part in ((1, self.C), (2, self.M)))
        solver = SLEPc.PEP().create(PETSc.COMM_SELF)
        solver.setOperators([to_petsc(K), to_petsc(C), to_petsc(M)])
        solver.setTarget(shift)
        set_up(solver, min(2 * count + _SPARE, K.shape[0]), SLEPc.PEP, prefix)
        s, vectors = pairs_of(solver, K, self.M.shape[0])
        return rate * s, vectors

    def _bordered(self, K: sp.csr_matrix, shift: float) -> sp.csr_matrix:
        """``[[K, Bᵀ], [B, 0]]`` with constraints about as large as the stiffness."""
        size = np.abs(K.diagonal()) + shift * self.M.diagonal()
        if not self.B.shape[0]:
            return K
        # whatever the unit of each
        rows = np.sqrt(np.asarray(self.B.multiply(self.B).sum(axis=1)).ravel())
        B = sp.diags(np.mean(size) / rows) @ self.B
        return sp.bmat([[K, B.T], [B, None]], format="csr")

    def _residuals(self, s: Complex, vectors: Complex) -> Array:
        """Out of the directions in which joints can push."""
        parts = [self.K @ vectors.T, (self.M @ vectors.T) * s**2]
        if self.C is not None:
            parts.append((self.C @ vectors.T) * s)
        total = sum(parts)
        if self.B.shape[0]:
            gram = scipy.sparse.linalg.splu((self.B @ self.B.T).tocsc())
            pushed = self.B @ total
            total = total - self.B.T @ (gram.solve(pushed.real) + 1j * gram.solve(pushed.imag))
        absolute = np.abs(vectors.T)
        size = abs(self.K) @ absolute + np.abs(s) ** 2 * (abs(self.M) @ absolute)
        return np.asarray(np.linalg.norm(total, axis=0) / np.linalg.norm(size, axis=0).clip(1e-300))


def _unit(vectors: Array, M: sp.csr_matrix, least: float) -> Array:
    """Rows of length one; those that are not longer than ``least`` are left out."""
    size = np.sqrt((vectors * (M @ vectors.T).T).sum(axis=1).clip(0.0))
    kept = size > least
    return np.asarray(vectors[kept] / size[kept, np.newaxis])


def _orthonormal(vectors: Array, M: sp.csr_matrix) -> Array:
    """Basis (k, n) of the span of rows, with ``Φ M Φᵀ = 1``."""
    if not len(vectors):
        return vectors
    weight, base = np.linalg.eigh(vectors @ (M @ vectors.T))
    kept = weight > _FOLLOWS * weight.max()
    return np.asarray((base[:, kept] / np.sqrt(weight[kept])).T @ vectors)


def _one_of_each_pair(
    s: Complex, vectors: Complex, still: npt.NDArray[np.bool_]
) -> tuple[Complex, Complex]:
    """Of conjugates the one with ``Im s > 0``; real ones all; of double zeros one each."""
    turning = ~still & (s.imag > -1e-9 * np.abs(s))
    rigid = vectors[still]
    span = np.concatenate([rigid.real, rigid.imag])
    if len(rigid):
        span = np.linalg.svd(span, full_matrices=False)[2][: (len(rigid) + 1) // 2]
    rates = np.concatenate([np.zeros(len(span)), s[turning]])
    return rates, np.concatenate([span.astype(np.complex128), vectors[turning]])
