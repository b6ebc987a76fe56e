"""Cables along cubic splines: the shapes they are laid in, and what stays when knots are added."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

import fem_lie as fl
from tests.drawn import empty_model

SECTION = fl.Section.from_stiffness([1e4, 1e4, 1e4, 2.0, 2.0, 2.0], mass=0.5)
KNOTS = np.array([0, 0, 0, 0, 1, 1, 3, 3, 4, 4, 4, 4.0])
CONTROL = np.array(
    [(0, 0, 0), (1, 0, 0.2), (2, 1, 0), (3, 2, 0), (4, 2.5, 1), (5, 1, 0), (5.5, 0, 0), (6, 0, 1.0)]
)
SPLINE = BSpline(KNOTS, CONTROL, 3)


def cubic(cable: fl.SplineCable, cell: int, ξ: float) -> np.ndarray:
    """A position on the curve between two nodes."""
    a, b = cable.frames[cable.model.elements[cell]]
    h = cable.model.lengths[cell]
    return (
        (1 - ξ) ** 2 * (1 + 2 * ξ) * a[0]
        + ξ**2 * (3 - 2 * ξ) * b[0]
        + h * ξ * (1 - ξ) ** 2 * a[1]
        + h * ξ**2 * (ξ - 1) * b[1]
    )


def energy(cable: fl.SplineCable) -> float:
    """As it is laid."""
    assembly = cable.model.assemble([cable.model])
    H = np.empty_like(cable.frames)
    H[assembly.order] = cable.frames
    return float(assembly.energy(H))


@pytest.mark.parametrize("cells", [1, 2, 5])
def test_more_knots_leave_the_curve_as_it_is(cells):
    """And so its length, without stretch, however fast the parameter runs."""
    cable = fl.SplineCable.of(SPLINE, SECTION, cells=cells)
    ends = np.repeat([0.0, 1.0, 3.0], cells) + np.tile(np.arange(cells) / cells, 3) * np.repeat(
        [1.0, 2.0, 1.0], cells
    )
    spans = np.repeat([1.0, 2.0, 1.0], cells) / cells
    for cell, (begin, span) in enumerate(zip(ends, spans, strict=True)):
        for ξ in (0.0, 0.3, 0.8, 1.0):
            np.testing.assert_allclose(cubic(cable, cell, ξ), SPLINE(begin + ξ * span), atol=1e-13)
    stretch = fl.Section.from_stiffness([1e4, 1, 1, 1e-12, 1e-12, 1e-12])
    assert energy(fl.SplineCable.of(SPLINE, stretch, cells=cells)) < 1e-10
    u = np.linspace(0, 4, 200001)
    arc = np.linalg.norm(np.diff(SPLINE(u), axis=0), axis=1).sum()
    assert cable.model.line_quadrature().lengths.sum() == pytest.approx(arc, rel=1e-3)


def test_doubled_knots_by_scipy_are_the_same_cable():
    finer = fl.SplineCable.of(SPLINE.insert_knot(2.0, m=2), SECTION)
    assert len(finer.frames) == 5
    np.testing.assert_allclose(finer.frames[2, 0], SPLINE(2.0), atol=1e-13)


def test_circle():
    """Radius of sixth order, and the energy of a straight cable that is bent to it."""
    errors, energies = [], []
    for cells in (4, 8, 16):
        ring = fl.SplineCable.circle((1, 2, 3), 2.0, (0, 1, 1), SECTION, cells=cells)
        assert len(ring.frames) == cells and len(ring.model.elements) == cells
        positions = [cubic(ring, k, 0.3) - (1, 2, 3) for k in range(cells)]
        errors.append(np.abs(np.linalg.norm(positions, axis=1) / 2.0 - 1).max())
        energies.append(energy(ring) / (np.pi * 2.0 / 2.0) - 1)
    assert errors[0] / errors[1] > 55 and errors[1] / errors[2] > 60 and errors[2] < 1e-7
    assert abs(energies[2]) < 1e-4 < abs(energies[0])


def test_interpolated_points_are_passed_and_closed():
    angle = 2 * np.pi * np.arange(13) / 12
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * np.sin(2 * angle)])
    points[-1] = points[0]
    ring = fl.SplineCable.through(points, SECTION, cells=2)
    assert len(ring.frames) == 24
    np.testing.assert_array_equal(ring.frames[::2, 0], points[:-1])
    line = fl.SplineCable.through(points[:5], SECTION)
    assert len(line.frames) == 5 and "end" in line.model.point_names


def test_weight_is_that_of_the_curve():
    """Line loads and gravity alike, on knots that are far from even."""
    scenes = []
    for load in (True, False):
        gentle = BSpline(KNOTS, CONTROL * (1, 0.02, 0.02), 3)
        stiff = fl.Section.from_stiffness([1e4, 1e4, 1e4, 200.0, 200.0, 200.0], mass=0.5)
        cable = fl.SplineCable.of(gentle, stiff, cells=4)
        scene = fl.Scene(gravity=(0, 0, 0) if load else (0, 0, -2.0))
        scene.add(cable)
        scene.add(fl.Clamp(cable.point("start")))
        cable.pin(cable.point("end"))
        if load:
            scene.add(fl.LineLoad(cable, (0, 0, -1.0)))
        scenes.append(fl.statics(scene).frames[-1])
    np.testing.assert_allclose(*scenes, atol=1e-8)


def test_straight_cable_of_uneven_speed_sags_as_an_even_one():
    """Reactions do not depend on the parameter, whose nodes are elsewhere on the cable."""
    found = []
    for power in (1.0, 1.3):
        u = np.linspace(1.0, 2.0, 17)
        x = (u**power - 1) / (2**power - 1)
        positions = np.outer(10 * x, (1, 0, 0))
        rates = np.outer(10 * power * u ** (power - 1) / (2**power - 1), (1, 0, 0))
        stiff = fl.Section.from_stiffness([1e4, 1e4, 1e4, 200.0, 200.0, 200.0], mass=0.5)
        cable = fl.SplineCable(u, positions, rates, stiff)
        scene = fl.Scene(gravity=(0, 0, -9.81))
        scene.add(cable)
        scene.add(fl.Clamp(cable.point("start")))
        cable.pin(cable.point("end"))
        found.append(fl.statics(scene).reactions[-1])
    np.testing.assert_allclose(*found, rtol=1e-3, atol=1e-3)


SIMPLE = BSpline(np.array([0, 0, 0, 0, 1, 2, 2, 2, 2.0]), CONTROL[:5], 3)
REFUSED = {
    "simple knot": (lambda: fl.SplineCable.of(SIMPLE, SECTION), "1 is there 1 times"),
    "degree": (lambda: fl.SplineCable.of(BSpline(KNOTS[1:-1], CONTROL, 1), SECTION), "degree 1"),
    "plane": (lambda: fl.SplineCable.of(BSpline(KNOTS, CONTROL[:, :2], 3), SECTION), "shape"),
    "no spline": (lambda: fl.SplineCable.of(CONTROL, SECTION), "BSpline"),
    "slope of zero length": (
        lambda: fl.SplineCable([0, 1], [(0, 0, 0), (1, 0, 0)], [(1, 0, 0), (0, 0, 0)], SECTION),
        "not zero",
    ),
    "knots": (
        lambda: fl.SplineCable([1, 0], [(0, 0, 0), (1, 0, 0)], [(1, 0, 0), (1, 0, 0)], SECTION),
        "increase",
    ),
    "shapes": (lambda: fl.SplineCable([0, 1, 2], CONTROL[:2], CONTROL[:2], SECTION), "shapes"),
    "points": (lambda: fl.SplineCable.through([(0, 0, 0), (0, 0, 0)], SECTION), "distinct"),
    "circle": (
        lambda: fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), SECTION, cells=2),
        "3 cells",
    ),
    "element": (
        lambda: fl.SplineCable.through(CONTROL, SECTION, formulation=fl.elements.HermiteCable()),
        "IsogeometricCable",
    ),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_refused(case):
    call, words = case
    with pytest.raises((ValueError, TypeError), match=words):
        call()


# --- from CAD files -------------------------------------------------------------------------------


def half_circles(folder, ending, count=1):
    """Rational cubics in a file: exact half circles about the z axis."""
    file = folder / f"half.{ending}"
    with empty_model() as gmsh:
        for height in range(count):
            corners = [(1, 0), (1, 2), (-1, 2), (-1, 0)]
            tags = [gmsh.model.occ.addPoint(x, y, height) for x, y in corners]
            gmsh.model.occ.addBSpline(
                tags, degree=3, weights=[1, 1 / 3, 1 / 3, 1], knots=[0, 1], multiplicities=[4, 4]
            )
        gmsh.model.occ.synchronize()
        gmsh.write(str(file))
    return file


@pytest.mark.parametrize(("ending", "digits"), [("brep", 1e-14), ("step", 1e-11)])
def test_a_rational_curve_from_a_file_is_followed_to_fourth_order(tmp_path, ending, digits):
    file, gaps, lengths = half_circles(tmp_path, ending), [], []
    for cells in (8, 16, 32):
        u, positions, slopes = fl.mesh.read_curve(file, cells)
        np.testing.assert_allclose(np.linalg.norm(positions, axis=1), 1.0, atol=digits)
        np.testing.assert_allclose(np.einsum("ij,ij->i", positions, slopes), 0.0, atol=10 * digits)
        h = np.diff(u)[:, np.newaxis]
        middle = 0.5 * (positions[:-1] + positions[1:]) + h * (slopes[:-1] - slopes[1:]) / 8
        gaps.append(np.abs(np.linalg.norm(middle, axis=1) - 1).max())
        cable = fl.SplineCable(u, positions, slopes, SECTION)
        lengths.append(abs(cable.model.line_quadrature().lengths.sum() - np.pi))
    assert (np.log2(np.array(gaps[:-1]) / gaps[1:]) > 3.6).all()
    assert lengths[-1] < 2e-6


def test_which_curve_of_a_file_must_be_said(tmp_path):
    file = half_circles(tmp_path, "brep", 2)
    with pytest.raises(ValueError, match=r"has the curves \[1, 2\], .* got curve = None"):
        fl.mesh.read_curve(file, 4)
    with pytest.raises(ValueError, match=r"got curve = 7"):
        fl.mesh.read_curve(file, 4, curve=7)
    assert fl.mesh.read_curve(file, 4, curve=2).positions[0] == pytest.approx([1, 0, 1])
    with pytest.raises(ValueError, match="at least 1, got 0"):
        fl.mesh.read_curve(file, 0, curve=1)
    with pytest.raises(FileNotFoundError, match="no mesh file"):
        fl.mesh.read_curve(tmp_path / "none.step", 4)
