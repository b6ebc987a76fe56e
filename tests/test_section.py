"""Sections: shape to stiffness and inertia, checked by integration and by known constants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mass_matrix import mass_matrix_6x6

import fem_lie as fl
from fem_lie import lie

STEEL = fl.Material(E=210e9, nu=0.3, density=7850.0)
SIZE = st.floats(1e-3, 10.0)


def _gauss(section, width, height):
    """Mass matrix of a rectangle by 2×2 Gauss points, exact for second moments."""
    xi = np.array([-1, 1]) / np.sqrt(3)
    mass_matrix = np.zeros((4, 4))
    for y in 0.5 * width * xi:
        for z in 0.5 * height * xi:
            shape = np.array([1.0, 0.0, y, z])
            mass_matrix += STEEL.density * 0.25 * width * height * np.outer(shape, shape)
    return mass_matrix


@given(SIZE, SIZE)
@settings(max_examples=25)
def test_inertia_of_a_rectangle_is_the_integral_of_its_definition(width, height):
    section = fl.Section.rectangle(width, height, STEEL)
    np.testing.assert_allclose(
        section.inertia, _gauss(section, width, height), rtol=1e-13, atol=1e-15 * width * height
    )


@pytest.mark.parametrize(
    "section",
    [
        fl.Section.rectangle(0.2, 0.1, STEEL),
        fl.Section.circle(0.1, STEEL),
        fl.Section.tube(0.09, 0.1, STEEL),
    ],
)
def test_inertia_and_bending_stiffness_are_moments_of_one_shape(section):
    """Rotary inertia about e₂, e₃ is ρ/E of bending stiffness; about e₁ it is the sum of both."""
    J = mass_matrix_6x6(section.inertia)[3:, 3:]
    ratio = STEEL.density / STEEL.E
    bending = np.diag(section.stiffness)[4:]
    np.testing.assert_allclose(np.diag(J), ratio * np.array([bending.sum(), *bending]), rtol=1e-14)
    assert section.inertia[0, 0] == pytest.approx(ratio * section.stiffness[0, 0], rel=1e-14)


def test_a_tall_section_is_stiffer_about_its_width():
    stiffness = fl.Section.rectangle(width=0.1, height=0.2, material=STEEL).stiffness
    assert stiffness[4, 4] == pytest.approx(STEEL.E * 0.1 * 0.2**3 / 12)
    assert stiffness[5, 5] == pytest.approx(STEEL.E * 0.2 * 0.1**3 / 12)


def _torsion_by_double_series(a, b):
    """Prandtl's stress function in a double sine series, truncated: converges as 1/n⁴."""
    n = np.arange(1, 1200, 2.0)
    m, k = np.meshgrid(n, n)
    terms = 1.0 / (m**2 * k**2 * ((m / a) ** 2 + (k / b) ** 2))
    return 256.0 * a * b / np.pi**6 * terms.sum()


def rectangle_torsion_constant(a, b):
    """That of a section whose shear modulus is 1."""
    return fl.Section.rectangle(a, b, fl.Material(2.0, 0.0, 1.0)).stiffness[3, 3]


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (2.0, 1.0), (1.0, 10.0)])
def test_torsion_constant_solves_poisson_problem(a, b):
    exact = rectangle_torsion_constant(a, b)
    # the tail of the truncated double series is positive and below 1e-7 here
    assert 0 < exact - _torsion_by_double_series(a, b) < 1e-7 * exact


def test_torsion_constant_of_square_and_of_strip():
    # 0.1405770149... in tables; the strip's limit is b³/3 (a − 0.6302 b)
    assert rectangle_torsion_constant(1.0, 1.0) == pytest.approx(0.14057701495515551, rel=1e-15)
    assert rectangle_torsion_constant(1e4, 1.0) == pytest.approx((1e4 - 0.630249) / 3, rel=1e-9)


