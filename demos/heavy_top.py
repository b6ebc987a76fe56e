"""A heavy top at 150 rad/s: one iteration matrix for the whole run, and the choice of the group.

O. Brüls & A. Cardona, J. Comput. Nonlinear Dyn. 5 (2010) 031002; O. Brüls, A. Cardona & M. Arnold,
Mech. Mach. Theory 48 (2012) 121. Mass 15 kg, J = diag(0.234375, 0.46875, 0.234375) kg m2 about the
centre of mass, which is 1 m from the fixed point along e2; the body's frame is at the centre of
mass, a spherical joint holds it at the origin. It starts upright on +Y with the angular velocity
(0, 150, -4.61538) rad/s in its own axes; gravity acts along -Z.

In fixed axes everything turns with 150 rad/s, and an iteration matrix is of use for a few steps. In
the body's axes mass, joint and the large part of the spin are constant: one matrix lasts.

How far a step is from the truth depends on the group on which it is made,

    SE(3)      H <- H exp(d), velocity (inv(R) dx/dt, omega)     a screw motion in each step
    R3xSO3     x <- x + u, R <- R exp(theta), velocity (dx/dt, omega)

The errors of a step are h^3 times second derivatives of the velocities. The centre of mass moves
slowly in space, 4.6 m/s in a circle of precession: dx/dt has small derivatives. The body's axes
turn with 150 rad/s under it, and the same velocity in components along them, inv(R) dx/dt, has a
second derivative of 150^2 times its size. That is the price of SE(3) for a body whose
centre of mass moves by little while it spins by much; a body that turns with an axis far away, like
a blade on a hub, has a constant velocity in its own axes and is better off on SE(3). Errors of the
position (largest at the reference times, m), radius 0.9, 0.2 s:

    step [s]                   1e-3     5e-4     2.5e-4   1.25e-4
    SE3, exponential           2.2e-2   5.4e-3   1.4e-3   3.4e-4
    SE3, Cayley                5.9e-3   1.5e-3   3.7e-4   9.3e-5
    R3xSO3, exponential        1.7e-3   4.2e-4   1.1e-4   2.6e-5
    R3xSO3, Cayley             2.0e-3   5.1e-4   1.3e-4   3.2e-5

(with the Cayley map the angle about the spin axis lags: 2 atan(theta/2) per step instead of theta.)
Without --group both are run, with steps down to an eighth, and compared in a diagram.

Reference: Euler's equations about the fixed point with a quaternion, ten digits, confirmed by a
formulation with the centre of mass and constraints.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie import lie
from fem_lie.pictures.diagrams import COLOURS

RESULTS = Path(__file__).parents[1] / "results"

# time, centre of mass, unit quaternion (w, x, y, z) of the body's axes
REFERENCE = np.fromstring(
    """
    0.05 0.225741118 0.973431984 -0.038355180 -0.814666053 -0.049181315 -0.568361869 0.104236299
    0.10 0.421296659 0.894571974 -0.149164701 0.331822913 0.177338057 0.914975159 -0.145826014
    0.15 0.556875687 0.766898253 -0.318993008 0.255629884 -0.331220395 -0.904490182 0.082728010
    0.20 0.605550561 0.598957682 -0.523983027 -0.708279153 0.438781088 0.545728396 0.089399753
    0.25 0.548884143 0.406994152 -0.730124618 0.838737324 -0.433643996 0.004095949 -0.329326295
    0.30 0.384607921 0.215668893 -0.897531991 -0.598178514 0.283443864 -0.500016911 0.558413045
    0.35 0.132463079 0.054877872 -0.989667597 0.107013428 -0.010196940 0.718322394 -0.687355139
    0.40 -0.166784671 -0.047439658 -0.984851437 0.396112000 -0.310590223 -0.565133130 0.653646343
    0.45 -0.461188794 -0.073600094 -0.884244266 -0.669095372 0.576646443 0.124544517 -0.451972264
    0.50 -0.702468297 -0.021165185 -0.711400258 0.584560624 -0.700662895 0.384325753 0.140193079
    """,
    sep=" ",
).reshape(-1, 8)
MAPS = {"exponential": fl.Parametrisation.EXPONENTIAL, "cayley": fl.Parametrisation.CAYLEY}


def top(group: fl.Group) -> tuple[fl.Scene, fl.RigidBody]:
    """The scene and its body."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(
        fl.RigidBody(15.0, (0.234375, 0.46875, 0.234375), (0, 1, 0), name="top").on(group)
    )
    scene.add(fl.Spherical(fl.ground(), body.centre, at=(0, 0, 0), name="tip"))
    body.turn((0, 150, -4.61538), about=(0, 0, 0))
    return scene, body


def main(
    group: str = "R3xSO3",
    step: float = 1e-3,
    duration: float = 0.2,
    radius: float = 0.9,
    parametrisation: str = "exponential",
    pictures: bool = True,
) -> dict[str, Any]:
    record, result = simulate(group, step, duration, radius, parametrisation)
    print(HEADER, row(record), sep="\n")
    if pictures:
        draw_motion(result)
    return record


