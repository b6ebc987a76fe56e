"""Errors by recovered stress: how far the stress of the elements is from a smoother one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from fem_lie.adapt.estimates.beam_recovery import beam_fields
from fem_lie.adapt.estimates.estimate import ElementErrors, ErrorEstimate, Estimated, Way, steps_of
from fem_lie.adapt.estimates.shell_recovery import shell_fields
from fem_lie.adapt.estimates.stress_fields import StressFields
from fem_lie.adapt.estimates.thin_recovery import thin_fields
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.scene import Scene

_RECOVERIES: dict[type, Callable[..., list[StressFields]]] = {
    Beam: beam_fields,
    Shell: shell_fields,
    ThinShell: thin_fields,
}


@dataclass(frozen=True)
class Recovery(ErrorEstimate):
    """``∫ (σ* − σ)·D⁻¹(σ* − σ)`` with a recovered stress σ*: the default.

    (O. C. Zienkiewicz & J. Z. Zhu, IJNME 24 (1987) 337.)

    Example:
        >>> fl.Recovery()
        Recovery()
    """

    def ways(self) -> Mapping[type, Way]:
        """For beams, shells and thin shells."""
        return dict.fromkeys(_RECOVERIES, _errors)


def _errors(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    return [fields.errors for fields in fields_of(result, body, scene, steps)]


def fields_of(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int] = (-1,)
) -> list[StressFields]:
    """Stress of the elements of a body and the one recovered from it, in some states.

    Raises:
        ValueError: See :meth:`~fem_lie.adapt.estimates.estimate.ErrorEstimate.errors`.
    """
    chosen = steps_of(result, body, scene, steps, tuple(_RECOVERIES))
    (recovery,) = (r for kind, r in _RECOVERIES.items() if isinstance(body, kind))
    return recovery(result, body, scene, chosen)
