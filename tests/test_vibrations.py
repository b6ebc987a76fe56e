"""Small vibrations against closed forms, characteristic equations and a collocation reference."""

import re

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import expm
from scipy.optimize import brentq

import fem_lie as fl
from demos.rotating_beam import flapping
from fem_lie import lie
from fem_lie.lie.node_types import inertia
from fem_lie.linear.spectra.pencil import Pencil
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.system import System
from fem_lie.system.small_motions import linearised
from tests.random_scenes import HELD, random_scene
from tests.scene_builder import build

E, RHO = 2e11, 7800.0
STEEL = fl.Material(E, 0.3, RHO)
G = 9.81


def beam(length=1.0, width=0.02, height=0.04, cells=16, clamped=True, **options):
    scene = fl.Scene()
    section = fl.Section.rectangle(width, height, STEEL)
    body = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells, **options))
    if clamped:
        scene.add(fl.Clamp(body.point("start")))
    return scene, body


def timoshenko(section: fl.Section, plane: int, length: float, count: int) -> np.ndarray:
    """Clamped-free frequencies: zeros of the determinant of the transfer of (w, φ, M, Q)."""
    D, mass_matrix = np.diag(section.stiffness), np.diag(section.inertia)
    EI, GA, rotary = (D[4], D[2], mass_matrix[3]) if plane == 2 else (D[5], D[1], mass_matrix[2])
    unit = np.sqrt(EI / mass_matrix[0]) / length**2
    scales = np.array([1, 1 / length, EI / length**2, EI / length**3])

    def determinant(omega: float) -> float:
        A = np.zeros((4, 4))
        A[0, 1], A[0, 3], A[1, 2] = 1, 1 / GA, 1 / EI
        A[2, 1], A[2, 3], A[3, 0] = -rotary * omega**2, -1, -mass_matrix[0] * omega**2
        return float(np.linalg.det(expm(length * A * scales / scales[:, np.newaxis])[2:, 2:]))

    return zeros(determinant, unit, count)


def zeros(function, unit: float, count: int) -> np.ndarray:
    found, x = [], 0.3 * unit
    while len(found) < count:
        if function(x) * function(x + 0.7 * unit) < 0:
            found.append(brentq(function, x, x + 0.7 * unit, xtol=1e-12 * x))
        x += 0.7 * unit
    return np.array(found)


@pytest.mark.parametrize(("length", "bound"), [(0.2, 4e-4), (1.0, 1e-4), (8.0, 1e-4)])
def test_clamped_beam(length, bound):
    """Bending in two planes, torsion and extension of a stubby to a slender Timoshenko beam.

    The largest error is that of short waves in the plane of the section's width, (kr)² θ²/10.
    """
    scene, _ = beam(length)
    section = fl.Section.rectangle(0.02, 0.04, STEEL)
    D, mass_matrix = np.diag(section.stiffness), np.diag(section.inertia)
    waves = (2 * np.arange(6) + 1) * np.pi / (2 * length)
    families = [
        timoshenko(section, 2, length, 6),
        timoshenko(section, 3, length, 6),
        waves * np.sqrt(D[3] / (mass_matrix[2] + mass_matrix[3])),
        waves * np.sqrt(D[0] / mass_matrix[0]),
    ]
    modes = fl.vibrations(scene)
    expected = np.sort(np.concatenate(families))[:6]
    np.testing.assert_allclose(modes.frequencies, expected, rtol=bound)
    assert not modes.damping_ratios.any()
    assert modes.residuals.max() < 1e-8


def test_orders_of_torsion_and_extension():
    """Errors of frequencies fall with the fourth power of the element size; rods have none so."""
    section = fl.Section.rectangle(0.1, 0.1, STEEL)
    D, mass_matrix = np.diag(section.stiffness), np.diag(section.inertia)
    wave = np.pi / 2
    speeds = np.sqrt([D[3] / (2 * mass_matrix[2]), D[0] / mass_matrix[0]])
    errors = []
    for cells in (4, 8):
        scene, _ = beam(width=0.1, height=0.1, cells=cells)
        found = fl.vibrations(scene, 12).frequencies
        errors.append([np.abs(found / omega - 1).min() for omega in wave * speeds * [3, 1]])
    orders = np.log2(np.divide(*errors))
    assert (orders > 3.8).all(), (orders, errors)


