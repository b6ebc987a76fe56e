"""Friction of penalties: closed forms, derivatives, resumed runs, and what is refused."""

from collections.abc import Callable

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import conserving_contact
from fem_lie import lie

GRAVITY, SIZE = 9.81, 0.1
FLOOR = fl.contact.Plane(fl.ground(), (0, 0, 1))


def on_slope(
    degrees: float, surface, law: fl.contact.Penalty, start=0.0
) -> tuple[fl.Scene, fl.extend.Point]:
    """A body of 1 kg whose centre is 0.1 m above a slope, in equilibrium across it."""
    angle = np.radians(degrees)
    body = fl.RigidBody(1.0, 0.4 * SIZE**2 * np.eye(3), (0, 0, SIZE - start))
    scene = fl.Scene(gravity=(GRAVITY * np.sin(angle), 0, -GRAVITY * np.cos(angle)))
    scene.add(body)
    scene.add(fl.contact.Contact(surface(body.point("centre")), FLOOR, law))
    return scene, body.point("centre")


def block(point: fl.extend.Point) -> fl.contact.Box:
    return fl.contact.Box(point, (4 * SIZE, 4 * SIZE, 2 * SIZE))


def ball(point: fl.extend.Point) -> fl.contact.Sphere:
    return fl.contact.Sphere(point, SIZE)


def run(scene: fl.Scene, duration: float, step: float, **options) -> fl.Result:
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-9)
    return scheme.run(scene, duration=duration, step=step, progress=False, **options)


@pytest.mark.parametrize(("degrees", "sticks"), [(20, True), (26.5, True), (27, False)])
def test_a_block_sticks_or_slides(degrees, sticks):
    """By Coulomb's law, after springs have been stretched."""
    k, μ, angle = 1e6, 0.5, np.radians(degrees)
    law = fl.contact.Penalty(k, damping=1e3, friction=μ)
    scene, centre = on_slope(degrees, block, law, GRAVITY * np.cos(angle) / (4 * k))
    x = run(scene, 0.3, 1e-3).position(centre)[:, 0]
    if sticks:
        assert np.ptp(x[-20:]) < 1e-9
    else:
        a = np.diff(x[-20:], 2) / 1e-6
        np.testing.assert_allclose(a, GRAVITY * (np.sin(angle) - μ * np.cos(angle)), rtol=1e-3)


def test_a_block_on_a_body_that_a_joint_holds_slides_to_rest():
    """And stays there, without other loads or damping in the energy balance."""
    μ, k, speed = 0.3, 1e6, 0.3
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    slab = scene.add(fl.RigidBody(1e3, 1e3 * np.eye(3), (0, 0, -0.5)))
    scene.add(fl.joints.Prismatic(fl.ground(), slab.point("centre"), axis=(0, 1, 0)))
    body = scene.add(fl.RigidBody(1.0, np.eye(3), (0, 0, SIZE - GRAVITY / (4 * k))))
    body.add_velocity((speed, 0, 0))
    top = fl.contact.Plane(slab.point((0, 0, 0)), (0, 0, 1))
    scene.add(
        fl.contact.Contact(block(body.point("centre")), top, fl.contact.Penalty(k, friction=μ))
    )
    x = run(scene, 0.3, 1e-3).position(body.point("centre"))[:, 0]
    assert x[-1] == pytest.approx(speed**2 / (2 * μ * GRAVITY), rel=0.02)
    assert np.ptp(x[-100:]) < 1e-5


def test_a_ball_rolls():
    """Springs go along: 5/7 of what it has without friction."""
    k, angle = 1e5, np.radians(20)
    law = fl.contact.Penalty(k, friction=0.5)
    scene, centre = on_slope(20, ball, law, GRAVITY * np.cos(angle) / k)
    result = run(scene, 0.5, 2e-3)
    wanted = 5 / 14 * GRAVITY * np.sin(angle) * 0.5**2
    assert result.position(centre)[-1, 0] == pytest.approx(wanted, rel=2e-3)


