"""Double four-bar mechanism: ten seconds through postures in which it may change its branch.

IFToMM benchmark A02 with N = 2. Three bars stand upright on hinges at x = 0, 1, 2 m, two bars join
their tops; all are 1 m and 1 kg, thin. Gravity acts along -y; the top of the first bar, B0, starts
with 1 m/s along x. The upright bars stay parallel and the mechanism is one pendulum,
3 theta" = -3.5 g cos(theta) (reference: that, to ten digits).

Where all bars lie flat, twice per turn or swing, the constraints lose rank: each loop could go over
to its crossed branch, and the joint forces there are not unique. Only the velocity says how it goes
on. A step that ends near the flat posture, at an angle of d from it, has an iteration matrix with
an eigenvalue of d^2, so round-off counts as 1/d^2: an iteration that is to converge to 1e-10 may
find no end there with hinges. --tolerance is 1e-8 for that reason; what that leaves adds up, so
steps below 2e-3 want less of it.

Two ways to write it: five hinges for each loop of bars, of which six constraints too many in all
(Redundant.MINIMUM_NORM; they are planar), or at one end of each upper bar a pin, a point that stays
in two planes of the next upright bar (InPlane), with nothing redundant but in the flat posture.
The conserving scheme takes the second only. It iterates to round-off, which there is what the last
digits of the posture make of it: it asks for that when its increments fall no more.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl

try:
    from demos.extrapolation import extrapolated
except ModuleNotFoundError:  # started as a script
    from extrapolation import extrapolated

RESULTS = Path(__file__).parents[1] / "results"
REFERENCE = np.loadtxt(Path(__file__).parent / "reference" / "double_four_bar.csv", delimiter=",")
INERTIA = (1e-9, 1.0 / 12.0, 1.0 / 12.0)
LARGEST = 0.02
"""Largest variable step, s."""


def mechanism(angle: float = np.pi / 2, speed: float = 1.0, pins: bool = False) -> fl.Scene:
    """The scene at an angle of the upright bars from x, which turn backwards with ``speed``."""
    kind = fl.Redundant.REFUSE if pins else fl.Redundant.MINIMUM_NORM
    scene = fl.Scene(gravity=(0, -9.81, 0), redundant=kind)
    along, z = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    axes = np.column_stack([along, np.cross(z, along), z])
    upright = []
    for k in range(3):
        foot = np.array([k, 0.0, 0.0])
        bar = scene.add(fl.RigidBody(1.0, INERTIA, foot + 0.5 * along, axes, name=f"bar {k}"))
        bar.turn(-speed * z, about=foot)
        scene.add(fl.Revolute(fl.ground(), bar.centre, at=foot, axis=z))
        upright.append(bar)
    for k in range(2):
        place = np.array([k + 0.5, 0.0, 0.0]) + along
        bar = scene.add(fl.RigidBody(1.0, INERTIA, place, name=f"top {k}"))
        bar.move(np.cross(-speed * z, along))
        half = np.array([0.5, 0.0, 0.0])
        left, right = place - half, place + half
        scene.add(fl.Revolute(upright[k].centre, bar.centre, at=left, axis=z))
        if pins:
            for normal in np.eye(3)[:2]:
                scene.add(fl.InPlane(upright[k + 1].centre, bar.centre, at=right, axis=normal))
        else:
            scene.add(fl.Revolute(bar.centre, upright[k + 1].centre, at=right, axis=z))
    return scene


def parallel(result: fl.Result) -> float:
    """Largest angle between two of the upright bars: round-off on the regular branch."""
    axes = [result.rotation(f"bar {k}.centre")[:, :2, 0] for k in range(3)]
    cross = [a[:, 0] * axes[0][:, 1] - a[:, 1] * axes[0][:, 0] for a in axes[1:]]
    dot = [(a * axes[0]).sum(axis=1) for a in axes[1:]]
    return float(np.abs(np.arctan2(cross, dot)).max())


def attempt(label: str, go: Callable[[], fl.Result]) -> dict[str, Any]:
    """One run: how far it comes, and how well."""
    try:
        result, end = go(), ""
    except fl.ConvergenceError as error:
        result, end = error.result, str(error).split(":")[0]
    rows = REFERENCE[REFERENCE[:, 0] <= result.times[-1] * (1 + 1e-12)]
    path = 2.0 * result.resampled(rows[:, 0]).position("bar 0.centre")[:, :2]
    case = {
        "label": label,
        "end": float(result.times[-1]),
        "error": float(np.abs(path - rows[:, 1:3]).max()),
        "angle_between": parallel(result),
        "energy_error": result.energy_error,
        "path": path,
        "result": result,
    }
    print(
        f"{label:34}{case['end']:8.3f}{case['error']:12.1e}{case['angle_between']:14.1e}"
        f"{case['energy_error']:12.1e}  {end}"
    )
    return case


def main(
    step: float = 4e-3,
    runs: int = 2,
    duration: float = 10.0,
    tolerance: float = 1e-8,
    pictures: bool = True,
) -> dict[str, Any]:
    """``runs``: constant steps of step, step/2 and so on; each must divide 0.5 s."""
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=tolerance)
    print("largest over the run:               until s  error [m]  between bars      energy")

    def constant(h: float, pins: bool) -> fl.Result:
        return scheme.run(mechanism(pins=pins), duration=duration, step=h)

    cases = []
    for h in (step / 2**k for k in range(runs)):
        cases.append(attempt(f"h = {h:g}, hinges", lambda h=h: constant(h, False)))
    pinned = attempt(f"h = {step:g}, pins", lambda: constant(step, True))
    variable = attempt(
        "variable, 1e-3 m/s, hinges",
        lambda: scheme.run(
            mechanism(), duration=duration, step=fl.AdaptiveStep(1e-3, largest=LARGEST)
        ),
    )
    conserving = attempt(
        f"h = {step:g}, pins, EnergyMomentum",
        lambda: fl.EnergyMomentum().run(mechanism(pins=True), duration=duration, step=step),
    )
    record: dict[str, Any] = {
        name: {key: case[key] for key in ("end", "error", "angle_between", "energy_error")}
        for name, case in (
            ("hinges", cases[-1]),
            ("pins", pinned),
            ("variable", variable),
            ("conserving", conserving),
        )
    }
    record["step"] = step
    record["errors"] = [case["error"] for case in cases]
    shared = min(len(case["path"]) for case in cases)
    limit = extrapolated([case["path"][:shared] for case in cases])
    record["extrapolated"] = float(np.abs(limit - REFERENCE[:shared, 1:3]).max())
    print(f"extrapolated: {record['extrapolated']:.1e} m")
    if pictures:
        RESULTS.mkdir(exist_ok=True)
        file = RESULTS / "double_four_bar.png"
        cases[-1]["result"].picture(file, title="Double four-bar mechanism")
        print(f"picture: {file}")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)
