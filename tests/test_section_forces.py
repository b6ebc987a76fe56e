"""Section forces of beams: equilibrium at any size, closed forms, objectivity, files."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from demos.elastica import elastica
from fem_lie import lie
from tests.assembled import Assembled

EA, GA, GJ, EI2, EI3 = 1e4, 5e3, 50.0, 100.0, 70.0
SECTION = fl.Section.from_stiffness([EA, GA, GA, GJ, EI2, EI3], mass=0.5, rotary=(2e-4, 1e-4))
STEEL = fl.Material(2e11, 0.3, 7800.0)
LENGTH = 2.0
FORMULATIONS = [
    fl.elements.GeodesicBeam(),
    fl.elements.DirectorBeam(1),
    fl.elements.DirectorBeam(2),
    fl.elements.KirchhoffRod(),
]
every_formulation = pytest.mark.parametrize("formulation", FORMULATIONS, ids=str)


def cantilever(cells: int, section: fl.Section = SECTION, formulation=None, **options):
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight(
            (0, 0, 0),
            (LENGTH, 0, 0),
            section,
            cells=cells,
            up=(0, 0, 1),
            formulation=formulation,
            **options,
        )
    )
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


def branch(damping: fl.sections.Damping | None = None) -> tuple[fl.Scene, fl.Beam]:
    """A kink and a branch: nodes that follow others."""
    scene = fl.Scene()
    mesh = fl.mesh.LineMesh.from_cells(
        [(0, 0, 0), (1, 0, 0), (1.2, 0.8, 0), (1.5, 0, 0.8), (2, 0, 0)],
        [(0, 1), (1, 2), (1, 3), (1, 4)],
    )
    return scene, scene.add(fl.Beam(mesh, SECTION, damping=damping))


def helix(s: float) -> tuple[float, float, float]:
    return 3 * np.cos(2 * s), 3 * np.sin(2 * s), s


def twisted_arc(formulation, section=SECTION) -> tuple[fl.Scene, fl.Beam]:
    scene = fl.Scene()
    beam = fl.Beam.curve(
        helix, section, cells=5, formulation=formulation, up=fl.sections.Twisted(lambda s: 0.3 * s)
    )
    return scene, scene.add(beam)


def in_frames(scene: fl.Scene, beam: fl.Beam, frames: np.ndarray) -> fl.post.SectionForces:
    """Those of one beam of a scene in given frames of its nodes."""
    info = fl.extend.Equations(scene, dynamics=False).info
    placed = np.zeros((sum(len(body.nodes) for body in info.bodies), 4, 3))
    placed[info.body(beam.name).nodes] = frames
    result = fl.StaticResult(
        np.ones(1),
        placed[np.newaxis],
        np.zeros((1, 0, 6)),
        np.zeros(1, dtype=np.int64),
        0,
        info,
        None,
        0.0,
        np.zeros((1, 0, 6)),
    )
    return fl.post.section_forces(result, beam, scene)


# --- equilibrium ----------------------------------------------------------------------------------


@every_formulation
def test_each_section_carries_what_acts_beyond_it(formulation):
    """A tip force and moment that bend and twist by more than a radian: all cuts, in space."""
    scene, beam = cantilever(6, formulation=formulation)
    force, moment = np.array([0.0, -20.0, 40.0]), np.array([30.0, 10.0, -20.0])
    scene.add(fl.PointLoad(beam.point("end"), force=force, moment=moment))
    result = fl.statics(scene, load_steps=2)
    found = fl.post.section_forces(result, beam, scene)
    assert found.times.tolist() == result.factors.tolist()
    ends = beam.model.elements[:, :2]
    for k, factor in enumerate(result.factors):
        x = found.frames[k, ends, 0]
        lever = found.frames[k, beam.model.elements[-1, 1], 0] - x
        expected = factor * (moment + np.cross(lever, force))
        # Newton's tolerance, times an axial stiffness of 1e4
        np.testing.assert_allclose(
            found.cut_forces[k], np.broadcast_to(factor * force, x.shape), atol=1e-6
        )
        np.testing.assert_allclose(found.cut_moments[k], expected, atol=1e-6)
        nodes = found.frames[k, beam.model.elements]
        half = 0.5 * lie.se3_relative(nodes[:, 0], nodes[:, 1])
        middle = nodes[:, 2] if nodes.shape[1] == 3 else lie.se3_retract(nodes[:, 0], half)
        lever = found.frames[k, beam.model.elements[-1, 1], 0] - middle[:, 0]
        expected = np.stack(
            [factor * force + 0 * lever, factor * (moment + np.cross(lever, force))]
        )
        local = np.einsum("mij,amj->mai", middle[:, 1:], expected).reshape(-1, 6)
        np.testing.assert_allclose(found.middle[k], local, atol=1e-6)
    assert np.arccos(result.rotation(beam.point("end"))[-1, 0, 0]) > 0.8
    # components are along the directors
    axes = result.rotation(beam.point("end"))[-1]
    np.testing.assert_allclose(found.ends[-1, -1, 1, :3], force @ axes, atol=1e-6)
    for i, name in enumerate(("N", "Vy", "Vz", "T", "My", "Mz")):
        np.testing.assert_array_equal(found.raw(name), found.ends[..., i])
    np.testing.assert_allclose(found.at(beam.point("end"), "T")[-1], moment @ axes[:, 0], atol=1e-6)
    # nothing acts between the ends: nothing jumps
    np.testing.assert_allclose(found.smooth_ends, found.ends, atol=1e-6)


def test_signs():
    """N pulls, a force to +z at the tip pulls at the top of the root where z < 0, and so on."""
    small = np.array([3.0, 2.0, 1.0]) * 1e-6
    scene, beam = cantilever(2)
    scene.add(fl.PointLoad(beam.point("end"), force=small, moment=(4e-6, 0, 0)))
    found = fl.post.section_forces(fl.statics(scene), beam, scene)
    root = [found.at(beam.point("start"), name)[-1] for name in ("N", "Vy", "Vz", "T", "My", "Mz")]
    expected = [*small, 4e-6, -small[2] * LENGTH, small[1] * LENGTH]
    np.testing.assert_allclose(root, expected, rtol=0, atol=1e-11)
    square = fl.Section.rectangle(1.0, 1.0, STEEL)
    points = [(0, 0.5), (-0.5, 0)]
    assert (square.axial_stress(points)[[0, 1], [1, 2]] > 0).all()
    assert (square.axial_stress(points)[:, 0] > 0).all()


@pytest.mark.parametrize("seed", range(2))
def test_what_meets_at_a_node_is_the_residual_of_the_scene(seed):
    """Far from equilibrium, at a kink and a branch, with damping."""
    scene, beam = branch(fl.sections.Damping(stiffness=0.1))
    damped, free = (
        Assembled(each, dynamics=True) for each in (scene, branch(fl.sections.Damping())[0])
    )
    rng = np.random.default_rng(seed)
    H = damped.moved(damped.start, 0.4 * rng.normal(size=(damped.count, 6)))
    v = rng.normal(size=(damped.count, 6))
    # without the forces of inertia that velocities have
    r = damped.residual(H) + damped.residual(H, v) - free.residual(H, v)
    report, arrays = damped.equations.report(H, v), damped.equations.arrays
    motion = fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3)
    motion = replace(
        motion,
        frames=np.tile(report.frames, (2, 1, 1, 1)),
        velocities=np.tile(report.twists, (2, 1, 1)),
    )
    found = fl.post.section_forces(motion, beam, scene, states=[-1])
    total, numbers = np.zeros((damped.count, 6)), motion.info.body(beam.name).nodes
    for (start, end), (first, second) in zip(
        numbers[beam.model.elements], found.ends[0], strict=True
    ):
        for node, wrench in ((start, -first), (end, second)):
            turn = lie.se3_adjoint(lie.se3_inverse(arrays.offset[node]))
            total[arrays.master[node]] += turn.T @ wrench
    np.testing.assert_allclose(total.ravel(), r, atol=1e-11 * np.abs(r).max())


def test_equilibrium_of_a_frame_with_a_branch():
    """Both arms of a branch hang on its stem, and a body on a link."""
    scene, beam = branch()
    scene.add(fl.Clamp(beam.point(0)))
    weight = scene.add(fl.RigidBody(1.0, (1, 1, 1), (1.2, 1.0, 0.3)))
    scene.add(fl.joints.RigidLink(beam.point(2), weight.point("centre")))
    loads = {3: np.array([0.0, 4.0, -3.0]), 4: np.array([2.0, 0.0, 1.0])}
    for node, force in loads.items():
        scene.add(fl.PointLoad(beam.point(node), force=force))
    scene.add(fl.PointLoad(weight.point("centre"), force=(1.0, 0.0, -2.0)))
    result = fl.statics(scene)
    found = fl.post.section_forces(result, beam, scene)
    total = np.array([3.0, 4.0, -4.0])
    np.testing.assert_allclose(found.cut_forces[-1, 0], [total, total], atol=1e-7)
    root = beam.frames[0, 0]
    about = np.cross(result.position(weight.point("centre"))[-1] - root, [1.0, 0.0, -2.0])
    about += sum(np.cross(result.position(beam.point(n))[-1] - root, f) for n, f in loads.items())
    np.testing.assert_allclose(found.cut_moments[-1, 0, 0], about, atol=1e-7)
    np.testing.assert_allclose(found.cut_forces[-1, 1, 0], [1.0, 0.0, -2.0], atol=1e-7)
    # the stem and the arm that goes straight on share a frame, but values jump there
    np.testing.assert_array_equal(found.smooth_ends, found.ends)
    with pytest.raises(ValueError, match="has 4 values at"):
        found.at(beam.point(1), "N")


def test_little_weight_carries_the_force_of_the_joint_at_all_times():
    """A heavy body swings on a beam without much mass: what the joint has, the beam has."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    light = fl.Section.from_stiffness([EA, GA, GA, GJ, EI2, EI3], mass=1e-7, polar=2e-11)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), light, cells=2))
    body = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (1, 0, 0)))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    joint = scene.add(fl.joints.Fixed(beam.point("end"), body.point("centre")))
    result = fl.GeneralisedAlpha(radius=0.5).run(scene, duration=0.2, step=0.01)
    found = fl.post.section_forces(result, beam, scene)
    axes = joint.frame()[1:] @ beam.point("end").frame[1:].T  # of the joint in the node's frame
    wrench = result.joint_force(joint).reshape(-1, 2, 3) @ axes
    assert np.abs(wrench).max() > 4.0
    for i, name in enumerate(("N", "Vy", "Vz", "T", "My", "Mz")):
        expected = wrench[:, i // 3, i % 3]
        # at the start the joint feels the load and the beam nothing yet
        np.testing.assert_allclose(found.at(beam.point("end"), name)[1:], expected[1:], atol=1e-5)


# --- what the element is --------------------------------------------------------------------------


@every_formulation
def test_rigid_motion_changes_nothing(formulation):
    scene, beam = twisted_arc(formulation)
    rng = np.random.default_rng(1)
    H = lie.se3_retract(beam.frames, 0.3 * rng.normal(size=(len(beam.frames), 6)))
    R, moved = lie.so3_exp(rng.normal(size=3)), H.copy()
    moved = moved @ R.T
    moved[:, 0] += rng.normal(size=3)
    one, other = in_frames(scene, beam, H), in_frames(scene, beam, moved)
    scale = np.abs(one.ends).max()
    for name in ("ends", "middle", "smooth_ends"):
        np.testing.assert_allclose(getattr(other, name), getattr(one, name), atol=1e-12 * scale)
    np.testing.assert_allclose(other.at_points(), one.at_points(), atol=1e-12 * scale)
    np.testing.assert_allclose(other.cut_forces, one.cut_forces @ R.T, atol=1e-12 * scale)


@every_formulation
def test_nothing_unloaded(formulation):
    scene, beam = twisted_arc(formulation)
    assert np.abs(in_frames(scene, beam, beam.frames).ends).max() < 1e-10


@pytest.mark.parametrize("curved", [False, True])
def test_coupled_section_under_constant_strain(curved):
    """``σ = D ε`` of a full 6×6 section, stretched, sheared, twisted and bent by any amount."""
    D = np.diag([90.0, 40, 30, 8, 6, 7]) + np.cos(np.add.outer(np.arange(6), np.arange(6)))
    section, formulation = (
        fl.Section.from_stiffness(D),
        fl.elements.GeodesicBeam(bending_flexibility=False),
    )
    scene = fl.Scene()
    rest = np.array([1.0, 0, 0, 0, 0, 0.8 if curved else 0])
    shape = (
        (lambda s: (np.sin(0.8 * s) / 0.8, (1 - np.cos(0.8 * s)) / 0.8, 0.0))
        if curved
        else (lambda s: (s, 0.0, 0.0))
    )
    beam = scene.add(fl.Beam.curve(shape, section, cells=4, formulation=formulation))
    strain = np.array([0.2, -0.1, 0.15, 1.1, -0.7, 0.9])
    s = np.linspace(0, 1, 5)
    frames = lie.se3_retract(beam.frames[0], s[:, np.newaxis] * (rest + strain))
    found = in_frames(scene, beam, frames)
    np.testing.assert_allclose(
        found.at_points(), np.broadcast_to(D @ strain, (4, 1, 6)), atol=1e-9 * 90
    )


@pytest.mark.parametrize("seed", range(2))
def test_stress_of_the_geodesic_element_is_the_mean_of_its_section_forces(seed):
    """``T₆ᵀ(d) σ_B = ∫ Ad(exp(−s d))ᵀ σ_B ds``, carried along the element in turning axes."""
    scene, beam = twisted_arc(fl.elements.GeodesicBeam())
    rng = np.random.default_rng(seed)
    H = lie.se3_retract(beam.frames, 0.3 * rng.normal(size=(len(beam.frames), 6)))
    found = in_frames(scene, beam, H)
    a, b = H[beam.model.elements].transpose(1, 0, 2, 3)
    T = lie.se3_tangent(lie.se3_relative(a, b))
    mean = np.einsum("mji,mj->mi", T, found.ends[0, :, 1])
    scale = np.abs(mean).max()
    np.testing.assert_allclose(found.at_points()[:, 0], mean, atol=1e-12 * scale)


def test_viscous_part():
    """Kelvin and Voigt: a bar that is pulled at a rate."""
    scene, beam = cantilever(3, damping=fl.sections.Damping(stiffness=0.1))
    motion = fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3)
    velocities = np.zeros_like(motion.velocities)
    velocities[1, :, 0] = 0.5 * motion.frames[1, :, 0, 0]
    found = fl.post.section_forces(replace(motion, velocities=velocities), beam, scene)
    np.testing.assert_allclose(found.mean("N")[1], EA * 0.1 * 0.5, rtol=1e-12)
    np.testing.assert_allclose(found.at_points(1), 0.0, atol=1e-9)


