"""Laws and published values of shell elements, and the load-capped arc length that they need."""

import re

import numpy as np
import pytest
from dolfinx import fem
from models import superpose
from shell_models import (
    BENT,
    DISPLACEMENT,
    HR,
    HW,
    PLUS,
    PLUS_DISPLACEMENT,
    QUADRILATERAL_9,
    SIX,
    SIX_DISPLACEMENT,
    TRIANGLE,
    TRIANGLE_6,
    Element,
    Statics,
    grid,
    hemisphere,
    patch,
    quartic,
    section,
    strip,
)

import fem_lie as fl
from fem_lie.elements.shells import element as shell
from fem_lie.elements.shells.cells import ShellCells
from fem_lie.lie.motions import retract

slow = pytest.mark.slow  # FFCx and the C compiler take long for them


def ids(element) -> str:
    return element.name


FAST = [HR, HW, DISPLACEMENT, PLUS, PLUS_DISPLACEMENT, SIX, TRIANGLE]
OTHERS = [BENT, SIX_DISPLACEMENT, TRIANGLE_6, QUADRILATERAL_9]
SLOW = [pytest.param(e, marks=slow, id=e.name) for e in OTHERS]
ALL = [*(pytest.param(e, id=e.name) for e in FAST), *SLOW]


class Probe:
    """Energy, forces and tangent of a patch at given frames, its own unknowns settled."""

    def __init__(self, element: Element, flat: bool = False, law=None) -> None:
        self.q, self.forms, self.D = patch(element, flat, law)
        if not hasattr(self.forms, "start"):
            self.forms.start = self.q.frames.copy()
            local = self.forms.local
            self.forms.local_start = None if local is None else local.x.array.copy()
        self.unloaded = self.forms.start
        self.size = self.forms.increment.function_space.dofmap.bs

    def random(self, seed: int, size: float = 0.15) -> np.ndarray:
        H, rng = self.unloaded.copy(), np.random.default_rng(seed)
        retract(H, size * rng.normal(size=(len(H), self.size)))
        return superpose(H, rng.normal(size=3), rng.normal(size=3))

    def at(self, H: np.ndarray) -> "Probe":
        self.q.frames[:] = H
        self.forms.increment.x.array[:] = 0.0
        if self.forms.local is None:
            self.forms.update_stress()
            return self
        self.forms.local.x.array[:] = self.forms.local_start
        for _ in range(30):
            before = self.forms.local.x.array.copy()
            self.forms.update_stress()
            change = np.abs(self.forms.local.x.array - before).max()
            if change <= 1e-13 * np.abs(before).max():
                break
        return self

    def energy(self) -> float:
        return fem.assemble_scalar(self.forms.energy)

    def forces(self) -> np.ndarray:
        return fem.assemble_vector(self.forms.residual).array.copy()

    def tangent(self) -> np.ndarray:
        return fem.assemble_matrix(self.forms.tangent).to_dense()

    def along(self, H: np.ndarray, h: np.ndarray, step: float) -> float:
        moved = H.copy()
        retract(moved, step * h.reshape(len(H), -1))
        return self.at(moved).energy()


# --- invariance and derivatives -------------------------------------------------------------------


@pytest.mark.parametrize("element", ALL)
def test_rigid_motion_is_without_strain(element):
    model = Probe(element)
    scale = np.abs(model.at(model.random(1)).forces()).max()
    model.at(superpose(model.unloaded, np.array([1.9, -0.7, 1.2]), np.array([3.0, 1, -2])))
    assert np.abs(model.forces()).max() < 1e-13 * scale


@pytest.mark.parametrize("element", ALL)
@pytest.mark.parametrize("flat", [True, False], ids=["flat", "curved"])
def test_only_rigid_motions_are_without_energy(element, flat):
    """No hourglass modes; the tangent of the free patch is positive but for six zeros."""
    model = Probe(element, flat)
    values = np.linalg.eigvalsh(model.at(model.unloaded).tangent())
    assert np.abs(values[:6]).max() < 1e-12 * values[-1]
    # softest is the drilling, or bending of a cell of degree 2: neither is round-off
    assert values[6] > 1e-6 * values[-1]


@pytest.mark.parametrize("element", ALL)
def test_forces_turn_with_the_shell(element):
    """In local frames nothing changes at all."""
    model = Probe(element)
    H = model.random(2)
    turned = superpose(H, np.array([0.3, 2.0, -1.4]), np.array([5.0, -4, 3]))
    energy, forces, tangent = (f() for f in (model.at(H).energy, model.forces, model.tangent))
    model.at(turned)
    # settling an element's own unknowns stops at 1e-13 of the largest
    assert model.energy() == pytest.approx(energy, rel=1e-10)
    assert np.abs(model.forces() - forces).max() < 1e-10 * np.abs(forces).max()
    assert np.abs(model.tangent() - tangent).max() < 1e-10 * np.abs(tangent).max()