def on_turntable(rate: float, radius: float, speed: float) -> tuple[fl.Scene, fl.extend.Point]:
    """A ball that rolls on a heavy table, which rotates, and starts outwards along x."""
    stiffness, mass = 4e5, 0.2
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    table = scene.add(fl.RigidBody.cylinder(1e4, 1.0, (0, 0, -SIZE), (0, 0, 0)))
    centre = table.point("centre")
    scene.add(fl.joints.Revolute(fl.ground(), centre, at=(0, 0, 0), axis=(0, 0, 1)))
    table.add_velocity((0, 0, 0), omega=(0, 0, rate), about=(0, 0, 0))
    height = SIZE / 2 - mass * GRAVITY / stiffness
    rolling = scene.add(fl.RigidBody.ball(mass, SIZE / 2, (radius, 0, height)))
    spin = np.array([rate * radius, speed, 0]) / (SIZE / 2)
    rolling.add_velocity((speed, 0, 0), omega=spin, about=rolling.point("centre"))
    surface = fl.contact.Sphere(rolling.point("centre"), SIZE / 2)
    plane = fl.contact.Plane(centre, (0, 0, 1), at=(0, 0, 0))
    scene.add(fl.contact.Contact(surface, plane, fl.contact.Penalty(stiffness, friction=0.6)))
    return scene, rolling.point("centre")


@pytest.mark.parametrize(
    ("scheme", "step"), [(fl.GeneralisedAlpha(), 1e-3), (fl.EnergyMomentum(), 2e-3)]
)
def test_a_ball_on_a_turntable_runs_in_circles(scheme, step):
    """With 2/7 of the table's rate, whatever the start (Weltner, Am. J. Phys. 47 (1979) 984).

    Both surfaces rotate while the contact point moves, and springs must not take that for slip.
    """
    rate, speed, errors = 10.0, 0.8, []
    for h in (step, step / 2):
        scene, centre = on_turntable(rate, 0.3, speed)
        result = scheme.run(scene, duration=0.25, step=h, progress=False)
        turned = 2 / 7 * rate * result.times
        exact = 3.5 * speed / rate * np.column_stack([np.sin(turned), 1 - np.cos(turned)])
        errors.append(np.abs(result.position(centre)[:, :2] - (0.3, 0) - exact).max())
    assert errors[1] < 0.3 * errors[0]
    assert errors[1] < 3e-4


def forces_of(term, H: np.ndarray) -> np.ndarray:
    out = np.zeros((len(H), 6))
    term.add_forces(H, out)
    return out.ravel()


def ball_on_ball() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    pair = [fl.RigidBody(1.0, np.eye(3), position) for position in ((0, 0, 0.098), (0, 0, -0.3))]
    return pair, (
        fl.contact.Sphere(pair[0].point("centre"), 0.1),
        fl.contact.Sphere(pair[1].point("centre"), 0.3),
    )


def ball_on_plane() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    pair = [fl.RigidBody(1.0, np.eye(3), position) for position in ((0, 0, 0.098), (0, 0, 0))]
    return pair, (
        fl.contact.Sphere(pair[0].point("centre"), 0.1),
        fl.contact.Plane(pair[1].point("centre"), (0, 0, 1)),
    )


def line_on_plane() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    section = fl.Section.circle(0.1, fl.Material(1e9, 0.3, 1.0))
    line = fl.Beam.straight((0, 0, 0.098), (1, 0, 0.098), section, cells=2)
    return [line], (fl.contact.Line(line, 0.1), FLOOR)


def sheet(height: float, cells: int) -> fl.Shell:
    """A square, 0.1 m thick, that is smaller the higher it is, so that edges do not meet."""
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([a, b, 0]) * (1 - height) + [0, 0, height], (cells, 1)
    )
    return fl.Shell(mesh, fl.ShellSection.layer(0.1, fl.Material(1e9, 0.3, 1.0)))


def shell_on_shell() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    upper, lower = sheet(0.097, 1), sheet(0.0, 2)
    return [upper, lower], (fl.contact.ShellSurface(upper), fl.contact.ShellSurface(lower))


def shell_on_plane() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    one = sheet(0.048, 1)
    return [one], (fl.contact.ShellSurface(one), FLOOR)


def ball_on_shell() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    one, body = sheet(0.0, 1), fl.RigidBody(1.0, np.eye(3), (0.3, 0.4, 0.148))
    return [body, one], (fl.contact.Sphere(body.point("centre"), 0.1), fl.contact.ShellSurface(one))


THICK = fl.Section.circle(0.1, fl.Material(1e9, 0.3, 1.0))


