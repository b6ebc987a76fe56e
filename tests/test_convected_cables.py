"""Axes of cables and nets that follow the motion: nothing but the matrix feels them."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

SECTION = fl.Section.from_stiffness([1e3] * 3 + [1.0] * 3, mass=0.5)


def helix(s: float) -> tuple[float, float, float]:
    return np.cos(4 * s), np.sin(4 * s), 1.5 * s


def cable() -> fl.Cable:
    return fl.Cable.curve(helix, SECTION, cells=6)


def net(stretch: float = 1.0) -> fl.Net:
    s = np.arange(4.0)
    x, y = np.meshgrid(s, s, indexing="ij")
    number = np.arange(16).reshape(4, 4)
    points = np.column_stack([x.ravel(), y.ravel(), 0.1 * x.ravel() * y.ravel()])
    return fl.Net(points, [*number.tolist(), *number.T.tolist()], SECTION, stretch=stretch)


def discrete() -> fl.Cable:
    mesh = fl.mesh.LineMesh.from_cells(
        [helix(s) for s in np.linspace(0, 1, 7)],
        [(k, k + 1) for k in range(6)],
        named_points={"start": [0], "end": [6]},
        kink_angle=1.5,
    )
    return fl.Cable(mesh, SECTION, formulation=fl.elements.DiscreteCable())


BODIES = {"slopes": cable, "places": discrete, "net": net}


def tangent(body, rows) -> np.ndarray:
    """Blocks of the matrix, with the true stress, in the axes of the rows."""
    assembly = body.model.assemble([body.model])
    H, found = np.empty_like(rows), []
    H[assembly.order] = rows
    for term in (assembly, *assembly.further_terms):
        forces = np.zeros((len(rows), 6))
        if term.stress_update is not None:
            term.stress_update.reset_stress(H)
        term.add_forces(H, forces)
        found += [term.tangent(H, forces).ravel(), forces.ravel()]
    return np.concatenate(found)


@pytest.mark.parametrize("make", BODIES.values(), ids=BODIES.keys())
def test_matrix_does_not_feel_a_rigid_motion(make):
    """Bent otherwise than at the start, then moved far and turned, about tangents, too."""
    body, rng = make(), np.random.default_rng(5)
    rotate = body.convect_axes().model.axes_update()
    assert rotate is not None
    rows = body.frames.copy()
    rows[:, 0] += 0.05 * rng.normal(size=rows[:, 0].shape)
    if make is cable:
        rows[:, 1] += 0.2 * rng.normal(size=rows[:, 1].shape)
    rotate(rows)
    expected = tangent(body, rows)
    for turn in ((0.0, 0, 1), (2.0, -1.5, 1.8), (3.1, 0.3, -0.2)):
        motion = lie.se3_exp(np.array([100.0, -20, 30, *turn]))
        moved = rows @ lie.rotation(motion).T
        moved[:, 0] += motion[0]
        # rows that say nothing of it, as the smallest rotations from step to step may have left
        left = moved.copy()
        if make is cable:
            left[:, 2] = 0.3 * moved[:, 2] + np.sqrt(1 - 0.09) * moved[:, 3]
            left[:, 3] = np.cross(
                left[:, 1] / np.linalg.norm(left[:, 1], axis=1)[:, np.newaxis], left[:, 2]
            )
        else:
            left[:, 1:] = rows[:, 1:]
        rotate(left)
        np.testing.assert_allclose(left, moved, atol=1e-10)
        np.testing.assert_allclose(
            tangent(body, left), expected, atol=1e-10 * np.abs(expected).max()
        )


@pytest.mark.parametrize("make", BODIES.values(), ids=BODIES.keys())
def test_motion_is_the_same(make):
    """A body that tumbles and hangs on a joint, with and without."""
    results = []
    for follows in (False, True):
        body = make()
        if follows:
            body.convect_axes()
        scene = fl.Scene(gravity=(0, 0, -9.81))
        scene.add(body)
        scene.add(fl.joints.Spherical(fl.ground(), body.point(0)))
        body.add_velocity(omega=(0.0, 3.0, 2.0), about=body.point(0))
        scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-11)
        results.append(scheme.run(scene, duration=0.1, step=1e-3))
    plain, other = results
    np.testing.assert_allclose(other.frames[:, :, 0], plain.frames[:, :, 0], atol=1e-8)
    np.testing.assert_allclose(other.total_energy, plain.total_energy, rtol=1e-7)


def test_a_straight_cable_has_no_rotation_to_follow():
    straight = fl.Cable.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2)
    with pytest.raises(ValueError, match="not straight"):
        straight.convect_axes()
