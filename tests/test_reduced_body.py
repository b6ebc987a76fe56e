"""Bodies in few shapes in time: laws of the equations, convergence to the full body, refusals."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.lie import kinds
from fem_lie.lie.motions import Group
from fem_lie.system import System
from fem_lie.system.instant import Instant, Plan

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)
RNG = np.random.default_rng(7)


def part(cells=8, bow=0.0):
    """A beam alone, perhaps bowed, which no mirror leaves as it is."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    line = fl.curve(lambda s: (s, bow * np.sin(np.pi * s), bow * s**2), cells)
    return scene, scene.add(fl.Beam(line, section, name="rod"))


def reduced(modes=4, bow=0.1, cells=8):
    scene, beam = part(cells, bow)
    return fl.reduced_body(scene, [beam.start, beam.end], modes), beam


class Anywhere:
    """Equations of a free body in any state: large motion, any deformation."""

    def __init__(self, group=Group.SE3, gravity=(1.0, -2.0, 3.0)):
        self.body, self.full = reduced()
        scene = fl.Scene(gravity=gravity)
        scene.add(self.body)
        self.system = System(scene, dynamics=True, group=group)
        n = self.system.count
        self.h = 0.05 * RNG.normal(size=(n, 6))
        self.v, self.a = 3.0 * RNG.normal(size=(n, 6)), 10.0 * RNG.normal(size=(n, 6))
        G = lie.se3_exp(RNG.normal(size=6))
        H = self.system.frames.copy()
        frames = kinds.placed(self.system.kinds)
        H[:n][frames] = lie.se3_compose(G, H[:n][frames])
        self.H = self.moved(H, self.h)

    def moved(self, H, h):
        out, n = H.copy(), self.system.count
        kinds.follow_all(self.system.kinds, np.ascontiguousarray(H[:n]), h, out[:n])
        return out

    def residual(self, H, v, a):
        r = np.empty(self.system.size)
        self.system.residual(Instant(H, v, a, np.zeros(0)), np.ones(0), r)
        return r

    def along(self, step, d, rates, seconds):
        """Residual where frames have moved by ``d``, and velocities of the group by the rest."""
        s, n = self.system, self.system.count
        v, a = np.empty((2, n, 6))
        kinds.all_from_local(s.kinds, self.H[:n], self.v, self.a, v, a)
        H = self.moved(self.H, step * d)
        shift = np.stack([rates, seconds])
        for x in shift:
            kinds.all_to_group(s.kinds, self.H[:n], x)
        twist, rate = np.empty((2, n, 6))
        for i in range(n):
            moved = v[i] + step * shift[0, i], a[i] + step * shift[1, i]
            kinds.to_local(s.kinds[i], H[i], *moved, twist[i], rate[i])
        return self.residual(H, twist, rate)


