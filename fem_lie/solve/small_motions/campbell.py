"""Campbell diagram and critical speeds of a rotor."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from fem_lie._arrays import Array, numbers, whole
from fem_lie.results.vibrations.campbell import CampbellDiagram
from fem_lie.results.vibrations.modes import Complex
from fem_lie.scene import Scene
from fem_lie.solve.progress_bars import Stopwatch, step_bar
from fem_lie.solve.small_motions.whirl import Shaft

_ACCURATE = 1e-10  # of a critical speed
_ROUGH = 1e-4
_DAMPED = 1e-6  # growth over the speed


def campbell(
    scene: Scene,
    axis: npt.ArrayLike,
    speeds: npt.ArrayLike,
    pairs: int = 2,
    *,
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    petsc_options_prefix: str = "fem_lie_campbell_",
) -> CampbellDiagram:
    """Whirl frequencies of a rotor over its speed, in the fixed frame, and critical speeds.

    The rotor is linearised about its steady rotation at each speed, with gyroscopic and centrifugal
    forces of all bodies. It is the same in all directions across its axis, as are its bearings:
    joints to ground, or springs in two directions. Ground rotates with it. Critical speeds are
    located to 1e-10 where a forward line crosses the synchronous one between two speeds.

    Args:
        scene: The rotor, with all nodes on its axis, and its bearings.
        axis: Vector along the axis; speeds are positive about it.
        speeds: Angular velocities, rad per time, ≥ 0, ascending, shape (k,).
        pairs: Number of forward, and of backward whirl modes.
        about: A point on the axis.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Invalid arguments, nodes away from the axis, a rotor or bearings that differ in
            directions across it, no bearings, dampers to ground, or fewer whirl modes.
        ConvergenceError: No steady rotation, or modes that are not found.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> shaft = fl.Beam.straight(
        ...     (0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, steel), cells=4
        ... )
        >>> scene = fl.Scene()
        >>> _ = scene.add(shaft)
        >>> _ = scene.add(fl.Clamp(shaft.point("start")))
        >>> diagram = fl.stability.campbell(scene, (1, 0, 0), [0.0, 100.0], pairs=1)
        >>> diagram.forward.shape
        (2, 1)
    """
    speeds, watch = ascending(speeds), Stopwatch()
    whole(pairs, "pairs")
    shaft = Shaft.of(scene, axis, about)

    @cache
    def at(speed: float) -> tuple[Complex, Complex]:
        return shaft.whirl(speed, pairs, petsc_options_prefix)

    # rotors that move freely, or that are not the same in all directions, are recognised at rest
    at(0.0)
    found = []
    with step_bar("Campbell diagram", "speed", len(speeds)) as show:
        for speed in speeds:
            found.append(at(float(speed)))
            show(f"{speed:g}")
    forward, backward = (np.array(lines) for lines in zip(*found, strict=True))

    def ahead(speed: float, line: int) -> float:
        """Whirl frequency of a forward line less the speed."""
        return float(at(speed)[0][line].imag) - speed

    critical = []
    before, after = forward[:-1].imag - speeds[:-1, None], forward[1:].imag - speeds[1:, None]
    for k, line in np.argwhere((before > 0.0) & (after <= 0.0)):
        ends = float(speeds[k]), float(speeds[k + 1])
        root = brentq(ahead, *ends, (int(line),), xtol=_ROUGH * ends[1])
        if abs(at(root)[0][line].real) > _DAMPED * root:
            near = {"xtol": _ACCURATE * ends[1], "rtol": _ACCURATE}
            critical.append(float(brentq(ahead, *ends, (int(line),), **near)))
            continue
        for _ in range(2):
            root = shaft.synchronous(root, petsc_options_prefix)
        critical.append(root)
    return CampbellDiagram(speeds, forward, backward, np.sort(critical), watch.seconds)


def ascending(speeds: npt.ArrayLike) -> Array:
    """Check speeds: finite, ≥ 0 and ascending, shape (k,)."""
    found = numbers(speeds, "speeds")
    if found.ndim != 1 or not len(found) or not (np.isfinite(found) & (found >= 0)).all():
        raise ValueError(f"speeds must be one or more angular velocities ≥ 0, got {speeds!r}")
    if (np.diff(found) <= 0).any():
        raise ValueError(f"speeds must be ascending, got {speeds!r}")
    return found
