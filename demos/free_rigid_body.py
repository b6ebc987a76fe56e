"""A rigid body in free flight: closed form, pulsating loads, and the turn about the middle axis.

Nothing holds the body, so its six equations stand alone in its own frame at the centre of mass,

    m (du/dt + omega x u) = R^T f,        J domega/dt + omega x J omega = moment,

with a constant mass matrix. A scene of such bodies has no matrix: generalised-alpha goes through
one compiled loop over bodies and steps.

--case symmetric (default). J = diag(1, 1, 2) kg m2, mass 1 kg, omega = (1, 0, 3) rad/s, no load.
With A = J1 = J2, C = J3 and the angular momentum L, the angular velocity turns about the symmetry
axis in the body at the rate lambda = (C - A)/A omega_3 = 3 rad/s, and the body about L in space at
|L|/A = 6.1 rad/s, nearly once in a second, with its axis 9.5 degrees off L:

    R(t) = R(0) exp(t L/A) exp(-lambda t e3)        (L in the body's axes at the start)

for then R^T dR/dt = exp(lambda t e3) L/A - lambda e3 = exp(lambda t e3) omega(0) is the solution of
Euler's equations. Reported are the largest angle of R^T R_exact, its order from h, h/2 and h/4, and
the time per step of one body with all steps kept, and of --bodies such bodies with different spins,
one step in ten kept.

--case paper. C. Liu & H. Hu, Chin. J. Theor. Appl. Mech. 53 (2021) 213, section 4.2: J = (3783.42,
3776.16, 2630.94) with products of inertia 352.9 (12), 484.74 (13), 469.74 (23) kg m2, v = (10, 10,
10) m/s, omega = (10, 10, 10) rad/s; force 50|sin 10t|, 52|sin(10t + pi/3)|, 50|sin(10t + pi/2)| kN
and a moment of the same numbers in kN m. The paper gives neither mass nor frames. Here the mass is
1000 kg, the force is fixed in space, the moment turns with the body, and the products are positive
off-diagonal entries of J. Reference: DOP853 to 11 digits, restarted at every kink of |sin|.

--case dzhanibekov. J = diag(1, 2, 3) kg m2, omega = (0.01, 2, 0.01) rad/s: turning about the middle
axis is unstable, and the body turns over every eleven seconds. Reference: DOP853 to 9 digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, sin
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie import lie
from fem_lie.pictures.diagrams import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
J, SPIN = np.array([1.0, 1.0, 2.0]), np.array([1.0, 0.0, 3.0])
RUNS = 5

# t, quaternion (w, x, y, z), angular velocity in the body's axes, velocity and position in space
PAPER = """
0.2    -0.284656105368  0.679226988485  0.558442581399  0.381789841497
       17.1946153145  8.16075109819  6.33876207098
       17.0807341827  17.7768500654  15.4535128659  2.54535128659  2.92132061971  2.72113025493
0.5    0.345180739426  -0.47897190844  -0.681899257631  -0.431798066805
       12.3615247098  18.2909929254  7.83821245119
       26.4183109273  28.0558761495  25.2053786267  8.87894520908  9.65058449459  9.07498360009
0.8    -0.822970836325  0.301232739509  0.452463517577  0.165089686135
       22.1923116819  13.9914805942  7.53991297201
       35.727500169  38.233708838  35.0532087669  18.0805429159  19.3550253904  18.2900830419
1      0.60344875546  -0.368432375407  -0.57764302494  -0.407965341695
       15.3304477471  22.5792590367  11.1853893708
       40.8046423546  44.068321756  42.7201055544  25.878433523  27.3947441474  25.9432972943
"""
# t, quaternion (w, x, y, z), angular velocity in the body's axes
DZHANIBEKOV = """
10     -0.012931119  0.9985483074  -0.006665672432  -0.05186166859
       -0.04104996797  -1.999603686  0.02506724204
20     0.9942062797  -0.02264888341  0.1034765963  0.01826185805
       0.1300811371  1.995790294  0.07554491432
30     -0.08205841251  0.9825356713  -0.06373740497  -0.1543619604
       -0.3996321932  -1.959692351  0.2308721796
40     0.93516522  -0.2180836063  0.1961988967  0.1985234117
       1.13775092  1.644877759  0.6569315431
50     -0.4950898244  0.6929778601  -0.4900573154  -0.1857729225
       -1.998771579  -0.07079671226  1.154020194
