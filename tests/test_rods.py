"""Rods without shear: Kirchhoff's and discrete ones."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

import fem_lie as fl
from demos import bend45, catenary, rings
from demos.elastica import BENDING, FORCE, LENGTH, elastica
from fem_lie import lie

KINDS = {"Kirchhoff": fl.elements.KirchhoffRod(), "discrete": fl.elements.DiscreteRod()}
each = pytest.mark.parametrize("name", KINDS)
SLENDER = [1e1, 1e2, 1e4]
"""Of a square section: EA L²/EI is twelve times its square."""


def section(slenderness: float, **inertia) -> fl.Section:
    EA = 12 * slenderness**2 * BENDING / LENGTH**2
    return fl.Section.from_stiffness([EA] * 3 + [BENDING] * 3, **inertia)


def cantilever(name: str, cells: int, own: fl.Section) -> tuple[fl.Scene, fl.Rod]:
    scene = fl.Scene()
    ends = (0, 0, 0), (LENGTH, 0, 0)
    rod = scene.add(fl.Rod.straight(*ends, own, cells=cells, formulation=KINDS[name]))
    scene.add(fl.Clamp(rod.point("start")))
    return scene, rod


def iterations(result: fl.StaticResult) -> float:
    """Of a step, those in vain among them."""
    return float(result.total_iterations) / len(result.iterations)


def rolled_up(name: str, cells: int, slenderness: float) -> tuple[float, float]:
    """Distance of the tip from the root over the length, and iterations per step."""
    scene, rod = cantilever(name, cells, section(slenderness))
    scene.add(fl.PointLoad(rod.point("end"), moment=(0, 0, 2 * np.pi * BENDING / LENGTH)))
    result = fl.statics(scene, load_steps=10)
    return float(np.linalg.norm(result.position(rod.point("end"))[-1])) / LENGTH, iterations(result)


@pytest.mark.parametrize("slenderness", SLENDER)
def test_full_circle(slenderness):
    (coarse, _), (fine, steps) = (rolled_up("Kirchhoff", n, slenderness) for n in (8, 16))
    assert fine < 2e-4 and coarse / fine > 14 and steps <= 5


@pytest.mark.parametrize("slenderness", SLENDER)
def test_full_circle_of_edges(slenderness):
    """Of second order; the frame of the end goes along with its edge within a step."""
    (coarse, _), (fine, steps) = (rolled_up("discrete", n, slenderness) for n in (8, 16))
    assert fine < 0.05 and coarse / fine > 3.2 and steps <= 5


@pytest.mark.parametrize(("name", "bound"), [("Kirchhoff", 1e-5), ("discrete", 2e-3)])
@pytest.mark.parametrize("slenderness", SLENDER)
def test_elastica(name, bound, slenderness):
    """Thick ones stretch: by about the square of the slenderness less."""
    scene, rod = cantilever(name, 16, section(slenderness))
    scene.add(fl.PointLoad(rod.point("end"), (0, 0, FORCE)))
    result = fl.statics(scene, load_steps=10)
    moved = result.position(rod.point("end"))[-1] - (LENGTH, 0, 0)
    stretched = 3.0 / (12 * slenderness**2) * FORCE * LENGTH**2 / BENDING
    assert np.linalg.norm(moved - elastica(FORCE)) / LENGTH <= bound + stretched
    assert iterations(result) <= 5


@pytest.mark.parametrize(("name", "bound"), [("rod", 2e-4), ("spline", 2e-4), ("discrete", 2e-3)])
def test_45_degree_bend(name, bound):
    """To the point of beams with shear, of which there is 5e-5 here."""
    errors = [bend45.solve(n, 3, bend45.FORMULATIONS[name])[0]["tip_error"] for n in (8, 16)]
    assert errors[1] < bound and errors[0] / errors[1] > 2.5


KNOTS = np.array([0, 0, 0, 0, 1, 1, 3, 3, 4, 4, 4, 4.0])
CONTROL = np.array(
    [(0, 0, 0), (1, 0, 0.2), (2, 1, 0), (3, 2, 0), (4, 2.5, 1), (5, 1, 0), (5.5, 0, 0), (6, 0, 1.0)]
)


@pytest.mark.parametrize("cells", [1, 3])
def test_a_rod_along_a_spline_is_this_spline_with_more_knots(cells):
    """Its length, and where knots are."""
    spline = BSpline(KNOTS, CONTROL, 3)
    rod = fl.Rod(fl.mesh.Spline.of(spline, 2 * cells).mesh(), section(100.0))
    u = np.linspace(0, 4, 100001)
    arc = np.linalg.norm(np.diff(spline(u), axis=0), axis=1).sum()
    assert rod.model.lengths.sum() == pytest.approx(arc, rel=1e-7)
    again = fl.Rod(fl.mesh.Spline.of(spline.insert_knot(2.0, m=2), cells).mesh(), section(100.0))
    np.testing.assert_allclose(again.frames[-1, :2], rod.frames[-1, :2], atol=1e-13)


def quarter(cells: int) -> float:
    """Error of a quarter ring, clamped, loaded across its plane, by a parameter of any speed."""
    u = np.linspace(0, 1, cells + 1)
    φ, rate = 0.5 * np.pi * (0.6 * u + 0.4 * u**2), 0.5 * np.pi * (0.6 + 0.8 * u)
    circle = np.stack([np.cos(φ), np.sin(φ), 0 * φ], axis=1)
    along = rate[:, np.newaxis] * np.stack([-np.sin(φ), np.cos(φ), 0 * φ], axis=1)
    own = fl.Section.from_stiffness([1e6, 1e6, 1e6, 0.5, 1.0, 1.0])
    scene = fl.Scene()
    rod = scene.add(fl.Rod(fl.mesh.Spline.checked(u, circle, along).mesh(), own))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), (0, 0, 1e-4)))
    found = fl.statics(scene).position(rod.point("end"))[-1, 2]
    exact = 1e-4 * (np.pi / 4 + (3 * np.pi / 4 - 2) / 0.5)
    return float(abs(found / exact - 1))


def test_a_ring_of_any_parameter_bends_and_twists_as_it_should():
    coarse, fine = quarter(4), quarter(8)
    assert fine < 1.5e-3 and coarse / fine > 3.5


def test_a_spline_that_nearly_stands_still_is_refused():
    line = fl.mesh.Spline.checked([0, 1], [(0, 0, 0), (1, 0, 0)], [(3, 0, 0), (2.9, 0, 0)])
    with pytest.raises(ValueError, match="insert more knots"):
        fl.Rod(line.mesh(), section(100.0))


@pytest.mark.parametrize("turn", [1e-9, 1e-3, 0.019, 0.021, 0.5, 2.3, 2.5, 3.0])
@pytest.mark.parametrize("slopes", [None, [(1.1, 0.9), (0.4, 0.8)]], ids=["curve", "spline"])
def test_closed_forces_are_those_of_the_energy(turn, slopes):
    """About all series and branches; with strain without stress, and coupled sections."""
    rng = np.random.default_rng(1)
    root = rng.normal(size=(6, 6))
    own = fl.Section.from_stiffness(root @ root.T + np.eye(6))
    mesh = fl.mesh.curve(lambda s: (s, 0.2 * s * s, 0.1 * s**3), cells=2)
    rod = fl.Rod(replace(mesh, slopes=slopes and np.array(slopes) / 2), own)
    assembly = rod.model.assemble([rod.model])
    assembly.set_eigenstrain(0.05 * rng.normal(size=(2, 6)))
    H, axis = rod.frames.copy(), rng.normal(size=3)
    for k in range(1, 3):
        H[k] = lie.se3_retract(H[k], np.r_[np.zeros(3), k * turn * axis / np.linalg.norm(axis)])
    forces, numeric, step = np.zeros((3, 6)), np.zeros((3, 6)), 1e-5
    assembly.add_forces(H[np.argsort(assembly.order)], forces)
    for i, j in np.ndindex(3, 6):
        h = step * np.eye(1, 18, 6 * i + j).reshape(3, 6)
        energies = [
            assembly.energy(lie.se3_retract(H, sign * h)[np.argsort(assembly.order)])
            for sign in (1, -1)
        ]
        numeric[i, j] = (energies[0] - energies[1]) / (2 * step)
    # central differences: step² of third derivatives, and round-off of the energy over the step
    np.testing.assert_allclose(
        forces[assembly.order], numeric, rtol=0, atol=1e-7 * np.abs(forces).max()
    )


def test_a_rod_with_next_to_no_bending_is_the_catenary():
    """Stretch varies along it, and is constant in an element: of second order."""
    (coarse, _, _), (fine, _, _) = (catenary.hang("rod", n) for n in (8, 16))
    assert fine["sag_error"] < 2e-5 and coarse["sag_error"] / fine["sag_error"] > 3.3
    assert fine["iterations"] <= 5 and not fine["failed_iterations"]


def test_helix_and_rings_buckle_at_their_closed_forms():
    record = rings.main(elements=32)
    assert record["helix_error"] < 1e-5 and record["helix_iterations"] <= 5
    assert abs(record["michell_error"]) < 1e-3 and abs(record["overcurved_error"]) < 5e-3


def test_helix_of_edges():
    (coarse, _), (fine, _) = (rings.helix(fl.elements.DiscreteRod(), n) for n in (16, 32))
    assert fine < 6e-3 and coarse / fine > 3.4


def swung(formulation: fl.elements.BeamFormulation, cells: int) -> np.ndarray:
    """Tip of an arc that falls from its clamp, out of its plane: it bends and twists."""
    own = fl.Section.rectangle(0.02, 0.02, fl.Material(1e8, 0.3, 1000.0))
    scene = fl.Scene(gravity=(0, -3.0, -9.81))
    arc = fl.Rod.curve(
        lambda s: (np.sin(s), 0, 1 - np.cos(s)), own, cells=cells, formulation=formulation
    )
    rod = scene.add(arc)
    scene.add(fl.Clamp(rod.point("start")))
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.15, step=1e-3)
    return result.position(rod.point("end"))[-1]


def test_edges_swing_as_the_cubic_does():
    """Axes of edges go along with them from step to step, and velocities with these."""
    exact = swung(fl.elements.KirchhoffRod(), 20)
    coarse, fine = (np.linalg.norm(swung(fl.elements.DiscreteRod(), n) - exact) for n in (10, 20))
    assert fine < 6e-4 and coarse / fine > 3


def test_edges_that_are_turned_go_round():
    """A quarter, all in one plane with the axis: positions have no spins across their edges."""
    scene, own = fl.Scene(), fl.Section.rectangle(0.02, 0.02, fl.Material(1e8, 0.3, 1000.0))
    ends, edges = ((-0.5, 0, 0), (0.5, 0, 0)), fl.elements.DiscreteRod()
    rod = scene.add(fl.Rod.straight(*ends, own, cells=8, formulation=edges))
    rod.add_velocity(omega=(0, 0, 0.5 * np.pi), about=(0.0, 0, 0))
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=1.0, step=1e-2)
    np.testing.assert_allclose(result.position(rod.point("end"))[-1], (0, 0.5, 0), atol=2e-4)


def test_rigid_motion_changes_no_forces_or_matrix_of_edges():
    """1000 rad about an oblique axis."""
    own = fl.Section.from_stiffness([90.0, 40, 30, 8, 6, 7])
    arc = fl.Rod.curve(
        lambda s: (3 * s, 0.4 * s * s, np.sin(s)),
        own,
        cells=4,
        formulation=fl.elements.DiscreteRod(),
    )
    springs = arc.model.assemble([arc.model]).further_terms[0]
    twists = 0.2 * np.random.default_rng(0).normal(size=(5, 6))
    H = lie.se3_retract(arc.frames, twists)
    turned = H @ lie.so3_exp(1000 * np.array([0.6, 0.0, 0.8])).T
    found = []
    for rows in (H, turned):
        forces = np.zeros((5, 6))
        springs.add_forces(rows, forces)
        springs.reset_stress(rows)
        found.append((forces, springs.tangent(rows, forces)))
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * np.abs(one).max())


@each
def test_a_kink_of_half_a_turn_is_refused(name):
    with pytest.raises(ValueError, match="the line goes back on itself"):
        points = (0, 0, 0), (1, 0, 0), (0, 0, 0)
        fl.Rod.polyline(points, section(10.0), cells=2, formulation=KINDS[name])


def test_corners_of_discrete_rods_are_refused():
    with pytest.raises(ValueError, match="one smooth line"):
        points = (0, 0, 0), (1, 0, 0), (1, 1, 0)
        fl.Rod.polyline(points, section(10.0), cells=2, formulation=fl.elements.DiscreteRod())


# --- an axis off the centroid ---

SOLID = fl.Section.rectangle(0.06, 0.04, fl.Material(2e11, 0.3, 7800.0))
OFF = [(0.03, 0.0), (-0.03, 0.02), (0.03, -0.05)]


def held_off(off: tuple[float, float], cells: int, gravity=(0.0, 0.0, 0.0)):
    """A cantilever whose centroid runs along x, a body on it at its free end, and its stiffness."""
    scene, ends = fl.Scene(gravity=gravity), ((0.0, *off), (1.0, *off))
    options = {"cells": cells, "up": (0, 0, 1)}
    rod = scene.add(fl.Rod.straight(*ends, SOLID.offset(*off), **options))
    body = scene.add(fl.RigidBody(2.0, (2e-3, 1e-3, 1e-3), position=(1, 0, 0)))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.joints.RigidLink(rod.point("end"), body.point("centre")))
    return scene, body, SOLID.stiffness[4, 4]


def loaded_off(off: tuple[float, float], cells: int, across: float) -> np.ndarray:
    """Where the body is, far from the start, under loads that pull and bend it, and twist it."""
    scene, body, EI = held_off(off, cells, (0.0, -9.81, 30.0 * across))
    force, moment = (EI, 2 * EI, 3 * EI * across), (0.4 * EI * across, 0, 0)
    scene.add(fl.PointLoad(body.point("centre"), force, moment=moment))
    return fl.statics(scene, load_steps=8).frames[-1, -1]


@pytest.mark.parametrize("off", OFF)
def test_an_axis_anywhere_in_the_section_is_the_same_rod(off):
    found, expected = (loaded_off(position, 4, 1.0) for position in (off, (0.0, 0.0)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


def test_bending_about_an_axis_off_the_centroid_is_of_fourth_order():
    exact = loaded_off((0.0, 0.0), 32, 0.0)
    coarse, fine = (np.abs(loaded_off(OFF[0], n, 0.0) - exact).max() for n in (4, 8))
    assert fine < 1e-4 and coarse / fine > 13


@pytest.mark.parametrize("off", OFF)
def test_vibrations_of_a_rod_do_not_depend_on_its_axis(off):
    expected = fl.vibrations(held_off((0.0, 0.0), 4)[0], 8).frequencies
    np.testing.assert_allclose(fl.vibrations(held_off(off, 4)[0], 8).frequencies, expected, 1e-9)


@pytest.mark.parametrize(("bent", "twisted"), [(False, 2.0), (True, 0.0), (True, 2.0)])
def test_curved_and_twisted_axes_off_the_centroid_are_those_of_beams(bent, twisted):
    """Of beams as good as without shear, on finer meshes; of second order."""
    D = SOLID.stiffness.copy()
    D[[1, 2], [1, 2]] *= 1e5
    own = fl.Section.from_stiffness(D).offset(0.06, -0.03)

    def tip(kind, cells):
        scene = fl.Scene()
        line = (lambda s: (np.sin(s), 1 - np.cos(s), 0)) if bent else (lambda s: (s, 0, 0))
        rod = scene.add(
            kind.curve(line, own, cells=cells, up=fl.sections.Twisted(lambda s: twisted * s))
        )
        scene.add(fl.Clamp(rod.point("start")))
        scene.add(fl.PointLoad(rod.point("end"), (100.0, 2.0, 3.0), moment=(10, 0, 0)))
        result = fl.statics(scene)
        return result.position(rod.point("end"))[-1] - rod.point("end").position

    exact = tip(fl.Beam, 64)
    coarse, fine = (np.linalg.norm(tip(fl.Rod, n) - exact) for n in (8, 16))
    assert fine < 2e-3 * np.linalg.norm(exact) and coarse / fine > 3.5


def test_a_rod_off_its_axis_that_tumbles_keeps_energy_and_momentum():
    rod = fl.Rod.straight((0, 0, 0), (0.5, 0, 0), SOLID.offset(0.03, 0.02), cells=3)
    rod.add_velocity(omega=(3.0, 40.0, 20.0), about=(0.1, 0, 0))
    scene = fl.Scene()
    scene.add(rod)
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3)
    np.testing.assert_allclose(result.total_energy, result.total_energy[0], rtol=1e-11)
    assert result.momentum_error < 1e-11 and result.angular_momentum_error < 1e-11


def test_a_shear_centre_off_the_tension_centre_is_named(caplog):
    """``GJ + GA d²`` instead of ``GJ``; where the axis is does not matter."""
    D = np.diag([1e6, 4e5, 4e5, 0, 0, 0]) + np.diag([0, 0, 0, 50.0, 100, 100])
    tension, shear = np.diag([1e6, 0, 0, 0, 100.0, 100.0]), np.diag([0, 4e5, 4e5, 50.0, 0, 0])
    d = 0.02
    T = np.eye(6)
    T[1, 3], T[2, 3] = 0.0, -d
    apart = fl.Section.from_stiffness(tension + T.T @ shear @ T).offset(0.3, 0.1)
    for section in (fl.Section.from_stiffness(D).offset(0.3, 0.1), apart):
        caplog.clear()
        fl.Rod.straight((0, 0, 0), (1, 0, 0), section, cells=1)
        assert ("4.2 times as stiff in torsion" in caplog.text) == (section is apart)


def test_stretch_that_bends_is_refused():
    offset = fl.Section.rectangle(0.02, 0.01, fl.Material(2e11, 0.3, 7800.0)).offset(0.01, 0)
    with pytest.raises(ValueError, match="must not couple stretch"):
        fl.Rod.straight(
            (0, 0, 0), (1, 0, 0), offset, cells=2, formulation=fl.elements.DiscreteRod()
        )


def test_edges_that_tumble_keep_energy_and_momentum():
    """Spins go along with edges, and accelerations are those of positions in any axes."""
    own = fl.Section.from_stiffness([1e4] * 3 + [1.0] * 3, mass=1.0, polar=1e-4)
    line, edges = (lambda s: (s, 0.2 * s**3, 0.5 * s * s)), fl.elements.DiscreteRod()
    rod = fl.Rod.curve(line, own, cells=10, formulation=edges)
    rod.add_velocity(omega=(3.0, 4.0, 2.0), about=rod.point(5))
    scene = fl.Scene()
    scene.add(rod)
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=1.0, step=1e-3)
    np.testing.assert_allclose(result.total_energy, result.total_energy[0], rtol=1e-4)
    assert result.momentum_error < 2e-5 and result.angular_momentum_error < 2e-3
