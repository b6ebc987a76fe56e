"""Floating frames, reduction bases, and errors of reduced-order bodies."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import mass_and_stiffness

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)


def rod(cells=8, *, clamped=True, end=(1.0, 0.0, 0.0)):
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    body = scene.add(fl.Beam.straight((0, 0, 0), end, section, cells=cells, name="rod"))
    if clamped:
        scene.add(fl.Clamp(body.point("start")))
    return scene, body


def square(cells=3):
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.1 * a * b), (cells, cells))
    body = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL), name="plate"))
    return scene, body


def states(scene, frames):
    """A result with any frames of the nodes of the body, in its order."""
    result, ordered = fl.statics(scene), np.empty_like(frames)
    ordered[:, result.info.bodies[0].nodes] = frames
    return replace(result, frames=ordered)


def motions(rng, count):
    return lie.se3_exp(rng.uniform(-2.0, 2.0, (count, 6)))


AXES = pytest.mark.parametrize(
    "axes", [fl.reduction.MeanAxes(), fl.reduction.NodeAxes(0), fl.reduction.NodeAxes(5)], ids=str
)


@AXES
def test_a_rigid_motion_is_found_and_nothing_is_left(rng, axes):
    scene, body = rod()
    bent = lie.se3_retract(body.frames, 0.02 * rng.normal(size=(2, 9, 6)))
    basis, G = fl.reduction.pod(states(scene, bent), body, 2, axes=axes), motions(rng, 4)
    moved = states(scene, lie.se3_compose(G[:, np.newaxis], body.frames))
    found = basis.project(moved, axes=axes)
    np.testing.assert_allclose(found.rigid, G, atol=1e-13)
    np.testing.assert_allclose(found.coordinates, 0.0, atol=1e-12)
    # nothing is left beside the modes, either
    np.testing.assert_allclose(found.expand(), moved.frames, atol=1e-12)
    with pytest.raises(ValueError, match="modes must be at most 0"):
        fl.reduction.pod(moved, body, 1, axes=axes)


@AXES
def test_local_motion_is_independent_of_position_and_expands_to_the_state(rng, axes):
    scene, body = rod()
    bent = lie.se3_retract(body.frames, rng.uniform(-0.1, 0.1, (1, 9, 6)))
    everywhere = lie.se3_compose(motions(rng, 3)[:, np.newaxis], bent)
    basis = fl.reduction.pod(states(scene, bent), body, 1, axes=axes)
    here, there = (basis.project(states(scene, each), axes=axes) for each in (bent, everywhere))
    assert np.abs(here.coordinates).max() > 0.0
    np.testing.assert_allclose(there.coordinates, np.tile(here.coordinates, (3, 1)), rtol=1e-12)
    np.testing.assert_allclose(there.expand(), everywhere, atol=1e-13)


def test_axes_of_shells_ignore_drilling_rotations(rng):
    scene, body = square()
    for corner in ("00", "10"):
        scene.add(fl.Clamp(body.point(corner)))
    n = len(body.frames)
    bent = lie.se3_retract(body.frames, 0.01 * rng.normal(size=(2, n, 6)))
    basis = fl.reduction.pod(states(scene, bent), body, 2, axes=fl.reduction.MeanAxes())
    G, spun = motions(rng, 2), np.zeros((2, n, 6))
    spun[:, :, 5] = rng.uniform(-1.0, 1.0, spun.shape[:2])
    frames = lie.se3_retract(lie.se3_compose(G[:, np.newaxis], body.frames), spun)
    found = basis.project(states(scene, frames), axes=fl.reduction.MeanAxes())
    np.testing.assert_allclose(found.rigid, G, atol=1e-12)
    np.testing.assert_allclose(found.coordinates, 0.0, atol=1e-12)
    rigid = lie.se3_compose(G[:, np.newaxis], body.frames)
    np.testing.assert_allclose(found.expand()[:, :, 3], rigid[:, :, 3], atol=1e-12)
    with pytest.raises(ValueError, match="drilling rotation"):
        basis.project(states(scene, frames), axes=fl.reduction.NodeAxes(0))


def test_projection_finds_coordinates_in_any_posture(rng):
    scene, body = rod(clamped=False)
    basis = fl.reduction.craig_bampton(scene, [body.point("start")], 5)
    basis = fl.reduction.Basis(body, basis.modes[6:])  # those that leave the start where it is
    η = 1e-2 * rng.uniform(-1.0, 1.0, (3, 5))
    G = motions(rng, 3)
    frames = fl.reduction.ReducedStates(basis, G, η, np.zeros(3)).expand()
    clamped, _ = rod()
    found = basis.project(states(clamped, frames), axes=fl.reduction.NodeAxes(0))
    np.testing.assert_allclose(found.coordinates, η, atol=1e-12)
    np.testing.assert_allclose(found.rigid, G, atol=1e-12)
    assert found.errors.max() < 1e-12


def test_shapes_of_a_motion_serve_another_posture_and_show_what_they_miss(rng):
    scene, body = rod()
    increments = np.einsum(
        "km,mni->kni", rng.uniform(-1.0, 1.0, (6, 3)), 0.02 * rng.uniform(-1.0, 1.0, (3, 9, 6))
    )
    increments[:, 0] = 0.0
    bent = lie.se3_retract(body.frames, increments)
    axes = fl.reduction.NodeAxes(0)
    basis = fl.reduction.pod(states(scene, bent), body, 3, axes=axes)
    turned = states(scene, lie.se3_compose(motions(rng, 6)[:, np.newaxis], bent))
    assert basis.project(turned, axes=axes).errors.max() < 1e-12
    fewer = fl.reduction.pod(states(scene, bent), body, 2, axes=axes)
    assert fewer.project(turned, axes=axes).errors.max() > 1e-3
    with pytest.raises(ValueError, match="at most 3"):
        fl.reduction.pod(states(scene, bent), body, 4, axes=axes)


def test_interface_modes_are_those_of_statics_and_normal_modes_vibrations():
    scene, body = rod(clamped=False)
    basis = fl.reduction.craig_bampton(scene, [body.point("start"), body.point("end")], 4)
    shapes = basis.modes
    unit = shapes[:12][:, [0, -1]].reshape(12, 12)
    np.testing.assert_allclose(unit / np.diag(unit), np.eye(12), atol=1e-14)
    assert (shapes[12:][:, [0, -1]] == 0).all()
    stretched = shapes[6, :, 0] / shapes[6, -1, 0]
    np.testing.assert_allclose(stretched, np.linspace(0.0, 1.0, 9), atol=1e-10)
    held, same = rod()
    held.add(fl.Clamp(same.point("end")))
    full = fl.vibrations(held, 4).frequencies
    normal = fl.reduction.Basis(same, shapes[12:])
    np.testing.assert_allclose(fl.reduction.reduced_frequencies(held, normal, 4), full, rtol=1e-8)


def test_vibrations_of_few_unknowns_are_found_though_they_come_in_pairs():
    """Eight square cells between three interfaces: Lanczos vectors once ended before the sixth."""
    rubber = fl.Material(E=5e6, nu=0.3, density=1100.0)
    scene, section = fl.Scene(), fl.Section.rectangle(0.05, 0.05, rubber)
    body = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=8))
    basis = fl.reduction.craig_bampton(
        scene, [body.point(4), body.point("start"), body.point("end")], 6
    )
    M, K = mass_and_stiffness(scene, basis.modes[18:])
    np.testing.assert_allclose(M, np.eye(6), atol=1e-10)
    k = np.diag(K)
    np.testing.assert_allclose(k[0::2], k[1::2], rtol=1e-8)


def test_reduced_frequencies_of_a_free_body():
    scene, body = rod(clamped=False)
    basis = fl.reduction.craig_bampton(scene, [body.point("start"), body.point("end")], 8)
    found, full = (
        fl.reduction.reduced_frequencies(scene, basis, 9),
        fl.vibrations(scene, 9).frequencies,
    )
    assert found[:6].max() < 1e-3 * full[6]
    np.testing.assert_allclose(found[6:], full[6:], rtol=1e-3)


def test_shells_have_shapes_too():
    scene, body = square()
    for corner in ("00", "10"):
        scene.add(fl.Clamp(body.point(corner)))
    basis = fl.reduction.craig_bampton(scene, [], 5)
    full = fl.vibrations(scene, 4).frequencies
    np.testing.assert_allclose(fl.reduction.reduced_frequencies(scene, basis, 4), full, rtol=1e-8)


def test_spin_stiffens_shapes_made_at_rest():
    scene, _ = rod(end=(4.0, 0.0, 0.0))
    basis = fl.reduction.craig_bampton(scene, [], 12)
    still = fl.reduction.reduced_frequencies(scene, basis, 3)
    at = fl.statics(scene, spin=(0, 0, 12.0))
    full = fl.vibrations(scene, 3, at=at).frequencies
    assert full[0] > 1.2 * still[0]
    np.testing.assert_allclose(
        fl.reduction.reduced_frequencies(scene, basis, 3, at=at), full, rtol=1e-3
    )


def test_a_basis_is_saved_for_its_mesh_alone(tmp_path):
    scene, _ = rod()
    basis, path = fl.reduction.craig_bampton(scene, [], 3), tmp_path / "rod.h5"
    basis.save(path)
    _, same = rod()
    np.testing.assert_array_equal(fl.reduction.load_basis(path, same).modes, basis.modes)
    for other in (rod(9)[1], rod(end=(1.0, 0.1, 0.0))[1]):
        with pytest.raises(ValueError, match="has another mesh"):
            fl.reduction.load_basis(path, other)
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = 99
    with pytest.raises(ValueError, match="version 99"):
        fl.reduction.load_basis(path, same)
    with h5py.File(path, "w"):
        pass
    with pytest.raises(ValueError, match="no basis"):
        fl.reduction.load_basis(path, same)


def test_what_cannot_be_reduced_is_said():
    scene, body = rod()
    free, loose = rod(clamped=False)
    with pytest.raises(ValueError, match="fixed degrees of freedom"):
        fl.reduction.craig_bampton(scene, [body.point("start")], 2)
    with pytest.raises(ValueError, match="twice"):
        fl.reduction.craig_bampton(scene, [body.point("end"), body.point("end")], 2)
    with pytest.raises(ValueError, match="not a node of rod"):
        fl.reduction.craig_bampton(scene, [loose.point("end")], 2)
    with pytest.raises(ValueError, match="not a node of rod"):
        fl.reduction.craig_bampton(scene, [fl.ground()], 2)
    with pytest.raises(ValueError, match="fewer than the 48"):
        fl.reduction.craig_bampton(scene, [], 48)
    with pytest.raises(ValueError, match="rigid-body modes"):
        fl.reduction.craig_bampton(free, [], 2)
    basis = fl.reduction.craig_bampton(scene, [], 2)
    with pytest.raises(ValueError, match="at most 2"):
        fl.reduction.reduced_frequencies(scene, basis, 3)
    with pytest.raises(ValueError, match="not the body"):
        fl.reduction.reduced_frequencies(free, basis, 2)
    with pytest.raises(ValueError, match="modes are 1 … 2, got 3"):
        basis.picture("shape.png", 3)
    jointed, body_in_joint = rod(clamped=False)
    jointed.add(fl.joints.Revolute(fl.ground(), body_in_joint.point("start"), axis=(0, 1, 0)))
    with pytest.raises(ValueError, match="without joints"):
        fl.reduction.craig_bampton(jointed, [], 2)
    ends = fl.reduction.craig_bampton(free, [loose.point("start")], 2)
    with pytest.raises(ValueError, match="fixed nodes"):
        fl.reduction.reduced_frequencies(scene, fl.reduction.Basis(body, ends.modes), 2)
    with pytest.raises(ValueError, match="modes of rod"):
        fl.reduction.Basis(body, basis.modes[:, :-1])
    with pytest.raises(ValueError, match="another mesh"):
        fl.reduction.Basis(rod(9)[1], np.ones((1, 10, 6))).project(fl.statics(scene))
    scene.add(fl.PointLoad(body.point("end"), force=(0, 0, 1e3)))
    with pytest.raises(ValueError, match="no equilibrium"):
        fl.reduction.craig_bampton(scene, [], 2)
    scene.add(square()[1])
    with pytest.raises(ValueError, match="got 2"):
        fl.reduction.craig_bampton(scene, [], 2)


def bent(force):
    """A rod, modes of it at rest, and the full equilibrium."""
    scene, body = rod()
    basis = fl.reduction.craig_bampton(scene, [], 4)
    both = fl.reduction.with_derivatives(scene, basis)
    scene.add(fl.PointLoad(body.point("end"), force=force * np.array([0.0, 1.0, 1.5])))
    return scene, basis, both, fl.statics(scene).frames[-1]


def test_derivatives_free_modes_from_stretching():
    scene, basis, both, full = bent(1e3)
    deflection = np.linalg.norm(full[-1, 0] - (1.0, 0.0, 0.0))
    assert deflection > 0.08
    errors = []
    for shapes in (basis, both):
        found = fl.reduction.reduced_statics(scene, shapes, load_steps=4)
        errors.append(np.linalg.norm(found.frames[:, 0] - full[:, 0], axis=1).max() / deflection)
    assert len(both) == 14
    np.testing.assert_array_equal(both.modes[:4], basis.modes)
    assert errors[0] > 0.3
    assert errors[1] < 0.01
    assert found.error == pytest.approx(errors[1] * deflection, rel=0.1)


def test_all_shapes_are_the_full_model():
    scene, body = rod(2)
    shapes = np.zeros((12, 3, 6))
    shapes[:, body.frames[:, 0, 0] > 0.0] = np.eye(12).reshape(12, 2, 6)
    basis = fl.reduction.Basis(body, shapes)
    scene.add(fl.PointLoad(body.point("end"), force=(50.0, 400.0, 600.0)))
    found = fl.reduction.reduced_statics(scene, basis)
    np.testing.assert_allclose(found.frames, fl.statics(scene).frames[-1], atol=1e-8)
    assert found.error < 1e-8
    moved = fl.statics(scene).displacement(body.point("end"))[-1]
    for point in (body.point("end"), f"{body.name}.end"):
        np.testing.assert_allclose(found.displacement(point), moved, atol=1e-8)
    assert found.iterations >= 2 and "iterations=" in repr(found)


def test_what_has_no_reduced_equilibrium_is_said():
    scene, _ = rod()
    basis = fl.reduction.craig_bampton(scene, [], 2)
    with pytest.raises(ValueError, match="no load"):
        fl.reduction.reduced_statics(scene, basis)
    with pytest.raises(ValueError, match="not the body"):
        fl.reduction.reduced_statics(rod()[0], basis)
    plate, shell = square()
    with pytest.raises(ValueError, match="for beams only"):
        fl.reduction.reduced_statics(plate, fl.reduction.Basis(shell, np.ones((1, 16, 6))))


def test_krylov_shapes_match_moments_of_the_answer():
    """Where the load acts, twice as many as there are shapes."""
    scene, body = rod()
    wrench = (0.0, 1.0, 2.0, 0.1, 0.0, 0.0)
    basis = fl.reduction.krylov(scene, [(body.point("end"), wrench)], 2)
    assert len(basis) == 2
    # of all nodes but the clamped one
    M, K = mass_and_stiffness(scene, np.eye(54)[6:].reshape(48, 9, 6))
    f = np.append(np.zeros(42), wrench)
    V = basis.modes.reshape(2, 54)[:, 6:].T
    answers = []
    for stiffness, mass, force in (
        (K, M, f),
        (V.T @ (K @ V), V.T @ (M @ V), V.T @ f),
    ):
        moment, found = np.linalg.solve(stiffness, force), []
        for _ in range(5):
            found.append(force @ moment)
            moment = np.linalg.solve(stiffness, mass @ moment)
        answers.append(found)
    differ = np.abs(np.divide(*answers) - 1.0)
    assert differ[:4].max() < 1e-6
    assert differ[4] > 1e-4


def test_krylov_shapes_of_nothing_are_refused():
    scene, body = rod()
    with pytest.raises(ValueError, match="free degrees of freedom"):
        fl.reduction.krylov(scene, [], 2)
    with pytest.raises(ValueError, match="free degrees of freedom"):
        fl.reduction.krylov(scene, [(body.point("start"), np.ones(6))], 2)
    with pytest.raises(ValueError, match="not a node of rod"):
        fl.reduction.krylov(scene, [(fl.ground(), np.ones(6))], 2)
    free, loose = rod(clamped=False)
    with pytest.raises(ValueError, match="rigid-body modes"):
        fl.reduction.krylov(free, [(loose.point("end"), np.ones(6))], 2)
    twice = fl.reduction.krylov(scene, [(body.point("end"), np.ones(6))] * 2, 2)
    assert len(twice) == 2


def test_expanded_states_have_section_forces_and_shapes_pictures(tmp_path):
    scene, body = rod()
    basis = fl.reduction.craig_bampton(scene, [], 20)
    scene.add(fl.PointLoad(body.point("end"), force=(0.0, 0.0, 10.0)))
    full = fl.statics(scene)
    states = basis.project(full, axes=fl.reduction.NodeAxes(0))
    shown = states.within(full)
    np.testing.assert_array_equal(shown.frames, states.expand())
    moments = [
        fl.post.section_forces(result, body, scene).ends[0, :, :, 4] for result in (full, shown)
    ]
    np.testing.assert_allclose(moments[1], moments[0], atol=0.02 * np.abs(moments[0]).max())
    with pytest.raises(ValueError, match="has 2 states"):
        states.within(fl.statics(scene, levels=(0.5, 1.0)))
    basis.picture(tmp_path / "shape.png", 1)
    assert (tmp_path / "shape.png").stat().st_size > 5000
    with pytest.raises(ValueError, match="1 … 20, got 21"):
        basis.picture(tmp_path / "shape.png", 21)
