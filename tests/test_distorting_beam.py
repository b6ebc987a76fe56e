"""Beams with sections that distort: laws of their cells, closed forms, and values of shells."""

from functools import cache
from math import pi, sqrt

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from tests.body_alone import BodyAlone

NU = 0.3
STEEL = fl.Material(E=2.1e11, nu=NU, density=7800.0)
SHAPES = fl.sections.SectionShape
UP = (0, 0, 1)


@cache
def section(name):
    """Sections that several tests use."""
    shape, modes = {
        "tube": (SHAPES.tube(0.99, 1.01), 2),
        "box": (SHAPES.box(0.4, 0.3, 0.01), 1),
        "channel": (SHAPES.channel(0.1, 0.2, 0.006, 0.006), 3),
        "square": (SHAPES.rectangle(0.1, 0.1), 1),
        "lipped channel": (SHAPES.polygon(lipped_channel(0.002)), 3),
    }[name]
    return fl.sections.Distortion(shape.mesh, STEEL, modes=modes)


def lipped_channel(thickness):
    """Outline of a channel of 0.2 by 0.06 with lips of 0.02, walls about these mid-lines."""
    t = 0.5 * thickness
    half = [(0.06 + t, 0.1 + t), (0.06 + t, 0.08), (0.06 - t, 0.08), (0.06 - t, 0.1 - t)]
    half.append((t, 0.1 - t))
    upper = [(-t, 0.1 + t), *half]
    return [*upper, *((y, -z) for y, z in reversed(upper))]


def straight(name, length, cells, **arguments):
    return fl.reduction.DistortingBeam.straight(
        (0, 0, 0), (length, 0, 0), section(name), cells=cells, up=UP, **arguments
    )


def cantilever(name, length, cells):
    scene = fl.Scene()
    beam = scene.add(straight(name, length, cells))
    scene.add(fl.Clamp(beam.point("start")))
    beam.hold_shape(beam.point("start"))
    beam.hold_warping(beam.point("start"))
    return scene, beam


# --- cells ----------------------------------------------------------------------------------------


def curved():
    """Beam on an arc, with two modal nodes at a point, by itself."""
    beam = fl.reduction.DistortingBeam.curve(
        lambda s: (np.sin(s), 0.1 * s, 1.0 - np.cos(s)), section("channel"), cells=2
    )
    alone = BodyAlone(beam, beam.model.assemble([beam.model]))
    alone.size = 0.01
    return alone


def close(found, expected, relative):
    np.testing.assert_allclose(found, expected, rtol=0, atol=relative * np.abs(expected).max())


def test_an_unloaded_curved_beam_has_no_forces():
    alone = curved()
    forces = alone.forces(alone.deformed())
    assert np.abs(alone.forces(alone.body.frames)).max() < 1e-12 * np.abs(forces).max()


def test_forces_are_the_gradient_of_the_energy():
    alone, h = curved(), 1e-6
    H, d = alone.deformed(), alone.rng.normal(size=(alone.count, 6))
    ahead, behind = (alone.term.energy(alone.follow(H, s * h * d)) for s in (1.0, -1.0))
    assert (ahead - behind) / (2 * h) == pytest.approx(np.vdot(alone.forces(H), d), rel=1e-7)


def test_the_tangent_is_the_derivative_of_the_forces():
    alone, h = curved(), 1e-6
    H, d = alone.deformed(), alone.rng.normal(size=(alone.count, 6))
    ahead, behind = (alone.forces(alone.follow(H, s * h * d)) for s in (1.0, -1.0))
    close(alone.matrix(H) @ d.ravel(), ((ahead - behind) / (2 * h)).ravel(), 1e-7)


def test_rigid_motions_change_nothing():
    """Amplitudes are not moved, and energy and forces along nodal axes stay."""
    alone = curved()
    H, motion = alone.deformed(), lie.se3_exp(np.array([1.0, 2, 3, 0.5, -1, 0.7]))
    moved = H.copy()
    frames = alone.kinds == int(fl.extend.NodeType.FRAME)
    moved[frames] = lie.se3_compose(motion, H[frames])
    assert alone.term.energy(moved) == pytest.approx(alone.term.energy(H), rel=1e-13)
    close(alone.forces(moved), alone.forces(H), 1e-12)
    rigid = node_types.rigid_motions(alone.kinds, H, np.zeros(3))
    work = np.einsum("ni,nij->j", alone.forces(H), rigid)
    assert np.abs(work).max() < 1e-11 * np.abs(alone.forces(H)).max()


# --- sections -------------------------------------------------------------------------------------


def test_ovalisation_of_a_tube_decays_as_by_the_theory_of_shells():
    """``B = 9π D/R³`` and ``C = π E t R³/16`` for ``u_r = cos 2θ`` without extension around."""
    R, t = 1.0, 0.02
    found = section("tube").decay_lengths
    closed = sqrt(2.0) * ((1 - NU**2) * R**6 / (12 * t**2)) ** 0.25
    np.testing.assert_allclose(found, closed, rtol=2e-3)
    ring = 9 * STEEL.E * t**2 / (12 * (1 - NU**2) * STEEL.density * R**4) / (1 + 0.25)
    np.testing.assert_allclose(section("tube").frequencies, sqrt(ring) / (2 * pi), rtol=2e-3)


