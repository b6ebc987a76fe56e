"""Options of generalised-α."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

from fem_lie._arrays import choice, number
from fem_lie.lie.motions import Parametrisation
from fem_lie.linear.choice import SkewPart
from fem_lie.scene import Scene
from fem_lie.solve.motion.integrator import check_kinds
from fem_lie.solve.motion.policies import Automatic, RefactorisationPolicy

DAMPED = 0.5
"""Largest spectral radius in sub-steps: chains of hundreds of links need this damping to
converge."""


class MatrixFrame(IntEnum):
    """Axes in which the iteration matrix is frozen; the solution does not depend on them.

    ``LOCAL``: the nodes' own axes, along which the matrix hardly changes. ``INERTIAL``: fixed axes,
    along which it rotates with the bodies, as in formulations with rotation vectors in the inertial
    frame; slower, for comparison.
    """

    LOCAL = 0
    INERTIAL = 1


class ConstraintIndex(IntEnum):
    """Which constraints hold at the end of each step, to the tolerance of the iteration.

    ``THREE``: position constraints; velocities satisfy them to second order. ``STABILISED_TWO``:
    velocity constraints, too, see :mod:`fem_lie.solve.impacts.impulses`.
    """

    THREE = 3
    STABILISED_TWO = 2


@dataclass(frozen=True)
class Options:
    """Options of :class:`~fem_lie.GeneralisedAlpha`, which documents them."""

    radius: float = 0.8
    tolerance: float = 2e-8
    policy: RefactorisationPolicy = field(default_factory=Automatic)
    max_iterations: int = 30
    parametrisation: Parametrisation = Parametrisation.EXPONENTIAL
    matrix_frame: MatrixFrame = MatrixFrame.LOCAL
    skew_part: SkewPart = SkewPart.DROPPED_IF_SMALL
    index: ConstraintIndex | None = None
    petsc_options_prefix: str = "fem_lie_dynamics_"

    def __post_init__(self) -> None:
        """Check the options."""
        check_kinds(self.tolerance, self.max_iterations, self.policy)
        number(self.radius, "radius")
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"the spectral radius must be in [0, 1], got {self.radius}")
        # plain numbers are accepted
        choice(self.parametrisation, Parametrisation, "parametrisation")
        choice(self.matrix_frame, MatrixFrame, "matrix_frame")
        if self.index is not None:
            choice(self.index, ConstraintIndex, "index")
        choice(self.skew_part, SkewPart, "skew_part")
        if not self.tolerance > 0:
            raise ValueError(f"expected tolerance > 0, got {self.tolerance}")

    def index_for(self, scene: Scene) -> ConstraintIndex:
        """The chosen index, or ``STABILISED_TWO`` if a scene has impacts, else ``THREE``.

        Velocities that violate constraints have energy that impacts set free, and keep contacts of
        bodies at rest moving.

        Args:
            scene: The scene of the run, without its impacts in ``contacts``.
        """
        if self.index is not None:
            return self.index
        return ConstraintIndex.STABILISED_TWO if scene.impacts else ConstraintIndex.THREE
