"""Inertia of a section per length, from what is known of it: mass, polar moment, both moments."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, number, numbers


def section_gram(
    gram: npt.ArrayLike | None,
    mass: float | None,
    polar: float | None,
    rotary: npt.ArrayLike | None,
) -> Array | None:
    """Gram matrix of (x, d₁, d₂, d₃) per length, or ``None`` if nothing is given.

    Args:
        gram: The matrix itself, shape (4, 4).
        mass: Mass per length.
        polar: Moment of inertia per length about e₁, of which e₂ and e₃ have half each.
        rotary: Moments of inertia per length about e₂ and e₃, shape (2,).

    Raises:
        ValueError: More than one of them, or moments without a mass; wrong shapes.
    """
    if gram is not None:
        matrix = numbers(gram, "gram")
        if mass is not None or polar is not None or rotary is not None:
            raise ValueError("give the Gram matrix, or mass= with polar= or rotary=, not both")
        if matrix.shape != (4, 4):
            raise ValueError(
                f"the Gram matrix of (x, d₁, d₂, d₃) must have shape (4, 4), got {matrix.shape}; a "
                "section of which the mass and moments of inertia per length are known has mass=…, "
                "polar=J₁ or mass=…, rotary=(J₂, J₃)"
            )
        return matrix
    if mass is None:
        if polar is not None or rotary is not None:
            raise ValueError("polar= and rotary= need mass=, the mass per length, beside them")
        return None
    if polar is not None and rotary is not None:
        raise ValueError("give polar= or rotary=; the polar moment is the sum of the other two")
    about = (0.0 if polar is None else number(polar, "polar") / 2) * np.ones(2)
    if rotary is not None:
        about = numbers(rotary, "rotary")
        if about.shape != (2,):
            raise ValueError(
                f"rotary must be the moments of inertia about e₂ and e₃, 2 numbers, got {rotary!r}"
            )
    # what turns about e₂ lies along e₃
    return np.diag([number(mass, "mass"), 0.0, about[1], about[0]])