def test_reference_constants_of_a_benchmark_can_be_given():
    section = fl.Section.rectangle(
        5e-3,
        5e-3,
        fl.Material(7e10, 0.3, 2700),
        shear_factor=5 / 6,
        torsion_constant=0.1406 * 5e-3**4,
    )
    G, A = 7e10 / 2.6, 25e-6
    np.testing.assert_allclose(
        np.diag(section.stiffness)[1:4], [5 / 6 * G * A, 5 / 6 * G * A, G * 0.1406 * 5e-3**4]
    )


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_shear_factors_of_tubes_reach_their_limits(nu):
    """Solid circle 6(1+ν)/(7+6ν) and thin tube 2(1+ν)/(4+3ν), Cowper 1966."""
    material = fl.Material(1.0, nu, 1.0)

    def factor(section):
        return section.stiffness[1, 1] / (material.G * section.stiffness[0, 0] / material.E)

    solid = 6 * (1 + nu) / (7 + 6 * nu)
    assert factor(fl.Section.circle(1.0, material)) == pytest.approx(solid, rel=1e-14)
    assert factor(fl.Section.tube(1e-7, 1.0, material)) == pytest.approx(solid, rel=1e-12)
    thin = 2 * (1 + nu) / (4 + 3 * nu)
    assert factor(fl.Section.tube(1 - 1e-7, 1.0, material)) == pytest.approx(thin, rel=1e-6)


def test_a_tube_is_a_circle_less_its_hole():
    tube, outer, hole = (
        fl.Section.tube(0.3, 0.5, STEEL),
        fl.Section.circle(0.5, STEEL),
        fl.Section.circle(0.3, STEEL),
    )
    np.testing.assert_allclose(tube.inertia, outer.inertia - hole.inertia, rtol=1e-13)
    for i in (0, 3, 4, 5):  # shear factors do not add
        assert tube.stiffness[i, i] == pytest.approx(
            outer.stiffness[i, i] - hole.stiffness[i, i], rel=1e-13
        )


def _random_body(seed):
    """Point masses: mass, tensor about the centre, centre, and the mass matrix by definition."""
    rng = np.random.default_rng(seed)
    m, x = rng.uniform(0.5, 2.0, 6), rng.normal(size=(6, 3))
    centre = m @ x / m.sum()
    r = x - centre
    J = sum(mi * (ri @ ri * np.eye(3) - np.outer(ri, ri)) for mi, ri in zip(m, r, strict=True))
    shape = np.column_stack([np.ones(6), x])
    return m.sum(), J, centre, (shape.T * m) @ shape


