"""Follower loads, stress-free strains, histories and damping, against closed forms."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import Assembled

EA, GA, GJ, EI2, EI3 = 1e4, 5e3, 50.0, 100.0, 70.0
MASS = np.diag([0.5, 0.0, 1e-4, 2e-4])
SECTION = fl.Section.from_stiffness([EA, GA, GA, GJ, EI2, EI3], MASS)
LENGTH = 2.0


def cantilever(cells: int, section: fl.Section = SECTION, **options):
    """A clamped bar; the joint reports the force on the ground, in axes with e₃ = z."""
    scene = fl.Scene()
    beam = fl.Beam.straight(
        (0, 0, 0), (LENGTH, 0, 0), section, cells=cells, up=(0, 0, 1), **options
    )
    scene.add(beam)
    joint = scene.add(fl.joints.Fixed(fl.ground(), beam.point("start")))
    return scene, beam, joint


def frames_of(result: fl.StaticResult, beam: fl.Beam) -> np.ndarray:
    """Frames of the beam's nodes at the end."""
    return result.frames[-1][result.info.body(beam.name).nodes]


def on_ground(result: fl.StaticResult, joint: fl.joints.Joint) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment of a joint at the origin on the ground, global components."""
    axes, wrench = joint.frame()[1:], result.joint_force(joint)[-1]
    return wrench[:3] @ axes, wrench[3:] @ axes


# --- derivatives ----------------------------------------------------------------------------------


def branch(damping: fl.sections.Damping | None = None) -> tuple[fl.Scene, fl.Beam]:
    """A kink and a branch: attached nodes."""
    scene = fl.Scene()
    mesh = fl.mesh.LineMesh.from_cells(
        [(0, 0, 0), (1, 0, 0), (1.2, 0.8, 0), (1.5, 0, 0.8)], [(0, 1), (1, 2), (1, 3)]
    )
    return scene, scene.add(fl.Beam(mesh, SECTION, damping=damping))


def random_state(system: Assembled, seed: int):
    rng = np.random.default_rng(seed)
    H = system.moved(system.start, 0.4 * rng.normal(size=(system.count, 6)))
    return H, rng.normal(size=(system.count, 6)), rng.normal(size=(system.count, 6))


@pytest.mark.parametrize("seed", range(3))
def test_tangent_of_pressure_and_of_all_loads_on_nodes_that_follow(seed):
    """Central differences of all that acts, at random frames; no load has a symmetric tangent."""
    scene, beam = branch()
    block = scene.add(fl.RigidBody(0.4, (0.2, 0.3, 0.4), (1.6, 0.9, 0.3)))
    scene.add(fl.joints.RigidLink(block.point("centre"), beam.point(2)))
    scene.add(fl.loads.PressureLoad(beam, 300.0, (0, 1, 2)))
    scene.add(fl.PointLoad(beam.point(3), force=(30, 20, 10), moment=(10, 20, 30)))
    scene.add(fl.PointLoad(block.point("centre"), (30, 20, 10), (1, 2, 3), following=True))
    scene.add(fl.LineLoad(beam, force=(10, 20, 30), moment=(3, 2, 1)))
    scene.add(fl.loads.PreStress(beam, (10, 20, 30, 3, 2, 1)))
    system = Assembled(scene, dynamics=False)
    H, _, _ = random_state(system, seed)
    K = system.matrix(H)
    # 1e-6² of third derivatives, and 1e-16 / 1e-6
    expected = system.differences(H, 1e-6)
    np.testing.assert_allclose(K, expected, rtol=0, atol=1e-8 * np.abs(K).max())


@pytest.mark.parametrize("seed", range(3))
def test_damping_is_linear_in_the_velocity_and_in_the_matrix(seed):
    """The derivative of the residual in the velocities is in the matrix."""
    scene, _ = branch(fl.sections.Damping(mass=2.0, stiffness=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)))
    system = Assembled(scene, dynamics=True)
    H, v, a = random_state(system, seed)
    D = system.matrix(H, v, a, damping=2.0) - system.matrix(H, v, a, damping=1.0)
    step, columns = 1e-3, []
    for j in range(6 * system.count):
        h = step * np.eye(1, 6 * system.count, j).reshape(-1, 6)
        columns.append((system.residual(H, v + h, a) - system.residual(H, v - h, a)) / (2 * step))
    # the residual is a quadratic of the velocities: round-off only
    np.testing.assert_allclose(D, np.array(columns).T, rtol=0, atol=1e-10 * np.abs(D).max())


@pytest.mark.parametrize("seed", range(3))
def test_viscous_forces_do_not_feel_rigid_motion_and_never_feed_it(seed):
    damped, free = (
        Assembled(branch(damping)[0], dynamics=True)
        for damping in (fl.sections.Damping(stiffness=0.1), None)
    )
    H, v, _ = random_state(damped, seed)
    moving = H[: damped.count]

    def forces(twists):
        return damped.residual(H, twists) - free.residual(H, twists)

    rigid = lie.se3_adjoint(lie.se3_inverse(moving)) @ v[0]
    assert np.abs(forces(rigid)).max() < 1e-12 * np.abs(forces(v)).max()
    assert forces(v) @ v.ravel() > 0


# --- pressure -------------------------------------------------------------------------------------


def test_pressure_on_any_plane_line_is_that_on_its_chord():
    """``Σ f = p (x_n − x_0) × w``: however the line is bent, if its sections stay upright."""
    rng = np.random.default_rng(3)
    turns = np.pad(rng.normal(size=(6, 1)), [(0, 0), (2, 0)])
    x = np.pad(rng.normal(size=(6, 2)), [(0, 0), (0, 1)])
    H = np.array([lie.frame(xi, lie.so3_exp(t)) for xi, t in zip(x, turns, strict=True)])
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=5, up=(0, 0, 1))
    scene = fl.Scene()
    scene.add(beam)
    # e₁ × e₃ = −e₂
    scene.add(fl.loads.PressureLoad(beam, 3.0, (0, -1, 0)))
    equations = fl.extend.Equations(scene, dynamics=False)
    rows, nodes = equations.start.frames.copy(), equations.unknowns.bodies[beam]
    rows[nodes] = H
    forces = equations.prescribed(0.0).loads(rows).reshape(-1, 6)[nodes]
    spatial = np.einsum("ni,nij->nj", forces[:, :3], H[:, 1:])
    np.testing.assert_allclose(spatial.sum(axis=0), np.cross(x[-1] - x[0], (0, 0, 3)), atol=1e-13)
    assert not forces[:, 3:].any()


def ring(cells: int, section: fl.Section, pressure: float):
    """A ring about z, supported at one point, under external pressure."""
    phi = 2 * np.pi * np.arange(cells) / cells
    pairs = np.column_stack([np.arange(cells), (np.arange(cells) + 1) % cells])
    points = np.column_stack([np.cos(phi), np.sin(phi), 0 * phi])
    scene = fl.Scene()
    mesh = fl.mesh.LineMesh.from_cells(points, pairs, kink_angle=np.radians(40))
    beam = scene.add(fl.Beam(mesh, section, up=(0, 0, 1)))
    scene.add(fl.Clamp(beam.point(0)))
    # e₂ = e₃ × e₁ points inward
    scene.add(fl.loads.PressureLoad(beam, pressure, (0, 1, 0)))
    return scene, beam


def test_a_ring_shrinks_by_its_hoop_strain():
    """``N = −p r`` on the current radius: ``r = R/(1 + pR/EA)``, to second order in the cells."""
    p, errors = 0.2 * EA, []
    stiff = fl.Section.from_stiffness([EA, EA, EA, EA, EA, EA])
    for cells in (16, 32):
        scene, beam = ring(cells, stiff, p)
        with pytest.warns(fl.schemes.CoarseElementsWarning, match="compressed by 1[67]%"):
            x = frames_of(fl.statics(scene, load_steps=2), beam)[:, 0]
        radius = 0.5 * np.linalg.norm(x[cells // 2] - x[0])
        errors.append(abs(radius - 1 / 1.2))
        middle = 0.5 * (x[cells // 2] + x[0])
        np.testing.assert_allclose(np.linalg.norm(x - middle, axis=1), radius, rtol=1e-9)
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) > 1.9, errors


def test_a_ring_buckles_at_its_critical_pressure():
    """``p = 3 EI/R³`` if the pressure stays normal (Lévy 1884); the tangent says when."""
    EI = 1.0
    section = fl.Section.from_stiffness([1e6, 1e6, 1e6, 100.0, 100.0, EI])
    lowest = []
    for factor in (0.98, 1.02):
        scene, _ = ring(48, section, factor * 3 * EI)
        result = fl.statics(scene)
        system = Assembled(scene, dynamics=False)
        H = system.start.copy()
        H[: system.count] = result.frames[-1]
        free = ~system.held.ravel()
        K = system.matrix(H)[np.ix_(free, free)]
        lowest.append(np.linalg.eigvals(K).real.min())
    assert lowest[0] > 0 > lowest[1], lowest


# --- fixed and following axes ---------------------------------------------------------------------


def test_moments_about_fixed_and_following_axes():
    """The clamp takes the moment as prescribed, or rotated with the tip."""
    moment = np.array([30.0, 40.0, 50.0])
    for following in (False, True):
        scene, beam, joint = cantilever(8)
        scene.add(fl.PointLoad(beam.point("end"), moment=moment, following=following))
        result = fl.statics(scene, load_steps=6)
        force, felt = on_ground(result, joint)
        R = result.rotation(beam.point("end"))[-1]
        assert np.linalg.norm(R - np.eye(3)) > 1
        np.testing.assert_allclose(felt, R @ moment if following else moment, atol=1e-7)
        np.testing.assert_allclose(force, 0.0, atol=1e-7)


def test_following_line_load_turns_with_its_nodes():
    """Its resultant is the sum of the rotated nodal forces, and equals the reaction."""
    scene, beam, joint = cantilever(6)
    density = np.array([3.0, 5.0, 40.0])
    scene.add(fl.LineLoad(beam, force=density, following=True))
    result = fl.statics(scene, load_steps=3)
    share = np.full(7, LENGTH / 6)
    share[[0, -1]] /= 2
    frames = frames_of(result, beam)
    R = lie.rotation(frames)
    forces = share[:, np.newaxis] * (R @ density)
    force, moment = on_ground(result, joint)
    np.testing.assert_allclose(force, forces.sum(axis=0), atol=1e-7)
    lever = np.cross(frames[:, 0], forces).sum(axis=0)
    # the bow of each element carries a couple to its ends, which cancels at inner nodes
    couple = np.cross([1.0, 0, 0], density) * (LENGTH / 6) ** 2 / 12
    np.testing.assert_allclose(moment, lever + R[0] @ couple - R[-1] @ couple, atol=1e-7)
    assert np.abs(R[-1] - np.eye(3)).max() > 0.3


SQUARE = fl.Section.rectangle(0.1, 0.1, fl.Material(E=1e6, nu=0.0, density=1e3))
LINES = {
    "beam": lambda: fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), SECTION, cells=3),
    "of degree 2": lambda: fl.Beam.straight(
        (0, 0, 0), (LENGTH, 0, 0), SECTION, cells=3, formulation=fl.elements.DirectorBeam(degree=2)
    ),
    "cable": lambda: fl.Cable.straight((0, 0, 0), (LENGTH, 0, 0), SQUARE, cells=3),
    "cable with a cell that runs backwards": lambda: fl.Cable(
        fl.mesh.LineMesh.from_cells(
            [(0, 0, 0), (0.5 * LENGTH, 0, 0), (LENGTH, 0, 0)], [(0, 1), (2, 1)]
        ),
        SQUARE,
    ),
    "ANCF": lambda: fl.AncfBeam.straight((0, 0, 0), (LENGTH, 0, 0), SQUARE, cells=3),
    "shell": lambda: fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: np.array([LENGTH * a, b, 0.0]), (3, 2)),
        fl.ShellSection.layer(0.1, fl.Material(1e6, 0.0, 1e3)),
    ),
    "shell of degree 2": lambda: fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: np.array([LENGTH * a, b, 0.0]), (3, 2), degree=2),
        fl.ShellSection.layer(0.1, fl.Material(1e6, 0.0, 1e3)),
        formulation=fl.elements.DisplacementBased(),
    ),
    "thin shell": lambda: fl.ThinShell(
        fl.mesh.smooth_patch(lambda a, b: np.array([LENGTH * a, b, 0.0]), (3, 2)),
        fl.ShellSection.layer(0.1, fl.Material(1e6, 0.0, 1e3)),
    ),
}


@pytest.mark.parametrize("name", LINES)
def test_a_load_along_a_line_may_be_a_function_of_the_position(name):
    """A parabola of force along x does the work of its integrals on rigid motions."""
    body = LINES[name]()

    def force(x):
        return np.array([0.0, 0.0, 3.0 * x[0] ** 2 - x[0]])

    load = fl.loads.EdgeLoad if "shell" in name else fl.LineLoad
    where = ("b=0",) if "shell" in name else ()
    nodal, on_rows = (
        load(body, *where, force=force).nodal(),
        load(body, *where, force=force).on_directors(),
    )
    x = body.frames[:, 0]
    about_y = -np.einsum("n,n->", x[:, 0], nodal[:, 2]) + nodal[:, 4].sum()
    # a rotation about y turns directors, or changes gradients: d₁ towards −z
    about_y -= np.einsum("nd,nd->", body.frames[:, 1:, 0], on_rows[..., 2])
    total, moment = LENGTH**3 - LENGTH**2 / 2, 0.75 * LENGTH**4 - LENGTH**3 / 3
    assert nodal[:, 2].sum() == pytest.approx(total, rel=1e-12)
    assert about_y == pytest.approx(-moment, rel=1e-12)
    np.testing.assert_allclose(
        load(body, *where, force=lambda x: (1.0, 2.0, 3.0)).nodal(),
        load(body, *where, force=(1.0, 2.0, 3.0)).nodal(),
        atol=1e-14,
    )


def test_a_triangular_load_bends_a_cantilever_by_its_closed_form():
    """``q L⁴/30 EI`` for a load that falls from q at the root to zero at the tip."""
    stiff = fl.Section.from_stiffness([1e8, 1e8, 1e8, GJ, EI2, EI3], MASS)
    scene, beam, _ = cantilever(8, stiff)
    scene.add(fl.LineLoad(beam, force=lambda x: (0, 0, 1e-3 * (1 - x[0] / LENGTH))))
    tip = fl.statics(scene).displacement(beam.point("end"))[-1, 2]
    assert tip == pytest.approx(1e-3 * LENGTH**4 / 30 / EI2, rel=2e-3)


def test_a_load_that_is_no_function_of_the_position_is_named():
    scene, beam, _ = cantilever(2)
    with pytest.raises(ValueError, match="force of the LineLoad on"):
        scene.add(fl.LineLoad(beam, force=lambda t: (0, 0, 10 * t)))
        fl.statics(scene)


# --- strains without stress -----------------------------------------------------------------------


def test_free_warming_makes_longer_and_no_stress():
    scene, beam, joint = cantilever(3)
    scene.add(fl.loads.Temperature(beam, 50.0, 1e-3))
    result = fl.statics(scene)
    np.testing.assert_allclose(
        result.position(beam.point("end"))[-1], [1.05 * LENGTH, 0, 0], atol=1e-12
    )
    np.testing.assert_allclose(result.joint_force(joint)[-1], 0.0, atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_gradient_of_temperature_bends_to_a_circle(axis):
    """Curvature α g: the warmer side is outside; one element is exact."""
    curvature = 1.3
    for cells in (1, 4):
        scene, beam, joint = cantilever(cells)
        scene.add(fl.loads.Temperature(beam, 0.0, 1e-3, gradient=1e3 * curvature * np.eye(2)[axis]))
        result = fl.statics(scene, load_steps=2)
        angle = curvature * LENGTH
        exact = np.zeros(3)
        exact[[0, 1 + axis]] = np.sin(angle) / curvature, (np.cos(angle) - 1) / curvature
        np.testing.assert_allclose(result.position(beam.point("end"))[-1], exact, atol=1e-9)
        np.testing.assert_allclose(result.joint_force(joint)[-1], 0.0, atol=1e-6)


def test_warming_between_clamps_is_a_thrust():
    """``N = −EA α ΔT``, and of two loads and two groups of cells the sum of each."""
    scene, beam, joint = cantilever(4)
    scene.add(fl.Clamp(beam.point("end")))
    scene.add(fl.loads.Temperature(beam, 20.0, 1e-4))
    scene.add(fl.loads.Eigenstrain(beam, (1e-3, 0, 0, 0, 0, 0)))
    force, _ = on_ground(fl.statics(scene), joint)
    np.testing.assert_allclose(force, [-3e-3 * EA, 0, 0], atol=1e-7)


def test_pre_stress_is_the_resultant_in_the_unloaded_configuration():
    """All six components, shear included, whatever the flexibility of the element."""
    given = np.array([100.0, 20, -30, 4, 5, -6])
    for cells, formulation in (
        (1, fl.elements.GeodesicBeam()),
        (3, fl.elements.GeodesicBeam()),
        (2, fl.elements.GeodesicBeam(False)),
    ):
        scene, beam, joint = cantilever(cells, formulation=formulation)
        for k in range(1, cells + 1):
            scene.add(fl.Clamp(beam.point(k)))
        scene.add(fl.loads.PreStress(beam, given))
        force, moment = on_ground(fl.statics(scene), joint)
        np.testing.assert_allclose(force, given[:3], atol=1e-9)
        # in the middle of the first element
        lever = np.cross([LENGTH / cells / 2, 0, 0], given[:3])
        np.testing.assert_allclose(moment, given[3:] + lever, atol=1e-9)


def test_a_string_under_tension_gives_way_as_strings_do():
    """``w = P/4T (L − 4/k tanh(kL/4))`` with ``k² = T/EI``: clamped at both ends."""
    T, P, errors = 5e3, 1e-4, []
    k = np.sqrt(T / EI2)
    stiff = fl.Section.from_stiffness([1e8, 1e8, 1e8, GJ, EI2, EI3])
    exact = P / (4 * T) * (LENGTH - 4 / k * np.tanh(k * LENGTH / 4))
    for cells in (16, 32, 64):
        scene, beam, _ = cantilever(cells, stiff)
        scene.add(fl.Clamp(beam.point("end")))
        scene.add(fl.loads.PreStress(beam, (T, 0, 0, 0, 0, 0)))
        middle = beam.point(cells // 2)
        scene.add(fl.PointLoad(middle, force=(0, 0, P)))
        errors.append(abs(fl.statics(scene).position(middle)[-1, 2] / exact - 1))
    assert max(errors) < 2e-4, errors


# --- histories ------------------------------------------------------------------------------------


def bar_with_a_mass(damping: fl.sections.Damping | None = None):
    """One axial degree of freedom: frequency √(k/m), with a negligible mass of the bar."""
    light = fl.Section.from_stiffness(SECTION.stiffness, 1e-6 * MASS)
    scene, beam, _ = cantilever(1, light, damping=damping)
    block = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), (LENGTH, 0, 0)))
    scene.add(fl.joints.RigidLink(beam.point("end"), block.point("centre")))
    return scene, beam, np.sqrt(EA / LENGTH / 2.0)


def run(scene: fl.Scene, duration: float, steps: int) -> fl.Result:
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-11)
    return scheme.run(scene, duration=duration, step=duration / steps)


def test_an_eigenstrain_with_a_history_drives_an_oscillator():
    """``ü + ω² (u − ε*(t) L) = 0`` with ``ε* = ε sin Ωt``, beside a constant one on other cells."""
    scene, beam, omega = bar_with_a_mass()
    other = scene.add(fl.Beam.straight((0, 1, 0), (1, 1, 0), SECTION, cells=2))
    scene.add(fl.Clamp(other.point("start")))
    drive, strain = 0.4 * omega, 1e-3
    scene.add(
        fl.loads.Eigenstrain(beam, (strain, 0, 0, 0, 0, 0), history=lambda t: np.sin(drive * t))
    )
    scene.add(fl.loads.Eigenstrain(other, (0, 0, 0, 0, 0, 0)))
    errors = []
    for steps in (200, 400):
        result = run(scene, 4 * np.pi / omega, steps)
        u = result.position(beam.point("end"))[:, 0] - LENGTH
        t = result.times
        exact = strain * LENGTH * (np.sin(drive * t) - 0.4 * np.sin(omega * t)) / (1 - 0.16)
        errors.append(np.abs(u - exact).max() / np.abs(exact).max())
        assert np.abs(result.position(other.point("end"))[:, 0] - 1).max() < 1e-12
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) > 1.9, errors


def test_histories_are_functions_of_time_and_of_the_load_factor():
    """In dynamics ``m ü = F cos Ωt + F₀``; in statics the factor's square, beside a plain load."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1)))
    scene.add(fl.PointLoad(body.point("centre"), (3.0, 0, 0), history=lambda t: np.cos(5 * t)))
    scene.add(fl.PointLoad(body.point("centre"), (0, 4.0, 0)))
    scene.add(
        fl.PointLoad(body.point("centre"), (0, 0, 1.0), following=True, history=lambda t: 6 * t)
    )
    result = run(scene, 1.0, 400)
    t = result.times
    exact = np.column_stack([3 / 2 / 25 * (1 - np.cos(5 * t)), t**2, t**3 / 2])
    np.testing.assert_allclose(result.position(body.point("centre")), exact, atol=2e-5)

    scene, beam, _ = cantilever(1)
    scene.add(fl.PointLoad(beam.point("end"), (8.0, 0, 0), history=lambda factor: factor**2))
    scene.add(fl.PointLoad(beam.point("end"), (2.0, 0, 0)))
    result = fl.statics(scene, load_steps=4)
    stretch = result.position(beam.point("end"))[:, 0] / LENGTH - 1
    np.testing.assert_allclose(stretch * EA, 8 * result.factors**2 + 2 * result.factors, atol=1e-8)


