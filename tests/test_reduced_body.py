"""Reduced-order bodies in time: laws of the equations, convergence to the full body, refusals."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from tests.assembled import Assembled, mass_and_stiffness

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)
AT_HOME = lie.se3_exp(np.zeros(6))


def part(cells=8, bow=0.0, G=AT_HOME):
    """A beam alone, perhaps bowed, which no mirror leaves as it is, moved by G."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.03, STEEL)

    def position(s):
        return tuple(G[0] + np.array((s, bow * np.sin(np.pi * s), bow * s**2)) @ G[1:])

    return scene, scene.add(fl.Beam(fl.mesh.curve(position, cells), section, name="rod", up=G[3]))


def reduced(modes=4, bow=0.1, cells=8, stretching=True):
    scene, beam = part(cells, bow)
    return fl.reduction.reduced_order_body(
        scene, [beam.point("start"), beam.point("end")], modes, stretching=stretching
    ), beam


class Anywhere(Assembled):
    """Equations of a free body in any state: large motion, any deformation."""

    def __init__(self, rng, group=fl.lie.Group.SE3, gravity=(1.0, -2.0, 3.0)):
        self.body, self.full = reduced()
        scene = fl.Scene(gravity=gravity)
        scene.add(self.body)
        super().__init__(scene, dynamics=True, group=group)
        n = self.count
        self.h = 0.05 * rng.normal(size=(n, 6))
        self.v, self.a = 3.0 * rng.normal(size=(n, 6)), 10.0 * rng.normal(size=(n, 6))
        G = lie.se3_exp(rng.normal(size=6))
        H = self.start.copy()
        frames = node_types.has_position(self.kinds)
        H[:n][frames] = lie.se3_compose(G, H[:n][frames])
        self.H = self.moved(H, self.h)

    def moved(self, H, h):
        """On the group of the run."""
        out, n = H.copy(), self.count
        node_types.retract_all(self.kinds, np.ascontiguousarray(H[:n]), h, out[:n])
        return out

    def along(self, step, d, rates, seconds):
        """Residual where frames have moved by ``d``, and velocities of the group by the rest."""
        n = self.count
        v, a = np.empty((2, n, 6))
        node_types.all_from_local(self.kinds, self.H[:n], self.v, self.a, v, a)
        H = self.moved(self.H, step * d)
        shift = np.stack([rates, seconds])
        for x in shift:
            node_types.all_to_group(self.kinds, self.H[:n], x)
        twist, rate = np.empty((2, n, 6))
        for i in range(n):
            moved = v[i] + step * shift[0, i], a[i] + step * shift[1, i]
            node_types.to_local(self.kinds[i], H[i], *moved, twist[i], rate[i])
        return self.residual(H, twist, rate)