def test_orders_of_bending():
    """Sixth between pins, where nothing but the wave counts; fourth with a clamped end."""
    errors = []
    for cells in (4, 8):
        scene, body = beam(20.0, cells=cells, clamped=False)
        for point in (body.point("start"), body.point("end")):
            scene.add(fl.joints.Revolute(point, fl.ground(), axis=(0, 1, 0)))
        pinned = fl.vibrations(scene, 4).frequencies
        section = fl.Section.rectangle(0.02, 0.04, STEEL)
        D, mass_matrix, wave = np.diag(section.stiffness), np.diag(section.inertia), np.pi / 10.0
        # the slow branch of Timoshenko's dispersion relation
        b = mass_matrix[0] * (D[4] * wave**2 + D[2]) + mass_matrix[3] * D[2] * wave**2
        c = D[2] * D[4] * wave**4
        exact = np.sqrt(2 * c / (b + np.sqrt(b**2 - 4 * mass_matrix[0] * mass_matrix[3] * c)))
        clamped = fl.vibrations(beam(0.5, cells=cells)[0], 6).frequencies
        third = timoshenko(section, 3, 0.5, 3)[2]
        errors.append([np.abs(pinned / exact - 1).min(), np.abs(clamped / third - 1).min()])
    orders = np.log2(np.divide(*errors))
    assert orders[0] > 5.7 and orders[1] > 3.7, (orders, errors)


def test_inertia_of_the_beam_element_is_that_of_the_rod():
    """Energy, momentum and angular momentum of any rigid motion of a straight beam are exact."""
    section = fl.Section.rectangle(0.1, 0.2, STEEL)
    scene, position, axis = fl.Scene(), np.array([1.0, 2, 0]), np.array([2.0, -1, 1])
    body = scene.add(fl.Beam.straight(position, position + axis, section, cells=3))
    omega, shift = np.array([1.0, 2, 3]), np.array([0.3, -0.2, 0.5])
    body.add_velocity(omega=omega, about=(0, 0, 0))
    body.add_velocity(shift)
    system = System(scene, dynamics=True)
    work = np.empty((2, system.count, 4, 3))
    energy, *momenta = inertia.invariants(
        system.kinds, system.frames, system.velocities[: system.count], *system.inertia, *work
    )
    length, mass_matrix = np.linalg.norm(axis), np.diag(section.inertia)
    mass, R = mass_matrix[0] * length, body.frames[0, 1:].T
    across = mass * length**2 / 12
    J = (
        R
        @ np.diag([mass_matrix[2] + mass_matrix[3], mass_matrix[3], mass_matrix[2]])
        @ R.T
        * length
    )
    J += across * (np.eye(3) - np.outer(axis, axis) / length**2)
    centre = position + axis / 2
    velocity = shift + np.cross(omega, centre)
    angular = mass * np.cross(centre, velocity) + J @ omega
    expected = 0.5 * mass * velocity @ velocity + 0.5 * omega @ J @ omega
    assert energy == pytest.approx(expected, rel=1e-13)
    np.testing.assert_allclose(momenta, [*(mass * velocity), *angular], rtol=1e-12)


@pytest.mark.parametrize("speed", [0.0, 2.0, 10.0])
def test_rotating_beam(speed):
    """Flap and lag of a slender beam on a hub, ω_lag² = ω_flap² − Ω², by Chebyshev collocation."""
    length = 10.0
    scene, body = beam(length)
    D, mass = np.diag(body.model.stiffness[0]), body.model.density[0, 0, 0]
    flap, lag = (np.sqrt(D[k] / mass) / length**2 for k in (4, 5))
    spin = speed * lag
    across = flap * flapping(spin / flap, 5)
    within = np.sqrt((lag * flapping(speed, 5)) ** 2 - spin**2)
    expected = np.sort([*across, *within])[:6]
    modes = fl.vibrations(scene, spin=(0, 0, spin))
    # slenderness 250: shear and rotary inertia are 1e-4 of the last
    np.testing.assert_allclose(modes.frequencies, expected, rtol=4e-4)
    np.testing.assert_allclose(modes.damping_ratios, 0.0, atol=1e-9)


