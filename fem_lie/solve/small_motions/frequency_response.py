"""Frequency response: steady-state motion under harmonic loads and base excitation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, numbers, vector, whole
from fem_lie.linear.spectra.harmonic import Harmonic
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.vibrations.modes import Complex
from fem_lie.results.vibrations.response import FrequencyResponse
from fem_lie.scene import Scene
from fem_lie.scene.load import Load, StrainLoad
from fem_lie.scene.rotation import Rotation
from fem_lie.scene.scene import require_scene
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.stability.equilibrium_state import small_motions
from fem_lie.system.equations import Equations
from fem_lie.system.small_motions import SmallMotions


@dataclass(frozen=True, eq=False)
class BaseExcitation:
    """Harmonic acceleration of ground, and so of all supports.

    The response is relative to ground; damping in proportion to mass acts on that relative motion.

    Attributes:
        acceleration: Amplitude of the acceleration, global components, shape (3,).

    Example:
        >>> shaker = fl.post.BaseExcitation((0, 0, 9.81))
    """

    acceleration: npt.ArrayLike

    def __post_init__(self) -> None:
        """Raise ``ValueError`` unless the acceleration is three finite numbers, not all zero."""
        if not vector(self.acceleration, 3, "BaseExcitation: acceleration").any():
            raise ValueError("BaseExcitation: acceleration must not be zero")


Excitation: TypeAlias = Load | BaseExcitation


def frequency_response(
    scene: Scene,
    loads: Excitation | Sequence[Excitation],
    frequencies: npt.ArrayLike,
    *,
    in_quadrature: Excitation | Sequence[Excitation] = (),
    modes: int | None = None,
    at: StaticResult | None = None,
    spin: npt.ArrayLike = (0.0, 0.0, 0.0),
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int = 1,
    petsc_options_prefix: str = "fem_lie_response_",
) -> FrequencyResponse:
    """Steady-state harmonic motion about an equilibrium, with the damping of the scene.

    The loads are ``Re(f exp(i ω t))`` in addition to those of the scene, under which there is
    equilibrium. Without ``modes`` the linearised equations are factorised at each frequency; with
    it, they are solved in the span of the slowest modes without damping and of the direct solution
    at the lowest frequency, which is faster for many frequencies.

    Args:
        scene: The scene.
        loads: One or several loads without a history, not added to the scene, or base excitations.
            Their values are amplitudes, in phase.
        frequencies: Angular frequencies ``ω``, rad per time, ≥ 0, shape (k,).
        in_quadrature: Loads that lead those by a quarter of a period: ``Re(i f exp(i ω t))``.
        modes: Number of modes; default: no reduction.
        at: Equilibrium of this scene, the last state of it; its rotation is taken with it.
        spin: Angular velocity of the frame in which there is equilibrium, global components, rad
            per time; loads and response are relative to it.
        about: A point on its axis.
        load_steps: For statics.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Invalid scene or options, loads that act on nothing that can move, or more modes
            than degrees of freedom.
        ConvergenceError: No equilibrium, an unbounded response, or modes that are not found.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> damping = fl.sections.Damping(stiffness=1e-4)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4, damping=damping)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> _ = scene.add(fl.Clamp(beam.point("start")))
        >>> force = fl.PointLoad(beam.point("end"), force=(0, 0, 1.0))
        >>> response = fl.post.frequency_response(scene, force, [0.0, 50.0])
        >>> response.displacement(beam.point("end")).shape
        (2, 3)
    """
    require_scene(scene)
    omega, watch = _frequencies(frequencies), Stopwatch()
    parts = _several(loads, "loads"), _several(in_quadrature, "in_quadrature")
    if modes is not None:
        whole(modes, "modes")
    if not any(parts):
        raise ValueError("expected a load or a base excitation, got none")
    equations, state = small_motions(
        _with_inactive(scene, parts), at, Rotation.of(spin, about), load_steps
    )
    free = equations.unknowns.degrees_of_freedom
    if modes is not None and modes > free:
        raise ValueError(f"modes must be 1 … {free}, the degrees of freedom, got {modes}")
    pencil = state.pencil()
    for part in parts:
        state.rotation.check(scene.with_loads(*_of_bodies(part), gravity=_gravity(part)))
    in_phase, leading = (amplitudes(scene, state, part) for part in parts)
    force = in_phase + 1j * leading
    if not force.any():
        raise ValueError("the loads act on nothing that can move")
    harmonic = Harmonic(pencil, force)
    if modes is None:
        found = np.array([harmonic.direct(float(each)) for each in omega])
    else:
        # with damping the slowest modes need not be those that oscillate slowly
        undamped = replace(pencil, C=None)
        _, vectors, _ = smallest(undamped, modes, state.rate, petsc_options_prefix)
        found = harmonic.reduced(vectors, omega)
    return response(equations, state, omega, found, watch.seconds)


def response(
    equations: Equations, state: SmallMotions, frequencies: Array, found: Complex, seconds: float
) -> FrequencyResponse:
    """The result, from amplitudes of the free unknowns, shape (k, n)."""
    return FrequencyResponse(
        frequencies=frequencies,
        shapes=np.array([state.twists(vector) for vector in found]),
        frames=equations.report(state.H).frames.copy(),
        info=equations.info,
        seconds=seconds,
    )


def amplitudes(scene: Scene, state: SmallMotions, loads: Sequence[Excitation]) -> Array:
    """Forces of loads on the free unknowns of a state of the scene, shape (n,)."""
    loaded = scene.with_loads(*_of_bodies(loads), gravity=_gravity(loads))
    return state.forces(Equations(loaded, dynamics=True).prescribed(1.0).loads(state.H))


def _frequencies(frequencies: npt.ArrayLike) -> Array:
    omega = numbers(frequencies, "frequencies")
    if omega.ndim != 1 or not len(omega) or not (np.isfinite(omega) & (omega >= 0)).all():
        raise ValueError(
            f"frequencies must be one or more angular frequencies ≥ 0, got {frequencies!r}"
        )
    return omega


def _several(loads: Excitation | Sequence[Excitation], what: str) -> list[Excitation]:
    """The loads as a list.

    Raises:
        TypeError: One is neither a load nor a base excitation.
        ValueError: One has a history, or is a strain.
    """
    found = [loads] if isinstance(loads, Load | BaseExcitation) else list(loads)
    for load in found:
        instance(load, Load | BaseExcitation, what, "loads or base excitations")
        if isinstance(load, StrainLoad):
            raise ValueError(f"{what}: expected forces, got a strain ({type(load).__name__})")
        if isinstance(load, Load) and load.history is not None:
            raise ValueError(
                f"{what}: expected amplitudes, got a {type(load).__name__} on {load.where} with a "
                "history"
            )
    return found


def _of_bodies(loads: Sequence[Excitation]) -> list[Load]:
    return [each for each in loads if isinstance(each, Load)]


def _gravity(loads: Sequence[Excitation]) -> Array:
    """Gravity that acts as base excitations do, in the frame of the base."""
    of_base = (each.acceleration for each in loads if isinstance(each, BaseExcitation))
    return -sum((np.asarray(each, dtype=np.float64) for each in of_base), np.zeros(3))


def _with_inactive(scene: Scene, parts: tuple[list[Excitation], ...]) -> Scene:
    """The scene with the loads at amplitude zero: they may act on rotations held otherwise."""
    # every load is a dataclass, which its base class does not say
    harmonic: list[Any] = [load for part in parts for load in _of_bodies(part)]
    added = [replace(load, history=_zero) for load in harmonic]
    return scene.with_loads(*scene.loads, *added)


def _zero(time: float) -> float:
    del time
    return 0.0
