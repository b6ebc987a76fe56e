"""Nodes that follow others rigidly: the same as joints, without constraints."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

MATERIAL = fl.Material(2.1e9, 0.3, 2000.0)
SECTION = fl.Section.rectangle(0.03, 0.05, MATERIAL)
THIN = fl.Section.circle(0.02, MATERIAL)
UP = (0.1, 0.2, 1.0)
POINTS = [(0.0, 0, 0), (0.5, 0, 0), (1.0, 0, 0), (1.2, 0.5, 0), (1.4, 1.0, 0), (1.3, -0.4, 0.5)]
KINK, BRANCH = [(0, 1), (1, 2), (2, 3), (3, 4)], [(0, 1), (1, 2), (2, 3), (3, 4), (2, 5)]


def mesh_of(cells, motion=None) -> fl.mesh.LineMesh:
    """Each arm is a group; the corner and the ends are named."""
    x = np.array(POINTS[: 1 + np.max(cells)])
    if motion is not None:
        x = motion[0] + x @ motion[1:]
    names = {"root": [0], "corner": [2], "tip": [4]} | ({"side": [5]} if len(x) == 6 else {})
    arms = {"trunk": [0, 1], "arm": [2, 3]} | ({"branch": [4]} if len(x) == 6 else {})
    return fl.mesh.LineMesh.from_cells(x, cells, groups=arms, named_points=names)


def frame(cells, joints: bool, gravity=(0, 0, 0)):
    """A scene with the lines in one mesh or as beams with joints, and its beams by group."""
    scene, mesh = fl.Scene(gravity), mesh_of(cells)
    sections = {name: THIN if name == "arm" else SECTION for name in mesh.groups}
    if not joints:
        return scene, dict.fromkeys(mesh.groups, scene.add(fl.Beam(mesh, sections, up=UP)))
    parts = {name: fl.Beam(mesh.part(name), sections[name], up=UP) for name in mesh.groups}
    for part in parts.values():
        scene.add(part)
    for name in list(parts)[1:]:
        scene.add(
            fl.joints.Fixed(parts["trunk"].point("corner"), parts[name].point("corner"), name=name)
        )
    return scene, parts


def both(cells, loads, solve, **options):
    """What ``solve(scene, parts)`` gives for one mesh and for joints."""
    found = []
    for joints in (False, True):
        scene, parts = frame(cells, joints, **options)
        scene.add(fl.Clamp(parts["trunk"].point("root")))
        for load in loads(parts):
            scene.add(load)
        found.append(solve(scene, parts))
    return found


LOADS = {
    "dead force and moment at the corner": lambda p: [
        fl.PointLoad(p["trunk"].point("corner"), force=(3, -20, 40), moment=(20, 10, -5))
    ],
    "following force and moment at the corner": lambda p: [
        fl.PointLoad(p["trunk"].point("corner"), (3, -20, 40), (20, 10, -5), following=True)
    ],
    "dead force at the tip": lambda p: [fl.PointLoad(p["arm"].point("tip"), force=(10, -20, 40))],
    "dead line load on the arm": lambda p: [
        fl.LineLoad(p["arm"], force=(0, 0, 30), moment=(10, 0, 0), cells="arm")
    ],
    "following line load on the arm": lambda p: [
        fl.LineLoad(p["arm"], (10, 20, 30), (10, 0, 0), cells="arm", following=True)
    ],
    "pressure on the arm": lambda p: [
        fl.loads.PressureLoad(p["arm"], 50.0, (0, 1, 1), cells="arm")
    ],
    "warm arm": lambda p: [fl.loads.Temperature(p["arm"], 50.0, 1e-3, (20.0, 100.0), cells="arm")],
    "pre-stressed arm": lambda p: [
        fl.loads.PreStress(p["arm"], (100, 20, 5, 10, 5, 8), cells="arm")
    ],
}


@pytest.mark.parametrize("cells", [KINK, BRANCH], ids=["kink", "branch"])
@pytest.mark.parametrize("name", LOADS)
def test_one_mesh_is_beams_with_joints_in_statics(cells, name):
    def solve(scene, parts):
        result = fl.statics(scene, load_steps=2, newton=fl.schemes.Newton(tolerance=1e-13))
        return result.position(parts["arm"].point("tip"))[-1], parts["arm"].point("tip").position

    (mesh, start), (joints, _) = both(cells, LOADS[name], solve)
    assert np.linalg.norm(mesh - start) > 1e-3, "the load does something"
    np.testing.assert_allclose(mesh, joints, rtol=0, atol=1e-12)


def test_one_mesh_is_beams_with_joints_in_dynamics():
    """Their steps solve the same equations: positions agree to the tolerance of the iteration."""

    def solve(scene, parts):
        scheme = fl.GeneralisedAlpha(tolerance=1e-11)
        result = scheme.run(scene, duration=0.05, step=1e-3)
        return result.position(parts["arm"].point("tip")), result

    (mesh, result), (joints, other) = both(
        BRANCH, LOADS["dead force at the tip"], solve, gravity=(0, 0, -9.81)
    )
    assert np.ptp(mesh, axis=0).max() > 1e-2
    np.testing.assert_allclose(mesh, joints, rtol=0, atol=1e-9)
    np.testing.assert_allclose(result.total_energy, other.total_energy, rtol=0, atol=1e-6)
    assert result.energy_error < 1e-2


def test_a_branch_does_not_see_a_rigid_motion_of_all():
    """Objectivity: turned and moved, with its loads and ``up``, it gives the turned solution."""
    motion = lie.frame([3.0, -2.0, 1.0], lie.so3_exp([1.0, -0.7, 2.0]))
    turn, tips = lie.rotation(motion), []
    for position in (None, motion):
        R = np.eye(3) if position is None else turn
        scene = fl.Scene(R @ [0, 2.0, -9.81])
        sections = {"trunk": SECTION, "arm": THIN, "branch": SECTION}
        beam = scene.add(fl.Beam(mesh_of(BRANCH, position), sections, up=R @ UP))
        scene.add(fl.Clamp(beam.point("root")))
        scene.add(fl.PointLoad(beam.point("tip"), R @ [5, -10, 20], R @ [3, 2, 1]))
        scene.add(fl.LineLoad(beam, (0, 5, 5), cells="branch", following=True))
        scene.add(fl.loads.PressureLoad(beam, 20.0, (0, 1, 0), cells="arm"))
        tips.append(
            fl.statics(scene, load_steps=2, newton=fl.schemes.Newton(tolerance=1e-13)).position(
                beam.point("tip")
            )[-1]
        )
    np.testing.assert_allclose(tips[1], motion[0] + turn @ tips[0], rtol=0, atol=1e-11)


def test_clamp_joint_and_motion_on_a_node_that_follows():
    """The corner of the branch has three nodes; it does not matter which of them is held."""
    tips = {}
    for node in (2, 6, 7):
        for support in ("clamp", "joint", "motion"):
            scene = fl.Scene()
            beam = scene.add(fl.Beam(mesh_of(BRANCH), SECTION, up=UP))
            assert beam.model.masters.tolist() == [0, 1, 2, 3, 4, 5, 2, 2]
            corner = beam.point(node)
            if support == "clamp":
                scene.add(fl.Clamp(corner))
            elif support == "joint":
                scene.add(fl.joints.Fixed(fl.ground(), corner))
            else:
                scene.add(fl.PrescribedMotion(corner, lambda t, start=corner.frame: start))
            scene.add(fl.PointLoad(beam.point("tip"), force=(10, -20, 40)))
            tips[node, support] = fl.statics(
                scene, newton=fl.schemes.Newton(tolerance=1e-13)
            ).position(beam.point("tip"))[-1]
    values = np.array(list(tips.values()))
    np.testing.assert_allclose(values, values[:1].repeat(9, axis=0), rtol=0, atol=1e-12)


def rod(start, end, **options) -> fl.Beam:
    return fl.Beam.straight(start, end, THIN, cells=2, **options)


@pytest.mark.parametrize("steps", [0, 40])
def test_a_rigid_link_is_a_fixed_joint_at_an_offset(steps):
    """Two rods of different formulations and a body between them, all apart."""
    tips = []
    for links in (True, False):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        a = scene.add(rod((0, 0, 0), (1, 0, 0)))
        b = scene.add(rod((1.3, 0.2, 0.4), (2, 1, 0), formulation=fl.elements.GeodesicBeam(False)))
        block = scene.add(fl.RigidBody(0.5, (0.02, 0.03, 0.04), (1.1, -0.2, 0.1)))
        for first, second in (
            (a.point("end"), block.point("centre")),
            (b.point("start"), block.point("centre")),
        ):
            joint = fl.joints.Fixed(first, second, at=first.position)
            scene.add(fl.joints.RigidLink(second, first) if links else joint)
        scene.add(fl.Clamp(a.point("start")))
        scene.add(fl.PointLoad(block.point("centre"), force=(0, 5, 3), moment=(1, 2, 3)))
        scene.add(fl.PointLoad(b.point("start"), force=(1, 2, 1), following=True))
        if steps:
            scheme = fl.GeneralisedAlpha(tolerance=1e-11)
            tips.append(
                scheme.run(scene, duration=steps * 1e-3, step=1e-3).position(b.point("end"))
            )
        else:
            result = fl.statics(scene, load_steps=2, newton=fl.schemes.Newton(tolerance=1e-13))
            tips.append(result.position(b.point("end")))
    assert np.linalg.norm(tips[0][-1] - [2, 1, 0]) > 1e-3
    np.testing.assert_allclose(tips[0], tips[1], rtol=0, atol=1e-8 if steps else 1e-12)


def test_linked_bodies_are_one_body():
    """Three bodies in a chain of links, one link too many, are the one of their common inertia."""
    rng = np.random.default_rng(4)
    masses, positions = [2.0, 1.0, 0.5], rng.normal(size=(3, 3))
    tensors = [np.diag(t) for t in ([0.3, 0.4, 0.5], [0.1, 0.1, 0.15], [0.2, 0.1, 0.2])]
    turns = lie.so3_exp(rng.normal(size=(3, 3)))
    centre = np.average(positions, axis=0, weights=masses)
    spread = positions - centre
    whole = sum(
        R @ J @ R.T + m * (r @ r * np.eye(3) - np.outer(r, r))
        for R, J, m, r in zip(turns, tensors, masses, spread, strict=True)
    )
    spin, speed = (4.0, -3.0, 5.0), (0.5, 0.2, -1.0)

    def run(*bodies, links=()):
        scene = fl.Scene()
        for body in bodies:
            scene.add(body).add_velocity(omega=spin, about=centre)
            body.add_velocity(speed)
        for i, j in links:
            scene.add(fl.joints.RigidLink(bodies[i].point("centre"), bodies[j].point("centre")))
        scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12)
        return scheme.run(scene, duration=0.5, step=5e-4)

    bodies = [
        fl.RigidBody(m, J, x, R)
        for m, J, x, R in zip(masses, tensors, positions, turns, strict=True)
    ]
    linked = run(*bodies, links=[(1, 2), (0, 2), (1, 0)])
    single = run(fl.RigidBody(sum(masses), whole, centre))
    start = single.frames[0, 0]
    for k in range(3):
        fixed = lie.se3_compose(lie.se3_inverse(start), linked.frames[0, k])
        exact = lie.se3_compose(single.frames[:, 0], fixed)
        # frames elsewhere on a body have their own second-order scheme
        np.testing.assert_allclose(linked.frames[:, k], exact, rtol=0, atol=2e-4)
        relative = lie.se3_relative(linked.frames[:, 0], linked.frames[:, k])
        np.testing.assert_allclose(relative, relative[:1].repeat(len(relative), 0), atol=1e-12)
    np.testing.assert_allclose(linked.kinetic, single.kinetic[0], rtol=1e-5)
    np.testing.assert_allclose(linked.momentum[0], single.momentum[0], atol=1e-13)
    np.testing.assert_allclose(linked.angular_momentum[0], single.angular_momentum[0], atol=1e-13)
    # of second order in the step, which turns by 3.5e-3
    assert linked.momentum_error < 5e-5 and linked.angular_momentum_error < 5e-5


def test_momentum_of_a_beam_with_a_body_beside_it():
    """Free flight with a spin: all momenta stay, however the parts vibrate."""
    scene = fl.Scene()
    beam = scene.add(rod((0, 0, 0), (1, 0, 0)))
    block = scene.add(fl.RigidBody(0.5, (0.02, 0.03, 0.04), (1.2, 0.3, 0.1)))
    scene.add(fl.joints.RigidLink(beam.point("end"), block.point("centre")))
    for body in (beam, block):
        body.add_velocity(omega=(1, 2, 3), about=(0.3, 0, 0))
        body.add_velocity((0.3, 0, 1))
    result = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-11).run(scene, duration=0.2, step=2e-4)
    # of second order in the step, as the pendulum's in test_dynamics.py
    assert result.momentum_error < 1e-4 and result.angular_momentum_error < 1e-4
    assert result.energy_error < 1e-3


def test_energy_of_a_dead_force_on_a_body_that_follows():
    """Its work goes with the body's own position, not with that of its master node."""
    scene = fl.Scene()
    beam = scene.add(rod((0, 0, 0), (1, 0, 0)))
    block = scene.add(fl.RigidBody(0.5, (0.02, 0.03, 0.04), (1.0, 0.4, 0.0)))
    scene.add(fl.joints.RigidLink(beam.point("end"), block.point("centre")))
    scene.add(fl.Clamp(beam.point("start")))
    force = np.array([0.0, 3.0, 20.0])
    scene.add(fl.PointLoad(block.point("centre"), force=force))
    result = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-11).run(scene, duration=0.05, step=1e-4)
    moved = result.position(block.point("centre")) - block.point("centre").position
    np.testing.assert_allclose(result.potential - result.potential[0], -moved @ force, atol=1e-12)
    assert result.energy_error < 1e-4