def test_reference_of_the_rotating_beam():
    """The stationary beam, and Wright et al. (J. Appl. Mech. 49 (1982) 197), hub radius 0."""
    np.testing.assert_allclose(flapping(0.0, 3), [3.51602, 22.0345, 61.6972], rtol=1e-5)
    np.testing.assert_allclose(flapping(10.0, 3), [11.2023, 33.6404, 74.6493], rtol=1e-5)


def test_steady_rotation_stretches():
    """``u = tan(kL)/k − L`` with ``k² = ρΩ²/E``: centrifugal force at the stretched position."""
    scene, body = beam()
    spin = 300.0
    k = spin * np.sqrt(RHO / E)
    result = fl.statics(scene, spin=(0, 0, spin))
    extension = result.position(body.point("end"))[-1, 0] - 1.0
    assert extension == pytest.approx(np.tan(k) / k - 1.0, rel=1e-6)


def test_steady_rotation_converges_quadratically():
    """A hanging, inclined beam; both iterations arrive at the same position."""
    tips = []
    for carried in (True, False):
        scene = fl.Scene(gravity=(0, 0, -G))
        section = fl.Section.rectangle(0.005, 0.01, STEEL)
        body = scene.add(fl.Beam.straight((0.1, 0, 0), (1.0, 0.3, 0.5), section, cells=8))
        scene.add(fl.Clamp(body.point("start")))
        result = fl.statics(
            scene,
            spin=(0, 0, 10),
            load_steps=2,
            newton=fl.schemes.Newton(linearised_stress=carried),
        )
        assert np.diff(result.iterations, prepend=0).max() <= 6
        tips.append(result.position(body.point("end"))[-1])
    np.testing.assert_allclose(*tips, rtol=0, atol=1e-9)


def test_stiffness_of_steady_motion_is_the_derivative_of_the_residual():
    scene, body = beam(cells=3, damping=fl.sections.Damping(mass=2.0))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("end")))
    system = System(scene, dynamics=True)
    rng = np.random.default_rng(3)
    H, weights = system.frames.copy(), rng.normal(size=system.m)
    n = system.count
    H[:n] = lie.se3_retract(H[:n], 0.2 * rng.normal(size=(n, 6)))
    spin, about = rng.normal(size=(2, 3))

    def residual(H):
        v = np.empty((n, 6))
        v[:, :3] = np.einsum("nij,nj->ni", H[:n, 1:], 1e3 * np.cross(spin, H[:n, 0] - about))
        v[:, 3:] = H[:n, 1:] @ (1e3 * spin)
        r = np.empty(system.size)
        system.residual(fl.extend.TimeState(H, v, np.zeros((n, 6)), weights), np.ones(system.m), r)
        return r[: 6 * n], v

    _, v = residual(H)
    system.elastic.reset_stress(H)
    blocks = linearised(system, H, v, weights)[2]
    dense = np.zeros((n, 6, n, 6))
    rows = np.repeat(np.arange(n), np.diff(system.kkt.indptr))
    dense[rows, :, system.kkt.indices] = blocks
    for _ in range(4):
        h = rng.normal(size=(n, 6))
        h[system.held] = 0.0
        ahead, back = H.copy(), H.copy()
        ahead[:n], back[:n] = (lie.se3_retract(H[:n], s * h) for s in (1e-6, -1e-6))
        numeric = (residual(ahead)[0] - residual(back)[0]) / 2e-6
        product = np.einsum("iajb,jb->ia", dense, h)
        product[system.held] = 0.0
        np.testing.assert_allclose(product.ravel(), numeric, atol=1e-7 * np.abs(numeric).max())


