"""Extrapolation of results to a step of size zero, and the order that they show.

The error of a scheme of second order has an expansion ``c₂ h² + c₃ h³ + c₄ h⁴ + …`` if the motion
is smooth on the scale of the steps (generalised-α is not symmetric in time, so odd powers are
there). Two results with steps h and h/2 give one without ``c₂``, three one without ``c₃`` (Aitken
and Neville's scheme, L. F. Richardson's "deferred approach to the limit"). That an expansion exists
is not taken for granted: :func:`order` says what the results themselves show.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt


def extrapolated(results: Sequence[npt.ArrayLike], powers: Sequence[int] = (2, 3, 4)) -> Any:
    """Limit of results with steps h, h/2, h/4 and so on.

    Args:
        results: Arrays of the same shape, the largest step first.
        powers: Of h in the expansion of the error; as many are removed as there are results to.
    """
    row = [np.asarray(result, dtype=np.float64) for result in results]
    if not 1 <= len(row) <= len(powers) + 1:
        raise ValueError(f"wanted 1 to {len(powers) + 1} results, got {len(row)}")
    for power in powers[: len(row) - 1]:
        weight = 2.0**power
        row = [(weight * b - a) / (weight - 1.0) for a, b in pairwise(row)]
    return row[0]


def order(results: Sequence[npt.ArrayLike]) -> float:
    """Median of the powers of h in the differences of the last three results; nan if fewer.

    Where differences are less than a hundredth of the largest they say little, and do not count.
    """
    if len(results) < 3:
        return float("nan")
    a, b, c = (np.atleast_1d(np.asarray(x, dtype=np.float64)) for x in results[-3:])
    coarse, fine = np.abs(a - b), np.abs(b - c)
    counts = coarse > 0.01 * coarse.max(axis=0)
    return float(np.median(np.log2(coarse[counts] / fine[counts])))


def largest_errors(results: Sequence[npt.ArrayLike], reference: npt.ArrayLike) -> tuple[Any, Any]:
    """Largest errors of each column, with each step and of what is extrapolated.

    Args:
        results: Shapes (times, columns), the largest step first.
        reference: Likewise.

    Returns:
        Largest errors by columns: with each step, shape (results, columns), and extrapolated.
    """
    rows = [*(np.asarray(result) for result in results), extrapolated(results)]
    errors = np.array([np.abs(row - np.asarray(reference)).max(axis=0) for row in rows])
    return errors[:-1], errors[-1]