@pytest.mark.parametrize("name", ["tube", "box", "channel", "square"])
def test_free_amplitudes_leave_the_stiffness_of_a_beam(name):
    """All but shear, which is that by energy instead of Cowper's."""
    shapes = {
        "tube": SHAPES.tube(0.99, 1.01),
        "box": SHAPES.box(0.4, 0.3, 0.01),
        "channel": SHAPES.channel(0.1, 0.2, 0.006, 0.006),
        "square": SHAPES.rectangle(0.1, 0.1),
    }
    own, other = (
        given.stiffness[np.ix_([0, 3, 4, 5], [0, 3, 4, 5])]
        for given in (section(name).section, shapes[name].section(STEEL))
    )
    if name == "channel":  # bending and torsion about the centroid include shear
        own, other = own[np.ix_([0, 2, 3], [0, 2, 3])], other[np.ix_([0, 2, 3], [0, 2, 3])]
    scale = np.sqrt(np.outer(np.diag(other), np.diag(other)))
    np.testing.assert_allclose(own / scale, other / scale, atol=1e-3)
    assert np.linalg.eigvalsh(section(name).stiffness)[0] > 0.0


def test_nothing_extends_far_in_a_solid_section():
    assert section("square").decay_lengths[0] < 0.1
    assert section("box").decay_lengths[0] > 0.8


def test_units_do_not_matter():
    """In millimetres and tonnes the same amplitudes, lengths and frequencies."""
    scaled = fl.sections.Distortion(
        SHAPES.box(400.0, 300.0, 10.0).mesh, fl.Material(2.1e5, NU, 7.8e-9), modes=1
    )
    metric = section("box")
    np.testing.assert_allclose(scaled.decay_lengths, 1e3 * metric.decay_lengths, rtol=1e-6)
    np.testing.assert_allclose(scaled.frequencies, metric.frequencies, rtol=1e-6)
    n = scaled.count
    per_unit = np.concatenate([np.ones(3), np.full(3, 1e-3), np.ones(n), np.full(n, 1e3)])
    found = scaled.stiffness.diagonal() * per_unit**2
    np.testing.assert_allclose(found, metric.stiffness.diagonal(), rtol=1e-5)


# --- statics --------------------------------------------------------------------------------------


def test_uniform_strain_is_that_of_the_plain_beam():
    """Torque and bending moments between diaphragms: amplitudes are constant."""
    found = []
    for kind in ("distorting", "plain"):
        scene = fl.Scene()
        if kind == "plain":
            element = fl.elements.DirectorBeam()
            beam = fl.Beam.straight(
                (0, 0, 0), (2, 0, 0), section("box").section, cells=4, up=UP, formulation=element
            )
        else:
            beam = straight("box", 2.0, 4)
            beam.hold_shape(beam.point("start"), beam.point("end"))
        scene.add(beam)
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), moment=(1e3, 2e3, 3e3)))
        found.append(fl.statics(scene).frames[-1, beam.point("end").node])
    moved = np.abs(found[1] - beam.frames[beam.point("end").node]).max()
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-4 * moved)


def test_a_distortional_load_acts_as_on_a_beam_on_an_elastic_foundation():
    """``P/(2 B ℓ)`` under the load, for the stiffness B in the plane and the decay length ℓ."""
    box, length, y, z = section("box"), 10.0, 0.195, 0.145
    scene, work = fl.Scene(), 0.0
    beam = scene.add(straight("box", length, 80))
    scene.add(fl.Clamp(beam.point("start")))
    for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        # without a torque
        force = np.array([0.0, b * y, a * z])
        scene.add(fl.PointLoad(beam.section_point(40, a * y, b * z), force=force))
        work += force @ box.displacement(a * y, b * z)[0]
    moved = beam.amplitudes(fl.statics(scene).frames[-1])[:, 0] * np.sign(work)
    B, length_of_decay = box.stiffness[6 + box.count, 6 + box.count], box.decay_lengths[0]
    assert moved[40] == pytest.approx(abs(work) / (2 * B * length_of_decay), rel=0.05)
    # it changes its sign at 3/4 π ℓ
    away = np.abs(np.arange(81) - 40) * length / 80 / length_of_decay
    assert (moved[away < 2.2] > 0).all()
    assert (moved[(away > 2.6) & (away < 4.0)] < 0).all()


def bent_tube(part):
    """Tube under a part of Brazier's moment ``(2√2/9) π E R t²/√(1 − ν²)``, R = 1, t = 0.02."""
    limit = 2 * sqrt(2) / 9 * pi * STEEL.E * 0.02**2 / sqrt(1 - NU**2)
    scene = fl.Scene()
    beam = scene.add(straight("tube", 20.0, 8))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, part * limit, 0)))
    return scene, beam


