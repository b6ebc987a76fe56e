"""Sections of any shape: closed forms with the mesh that the helper picks, and laws."""

from itertools import pairwise
from math import pi, sqrt

from mpi4py import MPI

import dolfinx
import numpy as np
import pytest
from scipy.integrate import quad

import fem_lie as fl

NU = 0.3
STEEL = fl.Material(E=210e9, nu=NU, density=7850.0)
RUBBERY = fl.Material(E=21e9, nu=NU, density=1200.0)
SHAPES = {
    "i": fl.sections.SectionShape.i_section(0.1, 0.2, 0.0056, 0.0085),
    "rolled i": fl.sections.SectionShape.i_section(0.1, 0.2, 0.0056, 0.0085, 0.012),
    "channel": fl.sections.SectionShape.channel(0.08, 0.2, 0.0085, 0.011),
    "angle": fl.sections.SectionShape.l_section(0.1, 0.15, 0.012),
    "box": fl.sections.SectionShape.box(0.1, 0.2, 0.006),
}


def properties(shape, material=STEEL):
    return shape.warping(material).properties


@pytest.fixture(scope="module")
def solved():
    return {name: shape.warping(STEEL) for name, shape in SHAPES.items()}


def like(actual, wanted, rtol=1e-3):
    """Entries of a matrix, off its diagonal in proportion to those on it."""
    scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    np.testing.assert_allclose(actual / scale, wanted / scale, rtol=0, atol=rtol)


# --- closed forms


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        (fl.sections.SectionShape.rectangle(1.0, 1.0), fl.Section.rectangle(1.0, 1.0, STEEL)),
        (fl.sections.SectionShape.rectangle(1.0, 4.0), fl.Section.rectangle(1.0, 4.0, STEEL)),
        (fl.sections.SectionShape.rectangle(60.0, 1.0), fl.Section.rectangle(60.0, 1.0, STEEL)),
        (fl.sections.SectionShape.circle(0.3), fl.Section.circle(0.3, STEEL)),
        (fl.sections.SectionShape.tube(0.6, 1.0), fl.Section.tube(0.6, 1.0, STEEL)),
        (fl.sections.SectionShape.tube(0.97, 1.0), fl.Section.tube(0.97, 1.0, STEEL)),
    ],
    ids=["square", "1:4", "60:1", "circle", "thick tube", "thin tube"],
)
def test_shapes_with_closed_forms(shape, exact):
    """All of stiffness, with Cowper's shear factors, and inertia; ten times better than claimed."""
    section = shape.section(STEEL)
    like(section.stiffness, exact.stiffness, 1e-4)
    plus = np.diag([0.0, 1.0, 0.0, 0.0])  # nothing moves along e₁
    like(section.inertia + plus, exact.inertia + plus, 1e-4)
    assert section.properties.area == pytest.approx(exact.properties.area, rel=1e-4)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.5])
def test_shear_factor_of_the_rectangle_for_other_materials(nu):
    """In Cowper's formula the ratio of the sides does not matter."""
    material = fl.Material(1.0, nu, 1.0)
    factors = properties(fl.sections.SectionShape.rectangle(1.0, 2.0), material).shear_factors
    like(factors, 10 * (1 + nu) / (12 + 11 * nu) * np.eye(2), 1e-6)


def test_equilateral_triangle():
    p = properties(fl.sections.SectionShape.polygon([(0, 0), (1, 0), (0.5, 0.5 * sqrt(3))]))
    assert p.area == pytest.approx(sqrt(3) / 4, rel=1e-12)
    # the warping function is a cubic, as the elements are
    assert p.torsion_constant == pytest.approx(sqrt(3) / 80, rel=1e-9)
    like(p.second_moments, sqrt(3) / 96 * np.eye(2), 1e-12)
    np.testing.assert_allclose(p.shear_centre, p.centroid, atol=1e-9)
    # three axes of symmetry: no direction is distinguished
    like(p.shear_factors, p.shear_factors[0, 0] * np.eye(2), 1e-9)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_semicircle(nu):
    """Cowper's (1 + ν)/(1.305 + 1.273 ν) for a force along the axis of symmetry."""
    angle = np.linspace(0.0, pi, 65)
    shape = fl.sections.SectionShape.polygon(np.column_stack([np.cos(angle), np.sin(angle)]))
    factors = properties(shape, fl.Material(1.0, nu, 1.0)).shear_factors
    # his constants have four digits
    assert factors[1, 1] == pytest.approx((1 + nu) / (1.305 + 1.273 * nu), rel=5e-4)
    assert abs(factors[0, 1]) < 1e-6


