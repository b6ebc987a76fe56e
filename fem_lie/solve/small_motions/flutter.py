"""Flutter and divergence of equilibria under loads without a potential.

The eigenvalues of the equations of motion, linearised about the equilibrium at a load factor, are
computed at increasing factors until a motion grows. The first factor follows from the stiffness and
the stiffness of the loads, the others grow by a quarter, and the limit is located by bisection.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array, positive, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.results.vibrations.flutter import Instability, StabilityLimit
from fem_lie.results.vibrations.modes import Complex
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.equilibrium_state import small_motions
from fem_lie.solve.stability.linear_buckling import energy_radius, geometric_stiffness
from fem_lie.solve.statics.follow import check_proportion
from fem_lie.solve.statics.unstable import UnstableEquilibriumWarning
from fem_lie.system.equations import Equations

_MODES = 6  # by default
_GROWTH = 1.25  # of the load factor from one to the next
_FIRST = 0.5  # first load factor, over that at which loads change the stiffness by all of it
_FARTHEST = 1e3
_LOCATED = 1e-6  # relative
_UNSTABLE = 1e-7  # growth over the rate of a motion; less is round-off of nearly equal eigenvalues
_OSCILLATES = 1e-2  # frequency over the rate of the first motion


def flutter(
    scene: Scene,
    count: int | None = None,
    *,
    until: float | None = None,
    load_steps: int = 1,
    petsc_options_prefix: str = "fem_lie_flutter_",
) -> StabilityLimit:
    """The smallest load factor at which the equilibrium of a scene flutters or diverges.

    For follower forces, and other loads without a potential, an equilibrium may lose its stability
    by an oscillation that grows, while its tangent stiffness is regular. Inertia and damping of the
    scene matter: small damping may lower the load at which flutter begins.

    Args:
        scene: The scene, with its loads at factor 1.
        count: Number of slowest modes that are followed; default: six, or all degrees of freedom
            if they are fewer.
        until: Largest load factor; default: 1000 times that at which the loads change the stiffness
            by about all of it.
        load_steps: For statics at each load factor.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Invalid scene, no load, loads that are not in proportion to the load factor, no
            inertia, insufficient supports, or an equilibrium that is unstable without loads.
        ConvergenceError: The equilibrium is stable up to the largest factor, or it is not found at
            one of the factors.

    Example:
        >>> section = fl.Section.from_stiffness([1e6] * 3 + [1.0] * 3, mass=1.0, polar=1e-6)
        >>> column = fl.Rod.straight((0, 0, 0), (1, 0, 0), section, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(column)
        >>> _ = scene.add(fl.Clamp(column.point("start")))
        >>> _ = scene.add(fl.PointLoad(column.point("end"), (-1.0, 0, 0), following=True))
        >>> print(fl.stability.flutter(scene).kind)
        flutter
    """
    check_proportion(scene)
    if count is not None:
        whole(count, "count")
    largest = None if until is None else positive(until, "until")
    watch = Stopwatch()
    loads = _Loaded(scene, count, whole(load_steps, "load_steps"), petsc_options_prefix)
    first = _FIRST * loads.scale()
    largest = _FARTHEST * first if largest is None else largest
    stable, states = 0.0, [loads.at(0.0)]
    if states[0].growing is not None:
        raise ValueError("the equilibrium is unstable without loads")
    factor = min(first, largest)
    while (state := loads.at(factor)).growing is None:
        states.append(state)
        if factor >= largest:
            raise ConvergenceError(f"the equilibrium is stable up to the load factor {factor:g}")
        stable, factor = factor, min(_GROWTH * factor, largest)
    while factor - stable > _LOCATED * factor:
        middle = 0.5 * (stable + factor)
        found = loads.at(middle)
        if found.growing is None:
            stable = middle
            states.append(found)
        else:
            factor, state = middle, found
    states.append(state)
    assert state.growing is not None
    oscillates = abs(state.growing.imag) > _OSCILLATES * abs(states[0].eigenvalues[0])
    return StabilityLimit(
        factor=factor,
        kind=(Instability.FLUTTER if oscillates else Instability.DIVERGENCE).value,
        frequency=float(abs(state.growing.imag)) if oscillates else 0.0,
        factors=np.array([each.factor for each in states]),
        eigenvalues=np.array([each.eigenvalues for each in states]),
        seconds=watch.seconds,
    )


class _State(NamedTuple):
    """Eigenvalues at a load factor, and the fastest of those that grow, if any."""

    factor: float
    eigenvalues: Complex
    growing: complex | None


class _Loaded:
    """Eigenvalues of a scene at any load factor."""

    def __init__(self, scene: Scene, count: int | None, load_steps: int, prefix: str) -> None:
        """Check the number of modes."""
        self._scene, self._load_steps, self._prefix = scene, load_steps, prefix
        self._count = Equations(scene, dynamics=True).unknowns.mode_count(count, _MODES)

    def scale(self) -> float:
        """Load factor at which the loads change the stiffness by about all of it."""
        model = StableEquilibrium(self._scene, self._prefix)
        model.check_start(0.0)
        _, load = model.forces()
        model.factorise(0.0)
        K, _ = model.pencil()
        G = geometric_stiffness(model, K, model.solve_finely(load))
        K = (0.5 * (K + K.T)).tocsr()
        radius = sum(energy_radius(model, K, part) for part in (G.symmetric, G.skew))
        if not radius:
            raise ValueError("the loads do not change the stiffness of the scene")
        return float(G.factor / radius)

    def at(self, factor: float) -> _State:
        """Eigenvalues at a load factor."""
        # every load is a dataclass, which its base class does not say
        loads: list[Any] = list(self._scene.loads)
        grown = [replace(load, history=lambda time: factor * time) for load in loads]
        scene = self._scene.with_loads(*grown, gravity=factor * self._scene.gravity)
        still = Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        with warnings.catch_warnings():
            # states beyond the limit are expected
            warnings.simplefilter("ignore", UnstableEquilibriumWarning)
            _, state = small_motions(scene, None, still, self._load_steps)
        s, _, _ = smallest(state.pencil(), self._count, 0.0, self._prefix)
        return _State(factor, s, _growing(s))


def _growing(s: Array | Complex) -> complex | None:
    """The eigenvalue that grows fastest, if any does."""
    unstable = s[s.real > _UNSTABLE * np.abs(s)]
    return complex(unstable[unstable.real.argmax()]) if len(unstable) else None
