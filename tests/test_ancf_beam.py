"""Beams of positions and three slopes: laws of the element, statics, motion, joints, bad input."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from tests.body_alone import BodyAlone

STEEL = fl.Material(1e3, 0.3, 2.0)
SECTION = fl.Section.rectangle(0.2, 0.3, STEEL)
ELEMENTS = {
    "default": fl.elements.AncfElement(),
    "no flexibility": fl.elements.AncfElement(bending_flexibility=False),
    "other ratio": fl.elements.AncfElement(poisson=-0.2),
}
every_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def bowed(s):
    return np.array([s, 0.3 * s * s, 0.2 * s**3])


class Alone(BodyAlone):
    """A beam by itself."""

    def __init__(self, cells=2, element=None, section=SECTION):
        body = fl.AncfBeam.curve(bowed, section, cells=cells, formulation=element)
        super().__init__(body, body.model.assemble([body.model]))


@every_element
def test_forces_are_the_gradient_of_the_energy(element):
    beam, step = Alone(element=element), 1e-5
    H, d = beam.deformed(), np.random.default_rng(2).normal(size=(beam.count, 6))
    ahead, behind = (beam.term.energy(beam.follow(H, s * step * d)) for s in (1, -1))
    assert np.vdot(beam.forces(H), d) == pytest.approx((ahead - behind) / (2 * step), rel=1e-7)


@every_element
def test_tangent_is_the_derivative_of_the_forces(element):
    beam, step = Alone(element=element), 1e-5
    H, d = beam.deformed(), np.random.default_rng(2).normal(size=(beam.count, 6))
    ahead, behind = (beam.forces(beam.follow(H, s * step * d)) for s in (1, -1))
    numeric = ((ahead - behind) / (2 * step)).ravel()
    K = beam.matrix(H)
    np.testing.assert_allclose(K @ d.ravel(), numeric, atol=1e-7 * np.abs(numeric).max())
    np.testing.assert_allclose(K, K.T, atol=1e-13 * np.abs(K).max())


def test_linearised_stress_is_linear_along_the_increment():
    """That of the next state to first order, and exactly where the increment is zero."""
    beam, step = Alone(), 1e-4
    H, d = beam.deformed(), np.random.default_rng(2).normal(size=(beam.count, 6))
    beam.term.update_stress(H, step * d)
    values = beam.term.linearised_values
    beam.term.reset_stress(beam.follow(H, step * d))
    here = beam.term.linearised_values
    beam.term.reset_stress(H)
    gap, change = np.abs(values - here).max(), np.abs(here - beam.term.linearised_values).max()
    assert 0.0 < gap < 0.01 * change


@every_element
def test_rigid_motion_changes_nothing_in_local_axes(element):
    """Claim 5: no energy, forces that turn along, and the same matrix to round-off."""
    beam = Alone(element=element)
    H = beam.turned(beam.deformed(), np.eye(4, 3, -1))
    moved = beam.turned(H, lie.se3_exp(np.array([3.0, -2.0, 1.0, 2.0, 0.5, -1.5])))
    rest = beam.turned(beam.body.frames, lie.se3_exp(np.array([1.0, 2.0, 3.0, -1.0, 2.0, 1.0])))
    assert beam.term.energy(rest) < 1e-25
    force, K = beam.forces(H), beam.matrix(H)
    np.testing.assert_allclose(beam.forces(moved), force, atol=1e-12 * np.abs(K).max())
    np.testing.assert_allclose(beam.matrix(moved), K, atol=1e-12 * np.abs(K).max())


@every_element
def test_only_rigid_motions_have_no_energy(element):
    beam = Alone(1, element)
    K = beam.matrix(beam.body.frames)
    stiffness = np.linalg.eigvalsh(K)
    assert np.abs(stiffness[:6]).max() < 1e-12 * stiffness[-1]
    assert stiffness[6] > 1e-5 * stiffness[-1]
    rigid = node_types.rigid_motions(beam.kinds, beam.body.frames, np.zeros(3)).reshape(-1, 6)
    np.testing.assert_allclose(K @ rigid, 0.0, atol=1e-12 * stiffness[-1])


# --- statics --------------------------------------------------------------------------------------


def cantilever(beam, **load):
    scene = fl.Scene()
    scene.add(beam)
    beam.clamp(beam.point("start"))
    scene.add(fl.PointLoad(beam.point("end"), **load))
    return scene


def tip(beam, load_steps=1, **load):
    result = fl.statics(cantilever(beam, **load), load_steps=load_steps)
    return result.position(beam.point("end"))[-1], result


@pytest.mark.parametrize("cells", [1, 3])
def test_small_deflections_are_those_of_timoshenko(cells):
    """Force and moment at the tip, in both planes, tension with contraction, and twist: exact."""
    D, L, small = np.diag(SECTION.stiffness), 2.0, 1e-8
    beam = fl.AncfBeam.straight((0, 0, 0), (L, 0, 0), SECTION, cells=cells)
    moved, result = tip(beam, force=(small, small, small), moment=(small, 0, 0))
    across = [small * (L**3 / (3 * EI) + L / GA) for EI, GA in ((D[5], D[1]), (D[4], D[2]))]
    expected = np.array([small * L / D[0], *across])
    np.testing.assert_allclose(moved - (L, 0, 0), expected, rtol=5e-5)
    node = beam.model.points_count - 1
    rows = result.frames[-1][2 * node + 1]
    # the moment acts on one slope, and so shears the section a little
    assert 0.5 * (rows[1, 2] - rows[2, 1]) == pytest.approx(small * L / D[3], rel=1e-4)
    strained = [1 - 0.3 * small / D[0]] * 2
    np.testing.assert_allclose([rows[1, 1], rows[2, 2]], strained, atol=1e-4 * small / D[0])


def thin(slenderness):
    """EI = 1 of a beam of length one."""
    t = 1.0 / slenderness
    return fl.Section.rectangle(t, t, fl.Material(12.0 / t**4, 0.3, 1.0))


ELASTICA = np.array([0.44500440, 0.81060902])
"""Tip under 10 EI/L² without stretch and shear, by the differential equation."""


@pytest.mark.parametrize("slenderness", [1e2, 1e3, 1e4])
def test_elastica_does_not_lock(slenderness):
    errors = []
    for cells in (4, 8, 16):
        beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), thin(slenderness), cells=cells)
        position, result = tip(beam, 8, force=(0, 10.0, 0))
        assert result.total_iterations <= 5 * len(result.factors)
        errors.append(np.linalg.norm(position[:2] - ELASTICA))
    assert (np.array(errors) < [4e-3, 1.3e-3, 4e-4]).all()


@pytest.mark.parametrize("slenderness", [1e3, 1e4])
def test_rolls_up_to_a_full_circle(slenderness):
    beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), thin(slenderness), cells=16)
    position, result = tip(beam, 16, moment=(0, 0, 2 * np.pi))
    assert np.linalg.norm(position) < 5e-4
    assert result.total_iterations <= 5 * len(result.factors) and not result.failed_iterations


def test_the_limit_of_the_bend_is_that_of_beams_whose_sections_stay():
    """But for what sections deform, of the order of (thickness/radius)²: with stiffer ones not."""

    def lifted(beam):
        scene = fl.Scene()
        scene.add(beam)
        if isinstance(beam, fl.AncfBeam):
            beam.clamp(beam.point("start"))
        else:
            scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 600.0)))
        return fl.statics(scene, load_steps=3).position(beam.point("end"))[-1]

    def arc(s):
        return 100 * np.array([np.sin(s * np.pi / 4), 1 - np.cos(s * np.pi / 4), 0.0])

    gaps = []
    for stiff in (1.0, 100.0):
        EA, EI = stiff * 1e7, 1e7 / 12
        section = fl.Section.from_stiffness([EA, EA / 2, EA / 2, EI, EI, EI])
        exact = lifted(fl.Beam.curve(arc, section, cells=16))
        found = lifted(fl.AncfBeam.curve(arc, section, cells=32))
        gaps.append(np.linalg.norm(found - exact) / np.linalg.norm(exact))
    assert 1e-4 < gaps[0] < 2e-4 and gaps[1] < 2e-5


def test_a_stretched_beam_pulls():
    """Laid a hundredth longer than it is: Green's strain, and half as much stress again."""
    beam = fl.AncfBeam.straight((0, 0, 0), (1.01, 0, 0), SECTION, cells=3, length=1.0)
    assert beam.model.lengths.sum() == pytest.approx(1.0, rel=1e-14)
    strains = beam.model.assemble([beam.model]).strains(beam.frames)
    np.testing.assert_allclose(strains[:, [0, 3, 6]], 0.5 * (1.01**2 - 1), rtol=1e-12)
    np.testing.assert_allclose(np.delete(strains, [0, 3, 6], axis=1), 0.0, atol=1e-14)


