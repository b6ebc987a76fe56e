"""Scenes of the literature, written from the guide, against closed forms and refined runs.

    python3 -m benchmarks.published

- *Flying spaghetti* in space: J. C. Simo & L. Vu-Quoc, CMAME 66 (1988) 125. The load has an impulse
  of 50; positions are compared with composed steps of a quarter of the size.
- *Euler's disk*: a thin disc whose centre rests precesses with ``Ω² = 4 g/(R sin α)``.
- *Tippe top*: with any friction the moment of momentum along the arm from the centre of mass to the
  contact is constant, J. H. Jellett, A Treatise on the Theory of Friction, 1872.
- *Peaucellier's linkage* of seven bars: a point moves along a straight line. All ten hinges have
  parallel axes, so that 9 of 50 constraints are redundant.
- *A rimless wheel* rolls down a slope (T. McGeer, Int. J. Robotics Research 9 (1990) 62): impacts
  of its spokes and gravity determine its steady rolling, in which no spoke leaves the ground early.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import fem_lie as fl

GRAVITY = 9.81
FLAT = fl.contact.Plane(fl.ground(), (0, 0, 1))
TOP = 0.4 * 0.02 * 0.02**2 * np.array([0.9, 0.9, 1.0])
"""Moments of inertia of the tippe top, kg m²."""

SCHEMES = {
    "GeneralisedAlpha": fl.GeneralisedAlpha(),
    "EnergyMomentum": fl.EnergyMomentum(),
    "EnergyDecaying": fl.EnergyDecaying(),
    "Variational": fl.schemes.Variational(),
}


def spaghetti() -> tuple[fl.Scene, fl.Beam]:
    """A free beam that a force and two moments at one end bend and throw."""
    section = fl.Section.from_stiffness(
        [1e4, 1e4, 1e4, 200.0, 500.0, 500.0], mass=1.0, rotary=(10.0, 10.0)
    )
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((6, 0, 0), (0, 8, 0), section, cells=10, name="beam"))
    ramp = fl.loads.PiecewiseLinear((0, 2.5, 5), (0, 1, 0))
    force, moment = (20, 0, 0), (0, 100, 200)
    scene.add(fl.PointLoad(beam.point("start"), force, moment, history=ramp))
    return scene, beam


def thrown() -> Iterator[str]:
    """Errors of momentum after the load and of the ends at 10 s."""
    scene, _ = spaghetti()
    fine = fl.schemes.Composed().run(scene, duration=10.0, step=0.0125, progress=False)
    for name, scheme in SCHEMES.items():
        scene, _ = spaghetti()
        result = scheme.run(scene, duration=10.0, step=0.05, progress=False)
        momentum = np.abs(result.momentum[-1] - (50, 0, 0)).max()
        ends = np.abs(result.frames[-1, [0, -1], 0] - fine.frames[-1, [0, -1], 0]).max()
        yield f"spaghetti, {name}: momentum {momentum:.1e}, ends {ends:.1e}"


def precession() -> Iterator[str]:
    """Error of the rate of Euler's disk at 0.2 rad, steps of 1 ms."""
    angle, radius, mass = 0.2, 0.04, 0.4
    axis, down = (np.sin(angle), 0, np.cos(angle)), np.array([np.cos(angle), 0, -np.sin(angle)])
    rate = np.sqrt(4 * GRAVITY / (radius * np.sin(angle)))
    inertia = mass * radius**2 / 4 * np.array([1, 1, 2])
    for name in ("GeneralisedAlpha", "EnergyMomentum", "Hamel"):
        scheme = SCHEMES.get(name, fl.schemes.Hamel())
        rotation = np.column_stack([down, (0, 1, 0), axis])
        disc = fl.RigidBody(mass, inertia, -radius * down, rotation)
        centre = disc.point("centre")
        disc.add_velocity(omega=-rate * np.sin(angle) * down, about=centre)
        scene = fl.Scene(gravity=(0, 0, -GRAVITY))
        scene.add(disc)
        scene.add(fl.joints.RollingDisc(fl.ground(), centre, axis=axis, radius=radius))
        result = scheme.run(scene, duration=3.0, step=1e-3, progress=False)
        x, y, _ = result.rotation(centre)[:, :, 2].T
        turned = np.unwrap(np.arctan2(y, x))[-1] / 3.0
        yield f"Euler's disk, {name}: rate {turned / rate - 1:.1e}"


def top(law: fl.contact.Penalty | fl.contact.Impact) -> tuple[fl.Scene, fl.RigidBody]:
    """A ball of 2 cm, whose centre of mass is 3 mm off, spins with 150 rad/s, tilted by 0.1 rad."""
    radius, off, tilt = 0.02, 0.003, 0.1
    axis = np.array([np.sin(tilt), 0, np.cos(tilt)])
    rotation = np.column_stack([(axis[2], 0, -axis[0]), (0, 1, 0), axis])
    body = fl.RigidBody(0.02, TOP, np.array([0, 0, radius]) - off * axis, rotation)
    middle = body.point((0, 0, radius))
    body.add_velocity(omega=150 * axis, about=middle)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(body)
    scene.add(fl.contact.Contact(fl.contact.Sphere(middle, radius), FLAT, law))
    return scene, body


