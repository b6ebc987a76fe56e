"""Functions of small changes without cancellation, in UFL: for energies of solids.

At small strains ``C`` is nearly one, and an energy that is a difference of numbers of order one,
such as ``tr C − 3 − ln det C``, is round-off: at a strain of 1e-6 its error is 1e-4 of itself.
Written in ``C − 1`` and with these functions it has all digits that strains have. UFL itself has
neither ``log1p`` nor ``expm1``.
"""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr

_NEAR, _TERMS = 0.1, 6
"""Argument up to which the series is summed, and its terms: the next one is 2e-18 of the first."""


def log1p(x: Expr) -> Expr:
    """``ln(1 + x)`` to round-off of ``x``, also where ``x`` is small.

    Args:
        x: A scalar above −1.

    Returns:
        ``2 artanh(x/(2 + x))`` by its series for ``|x| < 0.1``, and else the logarithm.
    """
    z = x / (2.0 + x)
    series: Expr | float = 1.0 / (2 * _TERMS + 1)
    for k in reversed(range(_TERMS)):
        series = 1.0 / (2 * k + 1) + z**2 * series
    return ufl.conditional(ufl.lt(abs(x), _NEAR), 2.0 * z * series, ufl.ln(1.0 + x))


def expm1(x: Expr) -> Expr:
    """``eˣ − 1`` to round-off of itself, also where ``x`` is small: ``tanh(x/2) (eˣ + 1)``.

    Args:
        x: A scalar.
    """
    return ufl.tanh(0.5 * x) * (ufl.exp(x) + 1.0)


def det_minus_one(C: Expr) -> Expr:
    """``det C − 1`` to round-off of strains.

    Args:
        C: A symmetric matrix (3, 3), near one or not.

    Returns:
        The change by the principal invariants of ``A = C − 1``: ``I₁ + I₂ + I₃``.
    """
    A = C - ufl.Identity(3)
    return ufl.tr(A) + 0.5 * (ufl.tr(A) ** 2 - ufl.inner(A, A)) + ufl.det(A)