@pytest.mark.parametrize("load", [-0.9, 0.5, 20.0])
def test_axial_force(load):
    """Pinned beam-column to string: ``ω_k² = ω_k0² (1 + N/(k² P_cr))``."""
    scene, body = beam(20.0, clamped=False)
    for point in (body.point("start"), body.point("end")):
        scene.add(fl.joints.Revolute(point, fl.ground(), axis=(0, 1, 0)))
    EI, mass = body.model.stiffness[0, 4, 4], body.model.density[0, 0, 0]
    wave = np.pi * np.arange(1, 4) / 20.0
    critical = EI * wave[0] ** 2
    scene.add(fl.loads.PreStress(body, (load * critical, 0, 0, 0, 0, 0)))
    expected = np.sqrt((EI * wave**4 + load * critical * wave**2) / mass)
    found = fl.vibrations(scene, 8).frequencies
    nearest = found[np.abs(found[:, np.newaxis] - expected).argmin(axis=0)]
    # 16 elements: θ⁴/240 of the string with θ = 3π/16
    np.testing.assert_allclose(nearest, expected, rtol=6e-4)


def test_buckled_column_is_unstable(caplog):
    scene, body = beam(20.0)
    critical = body.model.stiffness[0, 5, 5] * (np.pi / 40) ** 2
    scene.add(fl.PointLoad(body.point("end"), force=(-1.1 * critical, 0, 0)))
    with pytest.warns(fl.stability.UnstableEquilibriumWarning):
        modes = fl.vibrations(scene, 2)
    assert modes.unstable.tolist() == [True, False] or modes.unstable.tolist() == [False, True]
    assert modes.damping_ratios[modes.unstable] == pytest.approx(-1.0)
    assert "unstable" in caplog.text and "grows" in str(modes)


INTERVALS = ((4, 5), (7, 8), (10.5, 11.5))


def test_free_beam():
    """Six rigid motions, then ``cosh β cos β = 1``."""
    scene, body = beam(10.0, clamped=False)
    modes = fl.vibrations(scene, 10)
    assert not modes.eigenvalues[:6].any()
    beta = np.array([brentq(lambda x: np.cos(x) - 1 / np.cosh(x), *b) for b in INTERVALS])
    D, mass = np.diag(body.model.stiffness[0]), body.model.density[0, 0, 0]
    expected = [np.sqrt(D[k] / mass) * (beta / 10.0) ** 2 for k in (4, 5)]
    np.testing.assert_allclose(modes.frequencies[6:], np.sort(np.ravel(expected))[:4], rtol=2e-4)


def test_cantilever_of_two_bodies_is_the_cantilever_of_one():
    """Joints and rigid links: shapes are those of all nodes."""
    whole, body = beam(1.0, cells=8)
    expected = fl.vibrations(whole, 6)
    section = fl.Section.rectangle(0.02, 0.04, STEEL)
    for link in (True, False):
        scene = fl.Scene()
        parts = [
            scene.add(fl.Beam.straight((x, 0, 0), (x + 0.5, 0, 0), section, cells=4))
            for x in (0.0, 0.5)
        ]
        scene.add(fl.Clamp(parts[0].point("start")))
        join = fl.joints.RigidLink if link else fl.joints.Fixed
        scene.add(join(parts[0].point("end"), parts[1].point("start")))
        modes = fl.vibrations(scene, 6)
        np.testing.assert_allclose(modes.frequencies, expected.frequencies, rtol=1e-7)
        info, single = modes.info, expected.info
        for name, other in (("beam 1.end", "beam 1.node 4"), ("beam 2.end", "beam 1.end")):
            found = np.abs(modes.shapes[:, info.node(name)])
            np.testing.assert_allclose(
                found, np.abs(expected.shapes[:, single.node(other)]), atol=1e-5
            )
    assert np.abs(expected.shapes[0, :, :3]).max() == pytest.approx(body.model.size)