def spinning() -> Iterator[str]:
    """Drift of Jellett's integral in 4 s, and how far the top has tilted."""
    penalty = fl.contact.Penalty(2e3, friction=0.3)
    for name, law, step in (
        ("GeneralisedAlpha", fl.contact.Impact(friction=0.3), 1e-3),
        ("GeneralisedAlpha", penalty, 5e-4),
        ("EnergyMomentum", penalty, 5e-4),
    ):
        scene, body = top(law)
        centre = body.point("centre")
        result = SCHEMES[name].run(scene, duration=4.0, step=step, progress=False)
        R = result.rotation(centre)
        local = result.velocity(centre)[:, 3:] * TOP
        arm = 0.003 * R[:, :, 2] - (0, 0, 0.02)
        kept = np.einsum("tij,tj,ti->t", R, local, arm)
        drift, least = np.ptp(kept) / abs(kept[0]), R[:, 2, 2].min()
        yield f"tippe top, {name}, {type(law).__name__}: {drift:.1e}, least cosine {least:.3f}"


def linkage() -> tuple[fl.Scene, fl.extend.Point]:
    """Peaucellier's linkage, whose crank swings by 0.4 rad, and the point on the straight line."""
    square, side, angle = 3.0, 1.0, 0.5  # OA·OP, bars of the rhombus, direction of the crank
    origin, C, z = np.zeros(3), np.array([1.0, 0, 0]), (0, 0, 1)
    A = np.array([1.0 + np.cos(angle), np.sin(angle), 0])
    d = float(np.linalg.norm(A))
    u, far = A / d, square / d
    v = np.sqrt(side**2 - (far - d) ** 2 / 4) * np.array([-u[1], u[0], 0])
    B, D, P = (far + d) / 2 * u + v, (far + d) / 2 * u - v, far * u
    scene = fl.Scene(
        redundant=fl.joints.RedundantConstraints.MINIMUM_NORM, gravity=(0, -GRAVITY, 0)
    )
    bars = {}
    for name, start, end in zip(
        ("CA", "OB", "OD", "AB", "AD", "BP", "DP"),
        (C, origin, origin, A, A, B, D),
        (A, B, D, B, D, P, P),
        strict=True,
    ):
        bars[name] = scene.add(fl.RigidBody.cylinder(1.0, 0.01, start, end, name=name))
    hinges = {}
    for one, two, at in (
        ("", "CA", C),
        ("", "OB", origin),
        ("", "OD", origin),
        ("CA", "AB", A),
        ("CA", "AD", A),
        ("AB", "OB", B),
        ("AD", "OD", D),
        ("OB", "BP", B),
        ("OD", "DP", D),
        ("BP", "DP", P),
    ):
        a = bars[one].point("centre") if one else fl.ground()
        hinge = fl.joints.Revolute(a, bars[two].point("centre"), at=at, axis=z)
        hinges[one, two] = scene.add(hinge)
    scene.add(fl.joints.Drive(hinges["", "CA"].angle, lambda t: 0.4 * np.sin(t)))
    return scene, bars["DP"].point(P)


def straight() -> Iterator[str]:
    """How far the point leaves its line in a stroke of 0.65 m, and the time for a step of 5 ms."""
    for name, scheme in SCHEMES.items():
        scene, point = linkage()
        fl.schemes.set_initial_velocities(scene, 5e-3)
        result = scheme.run(scene, duration=6.3, step=5e-3, progress=False)
        x, y, _ = result.position(point).T
        each = 1e3 * result.seconds / (len(result.times) - 1)
        yield (
            f"Peaucellier, {name}: {np.abs(x - 1.5).max():.1e} m of {np.ptp(y):.4f} m, "
            f"{each:.2f} ms a step"
        )


def rolling_spokes(step: float) -> tuple[float, float]:
    """Relative errors of the angular velocity before and after impacts in steady rolling."""
    spokes, slope, J = 8, 0.2, 0.5
    half = np.pi / spokes
    corners = np.arange(spokes) * 2 * half + half
    ends = [(np.sin(a), y, np.cos(a)) for a in corners for y in (-0.2, 0.2)]
    scene = fl.Scene(gravity=(GRAVITY * np.sin(slope), 0, -GRAVITY * np.cos(slope)))
    wheel = scene.add(fl.RigidBody(1.0, (0.3, J, 0.3), (0, 0, np.cos(half))))
    wheel.add_velocity(omega=(0, 1.5, 0), about=(np.sin(half), 0, 0))
    rim = fl.contact.ConvexPolyhedron(wheel.point("centre"), ends)
    scene.add(fl.contact.Contact(rim, FLAT, fl.contact.Impact(friction=5.0)))
    result = SCHEMES["GeneralisedAlpha"].run(scene, duration=20.0, step=step, progress=False)
    omega = result.velocity(wheel.point("centre"))[len(result.times) // 2 :, 4]
    # momentum about the next corner, energy between impacts
    kept = (J + np.cos(2 * half)) / (J + 1)
    fall = 2 * GRAVITY * (np.cos(slope - half) - np.cos(slope + half)) / (J + 1)
    before = np.sqrt(fall / (1 - kept**2))
    top = np.sqrt((kept * before) ** 2 - 2 * GRAVITY * (1 - np.cos(half - slope)) / (J + 1))
    return float(omega.max() / before - 1), float(omega.min() / top - 1)


def spokes() -> Iterator[str]:
    """Errors before an impact and where a spoke is upright, in steady rolling."""
    for step in (2e-3, 1e-3, 5e-4):
        before, upright = rolling_spokes(step)
        yield f"rimless wheel, {step:g} s: before impacts {before:.1e}, upright {upright:.1e}"


def main() -> None:
    """Print all rows."""
    for rows in (thrown, precession, spinning, straight, spokes):
        for row in rows():
            print(row, flush=True)


if __name__ == "__main__":
    main()
