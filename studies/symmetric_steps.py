"""Steps that follow the speed, chosen symmetrically or not: energy over long times, and errors.

A rigid body that tumbles on an eccentric orbit, attracted by ``1/r²``: its centre moves on Kepler's
ellipse with the period 2π, a = 1 and e = 0.8, nine times as fast at one end as at the other. And a
soft bar that falls from the horizontal and swings, with a hinge at its end. Both by the variational
scheme, with the sizes of ``SymmetricStep``, with the same monitor taken from the last step only,
as is usual, and with as many constant steps. (E. Hairer & G. Söderlind, SIAM J. Sci. Comput. 26
(2005) 1838.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl
from fem_lie.extend import SymmetricControl
from fem_lie.schemes import SymmetricStep

ECCENTRICITY = 0.8
SLOWEST = 10.0
"""Largest step over the distance, in units of the orbit."""
SOFT = fl.Material(E=2e7, nu=0.3, density=1200.0)
RECORD = fl.schemes.Record.ENERGIES | fl.schemes.Record.MOMENTA


class Late(SymmetricControl):
    """The size that the last step should have had, as usual."""

    def observe(self, square: float, change: float) -> None:
        """Set the next size."""
        choice = self.choice
        self.coming = 0.5 * log(choice.largest**-2 + square / choice.distance**2)


@dataclass(frozen=True)
class LateStep(SymmetricStep):
    """Choice of sizes by :class:`Late`."""

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Late:
        """Control of a run."""
        return Late(self, (duration,), 1e-3 * self.largest, order)


@dataclass(frozen=True)
class Drift:
    """Energy of a run over the largest kinetic energy, and its angular momentum."""

    steps: int
    ratio: float
    swing: float
    drift: float
    angular: float

    def __str__(self) -> str:
        return (
            f"{self.steps:6d} steps, sizes 1 : {self.ratio:4.1f}, energy within {self.swing:.1e}, "
            f"drift {self.drift:+.1e}, angular momentum {self.angular:.1e}"
        )


def main(
    orbits: int = 80, swings: float = 50.0, distances: Sequence[float] = (0.04, 0.02, 0.01, 0.005)
) -> dict[str, dict[str, Drift] | list[tuple[int, float, float]]]:
    """Runs over long times, and errors of the orbit after 1.3 periods.

    Returns:
        The drifts of both scenes by the kind of steps, and rows of the number of steps and the
        errors of the position with symmetric and with constant steps.
    """
    cases = {
        "orbit": (orbit, 2.0 * pi * orbits, (0.04, 0.04 * SLOWEST)),
        "bar": (bar, swings, (0.008, 0.01)),
    }
    found: dict[str, dict[str, Drift] | list[tuple[int, float, float]]] = {}
    for name, (scene, duration, sizes) in cases.items():
        found[name] = runs = long_runs(scene, duration, *sizes)
        for kind, drift in runs.items():
            print(f"{name:6s} {kind:10s} {drift}")
    found["errors"] = rows = [errors(distance) for distance in distances]
    print(" steps  symmetric  constant  [a]")
    for row in rows:
        print("{:6d}  {:.2e}   {:.2e}".format(*row))
    return found


def orbit() -> fl.Scene:
    """A body that tumbles on an ellipse, from its far end."""
    scene, e = fl.Scene(), ECCENTRICITY
    body = scene.add(fl.RigidBody(1.0, (0.01, 0.02, 0.03), position=(1.0 + e, 0, 0), name="body"))
    body.add_velocity((0.0, sqrt((1.0 - e) / (1.0 + e)), 0.0))
    body.add_velocity(omega=(0.3, 1.0, 0.2), about=body.point("centre"))
    distance = fl.joints.Distance(fl.ground(), body.point("centre")).length
    attraction = {"law": lambda t, r, rate: 1.0 / r**2, "potential": lambda r: -1.0 / r}
    scene.add(fl.loads.ForceLaw(distance, **attraction))
    return scene


def exact(time: float) -> np.ndarray:
    """Its centre, from Kepler's equation; the near end is at −x."""
    e, mean = ECCENTRICITY, time + pi
    anomaly = brentq(lambda E: E - e * np.sin(E) - mean, mean - 2.0, mean + 2.0)
    return np.array([e - np.cos(anomaly), -sqrt(1.0 - e * e) * np.sin(anomaly), 0.0])


def bar() -> fl.Scene:
    """A soft bar that falls from the horizontal, with a hinge at one end."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    section = fl.Section.rectangle(0.02, 0.02, SOFT)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=4))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    return scene


def long_runs(
    scene: Callable[[], fl.Scene], duration: float, distance: float, largest: float
) -> dict[str, Drift]:
    """Symmetric and late steps, and as many constant ones."""
    found = {"symmetric": drift(scene(), duration, SymmetricStep(distance, largest))}
    found["late"] = drift(scene(), duration, LateStep(distance, largest))
    found["constant"] = drift(scene(), duration, duration / found["symmetric"].steps)
    return found


def drift(scene: fl.Scene, duration: float, step: float | SymmetricStep) -> Drift:
    """Difference of the mean energies of the last and the first quarter, and others."""
    result = fl.schemes.Variational().run(
        scene, duration=duration, step=step, record=RECORD, save_every=3, progress=False
    )
    sizes = np.array([step]) if result.steps is None else result.steps.sizes
    energy = (result.total_energy - result.total_energy[0]) / result.kinetic.max()
    quarters = np.searchsorted(result.times, duration * np.array([0.25, 0.75]))
    return Drift(
        steps=round(duration / sizes[0]) if result.steps is None else len(sizes),
        ratio=float(sizes.max() / sizes.min()),
        swing=float(np.abs(energy).max()),
        drift=float(energy[quarters[1] :].mean() - energy[: quarters[0]].mean()),
        angular=result.angular_momentum_error,
    )


def errors(distance: float, periods: float = 1.3) -> tuple[int, float, float]:
    """Number of steps, and errors of the position with symmetric and as many constant steps."""
    duration, count = 2.0 * pi * periods, 0
    step: float | SymmetricStep = SymmetricStep(distance, SLOWEST * distance)
    found = []
    for _ in range(2):
        result = fl.schemes.Variational().run(
            orbit(), duration=duration, step=step, save_every=10**6, progress=False
        )
        gap = result.position("body.centre")[-1] - exact(duration)
        found.append(float(np.linalg.norm(gap)))
        if result.steps is not None:
            count = len(result.steps.sizes)
        step = duration / count
    return count, *found


if __name__ == "__main__":
    main()