def test_ellipse():
    """Cowper's formula for the ellipse, too: n = a/b, with a along the force."""
    a, b, count = 2.0, 1.0, 128
    turn = 2 * pi / count
    angle, scale = turn * np.arange(count), sqrt(turn / np.sin(turn))  # area of the ellipse
    p = properties(
        fl.sections.SectionShape.polygon(
            scale * np.column_stack([a * np.cos(angle), b * np.sin(angle)])
        )
    )
    assert p.area == pytest.approx(pi * a * b, rel=1e-12)
    assert p.torsion_constant == pytest.approx(pi * a**3 * b**3 / (a**2 + b**2), rel=1e-3)
    for factor, n in zip(np.diag(p.shear_factors), (a / b, b / a), strict=True):
        cowper = (12 * (1 + NU) * n**2 * (3 * n**2 + 1)) / (
            (40 + 37 * NU) * n**4 + (16 + 10 * NU) * n**2 + NU
        )
        assert factor == pytest.approx(cowper, rel=1e-3)


def test_i_section(solved):
    p = solved["i"].properties
    outer, inner = (0.1, 0.2), (0.1 - 0.0056, 0.2 - 2 * 0.0085)
    zz = (outer[0] * outer[1] ** 3 - inner[0] * inner[1] ** 3) / 12
    yy = (2 * 0.0085 * 0.1**3 + inner[1] * 0.0056**3) / 12
    like(p.second_moments, np.diag([yy, zz]), 1e-12)
    assert p.area == pytest.approx(outer[0] * outer[1] - inner[0] * inner[1], rel=1e-12)
    np.testing.assert_allclose(p.shear_centre, 0, atol=1e-9)
    np.testing.assert_allclose(p.centroid, 0, atol=1e-12)
    assert p.principal_angle == pytest.approx(pi / 2)


def test_table_values_of_ipe_200(solved):
    """EN 10365: A = 28.48 cm², I_y = 1943 cm⁴, I_z = 142.4 cm⁴; tables round to four digits."""
    p = solved["rolled i"].properties
    assert p.area == pytest.approx(28.48e-4, rel=3e-4)
    np.testing.assert_allclose(np.diag(p.second_moments), [142.4e-8, 1943e-8], rtol=3e-4)
    # 6.98 cm⁴ in tables is an approximation for the fillets, 2 % off
    assert p.torsion_constant == pytest.approx(6.98e-8, rel=0.03)


def test_warping_constants_of_thin_walls():
    """Vlasov's of an I and of a channel, by middle lines."""
    b, h, t = 0.1, 0.2, 1e-3
    found = fl.sections.SectionShape.i_section(b, h + t, t, t).warping(STEEL).properties
    assert found.warping_constant == pytest.approx(t * b**3 * h**2 / 24, rel=0.01)
    found = fl.sections.SectionShape.channel(b + t / 2, h + t, t, t).warping(STEEL).properties
    of_channel = t * b**3 * h**2 / 12 * (3 * b + 2 * h) / (6 * b + h)
    assert found.warping_constant == pytest.approx(of_channel, rel=0.01)
    # the length over which held warping is felt
    torsion = STEEL.G * found.torsion_constant
    assert found.warping_length == pytest.approx(np.sqrt(STEEL.E * of_channel / torsion), rel=0.01)
    assert found.offset(1.0, 2.0).rotated(0.3).warping_constant == found.warping_constant


OPEN = {
    "I": fl.sections.SectionShape.i_section(0.1, 0.2, 0.0056, 0.0085, 0.012),
    "channel": fl.sections.SectionShape.channel(0.1, 0.2, 0.006, 0.009),
}
OTHERS = {
    "box": fl.sections.SectionShape.box(0.1, 0.2, 0.005),
    "rectangle": fl.sections.SectionShape.rectangle(0.1, 0.2),
    "strip": fl.sections.SectionShape.rectangle(0.1, 0.005),
    "angle": fl.sections.SectionShape.l_section(0.1, 0.1, 0.01),
}