"""


def main(
    case: str = "symmetric",
    step: float = 1e-3,
    duration: float | None = None,
    radius: float = 0.8,
    bodies: int = 1000,
    pictures: bool = True,
) -> dict[str, Any]:
    if case not in ("symmetric", *TABLES):
        raise ValueError(f"case must be symmetric, {' or '.join(TABLES)}, got {case!r}")
    scheme = fl.GeneralisedAlpha(radius=radius)
    record: dict[str, Any] = {"case": case, "step": step, "radius": radius}
    if case == "symmetric":
        return record | symmetric(scheme, step, duration or 1.0, bodies, pictures)
    return record | against_table(case, scheme, step, duration, pictures)


# --- closed form --------------------------------------------------------------------------------


def spinning(spins: np.ndarray) -> fl.Scene:
    """Symmetric bodies, one beside the other, with angular velocities (n, 3)."""
    scene = fl.Scene()
    for k, spin in enumerate(spins):
        body = scene.add(fl.RigidBody(1.0, J, (3.0 * k, 0, 0), name=f"body {k + 1}"))
        body.turn(spin, about=body.centre)
    return scene


def exact(times: np.ndarray) -> np.ndarray:
    """Rotation matrices in closed form, shape (T, 3, 3)."""
    t = times[:, np.newaxis]
    precession, nutation = J * SPIN / J[0], (J[2] / J[0] - 1.0) * SPIN[2] * np.array([0, 0, 1])
    return lie.so3_exp(t * precession) @ lie.so3_exp(-t * nutation)


def angles(R: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Angle between rotations, shape (T,)."""
    return np.linalg.norm(lie.so3_log(R.transpose(0, 2, 1) @ reference), axis=1)


def symmetric(
    scheme: fl.GeneralisedAlpha, step: float, duration: float, bodies: int, pictures: bool
) -> dict[str, Any]:
    """The closed form, and the time that it takes."""
    runs = [
        scheme.run(spinning(SPIN[np.newaxis]), duration=duration, step=h)
        for h in (step, step / 2, step / 4)
    ]
    errors = [angles(run.rotation(0), exact(run.times)) for run in runs]
    largest = np.array([error.max() for error in errors])
    one = fastest(scheme, spinning(SPIN[np.newaxis]), step, 10_000, 1)
    record: dict[str, Any] = {
        "rotation_error": float(largest[0]),
        "rotation_error_at_the_end": float(errors[0][-1]),
        "order": float(np.log2(largest[:-1] / largest[1:]).min()),
        "energy_error": runs[0].energy_error,
        "angular_momentum_error": runs[0].angular_momentum_error,
        "iterations_per_step": float(runs[0].iterations[-1] / (len(runs[0].times) - 1)),
        "microseconds_per_step": one,
    }
    print(f"J = diag(1, 1, 2) kg m2, omega = (1, 0, 3) rad/s, {duration:g} s, h = {step:g} s")
    print(f"rotation error {largest[0]:.2e} rad, order {record['order']:.3f}")
    print(f"one body, all steps kept: {one:.2f} microseconds per step")
    if bodies > 0:
        spins = SPIN + 0.5 * np.random.default_rng(1).normal(size=(bodies, 3))
        many = fastest(scheme, spinning(spins), step, 200, 10) / bodies
        record |= {"bodies": bodies, "microseconds_per_body_and_step": many}
        print(f"{bodies} bodies, one step in ten kept: {many:.2f} microseconds per body and step")
    if pictures:
        draw_symmetric(runs, errors)
    return record


def fastest(
    scheme: fl.GeneralisedAlpha, scene: fl.Scene, step: float, steps: int, save_every: int
) -> float:
    """Microseconds per step, best of several runs."""
    runs = (
        scheme.run(scene, duration=steps * step, step=step, save_every=save_every, progress=False)
        for _ in range(RUNS)
    )
    return 1e6 * min(run.seconds for run in runs) / steps


# --- tables -------------------------------------------------------------------------------------


def pulsating() -> fl.Scene:
    """The body of the paper."""
    tensor = [[3783.42, 352.9, 484.74], [352.9, 3776.16, 469.74], [484.74, 469.74, 2630.94]]
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1000.0, tensor, name="body"))
    body.move((10, 10, 10))
    body.turn((10, 10, 10), about=body.centre)
    for axis, (size, phase) in enumerate(((50e3, 0.0), (52e3, pi / 3), (50e3, pi / 2))):
        load, pulse = size * np.eye(3)[axis], pulse_of(phase)
        scene.add(fl.PointLoad(body.centre, force=load, history=pulse))
        scene.add(fl.PointLoad(body.centre, moment=load, following=True, history=pulse))
    return scene


def pulse_of(phase: float) -> Callable[[float], float]:
    return lambda t: abs(sin(10.0 * t + phase))


