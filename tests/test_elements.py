"""Laws that every element obeys, and what single elements are known for.

A new element is put into the lists of models.py.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpi4py import MPI

import models
import numpy as np
import pytest
import ufl
from dolfinx import fem
from hypothesis import given
from hypothesis import strategies as st
from models import BEAMS, ELEMENTS, D, built, few, hellinger_reissner_linear, straight, superpose

import fem_lie as fl
from fem_lie import lie
from fem_lie._form_cache import compile_expression
from fem_lie.elements.beams.directors import midpoint_strains
from fem_lie.elements.beams.element import bending_share, with_bending_flexibility
from fem_lie.elements.beams.geodesic import GEODESIC, geodesic_energy
from fem_lie.extend import StrainEnergy, cellwise
from fem_lie.forms.assembly import Assembly
from fem_lie.forms.cells import Cells, evaluate

seeds = st.integers(0, 2**32 - 1)
every_element = pytest.mark.parametrize("make", ELEMENTS, ids=lambda make: make.__name__)

STEP = 1e-5
# central differences: STEP² of third derivatives, some 100 of the values, and 1e-16 / STEP
DIFFERENCE = 1e-7


def differences(function, model, H):
    """Derivative of ``function()`` in the local increments of all nodes, by central differences."""
    columns = []
    for j in range(6 * len(H)):
        values = []
        for step in (STEP, -STEP):
            model.at(H).frames.update(step * np.eye(1, 6 * len(H), j))
            values.append(function())
        columns.append((values[0] - values[1]) / (2 * STEP))
    model.at(H)
    return np.array(columns).T


@every_element
@given(seed=seeds)
@few
def test_residual_is_derivative_of_energy(make, seed):
    model = built(make)
    H = model.random(seed)
    model.at(H).settle()
    residual = model.residual()
    numeric = differences(model.energy_value, model, H)
    assert np.abs(residual - numeric).max() < DIFFERENCE * np.abs(residual).max()


@every_element
@given(seed=seeds)
@few
def test_tangent_is_derivative_of_residual(make, seed):
    model = built(make)
    H = model.random(seed)
    model.at(H).settle()
    tangent = model.tangent()
    numeric = differences(model.residual, model, H)
    assert np.abs(tangent - numeric).max() < DIFFERENCE * np.abs(tangent).max()


@every_element
@given(seed=seeds)
@few
def test_rigid_motion_changes_nothing(make, seed):
    """1000 rad about a random axis, 1000 lengths away."""
    model, rng = built(make), np.random.default_rng(seed)
    H = model.random(seed)
    model.at(H).settle()
    energy, residual, tangent = model.energy_value(), model.residual(), model.tangent()
    axis, way = rng.normal(size=(2, 3))
    model.at(superpose(H, 1000 * axis / np.linalg.norm(axis), 1000 * way / np.linalg.norm(way)))
    # round-off: positions of 1000 lose 1e-13 of a length in the strain
    assert model.energy_value() == pytest.approx(energy, rel=1e-10)
    assert np.abs(model.residual() - residual).max() < 1e-10 * np.abs(residual).max()
    assert np.abs(model.tangent() - tangent).max() < 1e-10 * np.abs(tangent).max()


@every_element
def test_forces_of_an_element_are_in_equilibrium(make):
    """The nodal forces and moments, as global vectors about the origin, have no resultant."""
    model = built(make)
    H = model.random(3)
    model.at(H).settle()
    local = model.residual().reshape(-1, 6)
    R = lie.rotation(H)
    force, moment = (np.einsum("nij,nj->ni", R, local[:, k : k + 3]) for k in (0, 3))
    moment = moment + np.cross(H[:, 0], force)
    scale = np.abs(local).max()
    # sums of a few terms of the size of the forces
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * scale
    assert np.abs(moment.sum(axis=0)).max() < 1e-11 * scale


@pytest.mark.parametrize("make", BEAMS, ids=lambda make: make.__name__)
def test_tangent_is_symmetric_without_nodal_forces(make):
    """``K − Kᵀ`` is made of the nodal forces alone: one block per node, P of the force there."""
    model = built(make)
    model.at(model.random(5)).settle()
    K, r = model.tangent(), model.residual().reshape(-1, 6)
    expected = np.zeros_like(K)
    for i, g in enumerate(r):
        expected[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = lie.se3_coadjoint(g)
    assert np.abs(K - K.T - expected).max() < 1e-12 * np.abs(K).max()


# --- strain measures ------------------------------------------------------------------------------


def circle(count: int, angle: float, radius: float) -> np.ndarray:
    """Frames along an arc in the plane of e₁, e₂, with e₁ along the tangent."""
    motion = np.array([radius * angle / count, 0, 0, 0, 0, angle / count])
    H = [lie.se3_exp(np.zeros(6))]
    for _ in range(count):
        H.append(lie.se3_retract(H[-1], motion))
    return np.array(H)


def test_director_strains_of_an_arc():
    """A line of unit length bent to an arc: stretch 1 and curvature 1/r up to the chords."""
    count, angle = 50, 1.3
    q = fl.NodalFrames(straight(MPI.COMM_SELF, 1.0, count))
    q.frames[np.argsort(q.frames[:, 0, 0])] = circle(count, angle, 1.0 / angle)
    stretch, curvature = fl.elements.director_strains(q)
    strain = compile_expression(ufl.as_vector([*stretch, *curvature]), np.array([[0.5]]))
    values = strain.eval(q.function.function_space.mesh, np.arange(count, dtype=np.int32))
    values = values.reshape(count, 6)  # DOLFINx 0.11 keeps the axis of the points
    # θ²/12 of the angle θ of one element
    np.testing.assert_allclose(values, [[1, 0, 0, 0, 0, angle]] * count, atol=2e-4)


@pytest.mark.parametrize(("angle", "tolerance"), [(1e-7, 1e-15), (np.pi / 4, 2e-12), (2.0, 2e-7)])
def test_midpoint_strains_are_mean_rotation_and_angle(angle, tolerance):
    """``R_mᵀ Δx / L`` to round-off, and the rotation vector over L but for a cut-off fraction."""
    L, rng = 1.5, np.random.default_rng(2)
    axis, way = rng.normal(size=(2, 3))
    turn = angle * axis / np.linalg.norm(axis)
    q = fl.NodalFrames(straight(MPI.COMM_SELF, L, 1))
    first = np.argmin(q.frames[:, 0, 0])
    q.frames[first] = lie.se3_exp(rng.normal(size=6))
    R = lie.rotation(q.frames[first])
    q.frames[1 - first] = lie.frame(q.frames[first, 0] + way, R @ lie.so3_exp(turn))
    stretch, curvature, _ = midpoint_strains(q)
    strain = compile_expression(ufl.as_vector([*stretch, *curvature]), np.array([[0.5]]))
    values = strain.eval(q.function.function_space.mesh, np.zeros(1, dtype=np.int32)).ravel()
    middle = R @ lie.so3_exp(turn / 2)
    # sums of a few products of order one
    np.testing.assert_allclose(values[:3], middle.T @ way / L, atol=1e-14)
    np.testing.assert_allclose(values[3:], turn / L, atol=tolerance)


def single_element(section, length, flexible):
    """One straight geodesic element."""
    mesh = straight(MPI.COMM_SELF, length, 1)
    q = fl.NodalFrames(mesh)
    relative, ell = np.array([[length, 0, 0, 0, 0, 0]]), np.array([length])
    stiffness = section[np.newaxis]
    if flexible:
        stiffness = with_bending_flexibility(stiffness, relative)
    d, d0, L, C = (fl.extend.cellwise(mesh, a) for a in (relative, relative, ell, stiffness))
    energy = geodesic_energy(d, d0, L, C, mesh)
    return q, fl.extend.LocalFrameForms(energy, q.function, q.increment, GEODESIC, coordinates=d)


def slender_section(slenderness: float) -> np.ndarray:
    """EA, GA, GA, GJ, EI, EI of a bar of length 1 and side 1/slenderness."""
    a = 1.0 / slenderness
    return np.diag([a**2, a**2 / 3, a**2 / 4, a**4 / 20, a**4 / 12, a**4 / 15])


@pytest.mark.parametrize("slenderness", [1e1, 1e2, 1e3, 1e4, 1e5])
@pytest.mark.parametrize("kind", ["geodesic", "Hellinger-Reissner"])
def test_one_element_is_timoshenkos_cantilever(kind, slenderness):
    """Tip force and tip moment, deflection and rotation, in both planes."""
    section = slender_section(slenderness)
    GA, EI = np.diag(section)[1:3], np.diag(section)[[5, 4]]
    if kind == "geodesic":
        _, forms = single_element(section, 1.0, True)
    else:
        rest = np.array([1.0, 0, 0, 0, 0, 0])
        forms = hellinger_reissner_linear(straight(MPI.COMM_SELF, 1.0, 1), section, rest).forms
    K = fem.assemble_matrix(forms.tangent).to_dense()[6:, 6:]
    scale = np.sqrt(np.diag(K))
    flexibility = np.linalg.inv(K / np.outer(scale, scale)) / np.outer(scale, scale)
    y, z = flexibility[np.ix_([1, 5], [1, 5])], flexibility[np.ix_([2, 4], [2, 4])]
    # round-off grows with the ratio of shear to bending stiffness, slenderness²
    tolerance = max(1e-10, 1e-16 * slenderness**2)
    assert tolerance <= 1e-6
    for got, ga, ei, sign in ((y, GA[0], EI[0], 1), (z, GA[1], EI[1], -1)):
        exact = np.array([[1 / (3 * ei) + 1 / ga, sign / (2 * ei)], [sign / (2 * ei), 1 / ei]])
        np.testing.assert_allclose(got, exact, rtol=tolerance)


def test_without_bending_flexibility_one_element_is_too_stiff():
    section = slender_section(100.0)
    K = fem.assemble_matrix(single_element(section, 1.0, False)[1].tangent).to_dense()[6:, 6:]
    tip = np.linalg.inv(K)[1, 1]
    # one-point integration of a linear rotation: 1/4 instead of 1/3 of L³/EI
    assert tip == pytest.approx(1 / (4 * section[5, 5]) + 1 / section[1, 1], rel=1e-9)


def test_linear_moments_are_the_bending_flexibility():
    """Condensed, they are the one-point element with the compliance added: at any deformation."""
    count, length = 3, 2.0
    mesh = straight(MPI.COMM_SELF, length, count)
    rest = np.array([1.0, 0, 0, 0, 0, 0])
    mixed = hellinger_reissner_linear(mesh, D, rest)
    q = fl.NodalFrames(mesh)
    C = with_bending_flexibility(D[np.newaxis], length / count * np.eye(1, 6))[0]
    stretch, curvature = fl.elements.director_strains(q)
    strain = ufl.as_vector([*stretch, *curvature]) - ufl.as_vector(rest.tolist())
    energy = 0.5 * ufl.inner(strain, ufl.as_matrix(C.tolist()) * strain) * models.measure(mesh, 1)
    forms = fl.local_frame_forms(energy, q)
    H = mixed.random(11)
    mixed.at(H).settle()
    q.frames[:] = H
    residual = fem.assemble_vector(forms.residual).array
    tangent = fem.assemble_matrix(forms.tangent).to_dense()
    # round-off of inverting a 6×6 matrix of condition 30 twice
    assert np.abs(mixed.residual() - residual).max() < 1e-12 * np.abs(residual).max()
    assert np.abs(mixed.tangent() - tangent).max() < 1e-12 * np.abs(tangent).max()
    assert np.abs(C - D).max() > 1.0  # the flexibility is there at all


# --- forces and energy of the geodesic beam by hand are those that UFL derives ---


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


@dataclass(frozen=True)
class Stressed(fl.elements.BeamFormulation):
    """A beam of which the strains of the unloaded configuration are not subtracted."""

    degree: int = 1

    def forms(self, nodal, cells):
        mesh = nodal.function.function_space.mesh
        arc = cellwise(mesh, cells.lengths) / ufl.CellVolume(mesh)
        stretch, curvature = fl.elements.director_strains(nodal)
        strain = ufl.as_vector([*stretch, *curvature]) / arc - cells.eigenstrain
        C = cellwise(mesh, cells.stiffness)
        energy = StrainEnergy(
            strain, lambda e: ufl.inner(e, C * e) / 2, ufl.dx(mesh, degree=1), weight=arc
        )
        return fl.local_frame_forms(energy, nodal)


def test_an_element_with_forces_in_the_unloaded_configuration_is_refused():
    scene = fl.Scene()
    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)
    section = fl.Section.rectangle(0.1, 0.1, fl.Material(1e7, 0.0, 1.0))
    beam = scene.add(fl.Beam(line, section, formulation=Stressed()))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -1.0)))
    with pytest.raises(ValueError, match=r"Stressed: .* unloaded configuration.*present_values"):
        fl.statics(scene)