@pytest.mark.parametrize("name", [*OPEN, *OTHERS])
def test_open_profiles_in_beams_that_let_them_warp_are_named_in_the_log(name, caplog):
    section = {**OPEN, **OTHERS}[name].section(STEEL)
    fl.Beam.straight((0, 0, 0), (3, 0, 0), section, cells=4, name="girder")
    said = [record.getMessage() for record in caplog.records if "warping" in record.getMessage()]
    assert len(said) == (name in OPEN)
    if said:
        constant = section.properties.E * section.properties.warping_constant
        assert said[0].startswith("girder has an open thin-walled section")
        assert f"AncfBeam(warping={constant:.4g})" in said[0]
    caplog.clear()
    warping = None if name in OTHERS else 1.0
    fl.AncfBeam.straight((0, 0, 0), (3, 0, 0), section, cells=4, up=(0, 0, 1), warping=warping)
    fl.Beam.straight((0, 0, 0), (300, 0, 0), section, cells=4)  # nobody feels it there
    assert not caplog.records


def test_shear_centre_of_channels_tends_to_that_of_thin_walls():
    """e = 3 b² t / (h t + 6 b t) from the web's middle; what is left falls with the thickness."""
    errors = []
    for t in (0.08, 0.04, 0.02):
        p = properties(fl.sections.SectionShape.channel(1.0, 2.0, t, t))
        b, h = 1.0 - t / 2, 2.0 - t
        e = 3 * b**2 / (h + 6 * b)
        errors.append(abs(p.shear_centre[0] - (t / 2 - e)) / e)
        assert p.shear_centre[1] == pytest.approx(0.0, abs=1e-9)
    assert errors[-1] < 1e-3
    for coarse, fine in pairwise(errors):
        assert fine < 0.6 * coarse


def test_shear_centre_of_a_thin_angle_is_at_its_corner():
    """Shear flows of both flanges pass through the point where their middle lines meet."""
    p = properties(fl.sections.SectionShape.l_section(1.0, 1.5, 0.03))
    np.testing.assert_allclose(p.shear_centre, [0.015, 0.015], atol=0.1 * 0.03)


def test_principal_axes_of_angles():
    """Equal flanges: the axis of symmetry; unequal ones: Mohr's circle of two rectangles."""
    equal = properties(fl.sections.SectionShape.l_section(0.1, 0.1, 0.01))
    assert equal.principal_angle == pytest.approx(-pi / 4, abs=1e-9)
    a, b, t = 0.1, 0.15, 0.012
    p = properties(SHAPES["angle"])
    # flange along y, and the rest of the flange along z
    A = np.array([a * t, (b - t) * t])
    c = np.array([(a / 2, t / 2), (t / 2, t + (b - t) / 2)])
    centre = A @ c / A.sum()
    own = np.diag([a**3 * t + t**3 * (b - t), a * t**3 + t * (b - t) ** 3]) / 12
    moments = own + np.einsum("i,ij,ik->jk", A, c - centre, c - centre)
    np.testing.assert_allclose(p.centroid, centre, rtol=1e-12)
    like(p.second_moments, moments, 1e-12)
    yy, yz, zz = moments[0, 0], moments[0, 1], moments[1, 1]
    assert np.tan(2 * p.principal_angle) == pytest.approx(2 * yz / (yy - zz), rel=1e-9)
    radius = np.hypot((yy - zz) / 2, yz)
    np.testing.assert_allclose(
        p.principal_moments, (yy + zz) / 2 + radius * np.array([1, -1]), rtol=1e-12
    )
    turned = SHAPES["angle"].section(STEEL, angle=p.principal_angle)
    assert abs(turned.stiffness[4, 5]) < 1e-12 * turned.stiffness[4, 4]
    assert turned.stiffness[5, 5] > turned.stiffness[4, 4]


