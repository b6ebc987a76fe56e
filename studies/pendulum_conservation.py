"""Energy and angular momentum of flexible double pendulums over a million steps.

C. Liu & H. Hu, Chin. J. Theor. Appl. Mech. 53 (2021) 213, section 4.1: the double pendulums of
double_pendulum.py, by a scheme that conserves. No force acts but in the joints, so the energy and,
because the joint with the ground is a spherical one, the angular momentum about the origin stay.

    case 1   5 mm x 5 mm, spherical joints, bar II turns with (3, 0, -4) rad/s, h = 1e-4 s
    case 2   0.2 mm x 0.2 mm, otherwise as case 1: large deformation, h = 1e-5 s
    case 3   as case 1 with a revolute joint about X between the bars, and (3, 0, 0) rad/s

fem_lie.EnergyMomentum takes every force over a step so that its work is exactly the change of an
energy: elements by a discrete gradient that has no resultant, joints by their gradient at the mean
configuration, inertia in positions and directors, where its matrix is constant. What the paper
reports as the errors of its scheme (7.0e-10 and, with the revolute joint, 9.1e-3 of the angular
momentum) are therefore no limits. The iteration goes on until only round-off changes, and what
round-off leaves over in a step is made up in the next.

--decaying RADIUS takes fem_lie.EnergyDecaying with that spectral radius instead: the energy falls
in every step by what the step does not resolve, and momenta stay.

--tolerance TOL chooses the steps by that error per time, m/s, for the time of --steps steps: energy
and momenta stay, because they are numbers of one instant and every step conserves them.

--file FILE writes results as they are made, with checkpoints; after an interruption --resume goes
on from the last one, to the same numbers bit for bit.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl
from demos.command_line import RESULTS, run
from demos.double_pendulum import REFERENCE_TIP, STEP, pendulum
from demos.records import deflection

PAPER = {1: (5.0e-12, 7.0e-10), 2: (1.7e-5, 1.0e-5), 3: (4.9e-9, 9.1e-3)}
"""Largest relative errors of energy and angular momentum that the paper reports."""
TARGET = {1: 5e-12, 2: 2e-11, 3: 5e-12}
FIRST = 0.3
"""Length of bar I, m."""


def main(
    case: int = 1,
    steps: int = 10_000,
    elements: int = 10,
    step: float | None = None,
    save_every: int = 0,
    decaying: float | None = None,
    tolerance: float | None = None,
    file: str | None = None,
    resume: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    if case not in PAPER:
        raise ValueError(f"case must be 1, 2 or 3, got {case}")
    if steps < 1:
        raise ValueError(f"steps must be at least 1, got {steps}")
    h = STEP[case] if step is None else step
    every = save_every or max(1, steps // 10_000)
    scheme = fl.EnergyMomentum() if decaying is None else fl.EnergyDecaying(radius=decaying)
    scene, one, two = pendulum(case, elements)
    # compile and load everything before the clock runs
    scheme.run(pendulum(case, elements)[0], duration=2 * h, step=h, progress=False)
    if resume:
        if file is None:
            raise ValueError("--resume needs the --file of the run that is to go on")
        result = scheme.resume(scene, file)
    else:
        choice = h if tolerance is None else fl.schemes.AdaptiveStep(tolerance, first=h)
        result = scheme.run(scene, duration=steps * h, step=choice, save_every=every, file=file)
    record = {"case": case, "elements": elements, "step": h, "save_every": every}
    made = steps if result.steps is None else len(result.steps.times)
    record |= numbers(result, one, two, scene, made)
    if result.steps is not None:
        record["different_steps"] = len(np.unique(result.steps.sizes.round(12)))
        record["rejected"] = len(result.steps.rejected)
    report(record, decaying)
    if pictures:
        draw(result, case)
    return record


def numbers(
    result: fl.Result, one: fl.Beam, two: fl.Beam, scene: fl.Scene, steps: int
) -> dict[str, Any]:
    """What a run says of itself, as plain numbers."""
    tip = result.position(two.point("end"))
    record: dict[str, Any] = {
        "steps": steps,
        "seconds": result.seconds,
        "ms_per_step": 1e3 * result.seconds / steps,
        "iterations_per_step": float(result.iterations[-1] / steps),
        "factorisations": result.factorisations,
        "energy_error": result.energy_error,
        "angular_momentum_error": result.angular_momentum_error,
        "constraint_error": constraint_error(result, one, two, scene),
        "max_deflection": max(deflection(result, bar) for bar in (one, two)),
        "largest_energy_gain": float(np.diff(result.total_energy).max() / result.kinetic[0]),
    }
    record |= {f"tip_{axis}": float(value) for axis, value in zip("xyz", tip[-1], strict=True)}
    at_one = result.index(1.0)
    if abs(result.times[at_one] - 1.0) < 1e-9:
        record["tip_distance_at_1s"] = float(np.linalg.norm(tip[at_one] - REFERENCE_TIP))
    return record


def constraint_error(result: fl.Result, one: fl.Beam, two: fl.Beam, scene: fl.Scene) -> float:
    """Largest violation at the kept times: gaps in lengths of bar I, and angles of the axis."""
    gaps = [
        result.position(one.point("start")),
        result.position(one.point("end")) - result.position(two.point("start")),
    ]
    worst = max(float(np.linalg.norm(gap, axis=1).max()) for gap in gaps) / FIRST
    for joint in scene.joints:
        if isinstance(joint, fl.joints.Revolute):
            axis = np.asarray(joint.axis, dtype=np.float64)
            ends = []
            for point in (joint.a, joint.b):
                own = point.frame[1:] @ axis
                ends.append(result.rotation(point) @ own)
            worst = max(worst, float(np.linalg.norm(np.cross(*ends), axis=1).max()))
    return worst


def report(record: dict[str, Any], decaying: float | None) -> None:
    """Print the figures beside those of the paper."""
    energy, momentum = PAPER[record["case"]]
    target = TARGET[record["case"]]
    scheme = "energy-momentum" if decaying is None else f"energy-decaying, radius {decaying}"
    print(f"case {record['case']}, {record['steps']} steps of {record['step']:g} s, {scheme}")
    print(f"{'':26}{'here':>12}{'paper':>12}{'target':>12}")
    for name, paper, wanted in (
        ("energy_error", energy, target),
        ("angular_momentum_error", momentum, target),
        ("constraint_error", None, 1e-12),
        ("ms_per_step", None, 0.15),
    ):
        beside = f"{paper:12.1e}" if paper is not None else f"{'':12}"
        print(f"{name:26}{record[name]:12.1e}{beside}{wanted:12.1e}")
    for name in ("iterations_per_step", "factorisations", "max_deflection", "seconds"):
        print(f"{name:26}{record[name]:12.4g}")
    print("tip", *(f"{record[f'tip_{axis}']:.8f}" for axis in "xyz"))
    if record["case"] == 1 and "tip_distance_at_1s" in record:
        print(f"tip at 1 s: {record['tip_distance_at_1s']:.1e} m from {REFERENCE_TIP}")


def draw(result: fl.Result, case: int) -> None:
    """Leave pictures of the motion, the energies, the momenta and their errors."""
    RESULTS.mkdir(exist_ok=True)
    name = RESULTS / f"pendulum_conservation_{case}"
    result.picture(f"{name}.png", trace=["bar II.end"], title=f"Double pendulum, case {case}")
    result.plot("bar II.end", path=f"{name}_tip.png")
    result.plot_energies(f"{name}_energies.png")
    result.plot_momentum(f"{name}_momenta.png")
    errors(result, Path(f"{name}_errors.png"), case)
    print(f"pictures: {name}*.png")


def errors(result: fl.Result, path: Path, case: int) -> None:
    """Relative errors of energy and angular momentum over time."""
    from matplotlib.figure import Figure

    from fem_lie.extend import COLOURS

    energy = np.abs(result.total_energy - result.total_energy[0]) / result.total_energy[0]
    L = result.angular_momentum
    momentum = np.linalg.norm(L - L[0], axis=1) / np.linalg.norm(L[0])
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    for values, label, colour in zip(
        (energy, momentum), ("energy", "angular momentum"), COLOURS, strict=False
    ):
        axes.semilogy(result.times, np.maximum(values, 1e-17), lw=0.7, label=label, color=colour)
    for value, label in zip(PAPER[case], ("energy, paper", "angular momentum, paper"), strict=True):
        axes.axhline(value, lw=0.7, ls="--", color="0.5")
        axes.annotate(label, (0.0, value), fontsize=8, va="bottom")
    axes.set_xlabel("time, s")
    axes.set_ylabel("relative error")
    axes.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    run(main)
