"""Errors by residuals: how far the elements' stress is from balance, within them and between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fem_lie.adapt.estimates.beam_residual import beam_residual
from fem_lie.adapt.estimates.estimate import ErrorEstimate, Way
from fem_lie.adapt.estimates.shell_residual import shell_residual
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell


@dataclass(frozen=True)
class Residual(ErrorEstimate):
    """From the balance of stress resultants in local frames, with the constants of the elements.

    Of beams it is what is left of the balance within elements, of shells with nodes at their
    corners the jumps of stress between them; see
    :func:`~fem_lie.adapt.estimates.beam_residual.beam_residual` and
    :func:`~fem_lie.adapt.estimates.shell_residual.shell_residual`.

    Example:
        >>> found = fl.Residual()
        >>> isinstance(found, fl.ErrorEstimate)
        True
    """

    def ways(self) -> Mapping[type, Way]:
        """For beams and shells."""
        return {Beam: beam_residual, Shell: shell_residual}