@pytest.mark.parametrize("name", SHAPES)
def test_the_mesh_does_not_matter(name, solved):
    """Claimed is 1e-3; a mesh two times finer is the reference."""
    p, fine = solved[name].properties, properties(SHAPES[name].refined(2.0))
    assert p.torsion_constant == pytest.approx(fine.torsion_constant, rel=3e-4)
    like(p.shear_factors, fine.shear_factors, 3e-4)
    size = sqrt(np.trace(fine.second_moments) / fine.area)
    np.testing.assert_allclose(p.shear_centre, fine.shear_centre, atol=1e-4 * size)


# --- composites

LOWER, UPPER = (
    fl.sections.SectionShape.rectangle(1.0, 0.4),
    fl.sections.SectionShape.rectangle(1.0, 0.6),
)
LAYERS = fl.sections.SectionShape.joined(
    {"lower": LOWER.moved(0, 0.2), "upper": UPPER.moved(0, 0.7)}
)


def test_two_layers_as_a_transformed_section():
    p = LAYERS.warping({"lower": STEEL, "upper": RUBBERY}).properties
    n = RUBBERY.E / STEEL.E
    width, height, middle = np.array([1.0, n]), np.array([0.4, 0.6]), np.array([0.2, 0.7])
    A = width * height
    centre = A @ middle / A.sum()
    zz = (width * height**3 / 12 + A * (middle - centre) ** 2).sum()
    np.testing.assert_allclose(p.centroid, [0.0, centre], atol=1e-9)
    assert p.E * p.area == pytest.approx(STEEL.E * A.sum(), rel=1e-9)
    like(p.E * p.second_moments, STEEL.E * np.diag([A.sum() / 12, zz]), 1e-9)


def test_shear_flexibility_of_layers_is_that_of_the_shear_flow():
    """ν = 0 and a force across the layers: stress does not vary along them, ∫(Q S/EI)²/(G b) dz."""
    bottom, top = fl.Material(100.0, 0.0, 1.0), fl.Material(5.0, 0.0, 1.0)
    p = LAYERS.warping({"lower": bottom, "upper": top}).properties
    EI, c = p.E * p.second_moments[1, 1], p.centroid[1]

    def statical(z):
        from_above = top.E * ((1.0 - c) ** 2 - (max(z, 0.4) - c) ** 2) / 2
        return from_above + (bottom.E * ((0.4 - c) ** 2 - (z - c) ** 2) / 2 if z < 0.4 else 0.0)

    F = quad(lambda z: (statical(z) / EI) ** 2 / (50.0 if z < 0.4 else 2.5), 0, 1, points=[0.4])[0]
    assert 1 / (p.shear_factors[1, 1] * p.G * p.area) == pytest.approx(F, rel=1e-4)


def test_the_mesh_does_not_matter_where_a_region_ends_on_another():
    """The corners of the small square peak with a ratio of 1000 of the stiffnesses."""
    small, large = (
        fl.sections.SectionShape.rectangle(0.5, 0.5),
        fl.sections.SectionShape.rectangle(1.0, 1.0),
    )
    shape = fl.sections.SectionShape.joined({"soft": large.moved(0.75, 0.25), "hard": small})
    materials = {"hard": fl.Material(1e3, NU, 1.0), "soft": fl.Material(1.0, NU, 1.0)}
    own, fine = (s.warping(materials).properties for s in (shape, shape.refined(2.0)))
    assert own.torsion_constant == pytest.approx(fine.torsion_constant, rel=3e-4)
    like(own.shear_factors, fine.shear_factors, 3e-4)
    np.testing.assert_allclose(own.shear_centre, fine.shear_centre, atol=1e-4)


def test_filled_tube():
    """Torsion does not warp it: its parts' stiffnesses add."""
    shape = fl.sections.SectionShape.joined(
        {
            "tube": fl.sections.SectionShape.tube(0.8, 1.0),
            "core": fl.sections.SectionShape.circle(0.8),
        }
    )
    section = shape.section({"tube": STEEL, "core": RUBBERY})
    tube, core = fl.Section.tube(0.8, 1.0, STEEL), fl.Section.circle(0.8, RUBBERY)
    for i in (0, 3, 4, 5):
        parts = tube.stiffness[i, i] + core.stiffness[i, i]
        assert section.stiffness[i, i] == pytest.approx(parts, rel=1e-3)
    np.testing.assert_allclose(section.inertia, tube.inertia + core.inertia, rtol=1e-3, atol=1e-6)
    like(shape.section(STEEL).stiffness, fl.Section.circle(1.0, STEEL).stiffness)