# --- loads along the line -------------------------------------------------------------------------


@every_formulation
@pytest.mark.parametrize(
    ("axis", "shear", "moment", "sign"), [(1, "Vy", "Mz", 1), (2, "Vz", "My", -1)]
)
def test_line_load(formulation, axis, shear, moment, sign):
    """Exact: means, and shears and moments at the ends without jumps."""
    q, cells = 1e-4, 4
    scene, beam = cantilever(cells, formulation=formulation)
    scene.add(fl.LineLoad(beam, force=q * np.eye(3)[axis]))
    found = fl.post.section_forces(fl.statics(scene), beam, scene)
    x, size = found.arc, q * LENGTH
    tolerance = {"rtol": 0, "atol": 1e-6 * size}
    np.testing.assert_allclose(found.mean(shear)[-1], q * (LENGTH - x.mean(axis=1)), **tolerance)
    np.testing.assert_allclose(found.smooth(shear)[-1], q * (LENGTH - x), **tolerance)
    bent = sign * q * (LENGTH - x) ** 2 / 2
    np.testing.assert_allclose(found.smooth(moment)[-1], bent, **tolerance)
    if formulation == fl.elements.GeodesicBeam():
        cubes = (LENGTH - x[:, 1]) ** 3 - (LENGTH - x[:, 0]) ** 3
        mean = -sign * q * cubes / 6 / (LENGTH / cells)
        np.testing.assert_allclose(found.mean(moment)[-1], mean, **tolerance)
    jumps = found.raw(shear)[-1, :-1, 1] - found.raw(shear)[-1, 1:, 0]
    part = (
        1.0 if formulation != fl.elements.DirectorBeam(2) else 1 / 3
    )  # the rest is on the inner nodes
    np.testing.assert_allclose(jumps, q * part * LENGTH / cells, **tolerance)


