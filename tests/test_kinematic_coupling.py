"""Kinematic couplings (RBE2): rigid motion, transfer of forces, objectivity, schemes, messages."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

RUBBER = fl.sections.SaintVenantKirchhoff(E=1e6, nu=0.3, density=1100.0)
SHEET = fl.ShellSection.layer(0.01, fl.Material(E=2.1e8, nu=0.3, density=1100.0))
CENTRE = np.array([0.45, 0.05, 0.02])
TIGHT = fl.schemes.Newton(tolerance=1e-13)


def solid():
    return fl.Solid.brick((0.4, 0.1, 0.1), RUBBER, cells=(3, 1, 1), degree=2, name="part")


def shell():
    mesh = fl.mesh.parametric_surface(lambda a, b: (0.4 * a, 0.1 * b, 0.0), (3, 2))
    return fl.Shell(mesh, SHEET, name="part")


def coupled(part):
    """A part with a rigid body coupled to its far end, and the nodes there."""
    scene = fl.Scene()
    body = fl.RigidBody(1.0, (1e-3, 2e-3, 3e-3), position=CENTRE, name="body")
    for each in (part, body):
        scene.add(each)
    group = part.points("a=1")
    scene.add(fl.joints.KinematicCoupling(body.point("centre"), group, name="coupling"))
    return scene, body, [point.node for point in group]


def relative(result, k, nodes):
    """Frames of the group in the frame of the rigid body, state k."""
    of = {body.name: body.nodes for body in result.info.bodies}
    H = result.frames[k]
    return lie.se3_compose(lie.se3_inverse(H[of["body"][0]]), H[of["part"][nodes]])


@pytest.mark.parametrize("make", [solid, shell])
def test_group_moves_rigidly_and_its_resultant_is_the_load(make):
    """Large rotation: positions, and frames of a shell, keep their place in the frame of a."""
    part = make()
    scene, body, nodes = coupled(part)
    part.clamp("a=0")
    force, moment = np.array([5.0, 10.0, -30.0]), np.array([0.5, -3.0, 1.0])
    scene.add(fl.PointLoad(body.point("centre"), force=force, moment=moment))
    result = fl.statics(scene, load_steps=4, newton=TIGHT)
    before, after = (relative(result, k, nodes) for k in (0, -1))
    at = next(b.nodes[0] for b in result.info.bodies if b.name == "body")
    assert np.linalg.norm(lie.so3_log(lie.rotation(result.frames[-1, at]))) > 0.05
    kept = slice(1) if make is solid else slice(4)
    np.testing.assert_allclose(after[:, kept], before[:, kept], atol=1e-12)
    found = result.joint_force("coupling", axes="global")[-1]
    np.testing.assert_allclose(found, [*-force, *-moment], atol=1e-8)


@pytest.mark.parametrize("make", [solid, shell])
def test_free_part_follows_a_large_rotation_without_strain(make):
    part = make()
    scene, body, _ = coupled(part)
    turn = np.array([0.4, -1.2, 0.9])

    def motion(t):
        return lie.frame(CENTRE + t * np.array([0.1, 0.2, 0.3]), lie.so3_exp(t * turn))

    scene.add(fl.PrescribedMotion(body.point("centre"), motion))
    result = fl.statics(scene, load_steps=4, newton=TIGHT)
    away = part.frames[:, 0] - CENTRE
    expected = motion(1.0)[0] + away @ lie.so3_exp(turn).T
    of = next(b.nodes for b in result.info.bodies if b.name == "part")
    np.testing.assert_allclose(result.frames[-1, of, 0], expected, atol=1e-11)


def test_same_motion_and_force_as_ball_joints_at_all_nodes():
    """In time, by the compiled results: one resultant instead of the sum by hand."""
    results = []
    for apart in (False, True):
        part = solid()
        scene, body, _ = coupled(part)
        part.clamp("a=0")
        centre = body.point("centre")
        if apart:
            scene.joints.clear()
            scene.connections.clear()
            for k, point in enumerate(part.points("a=1")):
                name = f"ball {k}"
                scene.add(fl.joints.Spherical(centre, point, at=point.position, name=name))
        scene.add(fl.PointLoad(centre, force=(1.0, 2.0, -3.0)))
        results.append(fl.GeneralisedAlpha().run(scene, duration=0.02, step=1e-3))
    one, many = results
    np.testing.assert_allclose(one.frames, many.frames, atol=1e-10)
    forces, moments = np.zeros((2, len(one.times), 3))
    part, arm = solid(), one.position("body.centre")
    for k, point in enumerate(part.points("a=1")):
        force = many.joint_force(f"ball {k}", axes="global")[:, :3]
        at = many.frames[:, next(b.nodes for b in many.info.bodies if b.name == "part")]
        forces += force
        moments += np.cross(at[:, point.node, 0] - arm, force)
    found = one.joint_force("coupling", axes="global")
    np.testing.assert_allclose(found[:, :3], forces, atol=1e-7)
    np.testing.assert_allclose(found[:, 3:], moments, atol=1e-7)


def test_energy_and_momentum_of_a_spinning_pair():
    part = solid()
    scene, body, _ = coupled(part)
    for each in (part, body):
        each.add_velocity((0.1, 0.0, 0.2), omega=(1.0, 3.0, -2.0), about=CENTRE)
    result = fl.EnergyMomentum().run(scene, duration=0.02, step=1e-3)
    momentum = result.angular_momentum
    np.testing.assert_allclose(momentum, momentum[[0] * len(momentum)], rtol=1e-9)
    assert result.energy_error < 1e-10


def test_coupling_to_the_ground_is_a_clamp():
    tips = []
    for held in ("clamp", "coupling"):
        part, scene = solid(), fl.Scene()
        scene.add(part)
        if held == "clamp":
            part.clamp("a=0")
        else:
            group = part.points("a=0")
            root = scene.add(fl.joints.KinematicCoupling(fl.ground(), group, name="root"))
        scene.add(fl.loads.FaceLoad(part, "a=1", force=(0, 0, -500.0)))
        result = fl.statics(scene, newton=TIGHT)
        tips.append(result.displacement("part.111")[-1])
    np.testing.assert_allclose(tips[1], tips[0], rtol=1e-9)
    np.testing.assert_allclose(result.joint_force(root)[-1, :3], (0, 0, -5.0), atol=1e-9)


def test_the_reference_point_may_be_in_the_group():
    """An edge of a shell that its own corner carries, by the edge and by its other nodes."""
    tips = []
    for first in (0, 1):
        scene, part = fl.Scene(), shell()
        scene.add(part)
        part.clamp("a=0")
        group = part.points("a=1")
        edge = scene.add(fl.joints.KinematicCoupling(group[0], group[first:]))
        assert len(edge.group) == len(group) - 1
        scene.add(fl.PointLoad(group[0], force=(0, 0, -1.0)))
        tips.append(fl.statics(scene).displacement(group[0])[-1])
    np.testing.assert_array_equal(tips[0], tips[1])


def test_wrong_groups_have_a_message():
    scene, body, _ = coupled(solid())
    part, centre = scene.bodies[0], body.point("centre")
    group = part.points("a=0")
    thin = fl.ThinShell(fl.mesh.smooth_patch(lambda a, b: (a, b, 0.0), (2, 2)), SHEET)
    scene.add(thin)
    for wrong, message in (
        ([], "expected nodes other than body.centre in the group, got none"),
        ([centre], "expected nodes other than body.centre in the group, got none"),
        ([*group, group[0]], "a node is in the group twice"),
        ([part.point("a=0")], "expected nodes of bodies, got part.a=0"),
        ([thin.point(0)], "expected nodes with frames or positions"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.add(fl.joints.KinematicCoupling(centre, wrong))
    with pytest.raises(TypeError, match="KinematicCoupling: group"):
        fl.joints.KinematicCoupling(centre, [3])
