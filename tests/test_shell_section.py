"""Shell sections against closed forms, symmetries and integrals through the thickness."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(E=210.0, nu=0.3, density=7.8)
CARBON = fl.sections.Orthotropic(
    E1=140.0, E2=10.0, nu12=0.3, G12=5.0, G13=4.0, G23=3.0, density=1.6
)


def test_layer():
    t, E, nu = 0.2, 210.0, 0.3
    section = fl.ShellSection.layer(t, STEEL)
    C = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    D = np.zeros((8, 8))
    D[:3, :3], D[3:6, 3:6] = C * t, C * t**3 / 12
    D[6:, 6:] = np.eye(2) * 5 / 6 * E / (2 + 2 * nu) * t
    np.testing.assert_allclose(section.stiffness, D, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(
        section.inertia, np.diag([7.8 * t, 7.8 * t**3 / 12]), rtol=1e-13, atol=1e-16
    )
    assert section.thickness == t


def test_plies_of_one_material_are_one_layer():
    parts = [fl.sections.Ply(0.05, STEEL, angle) for angle in (0, 30, -70, 45)]
    one, many = fl.ShellSection.layer(0.2, STEEL), fl.ShellSection.laminate(parts)
    np.testing.assert_allclose(many.stiffness, one.stiffness, atol=1e-13 * 50)
    np.testing.assert_allclose(many.inertia, one.inertia, atol=1e-15)


def test_coupling_vanishes_for_symmetric_laminates_only():
    half = [fl.sections.Ply(0.1, CARBON, 0), fl.sections.Ply(0.05, CARBON, 40)]
    symmetric = fl.ShellSection.laminate([*half, *half[::-1]]).stiffness
    assert np.abs(symmetric[:3, 3:6]).max() < 1e-15 * np.abs(symmetric).max()
    other = fl.ShellSection.laminate([*half, *half]).stiffness
    assert np.abs(other[:3, 3:6]).max() > 1e-3 * np.abs(other).max()


def test_a_turned_ply_is_stiff_along_its_fibres():
    """In axes turned by the angle, (cos, sin), it is the ply at 0°; 90° exchanges the axes."""
    section = fl.ShellSection.laminate([fl.sections.Ply(1.0, CARBON, 25.0)]).stiffness
    c, s = np.cos(np.radians(25)), np.sin(np.radians(25))
    along = np.array([c * c, s * s, 2 * c * s])  # stretch along the fibres, nothing else
    straight = fl.ShellSection.laminate([fl.sections.Ply(1.0, CARBON)]).stiffness
    assert along @ section[:3, :3] @ along == pytest.approx(straight[0, 0], rel=1e-14)
    assert np.array([c, s]) @ section[6:, 6:] @ [c, s] == pytest.approx(straight[6, 6], rel=1e-14)
    crossed = fl.ShellSection.laminate([fl.sections.Ply(1.0, CARBON, 90.0)]).stiffness
    swap = [1, 0, 2, 4, 3, 5, 7, 6]
    np.testing.assert_allclose(crossed, straight[np.ix_(swap, swap)], atol=1e-13)


def cross_ply(thickness: float, angles: tuple[float, ...], **options: float) -> fl.ShellSection:
    """Equal plies of a fibre composite."""
    fibres = fl.sections.Orthotropic(25.0, 1.0, 0.25, 0.5, 0.5, 0.2, 1.0)
    plies = [fl.sections.Ply(thickness / len(angles), fibres, angle) for angle in angles]
    return fl.ShellSection.laminate(plies, **options)


def test_shear_stiffness_of_equal_plies_has_five_sixths():
    """In any axes, and about any reference surface."""
    plies = [fl.sections.Ply(0.2, CARBON, 25.0)] * 3
    known = fl.ShellSection.laminate(plies, shear_factor=5 / 6).stiffness[6:, 6:]
    for reference in (0.0, 0.5, 0.8):
        found = fl.ShellSection.laminate(plies, reference=reference).stiffness[6:, 6:]
        np.testing.assert_allclose(found, known, rtol=1e-13)


def test_shear_factor_of_a_cross_ply():
    """0.5952 of 0/90/90/0, J. M. Whitney, J. Appl. Mech. 40 (1973) 302."""
    one, both = (
        cross_ply(0.1, (0, 90, 90, 0), **options).stiffness[6, 6]
        for options in ({}, {"shear_factor": 1.0})
    )
    assert one / both == pytest.approx(0.5952, abs=5e-5)


def test_a_soft_core_is_not_sheared_by_its_faces():
    """``G d²/c``, where the sum over plies is 257 times as stiff."""
    face, core = fl.Material(7e4, 0.3, 1.0), fl.Material(13.0, 0.3, 1.0)
    plies = [fl.sections.Ply(t, m) for t, m in ((0.5, face), (20.0, core), (0.5, face))]
    shear = fl.ShellSection.laminate(plies).stiffness[6:, 6:]
    np.testing.assert_allclose(shear, core.G * 20.5**2 / 20 * np.eye(2), rtol=1e-3, atol=1e-12)


@pytest.mark.parametrize(
    ("slenderness", "published", "near"),
    [(10, 0.7530, 0.015), (20, 0.5164, 3e-3), (100, 0.4347, 1e-3)],
)
def test_a_cross_ply_deflects_as_in_three_dimensions(slenderness, published, near):
    """0/90/0 under ``q sin πx/a sin πy/a``: Pagano, J. Compos. Mater. 4 (1970) 20.

    5/6 of the sum misses by 11, 5 and 0.2 %.
    """
    h, α = 1.0 / slenderness, np.pi
    D = cross_ply(h, (0, 90, 0)).stiffness
    S5, S4, twist, both = D[6, 6], D[7, 7], D[5, 5] * α * α, (D[3, 4] + D[5, 5]) * α * α
    K = np.array(
        [
            [(S5 + S4) * α * α, S5 * α, S4 * α],
            [S5 * α, D[3, 3] * α * α + twist + S5, both],
            [S4 * α, both, twist + D[4, 4] * α * α + S4],
        ]
    )
    w = np.linalg.solve(K, [1.0, 0.0, 0.0])[0]
    assert 100 * w * h**3 == pytest.approx(published, rel=near)


@pytest.mark.parametrize("reference", [0.0, 0.3, 1.0])
def test_reference_surface(reference):
    """Strain and velocity at the middle are those of the reference surface, carried there."""
    plies = [fl.sections.Ply(0.1, CARBON, 20), fl.sections.Ply(0.3, STEEL)]
    middle = fl.ShellSection.laminate(plies)
    moved = fl.ShellSection.laminate(plies, reference=reference)
    z = (0.5 - reference) * 0.4
    T = np.eye(8)
    T[:3, 3:6] = z * np.eye(3)
    np.testing.assert_allclose(moved.stiffness, T.T @ middle.stiffness @ T, atol=1e-13)
    S = np.array([[1, z], [0, 1]])
    np.testing.assert_allclose(moved.inertia, S.T @ middle.inertia @ S, atol=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fl.ShellSection.layer(0.0, STEEL), "thickness of a ply .* got 0.0"),
        (lambda: fl.ShellSection.layer(0.1, fl.Material(1.0, 0.5, 1.0)), "below 1/2, got 0.5"),
        (
            lambda: fl.sections.Ply(0.1, STEEL, np.radians(-45)),
            "expected degrees, got .*-0.78.*, which are -45° in rad",
        ),
        (lambda: fl.ShellSection.laminate([]), "at least one ply"),
        (
            lambda: fl.ShellSection.laminate([fl.sections.Ply(1, STEEL)], reference=1.5),
            "between 0 and 1, got 1.5",
        ),
        (lambda: fl.ShellSection.layer(1, STEEL, shear_factor=-1), "shear_factor .* got -1"),
        (lambda: fl.sections.Orthotropic(1, 10, 0.4, 1, 1, 1, 1), "nu12² < E1/E2 = 0.1, got 0.4"),
        (lambda: fl.sections.Orthotropic(1, 1, 0.4, 1, float("nan"), 1, 1), "G13 .* got nan"),
    ],
)
def test_bad_input(make, message):
    with pytest.raises(ValueError, match=message):
        make()