def test_a_single_force_stays_a_jump():
    """LowRankCorrection a line load, and with elements of different lengths."""
    q, single = 1e-4, 3e-4
    s = np.array([0.0, 0.3, 0.7, 1.0, 1.6, 2.0])
    mesh = fl.mesh.LineMesh.from_cells(np.outer(s, [1, 0, 0]), [(i, i + 1) for i in range(5)])
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, SECTION, up=(0, 0, 1)))
    scene.add(fl.Clamp(beam.point(0)))
    scene.add(fl.LineLoad(beam, force=(0, 0, q)))
    scene.add(fl.PointLoad(beam.point(3), force=(0, 0, single)))
    found = fl.post.section_forces(fl.statics(scene), beam, scene)
    expected = q * (LENGTH - found.arc) + single * (np.arange(5) < 3)[:, np.newaxis]
    np.testing.assert_allclose(found.smooth("Vz")[-1], expected, atol=1e-6 * q)
    with pytest.raises(ValueError, match="has 2 values at"):
        found.at(beam.point(3), "Vz")
    np.testing.assert_allclose(found.at(beam.point(1), "Vz")[-1], expected[0, 1], atol=1e-6 * q)


def test_nothing_is_smooth_where_something_slides():
    """Its force is on the nodes of the element where it is."""
    scene, beam = cantilever(4)
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1), (0.6 * LENGTH, 0, 0)))
    scene.add(fl.joints.Sliding(beam, body.point("centre")))
    found = in_frames(scene, beam, lie.se3_retract(beam.frames, 0.1 * np.ones((5, 6))))
    np.testing.assert_array_equal(found.smooth_ends, found.ends)
    assert set(found.single) == set(range(5))