def beam_on_beam() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    pair = [fl.Beam.straight((0, 0, z), (1, 0, z), THICK, cells=n) for z, n in ((0.198, 2), (0, 3))]
    return pair, tuple(fl.contact.Line(beam, 0.1) for beam in pair)


def cable_on_beam() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    pair, (_, other) = beam_on_beam()
    pair[0] = fl.Cable.straight((0, 0, 0.198), (1, 0, 0.198), THICK, cells=2)
    return pair, (fl.contact.Line(pair[0], 0.1), other)


def bar_on_net() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    bar = fl.RigidBody(1.0, np.eye(3), (0.5, 0, 0.198))
    net = fl.Net(np.linspace((-0.1, 0, 0), (1.1, 0, 0), 4), [range(4)], THICK)
    cylinder = fl.contact.Cylinder(bar.point("centre"), (0.9, 0.02, 0), 0.1)
    return [bar, net], (cylinder, fl.contact.Line(net, 0.1))


def numbered(bodies):
    """Numbers of the nodes of bodies; their coordinates and types."""
    first = np.cumsum([0, *(len(b.frames) for b in bodies)])
    numbers = {b: np.arange(len(b.frames)) + k for b, k in zip(bodies, first, strict=False)}
    H = np.concatenate([b.frames for b in bodies])
    return numbers.__getitem__, H, np.concatenate([b.model.node_types for b in bodies])


def moved(types: np.ndarray, H: np.ndarray, h: np.ndarray) -> np.ndarray:
    out = H.copy()
    fl.extend.node_types.retract_all(types, H, h, out)
    return out


def ball_on_solid() -> tuple[list[fl.extend.Body], fl.contact.Contact]:
    rubber = fl.sections.NeoHooke(1e6, 0.3, 1000.0)
    block, ball = fl.Solid.brick((1, 1, 1), rubber, cells=(1, 1, 1)), np.array([0.1, 0.2, 0.108])
    top = block.frames[:, 0].mean(axis=0) * [1, 1, 0] + [0, 0, block.frames[:, 0, 2].max()]
    body = fl.RigidBody(1.0, np.eye(3), top + ball)
    faces = fl.contact.Facets(block, thickness=0.02)
    return [body, block], (fl.contact.Sphere(body.point("centre"), 0.1), faces)


@pytest.mark.parametrize("friction", [100.0, 0.1])
@pytest.mark.parametrize(
    "make",
    [
        ball_on_ball,
        ball_on_plane,
        line_on_plane,
        beam_on_beam,
        cable_on_beam,
        bar_on_net,
        shell_on_shell,
        shell_on_plane,
        ball_on_shell,
        ball_on_solid,
    ],
)
def test_derivatives(make, friction):
    """By differences, sticking and slipping."""
    bodies, surfaces = make()
    law = fl.contact.Penalty(50.0, friction=friction, holding=30.0)
    nodes, H, types = numbered(bodies)
    term = fl.contact.Contact(*surfaces, law).term(nodes)
    random = np.random.default_rng(1)
    H = moved(types, H, 1e-3 * random.normal(size=(len(H), 6)))
    wanted, found = np.zeros((2, 6 * len(H), 6 * len(H)))
    for block, i, j in zip(term.tangent(H, term.workspace()), *term.pairs, strict=True):
        found[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] += block
    for q in range(6 * len(H)):
        ends = []
        for sign in (1, -1):
            h = np.zeros((len(H), 6))
            h.flat[q] = sign * 1e-7
            ends.append(forces_of(term, moved(types, H, h)))
        wanted[:, q] = (ends[0] - ends[1]) / 2e-7
    assert np.abs(wanted).max() > 1.0
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8 * np.abs(wanted).max())


