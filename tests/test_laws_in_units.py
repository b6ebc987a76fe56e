"""Laws of bodies and schemes, in closed form and alike in five systems of units."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import fem_lie as fl
from tests.closed_loop import closed_loop
from tests.unit_systems import METRES, OTHER_SYSTEMS, UNIT_SYSTEMS, UnitSystem

each = pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
E, NU, RHO = 2e11, 0.3, 7800.0
FORMULATIONS = [
    fl.elements.GeodesicBeam(),
    fl.elements.DirectorBeam(1),
    fl.elements.DirectorBeam(2),
    fl.elements.KirchhoffRod(),
]
SHELLS = {
    "quadrilateral": ("quadrilateral", fl.elements.HellingerReissner(), False),
    "six parameters": ("quadrilateral", fl.elements.HellingerReissner(), True),
    "triangle": ("triangle", fl.elements.HellingerReissner(), False),
}


def alike(law: Callable[..., np.ndarray], u: UnitSystem, *args: object, part: float) -> np.ndarray:
    """What a law gives in metres, after it was found to give the same in these units."""
    found, expected = law(u, *args), law(METRES, *args)
    np.testing.assert_allclose(found, expected, rtol=0, atol=part * np.abs(expected).max())
    return found


def steel(u: UnitSystem, nu: float = NU) -> fl.Material:
    return fl.Material(u.stress(E), nu, u.density(RHO))


def bar(u: UnitSystem, side: float) -> fl.Section:
    return fl.Section.rectangle(u.length(side), u.length(side), steel(u))


# --- statics ---


@cache
def cantilever(u: UnitSystem, kind: int, bent: bool) -> np.ndarray:
    """Tip of a beam of length 1 over its length: a circle, or a small load across."""
    scene, I = fl.Scene(), 0.01**4 / 12  # noqa: E741
    ends = u.length([0, 0, 0]), u.length([1, 0, 0])
    section, cells = bar(u, 0.01), 8 if bent else 1
    beam = scene.add(fl.Beam.straight(*ends, section, cells=cells, formulation=FORMULATIONS[kind]))
    scene.add(fl.Clamp(beam.point("start")))
    moment = u.moment([0, 0, np.pi * E * I if bent else 0.0])
    force = u.force([0, 0.0 if bent else 3e-6 * E * I, 0])
    scene.add(fl.PointLoad(beam.point("end"), force=force, moment=moment))
    return u.inverse.length(fl.statics(scene).position(beam.point("end"))[-1])


@pytest.mark.parametrize("kind", range(4), ids=[str(f) for f in FORMULATIONS])
@each
def test_a_beam_bends_to_a_semicircle(u, kind):
    tip = alike(cantilever, u, kind, True, part=1e-8)
    bound = 1e-9 if kind == 0 else 5e-3  # polygons, and plain interpolation of 22.5°
    np.testing.assert_allclose(tip, [0, 2 / np.pi, 0], atol=bound)


@pytest.mark.parametrize("kind", range(4), ids=[str(f) for f in FORMULATIONS])
@each
def test_one_element_is_timoshenko(u, kind):
    deflection = alike(cantilever, u, kind, False, part=1e-9)[1]
    shear = bar(METRES, 0.01).stiffness[1, 1]
    sheared = kind < 3  # Kirchhoff's is not
    exact = 1e-6 + 3e-6 * sheared * E * 0.01**4 / 12 / shear
    np.testing.assert_allclose(deflection, exact, rtol=1e-6)


def plate(u: UnitSystem, kind: str, nu: float, cells: tuple[int, int], width: float) -> fl.Shell:
    """Of length 2, with cells that are not rectangles."""
    cell, formulation, drilling = SHELLS[kind]

    def position(a: float, b: float) -> np.ndarray:
        bulge = 0.1 * np.sin(np.pi * a) * np.sin(np.pi * b)
        return u.length([2.0 * (a + bulge), width * (b - bulge), 0.0])

    layer = fl.ShellSection.layer(u.length(0.02), steel(u, nu))
    mesh = fl.mesh.parametric_surface(position, cells, cell=cell)
    return fl.Shell(mesh, layer, formulation=formulation, drilling=drilling, name="plate")


@cache
def pulled(u: UnitSystem, kind: str) -> np.ndarray:
    """Places, and displacements over the strain, of a plate in uniform tension."""
    strain, scene = 1e-6, fl.Scene()
    shell = scene.add(plate(u, kind, NU, (3, 2), 1.0))
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.roller("00", (0, 0, 1))
    force = u.line_load([strain * E * 0.02, 0, 0])
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=force))
    result = fl.statics(scene)
    moved = result.frames[-1][:, 0] - result.info.undeformed[:, 0]
    return u.inverse.length([result.info.undeformed[:, 0], moved / strain])


@pytest.mark.parametrize("kind", SHELLS)
@each
def test_a_membrane_patch_is_exact(u, kind):
    x, moved = alike(pulled, u, kind, part=1e-8)
    np.testing.assert_allclose(moved, x * [1, -NU, 0], atol=1e-5)  # strains of 1e-6 have squares


@cache
def rolled(u: UnitSystem, kind: str) -> np.ndarray:
    """End of a strip under an end moment that bends it to a quarter of a circle."""
    scene, moment = fl.Scene(), np.pi / 4 * E * 0.02**3 / 12
    shell = scene.add(plate(u, kind, 0.0, (8, 1), 0.2))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", moment=u.force([0, -moment, 0])))
    return u.inverse.length(fl.statics(scene).position(shell.point("11"))[-1])


@pytest.mark.parametrize("kind", SHELLS)
@each
def test_a_strip_bends_to_a_quarter_of_a_circle(u, kind):
    end = alike(rolled, u, kind, part=1e-7)
    np.testing.assert_allclose(end, [4 / np.pi, 0.2, 4 / np.pi], atol=1e-2)


@cache
def blown(u: UnitSystem) -> np.ndarray:
    """Middle of a clamped plate under a pressure that deflects it by several thicknesses."""
    scene = fl.Scene()
    shell = scene.add(plate(u, "quadrilateral", NU, (6, 4), 1.0))
    shell.clamp("a=0")
    shell.clamp("a=1")
    scene.add(fl.loads.SurfacePressure(shell, u.stress(3e5), u.of([0, 0, 1e5], -2, 1, -2)))
    result = fl.statics(scene)
    return u.inverse.length(result.frames[-1][:, 0] - result.info.undeformed[:, 0])


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_pressure_blows_a_plate_up_alike(u):
    found = alike(blown, u, part=1e-7)
    assert found[:, 2].max() > 0.02


# --- stability ---


def column(u: UnitSystem) -> tuple[fl.Scene, fl.Beam]:
    """Clamped at its foot under Euler's load."""
    scene = fl.Scene()
    ends = u.length([0, 0, 0]), u.length([0, 0, 2])
    beam = scene.add(fl.Beam.straight(*ends, bar_of_column(u), cells=8, up=(1, 0, 0)))
    scene.add(fl.Clamp(beam.point("start")))
    euler = (np.pi / 4) ** 2 * E * 0.01 * 0.02**3 / 12
    scene.add(fl.PointLoad(beam.point("end"), force=u.force([0, 0, -euler])))
    return scene, beam


