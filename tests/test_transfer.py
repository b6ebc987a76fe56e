"""States on other meshes of the same bodies: momenta, energy, exact transfer."""

from functools import cache

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.unit_systems import METRES, OTHER_SYSTEMS, UNIT_SYSTEMS, UnitSystem

STEEL = fl.Material(E=2.1e9, nu=0.3, density=7800.0)
SECTION = fl.Section.rectangle(0.02, 0.03, STEEL)
SOFT = fl.Section.rectangle(0.02, 0.01, fl.Material(E=2e8, nu=0.3, density=1000.0))
ARC = fl.mesh.curve(lambda s: (np.sin(2 * s), 0.1 * s, 1 - np.cos(2 * s)), 8)
LINE = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)


def free(mesh, formulation=None, kind=fl.Beam):
    """A free beam, thrown, spinning and pushed across at one end."""
    scene = fl.Scene()
    beam = scene.add(kind(mesh, SECTION, formulation=formulation, name="beam"))
    beam.add_velocity(omega=(3.0, -2.0, 5.0), about=(0.2, 0.1, 0.0))
    beam.add_velocity((1.0, 2.0, -3.0))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 40.0, 0)))
    return scene


def thrown(scene, steps=8):
    return fl.GeneralisedAlpha().run(scene, duration=steps * 1e-3, step=1e-3)


def beside(mesh, cells):
    return fl.adaptivity.refine(mesh, cells)


@pytest.mark.parametrize(
    ("kind", "formulation"),
    [
        (fl.Beam, None),
        (fl.Beam, fl.elements.DirectorBeam(1)),
        (fl.Beam, fl.elements.DirectorBeam(2)),
        (fl.Rod, None),
    ],
)
@pytest.mark.parametrize("mesh", [ARC, LINE])
def test_momenta(kind, formulation, mesh):
    """Refined in part, and made coarse again."""
    coarse, fine = free(mesh, formulation, kind), free(beside(mesh, [0, 1, 3]), formulation, kind)
    result = thrown(coarse)
    changes = fl.adaptivity.transfer(result, coarse, fine)
    assert changes.momentum_error < 1e-12
    again = thrown(fine, 2)
    np.testing.assert_allclose(again.momentum[0], result.momentum[-1], rtol=1e-12)
    np.testing.assert_allclose(again.angular_momentum[0], result.angular_momentum[-1], rtol=1e-12)
    total = result.kinetic[-1] + result.elastic[-1]
    assert abs(changes.energy_change) < 5e-3 * total
    back = fl.adaptivity.transfer(again, fine, free(mesh, formulation, kind))
    assert back.momentum_error < 1e-12
    assert abs(back.energy_change) < 5e-3 * total


# --- what is carried exactly ----------------------------------------------------------------------


def rigid_motion(x):
    """Far from the unloaded state: turned by more than a right angle."""
    turn = lie.frame((0.3, -0.2, 0.5), lie.so3_exp((1.0, -1.5, 0.7)))
    return lie.se3_compose(turn, x)


def at_rest(scene):
    """One state of a scene, as it begins."""
    return fl.GeneralisedAlpha().run(scene, duration=1e-9, step=1e-9)


def begun(scene, frames, velocities):
    beam = scene.bodies[0]
    beam.model.start_frames, beam.velocities = frames, velocities
    return at_rest(scene)


@pytest.mark.parametrize("mesh", [ARC, LINE])
def test_rigid_motions_are_transferred_exactly(mesh):
    coarse, fine = free(mesh), free(beside(mesh, [1, 2]))
    beam, finer = coarse.bodies[0], fine.bodies[0]
    spin = np.array([0.4, 0.1, -0.3, 2.0, -1.0, 0.5])
    moved = rigid_motion(beam.frames)
    twists = lie.se3_adjoint(lie.se3_inverse(moved)) @ spin
    fl.adaptivity.transfer(begun(coarse, moved, twists), coarse, fine, state=0)
    np.testing.assert_allclose(finer.model.start_frames, rigid_motion(finer.frames), atol=1e-13)
    wanted = lie.se3_adjoint(lie.se3_inverse(finer.model.start_frames)) @ spin
    # the inertia of curved lines is that of their meshes, and momenta are kept
    allowed = 1e-12 if mesh is LINE else 5e-3
    np.testing.assert_allclose(finer.velocities, wanted, atol=allowed * np.abs(wanted).max())