@pytest.mark.parametrize("group", list(Group))
@pytest.mark.parametrize("factors", [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
def test_the_matrix_is_the_derivative_of_the_equations(group, factors):
    at = Anywhere(group)
    system, (mass, damping) = at.system, factors
    n = system.count
    forces, r = system.room(), np.empty(system.size)
    state = Instant(at.H, at.v, at.a, np.zeros(0))
    system.residual(state, np.ones(0), r, forces)
    plan = Plan(np.zeros((n, 6)), mass=mass, damping=damping, scale=np.zeros(0))
    system.fill_matrix(state, forces, plan)
    S = dense(system)
    x = RNG.normal(size=(n, 6))
    rest = damping * x, mass * x
    numeric = (at.along(1e-5, x, *rest) - at.along(-1e-5, x, *rest)) / 2e-5
    assert np.abs(S @ x.ravel() - numeric).max() < 2e-7 * np.abs(numeric).max()


def dense(system):
    """Of the blocks that were filled in."""
    import scipy.sparse as sp

    blocks, kkt = system.tangent.A, system.kkt
    return sp.bsr_matrix((blocks, kkt.indices, kkt.indptr)).toarray()


def test_forces_know_no_place_and_no_posture():
    at = Anywhere(gravity=(0, 0, 0))
    n, G = at.system.count, lie.se3_exp(RNG.normal(size=6))
    H = at.H.copy()
    frames = kinds.placed(at.system.kinds)
    H[:n][frames] = lie.se3_compose(G, H[:n][frames])
    here, there = (at.residual(where, at.v, at.a) for where in (at.H, H))
    np.testing.assert_allclose(there, here, atol=1e-11 * np.abs(here).max())


def test_a_rigid_motion_strains_nothing_and_moves_as_the_body_does():
    body, full = reduced()
    scene = fl.Scene()
    scene.add(body)
    body.turn((1.0, 2.0, 3.0), about=(0.3, 0.1, -0.2))
    full.turn((1.0, 2.0, 3.0), about=(0.3, 0.1, -0.2))
    whole = fl.Scene()
    whole.add(full)
    found, wanted = (fl.GeneralisedAlpha().run(s, duration=1e-3, step=1e-3) for s in (scene, whole))
    assert found.elastic[0] < 1e-20 * found.kinetic[0]
    assert found.kinetic[0] == pytest.approx(wanted.kinetic[0], rel=1e-12)
    np.testing.assert_allclose(found.momentum[0], wanted.momentum[0], atol=1e-12)
    np.testing.assert_allclose(found.angular_momentum[0], wanted.angular_momentum[0], atol=1e-12)
    np.testing.assert_allclose(
        fl.expand(found, body).velocities[0], wanted.velocities[0], atol=1e-12
    )


def flight(step):
    """A free body that is bent and spins."""
    body, _ = reduced()
    scene = fl.Scene()
    scene.add(body)
    body.turn((0.0, 5.0, 20.0), about=(0.5, 0.0, 0.0))
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


def swing(body, name="rod"):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(fl.Revolute(fl.ground(), body["start"], axis=(0, 1, 0)))
    scene.add(fl.PointLoad(body["end"], force=(0, 20.0, 0)))
    return fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.3, step=1e-3)


def test_more_shapes_come_nearer_to_the_full_body():
    whole = swing(part(8, 0.1)[1])
    errors = []
    for modes in (0, 2, 6):
        body, _ = reduced(modes)
        found = fl.expand(swing(body), body)
        errors.append(np.linalg.norm(found.frames[:, :, 0] - whole.frames[:, :, 0], axis=2).max())
    assert errors[0] > 2 * errors[1] > 4 * errors[2] or errors[2] < 2e-6
    np.testing.assert_allclose(found.velocities[-1], whole.velocities[-1], atol=2e-2)


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
        scene.add(fl.Clamp(each["start"]))
        scene.add(fl.PointLoad(each["end"], force=(0, 1.0, 2.0)))
        scenes.append(scene)
    states = (fl.statics(scene) for scene in scenes)
    found, wanted = (np.ravel(result.displacement("rod.end"))[-3:] for result in states)
    assert np.linalg.norm(found - wanted) < 1e-3 * np.linalg.norm(wanted)
    lowest = [fl.vibrations(scene.with_loads(), 3).frequencies for scene in scenes]
    np.testing.assert_allclose(*lowest, rtol=1e-3)


@pytest.mark.parametrize(
    "scheme", [fl.EnergyMomentum(), fl.Variational(), fl.Explicit(), fl.Asynchronous()], ids=str
)
@pytest.mark.parametrize("modes", [0, 4])
def test_other_schemes_refuse(scheme, modes):
    scene = fl.Scene()
    scene.add(reduced(modes)[0])
    with pytest.raises(ValueError, match=r"reduced bodies|no frames|no places"):
        scheme.run(scene, duration=1e-3, step=1e-3)


def test_bad_input():
    scene, beam = part()
    with pytest.raises(ValueError, match="an interface or more"):
        fl.reduced_body(scene, [], 3)
    strange, rod = part()
    other = fl.craig_bampton(strange, [rod.start], 2)
    with pytest.raises(ValueError, match="not the body"):
        fl.reduced_body(scene, [beam.start], other)
    body = fl.reduced_body(scene, [beam.start, beam.end], 3)
    with pytest.raises(ValueError, match="interfaces 0 … 1"):
        body.node(2)
    with pytest.raises(ValueError, match="no point 'middle'"):
        body["middle"]
    damped, section = fl.Scene(), fl.Section.rectangle(0.02, 0.03, STEEL)
    rod = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2, damping=fl.Damping(mass=1.0))
    damped.add(rod)
    with pytest.raises(ValueError, match="has damping"):
        fl.reduced_body(damped, [rod.start], 2)
    scene.add(fl.Clamp(beam.end))
    with pytest.raises(ValueError, match="held"):
        fl.reduced_body(scene, [beam.start], 3)
    with pytest.raises(ValueError, match="no body"):
        fl.expand(swing(part()[1]), replace_name(body))


def replace_name(body):
    body.name = "another"
    return body


def test_a_part_is_kept_in_a_file(tmp_path):
    body, full = reduced(4)
    path = tmp_path / "part.h5"
    fl.save_reduced(body, path)
    again = fl.load_reduced(path, full)
    assert again.point_names == body.point_names and again.name == body.name
    here, there = (swing(each).frames for each in (body, again))
    np.testing.assert_array_equal(here, there)
    with pytest.raises(ValueError, match="another mesh: 9 nodes"):
        fl.load_reduced(path, part(4)[1])
    with pytest.raises(ValueError, match="elsewhere"):
        fl.load_reduced(path, part(8, 0.2)[1])
    with pytest.raises(ValueError, match="no basis"):
        fl.load_basis(path, full)


def test_reduced_pendulum():
    from demos.reduced_pendulum import main

    record = main(duration=0.02, pictures=False)
    assert record["modes"] == 12
    assert record["motion_error"] < 1e-6
    assert record["stress_error"] < 0.1