def test_a_history_that_is_not_finite_is_named():
    scene, beam, _ = cantilever(1)
    scene.add(fl.PointLoad(beam.point("end"), (1.0, 0, 0)))
    scene.add(
        fl.PointLoad(beam.point("end"), (1.0, 0, 0), history=lambda t: np.inf if t > 0.4 else 1.0)
    )
    with pytest.raises(ValueError, match=r"history of load 2 is inf at time 0\.5"):
        fl.statics(scene, load_steps=2)


# --- damping --------------------------------------------------------------------------------------


def damping_ratio(result: fl.Result, u: np.ndarray) -> float:
    """From the logarithmic decrement of successive maxima, by parabolas through three points."""
    k = 1 + np.flatnonzero((u[1:-1] > u[:-2]) & (u[1:-1] >= u[2:]))
    left, top, right = u[k - 1], u[k], u[k + 1]
    peaks = top + (right - left) ** 2 / (8 * (2 * top - left - right))
    assert len(peaks) >= 3
    decrement = np.log(peaks[0] / peaks[-1]) / (len(peaks) - 1)
    return float(decrement / np.hypot(2 * np.pi, decrement))


@pytest.mark.parametrize("ratio", [0.01, 0.1])
def test_kelvin_voigt_damps_an_oscillator(ratio):
    """``ζ = τω/2``."""
    omega = bar_with_a_mass()[2]
    scene, beam, _ = bar_with_a_mass(fl.sections.Damping(stiffness=2 * ratio / omega))
    for body in scene.bodies:
        body.velocities[:, 0] = 0.01 * omega
    beam.velocities[0] = 0.0
    result = run(scene, 8 * np.pi / omega, 800)
    u = result.position(beam.point("end"))[:, 0] - LENGTH
    assert damping_ratio(result, u) == pytest.approx(ratio, rel=1e-3)


