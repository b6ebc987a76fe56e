"""Beams whose axial force is large beside the bending stiffness of their elements."""

from __future__ import annotations

from contextlib import nullcontext, suppress

import numpy as np
import pytest
import scipy.optimize

import fem_lie as fl
from benchmarks import coarse_beams
from benchmarks.coarse_beams import line

STEEL = fl.Material(2.1e11, 0.3, 7800.0)
ELEMENTS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
}


@pytest.fixture(params=ELEMENTS.values(), ids=ELEMENTS)
def element(request):
    return request.param


@pytest.mark.parametrize("cells", [16, 32])
def test_tensioned_wire_deflects_and_vibrates_as_its_closed_form(element, cells):
    """The deflection was 54 % too large with 20 elements, unstable, and the frequency 17 % low."""
    deflection, frequency = coarse_beams.wire(cells, element)
    assert abs(deflection) <= 0.025
    assert abs(frequency) <= 0.01


@pytest.mark.parametrize("times", [1.0, 1e2, 1e4])
def test_no_tension_makes_elements_unstable(element, times):
    """They lost their stability at 12 EI/h² and 24 EI/h²."""
    section, cells = fl.Section.circle(0.0005, STEEL), 4
    limit = 12 * section.stiffness[4, 4] * cells**2
    for tension in (0.5 * limit * times, 2.0 * limit * times):
        if tension > 0.02 * section.stiffness[0, 0]:
            continue
        wire, scene = line((0, 0, 0), (1, 0, 0), section, cells, element), fl.Scene()
        scene.add(wire)
        scene.add(fl.Clamp(wire.point("start")))
        scene.add(fl.PointLoad(wire.point("end"), (tension, 0, 0)))
        assert fl.statics(scene).stable[-1]


@pytest.mark.parametrize("cells", [2, 4, 8, 16])
def test_pulled_column_does_not_buckle_by_its_mesh(element, cells):
    """Factors were 417, 1526, 5748, 19 727 times Euler's load; tension beyond the shear stiffness,
    where the sections of any shear beam tip over, is far beyond all linear laws."""
    section = fl.Section.circle(0.01, STEEL)
    column, scene = line((0, 0, 0), (1, 0, 0), section, cells, element), fl.Scene()
    scene.add(column)
    scene.add(fl.Clamp(column.point("start")))
    scene.add(fl.PointLoad(column.point("end"), (section.stiffness[1, 1], 0, 0)))
    with suppress(fl.ConvergenceError, ValueError):  # there is none
        assert fl.buckling(scene, 1).factors[0] >= 0.5


def heavy_bar(cells, element):
    """Position of the tip, and the longest chord over its unloaded length."""
    scene, section = fl.Scene(gravity=(0, 0, -9.81)), fl.Section.rectangle(0.02, 0.02, STEEL)
    bar = scene.add(line((0, 0, 0), (30, 0, 0), section, cells, element))
    scene.add(fl.Clamp(bar.point("start")))
    result = fl.statics(scene)
    x = np.array([result.position(bar.point(k))[-1] for k in range(cells + 1)])
    return x[-1], np.linalg.norm(np.diff(x, axis=0), axis=1).max() / (30 / cells)


@pytest.mark.parametrize("cells", [8, 16])
def test_heavy_bar_keeps_its_length(element, cells):
    """A clamped bar of 30 m hangs down, against 256 rod elements."""
    tip, chord = heavy_bar(cells, element)
    assert chord <= 1.001
    assert np.linalg.norm(tip - (2.61142, 0.0, -28.94141)) <= 0.02 * 30


def test_heavy_bar_of_four_elements_is_named_as_coarse():
    """Its chords were stretched by 42 % without a word."""
    with pytest.warns(fl.schemes.CoarseElementsWarning, match="leans by .* use more elements"):
        tip, chord = heavy_bar(4, fl.elements.GeodesicBeam())
    assert chord <= 1.001
    assert np.linalg.norm(tip - (2.61142, 0.0, -28.94141)) <= 0.01 * 30


def test_spinning_strip_has_the_frequencies_of_a_tensioned_one(element):
    """75.4 instead of 105.2 rad/s with ten elements."""
    found = coarse_beams.spinning(10, element)
    np.testing.assert_allclose(found, (105.193, 258.029), rtol=0.01)


@pytest.mark.parametrize("cells", [8, 16])
def test_guyed_mast_buckles_under_its_load_and_not_by_its_guys(element, cells):
    """Guys in tension buckled at a fifth of the load; 80 elements of degree 2 have 3.185893."""
    assert coarse_beams.guyed(cells, element)[0] == pytest.approx(3.185893, rel=0.02)


def test_mean_shear_that_is_bending_does_not_depend_on_the_axes_of_the_section(element):
    """A strip under tension and a force across, its section turned by 30° in the beam's frame."""
    tips = []
    for angle in (0.0, np.pi / 6):
        up = (0.0, -np.sin(angle), np.cos(angle))
        section = fl.Section.rectangle(0.02, 0.004, STEEL).rotated(-angle)
        strip, scene = line((0, 0, 0), (1, 0, 0), section, 6, element, up=up), fl.Scene()
        scene.add(strip)
        scene.add(fl.Clamp(strip.point("start")))
        scene.add(fl.PointLoad(strip.point("end"), (2e4, 50.0, 30.0)))
        tips.append(fl.statics(scene).position(strip.point("end"))[-1])
    np.testing.assert_allclose(tips[1], tips[0], atol=1e-9)