def tumbling() -> fl.Scene:
    """The body that turns over."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 2, 3), name="body"))
    body.turn((0.01, 2, 0.01), about=body.centre)
    return scene


TABLES = {"paper": (pulsating, PAPER, 14, 1.0), "dzhanibekov": (tumbling, DZHANIBEKOV, 8, 50.0)}


def against_table(
    case: str, scheme: fl.GeneralisedAlpha, step: float, duration: float | None, pictures: bool
) -> dict[str, Any]:
    """A run compared with the rows of its reference that lie in it."""
    make, text, columns, whole = TABLES[case]
    # turning about the middle axis is unstable: it multiplies what the iteration leaves
    scheme = replace(scheme, tolerance=1e-11)
    result = scheme.run(make(), duration=duration or whole, step=step)
    table = np.array(text.split(), dtype=float).reshape(-1, columns)
    table = table[table[:, 0] < result.times[-1] + 0.5 * step]
    rows = [result.index(t) for t in table[:, 0]]
    record: dict[str, Any] = {
        "rotation_error": float(
            angles(result.rotation(0)[rows], rotations(table[:, 1:5])).max(initial=0.0)
        ),
        "angular_velocity_error": float(
            np.linalg.norm(result.velocities[rows, 0, 3:] - table[:, 5:8], axis=1).max(initial=0.0)
        ),
        "microseconds_per_step": 1e6 * result.seconds / (len(result.times) - 1),
    }
    if columns == 8:  # no load
        record["energy_error"] = result.energy_error
        record["angular_momentum_error"] = result.angular_momentum_error
    else:
        speed = np.einsum("tij,tj->ti", result.rotation(0), result.velocities[:, 0, :3])
        record["velocity_error"] = float(np.linalg.norm(speed[rows] - table[:, 8:11], axis=1).max())
        record["position_error"] = float(
            np.linalg.norm(result.position(0)[rows] - table[:, 11:], axis=1).max()
        )
    print(f"{case}, {result.times[-1]:g} s, h = {step:g} s, against {len(table)} rows:")
    for name, value in record.items():
        print(f"  {name.replace('_', ' ')} {value:.3g}")
    if pictures:
        draw_velocity(case, result, table)
    return record


def rotations(quaternions: np.ndarray) -> np.ndarray:
    """Rotation matrices of unit quaternions (w, x, y, z), shape (T, 3, 3)."""
    w, v = quaternions[:, :1], quaternions[:, 1:]
    sine = np.linalg.norm(v, axis=1, keepdims=True)
    return lie.so3_exp(2.0 * np.arctan2(sine, w) * v / np.where(sine > 0, sine, 1.0))


# --- pictures -----------------------------------------------------------------------------------


def draw_symmetric(runs: list[fl.Result], errors: list[np.ndarray]) -> None:
    """Path of the symmetry axis about L, and the errors."""
    figure = Figure(figsize=(9.0, 4.0), dpi=150, layout="constrained")
    path, error = figure.subplots(1, 2)
    L = J * SPIN / np.linalg.norm(J * SPIN)
    across = np.array([np.cross((0, 1, 0), L), (0, 1, 0)])
    closed = exact(runs[0].times)[:, :, 2] @ across.T
    marks = runs[0].rotation(0)[::20, :, 2] @ across.T
    path.plot(*closed.T, color=COLOURS[0], label="closed form")
    path.plot(*marks.T, "o", color=COLOURS[1], markersize=3, label="computed")
    path.plot(0, 0, "k+")
    path.annotate("L", (0, 0), (4, 4), textcoords="offset points")
    path.legend(frameon=False, loc=(0.28, 0.6))
    path.set(
        aspect="equal", title="Path of the symmetry axis", xlabel="across L", ylabel="across L"
    )
    for k, (run, values) in enumerate(zip(runs, errors, strict=True)):
        label = f"h = {run.times[1]:.3g} s"
        error.semilogy(run.times[1:], values[1:], color=COLOURS[k], label=label)
    error.legend(frameon=False)
    error.set(xlabel="t [s]", ylabel="rotation error [rad]", title="Error")
    save(figure, "free_rigid_body.png")


def draw_velocity(case: str, result: fl.Result, table: np.ndarray) -> None:
    """Angular velocity in the body's axes over time, and the reference."""
    figure = Figure(figsize=(7.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    for k in range(3):
        axes.plot(result.times, result.velocities[:, 0, 3 + k], color=COLOURS[k], label=f"ω{k + 1}")
        axes.plot(table[:, 0], table[:, 5 + k], "o", color=COLOURS[k], markersize=4)
    axes.legend(frameon=False)
    axes.set(xlabel="t [s]", ylabel="angular velocity [rad/s]", title=f"{case}; dots: reference")
    save(figure, f"free_rigid_body_{case}.png")


def save(figure: Figure, name: str) -> None:
    for axes in figure.axes:
        axes.grid(color="#DDDDDD", linewidth=0.6)
    RESULTS.mkdir(exist_ok=True)
    figure.savefig(RESULTS / name)
    print(f"picture: {RESULTS / name}")


if __name__ == "__main__":
    from command_line import run

    run(main)