def test_a_steady_rotation_goes_on_where_it_is_transferred_to():
    """With its velocities, which are also those that are added to the present configuration."""

    def arm() -> tuple[fl.Scene, fl.Beam]:
        scene = fl.Scene()
        return scene, scene.add(fl.Beam.straight((0.2, 0, 0), (1.2, 0.3, 0), SOFT, cells=4))

    spin = np.array([0.0, 0.0, 9.0])
    (still, held), (scene, beam), (_, other) = arm(), arm(), arm()
    still.add(fl.Clamp(held.point("start")))
    steady = fl.statics(still, spin=spin)
    assert np.abs(steady.displacement(held.point("end"))[-1]).max() > 1e-2
    fl.adaptivity.transfer(steady, still, scene)
    other.model.start_frames = beam.model.start_frames
    other.add_velocity(omega=spin, about=(0, 0, 0))
    np.testing.assert_allclose(beam.velocities, other.velocities, atol=1e-12 * 9.0)
    root = beam.frames[0]

    def hub(time: float) -> np.ndarray:
        return lie.se3_compose(lie.frame(np.zeros(3), lie.so3_exp(time * spin)), root)

    scene.add(fl.PrescribedMotion(beam.point("start"), hub))
    result = fl.GeneralisedAlpha().run(scene, duration=0.5, step=1e-2)
    seen = result.frames[:, :5, 0] @ lie.so3_exp(result.times[:, np.newaxis] * spin)
    np.testing.assert_allclose(seen, np.broadcast_to(seen[0], seen.shape), atol=1e-11)


def test_constant_strain_is_transferred_exactly():
    """A stretched and twisted circle: a screw, with the energy that it has."""
    strain = np.array([1.03, 0.01, -0.02, 0.4, 1.5, -0.7])
    plain = fl.elements.GeodesicBeam(bending_flexibility=False)
    coarse, fine = free(LINE, plain), free(beside(LINE, [0, 3]), plain)

    def screw(body):
        return lie.se3_exp(np.outer(body.frames[:, 0, 0], strain))

    beam, finer = coarse.bodies[0], fine.bodies[0]
    still = np.zeros((len(beam.frames), 6))
    changes = fl.adaptivity.transfer(begun(coarse, screw(beam), still), coarse, fine, state=0)
    np.testing.assert_allclose(finer.model.start_frames, screw(finer), atol=1e-13)
    assert changes.elastic[1] == pytest.approx(changes.elastic[0], rel=1e-11)


@pytest.mark.parametrize("kind", [fl.Beam, fl.Rod])
def test_refined_and_made_coarse_again(kind):
    """What was there comes back; new nodes take what momenta need."""
    coarse, fine, again = (free(m, None, kind) for m in (ARC, beside(ARC, [0, 2, 3, 5]), ARC))
    result = thrown(coarse)
    fl.adaptivity.transfer(result, coarse, fine)
    fl.adaptivity.transfer(at_rest(fine), fine, again, state=0)
    body = again.bodies[0]
    np.testing.assert_allclose(body.model.start_frames, result.frames[-1], atol=1e-13)
    np.testing.assert_allclose(body.velocities, result.velocities[-1], rtol=1e-9, atol=1e-9)


# --- solvers go on --------------------------------------------------------------------------------