def test_absurd_strains_are_named():
    """12 orders of magnitude too large a load stretches a bar, which is stable all the same."""
    bar, scene = (
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, STEEL), cells=4),
        fl.Scene(),
    )
    scene.add(bar)
    scene.add(fl.Clamp(bar.point("start")))
    scene.add(fl.PointLoad(bar.point("end"), (1e7, 0, 0)))
    with pytest.warns(fl.schemes.CoarseElementsWarning, match="is stretched by 15%"):
        fl.statics(scene)


def test_axis_that_leans_from_its_element_is_named():
    """A strip of two elements under a force across, a hundred times its stiffness."""
    section = fl.Section.rectangle(0.02, 0.001, STEEL)
    strip, scene = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2), fl.Scene()
    scene.add(strip)
    scene.add(fl.Clamp(strip.point("start")))
    scene.add(fl.PointLoad(strip.point("end"), (0, 0, 100 * section.stiffness[4, 4])))
    with pytest.warns(fl.schemes.CoarseElementsWarning, match="use more elements"):
        fl.statics(scene)


def test_soft_pendulum_of_few_elements_swings_as_a_fine_one():
    """Rubber, 1.2 m: beyond a lean of 0.7 rad elements gained length, and the tip was 1 m off."""
    scene, section = fl.Scene(gravity=(0, 0, -9.81)), coarse_beams.rubber()
    beam = scene.add(
        line((0, 0, 0), (1.2, 0, 0), section, 8, fl.elements.GeodesicBeam(), up=(0, 0, 1))
    )
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    with pytest.warns(fl.schemes.CoarseElementsWarning):
        motion = fl.GeneralisedAlpha(radius=0.6).run(scene, duration=0.8, step=2e-3)
    tips = motion.position(beam.point("end"))[[200, 250, 300, 350, 400]]
    cable = [  # of 128 cable elements
        (0.85287, 0, -0.78458),
        (0.39504, 0, -1.21527),
        (-0.33485, 0, -1.25101),
        (-0.68729, 0, -1.09466),
        (-0.88181, 0, -0.82106),
    ]
    assert np.linalg.norm(tips - cable, axis=1).max() <= 0.06 * 1.2


def test_rigid_motion_and_pure_bending_are_not_coarse():
    """No warning, which tests make an error: two elements that bend by 1.2 rad each, anywhere."""
    section = fl.Section.circle(0.01, STEEL)
    bar, scene = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2), fl.Scene()
    scene.add(bar)
    scene.add(fl.Clamp(bar.point("start")))
    bar.add_velocity(omega=(0.3, 0.2, -2.0), about=(0, 0, 0))
    moment = bar.frames[0][1:].T @ (0, 0, 2.4 * section.stiffness[5, 5])
    scene.add(fl.PointLoad(bar.point("end"), moment=moment))
    fl.statics(scene, load_steps=4)


_SPAN, _DIP, _AXIAL, _WEIGHT = 100.0, 2.0, 5e6, 7.8 * 9.81


def elastic_catenary(length: float) -> float:
    """Sag of an elastic cable of unstretched ``length`` between supports of equal height."""

    def half_span(force: float) -> float:
        slope = _WEIGHT * length / 2 / force
        return force / _WEIGHT * np.arcsinh(slope) + force * length / 2 / _AXIAL

    force = scipy.optimize.brentq(lambda F: half_span(F) - _SPAN / 2, 1e3, 1e6)
    rise = np.sqrt(1 + (_WEIGHT * length / 2 / force) ** 2) - 1
    return float(force / _WEIGHT * rise + _WEIGHT * (length / 2) ** 2 / 2 / _AXIAL)


@pytest.mark.parametrize("kind", ["soft", "without flexibility", "stiffer", "rod"])
def test_cable_of_curved_beams_sags_as_a_catenary_or_warns(kind):
    """Beams of 1.6 m that bend by their own curvature sagged by 5.56 m instead of 4.49 m."""
    bending = 400.0 if kind == "stiffer" else 0.1
    section = fl.Section.from_stiffness([_AXIAL] * 3 + [bending] * 3, mass=7.8)
    options = (
        {"formulation": fl.elements.GeodesicBeam(bending_flexibility=False)}
        if kind == "without flexibility"
        else {}
    )
    cable = (fl.Rod if kind == "rod" else fl.Beam).curve(
        lambda s: (_SPAN * s, 0, -4 * _DIP * s * (1 - s)), section, cells=64, **options
    )
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(cable)
    for end in ("start", "end"):
        scene.add(fl.joints.Spherical(fl.ground(), cable.point(end)))
    warned = pytest.warns(fl.schemes.CoarseElementsWarning, match="it is too soft")
    with warned if kind == "soft" else nullcontext():
        sag = -fl.statics(scene, load_steps=10).position(cable.point(32))[-1, 2]
    exact = elastic_catenary(cable.model.lengths.sum())
    assert kind == "soft" or sag == pytest.approx(exact, rel=1e-3)