def test_pendulum():
    """A rigid body on a spherical joint: two compound pendulums and a neutral turn."""
    mass, arm, J = 2.0, 0.3, np.array([1.0, 1.2, 0.5])
    scene = fl.Scene(gravity=(0, 0, -G))
    body = scene.add(fl.RigidBody(mass, J, (0, 0, -arm)))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("centre"), at=(0, 0, 0)))
    expected = np.sqrt(mass * G * arm / (J[:2] + mass * arm**2))
    modes = fl.vibrations(scene, 3)
    np.testing.assert_allclose(modes.frequencies, [0.0, *np.sort(expected)], atol=1e-9)


@pytest.mark.parametrize("spin", [3.0, 7.0, 20.0])
def test_sleeping_top(spin, caplog):
    """Precession and nutation ``J ν² − J₃ Ω ν + m g a = 0`` seen from the turning top.

    It stands if ``J₃² Ω² > 4 m g a J``.
    """
    mass, arm, J, J3 = 2.0, 0.3, 1.0, 1.5
    scene = fl.Scene(gravity=(0, 0, -G))
    body = scene.add(fl.RigidBody(mass, (J, J, J3), (0, 0, arm)))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("centre"), at=(0, 0, 0)))
    modes = fl.vibrations(scene, 3, spin=(0, 0, spin))
    nu = np.roots([J + mass * arm**2, -J3 * spin, mass * G * arm])
    s = 1j * (nu - spin)
    expected = np.where(s.imag < 0, s.conj(), s)
    found = modes.eigenvalues[np.abs(modes.eigenvalues) > 0]
    stands = (J3 * spin) ** 2 > 4 * mass * G * arm * (J + mass * arm**2)
    np.testing.assert_allclose(np.sort(found.imag), np.sort(expected.imag), rtol=1e-8)
    np.testing.assert_allclose(np.sort(found.real), np.sort(expected.real), atol=1e-7)
    assert modes.unstable.any() != stands
    assert ("unstable" in caplog.text) != stands


@pytest.mark.parametrize(("mass", "stiffness"), [(2.0, 0.0), (0.0, 1e-5), (2.0, 1e-5)])
def test_damping(mass, stiffness):
    """``ζ = α/(2ω) + β ω/2`` of the undamped frequency, which is ``|s|``."""
    plain, _ = beam()
    omega = fl.vibrations(plain).frequencies
    scene, _ = beam(damping=fl.sections.Damping(mass=mass, stiffness=stiffness))
    modes = fl.vibrations(scene)
    ratio = mass / (2 * omega) + stiffness * omega / 2
    np.testing.assert_allclose(modes.damping_ratios, ratio, rtol=1e-6)
    np.testing.assert_allclose(np.abs(modes.eigenvalues), omega, rtol=1e-7)


@pytest.mark.parametrize(("load", "flutters"), [(19.9, False), (20.2, True)])
def test_becks_column(load, flutters):
    """A following force makes the stiffness asymmetric: flutter at 20.05 EI/L² (Beck 1952)."""
    scene, body = beam(10.0)
    force = load * body.model.stiffness[0, 5, 5] / 100
    scene.add(fl.PointLoad(body.point("end"), force=(-force, 0, 0), following=True))
    modes = fl.vibrations(scene, 4)
    assert modes.unstable.any() == flutters
    assert (modes.frequencies[modes.unstable] > 0).all()


@pytest.mark.parametrize("clamped", [True, False])
def test_slenderness(clamped):
    """Up to 1e5: axial stiffness is 1e13 times that of the slowest mode, and is not felt."""
    scene, body = beam(1e3, 0.01, 0.02, clamped=clamped)
    modes = fl.vibrations(scene, 8)
    unit = np.sqrt(body.model.stiffness[0, 5, 5] / body.model.density[0, 0, 0]) / 1e6
    start = [3.51602, 7.03203] if clamped else [0.0] * 6 + [22.3733, 44.7466]
    np.testing.assert_allclose(modes.frequencies[: len(start)] / unit, start, rtol=1e-4)
    assert modes.residuals.max() < 1e-10


