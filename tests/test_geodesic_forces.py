"""Forces and energy of the geodesic beam by hand are those that UFL derives of its energy."""

from __future__ import annotations

from mpi4py import MPI

import models
import numpy as np
import pytest
from dolfinx import fem

import fem_lie as fl
from fem_lie import lie
from fem_lie.elements.beams.element import bending_share, with_bending_flexibility
from fem_lie.elements.beams.geodesic import GEODESIC, geodesic_energy
from fem_lie.forms.assembly import Assembly
from fem_lie.forms.cells import Cells, evaluate


def both(count: int) -> tuple[fl.NodalFrames, fl.extend.LocalFrameForms, fl.extend.LocalFrameForms]:
    """By hand, and derived: of any stiffness, strained at rest."""
    mesh, rng = models.straight(MPI.COMM_SELF, 1.5, count), np.random.default_rng(5)
    q = fl.NodalFrames(mesh)
    q.update(0.2 * rng.normal(size=(count + 1, 6)))
    ends = q.frames[q.function.function_space.dofmap.list]
    relative = lie.se3_relative(ends[:, 0], ends[:, 1])
    factors = rng.normal(size=(count, 6, 6))
    section = np.einsum("eij,ekj->eik", factors, factors)
    lengths = rng.uniform(0.5, 2.0, count)
    eigenstrain = fl.extend.cellwise(mesh, rng.normal(size=(count, 6)))
    nothing = np.zeros((count, 4, 4)), eigenstrain, None, np.zeros((count, 2))
    cells = fl.extend.CellData(lengths, section, *nothing)
    stiffness = with_bending_flexibility(section, relative)
    share = fl.extend.cellwise(mesh, bending_share(section, stiffness))
    d, d0, ell, D = (fl.extend.cellwise(mesh, a) for a in (relative, relative, lengths, stiffness))
    energy = geodesic_energy(d, d0, ell, D, mesh, eigenstrain, share=share)
    derived = fl.extend.LocalFrameForms(energy, q.function, q.increment, GEODESIC, coordinates=d)
    return q, fl.elements.GeodesicBeam().forms(q, cells), derived


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.1, 1.0], ids=str)
def test_forces_and_energy_are_those_of_the_energy(size):
    q, by_hand, derived = both(4)
    q.update(size * np.random.default_rng(6).normal(size=(5, 6)))
    wanted = fem.assemble_vector(derived.residual).array
    largest = np.abs(wanted).max()
    np.testing.assert_allclose(
        fem.assemble_vector(by_hand.residual).array, wanted, atol=1e-14 * largest
    )
    assembly = Assembly(q, by_hand, np.arange(5), np.arange(4), None)
    cells = Cells([(slice(0, 5), assembly)])
    F, W = np.empty((8, 6)), np.empty(4)
    evaluate(cells.table, q.frames, np.zeros((5, 4, 3)), F, W)
    assert W.sum() == pytest.approx(fem.assemble_scalar(derived.energy), rel=1e-13)
    r = np.zeros((5, 6))
    np.add.at(r, cells.table.nodes, F)
    np.testing.assert_allclose(r.ravel(), wanted, atol=1e-14 * largest)