def test_a_cut_without_a_difference():
    like(LAYERS.section(STEEL).stiffness, fl.Section.rectangle(1.0, 1.0, STEEL).stiffness, 1e-4)


def test_inertia_has_its_own_centre():
    heavy = fl.Material(STEEL.E, NU, 3 * STEEL.density)
    G = LAYERS.section({"lower": heavy, "upper": STEEL}).inertia  # about the middle, z = 0.5
    assert G[0, 0] == pytest.approx(STEEL.density * (3 * 0.4 + 0.6))
    assert G[0, 3] == pytest.approx(STEEL.density * (3 * 0.4 * -0.3 + 0.6 * 0.2))


# --- laws


@pytest.mark.parametrize("name", ["channel", "angle"])
def test_offset_by_the_parallel_axis_theorem(name, solved):
    p, shift = solved[name].properties, np.array([0.03, -0.05])
    y, z = shift
    centred, moved = solved[name].section(), solved[name].section(at=p.centroid + shift)
    EA, EI = p.E * p.area, p.E * p.second_moments
    assert moved.stiffness[4, 4] == pytest.approx(EI[1, 1] + EA * z**2)
    assert moved.stiffness[5, 5] == pytest.approx(EI[0, 0] + EA * y**2)
    assert moved.stiffness[4, 5] == pytest.approx(-EI[0, 1] - EA * y * z)
    np.testing.assert_allclose(moved.stiffness[0, [0, 4, 5]], EA * np.array([1, -z, y]))
    mass, J = STEEL.density * p.area, STEEL.density * p.second_moments
    np.testing.assert_allclose(moved.inertia[0], mass * np.array([1, 0, -y, -z]), atol=1e-9)
    np.testing.assert_allclose(moved.inertia[2:, 2:], J + mass * np.outer(shift, shift))
    for there in (centred, moved):
        # a shear force acts at the shear centre, wherever the axis is
        ys, zs = there.properties.shear_centre
        D = there.stiffness
        np.testing.assert_allclose(D[3, 1:3], ys * D[2, 1:3] - zs * D[1, 1:3], rtol=1e-9)
        twisted = p.G * p.torsion_constant + (ys * D[3, 2] - zs * D[3, 1])
        assert D[3, 3] == pytest.approx(twisted)
    back = moved.offset(-y, -z)
    like(back.stiffness, centred.stiffness, 1e-12)
    like(back.inertia + np.diag([0, 1, 0, 0]), centred.inertia + np.diag([0, 1, 0, 0]), 1e-12)
    np.testing.assert_allclose(back.outline, centred.outline, atol=1e-15)
    np.testing.assert_allclose(
        back.properties.shear_centre, centred.properties.shear_centre, atol=1e-15
    )


def test_energy_is_that_of_the_strains_at_the_new_point():
    rng = np.random.default_rng(0)
    L, strain, y, z = rng.normal(size=(6, 6)), rng.normal(size=6), 0.3, -0.7
    section = fl.Section.from_stiffness(L @ L.T)
    there = np.concatenate([strain[:3] + np.cross(strain[3:], [0, y, z]), strain[3:]])
    energy = strain @ section.stiffness @ strain
    assert there @ section.offset(y, z).stiffness @ there == pytest.approx(energy)


def test_a_quarter_turn_swaps_the_sides():
    turned = fl.Section.rectangle(1.0, 3.0, STEEL).offset(0.2, 0.0).rotated(pi / 2)
    wanted = fl.Section.rectangle(3.0, 1.0, STEEL).offset(0.0, 0.2)
    np.testing.assert_allclose(turned.stiffness, wanted.stiffness, rtol=1e-14)
    np.testing.assert_allclose(turned.inertia, wanted.inertia, rtol=1e-14)
    for angle in (0.4, pi):
        back = turned.rotated(angle).rotated(-angle)
        like(back.stiffness, turned.stiffness, 1e-14)