def test_free_damped_beam_has_six_rigid_motions():
    scene, _ = beam(clamped=False, damping=fl.sections.Damping(stiffness=1e-5))
    modes = fl.vibrations(scene, 8)
    assert not modes.eigenvalues[:6].any() and modes.eigenvalues[6:].all()
    span = modes.shapes[:6].reshape(6, -1)
    assert np.linalg.matrix_rank(span, tol=1e-6) == 6


def test_time_integration_swings_with_the_frequency():
    """A column under half its critical load starts with the velocity of its slowest mode."""
    scene, body = beam(1.0, 0.002, 0.004, cells=6)
    critical = body.model.stiffness[0, 5, 5] * (np.pi / 2) ** 2
    scene.add(fl.PointLoad(body.point("end"), force=(-0.5 * critical, 0, 0)))
    modes = fl.vibrations(scene, 1)
    shape, omega = modes.shapes[0].real, modes.frequencies[0]
    body.velocities[:] = 1e-3 * omega * shape[modes.info.body("beam 1").nodes]
    step = 2 * np.pi / omega / 100
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=110 * step, step=step)
    tip, times = result.position(body.point("end"))[:, 1], result.times
    before = np.flatnonzero(np.diff(np.sign(tip[1:])) != 0) + 1
    crossings = times[before] - tip[before] * step / (tip[before + 1] - tip[before])
    # the trapezoidal rule slows waves down by (ωh)²/12 = 3.3e-4
    assert np.pi / np.diff(crossings)[0] == pytest.approx(omega * (1 - 3.3e-4), rel=1e-4)
    assert omega < 0.75 * fl.vibrations(beam(1.0, 0.002, 0.004, cells=6)[0], 1).frequencies[0]


def test_at_takes_an_equilibrium():
    scene, body = beam(2.0, 0.005, 0.01)
    scene.add(fl.LineLoad(body, force=(0, 0, -1.0)))
    result = fl.statics(scene, spin=(0, 0, 5.0), load_steps=3)
    np.testing.assert_allclose(
        fl.vibrations(scene, at=result).eigenvalues,
        fl.vibrations(scene, spin=(0, 0, 5.0)).eigenvalues,
        rtol=1e-6,
    )
    other, _ = beam(2.0, 0.005, 0.01, cells=4)
    with pytest.raises(ValueError, match="must be an equilibrium of this scene with 5 nodes"):
        fl.vibrations(other, at=result)
    with pytest.raises(ValueError, match=r"the rotation is that of at=\.\.\."):
        fl.vibrations(scene, at=result, spin=(0, 0, 1))
    scene.add(fl.PointLoad(body.point("end"), force=(0, 0, 3.0)))
    with pytest.raises(ValueError, match="not an equilibrium of this scene under its full loads"):
        fl.vibrations(scene, at=result)


@pytest.mark.parametrize(
    "formulation",
    [
        fl.elements.GeodesicBeam(),
        fl.elements.DirectorBeam(1),
        fl.elements.DirectorBeam(2),
        fl.elements.KirchhoffRod(),
    ],
)
@pytest.mark.parametrize("cells", [2, 4])
def test_loads_that_no_joint_takes_are_balanced_by_the_beam(formulation, cells):
    """What statics leaves is small beside the loads, of which the sum of all forces knows none."""
    section = fl.Section.rectangle(0.02, 0.04, fl.Material(1e9, 0.3, 7800.0))
    scene = fl.Scene(gravity=(0, G, -2))

    def arc(s):
        return s, 0.4 * s * (1 - s), 0

    options = {"up": (0, 0, 1), "formulation": formulation}
    body = scene.add(fl.Beam.curve(arc, section, cells=cells, **options))
    scene.add(fl.Clamp(body.point("start")))
    scene.add(fl.PointLoad(body.point("end"), force=(-3, 20, 5)))
    found = fl.vibrations(scene, 2)
    exact = fl.vibrations(
        scene, 2, at=fl.statics(scene, load_steps=4, newton=fl.schemes.Newton(tolerance=1e-13))
    )
    np.testing.assert_allclose(found.frequencies, exact.frequencies, rtol=1e-7)
    other = fl.Scene(gravity=(0, G, -2))
    body = other.add(fl.Beam.curve(arc, section, cells=cells, **options))
    other.add(fl.Clamp(body.point("start")))
    other.add(fl.PointLoad(body.point("end"), force=(-3, 20, 5.01)))
    with pytest.raises(ValueError, match="not an equilibrium"):
        fl.vibrations(scene, 2, at=fl.statics(other))


