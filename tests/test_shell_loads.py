"""Loads on shells: pressure that follows, forces per area, volume and mass, edges."""

import basix
import numpy as np
import pytest
from scipy.integrate import solve_bvp

import fem_lie as fl
from tests.assembled import Assembled

SOFT = fl.Material(100.0, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, SOFT)
CELLS = [("quadrilateral", 1), ("triangle", 1), ("quadrilateral", 2), ("triangle", 2)]


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def formulation(cell: str, degree: int) -> fl.elements.ShellFormulation:
    return fl.elements.HellingerReissner() if degree == 1 else fl.elements.DisplacementBased()


def square(a: float, b: float) -> tuple[float, float, float]:
    return (2.0 * a, b, 0.0)


def plate(cell: str = "quadrilateral", degree: int = 1, cells=(2, 2), **options) -> fl.Shell:
    mesh = fl.mesh.parametric_surface(square, cells, cell=cell, degree=degree)
    return fl.Shell(mesh, LAYER, formulation=formulation(cell, degree), **options)


def box(cell: str, degree: int, count: int = 2) -> fl.Shell:
    """A closed surface: a cube of 2×2 squares per face, blown up to the unit sphere."""
    grids, positions = {}, []
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            # so that ∂/∂a × ∂/∂b is outward
            turn = 1 if side > 0 else -1
            patch = fl.mesh.parametric_surface(
                lambda a, b, k=axis, s=side, t=turn: np.roll([s, t * (2 * a - 1), 2 * b - 1], k),
                (count, count),
                cell=cell,
                degree=degree,
            )
            number = []
            for x in patch.points:
                key = tuple(np.round(x, 9))
                if key not in grids:
                    grids[key] = len(positions)
                    positions.append(x / np.linalg.norm(x))
                number.append(grids[key])
            faces.append(np.array(number)[patch.cells])
    mesh = fl.mesh.SurfaceMesh.from_cells(positions, np.concatenate(faces), cell)
    return fl.Shell(
        mesh, LAYER, director=lambda x: x / np.linalg.norm(x), formulation=formulation(cell, degree)
    )


def deformed(system: Assembled, seed: int = 1, size: float = 0.2) -> np.ndarray:
    """Random positions and directors of what is free."""
    H, rng = system.start, np.random.default_rng(seed)
    h = np.where(system.held, 0.0, size * rng.normal(size=(system.count, 6)))
    system.equations.supports.rotate_back(H, h)
    return system.tilted(H, h)


def loads(system: Assembled, H: np.ndarray, time: float = 1.0) -> np.ndarray:
    """Forces and moments of all loads, local components, shape (n, 6)."""
    return system.equations.prescribed(time).loads(H).reshape(-1, 6)


def pushes(system: Assembled, H: np.ndarray) -> np.ndarray:
    """Forces of all pressures, global components, shape (n, 3)."""
    return np.einsum("ni,nij->nj", loads(system, H)[:, :3], H[: system.count, 1:])


def volume(shell: fl.Shell, nodes: np.ndarray, H: np.ndarray, gradient=(0, 0, 0)) -> float:
    """``∫ x·n/3 + (g·x) (x·n)/4`` over the current surface: ``∫ 1 + g·x dV`` if it is closed."""
    cell, degree = basix.CellType[shell.model.mesh.cell], shell.model.mesh.degree
    points, weights = basix.make_quadrature(cell, 5 * degree)
    element = basix.create_element(
        basix.ElementFamily.P, cell, degree, basix.LagrangeVariant.gll_warped
    )
    x = H[nodes, 0][shell.model.mesh.cells]
    positions, along, across = np.einsum("dgk,ckj->dcgj", element.tabulate(1, points)[..., 0], x)
    normals = weights[:, np.newaxis] * np.cross(along, across)
    density = 1 / 3 + positions @ np.asarray(gradient, dtype=float) / 4
    return float((density * (positions * normals).sum(axis=2)).sum())


# --- pressure: its forces and its stiffness ---