def test_a_turned_section_is_the_same_in_turned_axes(solved):
    """Torsion constant, shear centre and factors belong to the section, not to its axes."""
    angle, shift = 0.5, np.array([7.0, -3.0])
    c, s = np.cos(angle), np.sin(angle)
    corners = SHAPES["angle"].parts["section"].outer.vertices @ np.array([[c, s], [-s, c]])
    warping = fl.sections.SectionShape.polygon(corners + shift).warping(STEEL)
    straight, turned = solved["angle"].section(), warping.section(angle=angle)
    like(turned.stiffness, straight.stiffness, 1e-4)  # two meshes
    np.testing.assert_allclose(turned.inertia, straight.inertia, rtol=1e-9, atol=1e-9)
    p, q = solved["angle"].properties, warping.properties
    assert q.torsion_constant == pytest.approx(p.torsion_constant, rel=1e-4)
    np.testing.assert_allclose(
        q.shear_centre - shift, np.array([[c, -s], [s, c]]) @ p.shear_centre, atol=1e-6
    )
    like(straight.rotated(angle).stiffness, warping.section().stiffness, 1e-4)


@pytest.mark.parametrize("unit", [1e-6, 1e3])
def test_units_do_not_matter(unit, solved):
    p = properties(fl.sections.SectionShape.channel(*(unit * np.array([0.08, 0.2, 0.0085, 0.011]))))
    q = solved["channel"].properties
    assert p.area == pytest.approx(unit**2 * q.area)
    assert p.torsion_constant == pytest.approx(unit**4 * q.torsion_constant, rel=1e-6)
    np.testing.assert_allclose(p.shear_centre / unit, q.shear_centre, atol=1e-8)
    like(p.shear_factors, q.shear_factors, 1e-6)


def test_a_beam_twists_unless_loaded_at_the_shear_centre(solved):
    """Small load at the tip, along e₃: bending, shear and twist by the formulas of the textbook."""
    channel, length, force = solved["channel"], 3.0, 1e-3
    p = channel.properties
    tips = []
    for at in (p.shear_centre, p.centroid):
        scene = fl.Scene()
        ends = (0, *at), (length, *at)
        beam = scene.add(fl.Beam.straight(*ends, channel.section(at), up=(0, 0, 1), cells=2))
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, force)))
        result = fl.statics(scene, load_steps=1)
        tips.append(result.position(beam.point("end"))[-1] - [length, *at])
    bending = force * length**3 / (3 * p.E * p.second_moments[1, 1])
    shear = force * length / (p.G * p.area * p.shear_factors[1, 1])
    twist = force * length / (p.G * p.torsion_constant)
    arm = p.centroid[0] - p.shear_centre[0]
    assert tips[0][2] == pytest.approx(bending + shear, rel=1e-6)
    assert tips[1][2] == pytest.approx(bending + shear + twist * arm**2, rel=1e-6)


# --- meshes of others


def test_section_from_gmsh(tmp_path):
    file = tmp_path / "layers.geo"
    file.write_text(
        'SetFactory("OpenCASCADE"); DefineConstant[ h = 0.4 ];\n'
        "Rectangle(1) = {-0.5, 0, 0, 1, h}; Rectangle(2) = {-0.5, h, 0, 1, 1 - h};\n"
        "Coherence; MeshSize{:} = 0.15;\n"
        'Physical Surface("lower") = {1}; Physical Surface("upper") = {2};\n'
    )
    mesh = fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(file))
    materials = {"lower": STEEL, "upper": RUBBERY}
    read, own = fl.sections.Warping(mesh, materials), LAYERS.warping(materials)
    like(read.section().stiffness, own.section().stiffness)
    np.testing.assert_allclose(read.section().inertia, own.section().inertia, atol=1e-8)
    thin = fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(file, {"h": 0.2}))
    assert fl.sections.Warping(thin, materials).properties.E < read.properties.E
    with pytest.raises(ValueError, match="no parameter 'k'"):
        fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(file, {"k": 0.2}))
    with pytest.raises(FileNotFoundError, match=r"nothing\.geo"):
        fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(tmp_path / "nothing.geo"))
    apart = tmp_path / "apart.geo"
    apart.write_text(file.read_text().replace("{-0.5, h,", "{0.7, h,"))
    with pytest.raises(ValueError, match="connected, got 2 pieces"):
        fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(apart))
    line = tmp_path / "line.geo"
    line.write_text("Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Line(1) = {1, 2};")
    with pytest.raises(ValueError, match="no surface cells"):
        fl.sections.SectionMesh.from_gmsh(fl.mesh.run_gmsh_script(line))


