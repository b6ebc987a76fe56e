"""Fourth order that conserves: steps that are made of steps of energy-momentum.

fem_lie.Composed makes each step of steps of another scheme, of which some go back in time, so that
the errors of second order cancel. Each of them keeps energy and angular momentum to round-off, so
all of them do. Three things are shown:

- the order, in frames, velocities and joint forces, of a soft beam that flies, and of the double
  pendulum of double_pendulum.py (case 1). Its bars start with a jump of their velocities, which
  wakes all waves there are, up to 2e6 rad/s: steps must resolve these, so the time is short.
- energy and angular momentum over many steps of both;
- what an error of 1e-7 of the length costs: the soft double pendulum of speed_against_error.py
  under gravity, for 0.4 s, against generalised-alpha. Both are run in turns, with the tolerance
  of the iteration that each needs; the best time of each step counts.

--triple takes Yoshida's triple jump, in place of Suzuki's five stages.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from demos.double_pendulum import pendulum
from studies.speed_against_error import DURATION, LENGTH

RESULTS = Path(__file__).parents[1] / "results"
SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
TOLD = ("frames", "velocities", "joint_forces")
ERROR, FINE = 1e-7, 1600
STEPS_OF_ALPHA = (1600, 3200, 6400, 12800)
STEPS_COMPOSED = {False: (40, 80, 160, 320), True: (80, 160, 320, 640)}


def flying_beam() -> fl.Scene:
    """A soft beam that turns, flies and bends."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), SOFT, cells=6))
    beam.turn((3, 1, -8), about=(0.2, 0, 0))
    beam.move((1.0, 0.0, 0.5))
    s = beam.frames[:, 0, 0] / 0.5
    beam.velocities[:, 2] += 4.0 * np.sin(np.pi * s)
    return scene


def case_1() -> fl.Scene:
    """The double pendulum of aluminium."""
    return pendulum(1)[0]


def soft_pendulum() -> tuple[fl.Scene, fl.Beam]:
    """The one of speed_against_error.py, and its lower bar."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one, two = (
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), SOFT, cells=4))
        for a, b in ((0.0, 0.4), (0.4, 1.0))
    )
    scene.add(fl.Spherical(fl.ground(), one.start))
    scene.add(fl.Revolute(one.end, two.start, axis=(0, 1, 0.3)))
    return scene, two


def main(
    triple: bool = False,
    steps: int = 2000,
    repeats: int = 3,
    speed: bool = True,
    pictures: bool = True,
) -> dict[str, Any]:
    how = fl.TripleJump() if triple else fl.FiveStages()
    scheme = fl.Composed(composition=how)
    more = 4 if triple else 1  # its error is so much larger
    record: dict[str, Any] = {"composition": type(how).__name__}
    cases: dict[str, tuple[Callable[[], fl.Scene], float, tuple[int, ...], float]] = {
        "beam": (flying_beam, 0.01, (16, 32, 64, 128), 2e-3),
        "pendulum": (case_1, 4e-4, (64, 128, 256, 512), 1e-3),
    }
    for name, (scene, duration, numbers, step) in cases.items():
        found = orders(scheme, scene, duration, [more * n for n in numbers])
        record |= {f"order_{name}_{what}": value for what, value in found.items()}
        result = scheme.run(scene(), duration=steps * step, step=step, save_every=10)
        record[f"energy_error_{name}"] = result.energy_error
        record[f"angular_momentum_error_{name}"] = result.angular_momentum_error
        record[f"ms_per_step_{name}"] = 1e3 * result.seconds / steps
    observed = [value for key, value in record.items() if key.startswith("order_")]
    record["order"] = max(observed, key=lambda value: abs(value - 4.0))
    for what in ("energy_error", "angular_momentum_error"):
        record[what] = max(record[f"{what}_{name}"] for name in cases)
    tables = {}
    if speed:
        tables = compare(how, STEPS_COMPOSED[triple], repeats)
        seconds = {name: seconds_at(ERROR, rows) for name, rows in tables.items()}
        record |= {f"seconds_at_1e7_{name}": value for name, value in seconds.items()}
        record["speedup_at_1e7"] = seconds["GeneralisedAlpha"] / seconds["Composed"]
    for key, value in record.items():
        print(f"{key:34}{value:.4g}" if isinstance(value, float) else f"{key:34}{value}")
    if pictures and tables:
        draw(tables)
    return record


def orders(
    scheme: fl.Composed, scene: Callable[[], fl.Scene], duration: float, numbers: list[int]
) -> dict[str, float]:
    """Observed order of all that is told, from runs with so many steps: the mean of all pairs."""
    ends = []
    for steps in numbers:
        result = scheme.run(scene(), duration=duration, step=duration / steps, save_every=steps)
        ends.append([getattr(result, name)[-1] for name in TOLD])
    found = {}
    for k, name in enumerate(TOLD):
        if ends[0][k].size:
            changes = [np.abs(a[k] - b[k]).max() for a, b in pairwise(ends)]
            slopes = np.log2(changes[:-1]) - np.log2(changes[1:])
            found[name] = float(np.mean(slopes))
    return found


def fall(scheme: Any, steps: int) -> tuple[np.ndarray, float]:
    """Where the tip of the soft pendulum is at the end, and seconds."""
    scene, lower = soft_pendulum()
    result = scheme.run(scene, duration=DURATION, step=DURATION / steps, save_every=steps)
    return result.position(lower.end)[-1], result.seconds


def compare(
    how: fl.Composition, steps: tuple[int, ...], repeats: int
) -> dict[str, list[tuple[float, float]]]:
    """Error of the tip, over the length, and seconds, of each scheme and number of steps."""
    alpha = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10)
    composed = fl.Composed(fl.EnergyMomentum(tolerance=ERROR), how)
    runs = [(alpha, n) for n in STEPS_OF_ALPHA] + [(composed, n) for n in steps]
    end, _ = fall(fl.Composed(), FINE)
    made = [[fall(scheme, steps) for scheme, steps in runs] for _ in range(repeats)]
    tables: dict[str, list[tuple[float, float]]] = {}
    for k, (scheme, _) in enumerate(runs):
        error = float(np.linalg.norm(made[0][k][0] - end) / LENGTH)
        row = error, min(turn[k][1] for turn in made)
        tables.setdefault(type(scheme).__name__, []).append(row)
    return tables


def seconds_at(error: float, rows: list[tuple[float, float]]) -> float:
    """What an error costs, between the runs; logarithms of both."""
    errors, seconds = np.log(np.array(sorted(rows))).T
    return float(np.exp(np.interp(np.log(error), errors, seconds)))


def draw(tables: dict[str, list[tuple[float, float]]]) -> None:
    """Error over seconds."""
    RESULTS.mkdir(exist_ok=True)
    figure = Figure(figsize=(5.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    for name, rows in tables.items():
        errors, seconds = zip(*rows, strict=True)
        axes.loglog(seconds, errors, "o-", markersize=4, label=name)
    axes.set(xlabel="seconds", ylabel="error of the tip, relative", title="Soft double pendulum")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    figure.savefig(RESULTS / "order_four.png")
    print(f"picture: {RESULTS / 'order_four.png'}")


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
