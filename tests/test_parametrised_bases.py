"""Bases of several results, and bases at parameters between those of others."""

import numpy as np
import pytest
import scipy.linalg

import fem_lie as fl
from benchmarks import parametrised_basis as crane

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)


def rod(length=1.0, cells=8):
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    return scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells, name="rod"))


def subspace(basis):
    """Orthonormal vectors (6 n, m) of dimensionless modes."""
    units = np.repeat([basis.body.model.size, 1.0], 3)
    return np.linalg.qr((basis.modes / units).reshape(len(basis), -1).T)[0]


def largest_angle(one, other):
    return scipy.linalg.subspace_angles(subspace(one), subspace(other)).max()


@pytest.fixture
def turning(rng):
    """Bases of two modes whose subspaces rotate at constant rates, by parameter."""
    body = rod()
    Q = np.linalg.qr(rng.uniform(-1.0, 1.0, (54, 4)))[0].T

    def basis(t):
        V = [np.cos(r * t) * Q[2 * k] + np.sin(r * t) * Q[2 * k + 1] for k, r in ((0, 0.3), (1, 1))]
        units = np.repeat([body.model.size, 1.0], 3)
        return fl.reduction.Basis(body, np.reshape(V, (2, -1, 6)) * units)

    return basis


def test_a_geodesic_is_interpolated_exactly(turning):
    at = [0.0, 0.5, 1.0]
    bases = [turning(t) for t in at]
    for t in (0.2, 0.8, 0.5, 1.2):
        found = fl.reduction.interpolated_basis(bases, at, t)
        assert largest_angle(found, turning(t)) < 1e-7


def test_order_sign_and_size_of_modes_do_not_matter(turning):
    at = [0.0, 0.5, 1.0]
    bases = [turning(t) for t in at]
    mixed = [fl.reduction.Basis(b.body, -3.0 * b.modes[::-1]) for b in bases]
    one, other = (fl.reduction.interpolated_basis(b, at, 0.7) for b in (bases, mixed))
    assert largest_angle(one, other) < 1e-7


def test_two_parameters(turning):
    """The subspace depends on their sum."""
    at = [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5)]
    bases = [turning(sum(each)) for each in at]
    found = fl.reduction.interpolated_basis(bases, at, (0.3, 0.15))
    assert largest_angle(found, turning(0.45)) < 1e-7


def test_modes_of_a_uniform_rod_do_not_depend_on_its_length():
    """So those of other lengths serve it, transferred or interpolated."""
    bases = []
    for length in (1.0, 2.0, 4.0):
        scene = fl.Scene()
        thick = 0.02 * length  # so that all ratios are those of the others
        section = fl.Section.rectangle(thick, 1.5 * thick, STEEL)
        body = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=8))
        scene.add(fl.Clamp(body.point("start")))
        bases.append(fl.reduction.craig_bampton(scene, [], 4))
    assert largest_angle(bases[0].transferred(bases[2].body), bases[2]) < 1e-6
    found = fl.reduction.interpolated_basis(bases[:2], (1.0, 2.0), 4.0, bases[2].body)
    assert found.body is bases[2].body and largest_angle(found, bases[2]) < 1e-6


def test_pod_of_several_results_represents_all_of_them():
    """Rods of two lengths, one bent to each side: two modes for both, one is not enough."""
    bodies, results = [], []
    for length, force in ((1.0, (0, 0, 300.0)), (2.0, (0, 100.0, 0))):
        body, scene = rod(length), fl.Scene()
        scene.add(body)
        scene.add(fl.Clamp(body.point("start")))
        scene.add(fl.PointLoad(body.point("end"), force=force))
        bodies.append(body)
        results.append(fl.statics(scene))
    axes = fl.reduction.FixedAxes()
    for modes, enough in ((1, False), (2, True)):
        basis = fl.reduction.pod(results, bodies, modes, axes=axes)
        away = [
            float(basis.transferred(body).project(result, axes=axes).errors[-1])
            for body, result in zip(bodies, results, strict=True)
        ]
        assert (max(away) < 1e-9) == enough, away


def test_a_crane_arm_between_training_points():
    """Lengths and loads of the benchmark, in one corner of its table."""
    keys = [(11.0, 500.0), (11.0, 2000.0), (14.0, 500.0)]
    runs = {key: crane.full(*key) for key in keys}
    at = (12.0, 900.0)
    found = crane.errors(runs, crane.full(*at), at, 4)
    assert found["POD of all"] < 0.01 and found["interpolated"] < 0.01, found


def test_wrong_bases_and_parameters(turning):
    bases = [turning(t) for t in (0.0, 0.5, 1.0)]
    at = (0.0, 0.5, 1.0)
    for call, message in (
        (lambda: fl.reduction.interpolated_basis(bases, (0.0, 1.0), 0.5), r"shape \(3, 1\)"),
        (lambda: fl.reduction.interpolated_basis(bases[:1], (0.0,), 0.5), "at least 2 bases"),
        (
            lambda: fl.reduction.interpolated_basis(bases, [(0, 0), (1, 1), (2, 2)], (0.5, 0.5)),
            "line or plane",
        ),
        (
            lambda: fl.reduction.interpolated_basis([*bases[:2], turning(np.pi / 2)], at, 0.1),
            "nearly orthogonal",
        ),
        (lambda: fl.reduction.interpolated_basis(bases, at, 0.1, rod(cells=4)), "9, .* has 5"),
        (lambda: bases[0].transferred(rod(cells=4)), "9 nodes"),
        (lambda: fl.reduction.pod([], [], 1), "a body for each result"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