@pytest.mark.parametrize("seed", [46, 103])
def test_what_statics_finds_for_vibrations_is_not_refused(seed):
    """These scenes are soft and stiff: an equilibrium to 1e-10 lengths had forces left over."""
    scene = build(random_scene(seed, HELD), static=True).scene
    found = fl.vibrations(scene, 4).eigenvalues
    fine = fl.statics(scene, newton=fl.schemes.Newton(tolerance=1e-13))
    exact = fl.vibrations(scene, 4, at=fine).eigenvalues
    np.testing.assert_allclose(found, exact, rtol=1e-6)


def test_bad_input():
    scene, body = beam(cells=1)
    with pytest.raises(ValueError, match="count must be 1 … 6, the degrees of freedom, got 7"):
        fl.vibrations(scene, 7)
    assert len(fl.vibrations(scene, 6)) == 6
    with pytest.raises(ValueError, match="spin must be 3 finite numbers"):
        fl.statics(scene, spin=(1, 2))
    scene.add(fl.PointLoad(body.point("end"), force=(0, 0, 1)))
    with pytest.raises(ValueError, match="load 1, on beam 1, is fixed in space and must be para"):
        fl.statics(scene, spin=(1, 0, 0))
    fl.statics(scene, spin=(0, 0, 1))
    heavy = fl.Scene(gravity=(0, -1, 0))
    heavy.add(fl.RigidBody(1.0, (1, 1, 1)))
    with pytest.raises(ValueError, match="gravity is fixed in space"):
        fl.vibrations(heavy, spin=(0, 0, 1))
    massless = fl.Scene()
    section = fl.Section.from_stiffness(np.ones(6))
    massless.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))
    with pytest.raises(ValueError, match="need the inertia of all sections"):
        fl.vibrations(massless, 1)


@pytest.mark.parametrize("rate", [None, 0.1], ids=["linear", "quadratic"])
def test_singular_pencil_is_named(rate):
    """The last unknown has neither mass nor stiffness: no shift makes its row regular."""
    M, K = sp.diags([1.0, 1.0, 1.0, 0.0], format="csr"), sp.diags([1.0, 2, 3, 0], format="csr")
    C = None if rate is None else sp.csr_matrix(([rate, -rate], ([0, 1], [1, 0])), shape=(4, 4))
    with pytest.raises(fl.ConvergenceError, match=r"SLEPc failed .*'test_'"):
        smallest(Pencil(M, C, K, sp.csr_matrix((0, 4))), 2, 0.0, "test_")


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_a_rate_of_round_off_is_zero_beside_slow_modes(unit):
    """The slowest square is 1e-13 of the fastest, and 1e-6 of the next one."""
    squares = unit * np.array([2e-9, 5e-4, *np.geomspace(1.0, 1.5e4, 18)])
    Q = np.linalg.qr(np.random.default_rng(3).normal(size=(20, 20)))[0]
    K = Q @ np.diag(squares) @ Q.T
    pencil = Pencil(
        sp.eye(20, format="csr"), None, sp.csr_matrix(0.5 * (K + K.T)), sp.csr_matrix((0, 20))
    )
    rates, vectors, residuals = smallest(pencil, 2, 0.0, "test_")
    np.testing.assert_allclose(-(rates**2).real, [0.0, squares[1]], rtol=1e-6, atol=0)
    sizes = np.linalg.norm(vectors, axis=1)
    np.testing.assert_allclose(np.abs(vectors @ Q[:, :2]).diagonal() / sizes, 1.0, rtol=1e-6)
    assert residuals.max() < 1e-5


