"""Every kind of body, by every scheme that takes it, moves alike in all systems of units."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import fem_lie as fl
from tests.unit_systems import METRES, OTHER_SYSTEMS, UnitSystem

E, RHO = 4e7, 1000.0


def rubber(u: UnitSystem) -> fl.Material:
    return fl.Material(u.stress(E), 0.3, u.density(RHO))


def bar(u: UnitSystem) -> fl.Section:
    return fl.Section.rectangle(*u.length([0.05, 0.04]), rubber(u))


def rope(u: UnitSystem) -> fl.Section:
    return fl.Section.circle(u.length(0.02), rubber(u))


def bow(u: UnitSystem, cells: int = 3) -> fl.mesh.LineMesh:
    return fl.mesh.curve(lambda s: u.length([s, 0.1 * np.sin(np.pi * s), 0.05 * s * s]), cells)


def sheet(u: UnitSystem, cell: str = "quadrilateral") -> fl.mesh.SurfaceMesh:
    return fl.mesh.parametric_surface(
        lambda a, b: u.length([a, 0.4 * b, 0.1 * a * a]), (2, 2), cell=cell
    )


def patch(u: UnitSystem) -> fl.mesh.SmoothPatch:
    """Whose mixed derivative is not nil."""
    return fl.mesh.smooth_patch(
        lambda a, b: u.length([a, 0.4 * (b - 0.5), 0.1 * np.sin(1.5 * a) * (a + b)]), (2, 1)
    )


def layer(u: UnitSystem) -> fl.ShellSection:
    return fl.ShellSection.layer(u.length(0.03), rubber(u))


def solid(u: UnitSystem, law: type, **mesh: object) -> fl.Solid:
    material = law(u.stress(E), 0.3, u.density(RHO))
    return fl.Solid.brick(tuple(u.length([1.0, 0.2, 0.2])), material, cells=(2, 1, 1), **mesh)


def rigid(u: UnitSystem) -> fl.RigidBody:
    return fl.RigidBody(u.mass(1.5), u.inertia([0.01, 0.05, 0.055]), u.length([0.5, 0, 0]))


def net(u: UnitSystem) -> fl.Net:
    points = u.length([[0, 0, 0], [0.5, 0.2, 0], [0.5, -0.2, 0.1], [1, 0, 0]])
    return fl.Net(points, [[0, 1, 3], [0, 2, 3], [1, 2]], rope(u))


def reduced(u: UnitSystem) -> fl.reduction.ReducedOrderBody:
    scene = fl.Scene()
    full = scene.add(fl.Beam(bow(u, 4), bar(u)))
    return fl.reduction.reduced_order_body(scene, [full.point("start"), full.point("end")], 3)


def spline(u: UnitSystem) -> fl.SplineCable:
    return fl.SplineCable.through(
        u.length([[0, 0, 0], [0.3, 0.1, 0], [0.6, 0.1, 0], [1, 0, 0]]), rope(u), cells=1
    )


BODIES: dict[str, Callable[[UnitSystem], fl.extend.Body]] = {
    "geodesic beam": lambda u: fl.Beam(bow(u), bar(u)),
    "director beam": lambda u: fl.Beam(bow(u), bar(u), formulation=fl.elements.DirectorBeam(2)),
    "rod": lambda u: fl.Rod(bow(u), bar(u)),
    "discrete rod": lambda u: fl.Rod(bow(u), bar(u), formulation=fl.elements.DiscreteRod()),
    "cable": lambda u: fl.Cable(bow(u), rope(u)),
    "discrete cable": lambda u: fl.Cable(bow(u), rope(u), formulation=fl.elements.DiscreteCable()),
    "spline cable": spline,
    "net": net,
    "shell": lambda u: fl.Shell(sheet(u), layer(u)),
    "shell of six": lambda u: fl.Shell(sheet(u), layer(u), drilling=True),
    "triangles": lambda u: fl.Shell(sheet(u, "triangle"), layer(u)),
    "thin shell": lambda u: fl.ThinShell(patch(u), layer(u)),
    "beam of gradients": lambda u: fl.AncfBeam(bow(u, 2), bar(u)),
    "shell of gradients": lambda u: fl.AncfShell(patch(u), layer(u)),
    "hexahedra": lambda u: solid(u, fl.sections.NeoHooke),
    "quadratic tetrahedra": lambda u: solid(
        u, fl.sections.SaintVenantKirchhoff, cell="tetrahedron", degree=2
    ),
    "rigid body": rigid,
    "reduced body": reduced,
}

FRAMES = {"geodesic beam", "director beam", "rod", "shell", "triangles", "rigid body"}
REFUSED = {"shell of six", "reduced body"}
OF_SLOPES = {"thin shell", "beam of gradients", "shell of gradients"}
TAKES = {
    "generalised-α": (fl.GeneralisedAlpha(), set(BODIES)),
    "conserving": (fl.EnergyMomentum(), set(BODIES)),
    "decaying": (fl.EnergyDecaying(radius=0.5), set(BODIES)),
    "composed": (fl.schemes.Composed(), FRAMES | {"discrete rod"}),
    "variational": (fl.schemes.Variational(), FRAMES | {"discrete rod"}),
    "explicit": (fl.Explicit(), set(BODIES) - REFUSED - OF_SLOPES - {"quadratic tetrahedra"}),
    "asynchronous": (fl.schemes.Asynchronous(), {"discrete cable", "net", "hexahedra"}),
}
"""Schemes, and the bodies that they take; asynchronous steps of others are explicit ones."""
STEPS = {"explicit": 2e-6, "asynchronous": 2e-6}
"""Of others: 2e-3 s, in which waves pass cells."""
BINARY = UnitSystem("powers of two", 2.0**10, 2.0**-6, 2.0**4)
THIRDS = UnitSystem("thirds of metres", 3.0, 1.0, 1.0)
ROUNDED = {"discrete rod", "triangles", "hexahedra", "quadratic tetrahedra", "reduced body"}
"""Bodies whose mass or forces are the same in powers of two to 1e-15 only."""


@cache
def flown(u: UnitSystem, scheme: str, name: str) -> tuple[np.ndarray, int, int]:
    """Places after five steps over their start, iterations, and steps that were divided.

    Iterations are those of all steps but the longest: a conserving step in which increments end
    above what was seen of round-off before finds anew where it ends, once in a run and by chance.
    """
    scene, step = fl.Scene(gravity=u.acceleration([0, 0, -9.81])), STEPS.get(scheme, 2e-3)
    body = scene.add(BODIES[name](u))
    body.add_velocity(omega=u.rate([1.0, 2.0, 3.0]), about=u.length([0.5, 0.1, 0]))
    result = TAKES[scheme][0].run(
        scene, duration=u.time(5 * step), step=u.time(step), progress=False
    )
    positions = (
        result.frames[-1][fl.extend.node_types.has_position(body.model.node_types), 0]
        - body.frames[fl.extend.node_types.has_position(body.model.node_types), 0]
    )
    each = np.diff(result.iterations)
    return u.inverse.length(positions), int(each.sum() - each.max()), int(result.divided)


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
@pytest.mark.parametrize(
    ("scheme", "name"), [(s, name) for s, (_, names) in TAKES.items() for name in sorted(names)]
)
def test_all_bodies_move_alike_by_all_schemes(scheme, name, u):
    """In about as many iterations: what is round-off is so in all units."""
    (moved, iterations, divided), (expected, first, parts) = (
        flown(unit, scheme, name) for unit in (u, METRES)
    )
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    # round-off of METRES may end an iteration early by chance, that of another unit decides, too
    as_many = [first, flown(THIRDS, scheme, name)[1]]
    assert min(as_many) - 3 <= 1.4 * iterations and iterations <= 3 + 1.4 * max(as_many)
    assert divided == parts == 0


@pytest.mark.parametrize(
    ("scheme", "name"),
    [(s, name) for s, (_, names) in TAKES.items() for name in sorted(names - ROUNDED)],
)
def test_units_that_are_powers_of_two_change_no_bit(scheme, name):
    """All digits are scaled exactly then: any constant beside a length, mass or time shows."""
    (moved, *counts), (expected, *others) = (flown(u, scheme, name) for u in (BINARY, METRES))
    np.testing.assert_array_equal(moved, expected)
    assert counts == others


STEEL: dict[str, Callable[[fl.Material], fl.extend.Body]] = {
    "thin shell": lambda steel: fl.ThinShell(patch(METRES), fl.ShellSection.layer(0.005, steel)),
    "beam of gradients": lambda steel: fl.AncfBeam.straight(
        (0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.02, steel), cells=3
    ),
    "shell of gradients": lambda steel: fl.AncfShell(
        patch(METRES), fl.ShellSection.layer(0.02, steel)
    ),
}


@pytest.mark.parametrize("name", STEEL)
def test_steel_flies_in_full_steps(name):
    """Where waves pass cells many times in a step, and no matrix has what rotation does in it."""
    scene = fl.Scene()
    body = scene.add(STEEL[name](fl.Material(2e11, 0.3, 7800.0)))
    body.add_velocity(omega=(1.0, 2.0, 3.0), about=(0.5, 0.1, 0))
    result = fl.EnergyMomentum().run(scene, duration=0.02, step=1e-3, progress=False)
    assert result.divided == 0
    assert result.factorisations <= 40
    assert result.energy_error <= 1e-11


# --- what else measures increments: statics, small motions, chosen steps, redundant joints ---

HELD = ("geodesic beam", "thin shell", "beam of gradients", "shell of gradients", "reduced body")


def ends(body: fl.extend.Body) -> tuple[fl.extend.Point, fl.extend.Point]:
    """Two points of a body of :data:`HELD`."""
    if isinstance(body, fl.reduction.ReducedOrderBody):
        return body.point(0), body.point(1)
    if isinstance(body, fl.ThinShell | fl.AncfShell):
        return body.point("00"), body.point("11")
    return body.point("start"), body.point("end")


def hung(u: UnitSystem, name: str, gravity: float = 0.0) -> tuple[fl.Scene, fl.extend.Point]:
    """A body whose first point is fixed to the ground, and its last point."""
    scene = fl.Scene(gravity=u.acceleration([0, 0, -gravity]))
    first, last = ends(scene.add(BODIES[name](u)))
    scene.add(fl.joints.Fixed(fl.ground(), first, at=first.position))
    return scene, last


@cache
def deflected(u: UnitSystem, name: str) -> tuple[np.ndarray, list[int]]:
    scene, tip = hung(u, name)
    size = 5.0 if name == "reduced body" else 0.5  # so much that bending draws its ends together
    scene.add(fl.PointLoad(tip, force=u.force([-0.6 * size, 0.4 * size, size])))
    result = fl.statics(scene, load_steps=2)
    return u.inverse.length(result.position(tip)[-1]), result.iterations.tolist()


@cache
def vibrating(u: UnitSystem, name: str) -> np.ndarray:
    return u.inverse.rate(fl.vibrations(hung(u, name)[0], 4).frequencies)


@cache
def in_chosen_steps(u: UnitSystem, name: str) -> tuple[np.ndarray, int, int]:
    scene, tip = hung(u, name, 9.81)
    scheme, step = fl.GeneralisedAlpha(tolerance=1e-11), fl.schemes.AdaptiveStep(u.velocity(1e-2))
    result = scheme.run(scene, duration=u.time(0.01), step=step, progress=False)
    path = u.inverse.length(result.position(tip)[-1])
    return path, len(result.times), int(result.iterations[-1])


@cache
def held_thrice(u: UnitSystem, name: str) -> np.ndarray:
    """Force and moment of each of three joints that hold one point, the smallest there are."""
    scene = fl.Scene(
        redundant=fl.joints.RedundantConstraints.MINIMUM_NORM, gravity=u.acceleration([0, 0, -9.81])
    )
    point, _ = ends(scene.add(BODIES[name](u)))
    for joint in (fl.joints.Fixed, fl.joints.Spherical):
        scene.add(joint(fl.ground(), point, at=point.position))
    scene.add(fl.joints.Revolute(fl.ground(), point, at=point.position, axis=(0, 1, 0)))
    step = u.time(2e-3)
    scheme = fl.GeneralisedAlpha(tolerance=1e-11)
    result = scheme.run(scene, duration=5 * step, step=step, progress=False)
    return u.inverse.wrench(result.joint_forces[-1])


each_held = pytest.mark.parametrize("name", HELD)
other_units = pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)


@each_held
@other_units
def test_bodies_deflect_alike(name, u):
    (found, iterations), (expected, as_many) = deflected(u, name), deflected(METRES, name)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    assert iterations == as_many


@each_held
@other_units
def test_bodies_vibrate_alike(name, u):
    np.testing.assert_allclose(vibrating(u, name), vibrating(METRES, name), rtol=1e-9)


@each_held
@other_units
def test_steps_of_bodies_are_chosen_alike(name, u):
    (found, steps, iterations), (expected, as_many, before) = (
        in_chosen_steps(unit, name) for unit in (u, METRES)
    )
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    assert steps == as_many
    assert abs(iterations - before) <= 3


@each_held
@other_units
def test_redundant_joints_share_forces_alike(name, u):
    found, expected = held_thrice(u, name), held_thrice(METRES, name)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


# --- metrics and springs of conserving schemes ---


@cache
def on_a_hinge(u: UnitSystem) -> np.ndarray:
    """Forces and moments of a hinge at one point of a thin shell that falls."""
    scene, step = fl.Scene(gravity=u.acceleration([0, 0, -9.81])), u.time(5e-3)
    point = scene.add(fl.ThinShell(patch(u), layer(u))).point("00")
    scene.add(fl.joints.Revolute(fl.ground(), point, at=point.position, axis=(0, 1, 0)))
    result = fl.EnergyMomentum().run(scene, duration=12 * step, step=step, progress=False)
    return u.inverse.wrench(result.joint_forces)


@other_units
def test_a_hinge_rotates_with_a_point_of_a_thin_shell_alike(u):
    """A metric that adds mixed derivatives, which are lengths, to slopes depends on the unit."""
    found, expected = on_a_hinge(u), on_a_hinge(METRES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@cache
def swinging(u: UnitSystem) -> float:
    """Balance of energy of a rope of bars that is clamped at its end."""
    scene, step = fl.Scene(gravity=u.acceleration([0, 0, -9.81])), u.time(5e-3)
    cable = scene.add(fl.Cable(bow(u), rope(u), formulation=fl.elements.DiscreteCable()))
    cable.clamp(cable.point("start"))
    result = fl.EnergyMomentum().run(scene, duration=12 * step, step=step, progress=False)
    return result.balance_error


@other_units
def test_a_clamped_rope_balances_energy_alike(u):
    """The edge that is fixed at a clamp is as long as others, not of the unit of length."""
    assert 0.5 < swinging(u) / swinging(METRES) < 2.0