def on_nodes(types: np.ndarray, H: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces and moments about the origin of generalised forces (6 n,), global components."""
    axes, each = fl.extend.node_types.all_axes(types, H), f.reshape(-1, 2, 3)
    F, second = np.einsum("nai,nij->anj", each, axes)
    vectors = (types > 3)[:, np.newaxis]
    return F, np.cross(H[:, 0], F) + np.where(vectors, np.cross(H[:, 1], second), second)


@pytest.mark.parametrize("make", [beam_on_beam, cable_on_beam, bar_on_net])
def test_friction_of_lines_balances_and_turns_with_rigid_motions(make):
    """Force and moment of all nodes vanish; springs rotate with both bodies without slip."""
    bodies, surfaces = make()
    nodes, H, types = numbered(bodies)
    law = fl.contact.Penalty(50.0, friction=0.3, holding=30.0)
    term = fl.contact.Contact(*surfaces, law).term(nodes)
    H = moved(types, H, 1e-3 * np.random.default_rng(1).normal(size=(len(H), 6)))

    term.accept(H)
    lost, (F, _) = term.dissipated, on_nodes(types, H, forces_of(term, H))
    size = np.linalg.norm(F, axis=1)
    assert size.max() > 1e-2
    turn = lie.se3_exp(np.array([0.03, -0.02, 0.01, 0.05, 0.12, -0.07]))
    for _ in range(20):
        H[:, 0] = turn[0] + H[:, 0] @ turn[1:]
        H[:, 1:] = H[:, 1:] @ turn[1:]
        term.accept(H)
    F, M = on_nodes(types, H, forces_of(term, H))
    assert max(np.abs(F.sum(axis=0)).max(), np.abs(M.sum(axis=0)).max()) < 1e-14 * len(F)
    np.testing.assert_allclose(np.linalg.norm(F, axis=1), size, atol=1e-11 * size.max())
    assert term.dissipated - lost < 1e-11 * term.energy(H)


def thrown() -> fl.Scene:
    """A ball that slides on the floor at first."""
    body = fl.RigidBody(1.0, 0.4 * SIZE**2 * np.eye(3), (0, 0, SIZE - 1e-4))
    body.add_velocity((0.3, 0.1, 0))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(body)
    scene.add(
        fl.contact.Contact(ball(body.point("centre")), FLOOR, fl.contact.Penalty(1e5, friction=0.3))
    )
    return scene


@pytest.mark.parametrize("every", [37, 60])
def test_a_restart_agrees_to_the_last_bit(tmp_path, every):
    """A ball slides, then rolls: in the middle of slip, and of stick."""

    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-9)
    options = {"duration": 0.1, "step": 1e-3, "progress": False, "checkpoint_every": every}
    whole = scheme.run(thrown(), **options, file=tmp_path / "whole.h5")
    scheme.run(thrown(), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(thrown(), tmp_path / "run.h5", progress=False)
    for name in ("frames", "balance"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))
    assert len(whole.friction.each) > 50
    np.testing.assert_array_equal(resumed.friction.each, whole.friction.each)
    # slips with μ g at first, and rolls with 5/7 of its speed in the end
    speed = np.diff(whole.frames[:, 0, 0, 0]) / 1e-3
    assert speed[-1] == pytest.approx(5 / 7 * 0.3, rel=5e-2)


def on_the_slope(step) -> tuple[fl.Scene, fl.Result]:
    """A block that slides down 30° with μ = 0.3, from its equilibrium across the slope."""
    law, angle = fl.contact.Penalty(1e5, damping=100.0, friction=0.3), np.radians(30)
    scene, _ = on_slope(30, block, law, GRAVITY * np.cos(angle) / 4e5)
    return scene, fl.GeneralisedAlpha().run(scene, duration=0.3, step=step, progress=False)


CHOSEN = fl.schemes.AdaptiveStep(tolerance=1e-5)


@pytest.mark.parametrize("step", [1e-3, CHOSEN], ids=["equal", "chosen"])
def test_forces_and_the_energy_balance_have_friction(step, tmp_path):
    """Coulomb's law by the force; the work ``μ N`` times the way is dissipated."""
    scene, result = on_the_slope(step)
    (contact,) = scene.contacts
    normal, x = GRAVITY * np.cos(np.radians(30)), result.frames[:, 0, 0, 0]
    found = fl.post.contact_forces(result, contact)
    np.testing.assert_allclose(found.total[-1], [-0.3 * normal, 0.0, normal], atol=1e-4)
    assert set(found.touching[1:]) == {4}
    assert result.balance[-1, 1] == pytest.approx(0.3 * normal * (x[-1] - x[0]), rel=1e-3)
    assert result.energy_error < 1e-4
    result.save(tmp_path / "slides.h5")
    read = fl.post.contact_forces(fl.Result.load(tmp_path / "slides.h5"), contact)
    np.testing.assert_array_equal(read.forces, found.forces)


def test_the_stored_energy_of_a_contact_that_opens_is_dissipated():
    """A ball that bounces with spin: the springs of friction are stretched when it leaves."""
    body = fl.RigidBody(1.0, 0.4 * SIZE**2 * np.eye(3), (0, 0, SIZE + 1e-3))
    body.add_velocity((0.5, 0, -0.5))
    scene = fl.Scene()
    scene.add(body)
    scene.add(fl.contact.Contact(ball(body.point("centre")), FLOOR, LAW))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=0.03, step=1e-4, progress=False)
    assert result.position(body.point("centre"))[-1, 2] > SIZE
    assert result.balance[-1, 1] > 0.02 * result.kinetic[0]
    assert result.energy_error < 1e-3