def swinging(mesh):
    """On a hinge, with a spring that counts turns, under a load with a history."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam = scene.add(fl.Beam(mesh, SECTION, name="beam"))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0), name="hinge"))
    beam.add_velocity(omega=(0, 40.0, 0), about=(0, 0, 0))
    scene.add(
        fl.PointLoad(beam.point("end"), force=(0, 0, 5.0), history=lambda t: np.sin(30.0 * t))
    )
    return scene


def test_dynamics_restarts_from_a_transferred_state():
    """As without an interruption on the same mesh; angles are counted, histories continue."""
    whole = fl.GeneralisedAlpha().run(swinging(LINE), duration=0.4, step=1e-3)
    first, second = swinging(LINE), swinging(LINE)
    half = fl.GeneralisedAlpha().run(first, duration=0.2, step=1e-3)
    changes = fl.adaptivity.transfer(half, first, second)
    assert changes.energy_change == pytest.approx(0.0, abs=1e-9)
    rest = fl.GeneralisedAlpha().run(second, duration=0.2, step=1e-3)
    gap = rest.position("beam.end")[-1] - whole.position("beam.end")[-1]
    assert np.linalg.norm(gap) < 2e-3
    assert rest.coordinate("hinge")[-1] == pytest.approx(whole.coordinate("hinge")[-1], abs=5e-3)
    assert abs(whole.coordinate("hinge")[-1]) > 2 * np.pi


def cantilever(mesh):
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, SECTION, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 500.0)))
    return scene


@pytest.mark.parametrize("solve", [fl.statics, fl.follow_loads])
def test_statics_restarts_from_a_transferred_state(solve):
    """To the same state as from the undeformed one."""
    fine = beside(LINE, [0, 1])
    coarse, onto = cantilever(LINE), cantilever(fine)
    half = solve(coarse, levels=[0.5])
    changes = fl.adaptivity.transfer(half, coarse, onto)
    assert changes.elastic[1] == pytest.approx(changes.elastic[0], rel=0.05)
    there, direct = solve(onto, levels=[0.5, 1.0]), solve(cantilever(fine))
    np.testing.assert_allclose(there.frames[-1], direct.frames[-1], atol=1e-8)
    np.testing.assert_allclose(
        there.displacement("beam.end")[-1], direct.displacement("beam.end")[-1], atol=1e-8
    )
    with pytest.raises(ValueError, match="must not be below"):
        solve(onto, levels=[0.25])


def test_a_path_restarts_from_a_transferred_state():
    fine = beside(LINE, [0, 1])
    coarse, onto = cantilever(LINE), cantilever(fine)
    fl.adaptivity.transfer(fl.follow_path(coarse, 0.5), coarse, onto)
    there, direct = fl.follow_path(onto), fl.follow_path(cantilever(fine))
    assert there.factors[0] == pytest.approx(0.5)
    np.testing.assert_allclose(there.frames[-1], direct.frames[-1], atol=1e-7)


# --- bad input ------------------------------------------------------------------------------------


def test_bodies_that_are_others():
    coarse = free(LINE)
    result = at_rest(coarse)
    with pytest.raises(ValueError, match="bodies were"):
        fl.adaptivity.transfer(result, coarse, fl.Scene())
    other = fl.Scene()
    other.add(fl.Rod(LINE, SECTION, name="beam"))
    with pytest.raises(ValueError, match="was a Beam, now it is a Rod"):
        fl.adaptivity.transfer(result, coarse, other)
    with pytest.raises(ValueError, match="same line"):
        fl.adaptivity.transfer(result, coarse, free(fl.mesh.straight_line((0, 0, 0), (2, 0, 0), 8)))
    with pytest.raises(ValueError, match="record"):
        bare = fl.GeneralisedAlpha().run(
            free(LINE), duration=1e-3, step=1e-3, record=fl.schemes.Record.FRAMES
        )
        fl.adaptivity.transfer(bare, coarse, free(LINE))
    with pytest.raises(ValueError, match="got state 7"):
        fl.adaptivity.transfer(result, coarse, free(LINE), state=7)
    with pytest.raises(TypeError, match="result"):
        fl.adaptivity.transfer("state", coarse, free(LINE))


def test_frames_to_begin_at_that_are_none():
    scene = free(LINE)
    scene.bodies[0].model.start_frames = np.zeros((2, 4, 3))
    with pytest.raises(ValueError, match="start_frames of"):
        at_rest(scene)


# --- shells ---------------------------------------------------------------------------------------


def plate(mesh):
    """A free plate, thrown and turned, pushed at a corner."""
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL), name="plate"))
    shell.add_velocity(omega=(3.0, -2.0, 5.0), about=(0.2, 0.1, 0.0))
    shell.add_velocity((1.0, 2.0, -3.0))
    return scene


def test_momenta_of_shells():
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2), cell="triangle")
    coarse, fine = plate(mesh), plate(fl.adaptivity.refine(mesh, [0, 3]))
    result = fl.GeneralisedAlpha().run(coarse, duration=4e-3, step=1e-3)
    changes = fl.adaptivity.transfer(result, coarse, fine)
    assert changes.momentum_error < 1e-12
    assert abs(changes.energy_change) < 1e-2 * (result.kinetic[-1] + result.elastic[-1])


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_bent_shells_keep_their_energy(cell):
    """A thin strip, bent far: the parts of a cell are bent, too, and not sheared."""

    def strip(mesh):
        scene = fl.Scene()
        layer = fl.ShellSection.layer(0.02, fl.Material(1e6, 0.0, 1.0))
        shell = scene.add(fl.Shell(mesh, layer, name="strip"))
        shell.clamp("a=0")
        scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 0.2)))
        return scene

    mesh = fl.mesh.parametric_surface(lambda a, b: (2 * a, 0.5 * b, 0.0), (16, 4), cell=cell)
    coarse = strip(mesh)
    result = fl.statics(coarse)
    for cells in (range(0, len(mesh.cells), 7), range(len(mesh.cells))):
        fine = strip(fl.adaptivity.refine(mesh, cells))
        changes = fl.adaptivity.transfer(result, coarse, fine)
        assert abs(changes.energy_change) < 0.02 * changes.elastic[0]


def spun(u: UnitSystem, cells: int) -> fl.Scene:
    """A free wire of 1 mm along an arc of about 2 m, whose nodes hardly have moments of inertia."""
    steel, scene = fl.Material(u.stress(2.1e11), 0.3, u.density(7800.0)), fl.Scene()
    mesh = fl.mesh.curve(lambda s: u.length([np.sin(2 * s), 0.1 * s, 1 - np.cos(2 * s)]), cells)
    wire = scene.add(fl.Beam(mesh, fl.Section.circle(u.length(1e-3), steel), name="wire"))
    wire.add_velocity(omega=u.rate([3.0, -2.0, 5.0]), about=u.length([0.2, 0.1, 0.0]))
    wire.add_velocity(u.velocity([1.0, 2.0, -3.0]))
    return scene


@cache
def energy_lost(u: UnitSystem) -> float:
    """By a transfer to a mesh that is no refinement, over the kinetic energy."""
    coarse, fine = spun(u, 8), spun(u, 11)
    result = fl.GeneralisedAlpha().run(coarse, duration=u.time(4e-3), step=u.time(1e-3))
    moved = fl.adaptivity.transfer(result, coarse, fine)
    assert moved.momentum_error < 1e-14
    return float(moved.energy_change / result.kinetic[-1])


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_velocities_of_given_momenta_are_the_same_in_all_units(u):
    """Masses and moments of inertia, and both momenta, are compared over a length of the model."""
    assert abs(energy_lost(u) - energy_lost(METRES)) < 1e-12


def pinned(u: UnitSystem, cells: int, node: int | None) -> tuple[fl.Scene, fl.Beam]:
    """A clamped beam of steel, of 1 m, with a pin on one of its nodes."""
    steel = fl.Material(u.stress(2.1e11), 0.3, u.density(7800.0))
    section = fl.Section.rectangle(*u.length([0.01, 0.01]), steel)
    scene = fl.Scene()
    beam = scene.add(fl.Beam(fl.mesh.straight_line((0, 0, 0), u.length([1, 0, 0]), cells), section))
    scene.add(fl.Clamp(beam.point("start")))
    if node is not None:
        scene.add(fl.joints.Spherical(fl.ground(), beam.point(node), name="pin"))
    return scene, beam


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
@pytest.mark.parametrize(("deflection", "torn"), [(4e-4, True), (4e-8, False)])
def test_a_torn_joint_is_refused_in_all_units(deflection, torn, u):
    """The pin is where its node was before a load moved it: by a millionth of the beam or more."""
    scene, beam = pinned(u, 4, None)
    force = u.force([0, 0, 3 * 2.1e11 * 0.01**4 / 12 * deflection])
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    result = fl.statics(scene)
    finer, _ = pinned(u, 8, 4)
    if torn:
        with pytest.raises(ValueError, match="pin is violated by"):
            fl.adaptivity.transfer(result, scene, finer)
    else:
        fl.adaptivity.transfer(result, scene, finer)


@pytest.mark.parametrize("position", ["node", "attachment frame"])
def test_a_drive_is_added_to_a_hinge_that_has_made_turns(position):
    """The drive takes over the whole turns that the hinge has counted."""
    stiffness, moment = 5.0, 50.0

    def wound(cells):
        scene = fl.Scene()
        beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=cells, name="beam"))
        point = beam.point("start") if position == "node" else beam.point((0.3, 0, 0))
        hinge = scene.add(fl.joints.Revolute(fl.ground(), point, name="hinge"))
        spring = scene.add(fl.joints.Spring(hinge.angle, stiffness, name="spring"))
        scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, moment)))
        return scene, hinge, spring

    (coarse, _, before), (fine, hinge, spring) = wound(2), wound(4)
    result = fl.statics(coarse, load_steps=10)
    angle = moment / stiffness
    assert result.joint_force(before)[-1][5] == pytest.approx(stiffness * angle, rel=1e-9)
    motor = fine.add(fl.joints.Drive(hinge.angle, lambda factor: angle * factor**2, name="motor"))
    fl.adaptivity.transfer(result, coarse, fine)
    driven = fl.statics(fine, levels=(1.0, 1.1))
    np.testing.assert_array_equal(driven.factors[[0, -1]], [1.0, 1.1])
    ends = [0, -1]
    # what the spring has, the load does not give: the drive
    wanted = stiffness * angle * np.array([1.0, 1.21])
    np.testing.assert_allclose(driven.joint_force(spring)[ends, 5], wanted, rtol=1e-8)
    rest = moment * np.array([1.0, 1.1]) - wanted
    np.testing.assert_allclose(driven.joint_force(motor)[ends, 5], rest, atol=1e-6)


def test_joints_that_are_added_to_a_transferred_state_are_refused():
    """With what to do instead."""

    def made() -> fl.Scene:
        scene = fl.Scene()
        bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="bar"))
        hinge = scene.add(fl.joints.Revolute(fl.ground(), bar.point("start"), axis=(0, 1, 0)))
        scene.add(fl.joints.Spring(hinge.angle, stiffness=10.0))
        return scene

    scene, onto = made(), made()
    fl.adaptivity.transfer(fl.statics(scene), scene, onto)
    onto.add(fl.joints.InPlane(fl.ground(), onto.bodies[0].point("end"), axis=(0, 1, 0)))
    with pytest.raises(ValueError, match=r"add all joints before fl\.adaptivity\.transfer"):
        fl.GeneralisedAlpha().run(onto, duration=1e-3, step=1e-3)
