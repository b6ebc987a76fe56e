"""Rigid motions that nothing resists are noticed in statics, whatever nodes are."""

import warnings

import numpy as np
import pytest

import fem_lie as fl
from tests.unit_systems import OTHER_SYSTEMS

SOFT = fl.Material(1e6, 0.3, 100.0)
SECTION = fl.Section.circle(0.05, SOFT)
AXIS = (1, 0, 0)


def brick(scene, **load):
    """A solid on a hinge about its long axis, pulled along it at the other face."""
    body = scene.add(
        fl.Solid.brick((1, 0.4, 0.4), fl.sections.NeoHooke(1e6, 0.3, 100.0), cells=(3, 2, 2))
    )
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("a=0"), axis=AXIS))
    for corner in ("100", "110", "101", "111"):
        scene.add(fl.PointLoad(body.point(corner), force=(20, 0, 0)))
    return body.point("111"), hinge


def beam(scene, kind, pull):
    """Between two pins, of which one moves along the axis."""
    body = scene.add(kind.straight((0, 0, 0), AXIS, SECTION, cells=4))
    hinge = scene.add(fl.joints.Cylindrical(fl.ground(), body.point("end"), axis=AXIS))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("start")))
    scene.add(fl.PointLoad(body.point("end"), force=(pull, 0, 0)))
    return body.point("end"), hinge


def net(scene):
    """A triangle that turns about one of its sides, pulled along that."""
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 1, 0)]
    body = scene.add(fl.Net(points, [[0, 1, 2], [0, 3], [3, 2], [1, 3]], SECTION))
    body.pin(body.point(0), body.point(2))
    scene.add(fl.PointLoad(body.point(3), force=(10, 0, 0)))
    return body.point(3), None


SCENES = {
    "brick on an axial hinge": brick,
    "ANCF beam on pins": lambda scene: beam(scene, fl.AncfBeam, 10.0),
    "beam on pins": lambda scene: beam(scene, fl.Beam, 10.0),
    "net": net,
}
OPTIONS = {
    "at once": {},
    "steps": {"load_steps": 5},
    "plain": {"newton": fl.schemes.Newton(linearised_stress=False)},
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_a_free_rotation_is_refused(name, options):
    scene = fl.Scene()
    SCENES[name](scene)
    with pytest.raises(fl.ConvergenceError, match="motion"):
        fl.statics(scene, **options)


@pytest.mark.parametrize("name", SCENES)
def test_paths_refuse_it_too(name):
    scene = fl.Scene()
    SCENES[name](scene)
    with pytest.raises(ValueError, match="the path has no start"):
        fl.follow_path(scene)


@pytest.mark.parametrize("name", ["brick on an axial hinge", "ANCF beam on pins"])
def test_a_soft_spring_holds_it(name):
    """Load steps and one step agree, and nothing turns."""
    found = []
    for options in ({}, {"load_steps": 4}):
        scene = fl.Scene()
        point, hinge = SCENES[name](scene)
        scene.add(fl.joints.Spring(hinge.angle, stiffness=1e-3))
        result = fl.statics(scene, **options)
        found.append(result.position(point)[-1])
    np.testing.assert_allclose(*found, atol=1e-9)
    np.testing.assert_allclose(found[0][1:], point.position[1:], atol=1e-2)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_what_is_free_does_not_depend_on_units(u, held):
    """A small brick on its hinge, without a spring and with one of a millionth of its stiffness."""
    scene, size = fl.Scene(), 0.01
    material = fl.sections.NeoHooke(u.stress(1e6), 0.3, u.density(100.0))
    edges = tuple(u.length([size, 0.4 * size, 0.4 * size]))
    body = scene.add(fl.Solid.brick(edges, material, cells=(3, 2, 2)))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("a=0"), axis=AXIS))
    force = u.force([5e3 * size**2, 0, 0])
    for corner in ("100", "110", "101", "111"):
        scene.add(fl.PointLoad(body.point(corner), force=force))
    if not held:
        with pytest.raises(fl.ConvergenceError, match="motion"):
            fl.statics(scene)
        return
    scene.add(fl.joints.Spring(hinge.angle, stiffness=u.moment(size**3)))
    moved = fl.statics(scene).position(body.point("111"))[-1] - body.point("111").position
    np.testing.assert_allclose(moved[1:], 0.0, atol=3e-2 * u.length(size))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
def test_a_free_rotation_is_refused_whatever_the_tolerance(tolerance):
    scene = fl.Scene()
    brick(scene)
    with pytest.raises(fl.ConvergenceError, match="motion"):
        fl.statics(scene, newton=fl.schemes.Newton(tolerance=tolerance))