def dolfinx_mesh(cell):
    """Layers of 0.4 and 0.6 with tags 3 and 8."""
    corners = [(-0.5, 0.0), (0.5, 1.0)]
    mesh = dolfinx.mesh.create_rectangle(MPI.COMM_SELF, corners, (10, 10), cell)
    count = mesh.topology.index_map(2).size_local
    middles = dolfinx.mesh.compute_midpoints(mesh, 2, np.arange(count, dtype=np.int32))
    tags = np.where(middles[:, 1] < 0.4, 3, 8).astype(np.int32)
    return mesh, dolfinx.mesh.meshtags(mesh, 2, np.arange(count, dtype=np.int32), tags)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_section_from_dolfinx(cell):
    mesh, tags = dolfinx_mesh(getattr(dolfinx.mesh.CellType, cell))
    section_mesh = fl.sections.SectionMesh.from_dolfinx(
        mesh, tags, regions={"upper": 8, "lower": 3}
    )
    materials = {"lower": STEEL, "upper": RUBBERY}
    warping = fl.sections.Warping(section_mesh, materials)
    like(warping.section().stiffness, LAYERS.section(materials).stiffness)
    assert len(warping.section().outline) == 4
    alone = fl.sections.Warping(fl.sections.SectionMesh.from_dolfinx(mesh), STEEL).properties
    assert alone.torsion_constant == pytest.approx(0.140577015, rel=1e-4)
    with pytest.raises(ValueError, match=r"each of the tags \[3, 8\] once, got"):
        fl.sections.SectionMesh.from_dolfinx(mesh, tags, regions={"lower": 3})
    with pytest.raises(ValueError, match="need cell_tags"):
        fl.sections.SectionMesh.from_dolfinx(mesh, regions={"lower": 3})
    few = dolfinx.mesh.meshtags(mesh, 2, tags.indices[:5], tags.values[:5])
    with pytest.raises(ValueError, match="must tag each"):
        fl.sections.SectionMesh.from_dolfinx(mesh, few)
    with pytest.raises(ValueError, match="triangles of degree 1 or 2"):
        fl.sections.SectionMesh.from_dolfinx(dolfinx.mesh.create_unit_interval(MPI.COMM_SELF, 2))


def test_outline_and_edges_of_a_tube():
    mesh = fl.sections.SectionShape.tube(0.5, 1.0).mesh
    outline = mesh.outline()
    np.testing.assert_allclose(np.linalg.norm(outline, axis=1), 1.0, atol=1e-3)
    assert 16 <= len(outline) <= 64
    radii = np.linalg.norm(mesh.borders(), axis=2)
    np.testing.assert_allclose(np.minimum(abs(radii - 1.0), abs(radii - 0.5)), 0.0, atol=1e-3)


def test_picture(tmp_path, solved):
    file = tmp_path / "channel.png"
    figure = solved["channel"].picture(file)
    assert file.stat().st_size > 20_000
    drawn = {line.get_label(): line.get_xydata() for line in figure.axes[0].lines}
    np.testing.assert_allclose(drawn["shear centre"][0], solved["channel"].properties.shear_centre)
    np.testing.assert_allclose(drawn["centroid"][0], solved["channel"].properties.centroid)
    composite = LAYERS.warping({"lower": STEEL, "upper": RUBBERY}).picture()
    assert {text.get_text() for text in composite.axes[0].texts} == {"lower", "upper"}


def test_warping_function_is_free_of_extension(solved):
    """At the axes of symmetry of the channel it is zero, and odd in z."""
    w = solved["channel"]
    assert np.abs(w.function[np.abs(w.points[:, 1]) < 1e-9]).max() < 1e-3 * w.function.max()
    assert w.function.max() == pytest.approx(-w.function.min(), rel=1e-3)


def test_properties_can_be_printed():
    text = str(fl.Section.rectangle(1.0, 2.0, STEEL).properties)
    assert "area                      2\n" in text
    assert "principal angle           90.0000°" in text