@every_formulation
def test_a_beam_on_a_hub(formulation):
    """N = ρA Ω² (L² − r²)/2: its mean in each element, and of second order at the ends."""
    spin, errors = 10.0, []
    section = fl.Section.rectangle(0.02, 0.04, STEEL)
    for cells in (4, 8):
        scene, beam = cantilever(cells, section, formulation)
        found = fl.post.section_forces(fl.statics(scene, spin=(0, 0, spin)), beam, scene)
        scale = beam.model.density[0, 0, 0] * spin**2 / 2
        a, b = found.arc.T
        mean = scale * (LENGTH**2 - (a**2 + a * b + b**2) / 3)
        # the stretched position is N/EA = 1e-5 further out
        np.testing.assert_allclose(found.mean("N")[-1], mean, rtol=2e-5, atol=1e-3 * scale)
        error = found.smooth("N")[-1] - scale * (LENGTH**2 - found.arc**2)
        errors.append(np.abs(error).max() / scale)
    # relative errors are h²/6 of second order at the root
    assert errors[0] / errors[1] > 3.7
    assert errors[1] < 0.05


def test_spin_up_in_time():
    """In a turning frame at rest: the same force by dynamics."""
    spin = 10.0
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.04, STEEL)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=8, up=(0, 0, 1)))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    beam.add_velocity(omega=(0, 0, spin), about=beam.point("start"))
    # large steps damp the axial vibration that starts with the load
    result = fl.GeneralisedAlpha(radius=0.0).run(scene, duration=0.5, step=0.01)
    found = fl.post.section_forces(result, beam, scene)
    scale = beam.model.density[0, 0, 0] * spin**2 / 2
    a, b = found.arc.T
    mean = scale * (LENGTH**2 - (a**2 + a * b + b**2) / 3)
    np.testing.assert_allclose(found.mean("N")[-1], mean, rtol=2e-3, atol=2e-3 * scale)