@pytest.mark.parametrize(("cell", "degree"), CELLS)
def test_load_stiffness_is_the_derivative_of_the_forces(cell, degree):
    """On an open surface, with a pressure that differs from cell to cell and grows with depth."""
    shell = plate(cell, degree)
    system = Assembled(
        scene_with(
            shell, fl.loads.SurfacePressure(shell, lambda x: 1.0 + x[0], gradient=(0.3, -0.2, 0.5))
        ),
        dynamics=True,
    )
    H = deformed(system)
    system.equations.prescribed(1.0).act()
    # the stress of the state is the same without pressure
    found, rng, step = system.matrix(H), np.random.default_rng(2), 1e-5
    found = found - Assembled(scene_with(shell), dynamics=True).matrix(H)
    h = np.where(system.held, 0.0, rng.normal(size=(system.count, 6)))
    ahead, behind = (pushes(system, system.moved(H, sign * step * h)) for sign in (1, -1))
    expected = -(ahead - behind) / (2 * step)
    found = (found @ h.ravel()).reshape(-1, 6)
    assert not found[:, 3:].any()
    found = np.einsum("ni,nij->nj", found[:, :3], H[: system.count, 1:])
    # the third derivative is that of a cubic, or quartic, and small: 1e-10
    np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize(("cell", "degree"), CELLS)
@pytest.mark.parametrize("gradient", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.5)])
def test_pressure_on_a_closed_surface_is_the_gradient_of_its_volume(cell, degree, gradient):
    """``Σ f·δx = δ∫ p dV`` for any state and increment, to round-off of the difference."""
    shell = box(cell, degree)
    system = Assembled(
        scene_with(shell, fl.loads.SurfacePressure(shell, 3.0, np.multiply(3.0, gradient))),
        dynamics=False,
    )
    H, nodes = deformed(system), system.equations.unknowns.bodies[shell]
    forces, rng, step = pushes(system, H), np.random.default_rng(3), 1e-4
    dx = rng.normal(size=forces.shape)
    work = 0.0
    for sign in (1, -1):
        moved = H.copy()
        moved[: system.count, 0] += sign * step * dx
        work += sign * 3.0 * volume(shell, nodes, moved, gradient) / (2 * step)
    assert (forces * dx).sum() == pytest.approx(work, rel=1e-6)
    if not any(gradient):
        np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-13)
        moment = np.cross(H[: system.count, 0], forces).sum(axis=0)
        np.testing.assert_allclose(moment, 0.0, atol=1e-12)
    else:
        # Archimedes: the weight of what is displaced
        buoyancy = 3.0 * np.asarray(gradient) * volume(shell, nodes, H)
        np.testing.assert_allclose(forces.sum(axis=0), buoyancy, atol=1e-12)
    assert system.equations.unknowns.has_potential


def test_pressure_pushes_to_the_side_of_the_directors():
    """Whichever way round the cells are."""
    for director in ((0, 0, 1.0), (0, 0, -1.0)):
        position = square if director[2] > 0 else lambda a, b: square(1 - a, b)
        shell = fl.Shell(
            fl.mesh.parametric_surface(position, (2, 2)), LAYER, director=lambda x, d=director: d
        )
        system = Assembled(scene_with(shell, fl.loads.SurfacePressure(shell, 3.0)), dynamics=False)
        total = pushes(system, system.start).sum(axis=0)
        np.testing.assert_allclose(total, 6.0 * np.array(director), atol=1e-12)


def open_case(name: str) -> fl.Scene:
    shell = plate(cells=(3, 3))
    pressure = 1.0
    match name:
        case "free":
            shell.clamp("a=0")
        case "fixed" | "jump":
            for side in ("a=0", "a=1", "b=0", "b=1"):
                shell.hinge(side)
            if name == "jump":
                pressure = lambda x: x[0]  # noqa: E731
        case "planes":
            shell.symmetry("a=0", (1, 0, 0))
            shell.symmetry("b=0", (0, 1, 0))
            shell.hinge("a=1")
            shell.hinge("b=1")
        case "guided plane":
            shell.roller("a=0", (1, 0, 0))
            for side in ("a=1", "b=0", "b=1"):
                shell.hinge(side)
        case "guided askew":
            shell.roller("a=0", (0, 1, 0))
            for side in ("a=1", "b=0", "b=1"):
                shell.hinge(side)
    return scene_with(shell, fl.loads.SurfacePressure(shell, pressure))


