"""Conservation with order four: compositions of the energy-momentum scheme.

fem_lie.schemes.Composed makes each step of steps of another scheme, of which some go back in time,
so that the errors of second order cancel. Each of them keeps energy and angular momentum to
round-off, so all of them do. Three things are shown, of one case:

- the order, the one farthest from 4 of those of frames, velocities and joint forces;
- errors of energy and angular momentum over many steps;
- what an error of 1e-7 of the length in nodal positions costs, against generalised-alpha.
  Both are run in turns, and the least time of the processor of each number of steps counts.

    pendulum   the double pendulum of double_pendulum.py, case 1. Its bars start with a jump of
               their velocities, which wakes all waves there are, up to 2e6 rad/s; steps must
               resolve these, so orders are those of a short time, and costs those of the same
               pendulum of soft bars that falls for 0.4 s (its axis tilted, so that it leaves the
               plane)
    beam       a soft beam that turns, flies and bends

--triple takes Yoshida's triple jump, in place of Suzuki's five stages.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from command_line import one_of, run
from diagrams import diagram
from double_pendulum import pendulum
from soft_bars import flying_beam, soft_pendulum

import fem_lie as fl

ERROR = 1e-7
ALPHA, COMPOSED = [1600 * 2**k for k in range(6)], [80, 160, 320, 640]


class Case(NamedTuple):
    """For orders: scene, duration, steps; size of those of a long run; costs of another scene."""

    scene: Callable[[], fl.Scene]
    short: float
    numbers: list[int]
    step: float
    timed: Callable[[], fl.Scene]
    long: float
    length: float


CASES = {
    "pendulum": Case(lambda: pendulum()[0], 4e-4, [64, 128, 256], 1e-3, soft_pendulum, 0.4, 1),
    "beam": Case(flying_beam, 0.01, [16, 32, 64, 128], 2e-3, flying_beam, 0.1, 0.5),
}


def ends(scheme: Any, scene: Any, duration: float, numbers: list[int]) -> list[fl.Result]:
    """Runs with so many steps, of which the last state is kept."""
    return [
        scheme.run(scene(), duration=duration, step=duration / n, save_every=n) for n in numbers
    ]


def main(
    case: str = "pendulum",
    triple: bool = False,
    steps: int = 2000,
    repeats: int = 3,
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("case", case, CASES)
    plan, how = CASES[case], fl.schemes.TripleJump() if triple else fl.schemes.FiveStages()
    scheme, orders = fl.schemes.Composed(composition=how), {}
    runs = ends(scheme, plan.scene, plan.short, [(1 + 3 * triple) * n for n in plan.numbers])
    for name in ("frames", "velocities", "joint_forces"):
        last = [getattr(made, name)[-1] for made in runs]
        if last[0].size:
            changes = np.log2([np.abs(a - b).max() for a, b in pairwise(last)])
            orders[f"order_{name}"] = float(-np.diff(changes).mean())
    kept = scheme.run(plan.scene(), duration=steps * plan.step, step=plan.step, save_every=10)
    record: dict[str, Any] = {
        "order": max(orders.values(), key=lambda order: abs(order - 4.0)),
        "energy_error": kept.energy_error,
        "angular_momentum_error": kept.angular_momentum_error,
        "ms_per_step": 1e3 * kept.seconds / steps,
        **orders,
    }
    if repeats:
        curves = costs(plan, how, repeats)
        alpha, composed = (np.exp(np.interp(np.log(ERROR), *np.log(c[:, ::-1]))) for c in curves)
        record |= {"speedup_at_1e7": float(alpha / composed)}
        if pictures:
            draw(curves)
    return record


def costs(plan: Case, how: fl.schemes.Composition, repeats: int) -> list[np.ndarray]:
    """Errors of positions over the length, and least seconds, of both schemes over steps."""
    end = ends(fl.schemes.Composed(), plan.timed, plan.long, [2560])[0].frames[-1, :, 0]
    alpha = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10)
    both = (alpha, ALPHA), (fl.schemes.Composed(fl.EnergyMomentum(tolerance=ERROR), how), COMPOSED)
    turns = [[[timed(s, plan, n) for n in ns] for s, ns in both] for _ in range(repeats)]
    curves = []
    for k, row in enumerate(turns[0]):
        gap = [np.linalg.norm(r.frames[-1, :, 0] - end, axis=1).max() / plan.length for r, _ in row]
        curves.append(np.array([gap, np.min([[t for _, t in turn[k]] for turn in turns], axis=0)]))
    return curves


def timed(scheme: Any, plan: Case, number: int) -> tuple[fl.Result, float]:
    """A run of so many steps, and its seconds of the processor, whatever else runs."""
    begin, (result,) = process_time(), ends(scheme, plan.timed, plan.long, [number])
    return result, process_time() - begin


def draw(curves: list[np.ndarray]) -> None:
    """Error over seconds."""
    with diagram("order_four.png") as axes:
        for (errors, seconds), name in zip(curves, ("generalised-alpha", "composed"), strict=True):
            axes.loglog(seconds, errors, "o-", markersize=4, label=name)
        axes.set(xlabel="seconds", ylabel="error of positions, relative")


if __name__ == "__main__":
    run(main, show=True)