@pytest.mark.parametrize("group", list(fl.lie.Group))
@pytest.mark.parametrize("factors", [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
def test_the_matrix_is_the_derivative_of_the_equations(rng, group, factors):
    at, (mass, damping) = Anywhere(rng, group), factors
    free = ~at.held
    x = np.where(free, rng.normal(size=(at.count, 6)), 0.0)
    S = at.matrix(at.H, at.v, at.a, mass=mass, damping=damping)
    rest = damping * x, mass * x
    numeric = (at.along(1e-6, x, *rest) - at.along(-1e-6, x, *rest)) / 2e-6
    error = np.abs(S @ x.ravel() - numeric)[free.ravel()]
    assert error.max() < 2e-8 * np.abs(numeric).max()


def test_forces_are_independent_of_position_and_orientation(rng):
    at = Anywhere(rng, gravity=(0, 0, 0))
    n, G = at.count, lie.se3_exp(rng.normal(size=6))
    H = at.H.copy()
    frames = node_types.has_position(at.kinds)
    H[:n][frames] = lie.se3_compose(G, H[:n][frames])
    here, there = (at.residual(where, at.v, at.a) for where in (at.H, H))
    np.testing.assert_allclose(there, here, atol=1e-11 * np.abs(here).max())


def test_a_rigid_motion_strains_nothing_and_moves_as_the_body_does():
    body, full = reduced()
    scene = fl.Scene()
    scene.add(body)
    body.add_velocity(omega=(1.0, 2.0, 3.0), about=(0.3, 0.1, -0.2))
    full.add_velocity(omega=(1.0, 2.0, 3.0), about=(0.3, 0.1, -0.2))
    whole = fl.Scene()
    whole.add(full)
    found, wanted = (fl.GeneralisedAlpha().run(s, duration=1e-3, step=1e-3) for s in (scene, whole))
    assert found.elastic[0] < 1e-20 * found.kinetic[0]
    assert found.kinetic[0] == pytest.approx(wanted.kinetic[0], rel=1e-12)
    np.testing.assert_allclose(found.momentum[0], wanted.momentum[0], atol=1e-12)
    np.testing.assert_allclose(found.angular_momentum[0], wanted.angular_momentum[0], atol=1e-12)
    np.testing.assert_allclose(
        fl.reduction.recover_full_motion(found, body).velocities[0],
        wanted.velocities[0],
        atol=1e-12,
    )


def flight(step):
    """A free body that is bent and spins."""
    body, _ = reduced()
    scene = fl.Scene()
    scene.add(body)
    body.add_velocity(omega=(0.0, 5.0, 20.0), about=(0.5, 0.0, 0.0))
    body.velocities[1, 1] += 2.0
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-10)
    return fl.GeneralisedAlpha.run(scheme, scene, duration=0.02, step=step)


def test_a_free_body_keeps_energy_and_momenta_as_the_scheme_does():
    """Errors of energy and of angular momentum fall with the square of the step."""
    coarse, fine = (flight(h) for h in (4e-5, 2e-5))
    assert fine.elastic.max() > 1e-3 * fine.kinetic[0]

    def away(result):
        L = result.angular_momentum
        P = np.abs(result.momentum - result.momentum[0]).max()
        return result.energy_error, np.abs(L - L[0]).max() / np.abs(L).max(), P

    first, second = away(coarse), away(fine)
    assert second[0] < 1e-3 and 3.0 < first[0] / second[0] < 5.5
    assert second[1] < 1e-3 and 3.0 < first[1] / second[1] < 5.5


def swing(body, record=fl.schemes.Record.ALL):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
    scene.add(fl.PointLoad(body.point("end"), force=(0, 20.0, 0)))
    return fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.3, step=1e-3, record=record)


def test_more_shapes_come_nearer_to_the_full_body():
    whole = swing(part(8, 0.1)[1])

    def away(*made, **chosen):
        body, _ = reduced(*made, **chosen)
        found = fl.reduction.recover_full_motion(swing(body), body)
        return np.linalg.norm(found.frames[:, :, 0] - whole.frames[:, :, 0], axis=2).max()

    few, more, most = (away(modes) for modes in (0, 4, 6))
    assert few > 5 * more > 6 * most and most < 3e-6
    assert away(6, stretching=False) > 5 * most


def test_inertial_modes_respond_to_weight_as_the_full_body():
    """With no vibration at all: between clamps, along and across a bowed beam."""
    positions = []
    for body in (reduced(0)[0], part(8, 0.1)[1]):
        scene = fl.Scene(gravity=(0.1, -0.2, 0.3))
        scene.add(body)
        scene.add(fl.Clamp(body.point("start")))
        scene.add(fl.Clamp(body.point("end")))
        frames = fl.statics(scene).frames[-1]
        positions.append(
            body.model.expand(frames[np.newaxis])[0] if len(positions) == 0 else frames
        )
    found, wanted = (frames[:, 0] - reduced()[1].frames[:, 0] for frames in positions)
    assert np.abs(found - wanted).max() < 1e-5 * np.abs(wanted).max()