def test_pictures(tmp_path):
    scene, _ = beam(cells=4)
    modes = fl.vibrations(scene, 2)
    modes.picture(tmp_path / "mode.png", 1)
    modes.animate(tmp_path / "mode.gif", 2, images=4, amplitude=0.2)
    assert min(path.stat().st_size for path in tmp_path.iterdir()) > 5_000
    with pytest.raises(ValueError, match=re.escape("modes are 1 … 2, got 0")):
        modes.picture(tmp_path / "mode.png", 0)
    with pytest.raises(ValueError, match="amplitude must be positive, got 0"):
        modes.moved(1, 0, 0.0)
    lines = str(modes).splitlines()
    assert len(lines) == 3 and f"{modes.hertz[0]:.5g}" in lines[1]


def test_bodies_without_any_stiffness_have_zeros_only():
    """Two of them: as many rigid motions as are asked for, up to all twelve."""
    scene = fl.Scene()
    for x in (0.0, 2.0):
        scene.add(fl.RigidBody(1.0, (0.1, 0.2, 0.3), position=(x, 0, 0)))
    for count in (1, 12):
        modes = fl.vibrations(scene, count)
        np.testing.assert_array_equal(modes.eigenvalues, np.zeros(count))


def pendulum() -> fl.Scene:
    """A rod on a damped hinge, created where it is horizontal."""
    scene = fl.Scene(gravity=(0, 0, -G))
    rod = scene.add(fl.RigidBody(1.0, (1e-4, 1 / 12, 1 / 12), (0.5, 0, 0), name="rod"))
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), rod.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
    )
    scene.add(fl.joints.Spring(hinge.angle, damping=0.5))
    return scene


def test_the_message_on_a_mechanism_that_moves_says_how_it_comes_to_rest():
    """As the message says: what a damped motion comes to has the frequency of a hanging rod."""
    swinging, hanging = pendulum(), pendulum()
    with pytest.raises(fl.ConvergenceError, match=r"where it hangs.*fl\.adaptivity\.transfer"):
        fl.vibrations(swinging, 1)
    motion = fl.GeneralisedAlpha().run(swinging, duration=40.0, step=1e-2)
    fl.adaptivity.transfer(motion, swinging, hanging)
    (s,) = fl.vibrations(hanging, 1).eigenvalues
    decay = 0.5 / (2 / 3)  # damping over twice the moment of inertia about the hinge
    wanted = -decay + 1j * np.sqrt(1.5 * G - decay**2)
    assert s == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.3, 0.5, -0.7)])
@pytest.mark.parametrize("radius", [0.3, 0.01, 1e-3])
def test_slender_free_rods_joined_by_springs(radius, tilt):
    """Of twelve modes two are strained: the rods move and turn against each other.

    Rotations about their own axes have little inertia, in which round-off of the springs counts.
    """
    stiffness, gap = 100.0, 0.5
    ends = np.array([[[0, y, 0], [1, y, 0]] for y in (0.0, gap)]) @ expm(lie.hat(np.array(tilt))).T
    scene = fl.Scene()
    one, two = (scene.add(fl.RigidBody.cylinder(1.0, radius, *each)) for each in ends)
    for a, b in zip(*ends, strict=True):
        distance = fl.joints.Distance(one.point(a), two.point(b))
        scene.add(fl.joints.Spring(distance.length, stiffness))
    inertia = 1 / 12 + radius**2 / 4
    exact = np.sort(np.sqrt([4 * stiffness, stiffness / inertia]))
    found = 2 * np.pi * fl.vibrations(scene, 12).hertz
    np.testing.assert_allclose(found, [0.0] * 10 + list(exact), rtol=1e-6, atol=1e-6)
