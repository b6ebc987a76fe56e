"""A contact surface of one's own: the inside of a torus, in which a bead slides.

A surface says by a gap function how far points are from it; normals, stiffness and forces over a
step follow by forward-mode differentiation. Balls touch it at once. What touches what is a table of
contact pairs by kinds of surfaces, to which a pair is added here, too: the vertices of a
polyhedron, since these are what touches a surface from within.

Across the tube a bead of radius a is a pendulum of length r − a; along it nothing brakes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import fem_lie as fl
from fem_lie.extend import (
    GAP_SIGNATURE,
    BallGapPair,
    GapSurface,
    PolyhedralSurface,
    callback,
    compiled,
    evaluate,
    register_contact_pair,
)


@compiled
def inside_torus(X, parameters):
    """Signed distance of a point from the wall of a tube about a ring in the plane z = 0."""
    x, y, z = X
    ring, tube = parameters
    across = math.sqrt(x * x + y * y) - ring
    return tube - math.sqrt(across * across + z * z)


@callback(GAP_SIGNATURE)
def gap(out, X, parameters):
    """The same with its derivatives."""
    evaluate(inside_torus, (0.0, 0.0), out, X, parameters)


@dataclass(frozen=True, eq=False)
class Torus(GapSurface):
    """The inside of a torus about the third axis of a point's frame."""

    point: fl.extend.Point
    ring: float
    tube: float

    gap = gap

    @property
    def parameters(self):
        """Both radii."""
        return self.ring, self.tube


register_contact_pair(PolyhedralSurface, Torus, BallGapPair)

RING, TUBE, BEAD, MASS, GRAVITY = 1.0, 0.3, 0.05, 0.2, 9.81
DEPTH = 1e-4  # of the bead at rest in the wall
LENGTH = TUBE - BEAD + DEPTH


def bead(angle: float, speed: float) -> tuple[fl.Scene, fl.RigidBody]:
    """A bead in a tube that is fixed, off the bottom by an angle, with a speed along the ring."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    position = (RING + LENGTH * math.sin(angle), 0.0, -LENGTH * math.cos(angle))
    body = scene.add(fl.RigidBody(MASS, 1e-4 * np.eye(3), position))
    body.add_velocity((0, speed, 0))
    law = fl.contact.Penalty(MASS * GRAVITY / DEPTH)
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(body.point("centre"), BEAD), Torus(fl.ground(), RING, TUBE), law
        )
    )
    return scene, body


def frequency(scheme: fl.GeneralisedAlpha | fl.EnergyMomentum) -> float:
    """Of small oscillations across the tube, from the times at which the bead is at the bottom."""
    scene, body = bead(ANGLE, speed=0.0)
    result = scheme.run(scene, duration=3.0, step=2e-3, progress=False)
    across, t = result.position(body.point("centre"))[:, 0] - RING, result.times
    k = np.flatnonzero(across[1:] * across[:-1] < 0.0)
    zeros = t[k] - across[k] * (t[k + 1] - t[k]) / (across[k + 1] - across[k])
    return float(np.pi / np.diff(zeros).mean())


def conserved() -> tuple[float, float]:
    """Relative errors of energy and of the moment of momentum about the axis, in an orbit."""
    scene, body = bead(0.3, speed=2.0)
    result = fl.EnergyMomentum().run(scene, duration=2.0, step=2e-3, progress=False)
    x = result.position(body.point("centre"))
    # of the means of steps, which are what conserving schemes move nodes by
    middle, velocity = 0.5 * (x[1:] + x[:-1]), np.diff(x, axis=0) / 2e-3
    moment = np.cross(middle, velocity)[:, 2]
    return result.balance_error, float(np.ptp(moment) / abs(moment[0]))


ANGLE = 0.02
EXACT = math.sqrt(GRAVITY / LENGTH) * (1.0 - ANGLE**2 / 16.0)
errors = {
    type(scheme).__name__: abs(frequency(scheme) / EXACT - 1.0)
    for scheme in (fl.GeneralisedAlpha(radius=1.0), fl.EnergyMomentum())
}
energy, moment = conserved()
print(", ".join(f"{name}: frequency {error:.0e}" for name, error in errors.items()))
print(f"in an orbit: energy {energy:.0e}, moment of momentum {moment:.0e}")
