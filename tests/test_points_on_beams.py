"""Joints at points within elements of beams: as at nodes, in statics, in time and about states."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

SECTION = fl.Section.circle(0.02, fl.Material(2e7, 0.3, 1000.0))
ELEMENTS = {
    "geodesic": None,
    "two directors": fl.elements.DirectorBeam(1),
    "three": fl.elements.DirectorBeam(2),
}
PLACE = 1.0 / np.sqrt(5.0)  # no mesh has a node there but by intention

every_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def beam_of(element, cells: int) -> tuple[fl.Beam, fl.extend.Point]:
    """With the position within an element."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=cells, formulation=element)
    return beam, beam.point((PLACE, 0, 0))


def meshed(element, cells: int) -> tuple[fl.Beam, fl.extend.Point]:
    """With a node at the position."""
    both = [round(cells * PLACE), round(cells * (1.0 - PLACE))]
    points = [(0, 0, 0), (PLACE, 0, 0), (1, 0, 0)]
    beam = fl.Beam.polyline(points, SECTION, cells=both, formulation=element)
    return beam, beam.point("corner 1")


def propped(beam: fl.Beam, point_at: fl.extend.Point) -> tuple[np.ndarray, np.ndarray]:
    """Where the end of a clamped beam goes that is held at the position, and the force there."""
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    prop = scene.add(fl.joints.Spherical(fl.ground(), point_at))
    scene.add(fl.PointLoad(beam.point("end"), (0, 0.03, -0.4)))
    result = fl.statics(scene)
    return result.position(beam.point("end"))[-1], result.joint_force(prop)[-1]


@every_element
def test_statics_converge_to_a_mesh_with_a_node_there(element):
    wanted, force = propped(*meshed(element, 40))
    off = []
    for cells in (4, 16):
        end, held = propped(*beam_of(element, cells))
        off.append(np.linalg.norm(end - wanted))
    # of second order at the least, but where in its element the position is differs
    assert off[1] < off[0] / 8.0
    assert off[1] < 2e-4
    np.testing.assert_allclose(held, force, atol=0.02 * np.linalg.norm(force))


@every_element
def test_a_weight_hangs_where_it_is_fixed(element):
    scene = fl.Scene(gravity=(0, 0, -10))
    beam, point_at = beam_of(element, 2)
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    weight = scene.add(fl.RigidBody(0.03, (1e-5,) * 3, point_at.position))
    hook = scene.add(fl.joints.Fixed(point_at, weight.point("centre")))
    result = fl.statics(scene)
    assert result.position(beam.point("end"))[-1, 2] < -0.05
    axes = result.rotation(weight.point("centre"))[-1] @ hook.frame()[1:].T
    np.testing.assert_allclose(axes @ result.joint_force(hook)[-1, :3], (0, 0, -0.3), atol=1e-10)


@pytest.mark.parametrize("following", [False, True], ids=["fixed", "following"])
@every_element
def test_loads_at_a_position_are_those_at_a_node_there(element, following):
    ends = []
    for beam, point_at in (beam_of(element, 4), beam_of(element, 16), meshed(element, 40)):
        scene = fl.Scene()
        scene.add(beam)
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(point_at, (0.1, 0.2, -0.5), (0.02, 0, 0.03), following=following))
        result = fl.statics(scene)
        ends.append(result.position(beam.point("end"))[-1])
    coarse, fine = (np.linalg.norm(end - ends[-1]) for end in ends[:-1])
    # the moment is of first order
    assert fine < 0.01 * np.linalg.norm(ends[-1] - (1, 0, 0))
    assert fine < coarse / 2.0


@every_element
def test_a_load_within_an_element_does_the_work_in_the_balance(element):
    beam, point_at = beam_of(element, 3)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.PointLoad(point_at, (0, 0.01, -0.03), (0.002, 0, 0.001)))
    scene.add(fl.PointLoad(beam.point((0.8, 0, 0)), (0, 0, 0.03), following=True, history=np.cos))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=0.3, step=2e-3)
    assert result.balance[-1, 0] > 1e-4
    assert result.balance_error < 1e-3
    impulse = result.impulses[:, 0, :3]
    np.testing.assert_allclose(result.momentum, impulse, atol=2e-3 * np.abs(impulse).max())