def test_the_message_names_the_bodies():
    scene = fl.Scene()
    brick(scene)
    held = scene.add(fl.Beam.straight((0, 3, 0), (1, 3, 0), SECTION, cells=1, name="held"))
    scene.add(fl.Clamp(held.point("start")))
    with pytest.raises(fl.ConvergenceError, match=r"nothing resists 1 rigid motion of solid 1"):
        fl.statics(scene)


def test_weight_holds_a_solid_that_hangs():
    """A pendulum at rest: its weight resists the rotation that the hinge leaves free."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    lengths, origin = (0.1, 0.1, 0.5), (-0.05, -0.05, -0.5)
    rubber = fl.sections.NeoHooke(1e6, 0.3, 100.0)
    body = scene.add(fl.Solid.brick(lengths, rubber, cells=(1, 1, 3), origin=origin))
    scene.add(fl.joints.Revolute(fl.ground(), body.point("c=1"), axis=AXIS))
    low = fl.statics(scene).position(body.point("000"))[-1]
    np.testing.assert_allclose(low[:2], body.point("000").position[:2], atol=1e-3)
    assert low[2] < -0.5


@pytest.mark.parametrize("corner", [None, "000"], ids=["loose", "on a spherical joint"])
@pytest.mark.parametrize("cells", [1, 2, 3])
@pytest.mark.parametrize("pressure", [0.3, 1e3, 3e4])
def test_free_motions_are_named_where_singular_matrices_prevent_convergence(
    corner, cells, pressure
):
    """Corrections are round-off without bound there; which analyses arrive is a matter of luck."""
    scene = fl.Scene()
    rubber = fl.sections.NeoHooke(1e6, 0.3, 1e3)
    body = scene.add(fl.Solid.brick((1, 1, 2), rubber, cells=(cells,) * 3))
    for face, force in (("c=1", -pressure), ("c=0", pressure)):
        scene.add(fl.loads.FaceLoad(body, face, (0, 0, force)))
    if corner:
        scene.add(fl.joints.Spherical(fl.ground(), body.point(corner)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of surfaces that fold on the way
        with pytest.raises(fl.ConvergenceError, match=r"nothing resists \d rigid motion"):
            fl.statics(scene)


def test_the_message_names_the_node_that_moves_most():
    """Of a rod that hangs on a beam by a ball joint, the far end."""
    scene = fl.Scene()
    arm = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="arm"))
    loose = scene.add(fl.Beam.straight((1, 0, 0), (3, 0, 0), SECTION, cells=2, name="loose"))
    scene.add(fl.Clamp(arm.point("start")))
    scene.add(fl.joints.Revolute(arm.point("end"), loose.point("start"), axis=(0, 1, 0)))
    scene.add(fl.PointLoad(loose.point("end"), force=(0, 0, -1)))
    expected = r"1 rigid motion of loose, with the largest displacement at 'loose.node 2', at \(3, "
    with pytest.raises(fl.ConvergenceError, match=expected):
        fl.statics(scene)
    with pytest.raises(ValueError, match=expected):
        fl.follow_path(scene)


def free_body(scene, kind):
    """A body that nothing holds, with two opposite corners or its ends."""
    if kind == "beam":
        body = fl.Beam.straight((0, 0, 0), AXIS, SECTION, cells=4)
        return scene.add(body), ("start", "end")
    if kind == "shell":
        mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (3, 3))
        return scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, SOFT))), ("00", "10")
    body = fl.Solid.brick((1, 1, 1), fl.sections.NeoHooke(1e6, 0.3, 100.0), cells=(2, 2, 2))
    return scene.add(body), ("000", "100")


@pytest.mark.parametrize("kind", ["beam", "shell", "solid"])
@pytest.mark.parametrize(
    ("force", "opposite", "ball", "count"),
    [
        ((1, 0, 0), False, False, 6),
        ((0, 0, 1), False, False, 6),
        ((1, 0, 0), True, False, 4),
        ((1, 0, 0), False, True, 1),
        ((0, 0, 1), False, True, 3),
    ],
    ids=["pulled", "lifted", "stretched", "pulled on a joint", "lifted on a joint"],
)
def test_all_free_motions_are_counted(kind, force, opposite, ball, count):
    """A load resists a rotation only where it is balanced, as a taut string shows."""
    scene = fl.Scene()
    body, (start, end) = free_body(scene, kind)
    scene.add(fl.PointLoad(body.point(end), force=force))
    if opposite:
        scene.add(fl.PointLoad(body.point(start), force=np.negative(force)))
    if ball:
        scene.add(fl.joints.Spherical(fl.ground(), body.point(start)))
    with pytest.raises(fl.ConvergenceError, match=f"nothing resists {count} rigid motion"):
        fl.statics(scene)


@pytest.mark.parametrize("corners", [("00",), ("00", "01")])
def test_a_shell_clamped_at_one_node_turns_about_its_normal_there(corners):
    """A node with a director has no rotation about the normal that a clamp could hold."""
    scene = fl.Scene()
    body, _ = free_body(scene, "shell")
    for corner in corners:
        scene.add(fl.Clamp(body.point(corner)))
    scene.add(fl.PointLoad(body.point("10"), force=(0, 1e-3, 0)))
    if len(corners) == 1:
        with pytest.raises(fl.ConvergenceError, match="nothing resists 1 rigid motion"):
            fl.statics(scene)
    else:
        assert fl.statics(scene).displacement(body.point("10"))[-1, 1] > 0.0


def test_a_free_body_under_loads_has_small_vibrations():
    """Statics finds the equilibrium about which they are, and the rigid motions are modes."""
    scene = fl.Scene()
    body, ends = free_body(scene, "shell")
    for end, pull in zip(ends, (-1.0, 1.0), strict=True):
        scene.add(fl.PointLoad(body.point(end), force=(pull, 0, 0)))
    with pytest.raises(fl.ConvergenceError, match="nothing resists 4 rigid motions"):
        fl.statics(scene)
    found = fl.vibrations(scene, 7).frequencies
    assert np.sum(found < 1e-3 * found[-1]) == 4


def bars_on_strings() -> fl.Scene:
    """A tensegrity of three bars, held as a whole; each may spin about its own axis."""
    scene, turn, held = fl.Scene(), 2 * np.pi / 3, np.radians(140.0)
    ring = turn * np.arange(3)
    low = np.column_stack([np.cos(ring), np.sin(ring), 0 * ring])
    top = np.column_stack([np.cos(ring + held), np.sin(ring + held), 2 + 0 * ring])
    bars = [fl.RigidBody.cylinder(1.0, 0.01, *ends) for ends in zip(low, top, strict=True)]
    feet = [scene.add(bar).point(x) for bar, x in zip(bars, low, strict=True)]
    heads = [bar.point(x) for bar, x in zip(bars, top, strict=True)]
    for k in range(3):
        after = (k + 1) % 3
        pairs = (feet[k], feet[after]), (heads[k], heads[after]), (heads[k], feet[after])
        for a, b in pairs:
            rest = 0.9 * np.linalg.norm(a.position - b.position)
            scene.add(fl.loads.ForceLaw((a, b), fl.loads.TensionOnly(1e3, rest)))
    scene.add(fl.joints.Spherical(fl.ground(), feet[0], at=low[0]))
    scene.add(fl.joints.InPlane(fl.ground(), feet[2], at=low[2], axis=(0, 0, 1)))
    along = low[1] - low[0]
    for axis in ((0, 0, 1), np.cross(along, (0, 0, 1))):
        scene.add(fl.joints.InPlane(fl.ground(), feet[1], at=low[1], axis=axis))
    return scene


def test_spins_of_bars_under_unbalanced_preloads_are_named():
    """They change no energy, but forces that are not balanced move with the bars."""
    with pytest.raises(fl.ConvergenceError, match="nothing resists 3 rigid motions of rigidbody"):
        fl.statics(bars_on_strings())


@pytest.mark.parametrize("kind", [fl.Beam, fl.Cable])
def test_free_motions_of_a_ring_are_no_instability(kind):
    """Bent from a straight cable, it vibrates in its plane as a ring that was made round.

    Torsion makes the modes across the plane the slowest ones of a ring of a beam.
    """
    steel, radius = fl.Material(2.1e11, 0.3, 7850.0), 0.2
    wire = fl.Section.circle(1e-3, steel)

    def circle(s: float) -> tuple[float, float, float]:
        angle = 2 * np.pi * s
        return radius * np.cos(angle), radius * np.sin(angle), 0.0

    scene = fl.Scene()
    ring = scene.add(kind.curve(circle, wire, cells=40))
    assert list(ring.model.point_names) == ["start"]
    frequencies = fl.vibrations(scene, 10).frequencies[6:]
    exact = 6 / np.sqrt(5) / radius**2 * np.sqrt(wire.stiffness[5, 5] / wire.inertia[0, 0])
    across = exact * np.sqrt(5 / 5.3)
    expected = [across, across, exact, exact] if kind is fl.Beam else [exact, exact]
    np.testing.assert_allclose(frequencies[: len(expected)], expected, rtol=1e-4)
