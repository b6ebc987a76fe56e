"""The error of every step of generalised-alpha, from what the step itself has computed.

C. Liu & H. Hu, Chin. J. Theor. Appl. Mech. 53 (2021) 213, section 4.2. With velocities v and their
rates at the two ends of a step, the increment of the exact motion from the same start is

    h v + h^2/2 dv/dt + h^2/6 (dv/dt_1 - dv/dt) + h^3/12 ad(v) dv/dt + O(h^4)

and that minus the increment of the scheme is its local error, if nothing holds the body. The
bracket ad(v) dv/dt is what a Lie group adds: without it the error of the translation is wrong by
half. Joints and stiffness are accounted for by one solution with the matrix of Newton's method,
which is factorised anyway: what is across a joint is no error of the position. (The docstring of
fem_lie/solve/alpha/variable.py derives it.) Here the estimate is held against the true local
error: each step is done once more, from the same state, in ten parts.

--case body. The free rigid body of the paper: J = (3783.42, 3776.16, 2630.94) with products of
inertia 352.9 (12), 484.74 (13), 469.74 (23) kg m2, v = (10, 10, 10) m/s, omega = (10, 10, 10)
rad/s; force 50|sin 10t|, 52|sin(10t + pi/3)|, 50|sin(10t + pi/2)| kN and a moment of the same
numbers in kN m. The paper gives neither mass nor frames. Here the mass is 1000 kg, the force is
fixed in space, the moment turns with the body, and the products are positive off-diagonal entries
of J. Where |sin| has a kink no formula for smooth motions can be right: these steps are counted
apart.

--case pendulum. The rigid double pendulum of the paper: bars of 0.3 m and 0.5 m, 5 mm square,
2700 kg/m3, both along +X at rest, spherical joints, gravity 9.81 m/s2 along -Z. Its tip at 1 s is
compared with an independent solver (Pinocchio, 1e-9) in a second run, whose steps are chosen by a
tolerance: the estimated error of each step over its size.

--case flexible. The same of aluminium bars that bend: their waves are not resolved by steps of a
millisecond.

--case tolerance. The rigid pendulum with tolerances of 1e-2, 1e-3, ... --tolerance m/s: the error
of the tip follows them.

--scheme energy_momentum or energy_decaying takes a scheme that conserves (its estimate is derived
in fem_lie/solve/conserving/mean_error.py). Energy then stays, or falls, whatever the steps.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sin
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie.extend import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
TIP = np.array([-0.58577183066, 0.0, -0.01018573161])  # Pinocchio, at 1 s
SIDE, LENGTHS, DENSITY, GRAVITY = 5e-3, (0.3, 0.5), 2700.0, (0.0, 0.0, -9.81)
SIZES, PHASES = (50e3, 52e3, 50e3), (0.0, pi / 3, pi / 2)


def main(
    case: str = "body",
    scheme: str = "generalised_alpha",
    step: float = 1e-3,
    duration: float = 1.0,
    radius: float = 0.8,
    tolerance: float = 1e-8,
    refinement: int = 10,
    pictures: bool = True,
) -> dict[str, Any]:
    if case not in (*CASES, "tolerance"):
        raise ValueError(f"case must be {', '.join(CASES)} or tolerance, got {case!r}")
    if scheme not in SCHEMES:
        raise ValueError(f"scheme must be {', '.join(SCHEMES)}, got {scheme!r}")
    rough, fine = SCHEMES[scheme](radius)
    if case == "tolerance":
        return follow_tolerance(rough, tolerance, pictures)
    scene = CASES[case]()
    steps = fl.schemes.ConstantStep(step, refinement=refinement)
    result = fine.run(scene, duration=duration, step=steps)
    assert result.steps is not None
    record: dict[str, Any] = {"case": case, "scheme": scheme, "step": step, "radius": radius}
    record |= body_numbers(result.steps) if case == "body" else joint_numbers(result.steps)
    if case == "pendulum":
        record |= against_solver(fine, tolerance)
    print(f"{case}, {scheme}, {duration:g} s, h = {step:g} s:")
    print(f"estimate over the error of {refinement} parts")
    for name, value in record.items():
        print(f"  {name} {value:.12g}" if isinstance(value, float) else f"  {name} {value}")
    if pictures:
        draw(result.steps, case)
    return record


# --- schemes: for whole runs, and for errors of single steps -------------------------------------


def generalised_alpha(radius: float) -> tuple[fl.extend.Integrator, fl.extend.Integrator]:
    return fl.GeneralisedAlpha(radius=radius), fl.GeneralisedAlpha(radius=radius, tolerance=1e-10)


def energy_momentum(radius: float) -> tuple[fl.extend.Integrator, fl.extend.Integrator]:
    return fl.EnergyMomentum(), fl.EnergyMomentum()


def energy_decaying(radius: float) -> tuple[fl.extend.Integrator, fl.extend.Integrator]:
    return fl.EnergyDecaying(radius=radius), fl.EnergyDecaying(radius=radius)


SCHEMES = {f.__name__: f for f in (generalised_alpha, energy_momentum, energy_decaying)}


# --- scenes -------------------------------------------------------------------------------------


def pulsating() -> fl.Scene:
    """The free body."""
    tensor = [[3783.42, 352.9, 484.74], [352.9, 3776.16, 469.74], [484.74, 469.74, 2630.94]]
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1000.0, tensor, name="body"))
    body.add_velocity((10, 10, 10))
    body.add_velocity(omega=(10, 10, 10), about=body.point("centre"))
    for load, phase in zip(np.diag(SIZES), PHASES, strict=True):
        pulse = pulse_of(phase)
        scene.add(fl.PointLoad(body.point("centre"), force=load, history=pulse))
        scene.add(fl.PointLoad(body.point("centre"), moment=load, following=True, history=pulse))
    return scene


def pulse_of(phase: float) -> Callable[[float], float]:
    return lambda t: abs(sin(10.0 * t + phase))


def rigid_pendulum(group: fl.lie.Group = fl.lie.Group.R3xSO3) -> fl.Scene:
    """Two rigid bars along +X."""
    scene, start, points = fl.Scene(gravity=GRAVITY), 0.0, [fl.ground()]
    for length, name in zip(LENGTHS, ("bar I", "bar II"), strict=True):
        mass = DENSITY * SIDE**2 * length
        across = mass * (length**2 + SIDE**2) / 12
        J = (mass * SIDE**2 / 6, across, across)
        bar = fl.RigidBody(mass, J, (start + length / 2, 0, 0), name=name).set_group(group)
        scene.add(bar)
        scene.add(fl.joints.Spherical(points[-1], bar.point("centre"), at=(start, 0, 0)))
        points.append(bar.point("centre"))
        start += length
    return scene


def flexible_pendulum(cells: int = 5) -> fl.Scene:
    """The same of beams."""
    aluminium = fl.Material(E=70e9, nu=0.3, density=DENSITY)
    square = fl.Section.rectangle(
        SIDE, SIDE, aluminium, shear_factor=5 / 6, torsion_constant=0.1406 * SIDE**4
    )
    scene, start, point = fl.Scene(gravity=GRAVITY), 0.0, fl.ground()
    for length, name in zip(LENGTHS, ("bar I", "bar II"), strict=True):
        ends = (start, 0, 0), (start + length, 0, 0)
        bar = scene.add(fl.Beam.straight(*ends, square, cells=cells, name=name))
        scene.add(fl.joints.Spherical(point, bar.point("start")))
        start, point = start + length, bar.point("end")
    return scene


CASES = {"body": pulsating, "pendulum": rigid_pendulum, "flexible": flexible_pendulum}


def tip(result: fl.Result) -> np.ndarray:
    """End of bar II of the rigid pendulum, shape (T, 3)."""
    arm = 0.5 * LENGTHS[1] * result.rotation("bar II.centre")[:, :, 0]
    return result.position("bar II.centre") + arm


# --- numbers ------------------------------------------------------------------------------------


def body_numbers(steps: fl.post.StepHistory) -> dict[str, Any]:
    """Translation and rotation together."""
    ratios = steps.ratios
    smooth = ratios[~holds_kink(steps)]
    p05, median, p95 = np.percentile(ratios, (5, 50, 95))
    return {
        "ratio_median": float(median),
        "ratio_p05": float(p05),
        "ratio_p95": float(p95),
        "ratio_min": float(smooth.min()),
        "ratio_max": float(smooth.max()),
        "steps_with_a_kink": int(len(ratios) - len(smooth)),
        "share_within": float(((ratios >= 0.8) & (ratios <= 1.25)).mean()),
    }


def holds_kink(steps: fl.post.StepHistory) -> np.ndarray:
    """Whether the sine of a load changes its sign in a step."""
    ends = steps.times[:, np.newaxis]
    before, after = (
        np.floor((10.0 * t + np.array(PHASES)) / pi)
        for t in (ends - steps.sizes[:, np.newaxis], ends)
    )
    return (before != after).any(axis=1)


def joint_numbers(steps: fl.post.StepHistory) -> dict[str, Any]:
    """Likewise; the correlation is the smaller one of translation and rotation."""
    ratios = steps.ratios
    pairs = (
        (steps.translation, steps.measured_translation),
        (steps.rotation, steps.measured_rotation),
    )
    record = {
        f"share_within_{factor}": float(((ratios >= 1 / factor) & (ratios <= factor)).mean())
        for factor in (3, 5)
    }
    return record | {
        "ratio_median": float(np.median(ratios)),
        "log_correlation": min(float(np.corrcoef(np.log(a), np.log(b))[0, 1]) for a, b in pairs),
    }


def against_solver(scheme: fl.extend.Integrator, tolerance: float) -> dict[str, Any]:
    """The tip after 1 s, by steps that a tolerance chooses."""
    result = scheme.run(rigid_pendulum(), duration=1.0, step=fl.schemes.AdaptiveStep(tolerance))
    assert result.steps is not None
    end = tip(result)[-1]
    record: dict[str, Any] = {f"tip_{axis}": float(x) for axis, x in zip("xyz", end, strict=True)}
    return record | {
        "tip_error": float(np.linalg.norm(end - TIP)),
        "steps": len(result.steps.times),
        "rejected": len(result.steps.rejected),
        "factorisations": result.factorisations,
        "energy_error": result.energy_error,
    }


def follow_tolerance(
    scheme: fl.extend.Integrator, tightest: float, pictures: bool
) -> dict[str, Any]:
    """Error of the tip over the tolerance."""
    tolerances = 10.0 ** np.arange(-2, round(np.log10(tightest)) - 1, -1)
    runs = [against_solver(scheme, value) for value in tolerances]
    print(
        "tolerance [m/s]   steps  rejected  factorisations per 100   error of the tip [m]   energy"
    )
    for value, run in zip(tolerances, runs, strict=True):
        share = 100 * run["factorisations"] / run["steps"]
        print(f"{value:15.0e} {run['steps']:7} {run['rejected']:9} {share:23.2f} ", end="")
        print(f"{run['tip_error']:22.2e} {run['energy_error']:8.1e}")
    errors = [run["tip_error"] for run in runs]
    slope = float(np.polyfit(np.log(tolerances), np.log(errors), 1)[0])
    print(f"error ~ tolerance^{slope:.3f}")
    if pictures:
        draw_tolerances(tolerances, errors)
    return runs[-1] | {"slope": slope, "tolerance": float(tolerances[-1])}


# --- picture ------------------------------------------------------------------------------------


def draw(steps: fl.post.StepHistory, case: str) -> None:
    """Estimates and errors over time, as the paper's figures 11 to 13."""
    figure = Figure(figsize=(10.0, 4.0), dpi=150, layout="constrained")
    for axes, name, unit, k in zip(
        figure.subplots(1, 2), ("translation", "rotation"), ("m", "rad"), (0, 1), strict=True
    ):
        estimated, measured = getattr(steps, name), getattr(steps, f"measured_{name}")
        axes.semilogy(steps.times, measured, color="#BBBBBB", lw=3.0, label="ten-fold refinement")
        axes.semilogy(steps.times, estimated, color=COLOURS[k], lw=0.8, label="estimate")
        axes.set(xlabel="t [s]", ylabel=f"local error [{unit}]", title=f"{case}, {name}")
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.legend(frameon=False)
    save(figure, f"time_error_{case}.png")


def draw_tolerances(tolerances: np.ndarray, errors: list[float]) -> None:
    figure = Figure(figsize=(5.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    axes.loglog(tolerances, errors, "o-", color=COLOURS[0], label="rigid double pendulum")
    axes.loglog(tolerances, tolerances, "--", color="#888888", label="tolerance × 1 s")
    axes.set(xlabel="tolerance [m/s]", ylabel="error of the tip at 1 s [m]")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    save(figure, "time_error_tolerance.png")


def save(figure: Figure, name: str) -> None:
    RESULTS.mkdir(exist_ok=True)
    figure.savefig(RESULTS / name)
    print(f"picture: {RESULTS / name}")


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