# --- closed forms ---------------------------------------------------------------------------------


def test_pure_bending_to_a_circle():
    """The moment is the same everywhere, and there is no force."""
    scene, beam = cantilever(8)
    moment = 2 * np.pi * EI3 / LENGTH
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, moment)))
    found = fl.post.section_forces(fl.statics(scene, load_steps=6), beam, scene)
    np.testing.assert_allclose(found.middle[-1, :, 5], moment, rtol=1e-9)
    np.testing.assert_allclose(found.middle[-1, :, :5], 0.0, atol=1e-6)
    np.testing.assert_allclose(found.at_points()[:, 0], found.middle[-1], atol=1e-6)


def test_elastica():
    """The moment at the root is force times lever of the bent rod."""
    EA, EI, length, force = 1e6, 100.0, 10.0, 4.0
    section = fl.Section.from_stiffness([EA, EA / 2, EA / 2, EI, EI, EI])
    errors = []
    for cells in (8, 16):
        scene = fl.Scene()
        beam = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells))
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, force)))
        found = fl.post.section_forces(fl.statics(scene, load_steps=4), beam, scene)
        exact = -force * (length + elastica(force)[0])
        errors.append(abs(found.at(beam.point("start"), "My")[-1] / exact - 1))
    assert max(errors) < 2e-6  # what is left with EA L²/EI = 1e6 is stretch and shear