def bar_of_column(u: UnitSystem) -> fl.Section:
    return fl.Section.rectangle(u.length(0.01), u.length(0.02), steel(u))


@cache
def eulers_loads(u: UnitSystem) -> np.ndarray:
    """By eigenvalues, and where the path crosses it."""
    scene, _ = column(u)
    point = fl.follow_path(scene, 0.5).bifurcations[0]
    return np.array([*fl.buckling(scene, 3).factors, point.factor])


@each
def test_a_column_buckles_at_eulers_load(u):
    """The weaker plane first."""
    found = alike(eulers_loads, u, part=1e-6)
    np.testing.assert_allclose(found, [0.25, 1.0, 2.25, 0.25], rtol=1e-2)


@cache
def snap(u: UnitSystem) -> np.ndarray:
    """Limit loads of two bars at an angle of 0.2 that are hinged to each other, over EA."""
    scene = fl.Scene()
    foot, head = u.length([np.cos(0.2), 0, 0]), u.length([0, 0, np.sin(0.2)])
    left = scene.add(fl.Beam.straight(-foot, head, bar(u, 0.1), cells=1, up=(0, 1, 0)))
    right = scene.add(fl.Beam.straight(foot, head, bar(u, 0.1), cells=1, up=(0, 1, 0)))
    for point in (left.point("start"), right.point("start")):
        scene.add(fl.joints.Revolute(fl.ground(), point, axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(left.point("end"), right.point("end"), axis=(0, 1, 0)))
    load = u.force(E * 0.01 * 0.02)
    scene.add(fl.PointLoad(left.point("end"), force=(0, 0, -load)))
    return np.array([p.factor for p in fl.follow_path(scene, 1.0).limits]) * 0.02


@each
def test_two_bars_snap_through_at_their_limit_load(u):
    found = alike(snap, u, part=1e-6)
    limit = 2 * (1 - np.cos(0.2) ** (2 / 3)) ** 1.5
    np.testing.assert_allclose(found, [limit, -limit], rtol=1e-3)


# --- vibrations ---


@cache
def frequencies(u: UnitSystem) -> np.ndarray:
    """Of a cantilever, and of a simply supported square plate; of a free bar."""
    rod, slab, free = fl.Scene(), fl.Scene(), fl.Scene()
    ends = u.length([0, 0, 0]), u.length([1, 0, 0])
    beam = rod.add(fl.Beam.straight(*ends, bar(u, 0.005), cells=8))
    rod.add(fl.Clamp(beam.point("start")))
    layer = fl.ShellSection.layer(u.length(0.005), steel(u))
    shell = slab.add(
        fl.Shell(fl.mesh.parametric_surface(lambda a, b: u.length([a, b, 0]), (8, 8)), layer)
    )
    for edge in ("a=0", "a=1", "b=0", "b=1"):
        shell.hinge(edge)
    free.add(fl.Beam.straight(*ends, bar(u, 0.005), cells=8))
    found = [fl.vibrations(scene, 7).frequencies for scene in (rod, slab, free)]
    return u.inverse.rate(np.concatenate([found[0][:2], found[1][:2], found[2]]))


@each
def test_small_vibrations(u):
    found = alike(frequencies, u, part=1e-6)
    bending = np.sqrt(E * 0.005**2 / (12 * RHO))
    rod = 3.51601527 * bending
    slab = np.pi**2 * bending / np.sqrt(1 - NU**2)
    np.testing.assert_allclose(found[:2], rod, rtol=1e-3)
    np.testing.assert_allclose(found[2:4] / [2 * slab, 5 * slab], 1.0, atol=7e-2)  # 8x8 cells
    np.testing.assert_array_equal(found[4:10], 0.0)  # rigid motions
    np.testing.assert_allclose(found[10], 22.3732854 * bending, rtol=1e-3)


@cache
def sliding_bar(u: UnitSystem, drag: float) -> fl.stability.Modes:
    """A short beam on a prismatic joint: stiff, and held by lengths and angles."""
    scene, ends = fl.Scene(), (u.length([0, 0, 0]), u.length([1, 0.3, 0.2]))
    damping = fl.sections.Damping(u.rate(drag))
    beam = scene.add(fl.Beam.straight(*ends, bar(u, 0.05), cells=4, damping=damping))
    scene.add(fl.joints.Prismatic(fl.ground(), beam.point("start"), at=ends[0], axis=(1, 0, 0)))
    return fl.vibrations(scene, 6)


@each
def test_drag_moves_eigenvalues_along_circles(u):
    """With damping in proportion to mass s² + c s + ω² = 0: −c/2 ± …, and 0 and −c if ω = 0."""
    free, damped = sliding_bar(u, 0.0), sliding_bar(u, 2.0)
    assert damped.residuals.max() < 1e-10
    s, ω = (u.inverse.rate(1.0) * modes.eigenvalues for modes in (damped, free))
    s, still, ω = s[2:], s[:2], np.abs(ω[1:5])
    np.testing.assert_allclose(still, [0.0, -2.0], rtol=1e-9)
    np.testing.assert_allclose(s.real, -1.0, rtol=0, atol=1e-9 * ω.max())
    np.testing.assert_allclose(np.abs(s), ω, rtol=1e-9)


# --- motion ---


SCHEMES = {
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
}


@cache
def conserved(u: UnitSystem, scheme: str) -> tuple[np.ndarray, float, float]:
    step = u.time(5e-4)
    result = SCHEMES[scheme].run(closed_loop(u), duration=20 * step, step=step, progress=False)
    return u.inverse.frame(result.frames), result.balance_error, result.momentum_error


@pytest.mark.parametrize("scheme", SCHEMES)
@each
def test_a_closed_loop_conserves(u, scheme):
    (frames, balance, momentum), (expected, _, _) = conserved(u, scheme), conserved(METRES, scheme)
    np.testing.assert_allclose(frames, expected, rtol=0, atol=1e-9)
    assert balance <= 1e-9 and momentum <= 1e-9


@cache
def chosen(u: UnitSystem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    steps = fl.schemes.AdaptiveStep(u.velocity(1e-3))
    result = fl.GeneralisedAlpha().run(closed_loop(u), duration=u.time(0.02), step=steps)
    sizes, frames = u.inverse.time(result.steps.sizes), u.inverse.frame(result.frames[-1])
    return sizes, frames, result.iterations


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_steps_are_chosen_alike(u):
    """And made alike: of multipliers, too, is known how large a correction is."""
    for found, expected in zip(chosen(u), chosen(METRES), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


# --- sections and results ---


@cache
def angle_section(u: UnitSystem) -> np.ndarray:
    shape = fl.sections.SectionShape.l_section(*u.length([0.1, 0.15, 0.012]))
    return u.inverse.section_stiffness(shape.section(steel(u)).stiffness)


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_warping_is_solved_alike(u):
    found, expected = angle_section(u), angle_section(METRES)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(found / scale, expected / scale, rtol=0, atol=1e-9)


@cache
def carried(u: UnitSystem) -> np.ndarray:
    """Forces and moments in a bent bar."""
    scene = fl.Scene()
    ends = u.length([0, 0, 0]), u.length([1, 0, 0])
    beam = scene.add(fl.Beam.straight(*ends, bar(u, 0.02), cells=4))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=u.force([100.0, 2.0, 3.0])))
    found = fl.post.section_forces(fl.statics(scene), beam, scene)
    forces, moments = u.inverse.force(found.cut_forces), u.inverse.moment(found.cut_moments)
    return np.concatenate([forces.ravel(), moments.ravel()])


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_section_forces_are_alike(u):
    alike(carried, u, part=1e-8)