@pytest.mark.parametrize("spinning", [False, True])
def test_inertial_shapes_have_unit_mass_and_are_in_the_order_of_stiffness(spinning):
    scene, beam = part(8, 0.1)
    basis = fl.reduction.inertial_modes(
        scene, [beam.point("start"), beam.point("end")], 4, spinning=spinning
    )
    M, K = mass_and_stiffness(scene, basis.modes)
    np.testing.assert_allclose(M, np.eye(len(M)), atol=1e-6)
    np.testing.assert_allclose(K, np.diag(K.diagonal()), atol=1e-6 * np.abs(K).max())
    assert len(M) == (16 if spinning else 10)
    assert (np.diff(K.diagonal()) > 0.0).all()


def test_spin_stiffens():
    from benchmarks.reduction import spinning_reduced

    stretched, constant = (spinning_reduced(6, each) for each in (True, False))
    assert stretched["body_6_error_at_0"] < 1e-8
    assert stretched["body_6_error_at_5"] < 1e-3 and stretched["body_6_error_at_10"] < 2e-3
    assert constant["constant_6_error_at_2"] > 0.1


@pytest.mark.parametrize("first", [0, 1])
def test_interfaces_come_in_any_order(first):
    """A soft cantilever that is bent by a twentieth of its length, seen from either end."""
    rubber = fl.Section.circle(0.008, fl.Material(E=2e8, nu=0.3, density=2000.0))
    beam = fl.Beam.straight((0, 0, 0), (0.3, 0, 0), rubber, cells=16, name="rod")
    part = fl.Scene()
    part.add(beam)
    ends = [beam.point("start"), beam.point("end")]
    few = fl.reduction.reduced_order_body(part, ends if first == 0 else ends[::-1], 4)
    positions = []
    for body in (few, beam):
        scene = fl.Scene()
        scene.add(body)
        scene.add(fl.Clamp(body.point("start")))
        scene.add(fl.PointLoad(body.point("end"), force=(0, 0, 1.07)))
        positions.append(np.ravel(fl.statics(scene).displacement("rod.end"))[-3:])
    found, wanted = positions
    assert wanted[2] > 0.045 * 0.3
    assert np.abs(found - wanted).max() < 6e-3 * wanted[2]


def test_bending_draws_ends_together():
    """A beam that is bent by its thickness is shorter by what its slope takes."""
    ends = []
    for body in (reduced(6, 0.0)[0], reduced(6, 0.0, stretching=False)[0], part(8)[1]):
        scene = fl.Scene()
        scene.add(body)
        scene.add(fl.Clamp(body.point("start")))
        scene.add(fl.PointLoad(body.point("end"), force=(0, 0, 600.0)))
        ends.append(np.ravel(fl.statics(scene).displacement("rod.end"))[-3:])
    found, constant, wanted = ends
    assert wanted[2] > 0.02 and wanted[0] < -2e-4
    assert abs(found[0] - wanted[0]) < 0.02 * abs(wanted[0])
    assert abs(constant[0]) < 1e-3 * abs(wanted[0])


def test_velocities_are_those_of_the_full_body():
    body, _ = reduced(6)
    found, whole = fl.reduction.recover_full_motion(swing(body), body), swing(part(8, 0.1)[1])
    np.testing.assert_allclose(found.velocities[-1], whole.velocities[-1], atol=4e-3)


def test_frames_alone_are_expanded_and_projected():
    body, _ = reduced(6)
    less = fl.reduction.recover_full_motion(swing(body, fl.schemes.Record.FRAMES), body)
    np.testing.assert_array_equal(
        less.frames, fl.reduction.recover_full_motion(swing(body), body).frames
    )
    with pytest.raises(AttributeError, match="velocities was not recorded"):
        _ = less.velocities
    states = fl.reduction.pod(less, part(8, 0.1)[1], 3).project(less)
    np.testing.assert_array_equal(states.within(less).frames, states.expand())