@pytest.mark.parametrize("element", ALL)
def test_forces_and_tangent_are_derivatives_of_the_energy(element):
    """Along the motion of ``retract``; the tangent is symmetric in any state."""
    model = Probe(element)
    H = model.random(3)
    forces, tangent = model.at(H).forces(), model.tangent()
    assert np.abs(tangent - tangent.T).max() < 1e-12 * np.abs(tangent).max()
    energy, rng, step = model.energy(), np.random.default_rng(3), 1e-4
    for _ in range(3):
        h = rng.normal(size=forces.size)
        ahead, back = (model.along(H, h, sign * step) for sign in (1, -1))
        # step² of third derivatives
        assert (ahead - back) / (2 * step) == pytest.approx(forces @ h, rel=1e-5)
        # 1e-16 / step² of the energy, and step² of fourth derivatives
        second = (ahead - 2 * energy + back) / step**2
        assert second == pytest.approx(h @ tangent @ h, rel=1e-5)


def test_hu_washizu_of_any_law_has_its_derivatives():
    model = Probe(HW, law=quartic)
    H = model.random(5)
    forces, tangent = model.at(H).forces(), model.tangent()
    h, energy, step = np.random.default_rng(5).normal(size=forces.size), model.energy(), 1e-4
    ahead, back = (model.along(H, h, sign * step) for sign in (1, -1))
    assert (ahead - back) / (2 * step) == pytest.approx(forces @ h, rel=1e-6)
    assert (ahead - 2 * energy + back) / step**2 == pytest.approx(h @ tangent @ h, rel=1e-5)


def test_hu_washizu_is_hellinger_reissner_for_a_quadratic_law():
    a, b = Probe(HR), Probe(HW)
    H = a.random(6)
    for model in (a, b):
        model.at(H)
    # 38 unknowns condensed in matrices with entries between t³ and 1/t³
    assert np.abs(a.forces() - b.forces()).max() < 1e-9 * np.abs(a.forces()).max()
    assert np.abs(a.tangent() - b.tangent()).max() < 1e-9 * np.abs(a.tangent()).max()


# --- patch tests ----------------------------------------------------------------------------------


def interior(model: Probe) -> np.ndarray:
    """Whether a node is not on the boundary of the patch; the middle node at least."""
    cells = model.q.function.function_space.dofmap.list
    X = model.unloaded[:, 0, :2]
    hull = np.array([[0, 0], [1, 0.2], [1.1, 1.2], [0.1, 1]])
    inside = np.ones(len(X), dtype=bool)
    for a, b in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        edge = b - a
        inside &= edge[0] * (X - a)[:, 1] - edge[1] * (X - a)[:, 0] > 1e-9
    assert inside.sum() >= 1 and cells.max() == len(X) - 1
    return inside


@pytest.mark.parametrize("element", ALL)
def test_membrane_patch(element):
    """A large homogeneous stretch of distorted cells: balanced inside, with the exact energy."""
    model = Probe(element, flat=True)
    H, F = model.unloaded.copy(), np.diag([1.2, 0.9, 1.0])
    F[0, 1] = F[1, 0] = 0.15  # without rotation: drilling stays where it is
    H[:, 0] = H[:, 0] @ F.T
    forces = model.at(H).forces().reshape(len(H), -1)
    inside = interior(model)
    assert np.abs(forces[inside, :2]).max() < 1e-10 * np.abs(forces[~inside]).max()
    E = (F.T @ F - np.eye(3)) / 2
    strain = np.array([E[0, 0], E[1, 1], 2 * E[0, 1]])
    # the patch is a parallelogram of sides (1, 0.2) and (0.1, 1)
    assert model.energy() == pytest.approx(0.98 / 2 * strain @ model.D[:3, :3] @ strain, rel=1e-12)


@pytest.mark.parametrize("element", ALL)
def test_bending_patch(element):
    """Small constant curvature and twist of distorted flat cells: balanced inside."""
    model = Probe(element, flat=True)
    H, curvature = model.unloaded.copy(), 1e-6 * np.array([[1.0, 0.4], [0.4, -0.7]])
    X = H[:, 0, :2].copy()
    H[:, 0, 2] = 0.5 * np.einsum("ni,ij,nj->n", X, curvature, X)
    slope = X @ curvature
    h = np.zeros((len(H), model.size))
    h[:, 3], h[:, 4] = slope[:, 1], -slope[:, 0]
    height = H[:, 0, 2].copy()
    retract(H, h)
    H[:, 0, 2] = height
    forces = model.at(H).forces().reshape(len(H), -1)
    inside = interior(model)
    # transverse forces and moments; those in the plane are of second order in the deflection
    bending = forces[:, 2:5]
    assert np.abs(bending[inside]).max() < 1e-9 * np.abs(bending[~inside]).max()