@pytest.mark.parametrize(
    ("name", "symmetric"),
    [
        ("free", False),
        ("fixed", True),
        ("jump", False),
        ("planes", True),
        ("guided plane", True),
        ("guided askew", False),
    ],
)
def test_matrix_is_known_to_be_symmetric_where_the_pressure_has_a_potential(name, symmetric):
    system = Assembled(open_case(name), dynamics=False)
    assert system.equations.unknowns.has_potential is symmetric
    K = system.matrix(deformed(system, seed=5, size=0.05))
    skew = np.abs(K - K.T).max() / np.abs(K).max()
    assert skew <= 1e-12 if symmetric else skew > 1e-6


# --- pressure: what it does ---


def sphere(count: int) -> tuple[fl.Shell, fl.Scene]:
    """Closed, of radius 1; by symmetry it does not leave the planes of coordinates."""
    bare = box("quadrilateral", 1, count).model.mesh
    planes = {f"{k}": np.flatnonzero(np.abs(bare.points[:, k]) < 1e-9) for k in range(3)}
    mesh = fl.mesh.SurfaceMesh.from_cells(bare.points, bare.cells, bare.cell, named_points=planes)
    shell = fl.Shell(mesh, LAYER, director=lambda x: x / np.linalg.norm(x))
    for k in range(3):
        shell.symmetry(f"{k}", np.eye(3)[k])
    return shell, scene_with(shell)


def blown_up(pressure: float) -> float:
    """Stretch of a sphere of radius 1, of least energy; the energy per area is
    ``E t/(1 − ν) ((λ² − 1)/2)² + D (1 + ν) (λ − 1)²``."""
    E, nu, t = SOFT.E, SOFT.nu, 0.1
    membrane, bending = E * t / (1 - nu), E * t**3 / 12 / (1 - nu)
    cubic = [membrane, -pressure, 2 * bending - membrane, -2 * bending]
    (stretch,) = (root.real for root in np.roots(cubic) if root.imag == 0 and root.real > 0.9)
    return float(stretch)


@pytest.mark.parametrize("solve", [fl.statics, fl.follow_loads])
def test_a_balloon_is_blown_up(solve):
    """Of second order in the mesh."""
    errors = []
    for count in (4, 8):
        shell, scene = sphere(count)
        scene.add(fl.loads.SurfacePressure(shell, 8.0))
        result = solve(scene)
        assert result.iterations[-1] <= 15
        radius = np.linalg.norm(result.frames[-1, :, 0], axis=1)
        errors.append(radius.mean() / blown_up(8.0) - 1)
    assert blown_up(8.0) > 1.25
    assert abs(errors[1]) <= 5e-3
    assert abs(errors[1]) <= abs(errors[0]) / 3.5


def bent_by_pressure(load: float) -> tuple[float, float]:
    """Tip of an inextensible cantilever, EI = L = 1, under a load normal to it wherever it goes."""

    def slopes(s, y):
        _, _, angle, m, nx, nz = y
        c, n = np.cos(angle), np.sin(angle)
        return np.array([c, n, m, n * nx - c * nz, load * n, -load * c])

    def ends(a, b):
        return np.array([a[0], a[1], a[2], b[3], b[4], b[5]])

    s = np.linspace(0, 1, 50)
    solution = solve_bvp(slopes, ends, s, np.vstack([s, 0 * s, 0.1 * s, 0 * s, 0 * s, 0 * s]))
    assert solution.success
    return float(solution.y[0, -1]), float(solution.y[1, -1])