def test_a_bent_tube_collapses_at_the_moment_of_brazier():
    """Where the moment has its maximum, the flattening begins to localise, too (Brazier 1927)."""
    path = fl.follow_path(bent_tube(1.0)[0], fl.stability.PathEnds(critical_points=1))
    assert path.critical[0].factor == pytest.approx(1.0, rel=2e-3)


def test_a_bent_tube_flattens():
    """With the flattening ζ over R, ``M² ∝ ζ (1 − 3/2 ζ)²``, with its maximum at ζ = 2/9."""
    scene, beam = bent_tube(0.9)
    amplitudes = beam.amplitudes(fl.statics(scene).frames[-1])
    ζ = abs(amplitudes[4] @ section("tube").displacement(0, 1.0)[:, 2])
    moment = sqrt(ζ) * (1 - 1.5 * ζ) / (sqrt(2 / 9) * (2 / 3))
    assert moment == pytest.approx(0.9, rel=2e-3)


# --- motion ---------------------------------------------------------------------------------------


def test_frequencies_of_a_lipped_channel_are_those_of_shells():
    """``RUN -m studies.distorting_sections``; a plain beam has 63 Hz for the first."""
    shells = [363.1, 412.4, 753.2, 793.8, 1059.1, 1247.6]
    scene, _ = cantilever("lipped channel", 1.0, 24)
    np.testing.assert_allclose(fl.vibrations(scene, 6).frequencies, shells, rtol=0.012)


@pytest.mark.parametrize(
    ("scheme", "step"), [(fl.schemes.Variational(), 2e-5), (fl.Explicit(), 1e-6)], ids=str
)
def test_momenta_are_conserved(scheme, step):
    """Amplitudes have none; a beam that tumbles and vibrates in its sections."""
    scene = fl.Scene()
    beam = scene.add(straight("box", 2.0, 4))
    beam.add_velocity((1, 0.5, 0.2), omega=(3, -4, 5), about=(0.3, 0, 0))
    beam.velocities[5:, 0] = 0.3
    result = scheme.run(scene, duration=20 * step, step=step, progress=False)
    for momenta in (result.momentum, result.angular_momentum):
        assert np.abs(momenta - momenta[0]).max() < 1e-12 * np.abs(momenta).max()
    assert np.abs(result.total_energy / result.total_energy[0] - 1).max() < 1e-5


# --- points and supports --------------------------------------------------------------------------


def test_points_of_the_section_move_with_its_distortion():
    beam = straight("box", 2.0, 4)
    point = beam.section_point("end", 0.2, 0.15)
    np.testing.assert_allclose(point.position, [2.0, 0.2, 0.15], atol=1e-14)
    H = beam.frames.copy()
    modal = 5 + 4
    H[modal, 1] = 1e-3, 2e-3, 3e-3
    expected = [2.0, 0.2, 0.15] + np.array([1e-3, 2e-3, 3e-3]) @ section("box").displacement(
        0.2, 0.15
    )
    np.testing.assert_allclose(point.attachment.frame(H)[0], expected, atol=1e-14)


def test_supports_hold_the_shape_and_the_warping():
    scene, beam = cantilever("box", 1.0, 8)
    beam.hold_shape(beam.point("end"))
    scene.add(fl.PointLoad(beam.section_point(4, 0.195, 0.145), force=(0, 0, 1e3)))
    amplitudes = beam.amplitudes(fl.statics(scene).frames[-1])
    np.testing.assert_array_equal(amplitudes[0], 0.0)
    assert amplitudes[8, 0] == 0.0
    assert np.abs(amplitudes[8, 1:]).min() > 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda beam: beam.section_point("end", 0.0, 0.0), "is not in the section"),
        (lambda beam: beam.hold_shape(straight("box", 1.0, 2).point("end")), "not a node of it"),
        (lambda beam: beam.point(7), "has points 0 … 2"),
        (lambda beam: fl.sections.Distortion(SHAPES.circle(1.0).mesh, STEEL, 0), "at least 1"),
    ],
)
def test_what_is_not_possible_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(straight("box", 1.0, 2))


def test_conserving_schemes_refuse_it_by_name():
    scene, _ = cantilever("box", 1.0, 2)
    with pytest.raises(ValueError, match="does not support beams with sections that distort"):
        fl.EnergyMomentum().run(scene, duration=1e-3, step=1e-3, progress=False)


def test_strain_loads_refuse_it_by_name():
    _, beam = cantilever("box", 1.0, 2)
    with pytest.raises(TypeError, match="must be a Beam, a Shell or a Solid, got the Distorting"):
        fl.loads.Temperature(beam, expansion=1e-5, rise=10.0)


def test_the_picture_of_the_fields_is_written(tmp_path):
    section("box").picture(tmp_path / "box.png")
    assert (tmp_path / "box.png").stat().st_size > 1000