@pytest.mark.parametrize(
    "damping",
    [
        fl.sections.Damping(mass=2.0),
        fl.sections.Damping(stiffness=2e-3),
        fl.sections.Damping(mass=1.0, stiffness=1e-3),
        # of the six times only that of κ₂ matters to bending in the plane of z
        fl.sections.Damping(stiffness=(0, 0, 0, 1, 2e-3, 1)),
    ],
    ids=["mass", "stiffness", "both", "curvature"],
)
def test_rayleigh_damps_the_first_bending_mode(damping):
    """``ζ = (a/ω + τω)/2``, started in the shape of the mode of a clamped bar."""
    section = fl.Section.from_stiffness([1e6, 1e6, 1e6, GJ, EI2, EI3], mass=0.5, polar=2e-7)
    scene, beam, _ = cantilever(12, section, damping=damping)
    root = 1.8751040687
    omega = (root / LENGTH) ** 2 * np.sqrt(EI2 / 0.5)
    s = root * beam.frames[:, 0, 0] / LENGTH
    sigma = (np.sinh(root) - np.sin(root)) / (np.cosh(root) + np.cos(root))
    shape = np.cosh(s) - np.cos(s) - sigma * (np.sinh(s) - np.sin(s))
    slope = root / LENGTH * (np.sinh(s) + np.sin(s) - sigma * (np.cosh(s) - np.cos(s)))
    beam.velocities[:, 2], beam.velocities[:, 4] = 1e-3 * shape, -1e-3 * slope
    result = run(scene, 6 * np.pi / omega, 400)
    u = result.position(beam.point("end"))[:, 2]
    exact = 0.5 * (damping.mass / omega + damping.factors()[4] * omega)
    assert 0.01 < exact < 0.1
    # shear and the mesh change the frequency by less than a percent
    assert damping_ratio(result, u) == pytest.approx(exact, rel=0.01)