@pytest.mark.parametrize(
    ("cell", "degree", "cells", "bound"),
    [
        ("quadrilateral", 1, 16, 4e-3),
        ("triangle", 1, 16, 6e-3),
        ("quadrilateral", 2, 8, 2e-3),
        ("triangle", 2, 8, 5e-3),
    ],
)
def test_a_strip_bends_under_pressure_as_a_beam_does(cell, degree, cells, bound):
    """It is so thin that it neither stretches nor shears."""
    material, t = fl.Material(12e6, 0.0, 1.0), 0.01
    shell = fl.Shell(
        fl.mesh.parametric_surface(
            lambda a, b: (a, 0.1 * b, 0.0), (cells, 1), cell=cell, degree=degree
        ),
        fl.ShellSection.layer(t, material),
        formulation=formulation(cell, degree),
        name="strip",
    )
    shell.clamp("a=0")
    scene = scene_with(shell, fl.loads.SurfacePressure(shell, 8.0 * 12e6 * t**3 / 12))
    assert not fl.extend.Equations(scene, dynamics=False).unknowns.has_potential
    result = fl.follow_loads(scene)
    expected = bent_by_pressure(8.0)
    assert expected[1] > 0.6
    np.testing.assert_allclose(result.position("strip.10")[-1, [0, 2]], expected, atol=bound)


def test_a_balloon_pulsates_with_its_energy():
    """Kinetic, elastic and −p V, after a sudden pressure: a law of the sum of all steps."""
    shell, scene = sphere(2)
    scene.add(fl.loads.SurfacePressure(shell, 8.0))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=0.5, step=0.005)
    nodes = result.info.body(shell.name).nodes
    volumes = np.array([volume(shell, nodes, H) for H in result.frames])
    energy = result.kinetic + result.elastic
    work = 8.0 * (volumes - volumes[0])
    assert np.ptp(volumes) > 1.0
    np.testing.assert_allclose(energy - energy[0], work, atol=3e-3 * np.ptp(work))


def test_pressures_have_histories_of_their_own():
    """One grows with the load factor, the other as its history says."""
    shell = plate()
    scene = scene_with(
        shell,
        fl.loads.SurfacePressure(shell, 3.0),
        fl.loads.SurfacePressure(shell, 5.0, history=lambda t: t**2),
    )
    system = Assembled(scene, dynamics=False)
    system.equations.prescribed(0.5).act(factor=0.1)
    local = -system.residual(system.start)[: 6 * system.count].reshape(-1, 6)
    total = np.einsum("ni,nij->j", local[:, :3], system.start[: system.count, 1:])
    np.testing.assert_allclose(total, [0, 0, 2.0 * (0.3 + 1.25)], atol=1e-13)
    with pytest.raises(ValueError, match=r"SurfacePressure on .* with a history"):
        fl.follow_loads(scene)


def test_a_beam_under_pressure_by_the_arc_length():
    """As by load steps; the load stiffness grows with the load."""
    section = fl.Section.from_stiffness([1e4, 5e3, 5e3, 1.0, 1.0, 1.0], mass=1.0)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=8, up=(0, 0, 1))
    scene = scene_with(
        beam, fl.Clamp(beam.point("start")), fl.loads.PressureLoad(beam, 8.0, (0, 1, 1))
    )
    stepped, followed = fl.statics(scene, load_steps=4), fl.follow_loads(scene, [0.5, 1.0])
    found, expected = followed.position(beam.point("end")), stepped.position(beam.point("end"))
    np.testing.assert_allclose(found, expected[[1, 3]], atol=1e-7)
    assert np.abs(found[-1] - found[0]).max() > 0.1


# --- forces over the surface ---


@pytest.mark.parametrize(("cell", "degree"), CELLS)
def test_a_force_that_varies_has_its_resultant_and_moment(cell, degree):
    """Linear over the plate (2 × 1), ``f = (x, 2 y, 1)``."""
    shell = plate(cell, degree)
    load = fl.AreaLoad(shell, lambda x: (x[0], 2 * x[1], 1.0))
    values, x = load.nodal(), shell.frames[:, 0]
    np.testing.assert_allclose(values[:, :3].sum(axis=0), [2.0, 2.0, 2.0], atol=1e-13)
    moment = np.cross(x, values[:, :3]).sum(axis=0)
    np.testing.assert_allclose(moment, [1.0, -2.0, 2.0 - 1.0], atol=1e-13)