# --- bending to a circle, locking -----------------------------------------------------------------


@slow
def test_one_element_bends_to_the_exact_angle():
    """With the decoupled strain an end moment gives ML/EI, whatever the size of the angle."""
    length, t, E = 10.0, 0.1, 1e6
    mesh = grid((1, 1), lambda a, b: [length * a, b, 0 * a])
    q = fl.NodalFrames(mesh)
    D = section(E, 0.0, t)
    forms = BENT.forms(BENT.cells(q), D)
    X = q.frames[:, 0]
    held = np.zeros((4, 5), dtype=bool)
    held[X[:, 0] < 1e-9] = True
    moment = D[3, 3] * np.pi / 2 / length
    ends = np.flatnonzero(X[:, 0] > 1e-9)
    loads = [(i, np.zeros(3)) for i in ends]
    moments = [(i, np.array([0, moment / 2])) for i in ends]
    model = Statics(q, forms, held, loads, moments=moments)
    fl.stability.ArcLength(tolerance=1e-11).follow(model)
    t3 = q.frames[ends, 3]
    angle = np.arctan2(t3[:, 0], t3[:, 2])
    np.testing.assert_allclose(angle, np.pi / 2, rtol=1e-8)


def curved_beam(t: float, radius: float) -> float:
    """Deflection of a quarter circle under a radial unit end force, with shear and stretch."""
    EI, EA, GA = 1e6 * t**3 / 12, 1e6 * t, 5 / 6 * 0.5e6 * t
    return np.pi / 4 * (radius**3 / EI + radius / EA + radius / GA)


@pytest.mark.parametrize("element", [HR, TRIANGLE, pytest.param(TRIANGLE_6, marks=slow)], ids=ids)
@pytest.mark.parametrize("slenderness", [1e1, 1e2, 1e3, 1e4, 1e5])
def test_no_locking(element, slenderness):
    t = 10.0 / slenderness
    model = strip(element, (16, 1), t, 10.0)
    displacement = model.linear()
    tip = -np.mean([displacement[i, 0] for i, _ in model.loads])
    assert 0.97 < tip / curved_beam(t, 10.0) < 1.03


@pytest.mark.parametrize("slenderness", [1e1, 1e3, 1e5])
@pytest.mark.parametrize("element", [PLUS, PLUS_DISPLACEMENT], ids=ids)
def test_distorted_cells_do_not_lock_with_mitc4_plus(element, slenderness):
    """Trapezoids, warped by the curvature; MITC4 alone keeps a third of the deflection."""
    t = 10.0 / slenderness
    model = strip(element, (16, 1), t, 10.0, distortion=1.0)
    displacement = model.linear()
    tip = -np.mean([displacement[i, 0] for i, _ in model.loads])
    assert 0.97 < tip / curved_beam(t, 10.0) < 1.03


def test_hellinger_reissner_is_displacement_on_a_fine_mesh():
    tips = []
    for element in (HR, DISPLACEMENT):
        model = strip(element, (64, 2), 0.5, 10.0, distortion=0.3)
        displacement = model.linear()
        tips.append(-np.mean([displacement[i, 0] for i, _ in model.loads]))
    # both are of second order: (90°/64)² = 6e-4
    assert tips[0] == pytest.approx(tips[1], rel=2e-3)
    assert tips[0] == pytest.approx(curved_beam(0.5, 10.0), rel=2e-3)


# --- hemisphere -----------------------------------------------------------------------------------

REFERENCE = {0.04: (4.0753, 8.1524), 0.01: (3.8267, 7.0991)}


def pull(element: Element, count: int, t: float):
    model, a, b = hemisphere(element, count, t, {0.04: 400.0, 0.01: 5.0}[t])
    path = fl.stability.ArcLength().follow(model)
    x = model.positions()
    return np.array([x[a, 0] - 10, 10 - x[b, 1]]), path


@pytest.mark.parametrize(
    ("element", "count", "t", "tolerance"),
    [(HR, 16, 0.04, 0.01), (HW, 16, 0.04, 0.01), (HR, 24, 0.01, 0.015), (HW, 24, 0.01, 0.015),
     (HR, 32, 0.01, 0.005), (PLUS, 24, 0.01, 0.002), (DISPLACEMENT, 32, 0.01, 0.05),
     (TRIANGLE, 24, 0.01, 0.02)],
)  # fmt: skip
def test_hemisphere(element, count, t, tolerance):
    deflections, path = pull(element, count, t)
    np.testing.assert_allclose(deflections, REFERENCE[t], rtol=tolerance)
    assert path.total_iterations <= 18
    assert path.factors[-1] == 1.0


