"""Ties of solids with different meshes on a common face."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

YOUNG, POISSON = 2e6, 0.3
STEEL = fl.sections.SaintVenantKirchhoff(E=YOUNG, nu=POISSON, density=1000.0)
TIGHT = fl.schemes.Newton(tolerance=1e-13)
NORMALS = {
    f"{axis}={end}": (2 * end - 1) * unit
    for axis, unit in zip("abc", np.eye(3), strict=True)
    for end in (0, 1)
}


def brick(cells, name, origin=(0, 0, 0), lengths=(1, 1, 1), **options):
    return fl.Solid.brick(lengths, STEEL, cells=cells, origin=origin, name=name, **options)


def scene_of(*bodies):
    scene = fl.Scene()
    for body in bodies:
        scene.add(body)
    return scene


def positions(result, name):
    nodes = next(body.nodes for body in result.info.bodies if body.name == name)
    return result.frames[-1, nodes, 0]


TETRAHEDRA = {"cell": "tetrahedron", "degree": 2}
MESHES = {
    "finer first": ((3, 3, 1), {}, (2, 2, 1), {}),
    "coarser first": ((2, 1, 1), {}, (3, 2, 1), {}),
    "quadratic on linear": ((2, 2, 1), {"degree": 2}, (3, 3, 1), {}),
    "tetrahedra on hexahedra": ((2, 2, 1), TETRAHEDRA, (3, 1, 1), {"degree": 2}),
}


@pytest.mark.parametrize("name", MESHES)
def test_constant_stress_passes_the_face(name):
    """Stretched, sheared: the first Piola-Kirchhoff stress of a gradient F acts on all faces."""
    F = np.array([[1.1, 0.1, 0.05], [0.0, 0.95, 0.08], [0.0, 0.0, 1.05]])
    E = 0.5 * (F.T @ F - np.eye(3))
    first_lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    P = F @ (first_lame * np.trace(E) * np.eye(3) + YOUNG / (1 + POISSON) * E)
    cells, options, others, more = MESHES[name]
    below, above = brick(cells, "below", **options), brick(others, "above", (0, 0, 1), **more)
    scene = scene_of(below, above)
    below.clamp("000")
    for corner, axis in (("100", (0, 1, 0)), ("100", (0, 0, 1)), ("010", (0, 0, 1))):
        below.roller(corner, normal=axis)
    for body, within in ((below, "c=1"), (above, "c=0")):
        for face, normal in NORMALS.items():
            if face != within:
                scene.add(fl.loads.FaceLoad(body, face, force=P @ normal))
    tie = scene.add(fl.joints.Tie(below, "c=1", above, "c=0"))
    result = fl.statics(scene, newton=TIGHT)
    for body in (below, above):
        expected = body.frames[:, 0] @ F.T
        np.testing.assert_allclose(positions(result, body.name), expected, atol=1e-10)
    force = result.joint_force(tie, axes="global")[-1, :3]
    np.testing.assert_allclose(force, P[:, 2], atol=1e-9 * YOUNG)


def test_supports_that_hold_corners_of_the_tie_leave_constant_stress():
    """Also along inclined axes: no constraint is redundant."""
    turn = lie.so3_exp([0.3, -0.2, 0.5])
    halves = [
        fl.Solid(
            fl.mesh.parametric_volume(lambda a, b, c, at=at: turn @ (a + at, b, c), cells),
            STEEL,
            name=name,
        )
        for name, cells, at in (("left", (1, 3, 3), 0.0), ("right", (1, 2, 2), 1.0))
    ]
    scene = scene_of(*halves)
    for half in halves:
        half.roller("b=0", normal=turn[:, 1])
        half.roller("c=0", normal=turn[:, 2])
    halves[0].roller("a=0", normal=turn[:, 0])
    scene.add(fl.loads.FaceLoad(halves[1], "a=1", force=1e5 * turn[:, 0]))
    tie = scene.add(fl.joints.Tie(halves[0], "a=1", halves[1], "a=0"))
    result = fl.statics(scene, newton=TIGHT)
    np.testing.assert_allclose(
        result.joint_force(tie, axes="global")[-1, :3], 1e5 * turn[:, 0], atol=1e-5
    )
    at = [positions(result, half.name) @ turn for half in halves]
    local = [half.frames[:, 0] @ turn for half in halves]
    stretches = at[0][local[0][:, 0] > 0.5].max(axis=0)
    for found, before in zip(at, local, strict=True):
        np.testing.assert_allclose(found, before * stretches, atol=1e-10)


def test_tied_equal_meshes_are_one_body():
    tips = []
    for tied in (False, True):
        if tied:
            root, end = brick((2, 2, 2), "root"), brick((2, 2, 2), "end", (1, 0, 0))
            scene = scene_of(root, end)
            scene.add(fl.joints.Tie(end, "a=0", root, "a=1"))
        else:
            root = end = brick((4, 2, 2), "end", lengths=(2, 1, 1))
            scene = scene_of(root)
        root.clamp("a=0")
        scene.add(fl.loads.FaceLoad(end, "a=1", force=(0, 0, -2e4)))
        tips.append(fl.statics(scene, newton=TIGHT).displacement("end.111")[-1])
    np.testing.assert_allclose(tips[1], tips[0], rtol=1e-12, atol=1e-14)


def test_cantilever_of_two_halves_converges_to_one_body():
    def sag(parts):
        bodies, at = [], 0.0
        for k, (cells, length) in enumerate(parts):
            bodies.append(brick(cells, f"{k}", (at, 0, 0), (length, 1, 1), degree=2))
            at += length
        scene = scene_of(*bodies)
        for before, after in pairwise(bodies):
            scene.add(fl.joints.Tie(after, "a=0", before, "a=1"))
        bodies[0].clamp("a=0")
        scene.add(fl.loads.FaceLoad(bodies[-1], "a=1", force=(0, 0, -10.0)))
        return fl.statics(scene).displacement(bodies[-1].point("111"))[-1, 2]

    exact = sag([((16, 2, 2), 6.0)])
    meshes = ([((2 * n, n, n), 3.0), ((3 * n, 2 * n, n), 3.0)] for n in (1, 2))
    errors = [abs(sag(mesh) / exact - 1) for mesh in meshes]
    assert errors[1] < 0.4 * errors[0] < 0.02


def spinning(scheme, turn=None):
    """Two tied blocks in free flight; ``turn`` rotates all at the start."""
    R = np.eye(3) if turn is None else lie.so3_exp(turn)
    halves = [
        fl.Solid(
            fl.mesh.parametric_volume(lambda a, b, c, at=at: R @ (a, b, c + at), cells),
            STEEL,
            name=name,
        )
        for name, cells, at in (("below", (3, 2, 1), 0.0), ("above", (2, 1, 1), 1.0))
    ]
    scene = scene_of(*halves)
    for half in halves:
        half.add_velocity(R @ (0.3, -0.2, 0.1), omega=R @ (1, 3, -2), about=R @ (0.5, 0.5, 1))
    scene.add(fl.joints.Tie(halves[0], "c=1", halves[1], "c=0", name="glue"))
    return R, scheme.run(scene, duration=0.05, step=5e-3)


def test_energy_momentum_conserves_all_and_does_not_depend_on_axes():
    (_, result), (R, turned) = (
        spinning(fl.EnergyMomentum(), turn) for turn in (None, (0.3, 1, -2))
    )
    assert result.energy_error < 1e-12
    assert result.momentum_error < 1e-12 and result.angular_momentum_error < 1e-12
    assert np.abs(result.joint_force("glue", axes="global")).max() > 1e3
    for name in ("below", "above"):
        expected = positions(result, name) @ R.T
        np.testing.assert_allclose(positions(turned, name), expected, atol=1e-10)


def test_generalised_alpha_conserves_momentum():
    _, result = spinning(fl.GeneralisedAlpha(tolerance=1e-12))
    assert result.momentum_error < 1e-12


def test_a_released_tie_has_no_force():
    below, above = brick((2, 2, 1), "below"), brick((1, 1, 1), "above", (0, 0, 1))
    below.clamp("c=0")
    scene = scene_of(below, above)
    scene.gravity = (0, 0, 9.81)
    tie = scene.add(fl.joints.Tie(below, "c=1", above, "c=0"))
    scene.add(fl.schemes.Event(lambda state: state.time - 0.005, fl.schemes.Release(tie)))
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3)
    force = result.joint_force(tie, axes="global")[:, 2]
    assert abs(force[2]) > 1.0 and force[-1] == 0.0


def pair(**options):
    below = brick((2, 2, 1), "below")
    above = brick((3, 3, 1), "above", **{"origin": (0, 0, 1)} | options)
    return below, above


@pytest.mark.parametrize(
    ("sides", "message"),
    [
        (pair(origin=(0, 0, 1.01)), "have a distance of 0.01 at"),
        (pair(origin=(0, 0, 9)), "the closest nodes are 8 from each other"),
        (pair(lengths=(0.5, 1, 1)), "expected below.c=1 within above.c=0, which covers"),
    ],
)
def test_faces_that_do_not_fit_have_a_message(sides, message):
    scene, (below, above) = scene_of(*sides), sides
    with pytest.raises(ValueError, match=message):
        scene.add(fl.joints.Tie(below, "c=1", above, "c=0"))


def test_wrong_arguments_have_a_message():
    below, above = pair()
    ball = fl.RigidBody(1.0, (1, 1, 1), position=(0, 0, 0))
    scene = scene_of(below, above, ball)
    with pytest.raises(TypeError, match="Tie: second"):
        fl.joints.Tie(below, "c=1", ball, "c=0")
    with pytest.raises(ValueError, match="top"):
        scene.add(fl.joints.Tie(below, "top", above, "c=0"))
    with pytest.raises(ValueError, match="expected faces of two solids"):
        scene.add(fl.joints.Tie(below, "c=1", below, "c=0"))


def test_ties_that_follow_from_others_are_refused_by_name():
    """Three blocks around an edge: the third tie repeats some constraints of the edge."""
    blocks = [
        brick((2, 2, 2), "one"),
        brick((2, 2, 2), "two", (1, 0, 0)),
        brick((2, 2, 2), "three", (0, 1, 0), (2, 1, 1)),
    ]
    scene = scene_of(*blocks)
    scene.add(fl.joints.Tie(blocks[0], "a=1", blocks[1], "a=0"))
    scene.add(fl.joints.Tie(blocks[0], "b=1", blocks[2], "b=0"))
    scene.add(fl.joints.Tie(blocks[1], "b=1", blocks[2], "b=0", name="third"))
    with pytest.raises(ValueError, match="constraints are redundant"):
        fl.statics(scene)