# --- strains without stress -----------------------------------------------------------------------


def test_warming_between_clamps_and_histories():
    """``N = −EA α ΔT`` at each load factor; a history goes with the factor, too."""
    scene, beam = cantilever(3)
    scene.add(fl.Clamp(beam.point("end")))
    scene.add(fl.loads.Temperature(beam, 20.0, 1e-4))
    scene.add(fl.loads.Eigenstrain(beam, (1e-3, 0, 0, 0, 0, 0), history=lambda t: t**2))
    found = fl.post.section_forces(fl.statics(scene, load_steps=2), beam, scene)
    expected = -EA * (2e-3 * found.times + 1e-3 * found.times**2)
    np.testing.assert_allclose(found.mean("N"), np.tile(expected, (3, 1)).T, rtol=1e-9)
    np.testing.assert_allclose(found.at_points(0)[:, 0, 0], expected[0], rtol=1e-9)


def test_constant_strains_act_from_the_start_in_dynamics():
    given = np.array([100.0, 20, -30, 4, 5, -6])
    scene, beam = cantilever(2)
    for k in (1, 2):
        scene.add(fl.Clamp(beam.point(k)))
    scene.add(fl.loads.PreStress(beam, given))
    result = fl.GeneralisedAlpha().run(scene, duration=2e-3, step=1e-3)
    found = fl.post.section_forces(result, beam, scene)
    np.testing.assert_allclose(found.middle, np.broadcast_to(given, (3, 2, 6)), atol=1e-9)


# --- stress ---------------------------------------------------------------------------------------


def test_axial_stress_has_the_force_and_moments_of_the_section():
    """Integrated over a rectangle off the axis and turned: N, M_y and M_z about the axis."""
    b, h, angle = 0.3, 0.7, 0.4
    section = fl.Section.rectangle(b, h, STEEL).offset(0.2, -0.1).rotated(angle)
    x, w = np.polynomial.legendre.leggauss(3)
    grid = np.array([(0.5 * b * s - 0.2, 0.5 * h * t + 0.1) for s in x for t in x])
    c, s = np.cos(angle), np.sin(angle)
    y, z = points = np.array([[c, -s], [s, c]]) @ grid.T
    area = 0.25 * b * h * np.outer(w, w).ravel()
    stress = section.axial_stress(points.T)
    found = np.array([area, area * z, -area * y]) @ stress
    np.testing.assert_allclose(found, np.eye(3), atol=1e-12)


def test_largest_stress_of_a_bent_and_pulled_bar():
    """``N/A ± M_y/W``, at both ends and in the middle."""
    b, h, force = 0.02, 0.04, 1e-3
    scene, beam = cantilever(2, fl.Section.rectangle(b, h, STEEL))
    scene.add(fl.PointLoad(beam.point("end"), force=(5 * force, 0, force)))
    found = fl.post.section_forces(fl.statics(scene), beam, scene)
    bending = force * (LENGTH - found.arc) * 6 / (b * h**2)
    pull = 5 * force / (b * h)
    atol = 1e-6 * bending.max()
    np.testing.assert_allclose(found.raw("stress max")[-1], pull + bending, atol=atol)
    np.testing.assert_allclose(found.raw("stress min")[-1], pull - bending, atol=atol)
    middle = pull + bending.mean(axis=1)
    np.testing.assert_allclose(found.mean("stress max")[-1], middle, atol=atol)
    np.testing.assert_allclose(found.raw("V")[-1], force, rtol=1e-6)