def test_mass_damping_stops_a_free_body():
    """A free bar slows down as ``exp(−a t)``, in translation and in its spin about its axis."""
    scene = fl.Scene()
    beam = fl.Beam.straight(
        (-1, 0, 0), (1, 0, 0), SECTION, cells=2, damping=fl.sections.Damping(mass=3.0)
    )
    scene.add(beam).add_velocity((1.0, 2.0, -1.0))
    beam.add_velocity(omega=(5.0, 0, 0), about=(0, 0, 0))
    result = run(scene, 0.5, 500)
    slower = np.exp(-3.0 * result.times)[:, np.newaxis]
    # of the second order in a step of the rate: (3e-3)²/12 times what there is
    np.testing.assert_allclose(result.momentum, slower * result.momentum[0], atol=5e-6)
    np.testing.assert_allclose(
        result.angular_momentum, slower * result.angular_momentum[0], atol=5e-6
    )


def test_kelvin_voigt_does_not_slow_down_a_spin():
    """Vibrations decay; momentum and angular momentum are conserved."""
    scene = fl.Scene()
    beam = fl.Beam.straight(
        (-1, 0, 0), (1, 0, 0), SECTION, cells=4, damping=fl.sections.Damping(0.0, 5e-3)
    )
    scene.add(beam).add_velocity(omega=(0, 0, 3.0), about=(0, 0, 0))
    beam.add_velocity((0, 0, 1.0))
    result = run(scene, 1.0, 1000)
    assert result.momentum_error < 1e-8 and result.angular_momentum_error < 1e-4
    # only the stretch that the spin needs has been damped: its share is ρL²ω²/EA ~ 1e-4
    lost = 1 - result.total_energy / result.total_energy[0]
    assert 0 < lost[-1] < 1e-3
    assert abs(lost[-1] - lost[-200]) < 1e-6
