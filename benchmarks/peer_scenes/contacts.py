"""Scenes in which balls touch walls, described in numbers, and where their probes end exactly.

Descriptions are those of rigid bodies (``descriptions``), with ``balls`` and ``walls`` fixed to
bodies or to ground (body None). Each ball touches each wall, and if all ``touch`` those of other
bodies. ``friction`` is Coulomb's coefficient,
``restitution`` Newton's. Compliant contacts have springs and dampers, whose natural ``frequency``
(of the mass that each ball carries, rad/s) grows as steps become smaller, so that they approach
rigid ones; ``damping_ratio`` gives the same restitution.
"""

from __future__ import annotations

from math import atan2, cos, exp, hypot, log, pi, sin, sqrt
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from benchmarks import piles
from demos import rod_in_box

Description = dict[str, Any]
Array = npt.NDArray[np.float64]
GRAVITY = 9.81
RESOLVED, USUAL = 0.3, 1e-3
"""Natural frequency of compliant contacts times the step (ten steps in an undamped impact), at the
usual step (s) where it is resolved better with smaller steps."""


def damping_ratio(restitution: float) -> float:
    """Of a spring and a damper that push and never pull, and rebound with this restitution.

    Schwager & Pöschel, Granular Matter 9 (2007), equation 17: the contact ends where its force is
    zero, before the overlap is. Without restitution it is critical, which rebounds with exp(-2).
    """
    if restitution == 0.0:
        return 1.0

    def rebound(zeta: float) -> float:
        root = sqrt(1 - zeta**2)
        angle = atan2(2 * zeta * root, 1 - 2 * zeta**2)
        return exp(-zeta / root * (pi - angle)) - restitution

    return float(brentq(rebound, 0.0, 1 - 1e-9)) if restitution < 1.0 else 0.0


def pulling_damping_ratio(restitution: float) -> float:
    """The same of a spring and a damper that also pull, as long as there is overlap: Exudyn's."""
    if restitution == 0.0:
        return 1.0
    return -log(restitution) / hypot(pi, log(restitution))


def compliant(scene: Description, step: float) -> Description:
    """Springs and dampers of a step, for a request.

    The restitution that an impact has in the numbers depends on how many steps it lasts, so that
    with restitution this number grows as the stiffness does: errors of both fall equally fast.
    """
    ratio, shortest = damping_ratio(scene["restitution"]), step
    if scene["restitution"]:
        shortest = sqrt(step * USUAL)
    pulling = pulling_damping_ratio(scene["restitution"])
    law = {"damping_ratio": ratio, "pulling_damping_ratio": pulling}
    return law | {"frequency": RESOLVED / shortest}


def body(mass: float, inertia: Any, centre: Any, velocity: Any = (0, 0, 0)) -> Description:
    """One that does not spin."""
    numbers = {"inertia": inertia, "centre": centre, "velocity": velocity, "spin": np.zeros(3)}
    return {"mass": mass} | {name: np.asarray(v, float).tolist() for name, v in numbers.items()}


def floor() -> Description:
    return {"body": None, "at": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}


# --- a ball that slides, then rolls ---------------------------------------------------------------

BALL, BALL_MASS, THROWN, SPUN, SLIDING = 0.05, 0.5, (1.0, 0.0, 0.0), (12.0, -4.0, 0.0), 0.2


def thrown() -> Description:
    """A ball on the floor whose slip is not along its velocity, so that its path is a parabola."""
    J = 0.4 * BALL_MASS * BALL**2
    ball = body(BALL_MASS, [J, J, J], (0, 0, BALL), THROWN) | {"spin": list(SPUN)}
    return {
        "bodies": [ball],
        "joints": [],
        "gravity": [0.0, 0.0, -GRAVITY],
        "balls": [{"body": 0, "at": [0.0, 0.0, BALL], "radius": BALL}],
        "walls": [floor()],
        "friction": SLIDING,
        "restitution": 0.0,
        "probe": {"body": 0, "at": [0.0, 0.0, BALL]},
    }


def thrown_end(time: float) -> Array:
    """Centre of the thrown ball.

    Friction has the constant direction of the first slip, whose speed falls by 7/2 μ g.
    """
    slip = np.array(THROWN) - BALL * np.cross(SPUN, (0, 0, 1))
    speed = float(np.linalg.norm(slip))
    slows = -SLIDING * GRAVITY * slip / speed
    slides = min(time, 2 * speed / (7 * SLIDING * GRAVITY))
    rolls = time - slides
    v = np.array(THROWN)
    return np.array([0, 0, BALL]) + v * time + slows * (slides**2 / 2 + slides * rolls)


# --- a ball that bounces --------------------------------------------------------------------------

DROP, REBOUND = 0.2, 0.8


def dropped() -> Description:
    """A ball above the floor."""
    scene = thrown()
    scene["bodies"][0] |= {"velocity": [0.0] * 3, "spin": [0.0] * 3}
    for given in (scene["bodies"][0]["centre"], scene["balls"][0]["at"], scene["probe"]["at"]):
        given[2] += DROP
    return scene | {"friction": 0.0, "restitution": REBOUND}