def test_velocities_that_a_link_does_not_allow_are_refused():
    scene = fl.Scene()
    beam = scene.add(rod((0, 0, 0), (1, 0, 0), name="arm"))
    block = scene.add(fl.RigidBody(0.5, (0.02, 0.03, 0.04), (1.0, 0.4, 0.0), name="block"))
    scene.add(fl.joints.RigidLink(beam.point("end"), block.point("centre")))
    beam.add_velocity(omega=(0, 0, 2), about=(0, 0, 0))
    with pytest.raises(ValueError, match="velocities of block contradict a rigid link"):
        fl.extend.Equations(scene, dynamics=True)
    block.add_velocity(omega=(0, 0, 2), about=(0, 0, 0))
    fl.extend.Equations(scene, dynamics=True)


def test_a_joint_between_linked_points_is_redundant():
    scene = fl.Scene()
    a, b = scene.add(rod((0, 0, 0), (1, 2, 0.3))), scene.add(rod((1, 2, 0.3), (2, 1, 0)))
    scene.add(fl.joints.RigidLink(a.point("end"), b.point("start")))
    scene.add(fl.Clamp(a.point("start")))
    scene.add(fl.joints.Revolute(b.point("start"), a.point("end"), axis=(1, 1, 3), name="useless"))
    with pytest.raises(ValueError, match=r"5 of 5 constraints are redundant.*useless"):
        fl.extend.Equations(scene, dynamics=True)
