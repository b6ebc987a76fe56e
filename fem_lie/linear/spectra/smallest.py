"""The smallest eigenvalues of a constrained quadratic problem, each checked by its residual.

With ``P`` the quadratic at a shift of about the size of the eigenvalues, a step of inverse
iteration changes an eigenvector ``φ`` by ``e = P⁻¹ Q(s) φ``. The ratio of the lengths of ``e`` and
``φ``, both in the mass norm, does not depend on units. For symmetric problems it bounds the
relative distance of ``s² + shift`` from an eigenvalue (T. Kato, J. Phys. Soc. Japan 4 (1949) 334),
however stiff elements are. The residual forces ``Q(s) φ`` do not: they are small relative to those
of stiff elements even if ``s`` is wrong.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.krylov import Approximation, Krylov
from fem_lie.linear.spectra.pencil import SHIFT, Complex, ComplexExtended, Pencil
from fem_lie.linear.spectra.slow_motions import without, without_round_off

MOST = 600  # unknowns less constraints, which take some seconds
_INFINITE = 1e-14  # of the largest inverse: eigenvalues of unknowns without mass


def dense(pencil: Pencil, count: int, floor: float) -> Approximation:
    """The smallest eigenvalues by a dense method, which cannot miss any.

    Raises:
        ConvergenceError: The problem is too large, or singular at the shift.
    """
    unknowns, pencil = pencil.unknowns, pencil.whole
    n, m = pencil.M.shape[0], pencil.B.shape[0]
    if n - m > MOST:
        raise ConvergenceError(f"{n - m} unknowns are too many for a dense eigenvalue problem")
    basis = _admissible(pencil.B)
    rate = max(np.sqrt(SHIFT) * pencil.fastest, floor) or 1.0
    K = np.asarray(basis @ pencil.terms(basis.astype(np.complex128))[2].T.real, dtype=np.float64)
    M = basis @ (pencil.M @ basis.T)
    C = np.zeros_like(M) if pencil.C is None else basis @ (pencil.C @ basis.T)
    P = K + rate * C + rate**2 * M
    scale = 1.0 / np.sqrt(np.abs(np.diag(P)).clip(1e-300))
    try:
        inverse = np.linalg.inv(scale[:, np.newaxis] * P * scale)
    except np.linalg.LinAlgError as error:
        raise ConvergenceError("the dense eigenvalue problem is singular at its shift") from error
    inverse = scale[:, np.newaxis] * inverse * scale
    if pencil.C is not None:
        s, reduced = _quadratic(M, C + 2.0 * rate * M, inverse, rate)
    elif pencil.symmetric:
        s, reduced = _symmetric(K, M)
    else:
        s, reduced = _linear(M, inverse, rate)
    order = np.argsort(np.abs(s), kind="stable")[: 2 * count + n // 4]

    def solve(residuals: ComplexExtended) -> Complex:
        forces = unknowns.whole_forces(residuals).astype(np.complex128)
        return unknowns.part(np.asarray(forces @ basis.T @ inverse.T @ basis))

    return Approximation(s[order], unknowns.part(reduced[order] @ basis), solve)


def _admissible(B: sp.csr_matrix) -> Array:
    """Orthonormal rows (r, n) that satisfy the constraints."""
    if not B.shape[0]:
        return np.eye(B.shape[1])
    size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
    return np.asarray(scipy.linalg.null_space((sp.diags(1.0 / size) @ B).toarray()).T)


def _symmetric(K: Array, M: Array) -> tuple[Complex, Complex]:
    """Roots with ``Im s ≥ 0`` of ``(s² M + K) x = 0``, and ``x`` as rows."""
    try:
        squares, x = scipy.linalg.eigh(0.5 * (K + K.T), M)
    except np.linalg.LinAlgError as error:
        raise ConvergenceError("the mass matrix is not positive definite") from error
    return np.sqrt((-squares).astype(np.complex128)), x.T.astype(np.complex128)


def _linear(M: Array, inverse: Array, rate: float) -> tuple[Complex, Complex]:
    """As :func:`_symmetric`, with the inverse of ``K + rate² M``, for an unsymmetric ``K``."""
    θ, x = np.linalg.eig(inverse @ M)
    finite = np.abs(θ) > _INFINITE * np.abs(θ).max()
    s = np.sqrt(rate**2 - 1.0 / θ[finite].astype(np.complex128))
    return np.where(s.imag < 0, -s, s), x.T[finite].astype(np.complex128)


def _quadratic(M: Array, C: Array, inverse: Array, rate: float) -> tuple[Complex, Complex]:
    """All roots of ``(t² M + t C + P) x = 0``, ``s = rate + t``, with the inverse of ``P``.

    ``μ = unit/t`` are eigenvalues of a companion matrix whose blocks are about one.
    """
    n = len(M)
    inertia, damping = inverse @ M, inverse @ C
    unit = 1.0 / np.sqrt(np.linalg.norm(inertia, 2))
    lower = np.hstack([-(unit**2) * inertia, -unit * damping])
    μ, x = np.linalg.eig(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower]))
    finite = np.abs(μ) > _INFINITE * np.abs(μ).max()
    s = rate + unit / μ[finite].astype(np.complex128)
    return s, x[:n].T[finite].astype(np.complex128)


_ACCEPTED = 1e-5  # largest residual; errors of symmetric eigenvalues are its square
_NEAR = 1e-2  # residual below which a step of inverse iteration improves a mode
_SLOWER = 0.99  # largest quotient of rates of clearly slower modes
_SPLIT = 1e-7  # relative size of parts of a vector that are round-off


def smallest(
    pencil: Pencil, count: int, floor: float, prefix: str
) -> tuple[Complex, Complex, Array]:
    """Eigenvalues of least magnitude with ``Im s ≥ 0``, vectors (count, n) and residuals.

    If SLEPc's residuals are too large, or it finds too few, a dense method replaces it, or SLEPc
    with another shift if the problem is too large.

    Args:
        pencil: The problem.
        count: Number of eigenvalues.
        floor: A relevant rate, such as that of a rotation; 0 if there is none.
        prefix: Prefix of SLEPc's options; those of its second attempt have ``again_`` after it.

    Raises:
        ConvergenceError: No method finds all of them.
    """
    reasons = []
    for method in (Krylov(prefix), dense, Krylov(f"{prefix}again_", nearer=0.3, spare=4 * count)):
        try:
            found = method(pencil, count, floor)
        except ConvergenceError as error:
            reasons.append(str(error))
            continue
        s, vectors, round_off, free = _physical(pencil, found)
        if len(s) < count:
            reasons.append(f"{len(s)} of {count} modes found")
            continue
        order = np.argsort(np.abs(s), kind="stable")[:count]
        rates, motions = s[order], vectors[order]
        s, vectors, residuals = _improved(pencil, found, rates, motions)
        # free motions are known without the inverse, in which round-off of their stiffness grows
        # by the smallest inertia
        known = order < free
        vectors[known], residuals[known] = motions[known], 0.0
        if (residuals <= _ACCEPTED).all():
            # only now: a mode of round-off satisfies the problem with its own rate, not with zero
            s = np.where(np.abs(s) <= round_off[order], 0.0, s)
            order = np.argsort(np.abs(s), kind="stable")
            return s[order], vectors[order], residuals[order]
        reasons.append(f"a mode has a residual of {residuals.max():.1e}")
    raise ConvergenceError(
        f"{count} modes with residuals below {_ACCEPTED:g} were not found: {'; '.join(reasons)}. "
        f"Ask for fewer, or see SLEPc's options under the prefix {prefix!r}"
    )


def _physical(pencil: Pencil, found: Approximation) -> tuple[Complex, Complex, Array, int]:
    """Eigenpairs, one of each conjugate pair, and rates that round-off makes of zero, (k,).

    The last number is that of free motions, which come first: their strains and the stiffness along
    them are zero up to round-off.
    """
    possible = _possible(pencil, found.s, found.vectors)
    s, vectors = found.s[possible], found.vectors[possible]
    free = np.empty((0, pencil.M.shape[0]))
    if pencil.parts is not None:
        slow = without_round_off(pencil, s, vectors)
        free, s, vectors = slow.free, slow.s, slow.vectors
    s = _rayleigh(pencil, s, vectors, pencil.terms(vectors))
    strained = vectors - pencil.work(vectors, (pencil.M @ free.T).T) @ free
    round_off = pencil.round_off(strained, pencil.kinetic(vectors))
    if pencil.C is not None:
        s, vectors = _one_of_each_pair(pencil, np.where(np.abs(s) <= round_off, 0.0, s), vectors)
        round_off = np.zeros(len(s))
    zeros = np.zeros(len(free), dtype=np.complex128)
    both = np.concatenate([free.astype(np.complex128), vectors])
    return np.concatenate([zeros, s]), both, np.concatenate([zeros.real, round_off]), len(free)


def _possible(pencil: Pencil, s: Complex, vectors: Complex) -> npt.NDArray[np.bool_]:
    """Whether eigenpairs are motions: infinite eigenvalues of constraints appear as large ones.

    Their vectors violate the constraints, and differ from their Rayleigh quotients.
    """
    quotients = np.abs(_rayleigh(pencil, s, vectors, pencil.terms(vectors)))
    fast = np.abs(s) > np.sqrt(SHIFT) * pencil.fastest
    return np.asarray(~fast | (quotients > 0.5 * np.abs(s)))


def _improved(
    pencil: Pencil, found: Approximation, s: Complex, vectors: Complex
) -> tuple[Complex, Complex, Array]:
    """Eigenpairs in ascending order, after a step of inverse iteration where it improves them.

    The step would amplify components of slower modes.
    """
    slower = _slower(pencil, s, vectors)
    vectors = np.concatenate(
        [without(pencil, basis, s[[k]], vectors[[k]]) for k, basis in enumerate(slower)]
    )
    residuals, change = _residuals(pencil, found, s, vectors, pencil.terms(vectors))
    for own, basis in zip(change, slower, strict=True):
        own -= pencil.work(own, (pencil.M @ basis.T).T) @ basis
    near = np.where((residuals <= _NEAR)[:, np.newaxis], vectors - change, vectors)
    terms = pencil.terms(near)
    nearest = np.where(s == 0.0, 0.0, _rayleigh(pencil, s, near, terms))
    lower, _ = _residuals(pencil, found, nearest, near, terms)
    better = lower < residuals
    return (
        np.where(better, nearest, s),
        np.where(better[:, np.newaxis], near, vectors),
        np.minimum(lower, residuals),
    )


def _slower(pencil: Pencil, s: Complex, vectors: Complex) -> list[Array]:
    """Span of clearly slower modes for each mode, with ``Φ M Φᵀ = 1``."""
    found, rows = [], [0]
    basis: Array = np.empty((0, vectors.shape[1]))
    for k, vector in enumerate(vectors):
        found.append(basis[: rows[np.searchsorted(np.abs(s), _SLOWER * np.abs(s[k]))]])
        for part in (vector.real, vector.imag):
            size, left = np.sqrt(pencil.work(part, pencil.M @ part)), part
            for _ in range(2):
                left = left - pencil.work(left, (pencil.M @ basis.T).T) @ basis
            length = np.sqrt(pencil.work(left, pencil.M @ left))
            if length > _SPLIT * size:
                basis = np.vstack([basis, left / length])
        rows.append(len(basis))
    return found


def _residuals(
    pencil: Pencil,
    found: Approximation,
    s: Complex,
    vectors: Complex,
    terms: tuple[Complex, Complex, Complex],
) -> tuple[Array, Complex]:
    """Lengths of ``P⁻¹ Q(s) φ`` over those of ``φ``, and the vectors themselves."""
    M, C, K = terms
    wide = s.astype(np.clongdouble)[:, np.newaxis]
    change = found.solve(np.asarray(wide * wide * M + wide * C + K))
    size = pencil.kinetic(change) / pencil.kinetic(vectors).clip(1e-300)
    return np.asarray(np.sqrt(size)), change


def _rayleigh(
    pencil: Pencil, s: Complex, vectors: Complex, terms: tuple[Complex, Complex, Complex]
) -> Complex:
    """Root of ``φᴴ Q(s) φ`` nearest to ``s``, for each ``φ``."""
    own = [(vectors.conj() * term).sum(axis=1) for term in terms]
    m, c, k = pencil.unknowns.total(np.array(own))
    root = np.sqrt(c * c - 4.0 * m * k)
    # the sum in which neither part cancels
    q = -0.5 * (c + np.where((c.conj() * root).real < 0.0, -root, root))
    first = np.divide(q, m, out=np.zeros_like(q), where=m != 0)
    second = np.divide(k, q, out=first.copy(), where=q != 0)
    return np.asarray(
        np.where(np.abs(first - s) <= np.abs(second - s), first, second), dtype=np.complex128
    )


def _one_of_each_pair(pencil: Pencil, s: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """The eigenvalue with ``Im s > 0`` of each pair; all real ones; one of each double zero."""
    still = s == 0.0
    turning = ~still & (s.imag > -1e-9 * np.abs(s))
    rigid = vectors[still]
    span = np.concatenate([rigid.real, rigid.imag])
    if len(rigid):
        triangle = pencil.unknowns.triangle(pencil.unknowns.owned(span).T)
        _, sizes, turn = np.linalg.svd(triangle)
        largest = slice((len(rigid) + 1) // 2)
        span = (turn[largest] / sizes[largest, np.newaxis]) @ span
    rates = np.concatenate([np.zeros(len(span)), s[turning]])
    return rates, np.concatenate([span.astype(np.complex128), vectors[turning]])