# --- bad input

SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
S = fl.sections.SectionShape


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: S.rectangle(0.0, 1.0), r"width must be a positive finite number, got 0\.0"),
        (lambda: S.circle(float("nan")), "radius.*got nan"),
        (lambda: S.tube(1.0, 0.5), r"inner_radius must be less than outer_radius, got 1\.0"),
        (lambda: S.box(1.0, 2.0, 0.5), "twice the thickness must be less than the smaller side"),
        (lambda: S.i_section(0.1, 0.2, 0.1, 0.01), "web must be less than width"),
        (lambda: S.i_section(0.1, 0.2, 0.01, 0.1), "twice the flange must be less than height"),
        (lambda: S.channel(0.1, 0.2, 0.2, 0.01), "web must be less than width"),
        (lambda: S.channel(0.1, 0.2, 0.01, -0.01), "flange must be a positive"),
        (lambda: S.l_section(0.1, 0.2, 0.1), "thickness must be less than the shorter flange"),
        (lambda: S.l_section(0.1, 0.2, 0.01, 0.1), "root_radius must be at least 0 and less than"),
        (lambda: S.polygon([(0, 0), (1, 0)]), "points must be at least 3 points"),
        (lambda: S.polygon([(0, 0), (1, 0), (np.inf, 1)]), "points must be finite"),
        (lambda: S.polygon([(0, 0), (1, 0), (1, 0), (0, 1)]), "differ from their neighbours"),
        (lambda: S.polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), "the outline crosses or touches its"),
        (lambda: S.polygon([(0, 0), (2, 0), (1, 0), (1, 1)]), "the outline crosses or touches its"),
        (lambda: S.polygon(SQUARE, [SQUARE + 3]), "hole 0 lies outside the outline"),
        (lambda: S.polygon(SQUARE, [SQUARE * 3 - 1]), "hole 0 lies outside the outline"),
        (lambda: S.polygon(SQUARE, [SQUARE + 0.5]), "hole 0 crosses or touches the outline"),
        (lambda: S.polygon(SQUARE, [SQUARE * 0.5]), "hole 0 crosses or touches the outline"),
        (
            lambda: S.polygon(SQUARE, [SQUARE * 0.5 + 0.1, SQUARE * 0.5 + 0.3]),
            "hole 1 crosses or touches hole 0",
        ),
        (
            lambda: S.polygon(SQUARE, [SQUARE * 0.5 + 0.2, SQUARE * 0.2 + 0.3]),
            "hole 1 lies inside hole 0",
        ),
        (lambda: S.rectangle(1.0, 1e6).mesh, "walls are too thin to be meshed: about"),
        (lambda: S({}), "at least one part"),
        (lambda: S.circle(1.0).refined(-1.0), "refinement must be a positive"),
        (lambda: S.circle(1.0).moved(np.nan, 0.0), "y and z must be finite"),
        (lambda: S.joined({"a": LAYERS}), "'a' must have one region, got 2"),
        (
            lambda: S.joined({"a": LOWER, "b": UPPER}).mesh,
            "parts 'a', 'b' overlap; they may only touch",
        ),
        (lambda: S.joined({"a": LOWER, "b": UPPER.moved(0, 2)}).mesh, "connected, got 2 pieces"),
        (lambda: S.joined({"a": LOWER, "b": UPPER.moved(1, 0.5)}).mesh, "connected, got 2 pieces"),
        (lambda: LAYERS.section({"lower": STEEL}), "region 'upper' has no material"),
        (
            lambda: LAYERS.section({"lower": STEEL, "upper": STEEL, "glue": STEEL}),
            "there is no region 'glue'; there are: lower, upper",
        ),
        (
            lambda: fl.sections.Warping(LAYERS.mesh, STEEL, degree=1),
            "degree must be at least 2, got 1",
        ),
        (lambda: LAYERS.section(STEEL, at=(1, 2, 3)), r"at must be a point \(y, z\)"),
        (lambda: LAYERS.section(STEEL, angle=np.inf), "angle must be a finite number"),
        (lambda: fl.Section.circle(1, STEEL).offset(np.nan, 0), "y must be a finite number"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
