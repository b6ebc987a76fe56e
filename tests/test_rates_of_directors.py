"""Angular velocities that conserving schemes tell of nodes whose directors have no inertia."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.lie.node_types.inertia import Inertia, local_twists, turning_of

STEP = 2e-3
SCHEMES = {"energy-momentum": fl.EnergyMomentum(), "energy-decaying": fl.EnergyDecaying(radius=0.8)}


def plate() -> tuple[fl.Scene, fl.Shell]:
    """One that bends while it tumbles; only its third director has inertia."""
    section = fl.ShellSection.layer(0.02, fl.Material(1e6, 0.3, 1000.0))
    shell = fl.Shell(fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.0), (4, 2)), section)
    shell.add_velocity(omega=(1.0, 2.0, 0.5), about=(0, 0, 0))
    scene = fl.Scene()
    scene.add(shell)
    return scene, shell


@pytest.mark.parametrize("name", SCHEMES)
def test_reported_velocities_are_those_of_the_frames(name):
    """Not what directors without inertia remember, which changes sign in every step."""
    scene, _ = plate()
    result = SCHEMES[name].run(scene, duration=0.4, step=STEP)
    moved = lie.se3_relative(result.frames[:-2], result.frames[2:])[:, :, 3:] / (2 * STEP)
    reported = result.velocities[1:-1, :, 3:]
    assert np.abs(moved[..., :2]).max() > 1.0
    np.testing.assert_allclose(reported, moved, atol=0.02 * np.abs(moved).max())


def test_rates_of_a_turning_frame_give_its_velocity():
    """Whatever the inertia, in part or none."""
    rng = np.random.default_rng(1)
    matrices = np.zeros((5, 4, 4))
    matrices[:, 0, 0] = 1.0
    matrices[1, 3, 3] = 1e-6
    matrices[2, 1:, 1:] = np.diag([0.0, 2.0, 1e-3])
    for k in (3, 4):
        points = rng.normal(size=(6, 3))
        matrices[k, 1:, 1:] = points.T @ points
    mass = Inertia(np.arange(6), np.arange(5), matrices)
    H, v = lie.se3_exp(rng.normal(size=(5, 6))), rng.normal(size=(5, 6))
    rates = np.empty((5, 4, 3))
    rates[:, 0] = np.einsum("nk,nkj->nj", v[:, :3], H[:, 1:])
    turned = np.einsum("nij->nji", lie.hat(v[:, 3:]))
    rates[:, 1:] = np.einsum("nki,nij->nkj", turned, H[:, 1:])
    held, found = np.zeros((5, 6), dtype=bool), np.empty((5, 6))
    local_twists(H, rates, turning_of(mass, held), found)
    np.testing.assert_allclose(found, v, rtol=1e-12, atol=1e-12)
    # what has no inertia may do as it likes: the first two directors of the second node
    rates[1, 1:3] = rng.normal(size=(2, 3))
    held[1, 5] = True
    local_twists(H, rates, turning_of(mass, held), found)
    np.testing.assert_allclose(found[1], v[1] * [1, 1, 1, 1, 1, 0], rtol=1e-12, atol=1e-12)