def test_forces_per_volume_and_mass_are_gravity():
    """On a laminate whose centre of mass is off the reference surface, too."""
    heavy = fl.ShellSection.laminate([fl.sections.Ply(0.1, SOFT)], reference=0.0)
    gravity = np.array([0.3, -0.2, -9.0])

    def dead(section, make) -> np.ndarray:
        shell = fl.Shell(fl.mesh.parametric_surface(square, (2, 2)), section)
        scene = fl.Scene(gravity if make is None else (0, 0, 0))
        scene.add(shell)
        if make is not None:
            scene.add(make(shell))
        equations = fl.extend.Equations(scene, dynamics=True)
        return equations.prescribed(0.0).loads(equations.start.frames)

    for section in (LAYER, heavy):
        found = dead(section, lambda shell: fl.loads.MassLoad(shell, gravity))
        np.testing.assert_allclose(found, dead(section, None), atol=1e-14)
    found = dead(LAYER, lambda shell: fl.loads.VolumeLoad(shell, lambda x: SOFT.density * gravity))
    np.testing.assert_allclose(found, dead(LAYER, None), atol=1e-14)


def test_loads_on_a_group_of_cells():
    bare = fl.mesh.parametric_surface(square, (4, 1))
    mesh = fl.mesh.SurfaceMesh.from_cells(
        bare.points, bare.cells, bare.cell, groups={"half": [2, 3]}
    )
    shell = fl.Shell(mesh, LAYER)
    area = fl.AreaLoad(shell, (0, 0, 1.0), "half").nodal()
    assert area[:, 2].sum() == pytest.approx(1.0)
    assert not area[shell.frames[:, 0, 0] < 0.9].any()
    pressure = fl.loads.SurfacePressure(shell, 1.0, cells="half")
    system = Assembled(scene_with(shell, pressure), dynamics=False)
    np.testing.assert_allclose(pushes(system, system.start), area[:, :3], atol=1e-14)


# --- edges ---


def strip(formulation: fl.elements.ShellFormulation | None = None, cells: int = 16) -> fl.Shell:
    """A strip along x, EI = L = 1 in all."""
    material = fl.Material(12e6 / 0.1, 0.0, 1.0)
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, 0.1 * b, 0.0), (cells, 1)),
        fl.ShellSection.layer(0.01, material),
        formulation=formulation,
        name="strip",
    )
    shell.clamp("a=0")
    return shell


@pytest.mark.parametrize("following", [False, True])
def test_an_end_moment_rolls_a_strip_up(following):
    """To a full circle; with decoupled bending the end turns exactly."""
    shell = strip(fl.elements.HellingerReissner(fl.elements.DECOUPLED))
    # −y is along the edge, whose shell is on its left
    moment = (-2 * np.pi / 0.1, 0, 0) if following else (0, -2 * np.pi / 0.1, 0)
    load = fl.loads.EdgeLoad(shell, "a=1", moment=moment, following=following)
    # held in its plane by nothing, it turns over sideways before the circle is full
    with pytest.warns(fl.stability.UnstableEquilibriumWarning, match="at load factor 1 "):
        result = fl.follow_loads(scene_with(shell, load), [0.25, 0.5, 0.75, 1.0])
    ends = shell.model.mesh.nodes("a=1")
    turned = result.frames[:, result.info.body("strip").nodes[ends], 3]
    angle = 2 * np.pi * result.factors
    expected = np.column_stack([-np.sin(angle), 0 * angle, np.cos(angle)])
    np.testing.assert_allclose(turned, np.repeat(expected[:, None], 2, axis=1), atol=1e-6)
    position = np.column_stack([np.sin(angle) / angle, 0 * angle, (1 - np.cos(angle)) / angle])
    # chords instead of arcs
    np.testing.assert_allclose(result.position("strip.10"), position, atol=1e-2)


