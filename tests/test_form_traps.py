"""Mistakes that users of own forms make: each works, or is refused with a clear message."""

from mpi4py import MPI

import models
import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

import fem_lie as fl


@pytest.fixture
def case():
    return own_beam()


def own_beam():
    """Mesh, frames and strains of a line of two elements."""
    msh = models.line(MPI.COMM_SELF, 2, 3)
    q = fl.NodalFrames(msh)
    stretch, curvature = fl.elements.director_strains(q)
    return msh, q, ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])


def quadratic(strain):
    return ufl.inner(strain, strain) / 2


def forms_of(case):
    msh, q, strain = case
    return fl.local_frame_forms(quadratic(strain) * ufl.dx(msh), q)


def support(q, value=0.0):
    V = q.increment.function_space
    return fem.dirichletbc(np.full(6, value), np.array([0], np.int32), V)


def local(msh, family, degree):
    return fem.Function(fem.functionspace(msh, (family, degree, (6,))))


def mixed(case, resultants):
    msh, q, strain = case
    energy = ufl.inner(resultants, strain) - ufl.inner(resultants, resultants) / 2
    return fl.local_frame_forms(energy * ufl.dx(msh), q, local=resultants)


TRAPS = {
    "continuous local field": (
        lambda c: mixed(c, local(c[0], "Lagrange", 1)),
        r"local.*discontinuous|continuous between cells",
    ),
    "local field on another mesh": (
        lambda c: mixed(c, local(own_beam()[0], "DG", 0)),
        "expected an energy on the mesh of the frames",
    ),
    "local field is no function": (
        lambda c: fl.local_frame_forms(quadratic(c[2]) * ufl.dx(c[0]), c[1], local="DG"),
        "local must be a function of DOLFINx, or None",
    ),
    "energy not integrated": (
        lambda c: fl.local_frame_forms(quadratic(c[2]), c[1]),
        r"energy must be a UFL form, such as w \* ufl.dx\(mesh\)",
    ),
    "energy without frames": (
        lambda c: fl.local_frame_forms(fem.Constant(c[0], 1.0) * ufl.dx(c[0]), c[1]),
        "the energy does not depend on the coordinates",
    ),
    "frames of another mesh": (
        lambda c: fl.local_frame_forms(quadratic(c[2]) * ufl.dx(c[0]), own_beam()[1]),
        "expected an energy on the mesh of the frames",
    ),
    "measure of another mesh": (
        lambda c: fl.local_frame_forms(quadratic(c[2]) * ufl.dx(own_beam()[0]), c[1]),
        "expected an energy on the mesh of the frames",
    ),
    "coordinates for frames": (
        lambda c: fl.local_frame_forms(quadratic(c[2]) * ufl.dx(c[0]), c[1].function),
        "q must be NodalFrames",
    ),
    "interior facets": (
        lambda c: fl.local_frame_forms(ufl.avg(c[1].position[0]) * ufl.dS(c[0]), c[1]),
        "over cells .* or over exterior facets",
    ),
    "no quadrature degree": (
        lambda c: fl.local_frame_forms(fl.extend.StrainEnergy(c[2], quadratic, ufl.dx(c[0])), c[1]),
        "measure of a StrainEnergy needs a quadrature degree",
    ),
    "degree zero": (
        lambda c: fl.NodalFrames(c[0], degree=0),
        "NodalFrames: degree",
    ),
    "plane mesh": (
        lambda c: fl.NodalFrames(mesh.create_unit_square(MPI.COMM_SELF, 2, 2)),
        "gdim 3, got gdim 2",
    ),
    "points for a mesh": (
        lambda c: fl.NodalFrames(c[0].geometry.x),
        "NodalFrames: mesh must be a mesh of DOLFINx",
    ),
    "supports on another mesh": (
        lambda c: fl.FrameProblem(forms_of(c), c[1], [support(own_beam()[1])]),
        "expected bcs on q.increment.function_space",
    ),
    "support of one component": (
        lambda c: fl.FrameProblem(
            forms_of(c),
            c[1],
            [fem.dirichletbc(0.0, np.array([0], np.int32), c[1].increment.function_space.sub(0))],
        ),
        "expected bcs on q.increment.function_space",
    ),
    "support without a list": (
        lambda c: fl.FrameProblem(forms_of(c), c[1], support(c[1])),
        "bcs must be a sequence of supports",
    ),
    "UFL for forms": (
        lambda c: fl.FrameProblem([quadratic(c[2]) * ufl.dx(c[0])], c[1]),
        "forms must be forms of fl.local_frame_forms",
    ),
    "complex force": (
        lambda c: fl.extend.dead_force(
            fem.Constant(c[0], np.array([1j, 0, 0])), ufl.dx(c[0]), c[1]
        ),
        "expected force of real numbers, got the complex",
    ),
    "force in the plane": (
        lambda c: fl.extend.dead_force(ufl.as_vector([1.0, 0.0]), ufl.dx(c[0]), c[1]),
        r"expected force as a UFL vector of shape \(3,\)",
    ),
    "increments of the wrong size": (
        lambda c: c[1].update(np.zeros(5)),
        "h must have 6 values for each of",
    ),
}


@pytest.mark.parametrize("trap", TRAPS)
def test_traps_are_refused(case, trap):
    attempt, message = TRAPS[trap]
    with pytest.raises((TypeError, ValueError), match=message):
        attempt(case)


def test_two_quadrature_degrees_add(case):
    """One form over two rules is the sum of a form over each."""
    msh, q, _ = case
    q.update(np.linspace(-0.1, 0.1, q.increment.x.array.size))
    w = ufl.inner(q.position, q.position) * q.position[0] ** 2
    # UFL 2024.2 merges integrals of the same integrand, also of a plain form: here they differ
    low, high = 2 * w * ufl.dx(msh, degree=1), w * ufl.dx(msh, degree=5)
    found, *parts = (
        fem.assemble_vector(fl.local_frame_forms(energy, q).residual).array
        for energy in (low + high, low, high)
    )
    assert np.abs(parts[0] - parts[1]).max() > 1e-3
    np.testing.assert_allclose(found, sum(parts), atol=1e-13)
