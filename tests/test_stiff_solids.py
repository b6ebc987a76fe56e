"""Solids of any stiffness in conserving schemes, and energies without cancellation."""

from collections.abc import Callable

import numpy as np
import pytest
import ufl
from basix.ufl import element
from ufl.algorithms.apply_derivatives import apply_derivatives
from ufl.core.expr import Expr

import fem_lie as fl

PLANE = ufl.Mesh(element("Lagrange", "triangle", 1, shape=(2,)))
SMALL = [1e-16, 1e-12, 1e-8, 1e-5, 1e-3, 0.0999, 0.1001, 0.5, 3.0]


@pytest.mark.parametrize("x", [*SMALL, *(-x for x in SMALL if x < 1.0)])
@pytest.mark.parametrize(
    ("function", "exact", "slope"),
    [
        (fl.sections.log1p, np.log1p, lambda x: 1.0 / (1.0 + x)),
        (fl.sections.expm1, np.expm1, np.exp),
    ],
    ids=["log1p", "expm1"],
)
def test_small_changes_have_all_digits(function, exact, slope, x):
    at = ufl.variable(ufl.SpatialCoordinate(PLANE)[0])
    found = function(at)
    assert found((x, 0.0)) == pytest.approx(exact(x), rel=4e-15)
    derivative = apply_derivatives(ufl.diff(found, at))
    assert derivative((x, 0.0)) == pytest.approx(slope(x), rel=1e-14)


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e-2, 0.5])
def test_a_determinant_has_all_digits_of_its_change(size):
    """Powers of two, so that ``1 + A`` is exact."""
    size = 2.0 ** np.round(np.log2(size))
    A = size * np.array([[1.0, 0.5, 0.25], [0.5, -0.5, 0.125], [0.25, 0.125, 0.75]])
    exact = np.trace(A) + 0.5 * (np.trace(A) ** 2 - (A * A).sum()) + np.linalg.det(A)
    found = fl.sections.det_minus_one(ufl.as_matrix((np.eye(3) + A).tolist()))(())
    assert found == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize("strain", [2.0**-40, 2.0**-20, 2.0**-10, 0.25])
def test_neo_hooke_has_all_digits_of_small_strains(strain):
    """Against ``½ μ (tr A − ln(1 + a)) + ⅛ λ ln(1 + a)²`` for ``C = 1 + A``, by its series."""
    law = fl.sections.NeoHooke(3.0, 0.3)
    λ, μ = law.parameters
    a = np.array([strain, -0.5 * strain, 0.25 * strain])
    # ½ μ Σ (a − ln(1 + a)): each term is a²/2 − a³/3 …
    k = np.arange(2, 60)
    terms = ((-1.0) ** k / k * a[:, np.newaxis] ** k).sum()
    exact = 0.5 * μ * terms + 0.125 * λ * np.log1p(a).sum() ** 2
    found = law.energy(ufl.as_matrix(np.diag(1.0 + a).tolist()), λ, μ)(())
    # what is left is of first order in strain, as round-off of C is
    assert found == pytest.approx(exact, rel=1e-13, abs=4e-16 * μ * strain)


def naive(C: Expr, λ: Expr, μ: Expr) -> Expr:
    """Neo-Hooke as textbooks have it."""
    log = 0.5 * ufl.ln(ufl.det(C))
    return 0.5 * μ * (ufl.tr(C) - 3.0 - 2.0 * log) + 0.5 * λ * log**2


def fung(C: Expr, λ: Expr, μ: Expr) -> Expr:
    """An exponential, with small strains as the others have them."""
    E = 0.5 * (C - ufl.Identity(3))
    return μ * fl.sections.expm1(ufl.inner(E, E)) + 0.5 * λ * ufl.tr(E) ** 2


def spun(law: fl.sections.SolidMaterial, held: str, **mesh: object) -> fl.Scene:
    body = fl.Solid.brick((1.0, 0.2, 0.2), law, cells=(2, 1, 1), **mesh)
    scene = fl.Scene(gravity=(0, 0, 0) if held == "free" else (0, 0, -9.81))
    scene.add(body)
    if held == "free":
        body.add_velocity(omega=(1, 2, 3), about=(0.5, 0.1, 0.1))
    elif held == "clamped":
        body.clamp("a=0")
    else:
        scene.add(fl.joints.Spherical(fl.ground(), body.point("a=0")))
    return scene


def ran(scheme: fl.EnergyMomentum | fl.EnergyDecaying, scene: fl.Scene) -> fl.Result:
    return scheme.run(scene, duration=0.01, step=1e-3, progress=False)


LAWS: dict[str, Callable[[float], fl.sections.SolidMaterial]] = {
    "neo-Hooke": lambda E: fl.sections.NeoHooke(E, 0.3, 1000.0),
    "Fung": lambda E: fl.sections.Hyperelastic(
        fung, 1000.0, fl.sections.NeoHooke(E, 0.3).parameters
    ),
}
SCHEMES = {"conserving": fl.EnergyMomentum(), "decaying": fl.EnergyDecaying(radius=0.8)}


@pytest.mark.parametrize("E", [1e7, 1e9, 2e11])
@pytest.mark.parametrize("held", ["free", "clamped", "joint"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_stiff_solids_move_as_saint_venants(scheme, law, held, E):
    """In full steps, in as many iterations, to as many digits."""
    found = ran(SCHEMES[scheme], spun(LAWS[law](E), held))
    linear = ran(SCHEMES[scheme], spun(fl.sections.SaintVenantKirchhoff(E, 0.3, 1000.0), held))
    assert found.divided == linear.divided == 0
    assert found.iterations[-1] <= 1.2 * linear.iterations[-1] + 5
    assert found.balance_error <= 1e-13 + 20.0 * linear.balance_error


@pytest.mark.parametrize("held", ["free", "joint"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_steel_takes_long_steps_whole(scheme, held):
    """A matrix of the start of the step is that of a body that has yet to rotate to its midpoint.

    Where it fails, corrections that learn from each other reach the end with one more.
    """
    scene = spun(fl.sections.SaintVenantKirchhoff(2e11, 0.3, 7800.0), held)
    result = SCHEMES[scheme].run(scene, duration=0.1, step=0.01, progress=False)
    assert result.divided == 0
    assert result.factorisations <= 25
    assert result.iterations[-1] <= 250
    assert result.balance_error <= 5e-10


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_stiff_solids_of_degree_two(cell):
    """Of steel."""
    result = ran(fl.EnergyMomentum(), spun(LAWS["neo-Hooke"](2e11), "free", cell=cell, degree=2))
    assert result.divided == 0
    assert result.energy_error <= 1e-10


@pytest.mark.parametrize("E", [1e7, 1e9])
def test_a_material_with_cancellation_runs_and_is_named(E, caplog):
    """Energy is conserved as far as the law has it: to an ulp of a stiffness times a volume."""
    law = fl.sections.NeoHooke(E, 0.3, 1000.0)
    result = ran(
        fl.EnergyMomentum(), spun(fl.sections.Hyperelastic(naive, 1000.0, law.parameters), "free")
    )
    assert result.divided == 0
    assert "are differences of larger numbers" in caplog.text and "log1p" in caplog.text
    known = np.finfo(np.float64).eps * law.parameters[1] * 0.04
    assert np.ptp(result.total_energy) <= 100 * known
    caplog.clear()
    ran(fl.EnergyMomentum(), spun(law, "free"))
    assert "larger numbers" not in caplog.text