@pytest.mark.parametrize("how", [fl.statics, fl.follow_path], ids=["steps", "path"])
def test_contact_forces_with_friction_are_in_equilibrium(how):
    """A block that springs hold on a slope: contact forces carry its weight."""
    scene, _ = on_slope(10, block, fl.contact.Penalty(1e5, friction=0.5), 1e-5)
    (contact,) = scene.contacts
    result = how(scene)
    weight = np.asarray(scene.gravity)  # of 1 kg
    loaded = np.flatnonzero(result.factors)
    found = fl.post.contact_forces(result, contact, loaded.tolist())
    expected = np.outer(result.factors[loaded], -weight)
    np.testing.assert_allclose(found.total, expected, rtol=0, atol=1e-6)


def test_friction_along_a_line_is_in_the_forces_and_the_balance():
    scene = sliding_beam(line=True)
    result = run(scene, 0.04, 2e-4)
    found = fl.post.contact_forces(result, scene.contacts[0])
    lost = result.momentum[0, :2] - result.momentum[-1, :2]
    impulse = -np.trapezoid(found.total[:, :2], result.times, axis=0)
    np.testing.assert_allclose(impulse, lost, rtol=0.05)
    assert result.balance[-1, 1] > 0.0
    assert result.energy_error < 2e-3


def test_states_between_steps_have_no_friction_forces():
    scene, _ = on_slope(30, block, fl.contact.Penalty(1e5, friction=0.3))
    result = run(scene, 0.01, 1e-3, save_at=[0.0, 0.0055])
    with pytest.raises(ValueError, match=r"no friction forces of Contact.*save_every"):
        fl.post.contact_forces(result, scene.contacts[0])


def viscous_forces_of(term, H: np.ndarray, v: np.ndarray) -> np.ndarray:
    out = np.zeros((len(H), 6))
    term.add_viscous_forces(H, v, out)
    return out.ravel()


@pytest.mark.parametrize("friction", [100.0, 0.1])
@pytest.mark.parametrize(
    "make", [ball_on_ball, ball_on_plane, line_on_plane, ball_on_shell, cable_on_beam, bar_on_net]
)
def test_derivatives_with_damping(make, friction):
    """In twists and in frames by differences, sticking and slipping."""
    bodies, surfaces = make()
    law = fl.contact.Penalty(50.0, damping=3.0, ramp=1e-2, friction=friction, holding=30.0)
    nodes, H, types = numbered(bodies)
    term = fl.contact.Contact(*surfaces, law).term(nodes)
    random = np.random.default_rng(1)
    H = moved(types, H, 1e-3 * random.normal(size=(len(H), 6)))
    v = 1e-2 * random.normal(size=(len(H), 6))

    def shifted(h):
        # velocities of nodes without frames are constant in space
        there, axes = moved(types, H, h), fl.extend.node_types.all_axes
        turned = np.einsum("nik,njk->nij", axes(types, there), axes(types, H))
        halves = np.einsum("nij,naj->nai", turned, v.reshape(-1, 2, 3)).reshape(-1, 6)
        return there, np.where((types > 3)[:, np.newaxis], halves, v)

    moves = (lambda h: (H, v + h)), shifted
    for blocks, move in zip(term.viscous_tangent(H, v), moves, strict=True):
        wanted, found = np.zeros((2, 6 * len(H), 6 * len(H)))
        for block, i, j in zip(blocks, *term.pairs, strict=True):
            found[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] += block
        for q in range(6 * len(H)):
            h = np.zeros((len(H), 6))
            h.flat[q] = 1e-7
            ends = [viscous_forces_of(term, *move(sign * h)) for sign in (1, -1)]
            wanted[:, q] = (ends[0] - ends[1]) / 2e-7
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())


