"""Goal: a frequency of small vibrations, with the energy error of its mode.

With a mode φ of unit mass, ``φᵀMφ = 1``, the square of its frequency is too large by the energy of
the error of the mode, ``ω_h² − ω² ≈ Σ ∫ (σ*_φ − σ_φ)·D⁻¹(σ*_φ − σ_φ)`` (G. Strang & G. J. Fix, An
Analysis of the Finite Element Method, 1973, ch. 6). The stress is that of the mode; the effect of
an error of the equilibrium on the frequency is not included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, whole
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.goals import Goal, fields_along
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.solve.statics.statics import statics
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class FrequencyGoal(Goal):
    """Goal: the angular frequency of a vibration mode about the last state, rad per time.

    Attributes:
        mode: Number of the mode, counted from 1, the slowest first.

    Raises:
        ValueError: The number is not positive.
    """

    mode: int = 1

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if ``mode`` is not a positive integer."""
        whole(self.mode, "mode")

    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` for velocity constraints, or if there is no inertia.

        Args:
            scene: The scene.
        """
        if any(joint.velocity_definitions() for joint in scene.joints):
            raise ValueError(
                "expected position constraints for a frequency, got a velocity constraint"
            )
        Equations(scene, dynamics=True)  # raises if there is no inertia

    def solve(self, scene: Scene) -> StaticResult:
        """Equilibrium in load steps, also without loads.

        Args:
            scene: The scene.
        """
        return statics(scene)

    def found(
        self, result: StaticResult, bodies: Sequence[Estimated], scene: Scene
    ) -> tuple[float, list[Array]]:
        """The frequency about the last state, and the contribution of each element to its error.

        Args:
            result: A result of the scene.
            bodies: Bodies of the scene.
            scene: The scene.

        Raises:
            ValueError: There are fewer modes, or damping or rotation, or the mode does not
                oscillate.
        """
        omega, shape = self._mode(result, scene)
        parts = []
        for body in bodies:
            now, missing = fields_along(result, body, scene, shape)
            parts.append(np.asarray(-now.energy(missing) / (2.0 * omega), dtype=np.float64))
        return omega, parts

    def _mode(self, result: StaticResult, scene: Scene) -> tuple[float, Array]:
        """Frequency, and nodal twists (N, 6) with unit mass."""
        equations = Equations(scene, dynamics=True)
        state = equations.small_motions(result.steady_rotation)
        state.move(result.info.renumbered(result.frames, equations.unknowns.bodies))
        pencil = state.pencil()
        if pencil.C is not None:
            raise ValueError("a frequency is estimated without damping and steady rotation")
        free = pencil.K.shape[0] - pencil.B.shape[0]
        if self.mode > free:
            raise ValueError(f"mode must be 1 … {free}, the degrees of freedom, got {self.mode}")
        s, vectors, _ = smallest(pencil, self.mode, 0.0, "fem_lie_frequency_")
        omega, vector = float(s[-1].imag), vectors[-1].real
        if omega <= 0.0:
            raise ValueError(f"mode {self.mode} does not oscillate: its eigenvalue is {s[-1]:.3g}")
        twists = state.twists(vector.astype(np.complex128)).real
        return omega, np.asarray(twists / np.sqrt(vector @ (pencil.M @ vector)))

    def __str__(self) -> str:
        """Description with the number of the mode."""
        return f"frequency of mode {self.mode}"
