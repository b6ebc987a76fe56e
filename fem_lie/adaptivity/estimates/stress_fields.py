"""Stress of the elements of a body and recovered stress, and the errors by their difference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie.adaptivity.estimates.estimate import ElementErrors


@dataclass(frozen=True, eq=False)
class StressFields:
    """Stress at q points of each of m elements, b components in local frames.

    Attributes:
        own: Stress of the elements, shape (m, q, b).
        recovered: Recovered stress, of higher order, shape (m, q, b).
        weights: Integration weight (length or area) of each point, shape (m, q).
        compliance: ``D⁻¹`` of each element, shape (m, b, b).
    """

    own: Array
    recovered: Array
    weights: Array
    compliance: Array

    def energy(self, stress: Array) -> Array:
        """``∫ σ · D⁻¹ σ`` of each element, shape (m,): twice its elastic energy."""
        return self.work(stress, stress)

    def work(self, a: Array, b: Array) -> Array:
        """``∫ σ_a · D⁻¹ σ_b`` of each element, shape (m,)."""
        at_points = ((a @ self.compliance) * b).sum(axis=2)
        return np.asarray((at_points * self.weights).sum(axis=1))

    @property
    def missing(self) -> Array:
        """Recovered stress minus that of the elements, shape (m, q, b)."""
        return self.recovered - self.own

    @property
    def errors(self) -> ElementErrors:
        """Element errors: energy of the difference."""
        return ElementErrors(self.energy(self.missing), float(self.energy(self.own).sum()))