@pytest.mark.parametrize("damping", [1e3, 4e3])
def test_friction_in_an_impact_is_limited_by_the_whole_normal_force(damping):
    """A ball that spins hits the floor: the impulse along it is μ times that across it."""
    μ, spin = 0.3, 500.0
    law = fl.contact.Penalty(1e6, damping=damping, ramp=1e-5, friction=μ)
    body = fl.RigidBody(1.0, 0.4 * SIZE**2 * np.eye(3), (0, 0, SIZE + 1e-3))
    body.add_velocity((0, 0, -0.5), omega=(0, spin, 0), about=body.point("centre"))
    scene = fl.Scene()
    scene.add(body)
    contact = scene.add(fl.contact.Contact(ball(body.point("centre")), FLOOR, law))
    result = run(scene, 0.02, 1e-5)
    Δ = result.momentum[-1] - result.momentum[0]
    assert Δ[2] > 0.5
    assert Δ[0] == pytest.approx(μ * Δ[2], rel=2e-3)
    assert result.energy_error < 2e-3
    # forces in results have the same ratio while it slips
    total = fl.post.contact_forces(result, contact).total
    pushed = total[:, 2] > 1.0
    np.testing.assert_allclose(total[pushed, 0], μ * total[pushed, 2], rtol=0.02)


def test_damping_brings_a_block_to_rest_that_sticks():
    """Pushed along the floor below the limit it would oscillate on its springs without damping."""
    law = fl.contact.Penalty(1e6, damping=2e3, friction=0.5)
    scene, centre = on_slope(20, block, law, GRAVITY * np.cos(np.radians(20)) / 4e6)
    result = run(scene, 0.1, 1e-3)
    assert np.abs(result.velocities[-1]).max() < 1e-6
    assert np.ptp(result.position(centre)[-20:, 0]) < 1e-9


LAW = fl.contact.Penalty(1e5, friction=0.3)


@pytest.mark.parametrize(
    ("case", "steps", "lost"), [("box", 60, 0.02), ("corners", 120, 1e-3), ("beams", 20, 1e-4)]
)
def test_conserving_steps_account_for_the_work_of_friction(case, steps, lost):
    """Free bodies and beams that touch: in no step is less than nothing lost, and momenta stay."""
    build, stiffness, mass, _ = conserving_contact.CASES[case]
    scene, _ = build(stiffness, 0.3)
    step = 0.2 * 2 * np.pi * np.sqrt(mass / stiffness)
    result = fl.EnergyMomentum().run(scene, duration=steps * step, step=step, progress=False)
    assert np.diff(result.balance[:, 1]).min() >= 0.0
    assert result.balance[-1, 1] > lost * result.kinetic[0]
    assert result.energy_error < 1e-12
    assert result.momentum_error < 1e-12
    assert result.angular_momentum_error < 1e-12


def crossing(k: float) -> fl.Scene:
    """Two beams that meet and slide, about as wide as the points of friction are apart."""
    section, scene = fl.Section.circle(0.04, fl.Material(1e8, 0.3, 1000.0)), fl.Scene()
    lower = scene.add(fl.Beam.straight((-0.25, 0, 0), (0.25, 0, 0), section, cells=8))
    upper = scene.add(fl.Beam.straight((-0.15, -0.2, 0.079), (0.2, 0.2, 0.079), section, cells=8))
    upper.add_velocity((2.0, 0.5, -1.0))
    sides = fl.contact.Line(lower, 0.04), fl.contact.Line(upper, 0.04)
    scene.add(fl.contact.Contact(*sides, fl.contact.Penalty(k, friction=0.3)))
    return scene


def over_a_bar(k: float, kind: type = fl.Beam) -> fl.Scene:
    """A rope that falls on a free bar, and slides off it."""
    rope = kind(
        fl.mesh.curve(lambda s: np.array([1.2 * s - 0.5, 0.0, 0.0]), 16),
        fl.Section.circle(0.01, fl.Material(1e8, 0.3, 1200.0)),
    )
    scene = fl.Scene()
    scene.add(rope)
    rope.add_velocity((1.0, 0.0, -1.0))
    bar = scene.add(fl.RigidBody(0.5, 0.01 * np.eye(3), (0.0, 0.0, -0.111)))
    round_bar = fl.contact.Cylinder(bar.point("centre"), (0, 0.4, 0), 0.1)
    law = fl.contact.Penalty(k, friction=0.3)
    scene.add(fl.contact.Contact(fl.contact.Line(rope, 0.01), round_bar, law))
    return scene