@pytest.mark.parametrize("direction", [1, 2])
def test_following_edge_forces_are_those_of_a_beam(direction):
    """Along the director, and a push along the strip beside a small one across."""
    shell = strip()
    force = np.array([0.0, 0.0, 3.0]) if direction == 2 else np.array([0.0, -8.0, 1.0])
    load = fl.loads.EdgeLoad(shell, "a=1", force=force / 0.1, following=True)
    result = fl.follow_loads(scene_with(shell, load))
    section = fl.Section.from_stiffness([1.2e5, 5e4, 5e4, 1.0, 1.0, 1.0], mass=1.0)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=16, up=(0, 0, 1))
    # the beam's axes: along, then those of its section
    axes = beam.frames[-1, 1:]
    push = fl.PointLoad(beam.point("end"), axes @ [force[1], 0, force[2]], following=True)
    reference = fl.statics(scene_with(beam, fl.Clamp(beam.point("start")), push), load_steps=4)
    expected = reference.position(beam.point("end"))[-1]
    assert expected[2] > 0.05
    found = result.position("strip.10")[-1]
    np.testing.assert_allclose(found[[0, 2]], expected[[0, 2]], atol=5e-3)


def test_axes_of_an_edge_have_the_shell_on_their_left():
    """Whatever the order of the curve's nodes; outward and along on the four sides of a plate."""
    shell = plate()
    for side, outward, along in (
        ("a=0", (-1, 0, 0), (0, -1, 0)),
        ("a=1", (1, 0, 0), (0, 1, 0)),
        ("b=0", (0, -1, 0), (1, 0, 0)),
        ("b=1", (0, 1, 0), (-1, 0, 0)),
    ):
        for force, expected in (((0, 1, 0), outward), ((1, 0, 0), along), ((0, 0, 1), (0, 0, 1))):
            local = fl.loads.EdgeLoad(shell, side, force, following=True).nodal()[:, :3]
            total = np.einsum("ni,nij->j", local, shell.frames[:, 1:])
            length = 1.0 if side[0] == "a" else 2.0
            np.testing.assert_allclose(total, length * np.array(expected), atol=1e-13)


# --- bad input ---


def inner_curve() -> fl.Shell:
    bare = fl.mesh.parametric_surface(square, (2, 1))
    (middle,) = (np.flatnonzero(np.abs(bare.points[:, 0] - 1) < 1e-9),)
    mesh = fl.mesh.SurfaceMesh.from_cells(
        bare.points, bare.cells, bare.cell, curves={"m": [middle]}
    )
    return fl.Shell(mesh, LAYER)


CASES = {
    "pressure that is not finite": (
        lambda s: fl.loads.SurfacePressure(s, lambda x: np.nan if x[0] > 1 else 0.0),
        r"pressure on .* at \[1\.5",
    ),
    "pressure of three components": (lambda s: fl.loads.SurfacePressure(s, (0, 0, 1)), "1 finite"),
    "gradient of one component": (lambda s: fl.loads.SurfacePressure(s, 1.0, 2.0), "3 finite"),
    "unknown cells": (
        lambda s: fl.loads.SurfacePressure(s, 1.0, cells="top"),
        "no group of cells 'top'",
    ),
    "force that is not finite": (
        lambda s: fl.AreaLoad(s, lambda x: (np.inf, 0, 0)),
        "AreaLoad on .* at",
    ),
    "following load between cells": (
        lambda s: fl.loads.EdgeLoad(s, "m", (0, 0, 1), following=True),
        "between cells",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_input(case):
    make, message = CASES[case]
    shell = inner_curve()
    with pytest.raises(ValueError, match=message):
        scene_with(shell, make(shell))


def test_force_per_mass_needs_mass():
    massless = fl.ShellSection(LAYER.stiffness, np.zeros((2, 2)), 0.1)
    shell = fl.Shell(fl.mesh.parametric_surface(square, (1, 1)), massless)
    with pytest.raises(ValueError, match="needs mass"):
        scene_with(shell, fl.loads.MassLoad(shell, (0, 0, 1)))