@pytest.mark.parametrize("seed", range(5))
def test_mass_matrix_of_point_masses(seed):
    mass, J, centre, mass_matrix = _random_body(seed)
    np.testing.assert_allclose(
        fl.sections.director_mass_matrix(mass, J, centre), mass_matrix, rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("seed", range(5))
def test_kinetic_energy_is_the_same_in_directors_and_in_local_velocities(seed):
    mass, J, centre, mass_matrix = _random_body(seed)
    rng = np.random.default_rng(100 + seed)
    v, R = rng.normal(size=6), lie.so3_exp(rng.normal(size=3))
    qdot = np.vstack([R @ v[:3], (R @ lie.hat(v[3:])).T])
    in_directors = 0.5 * np.einsum(
        "ab,aj,bj", fl.sections.director_mass_matrix(mass, J, centre), qdot, qdot
    )
    assert 0.5 * v @ mass_matrix_6x6(mass_matrix) @ v == pytest.approx(in_directors, rel=1e-12)


def test_section_inertia_is_that_of_a_flat_rigid_body():
    """A section has no extent along e₁: the triangle inequality is an equality, and is allowed."""
    section = fl.Section.rectangle(0.2, 0.1, STEEL)
    J = mass_matrix_6x6(section.inertia)
    np.testing.assert_allclose(
        fl.sections.director_mass_matrix(J[0, 0], J[3:, 3:]),
        section.inertia,
        rtol=1e-13,
        atol=1e-16,
    )


@pytest.mark.parametrize(
    ("given", "moments"),
    [
        ({"mass": 2.0}, (0, 0, 0)),
        ({"mass": 2.0, "polar": 0.5}, (0.5, 0.25, 0.25)),
        ({"mass": 2.0, "rotary": (0.3, 0.1)}, (0.4, 0.3, 0.1)),
        ({"mass_matrix": fl.sections.director_mass_matrix(2.0, (0.4, 0.3, 0.1))}, (0.4, 0.3, 0.1)),
    ],
)
def test_inertia_of_a_section_is_what_its_name_says(given, moments):
    """Moments of inertia per length about e₁, e₂, e₃, never second moments in their place."""
    section = fl.Section.from_stiffness(np.eye(6), **given)
    expected = np.diag([2.0, 2.0, 2.0, *moments])
    np.testing.assert_allclose(mass_matrix_6x6(section.inertia), expected, atol=1e-15)


def test_any_stiffness_is_accepted_and_kept():
    rng = np.random.default_rng(0)
    L = rng.normal(size=(6, 6)) * np.geomspace(1e4, 1e-2, 6)[:, np.newaxis]
    D = L @ L.T
    section = fl.Section.from_stiffness(D)
    np.testing.assert_allclose(section.stiffness, D)
    assert section.inertia is None
    with pytest.raises(ValueError, match="read-only"):
        section.stiffness[0, 0] = 0


COUPLED = np.eye(6)
COUPLED[0, 3] = COUPLED[3, 0] = 1.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fl.Material(0.0, 0.3, 1.0), r"Young's modulus.*positive.*got 0\.0"),
        (lambda: fl.Material(1.0, 0.3, -1.0), r"density.*positive.*got -1\.0"),
        (lambda: fl.Material(1.0, 0.6, 1.0), r"-1 < nu <= 0.5, got 0\.6"),
        (lambda: fl.Material(1.0, -1.0, 1.0), r"-1 < nu <= 0.5"),
        (lambda: fl.Material(float("nan"), 0.3, 1.0), "Young's modulus.*nan"),
        (lambda: fl.Material(1.0, float("nan"), 1.0), "nu.*nan"),
        (lambda: fl.Section.rectangle(0.0, 1.0, STEEL), r"width.*got 0\.0"),
        (lambda: fl.Section.rectangle(1.0, 1.0, STEEL, shear_factor=-1.0), "shear_factor.*got -1"),
        (lambda: fl.Section.rectangle(1.0, 1.0, STEEL, torsion_constant=0.0), "torsion_constant"),
        (lambda: fl.Section.circle(-1.0, STEEL), r"radius.*got -1\.0"),
        (lambda: fl.Section.tube(1.0, 0.5, STEEL), r"less than outer_radius, got 1\.0 and 0\.5"),
        (lambda: fl.Section.from_stiffness(np.eye(5)), r"shape \(6, 6\)"),
        (lambda: fl.Section.from_stiffness(np.tri(6)), "symmetric"),
        (lambda: fl.Section.from_stiffness(COUPLED), "positive definite"),
        (lambda: fl.Section.from_stiffness(np.diag([1, 1, 1, 1, 1, -1])), "positive definite"),
        (lambda: fl.Section.from_stiffness(np.full((6, 6), np.nan)), "finite"),
        (lambda: fl.Section.from_stiffness(np.eye(6), np.zeros((4, 4))), "positive mass"),
        (lambda: fl.Section.from_stiffness(np.eye(6), mass=0.0), "positive mass"),
        (lambda: fl.Section.from_stiffness(np.eye(6), [2, 3, 1, 2]), r"mass=…, rotary=\(J₂, J₃\)"),
        (lambda: fl.Section.from_stiffness(np.eye(6), polar=1.0), "need mass="),
        (lambda: fl.Section.from_stiffness(np.eye(6), np.eye(4), mass=1.0), "not both"),
        (lambda: fl.Section.from_stiffness(np.eye(6), mass=1, polar=2, rotary=(1, 1)), "sum of"),
        (
            lambda: fl.Section.from_stiffness(np.eye(6), mass=1, rotary=(2, 1, 1)),
            "e₂ and e₃, 2 num",
        ),
        (lambda: fl.Section.from_stiffness(np.eye(6), mass=1, rotary=(-2, 1)), "semidefinite"),
        (lambda: fl.Section.from_stiffness(np.eye(6), mass=1, polar=-1), "semidefinite"),
        (lambda: fl.Section.from_stiffness(np.eye(6), np.diag([1, 0, -1, 1])), "semidefinite"),
        (lambda: fl.Section.from_stiffness(np.eye(6), outline=[[0, 0]]), "at least 3"),
        (lambda: fl.sections.director_mass_matrix(0.0, np.eye(3)), "mass.*got 0"),
        (lambda: fl.sections.director_mass_matrix(1.0, [1.0, 1.0, 3.0]), "sum of the others"),
        (lambda: fl.sections.director_mass_matrix(1.0, [1.0, 1.0, -1.0]), "positive principal"),
        (lambda: fl.sections.director_mass_matrix(1.0, np.tri(3)), "symmetric"),
        (lambda: fl.sections.director_mass_matrix(1.0, np.eye(3), (0, 0)), "centre"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