def test_vibrations_are_those_of_beams():
    slim = fl.Section.rectangle(0.05, 0.05, fl.Material(2e11, 0.3, 7800.0))
    beam = fl.AncfBeam.straight((0, 0, 0), (2, 0, 0), slim, cells=16)
    beam.clamp(beam.point("start"))
    fine = fl.Beam.straight((0, 0, 0), (2, 0, 0), slim, cells=64)
    scenes = [fl.Scene(), fl.Scene()]
    for scene, item in zip(scenes, (beam, fine), strict=True):
        scene.add(item)
    scenes[1].add(fl.Clamp(fine.point("start")))
    found, expected = (fl.vibrations(scene, 4).frequencies for scene in scenes)
    np.testing.assert_allclose(found, expected, rtol=1e-3)


def test_line_loads_and_gravity_agree():
    """A weight along the beam, as a load and as gravity, on an arc: the same equilibrium."""
    scenes = []
    for gravity in (True, False):
        beam = fl.AncfBeam.curve(bowed, SECTION, cells=3)
        beam.clamp(beam.point("start"))
        weight = np.array([0, 0, -SECTION.inertia[0, 0] * 0.05])
        scene = fl.Scene(gravity=(0, 0, -0.05)) if gravity else fl.Scene()
        scene.add(beam)
        if not gravity:
            scene.add(fl.LineLoad(beam, force=weight))
        scenes.append(fl.statics(scene).position(beam.point("end"))[-1])
    assert np.linalg.norm(scenes[0] - bowed(1.0)) > 1e-3
    np.testing.assert_allclose(scenes[0], scenes[1], atol=1e-9)


