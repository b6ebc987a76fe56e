"""Unbalance response of a rotor: forces that rotate with it are constant in its frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, vector
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.harmonic import Harmonic
from fem_lie.results.vibrations.modes import Complex
from fem_lie.results.vibrations.response import FrequencyResponse
from fem_lie.scene import Scene
from fem_lie.scene.nodal_loads import PointLoad
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.small_motions.campbell import ascending
from fem_lie.solve.small_motions.frequency_response import amplitudes
from fem_lie.solve.small_motions.whirl import Shaft
from fem_lie.solve.stability.equilibrium_state import small_motions

_ACROSS = 1e-9  # component of an unbalance along the axis
_ISOTROPIC = 1e-6


@dataclass(frozen=True, eq=False)
class Unbalance:
    """A small mass away from the axis of a rotor.

    Attributes:
        point: A point on the axis of the rotor.
        moment: Mass times the vector from the axis to it, in the initial configuration, global
            components, shape (3,).

    Example:
        >>> disc = fl.RigidBody(2.0, (1.0, 0.5, 0.5))
        >>> weight = fl.stability.Unbalance(disc.point("centre"), (0, 1e-4, 0))
    """

    point: Point
    moment: npt.ArrayLike

    def __post_init__(self) -> None:
        """Raise an error unless it is a point of a body and a vector that is not zero."""
        require_point(self.point, "Unbalance: point")
        if self.point.is_ground:
            raise ValueError("an unbalance needs a point of a body, got ground")
        if not vector(self.moment, 3, "Unbalance: moment").any():
            raise ValueError("Unbalance: moment must not be zero")


def unbalance_response(
    scene: Scene,
    axis: npt.ArrayLike,
    unbalances: Unbalance | Sequence[Unbalance],
    speeds: npt.ArrayLike,
    *,
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> FrequencyResponse:
    """Synchronous whirl of a rotor with unbalances, in the fixed frame.

    The centrifugal force of an unbalance is constant in the frame that rotates, where the rotor
    bends as in statics, with the stiffness of its steady rotation. Complex amplitudes are those of
    the motion in the fixed frame, with the phase of the rotor at the time when it is in its initial
    position.

    Args:
        scene: The rotor, as for :func:`~fem_lie.stability.campbell`.
        axis: Vector along the axis; speeds are positive about it.
        unbalances: One or several unbalances.
        speeds: Angular velocities, rad per time, ≥ 0, ascending, shape (k,).
        about: A point on the axis.

    Raises:
        ValueError: Invalid arguments, an unbalance along the axis, a rotor or bearings that differ
            in directions across it, nodes away from the axis, or dampers to ground.
        ConvergenceError: No steady rotation, or an unbounded response: a critical speed without
            damping, or a rotor that is free to move along or about its axis.
    """
    omega, watch = ascending(speeds), Stopwatch()
    given = [unbalances] if isinstance(unbalances, Unbalance) else list(unbalances)
    for each in given:
        instance(each, Unbalance, "unbalances", "one or several Unbalance(point, moment)")
    if not given:
        raise ValueError("expected an unbalance, got none")
    shaft = Shaft.of(scene, axis, about)
    moments = [np.asarray(each.moment, dtype=np.float64) for each in given]
    for moment in moments:
        if abs(moment @ shaft.axis) > _ACROSS * np.linalg.norm(moment):
            raise ValueError(f"an unbalance must be across the axis {shaft.axis}, got {moment}")
    bodies = _Bent(shaft, [each.point for each in given], moments)
    shapes = np.array([bodies.amplitudes(float(speed)) for speed in omega])
    return FrequencyResponse(omega, shapes, bodies.frames, bodies.info, watch.seconds)


class _Bent:
    """A rotor that is bent by its unbalances in the frame that rotates.

    Attributes:
        frames: The rotor without unbalances, shape (n, 4, 3).
        info: Bodies and joints.
    """

    def __init__(self, shaft: Shaft, points: list[Point], moments: list[Array]) -> None:
        self._shaft, self._points, self._moments = shaft, points, moments
        equations, state = small_motions(shaft.scene, None, Rotation(0.0 * shaft.axis, shaft.about))
        self.frames, self.info = equations.report(state.H).frames.copy(), equations.info

    def amplitudes(self, speed: float) -> Complex:
        """Complex amplitudes in the fixed frame, local increments of all nodes, shape (n, 6)."""
        axis, moments = self._shaft.axis, np.array(self._moments)
        equations, state = small_motions(
            self._shaft.scene, None, Rotation(speed * axis, self._shaft.about)
        )
        R, pencil = equations.report(state.H).frames[:, 1:], state.pencil()
        bent = []
        for turned in (moments, np.cross(axis, moments)):
            pairs = zip(self._points, turned, strict=True)
            loads = [PointLoad(point, force=speed**2 * moment) for point, moment in pairs]
            force = amplitudes(self._shaft.scene, state, loads).astype(np.complex128)
            try:
                twists = state.twists(Harmonic(pencil, force).direct(0.0)).real
            except ConvergenceError:
                raise ConvergenceError(
                    f"the response at the speed {speed:g} is unbounded: it is a critical speed "
                    "without damping, or the rotor is free to move along or about its axis. "
                    "Expected a bearing that holds these, for example a Universal joint"
                ) from None
            parts = twists.reshape(-1, 2, 3)
            bent.append(np.einsum("nki,nij->nkj", parts, R))
        quarter = np.cross(axis, bent[0])
        if np.abs(quarter - bent[1]).max() > _ISOTROPIC * np.abs(bent[1]).max():
            raise ValueError(
                "the rotor bends differently under unbalances in different directions: expected a "
                "rotor and bearings that are the same in all directions across the axis"
            )
        # cos Ωt and sin Ωt times both are the real part of this times exp(i Ω t)
        whirl = bent[0] - 1j * quarter
        return np.einsum("nkj,nij->nki", whirl, self.frames[:, 1:]).reshape(-1, 6)
