"""Energy and momenta of conserving steps over impacts: bodies, beams, lines and shells.

    python -m benchmarks.conserving_contact [--cases box corners beams lines5 lines90
        ball sheets slab] [--friction 0.3] [--long]

Nothing holds the bodies, so momentum and angular momentum stay, and energy but for what friction
takes, which is printed with the least that it takes in a step. Steps are given in periods of
contact, 2π √(m/k) with the mass that an impact moves. With ``--long`` the ball in the turning box
makes 10⁵ steps. Lines and shells have no friction in conserving schemes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import perf_counter

import numpy as np

import fem_lie as fl

SECTION = fl.Section.circle(0.02, fl.Material(2e8, 0.3, 1000.0))
LAYER = fl.ShellSection.layer(0.02, fl.Material(1e8, 0.3, 1000.0))
Case = tuple[fl.Scene, fl.contact.Contact]


def ball(position: tuple[float, ...], velocity: tuple[float, ...]) -> fl.RigidBody:
    body = fl.RigidBody(1.0, 4e-3 * np.eye(3), position)
    body.add_velocity(velocity)
    return body


def scene_of(*items: object) -> fl.Scene:
    scene = fl.Scene(gravity=(0, 0, 0))
    for item in items:
        scene.add(item)
    return scene


def box(k: float, μ: float = 0.0) -> Case:
    """A ball within a free box that turns."""
    outer, one = fl.RigidBody(3.0, np.diag([0.4, 0.6, 0.9])), ball((0.1, 0.05, 0), (1, 0.7, 0.4))
    outer.add_velocity(omega=(0.5, 1, 2), about=outer.point("centre"))
    outer.add_velocity((-1 / 3, -0.7 / 3, -0.4 / 3))
    inside = fl.contact.Box(outer.point("centre"), (1, 1, 1), inside=True)
    touch = fl.contact.Contact(
        fl.contact.Sphere(one.point("centre"), 0.1), inside, fl.contact.Penalty(k, friction=μ)
    )
    return scene_of(outer, one, touch), touch


def corners(k: float, μ: float = 0.0) -> Case:
    """A box that turns, with its corners on the face of another body."""
    table = fl.RigidBody(3.0, np.diag([0.4, 0.6, 0.9]))
    one = fl.RigidBody(1.0, np.diag([0.02, 0.03, 0.04]), (0.1, 0.05, 0.5))
    one.add_velocity(omega=(2, 1, 3), about=one.point("centre"))
    one.add_velocity((0, 0, -1))
    face = fl.contact.Plane(table.point("centre"), (0, 0, 1))
    touch = fl.contact.Contact(
        fl.contact.Box(one.point("centre"), (0.3, 0.4, 0.5)),
        face,
        fl.contact.Penalty(k, friction=μ),
    )
    return scene_of(table, one, touch), touch


def beams(k: float, μ: float = 0.0) -> Case:
    """A ball that is hit by the round nodes of a beam."""
    beam, one = (
        fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=6),
        ball((0.7, 0.2, 0.05), (0, 0, 0)),
    )
    beam.add_velocity((0, 5, 0))
    nodes = fl.contact.Vertices([fl.extend.Point(beam, n) for n in range(len(beam.frames))], 0.02)
    touch = fl.contact.Contact(
        nodes, fl.contact.Sphere(one.point("centre"), 0.15), fl.contact.Penalty(k, friction=μ)
    )
    return scene_of(beam, one, touch), touch


def lines(k: float, angle: float, μ: float) -> Case:
    """Two beams across each other that meet and slide."""
    c, s = 0.5 * np.cos(np.radians(angle)), 0.5 * np.sin(np.radians(angle))
    lower = fl.Beam.straight((-0.5, 0, 0), (0.5, 0, 0), SECTION, cells=6)
    upper = fl.Beam.straight((-c + 0.1, -s, 0.05), (c + 0.1, s, 0.05), SECTION, cells=6)
    upper.add_velocity((1, 0.5, -5))
    touch = fl.contact.Contact(
        fl.contact.Line(lower, 0.02),
        fl.contact.Line(upper, 0.02),
        fl.contact.Penalty(k, friction=μ),
    )
    return scene_of(lower, upper, touch), touch


def sheet(height: float, length: float, cells: int, slope: float = 0.0) -> fl.Shell:
    """Square, about the vertical axis."""

    def position(a: float, b: float) -> np.ndarray:
        x, y = length * (a - 0.5), length * (b - 0.5)
        return np.array([x, y, height + slope * (x + 0.5 * y)])

    return fl.Shell(fl.mesh.parametric_surface(position, (cells, cells)), LAYER)


def on_sheet(k: float, μ: float = 0.0) -> Case:
    """A ball thrown aslant on a free sheet."""
    one, lower = ball((0.1, 0.05, 0.115), (0.3, 0.2, -1)), sheet(0, 1, 6)
    surface = fl.contact.ShellSurface(lower, smooth=False)
    touch = fl.contact.Contact(
        fl.contact.Sphere(one.point("centre"), 0.1), surface, fl.contact.Penalty(k, friction=μ)
    )
    return scene_of(lower, one, touch), touch


def sheets(k: float, μ: float = 0.0) -> Case:
    """A sheet that comes down aslant on a wider one."""
    lower, upper = sheet(0, 1, 5), sheet(0.045, 0.5, 4, 0.05)
    upper.add_velocity((0.5, 0.2, -2))
    a, b = (
        fl.contact.ShellSurface(upper, smooth=False),
        fl.contact.ShellSurface(lower, smooth=False),
    )
    touch = fl.contact.Contact(a, b, fl.contact.Penalty(k, friction=μ))
    return scene_of(lower, upper, touch), touch


def slab(k: float, μ: float = 0.0) -> Case:
    """A sheet that comes down aslant on the face of a body."""
    table, upper = fl.RigidBody(3.0, np.diag([0.4, 0.6, 0.9])), sheet(0.035, 0.5, 4, 0.05)
    upper.add_velocity((0.5, 0.2, -2))
    face = fl.contact.Plane(table.point("centre"), (0, 0, 1))
    touch = fl.contact.Contact(
        face, fl.contact.ShellSurface(upper, smooth=False), fl.contact.Penalty(k, friction=μ)
    )
    return scene_of(table, upper, touch), touch


CASES: dict[str, tuple[Callable[..., Case], float, float, float]] = {
    "box": (box, 1e4, 0.75, 3.0),
    "corners": (corners, 1e4, 0.75, 3.0),
    "beams": (beams, 1e4, 0.2, 0.1),
    "lines90": (lambda k, μ=0.0: lines(k, 90.0, μ), 1e6, 0.2, 0.1),
    "lines5": (lambda k, μ=0.0: lines(k, 5.0, μ), 1e6, 0.2, 0.1),
    "ball": (on_sheet, 1e4, 0.75, 0.3),
    "sheets": (sheets, 1e6, 10.0, 0.2),
    "slab": (slab, 1e6, 6.0, 0.2),
}
"""Scene, stiffness, mass that moves, duration; of sheets both per area."""


def run(
    name: str, periods: float, scheme: fl.EnergyMomentum, μ: float, steps: int | None = None
) -> None:
    """Print a row of the table."""
    build, k, mass, duration = CASES[name]
    size = periods * 2 * np.pi * np.sqrt(mass / (k if name[:5] != "lines" else 0.06 * k))
    count = max(int(duration / size), 20) if steps is None else steps
    (scene, touch), began = build(k, μ), perf_counter()
    result = scheme.run(scene, duration=count * size, step=size, progress=False)
    spent = (perf_counter() - began) / count
    some = range(0, len(result.times), max(1, len(result.times) // 2000))
    found = fl.post.contact_forces(result, touch, some)
    print(
        f"{name:8s} {periods:5.2f} periods {count:7d} steps, {(found.touching > 0).mean():4.0%} in "
        f"contact: energy {result.balance_error:.1e} momentum {result.momentum_error:.1e} angular "
        f"{result.angular_momentum_error:.1e}, {result.iterations[-1] / count:.1f} iterations, "
        f"{result.factorisations} matrices, {result.divided} steps divided, {1e6 * spent:.0f} µs, "
        f"overlap {found.penetration.max():.1e}, lost {result.balance[-1, 1]:.3f} of "
        f"{result.kinetic[0]:.3f} J, in a step at least {np.diff(result.balance[:, 1]).min():.1e}",
        flush=True,
    )


def main() -> None:
    """All rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--periods", nargs="+", type=float, default=[0.02, 0.2, 0.9, 2.0])
    parser.add_argument("--decaying", type=float, help="radius of EnergyDecaying")
    parser.add_argument("--friction", type=float, default=0.0)
    parser.add_argument("--long", action="store_true")
    given = parser.parse_args()
    scheme = fl.EnergyMomentum()
    if given.decaying is not None:
        scheme = fl.EnergyDecaying(radius=given.decaying)
    if given.long:
        run("box", 0.2, scheme, given.friction, 100_000)
        return
    for name in given.cases:
        for periods in given.periods:
            run(name, periods, scheme, given.friction)


if __name__ == "__main__":
    main()