def test_joints_supports_and_points_stay_where_they_are_in_full_fields():
    """Behind another body, with interfaces whose numbers are others."""
    body, scene = reduced(2)[0], fl.Scene(gravity=(0, 0, -9.81))
    for name in ("ball", "bob"):
        scene.add(fl.RigidBody(1.0, 0.1 * np.eye(3), body.point("end").position, name=name))
    ball, bob = scene.bodies
    scene.add(body)
    scene.add(fl.joints.Spherical(ball.point("centre"), body.point("end")))
    scene.add(fl.joints.Spherical(body.point("end"), bob.point("centre")))
    scene.add(fl.Clamp(body.point("start")))
    result = fl.GeneralisedAlpha().run(scene, duration=2e-3, step=1e-3)
    found = fl.reduction.recover_full_motion(result, body)
    pairs = [(j.node, k.node) for j, k in zip(result.info.joints, found.info.joints, strict=True)]
    pairs += zip(result.info.supports.nodes, found.info.supports.nodes, strict=True)
    assert len(pairs) > 2
    for old, new in pairs:
        np.testing.assert_array_equal(found.frames[:, new], result.frames[:, old])
    for name in ("ball.centre", "rod.start", "rod.end"):
        np.testing.assert_array_equal(found.position(name), result.position(name))


def test_balances_are_those_of_the_full_body():
    """Weight, reactions and the rate of angular momentum agree, of the reduced body by itself."""
    body, _ = reduced()
    found = swing(body)
    whole = swing(part(8, 0.1)[1])
    left = found.momentum - found.momentum[0] - found.impulses.sum(axis=1)[:, :3]
    turned = found.angular_momentum - found.angular_momentum[0]
    left_turning = turned - found.impulses.sum(axis=1)[:, 3:]
    scale = np.abs(found.impulses).max()
    assert np.abs(left).max() < 1e-3 * scale and np.abs(left_turning).max() < 1e-3 * scale
    assert found.energy_error < 1e-4
    np.testing.assert_allclose(found.impulses[-1], whole.impulses[-1], atol=1e-3 * scale)


def test_statics_and_vibrations_take_it():
    body, full = reduced(8)
    scenes = []
    for each in (body, full):
        scene = fl.Scene()
        scene.add(each)
        scene.add(fl.Clamp(each.point("start")))
        scene.add(fl.PointLoad(each.point("end"), force=(0, 1.0, 2.0)))
        scenes.append(scene)
    states = (fl.statics(scene) for scene in scenes)
    found, wanted = (np.ravel(result.displacement("rod.end"))[-3:] for result in states)
    assert np.linalg.norm(found - wanted) < 1e-3 * np.linalg.norm(wanted)
    lowest = [fl.vibrations(scene.with_loads(), 3).frequencies for scene in scenes]
    np.testing.assert_allclose(*lowest, rtol=1e-3)


@pytest.mark.parametrize("scheme", [fl.Explicit(), fl.schemes.Asynchronous()], ids=str)
@pytest.mark.parametrize("modes", [0, 4])
def test_other_schemes_refuse(scheme, modes):
    scene = fl.Scene()
    scene.add(reduced(modes)[0])
    with pytest.raises(ValueError, match=r"reduced-order|without frames|than positions"):
        scheme.run(scene, duration=1e-3, step=1e-3)