def test_a_hinged_beam_swings_as_one_of_frames_with_one_matrix():
    def swing(made, cells):
        own = fl.Section.from_stiffness([1e4, 4e3, 4e3, 1.0, 1.0, 1.0], mass=1.0, polar=1e-3)
        body = made.straight((0, 0, 0), (1, 0, 0), own, cells=cells)
        scene = fl.Scene(gravity=(0, 0, -9.81))
        scene.add(body)
        scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
        result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.3, step=1e-3)
        return result.position(body.point("end")), result.k_updates

    positions, matrices = swing(fl.AncfBeam, 12)
    expected, _ = swing(fl.Beam, 24)
    assert matrices == 1
    np.testing.assert_allclose(positions, expected, atol=5e-4)


def test_tumbling_conserves_energy_and_momenta():
    own = fl.Section.from_stiffness([1e4, 4e3, 4e3, 1.0, 1.0, 1.0], mass=1.0, polar=1e-3)
    beam = fl.AncfBeam.curve(bowed, own, cells=4)
    beam.add_velocity(omega=(3.0, 4.0, 2.0), about=(0.4, 0.2, 0.0))
    scene = fl.Scene()
    scene.add(beam)
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=1e-3)
    assert np.ptp(result.total_energy) < 1e-11 * result.total_energy[0]
    for momentum in (result.momentum, result.angular_momentum):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(momentum[0]).max()


@pytest.mark.parametrize("slenderness", [0.5, 2.0, 6.0])
def test_restrained_warping_is_that_of_vlasov(slenderness):
    """A cantilever of an I section, twisted at its tip: φ = T L/GJ (1 − tanh kL/kL)."""
    GJ, L, T = 2.0, 3.0, 1e-6
    EIw = GJ * (L / slenderness) ** 2
    own = fl.Section.from_stiffness([1e3, 4e2, 4e2, GJ, 5.0, 1.0])
    errors = []
    for cells in (8, 24):
        beam = fl.AncfBeam.straight((0, 0, 0), (L, 0, 0), own, cells=cells, warping=EIw)
        _, result = tip(beam, moment=(T, 0, 0))
        rows = result.frames[-1][2 * beam.model.points_count - 1]
        twist = 0.5 * (rows[1, 2] - rows[2, 1])
        exact = T * L / GJ * (1 - np.tanh(slenderness) / slenderness)
        errors.append(abs(twist / exact - 1))
    assert errors[0] < 0.06 and errors[1] < 0.02 and errors[1] < errors[0]


# --- bad input ------------------------------------------------------------------------------------


def test_corners_are_refused():
    mesh = fl.mesh.LineMesh.from_cells([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1), (1, 2)])
    with pytest.raises(ValueError, match="corners or branches"):
        fl.AncfBeam(mesh, SECTION)


def test_damping_with_strain_is_refused():
    with pytest.raises(ValueError, match="with mass only"):
        fl.AncfBeam.straight(
            (0, 0, 0), (1, 0, 0), SECTION, cells=2, damping=fl.sections.Damping(stiffness=0.1)
        )


def test_a_clamp_of_half_a_point_is_refused():
    beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2)
    with pytest.raises(ValueError, match=r"AncfBeam\.clamp"):
        fl.Clamp(beam.point("start")).check()
    with pytest.raises(ValueError, match="not a node of it"):
        beam.clamp(beam.point_in_cell(0, 0.5))


@pytest.mark.parametrize("ratio", [0.5, -1.0, 0.7])
def test_no_ratio_of_poisson(ratio):
    with pytest.raises(ValueError, match=r"between -1 and 0\.5"):
        fl.elements.AncfElement(poisson=ratio)