def along_a_sheet(k: float) -> fl.Scene:
    """A beam that comes down aslant on a sheet."""
    sheet, section = (
        conserving_contact.sheet(0.0, 1.0, 4),
        fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1000.0)),
    )
    scene = fl.Scene()
    scene.add(sheet)
    beam = scene.add(fl.Beam.straight((-0.3, -0.2, 0.02), (0.25, 0.2, 0.03), section, cells=6))
    beam.add_velocity((1.0, 0.3, -1.0))
    surface = fl.contact.ShellSurface(sheet, smooth=False)
    law = fl.contact.Penalty(k, friction=0.3)
    scene.add(fl.contact.Contact(fl.contact.Line(beam, 0.01), surface, law))
    return scene


BETWEEN: dict[str, tuple[Callable[[], fl.Scene], float]] = {
    "line and line": (lambda: crossing(1e6), 2e-4),
    "beam and bar": (lambda: over_a_bar(1e5), 1e-3),
    "cable and bar": (lambda: over_a_bar(1e5, fl.Cable), 1e-3),
    "ball and sheet": (lambda: conserving_contact.on_sheet(1e4, 0.3)[0], 4e-3),
    "sheet and face": (lambda: conserving_contact.slab(1e6, 0.3)[0], 1e-3),
    "sheet and sheet": (lambda: conserving_contact.sheets(1e6, 0.3)[0], 1e-3),
    "line and sheet": (lambda: along_a_sheet(1e5), 1e-3),
}


@pytest.mark.parametrize("name", BETWEEN)
def test_lines_and_surfaces_slide_in_conserving_steps_as_in_others(name):
    """Round-off of energy and momenta, and the loss of generalised-α with quarters of the step."""
    make, step = BETWEEN[name]
    found, compared = (
        scheme.run(make(), duration=20 * step, step=step / parts, progress=False)
        for scheme, parts in ((fl.EnergyMomentum(), 1), (fl.GeneralisedAlpha(), 4))
    )
    assert np.diff(found.balance[:, 1]).min() >= 0.0
    assert found.balance[-1, 1] > 1e-3 * found.kinetic[0]
    assert found.balance[-1, 1] == pytest.approx(compared.balance[-1, 1], rel=0.1)
    assert found.balance_error < 1e-11
    assert found.momentum_error < 1e-12
    assert found.angular_momentum_error < 1e-12


def in_a_box(steps: int) -> fl.Result:
    """A ball in a free box that turns, with friction, by steps of a fifth of a contact's period."""
    scene, _ = conserving_contact.box(1e4, 0.3)
    step = 0.4 * np.pi * np.sqrt(0.75 / 1e4)
    return fl.EnergyMomentum().run(scene, duration=steps * step, step=step, progress=False)


def test_an_open_contact_with_friction_keeps_its_matrix():
    """Anchors of what flies freely hold no spring, not even of round-off."""
    assert in_a_box(10).factorisations <= 2


def test_steps_that_stick_and_slip_in_turns_are_made_in_full():
    result = in_a_box(140)
    assert result.divided == 0
    assert np.diff(result.balance[:, 1]).min() >= 0.0
    assert result.balance_error < 1e-12


def test_a_ball_slides_then_rolls_in_conserving_steps():
    """By 5/7 of its speed in the end; ground has given the rest, and friction taken 2/7."""
    result = fl.EnergyMomentum().run(thrown(), duration=0.2, step=1e-3, progress=False)
    velocity = np.diff(result.frames[:, 0, 0, 0]) / 1e-3
    assert velocity[-1] == pytest.approx(5 / 7 * 0.3, rel=1e-2)
    assert result.balance[-1, 1] == pytest.approx(2 / 7 * 0.5 * (0.3**2 + 0.1**2), rel=2e-2)
    assert result.energy_error < 1e-12
    assert result.momentum_error < 5e-12


