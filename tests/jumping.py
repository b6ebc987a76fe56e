"""A mass on a spring under a load or a drive that jumps, in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

import fem_lie as fl

Numbers = npt.NDArray[np.float64]

SCHEMES = {
    "generalised alpha": fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10),
    "energy momentum": fl.EnergyMomentum(),
    "energy decaying": fl.EnergyDecaying(radius=0.5),
}
END, M, K = 1.0, 2.0, 80.0
AT_END, INSIDE = 0.3, 0.3137
ACCELERATION = 1.5
OMEGA = np.sqrt(K / M)


def oscillator(history: Callable[[float], float]) -> tuple[fl.Scene, fl.RigidBody]:
    """A mass on a spring under a force of size 4 that has this history."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(M, (0.1, 0.2, 0.3)))
    slide = scene.add(fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Spring(slide.displacement, K))
    scene.add(fl.PointLoad(body.point("centre"), force=(4.0, 0, 0), history=history))
    return scene, body


def driven(function: Callable[[float], float]) -> tuple[fl.Scene, fl.RigidBody]:
    """A cart that is driven, and a mass on a spring on it, which is returned."""
    scene = fl.Scene()
    cart = scene.add(fl.RigidBody(1.0, (0.1, 0.2, 0.3), name="cart"))
    body = scene.add(fl.RigidBody(M, (0.1, 0.2, 0.3)))
    slide = scene.add(fl.joints.Prismatic(fl.ground(), cart.point("centre"), axis=(1, 0, 0)))
    rail = scene.add(
        fl.joints.Prismatic(cart.point("centre"), body.point("centre"), axis=(1, 0, 0))
    )
    scene.add(fl.joints.Spring(rail.displacement, K))
    scene.add(fl.joints.Drive(slide.displacement, function))
    return scene, body


def after_step_force(t: Numbers, at: float) -> tuple[Numbers, Numbers]:
    """Displacement and velocity of the mass at rest that a force of 4 pulls from ``at`` on."""
    s = np.maximum(t - at, 0.0)
    return 4.0 / K * (1 - np.cos(OMEGA * s)), 4.0 / K * OMEGA * np.sin(OMEGA * s)


def after_acceleration(t: Numbers, at: float) -> tuple[Numbers, Numbers]:
    """Likewise of the mass on a cart that is accelerated from ``at`` on."""
    a = ACCELERATION
    s = np.maximum(t - at, 0.0)
    x = 0.5 * a * s**2 - a / OMEGA**2 * (1 - np.cos(OMEGA * s))
    return x, a * s - a / OMEGA * np.sin(OMEGA * s)