def dropped_end(time: float) -> Array:
    """Centre of the dropped ball, after as many impacts as there have been."""
    flight = sqrt(2 * DROP / GRAVITY)
    left, height, up = time - flight, DROP, 0.0
    if left > 0:
        up, height = REBOUND * GRAVITY * flight, 0.0
        while left > 2 * up / GRAVITY:
            left -= 2 * up / GRAVITY
            up *= REBOUND
    else:
        left = time
    return np.array([0, 0, BALL + height + up * left - GRAVITY * left**2 / 2])


# --- a block that slides down a slope, and stops --------------------------------------------------

EDGES, FOOT, BLOCK_MASS, SLOPE, PUSHED, HOLDS = (0.2, 0.1, 0.06), 0.01, 1.0, 15.0, 1.0, 0.5


def block() -> Description:
    """A block on four round feet, on a slope along x; axes are those of the slope."""
    a, b, c = EDGES
    J = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) * BLOCK_MASS / 12
    centre, angle = (0.0, 0.0, 2 * FOOT + c / 2), np.deg2rad(SLOPE)
    feet = [
        {"body": 0, "at": [x * a / 2, y * b / 2, FOOT], "radius": FOOT}
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    return {
        "bodies": [body(BLOCK_MASS, J, centre, (PUSHED, 0, 0))],
        "joints": [],
        "gravity": [GRAVITY * sin(angle), 0.0, -GRAVITY * cos(angle)],
        "balls": feet,
        "walls": [floor()],
        "friction": HOLDS,
        "restitution": 0.0,
        "probe": {"body": 0, "at": list(centre)},
    }


def block_end(time: float) -> Array:
    """Centre of the block, which stays where it has stopped."""
    angle = np.deg2rad(SLOPE)
    slows = GRAVITY * (HOLDS * cos(angle) - sin(angle))
    t = min(time, PUSHED / slows)
    return np.array([PUSHED * t - slows * t**2 / 2, 0.0, 2 * FOOT + EDGES[2] / 2])


# --- a pile of balls ------------------------------------------------------------------------------


def pile(count: int, probe: int) -> Description:
    """Balls of benchmarks/piles.py that fall into a box; ``probe`` is one of them."""
    given = piles.in_box(count)
    (radius,) = set(given.radii)
    mass = float(piles.masses_of(radius))
    moments = np.full(3, 0.4 * mass * radius**2)
    walls = [{"body": None, "at": a.tolist(), "normal": n.tolist()} for a, n in given.walls]
    return {
        "bodies": [body(mass, moments, at) for at in given.positions],
        "joints": [],
        "gravity": given.gravity.tolist(),
        "balls": [
            {"body": k, "at": at.tolist(), "radius": float(radius)}
            for k, at in enumerate(given.positions)
        ],
        "walls": walls,
        "touch": True,
        "friction": piles.FRICTION,
        "restitution": 0.0,
        "probe": {"body": probe, "at": given.positions[probe].tolist()},
    }


# --- the rod in a box -----------------------------------------------------------------------------


def rod_with_balls(friction: float = 0.2) -> Description:
    """demos/rod_in_box.py with balls at the ends of the rod, without gravity on the box."""
    scene, *_ = rod_in_box.rod_in_box("spheres", rod_in_box.Impact(friction))
    rod, box = scene.bodies
    axes = rod.frames[0, 1:]
    edges = np.array([rod_in_box.LENGTH, rod_in_box.SIDE, rod_in_box.SIDE])
    own = np.diag(rod_in_box.box_inertia(rod_in_box.MASS, edges))
    masses = [rod_in_box.DENSITY * float(e.prod()) for e in (rod_in_box.OUTER, rod_in_box.INNER)]
    outer, inner = (
        rod_in_box.box_inertia(m, e)
        for m, e in zip(masses, (rod_in_box.OUTER, rod_in_box.INNER), strict=True)
    )
    weight = [0.0, 0.0, -rod_in_box.GRAVITY * rod_in_box.MASS]
    falls = body(rod_in_box.MASS, axes.T @ own @ axes, rod.frames[0, 0]) | {"force": weight}
    centre = box.frames[0, 0]
    sides = [sign * np.eye(3)[k] for k in range(3) for sign in (-1, 1)]
    return {
        "bodies": [falls, body(masses[0] - masses[1], outer - inner, centre)],
        "joints": [],
        "gravity": [0.0, 0.0, 0.0],
        "balls": [
            {"body": 0, "at": end.tolist(), "radius": rod_in_box.SIDE / 2}
            for end in (rod_in_box.FIRST, rod_in_box.SECOND)
        ],
        "walls": [
            {
                "body": 1,
                "at": (centre + side * rod_in_box.INNER / 2).tolist(),
                "normal": (-side).tolist(),
            }
            for side in sides
        ],
        "friction": friction,
        "restitution": 0.0,
        "probe": {"body": 0, "at": rod_in_box.FIRST.tolist()},
    }
