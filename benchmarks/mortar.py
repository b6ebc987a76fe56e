"""Mortar contact along lines: patch tests, Hertz-like pressure, belts on drums, crossed cables.

    python -m benchmarks.mortar

- Patch test: two beams with 7 and 5 elements, the lower one on an elastic foundation, are pressed
  against each other by an even load. The pressure is even. So it is where a beam lies askew on
  faces of a shell that is held.
- Hertz-like: a cylinder of radius R is pressed by d into a line on an elastic foundation, k per
  area. The pressure is ``k (d − x²/2R)`` for ``|x| < a = √(2 R d)``, the force ``4/3 k a d``.
- A belt is pulled around half of a drum without friction: the pressure is T/R per length.
- The belt is pulled around half of the drum with friction: on its surface, in a distance b from
  the axis, so that shear forces ``Q = −μ p b`` bend it back. With ``r = R + b`` the tension grows
  by ``exp(λ φ)``, ``λ (r + μ b λ) = μ R``, which is ``exp(μ φ)`` for thin belts.
- Two taut cables of length 2 L, tension T and extensional stiffness EA cross at a right angle. One
  of them is moved by d against the other: the force is ``2 (T + EA ε) δ/ℓ`` with ``δ = d/2``,
  ``ℓ² = L² + δ²`` and ``ε = ℓ/L − 1`` along the taut length.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.polynomial.legendre import leggauss

import fem_lie as fl

Law: TypeAlias = fl.contact.Penalty | fl.contact.MortarPenalty

LOAD, SOFT, RADIUS = 10.0, 0.1, 0.01  # N/m, N/m^2, m
FOUNDATION = 1e3  # N/m^2
HALF_LENGTH, WHEEL, DEEP = 0.1, 5.0, 2e-4  # m
DRUM, BELT, TENSION = 0.1, 1e-3, 1.0
ROPE, PULLED, FRICTION = 2e-4, 2e-3, 0.3
HALF, CABLE, TAUT, EXTENSION, MOVED = 0.5, 2e-3, 100.0, 1e4, 0.04
DOWN = np.array([[0.0, 0.0, -1.0], *np.zeros((3, 3))])


def guided(scene: fl.Scene, beam: fl.Beam, stiffness: float, load: float) -> None:
    """Nodes that move along z only, on springs and under loads per length."""
    cells = len(beam.model.elements)
    for node in range(cells + 1):
        length = beam.model.lengths.sum() / cells * (0.5 if node in (0, cells) else 1.0)
        joint = scene.add(fl.joints.Prismatic(fl.ground(), beam.point(node), axis=(0, 0, 1)))
        scene.add(fl.joints.Spring(joint.displacement, stiffness=stiffness * length))
        scene.add(fl.PointLoad(beam.point(node), force=(0, 0, -load * length)))


def pressed(law: Law, cells: tuple[int, int] = (7, 5)) -> dict[str, float]:
    """How uneven the pressure of two beams of 1 m is over its mean, and the force.

    The lower beam sinks by the pressure over the stiffness of its foundation at each node.
    """
    section = fl.Section.circle(RADIUS, fl.Material(1e9, 0.3, 1000.0))
    scene, lines = fl.Scene(), []
    for z, count, stiffness, load in (
        (2 * RADIUS, cells[0], SOFT, LOAD),
        (0.0, cells[1], FOUNDATION, 0.0),
    ):
        beam = scene.add(fl.Beam.straight((0, 0, z), (1, 0, z), section, cells=count))
        guided(scene, beam, stiffness, load)
        lines.append(fl.contact.Line(beam, RADIUS))
    contact = scene.add(fl.contact.Contact(*lines, law))
    rest = fl.statics(scene)
    expected = LOAD / (FOUNDATION + SOFT)
    lower = rest.frames[-1][cells[0] + 1 : sum(cells) + 2, 0, 2]
    return {
        "uneven": float(np.ptp(lower) / expected),
        "force": float(fl.post.contact_forces(rest, contact).total[-1][2]),
        "expected": FOUNDATION * expected,
        "iterations": int(rest.iterations[-1]),
    }


def askew(law: Law) -> float:
    """How uneven the force per length of a beam is that lies across faces of a held shell."""
    section = fl.Section.circle(RADIUS, fl.Material(1e9, 0.3, 1000.0))
    start, end = np.array([0.0, -0.05, 2 * RADIUS]), np.array([1.0, 0.12, 2 * RADIUS])
    beam = fl.Beam.straight(start, end, section, cells=7)
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([1.2 * a - 0.1, 0.4 * b - 0.2, 0.0]), (5, 3)
    )
    shell = fl.Shell(mesh, fl.ShellSection.layer(2 * RADIUS, fl.Material(5e8, 0.3, 1000.0)))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(shell)
    guided(scene, beam, SOFT, LOAD)
    for node in range(len(shell.frames)):
        scene.add(fl.Clamp(shell.point(node)))
    surfaces = fl.contact.Line(beam, RADIUS), fl.contact.ShellSurface(shell)
    contact = scene.add(fl.contact.Contact(*surfaces, law))
    found = fl.post.contact_forces(fl.statics(scene), contact)
    last = found.states == found.count - 1
    element = (7 * found.positions[last, 0]).astype(int)
    forces = np.bincount(element, found.forces[last, 2])
    return float(np.ptp(forces) / forces.mean())


def hertz(law: Law, cells: int = 80) -> dict[str, float]:
    """Errors of the force and of the largest pressure of a cylinder on an elastic foundation."""
    section = fl.Section.from_stiffness([1e-4, 1e-4, 1e-4, 1e-9, 1e-9, 1e-9])
    scene, length = fl.Scene(), HALF_LENGTH
    line = scene.add(fl.Beam.straight((-length, 0, 0), (length, 0, 0), section, cells=cells))
    guided(scene, line, FOUNDATION, 0.0)
    wheel = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), (0, 0, RADIUS + WHEEL)))
    start = wheel.frames[0].copy()
    motion = fl.PrescribedMotion(wheel.point("centre"), lambda factor: start + factor * DEEP * DOWN)
    scene.add(motion)
    surface = fl.contact.Cylinder(wheel.point("centre"), (0, 0.4, 0), WHEEL)
    contact = scene.add(fl.contact.Contact(fl.contact.Line(line, RADIUS), surface, law))
    rest = fl.statics(scene, load_steps=4)
    force = float(abs(fl.post.contact_forces(rest, contact).total[-1][2]))
    deepest = float(-rest.frames[-1][cells // 2, 0, 2])
    half = np.sqrt(2 * (WHEEL + RADIUS) * DEEP)
    return {
        "force": float(force / (4 / 3 * FOUNDATION * half * DEEP) - 1.0),
        "pressure": deepest / DEEP - 1.0,
        "iterations": int(rest.iterations[-1]),
    }


def laid(radius: float, tail: float) -> Callable[[float], tuple[float, float, float]]:
    """Half a circle with straight tails at both ends."""

    def position(s: float) -> tuple[float, float, float]:
        along = s * (np.pi * radius + 2 * tail) - tail
        turned = min(max(along / radius, 0.0), np.pi)
        beyond, c, n = along - turned * radius, np.cos(turned), np.sin(turned)
        return radius * c - beyond * n, radius * n + beyond * c, 0.0

    return position


def capstan(
    law: fl.contact.Penalty | fl.contact.MortarPenalty, cells: int = 40, thick: float = ROPE
) -> dict[str, float]:
    """Error of the ratio of tensions of a belt that slips around half of a drum."""
    radius = DRUM + thick - 6e-6
    section = fl.Section.from_stiffness([1e4, 3e3, 3e3, 1e-5, 1e-5, 1e-5])
    element = fl.elements.GeodesicBeam(bending_flexibility=False)
    curve = laid(radius, 3 * np.pi * radius / cells)
    rope = fl.Beam.curve(curve, section, cells=cells + 6, formulation=element)
    start, scene = rope.frames[-1], fl.Scene()
    along = np.array([start[1], *np.zeros((3, 3))])
    scene.add(rope)
    motion = fl.PrescribedMotion(rope.point("end"), lambda factor: start + factor * PULLED * along)
    scene.add(motion)
    scene.add(fl.PointLoad(rope.point("start"), force=-TENSION * rope.frames[0, 1]))
    drum = fl.contact.Cylinder(fl.ground(), (0, 0, 0.4), DRUM)
    scene.add(fl.contact.Contact(fl.contact.Line(rope, thick), drum, law))
    rest = fl.statics(scene, load_steps=10)
    ratio = float(rest.reaction(motion)[-1, :3] @ start[1]) / TENSION
    μ, across = law.friction, DRUM + thick
    grows = (np.sqrt(across**2 + 4 * μ**2 * thick * DRUM) - across) / (2 * μ * thick)
    return {
        "error": float(ratio / np.exp(grows * np.pi) - 1.0),
        "of thin belts": float(ratio / np.exp(μ * np.pi) - 1.0),
        "iterations": int(rest.iterations[-1]),
    }


def belt(law: Law, cells: int = 40) -> dict[str, float]:
    """Pressure over T/R in the middle half of the arc: mean and largest errors."""
    radius, tail = DRUM + 0.999 * BELT, 3 * np.pi * DRUM / cells
    section = fl.Section.from_stiffness([1e4, 1e3, 1e3, 1e-5, 1e-5, 1e-5])
    rope = fl.Beam.curve(laid(radius, tail), section, cells=cells + 6)
    scene = fl.Scene()
    scene.add(rope)
    scene.add(fl.Clamp(rope.point("end")))
    scene.add(fl.PointLoad(rope.point("start"), force=(0, -TENSION, 0)))
    drum = fl.contact.Cylinder(fl.ground(), (0, 0, 0.4), DRUM)
    contact = scene.add(fl.contact.Contact(fl.contact.Line(rope, BELT), drum, law))
    rest = fl.statics(scene, load_steps=2)
    forces = fl.post.contact_forces(rest, contact)
    last = forces.states == forces.count - 1
    X, F = forces.positions[last], np.linalg.norm(forces.forces[last], axis=1)
    angle = np.arctan2(X[:, 1], X[:, 0])
    inner = np.flatnonzero(np.abs(angle - np.pi / 2) < np.pi / 4)
    inner = inner[np.argsort(angle[inner])]
    spans = np.diff(angle[inner]) * (DRUM + BELT)
    weights = 0.5 * leggauss(3)[1]
    # Gauss points of whole elements: the wider distances are those within an element
    first = inner[np.argmax(spans > spans.max() * 0.99) :][: 3 * (len(inner) // 3 - 1)]
    elements = F[first[: len(first) // 3 * 3]].reshape(-1, 3)
    length = float(rope.model.lengths[cells // 2])
    pressures = elements / (weights * length) * (DRUM + BELT) / TENSION
    return {
        "mean": float(pressures.mean() - 1.0),
        "largest": float(np.abs(pressures - 1.0).max()),
        "iterations": int(rest.iterations[-1]),
    }


def moved_down(start: np.ndarray) -> Callable[[float], np.ndarray]:
    """Motion of a frame by the displacement of the end of a cable."""
    return lambda factor: start + factor * MOVED * DOWN


def crossed(law: Law, cells: int = 41) -> dict[str, float]:
    """Contact force of two cables, whose elements are finer where they touch; its error."""
    section = fl.Section.from_stiffness([EXTENSION, 1e3, 1e3, 1e-4, 1e-4, 1e-4])

    def cable(axis: int, z: float) -> fl.Cable:
        def position(s: float) -> np.ndarray:
            s, x = 2 * s - 1, np.array([0.0, 0.0, z])
            x[axis] = HALF * (0.05 * s + 0.95 * s**3)
            return x

        length = 2 * HALF / (1 + TAUT / EXTENSION)
        return fl.Cable.curve(position, section, cells=cells, length=length)

    upper, lower, scene = cable(0, 2 * CABLE), cable(1, 0.0), fl.Scene()
    for body in (upper, lower):
        scene.add(body)
    for end, node in (("start", 0), ("end", cells)):
        scene.add(fl.joints.Spherical(fl.ground(), lower.point(end)))
        held = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), upper.frames[node, 0]))
        motion = moved_down(held.frames[0].copy())
        scene.add(fl.PrescribedMotion(held.point("centre"), motion))
        scene.add(fl.joints.Spherical(held.point("centre"), upper.point(end)))
    lines = fl.contact.Line(upper, CABLE), fl.contact.Line(lower, CABLE)
    contact = scene.add(fl.contact.Contact(*lines, law))
    rest = fl.statics(scene, load_steps=4)
    force = float(fl.post.contact_forces(rest, contact).total[-1][2])
    deep = 0.5 * MOVED
    length = float(np.hypot(HALF, deep))
    tension = TAUT + (EXTENSION + TAUT) * (length / HALF - 1)
    expected = 2 * tension * deep / length
    return {"force": force, "error": force / expected - 1.0, "iterations": int(rest.iterations[-1])}


def main() -> dict[str, dict[str, float]]:
    """All figures."""
    mortar, penalty = fl.contact.Mortar, fl.contact.MortarPenalty
    found = {
        "two beams, multipliers": pressed(mortar(1e5)),
        "two beams, mortar penalty": pressed(penalty(1e5)),
        "two beams, penalty": pressed(fl.contact.Penalty(1e5)),
        "askew on a shell, multipliers": {"uneven": askew(mortar(1e5))},
        "askew on a shell, mortar penalty": {"uneven": askew(penalty(1e5))},
        "Hertz-like, multipliers": hertz(mortar(1e6)),
        "Hertz-like, mortar penalty": hertz(penalty(1e6)),
        "belt, multipliers": belt(mortar(1e8)),
        "belt, multipliers, k = 1e7, 1e9": {
            "iterations": float(max(belt(mortar(k))["iterations"] for k in (1e7, 1e9)))
        },
        "belt, mortar penalty": belt(penalty(1e6)),
        "belt, penalty": belt(fl.contact.Penalty(1e6)),
        "belt that slips, 20 elements": capstan(penalty(1e6, FRICTION), 20),
        "belt that slips, 40 elements": capstan(penalty(1e6, FRICTION)),
        "belt that slips, thick": capstan(penalty(1e6, FRICTION), thick=5e-3),
        "belt that slips, penalty": capstan(fl.contact.Penalty(1e6, friction=FRICTION)),
        "crossed cables, 20 elements": crossed(mortar(1e7), 20),
        "crossed cables, 41 elements": crossed(mortar(1e7)),
        "crossed cables, 41 elements, penalty": crossed(fl.contact.Penalty(1e8)),
    }
    for name, figures in found.items():
        print(f"{name:40}", ", ".join(f"{key} {value:.4g}" for key, value in figures.items()))
    return found


if __name__ == "__main__":
    main()