def test_six_parameters_are_five():
    """On the hemisphere, over five decades of the drilling stiffness."""
    five, _ = pull(HR, 16, 0.04)
    Gt = 6.825e7 / 2.6 * 0.04
    for factor in 10.0 ** np.arange(-8, -3):
        six, path = pull(Element("", drilling=factor * Gt), 16, 0.04)
        np.testing.assert_allclose(six, five, rtol=1e-4)
        assert path.total_iterations <= 18


# --- bad input ------------------------------------------------------------------------------------


def test_measures_for_other_cells_are_refused():
    q = fl.NodalFrames(grid((1, 1), lambda a, b: [a, b, 0 * a], "triangle"))
    with pytest.raises(ValueError, match=r"quadrilateral and degree 1, the frames .* triangle"):
        ShellCells(q)
    with pytest.raises(ValueError, match=r"degree 2, .* degree 1"):
        ShellCells(q, fl.elements.MITC6)
    with pytest.raises(ValueError, match="HellingerReissner"):
        shell.displacement(ShellCells(q, fl.elements.MITC3_PLUS), quartic)


def test_there_is_no_mixed_element_of_degree_2():
    q = fl.NodalFrames(grid((1, 1), lambda a, b: [a, b, 0 * a], "triangle"), 2)
    with pytest.raises(ValueError, match="no mixed element"):
        shell.hu_washizu(ShellCells(q, fl.elements.MITC6), quartic)


# --- arc length -----------------------------------------------------------------------------------


class Truss(fl.stability.Equilibrium):
    """Two shallow bars, pushed down in the middle: ``w³/2 − 3w²/2 + w = λ P``, limit 0.19245."""

    diameter = 2.0

    def __init__(self, load: float) -> None:
        self.w, self.load = 0.0, load

    def forces(self):
        w = self.w
        return np.array([0.5 * w**3 - 1.5 * w**2 + w]), np.array([self.load])

    def factorise(self, factor: float) -> None:
        self.k = 1.5 * self.w**2 - 3 * self.w + 1

    def solve(self, b):
        return b / self.k

    def move(self, dx) -> None:
        self.w += dx[0]

    def positions(self):
        return np.array([[0.0, 0.0, self.w]])

    def translations(self, dx):
        return np.array([[0.0, 0.0, dx[0]]])

    def twists(self, dx):
        return np.array([[0.0, 0.0, dx[0], 0.0, 0.0, 0.0]])

    def negative_pivots(self) -> int:
        return int(self.k < 0)

    def check_rotations(self, factor: float) -> None:
        """Bars have no turn that they must not make."""

    def check_passage(self, before) -> None:
        """Nothing touches."""

    def rotation_hint(self) -> str:
        return ""

    def state(self):
        return self.w

    def restore(self, state) -> None:
        self.w = state


def test_arc_length_passes_limit_points_and_stops_at_the_loads():
    """It snaps through at λ = 0.385, and the last state lies beyond."""
    path = fl.stability.ArcLength(loose=1e-9).follow(Truss(0.5), [0.2, 0.3, 1.0])
    below = np.roots([0.5, -1.5, 1, -0.1]).real.min(), np.roots([0.5, -1.5, 1, -0.15]).real.min()
    (beyond,) = [w.real for w in np.roots([0.5, -1.5, 1, -0.5]) if abs(w.imag) < 1e-9]
    np.testing.assert_allclose(path.states, [*below, beyond], rtol=1e-7)
    factors = np.array(path.factors)
    assert {0.2, 0.3, 1.0} <= set(path.factors)
    # the load falls between the limit points, below zero
    assert (np.diff(factors) < 0).any() and factors.max() == 1.0


def test_arc_length_says_where_it_gave_up():
    truss = Truss(0.5)
    truss.solve = lambda b: b * np.nan
    with pytest.raises(fl.ConvergenceError, match="no equilibrium beyond load factor 0") as caught:
        fl.stability.ArcLength().follow(truss)
    assert caught.value.result.failed_steps > 10
    assert truss.w == 0.0


@pytest.mark.parametrize("levels", [(), (0.5, 0.5), (0.0, 1.0), (-1.0,)])
def test_arc_length_wants_increasing_levels(levels):
    with pytest.raises(ValueError, match="positive and increase"):
        fl.stability.ArcLength().follow(Truss(0.5), levels)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    "element", [fl.elements.HellingerReissner, fl.elements.HuWashizu, fl.elements.DisplacementBased]
)
def test_an_element_that_refuses_cells_names_those_that_take_them(element, cell, degree):
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (1, 1), cell=cell, degree=degree)
    section = fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0))
    try:
        fl.Shell(mesh, section, formulation=element())
    except ValueError as error:
        advised = re.findall(r"(\w+)\(\)", str(error))
        assert advised
        assert element.__name__ not in advised
        for name in advised:
            fl.Shell(mesh, section, formulation=getattr(fl.elements, name)())
    else:
        assert (cell, degree) in element().defaults()