def pendulum(beam, point_at, *, sprung: bool = False, scheme=None, step=1e-3, duration=0.1):
    """A beam that swings about the position, with a spring and damper there if it is sprung."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    hinge = scene.add(fl.joints.Revolute(fl.ground(), point_at, axis=(0, 1, 0), name="hinge"))
    if sprung:
        scene.add(fl.joints.Spring(hinge.angle, stiffness=0.5, damping=0.05))
        reach = scene.add(fl.joints.Distance(point_at, beam.point("end"), at=(PLACE, 0, 0.1)))
        scene.add(fl.joints.Spring(reach.length, stiffness=3.0))
    scheme = scheme or fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    return scheme.run(scene, duration=duration, step=step)


@every_element
@pytest.mark.parametrize("sprung", [False, True], ids=["free", "sprung"])
def test_a_pendulum_keeps_its_energy_and_stays_closed(element, sprung):
    result = pendulum(*beam_of(element, 6), sprung=sprung)
    assert result.joint_violations.max() < 1e-12
    assert result.balance_error < 2e-5
    assert (result.balance[-1, 1] > 1e-6) == sprung
    wanted = pendulum(*meshed(element, 12), sprung=sprung).position("beam 1.end")[-1]
    far = np.linalg.norm(result.position("beam 1.end")[-1] - wanted)
    # three per cent are those of two directors, one per thousand those of others
    assert far < 0.03 * np.linalg.norm(wanted - (1, 0, 0))


def test_second_order_in_time_of_motion_and_force():
    ends, forces = [], []
    for steps in (100, 200, 400):
        result = pendulum(*beam_of(None, 3), sprung=True, step=0.1 / steps)
        ends.append(result.position("beam 1.end")[-1])
        forces.append(result.joint_force("hinge")[-1])
    for values in (ends, forces):
        coarse, fine = np.linalg.norm(np.diff(values, axis=0), axis=1)
        assert 3.3 < coarse / fine < 5.0


@pytest.mark.parametrize(
    "options",
    [
        {"policy": fl.schemes.EveryIteration()},
        {"policy": fl.schemes.ConstraintsOnly()},
        {"matrix_frame": fl.schemes.MatrixFrame.INERTIAL},
        {"index": fl.schemes.ConstraintIndex.STABILISED_TWO},
        {"group": fl.lie.Group.R3xSO3},
    ],
    ids=lambda options: next(iter(options)),
)
def test_the_motion_is_the_same_by_any_matrix_and_on_any_group(options):
    beam, point_at = beam_of(None, 3)
    wanted = pendulum(beam, point_at, sprung=True, duration=0.03).position("beam 1.end")
    options = dict(options)
    group = options.pop("group", None)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10, **options)
    beam, point_at = beam_of(None, 3)
    if group is not None:
        beam.set_group(group)
    result = pendulum(beam, point_at, sprung=True, scheme=scheme, duration=0.03)
    # stabilised and on another group it is another scheme of second order
    bound = 1e-9 if {"policy", "matrix_frame"} & set(options) else 1e-4
    np.testing.assert_allclose(result.position("beam 1.end"), wanted, atol=bound)
    assert result.joint_violations.max() < 1e-12


def test_steps_that_are_chosen():
    wanted = pendulum(*beam_of(None, 3), step=2.5e-4)
    result = pendulum(*beam_of(None, 3), step=fl.schemes.AdaptiveStep(1e-5))
    assert result.joint_violations.max() < 1e-12
    far = result.position("beam 1.end")[-1] - wanted.position("beam 1.end")[-1]
    assert np.linalg.norm(far) < 1e-4


def test_what_turns_with_all_does_not_change():
    """The same pendulum, elsewhere and along other axes, in the same steps."""
    turn = lie.so3_exp(np.array([0.4, -0.3, 0.8]))
    found = []
    for R, origin in ((np.eye(3), np.zeros(3)), (turn, np.array([3.0, -1.0, 2.0]))):
        scene = fl.Scene(gravity=R @ (0, 0, -9.81))
        up = None if R is turn else (0, 0, 1)
        ends = origin, origin + R[:, 0]
        beam = fl.Beam.straight(*ends, SECTION, cells=3, up=R[:, 2] if up is None else up)
        scene.add(beam)
        scene.add(
            fl.joints.Revolute(fl.ground(), beam.point(origin + PLACE * R[:, 0]), axis=R[:, 1])
        )
        scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-11)
        result = scheme.run(scene, duration=0.05, step=1e-3)
        found.append((result.position(beam.point("end")) - origin) @ R)
    np.testing.assert_allclose(*found, atol=1e-9)


@every_element
def test_vibrations_are_those_of_a_mesh_with_a_node_there(element):
    found = []
    for beam, point_at in (beam_of(element, 8), beam_of(element, 32), meshed(element, 48)):
        scene = fl.Scene()
        scene.add(beam)
        scene.add(fl.joints.Revolute(fl.ground(), point_at, axis=(0, 1, 0)))
        scene.add(fl.Clamp(beam.point("start")))
        found.append(fl.vibrations(scene, 4).frequencies)
    coarse, fine = (np.abs(frequencies / found[-1] - 1.0).max() for frequencies in found[:-1])
    # a moment within an element bends it as if it acted at both ends: of first order
    assert fine < 0.03
    assert fine < coarse / 2.0


def test_a_position_that_is_moved_and_one_that_is_driven():
    """A beam is turned about its position; another hangs on its end by a coordinate that grows."""
    scene = fl.Scene()
    beam, point_at = beam_of(None, 3)
    scene.add(beam)
    start = point_at.frame

    def turned(time: float) -> np.ndarray:
        angle = np.array([0, 0, 0, 0, 0, 0.5 * time**3])
        return lie.se3_compose(start, lie.se3_exp(angle))

    motion = scene.add(fl.PrescribedMotion(point_at, turned))
    other = scene.add(fl.Beam.straight((1, -0.3, 0), (1, 0.5, 0), SECTION, cells=2))
    hinge = scene.add(fl.joints.Revolute(beam.point("end"), other.point((1, 0, 0))))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 0.4 * t**3))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-11)
    result = scheme.run(scene, duration=0.5, step=2e-3)
    np.testing.assert_allclose(result.coordinate(hinge)[-1], 0.4 * 0.5**3, atol=1e-12)
    assert result.joint_violations.max() < 1e-12
    assert result.balance_error < 1e-3
    assert np.abs(result.reaction(motion)[-1, 5]) > 1e-4


def test_checkpoints_know_where_positions_are(tmp_path):
    def swinging(point_at: float) -> fl.Scene:
        scene = fl.Scene(gravity=(0, 0, -9.81))
        beam = scene.add(beam_of(None, 2)[0])
        scene.add(
            fl.joints.Revolute(
                fl.ground(), beam.point((point_at, 0, 0)), at=(0.3, 0, 0), axis=(0, 1, 0)
            )
        )
        return scene

    scheme, file = fl.GeneralisedAlpha(), tmp_path / "run.h5"
    run = scheme.run(swinging(0.3), duration=0.01, step=1e-3, file=file, checkpoint_every=5)
    again = scheme.resume(swinging(0.3), file)
    np.testing.assert_array_equal(again.frames, run.frames)
    with pytest.raises(ValueError, match="constraint definitions of Revolute"):
        scheme.resume(swinging(0.31), file)


@pytest.mark.parametrize("following", [False, True])
def test_conserving_schemes_account_for_loads_on_position_nodes(following):
    """Their work and impulses, to round-off."""
    scene = fl.Scene()
    beam, point_at = beam_of(None, 2)
    scene.add(beam)
    beam.add_velocity(omega=(1.0, 2.0, 3.0), about=(0, 0, 0))
    load = {"force": (0, 0, 1), "moment": (0.1, 0, 0.2), "following": following}
    scene.add(fl.PointLoad(point_at, **load))
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3)
    assert abs(result.balance[-1, 0]) > 1e-6
    assert max(result.balance_error, result.momentum_error) <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_points_are_nodes_where_there_are_nodes():
    beam = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), SECTION, cells=4, formulation=fl.elements.DirectorBeam(2)
    )
    assert beam.point((0, 0, 0)).attachment is None
    assert beam.point((0.5, 0, 0)).attachment is None
    assert beam.point((1, 0, 0)).node == beam.point("end").node
    assert beam.point((0.125, 0, 0)).attachment is None  # the middle node of the first element
    assert beam.point((0.3, 0, 0)).same(beam.point_in_cell(1, 0.2))
    np.testing.assert_allclose(beam.point((0.3, 0, 0)).position, (0.3, 0, 0), atol=1e-15)


def test_the_closest_point_of_a_line_is_the_foot_of_the_perpendicular():
    beam = fl.Beam.straight((0, 0, 0), (3, 4, 0), SECTION, cells=3)
    foot, across = np.array([3, 4, 0]) * 0.37, np.array([-0.8, 0.6, 0])
    point = beam.point(foot + 0.02 * across, tolerance=0.03)
    np.testing.assert_allclose(point.position, foot, atol=1e-14)
    with pytest.raises(ValueError, match=r"no point at .* 0\.02 away, and the tolerance is 0\.01"):
        beam.point(foot + 0.02 * across, tolerance=0.01)


def test_points_on_an_arc():
    angle = np.pi / 3
    arc = fl.Beam.curve(lambda s: (np.sin(angle * s), 0, 1 - np.cos(angle * s)), SECTION, cells=3)
    position = (np.sin(0.4 * angle), 0, 1 - np.cos(0.4 * angle))
    np.testing.assert_allclose(arc.point(position).position, position, atol=1e-9)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda beam: beam.point((1.2, 0, 0)), "the closest one, node 2, is at .* 0.2 away"),
        (lambda beam: beam.point("middle"), "Beam has no point 'middle'; it has: end, start"),
        (lambda beam: beam.point(7), "Beam has nodes 0 … 2, got 7"),
        (lambda beam: beam.point(0.5), "a name, a node or the position of a point of Beam must be"),
        (lambda beam: beam.point((0, 0)), "must be 3 finite numbers, got \\(0, 0\\)"),
        (lambda beam: beam.points("top"), "no points or cells 'top'; it has: end, start"),
        (lambda beam: beam.point_in_cell(7, 0.5), "Beam has elements 0 … 1, got 7"),
        (lambda beam: beam.point_in_cell(0, 1.5), "a part of an element is 0 to 1, got 1.5"),
        (lambda beam: fl.Scene().add(fl.Clamp(beam.point((0.3, 0, 0)))), "a clamp needs a node"),
        (
            lambda beam: fl.Scene().add(
                fl.joints.RigidLink(beam.point("end"), beam.point((0.3, 0, 0)))
            ),
            "link needs a node",
        ),
        (
            lambda beam: fl.Scene().add(
                fl.joints.Fixed(*[beam.point((0.3, 0, 0)) for _ in range(2)])
            ),
            "to itself",
        ),
    ],
)
def test_what_a_point_cannot_be(wrong, message):
    beam, _ = beam_of(None, 2)
    with pytest.raises((ValueError, TypeError), match=message):
        wrong(beam)


@every_element
def test_results_know_where_positions_are_and_how_they_move(element):
    beam, point_at = beam_of(element, 2)
    result = pendulum(beam, point_at, duration=0.02)
    np.testing.assert_allclose(
        result.position(point_at), np.tile(point_at.position, (21, 1)), atol=1e-12
    )
    other = beam.point((0.8, 0, 0))
    ahead = np.diff(result.position(other), axis=0) / 1e-3
    moves = np.einsum("tij,tj->ti", result.rotation(other), result.velocity(other)[:, :3])
    # differences of steps against means of rates
    np.testing.assert_allclose(0.5 * (moves[1:] + moves[:-1]), ahead, atol=2e-3)
    assert np.abs(ahead).max() > 0.05