def both_groups(step: float = 1e-3, pictures: bool = True, **parameters: Any) -> dict[str, Any]:
    """Both groups over the step; the record of R3xSO3, that of SE3 under ``SE3_…``."""
    runs = {
        group: [simulate(group, step / 2**k, **parameters) for k in range(4)]
        for group in ("SE3", "R3xSO3")
    }
    print(HEADER)
    for record, _ in runs["SE3"] + runs["R3xSO3"]:
        print(row(record))
    if pictures:
        draw_motion(runs["R3xSO3"][-1][1])
        draw_errors({group: [record for record, _ in pairs] for group, pairs in runs.items()})
    other = {f"SE3_{key}": value for key, value in runs["SE3"][0][0].items()}
    return runs["R3xSO3"][0][0] | other


def simulate(
    group: str = "R3xSO3",
    step: float = 1e-3,
    duration: float = 0.2,
    radius: float = 0.9,
    parametrisation: str = "exponential",
) -> tuple[dict[str, Any], fl.Result]:
    """Integrate with a kept matrix in local, and again in inertial components; record, results."""
    if group not in fl.Group.__members__:
        raise ValueError(f"group must be one of {', '.join(fl.Group.__members__)}, got {group!r}")
    if parametrisation not in MAPS:
        raise ValueError(f"parametrisation must be one of {', '.join(MAPS)}")
    results = {}
    for components in fl.Components:
        scene, _ = top(fl.Group[group])
        scheme = fl.GeneralisedAlpha(
            radius=radius,
            policy=fl.Limit(4),
            parametrisation=MAPS[parametrisation],
            components=components,
        )
        results[components] = scheme.run(scene, duration=duration, step=step)
    result, inertial = results[fl.Components.LOCAL], results[fl.Components.INERTIAL]
    steps = len(result.times) - 1
    position, rotation = errors(result)
    return {
        "group": group,
        "parametrisation": parametrisation,
        "step": step,
        "steps": steps,
        "position_error": position,
        "rotation_error": rotation,
        "force_error": force_error(scene, result, step),
        "energy_error": result.energy_error,
        "iterations_per_step": float(result.iterations[-1] / steps),
        "factorisations": result.factorisations,
        "seconds": result.seconds,
        "iterations_per_step_inertial": float(inertial.iterations[-1] / steps),
        "factorisations_inertial": inertial.factorisations,
        "seconds_inertial": inertial.seconds,
    }, result


def errors(result: fl.Result) -> tuple[float, float]:
    """Largest distance (m) and angle (rad) from the reference, at its times within the run."""
    position, rotation = [], []
    for time, *values in REFERENCE:
        k = result.index(time)
        if abs(result.times[k] - time) > 1e-9:
            continue
        x, (w, *v) = np.array(values[:3]), values[3:]
        R = lie.so3_exp(2 * np.arctan2(np.linalg.norm(v), w) * np.array(v) / np.linalg.norm(v))
        H = result.frames[k, 0]
        position.append(np.linalg.norm(H[0] - x))
        rotation.append(np.linalg.norm(lie.so3_log(R.T @ lie.rotation(H))))
    if not position:
        raise ValueError("no reference time is met: wanted a step that divides 0.05 s")
    return float(max(position)), float(max(rotation))


def force_error(scene: fl.Scene, result: fl.Result, step: float) -> float:
    """Joint force against m (g - a) of the computed path, relative; from the first step on."""
    x = result.position("top.centre")
    a = (x[2:] - 2 * x[1:-1] + x[:-2]) / step**2
    exact = 15.0 * (np.array([0, 0, -9.81]) - a)
    force = result.joint_force("tip")[1:-1, :3] @ scene.joints[0].frame()[1:]
    return float(np.abs(force - exact).max() / np.abs(exact).max())


HEADER = """\
                       error of                     local components      inertial components
group   step [s]  position  rotation  joint force  iterations  factor-   iterations  factor-
                     [m]      [rad]    (relative)   per step  isations    per step  isations"""


def row(record: dict[str, Any]) -> str:
    return (
        f"{record['group']:7} {record['step']:8.2e} {record['position_error']:8.1e}"
        f" {record['rotation_error']:9.1e} {record['force_error']:11.1e}"
        f" {record['iterations_per_step']:12.2f} {record['factorisations']:9}"
        f" {record['iterations_per_step_inertial']:11.2f} {record['factorisations_inertial']:9}"
    )


def draw_motion(result: fl.Result) -> None:
    """Leave a picture of the path of the centre of mass."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / "heavy_top.png"
    result.picture(path, trace=["top.centre"], title="Heavy top, 150 rad/s")
    print(f"picture: {path}")


def draw_errors(records: dict[str, list[dict[str, Any]]]) -> None:
    """Leave a diagram of the position error over the step."""
    figure = Figure(figsize=(6.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    for (group, rows), style, colour in zip(records.items(), ("s-", "o-"), COLOURS, strict=False):
        steps = [r["step"] for r in rows]
        axes.loglog(steps, [r["position_error"] for r in rows], style, color=colour, label=group)
    axes.set(xlabel="step [s]", ylabel="error of the position [m]", title="Heavy top")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    path = RESULTS / "heavy_top_errors.png"
    figure.savefig(path)
    print(f"picture: {path}")


if __name__ == "__main__":
    from command_line import run

    run(main, without={"group": both_groups})
