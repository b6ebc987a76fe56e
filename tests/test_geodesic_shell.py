"""A shell whose edges are geodesics of SE(3): exact in pure bending, and the laws of elements."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from studies import distorted_shells

SHELL = fl.elements.GeodesicShell()
LENGTH, WIDTH, THICKNESS, E = 1.0, 0.2, 0.01, 1e7


def strip(shape: tuple[int, int], nu: float = 0.0, warp: float = 0.0, bow: float = 0.0) -> fl.Shell:
    """A strip in cells that may be distorted within it, flat or curved."""

    def position(a: float, b: float) -> tuple[float, float, float]:
        bump = np.sin(np.pi * a) * np.sin(np.pi * b)
        x, y = LENGTH * a + warp * bump, WIDTH * b - 0.3 * warp * bump
        return x, y, bow * (a * a + a * b)

    layer = fl.ShellSection.layer(THICKNESS, fl.Material(E, nu, 1000.0))
    return fl.Shell(fl.mesh.parametric_surface(position, shape), layer, formulation=SHELL)


def bent(angle: float, steps: int) -> tuple[fl.Shell, Any]:
    """One element, clamped, under moments at the other end."""
    shell, scene = strip((1, 1)), fl.Scene()
    scene.add(shell)
    moment = E * THICKNESS**3 / 12 * WIDTH * angle / LENGTH
    for corner in "00", "01":
        scene.add(fl.Clamp(shell.point(corner)))
    for corner in "10", "11":
        scene.add(fl.PointLoad(shell.point(corner), moment=(0, -moment / 2, 0)))
    return shell, fl.statics(scene, load_steps=steps)


@pytest.mark.filterwarnings("ignore:.*fold at 3.14 rad")
@pytest.mark.parametrize("steps", [1, 4])
@pytest.mark.parametrize("degrees", [90, 180])
def test_one_element_is_exact_in_pure_bending(degrees, steps):
    """Rotation and position."""
    angle = np.radians(degrees)
    shell, result = bent(angle, steps)
    end = LENGTH / angle * np.array([np.sin(angle), 0.0, 1.0 - np.cos(angle)])
    for corner, y in ("10", 0.0), ("11", WIDTH):
        point = shell.point(corner)
        exact = [end[0], y, end[2]]
        np.testing.assert_allclose(result.position(point)[-1], exact, atol=1e-10)
        director = result.rotation(point)[-1][:, 2]
        np.testing.assert_allclose(director, [-np.sin(angle), 0, np.cos(angle)], atol=1e-10)


def term_of(shell: fl.Shell):
    """The assembly, and its frames in the order of its nodes."""
    term = shell.model.assemble([shell.model])
    H = np.empty_like(shell.frames)
    H[term.order] = shell.frames
    return term, H


def disturbed(H: np.ndarray, size: float) -> np.ndarray:
    h = size * np.random.default_rng(0).standard_normal((len(H), 6))
    return lie.se3_compose(H, lie.se3_exp(h))


@pytest.mark.parametrize("bow", [0.0, 0.3])
def test_rigid_motions_change_nothing(bow):
    term, H = term_of(strip((2, 2), 0.3, 0.1, bow))
    H = disturbed(H, 0.05)
    motion = lie.frame(np.array([300.0, -200.0, 100.0]), lie.so3_exp(np.array([1.0, -2.0, 0.7])))
    moved = lie.se3_compose(motion, H)
    there, here = np.zeros((2, len(H), 6))
    term.add_forces(H, here)
    term.add_forces(moved, there)
    np.testing.assert_allclose(there, here, atol=1e-10 * np.abs(here).max())
    assert term.energy(moved) == pytest.approx(term.energy(H), rel=1e-10)


@pytest.mark.parametrize("bow", [0.0, 0.3])
def test_forces_are_the_gradient_and_the_tangent_their_derivative(bow):
    term, H = term_of(strip((2, 1), 0.3, 0.1, bow))
    H = disturbed(H, 0.1)
    forces, size = np.zeros((len(H), 6)), 1e-6
    term.add_forces(H, forces)
    term.reset_stress(H)
    K = np.zeros((len(H), 6, len(H), 6))
    rows = np.repeat(np.arange(len(H)), np.diff(term.indptr))
    for block, i, j in zip(term.tangent(H, term.workspace()), rows, term.indices, strict=True):
        K[i, :, j] += block
    for node, component in ((0, 0), (1, 2), (2, 3), (3, 4), (4, 5)):
        h = np.zeros((len(H), 6))
        h[node, component] = size
        ends = [lie.se3_compose(H, lie.se3_exp(sign * h)) for sign in (1.0, -1.0)]
        energies = [term.energy(end) for end in ends]
        gradient = (energies[0] - energies[1]) / (2 * size)
        assert gradient == pytest.approx(forces[node, component], abs=1e-6 * np.abs(forces).max())
        both = np.zeros((2, len(H), 6))
        for end, out in zip(ends, both, strict=True):
            term.add_forces(end, out)
        change = (both[0] - both[1]) / (2 * size)
        np.testing.assert_allclose(change, K[..., node, component], atol=1e-6 * np.abs(K).max())


@pytest.mark.parametrize("bow", [0.0, 0.3])
def test_only_rigid_motions_have_no_energy(bow):
    term, H = term_of(strip((1, 1), 0.3, 0.0, bow))
    K = np.zeros((len(H), 6, len(H), 6))
    term.reset_stress(H)
    rows = np.repeat(np.arange(len(H)), np.diff(term.indptr))
    for block, i, j in zip(term.tangent(H, term.workspace()), rows, term.indices, strict=True):
        K[i, :, j] += block
    scale = np.tile([1.0] * 3 + [1.0 / WIDTH] * 3, len(H))
    values = np.linalg.eigvalsh(K.reshape(24, 24) * np.outer(scale, scale))
    assert np.abs(values[:6]).max() < 1e-12 * values[-1]
    assert values[6] > 1e-7 * values[-1]


STATES = {
    "stretch": (lambda x, y: (1e-5 * x, -3e-6 * y, 0), lambda x, y: (0, 0, 0)),
    "shear": (lambda x, y: (1e-5 * y, 1e-5 * x, 0), lambda x, y: (0, 0, 0)),
    "bending": (lambda x, y: (0, 0, 5e-5 * x * x), lambda x, y: (0, -1e-4 * x, 0)),
    "twist": (lambda x, y: (0, 0, 1e-4 * x * y), lambda x, y: (1e-4 * x, -1e-4 * y, 0)),
}


@pytest.mark.parametrize("state", STATES)
def test_constant_strain_is_exact_on_distorted_cells(state):
    """Nodes within the patch are in equilibrium, and the energy is that of the strain."""
    term, H = term_of(strip((2, 2), 0.3, 0.12))
    move, turn = STATES[state]
    x, y = H[:, 0, :2].T.copy()
    for i in range(len(H)):
        R = lie.so3_exp(np.array(turn(x[i], y[i]), dtype=float))
        u = np.array(move(x[i], y[i]), dtype=float)
        H[i] = lie.frame(H[i, 0] + u, R @ lie.rotation(H[i]))
    forces = np.zeros((len(H), 6))
    term.add_forces(H, forces)
    inner = (x > 1e-9) & (x < LENGTH - 1e-9) & (y > 1e-9) & (y < WIDTH - 1e-9)
    assert inner.any()
    # to first order; membrane forces of a bent plate are of second order
    of_state = [0, 1, 5] if state in ("stretch", "shear") else [2, 3, 4]
    forces = forces[:, of_state]
    assert np.abs(forces[inner]).max() < 1e-4 * np.abs(forces).max()
    D, ε = fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.3, 1000.0)).stiffness, np.zeros(8)
    at, value = {
        "stretch": ([0, 1], [1e-5, -3e-6]),
        "shear": ([2], [2e-5]),
        "bending": ([3], [-1e-4]),
        "twist": ([5], [-2e-4]),
    }[state]
    ε[at] = value
    exact = 0.5 * ε @ D @ ε * LENGTH * WIDTH
    assert term.energy(H) == pytest.approx(exact, rel=1e-4)


SCHEMES = {
    "generalised-α": (fl.GeneralisedAlpha(radius=1.0), 1e-5, 1e-7),
    "conserving": (fl.EnergyMomentum(), 1e-11, 1e-11),
    "decaying": (fl.EnergyDecaying(), 1e-11, 1e-11),
    "variational": (fl.schemes.Variational(), 1e-5, 1e-11),
    "explicit": (fl.Explicit(), 1e-5, 1e-11),
}


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_beam_fixed_to_it_in_every_scheme(scheme):
    made, balance, momenta = SCHEMES[scheme]
    scene, shell = fl.Scene(), strip((2, 2), 0.3, 0.1, 0.1)
    section = fl.Section.rectangle(0.05, 0.04, fl.Material(E, 0.3, 1000.0))
    end = shell.point("11").position
    beam = fl.Beam.straight(end, end + np.array([0.3, 0.2, 0.4]), section, cells=2)
    for body in shell, beam:
        scene.add(body)
        body.add_velocity(omega=(0.3, 2.0, 1.0), about=(0.5, 0, 0))
    scene.add(fl.joints.Fixed(shell.point("11"), beam.point("start")))
    result = made.run(scene, duration=2e-3, step=2e-5, progress=False)
    assert result.balance_error < balance
    assert result.momentum_error < momenta
    assert result.angular_momentum_error < momenta
    assert result.joint_violations.max() < 1e-11


def test_bad_input():
    layer = fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.3, 1000.0))

    def flat(a: float, b: float) -> tuple[float, float, float]:
        return a, b, 0.0

    with pytest.raises(ValueError, match="drilling=False"):
        mesh = fl.mesh.parametric_surface(flat, (1, 1))
        fl.Shell(mesh, layer, formulation=SHELL, drilling=False)
    with pytest.raises(ValueError, match="GeodesicShell is for quadrilaterals"):
        mesh = fl.mesh.parametric_surface(flat, (1, 1), cell="triangle")
        fl.Shell(mesh, layer, formulation=SHELL)


def test_drilling_helps_on_distorted_cells():
    """In-plane bending of trapezoids and parallelograms, over beam theory."""
    found = distorted_shells.main()
    for cells, five, geodesic in (("trapezoids", 0.06, 0.9), ("parallelograms", 0.65, 0.97)):
        assert found[cells]["five_in_plane"] < five
        assert found[cells]["geodesic_in_plane"] > geodesic
    for values in found.values():
        assert values["geodesic_across"] == pytest.approx(values["five_across"], rel=1e-3)


@pytest.mark.filterwarnings("ignore:.*fold at 3.14 rad")
def test_moments_of_one_element():
    """The stress field of a bent element has the moment at its end, and nothing else."""
    shell, result = bent(np.pi / 2, 1)
    found = fl.post.resultants(result, shell)
    moment = E * THICKNESS**3 / 12 * np.pi / 2 / LENGTH
    np.testing.assert_allclose(np.abs(found.at_points[..., 3]), moment, rtol=1e-12)
    others = np.delete(found.at_points, 3, axis=-1)
    np.testing.assert_allclose(others, 0.0, atol=1e-9 * moment)


@pytest.mark.parametrize("cells", [4, 8])
def test_a_compressed_plate_buckles_as_a_plate_at_first(cells):
    """A square plate, simply supported, buckles at ``4π²D/a²``.

    Rotations of the nodes about their directors, alternately to one side and to the other, must not
    buckle before: edges are arcs, and longer then.
    """
    side, thickness, nu = 1.0, 0.01, 0.3
    mesh = fl.mesh.parametric_surface(lambda a, b: (side * a, side * b, 0.0), (cells, cells))
    layer = fl.ShellSection.layer(thickness, fl.Material(E, nu, 1000.0))
    plate, scene = fl.Shell(mesh, layer, formulation=SHELL, name="plate"), fl.Scene()
    scene.add(plate)
    rim = {p.node: p for side in ("a=0", "a=1", "b=0", "b=1") for p in plate.points(side)}
    held = [(point, (0, 0, 1)) for point in rim.values()]
    held += [(point, (1, 0, 0)) for point in plate.points("a=0")]
    held += [(point, (0, 1, 0)) for point in plate.points("b=0")]
    for point, axis in held:
        scene.add(fl.joints.InPlane(fl.ground(), point, axis=axis))
    bending = E * thickness**3 / 12 / (1 - nu**2)
    critical = 4 * np.pi**2 * bending / side**2
    scene.add(fl.loads.EdgeLoad(plate, "a=1", force=(-critical, 0, 0)))
    found = fl.buckling(scene, 1)
    assert found.factors[0] == pytest.approx(1.0, abs=1.6 / cells**2)