# --- pictures, files, input -----------------------------------------------------------------------


def test_files_hold_the_values(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    scene, beam = cantilever(3, formulation=fl.elements.DirectorBeam(2))
    scene.add(fl.RigidBody(1.0, (1, 1, 1), (5, 0, 0)))
    scene.add(fl.PointLoad(beam.point("end"), force=(1.0, 2.0, 30.0)))
    result = fl.GeneralisedAlpha().run(scene, duration=0.02, step=0.01)
    found = fl.post.section_forces(result, beam, scene)
    found.write_vtk(tmp_path / "forces.pvd")
    series = pyvista.get_reader(str(tmp_path / "forces.pvd"))
    np.testing.assert_allclose(series.time_values, result.times)
    series.set_active_time_value(result.times[2])
    data = series.read()[0]
    assert (data.n_cells, data.n_points) == (3, 6)
    np.testing.assert_allclose(data.point_data["My"], found.raw("My")[2].ravel())
    np.testing.assert_allclose(data.cell_data["Vz"], found.mean("Vz")[2])
    np.testing.assert_allclose(data.point_data["force"], found.cut_forces[2].reshape(-1, 3))
    result.write_vtk(tmp_path / "all.pvd", forces=[found])
    series = pyvista.get_reader(str(tmp_path / "all.pvd"))
    series.set_active_time_value(result.times[2])
    data = series.read()[0]
    expected = [np.nan, *np.repeat(found.mean("My")[2], 2)]  # a body, then two lines an element
    np.testing.assert_allclose(data.cell_data["My"], expected)
    some = fl.post.section_forces(result, beam, scene, states=[0])
    with pytest.raises(ValueError, match=r"expected .* at all 3 times, got 1"):
        result.write_vtk(tmp_path / "some.pvd", forces=[some])


def test_diagram(tmp_path):
    """A line for each piece and each state, from end to end."""
    scene, beam = branch()
    scene.add(fl.Clamp(beam.point(0)))
    scene.add(fl.PointLoad(beam.point(2), force=(1.0, 2.0, 3.0)))
    found = fl.post.section_forces(fl.statics(scene, load_steps=2), beam, scene)
    units = fl.post.Units(length="m", force="kN")
    figure = found.plot("N", "My", states=(0, 1), path=tmp_path / "N.png", units=units)
    assert (tmp_path / "N.png").stat().st_size > 10_000
    above, below = figure.axes
    assert (above.get_ylabel(), below.get_ylabel()) == ("N [kN]", "My [kN m]")
    lines = [line for line in above.get_lines() if len(line.get_xdata()) > 2 or line.get_alpha()]
    assert len(lines) == 2 * len(beam.model.chains.first)
    np.testing.assert_allclose(
        lines[1].get_ydata()[:2], found.raw("N")[1, beam.model.chains.order[0]]
    )
    assert len(found.plot(smooth=True).axes) == 6


def test_bad_input_is_named():
    scene, beam = cantilever(2)
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 1.0)))
    result = fl.statics(scene)
    other = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=3, name="other")
    with pytest.raises(ValueError, match="other is not in the scene"):
        fl.post.section_forces(result, other, scene)
    scene.add(other)
    with pytest.raises(ValueError, match="no body 'other'"):
        fl.post.section_forces(result, other, scene)
    with pytest.raises(ValueError, match="has 1 states, got state 1"):
        fl.post.section_forces(result, beam, scene, states=[1])
    with pytest.raises(TypeError, match=r"state must be the number of a state, got 0\.5"):
        fl.post.section_forces(result, beam, scene, states=[0.5])
    found = fl.post.section_forces(result, beam, scene)
    with pytest.raises(ValueError, match="has no quantity 'Nx'; it has: N, Vy"):
        found.raw("Nx")
    with pytest.raises(ValueError, match="axial stress needs a section that knows"):
        found.raw("stress max")
    with pytest.raises(ValueError, match=r"other\.end is not a point of beam 1"):
        found.at(other.point("end"), "N")
    with pytest.raises(ValueError, match="no outline"):
        section = fl.Section.rectangle(1, 1, STEEL)
        replace(section, outline=None).axial_stress()