@pytest.mark.parametrize("every", [30, 90], ids=["slipping", "rolling"])
def test_a_conserving_restart_agrees_to_the_last_bit(tmp_path, every):
    options = {"duration": 0.1, "step": 1e-3, "progress": False, "checkpoint_every": every}
    whole = fl.EnergyMomentum().run(thrown(), **options, file=tmp_path / "whole.h5")
    fl.EnergyMomentum().run(thrown(), **options, file=tmp_path / "run.h5")
    resumed = fl.EnergyMomentum().resume(thrown(), tmp_path / "run.h5", progress=False)
    for name in ("frames", "balance", "elastic"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def sliding_beam(*, line: bool) -> fl.Scene:
    """A soft beam that bounces along the floor, with some of it sticking."""
    section = fl.Section.circle(0.01, fl.Material(1e7, 0.3, 1000.0))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    beam = scene.add(fl.Beam.straight((0, 0, 0.0097), (1, 0, 0.03), section, cells=6))
    beam.add_velocity((0.1, 0.05, 0))
    nodes = fl.contact.Vertices([fl.extend.Point(beam, k) for k in range(7)], 0.01)
    law = fl.contact.Penalty(2e4 if line else 2e3, friction=0.3)
    scene.add(fl.contact.Contact(fl.contact.Line(beam, 0.01) if line else nodes, FLOOR, law))
    return scene


@pytest.mark.parametrize("scheme", [fl.GeneralisedAlpha(radius=0.8), fl.EnergyMomentum()])
@pytest.mark.parametrize("line", [False, True], ids=["nodes", "line"])
def test_a_restart_of_a_beam_during_stick_and_slip_agrees_to_the_last_bit(tmp_path, line, scheme):
    options = {"duration": 0.04, "step": 1e-3, "progress": False, "checkpoint_every": 30}
    whole = scheme.run(sliding_beam(line=line), **options, file=tmp_path / "whole.h5")
    scheme.run(sliding_beam(line=line), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(sliding_beam(line=line), tmp_path / "run.h5", progress=False)
    for name in ("frames", "velocities", "balance", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))
    # it slows down along the floor
    assert whole.momentum[-1, 0] < 0.999 * whole.momentum[0, 0]


REFUSED = {
    "friction": (
        lambda: fl.contact.Penalty(1e3, friction=-0.1),
        r"Penalty: friction must not be negative, got -0.1",
    ),
    "nan": (lambda: fl.contact.Penalty(1e3, friction=float("nan")), "friction"),
    "holding": (lambda: fl.contact.Penalty(1e3, friction=0.1, holding=0.0), "Penalty: holding"),
    "variational": (
        lambda: fl.schemes.Variational().run(
            on_slope(20, ball, LAW)[0], duration=0.1, step=1e-3, progress=False
        ),
        "Variational does not support friction of penalties",
    ),
    "conserving": (
        lambda: fl.EnergyMomentum().run(
            on_slope(20, ball, fl.contact.Penalty(1e3, damping=1.0, friction=0.3))[0],
            duration=0.1,
            step=1e-2,
            progress=False,
        ),
        "contacts by penalty with damping: use GeneralisedAlpha",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(("cells", "reported"), [(20, True), (150, False)])
def test_friction_that_no_point_of_a_line_sees_is_reported(cells, reported, caplog):
    """A bar on two rollers, in contact over less than the points of friction are apart."""
    radius, stiffness = 0.01, 1e8
    section = fl.Section.circle(radius, fl.Material(2.1e11, 0.3, 7850.0))
    bar = fl.Beam.straight((-0.5, 0, 0), (0.5, 0, 0), section, cells=cells, name="bar")
    scene = fl.Scene(gravity=(0.5, 0, -9.81))
    scene.add(bar)
    for x in (-0.3, 0.3):
        height = -0.06 + 4.2e-4 * (3e6 / stiffness) ** (2 / 3)
        scene.add(
            fl.contact.Contact(
                fl.contact.Line(bar, radius),
                fl.contact.Cylinder(fl.ground((x, 0, height)), (0, 0.2, 0), 0.05),
                fl.contact.Penalty(stiffness, friction=0.3),
            )
        )
    with caplog.at_level("WARNING", "fem_lie"):
        fl.GeneralisedAlpha().run(scene, duration=0.03, step=1e-3, progress=False)
    assert ("friction acts at fixed points" in caplog.text) == reported
