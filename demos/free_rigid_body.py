"""A rigid body in free flight: the closed form of a symmetric one, and what a step costs.

Nothing holds the body, so its six equations stand alone in its own frame at the centre of mass,

    m (du/dt + omega x u) = R^T f,        J domega/dt + omega x J omega = moment,

with a constant mass matrix. A scene of such bodies has no matrix: generalised-alpha goes through
one compiled loop over bodies and steps.

J = diag(1, 1, 2) kg m2, mass 1 kg, omega = (1, 0, 3) rad/s, no load.
With A = J1 = J2, C = J3 and the angular momentum L, the angular velocity turns about the symmetry
axis in the body at the rate lambda = (C - A)/A omega_3 = 3 rad/s, and the body about L in space at
|L|/A = 6.1 rad/s, nearly once in a second, with its axis 9.5 degrees off L:

    R(t) = R(0) exp(t L/A) exp(-lambda t e3)        (L in the body's axes at the start)

for then R^T dR/dt = exp(lambda t e3) L/A - lambda e3 = exp(lambda t e3) omega(0) is the solution of
Euler's equations. Reported are the largest angle of R^T R_exact, its order from h, h/2 and h/4, and
the time per step of one body with all steps kept, and of --bodies such bodies with different spins,
one step in ten kept.

tumbling_body.py has pulsating loads, and the turn about the middle axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram

import fem_lie as fl
from fem_lie import lie

J, SPIN = np.array([1.0, 1.0, 2.0]), np.array([1.0, 0.0, 3.0])
RUNS = 5


def spinning(spins: np.ndarray) -> fl.Scene:
    """Symmetric bodies, one beside the other, with angular velocities (n, 3)."""
    scene = fl.Scene()
    for k, spin in enumerate(spins):
        body = scene.add(fl.RigidBody(1.0, J, (3.0 * k, 0, 0), name=f"body {k + 1}"))
        body.add_velocity(omega=spin, about=body.point("centre"))
    return scene


def exact(times: np.ndarray) -> np.ndarray:
    """Rotation matrices in closed form, shape (T, 3, 3)."""
    t = times[:, np.newaxis]
    precession, nutation = J * SPIN / J[0], (J[2] / J[0] - 1.0) * SPIN[2] * np.array([0, 0, 1])
    return lie.so3_exp(t * precession) @ lie.so3_exp(-t * nutation)


def angles(R: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Angle between rotations, shape (T,)."""
    return np.linalg.norm(lie.so3_log(R.transpose(0, 2, 1) @ reference), axis=1)


def fastest(
    scheme: fl.GeneralisedAlpha, scene: fl.Scene, step: float, steps: int, save_every: int
) -> float:
    """Microseconds per step, best of several runs."""
    runs = (
        scheme.run(scene, duration=steps * step, step=step, save_every=save_every, progress=False)
        for _ in range(RUNS)
    )
    return 1e6 * min(run.seconds for run in runs) / steps


def main(
    step: float = 1e-3,
    duration: float = 1.0,
    radius: float = 0.8,
    bodies: int = 1000,
    pictures: bool = True,
) -> dict[str, Any]:
    scheme, alone = fl.GeneralisedAlpha(radius=radius), SPIN[np.newaxis]
    halves = [step, step / 2, step / 4]
    runs = [scheme.run(spinning(alone), duration=duration, step=h) for h in halves]
    errors = [angles(one.rotation(0), exact(one.times)) for one in runs]
    largest = np.array([error.max() for error in errors])
    if pictures:
        draw(runs, errors)
    record: dict[str, Any] = {
        "case": "symmetric",
        "step": step,
        "radius": radius,
        "rotation_error": float(largest[0]),
        "rotation_error_at_the_end": float(errors[0][-1]),
        "order": float(np.log2(largest[:-1] / largest[1:]).min()),
        "energy_error": runs[0].energy_error,
        "angular_momentum_error": runs[0].angular_momentum_error,
        "iterations_per_step": float(runs[0].iterations[-1] / (len(runs[0].times) - 1)),
        "microseconds_per_step": fastest(scheme, spinning(alone), step, 10_000, 1),
    }
    if bodies > 0:
        spins = SPIN + 0.5 * np.random.default_rng(1).normal(size=(bodies, 3))
        many = fastest(scheme, spinning(spins), step, 200, 10) / bodies
        record |= {"bodies": bodies, "microseconds_per_body_and_step": many}
    return record


def draw(runs: list[fl.Result], errors: list[np.ndarray]) -> None:
    """Path of the symmetry axis about L, and the errors."""
    L = J * SPIN / np.linalg.norm(J * SPIN)
    across = np.array([np.cross((0, 1, 0), L), (0, 1, 0)])
    closed = exact(runs[0].times)[:, :, 2] @ across.T
    marks = runs[0].rotation(0)[::20, :, 2] @ across.T
    with diagram("free_rigid_body.png", panels=2) as (path, error):
        path.plot(*closed.T, color=COLOURS[0], label="closed form")
        path.plot(*marks.T, "o", color=COLOURS[1], markersize=3, label="computed")
        path.plot(0, 0, "k+")
        path.annotate("L", (0, 0), (4, 4), textcoords="offset points")
        path.legend(frameon=False, loc=(0.28, 0.6))
        path.set(aspect="equal", title="Path of the symmetry axis")
        path.set(xlabel="across L", ylabel="across L")
        for colour, one, values in zip(COLOURS, runs, errors, strict=False):
            label = f"h = {one.times[1]:.3g} s"
            error.semilogy(one.times[1:], values[1:], color=colour, label=label)
        error.set(xlabel="t [s]", ylabel="rotation error [rad]", title="Error")


if __name__ == "__main__":
    run(main, show=True)