def test_bad_input():
    scene, beam = part()
    with pytest.raises(ValueError, match="expected at least one"):
        fl.reduction.reduced_order_body(scene, [], 3)
    strange, rod = part()
    other = fl.reduction.craig_bampton(strange, [rod.point("start")], 2)
    with pytest.raises(ValueError, match="not the body"):
        fl.reduction.reduced_order_body(scene, [beam.point("start")], other)
    body = fl.reduction.reduced_order_body(scene, [beam.point("start"), beam.point("end")], 3)
    with pytest.raises(ValueError, match="interfaces 0 … 1"):
        body.point(2)
    matrices = (
        body.model.interfaces,
        body.model.stiffness,
        body.model.density,
        body.model.modes,
        beam,
    )
    with pytest.raises(ValueError, match="quadratic must have shape"):
        fl.reduction.ReducedOrderBody(*matrices, points={}, quadratic=np.zeros((2, 2, 2)))
    few, size = body.model.stiffness[:4, :4], np.abs(body.model.stiffness).max()
    uneven = body.model.stiffness + 1e-6 * size * np.eye(len(body.model.stiffness), k=1)
    for wrong, message in (
        ((body.model.interfaces, uneven, *matrices[2:]), "stiffness must be symmetric"),
        ((*matrices[:2], np.eye(5), *matrices[3:]), "density must be finite and of shape"),
        (
            (*matrices[:2], np.full_like(body.model.density, np.nan), *matrices[3:]),
            "density must be finite",
        ),
        ((body.model.interfaces, few, np.eye(16), *matrices[3:]), "have 6 coordinates, got 4"),
    ):
        with pytest.raises(ValueError, match=message):
            fl.reduction.ReducedOrderBody(*wrong, points={})
    with pytest.raises(ValueError, match="no point 'middle'"):
        body.point("middle")
    damped, section = fl.Scene(), fl.Section.rectangle(0.02, 0.03, STEEL)
    rod = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), section, cells=2, damping=fl.sections.Damping(mass=1.0)
    )
    damped.add(rod)
    with pytest.raises(ValueError, match="has damping"):
        fl.reduction.reduced_order_body(damped, [rod.point("start")], 2)
    solid = fl.Scene()
    brick = solid.add(
        fl.Solid.brick((1, 1, 2), fl.sections.NeoHooke(1e6, 0.3, 1000.0), cells=(1, 1, 2))
    )
    with pytest.raises(ValueError, match="a basis needs nodes with frames, and nodes of"):
        fl.reduction.reduced_order_body(solid, [brick.point(0)], 2)
    scene.add(fl.Clamp(beam.point("end")))
    with pytest.raises(ValueError, match="held"):
        fl.reduction.reduced_order_body(scene, [beam.point("start")], 3)
    with pytest.raises(ValueError, match="no body"):
        fl.reduction.recover_full_motion(swing(part()[1]), replace_name(body))


def replace_name(body):
    body.name = "another"
    return body


def test_a_part_is_used_elsewhere(tmp_path):
    """Made in one posture and put into a scene in another one, with the world turned alike."""
    body, _ = reduced(4)
    fl.reduction.save_reduced(body, tmp_path / "part.h5")
    G = lie.se3_exp(np.array([0.3, -0.2, 0.5, 0.4, -1.1, 0.8]))
    again = fl.reduction.load_reduced(tmp_path / "part.h5", part(8, 0.1, G)[1])
    states = []
    for each, turn in ((body, np.eye(3)), (again, G[1:].T)):
        scene = fl.Scene(gravity=turn @ (0.0, 0.0, -9.81))
        scene.add(each)
        scene.add(fl.joints.Revolute(fl.ground(), each.point("start"), axis=turn @ (0.0, 1.0, 0.0)))
        result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.1, step=1e-3)
        states.append(fl.reduction.recover_full_motion(result, each).frames[-1])
    np.testing.assert_allclose(states[1], lie.se3_compose(G, states[0]), atol=1e-9)


def test_a_part_is_kept_in_a_file(tmp_path):
    body, full = reduced(4)
    path = tmp_path / "part.h5"
    fl.reduction.save_reduced(body, path)
    again = fl.reduction.load_reduced(path, full)
    assert again.model.point_names == body.model.point_names and again.name == body.name
    here, there = (swing(each).frames for each in (body, again))
    np.testing.assert_array_equal(here, there)
    with pytest.raises(ValueError, match="another mesh: 9 nodes and 8 cells"):
        fl.reduction.load_reduced(path, part(4)[1])
    with pytest.raises(ValueError, match="other positions"):
        fl.reduction.load_reduced(path, part(8, 0.2)[1])
    with pytest.raises(ValueError, match="no basis"):
        fl.reduction.load_basis(path, full)


def test_reduced_pendulum():
    from demos.reduced_pendulum import main

    record = main(duration=0.02, pictures=False)
    assert record["modes"] == 18
    assert record["motion_error"] < 1e-6
    assert record["moment_error"] < 1e-3
    assert record["stress_error"] < 1e-2
