"""Errors after jumps of a load or of a drive: the table of docs/measured/time_error.md.

    python3 -m benchmarks.jumps

The mass on a spring of tests/jumping.py. A force sets in at a multiple of all steps or within one;
a drive accelerates the cart on which the mass is from such a time on. The scheme knows the
time by the history, or is not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

import fem_lie as fl
from tests.jumping import (
    ACCELERATION,
    AT_END,
    END,
    INSIDE,
    SCHEMES,
    after_step_force,
    driven,
    oscillator,
)

STEPS = (2e-2, 1e-2, 5e-3)


def load_error(scheme: str, at: float, announced: bool, step: float) -> float:
    """Of the displacement, the largest over the largest displacement."""
    history = fl.loads.PiecewiseLinear((0, at, at), (0, 0, 1))
    scene, body = oscillator(history if announced else lambda t: history(t))
    result = SCHEMES[scheme].run(scene, duration=END, step=step, progress=False)
    exact, _ = after_step_force(result.times, at)
    return float(np.abs(result.position(body.point("centre"))[:, 0] - exact).max() / 0.1)


def drive_error(scheme: str, at: float, announced: bool, step: float) -> float:
    """Of the velocity of the cart, the largest in m/s."""
    motion = fl.loads.PiecewiseSmooth(lambda t: 0.5 * ACCELERATION * max(t - at, 0.0) ** 2, (at,))
    scene, _ = driven(motion if announced else lambda t: motion(t))
    result = SCHEMES[scheme].run(scene, duration=END, step=step, progress=False)
    exact = ACCELERATION * np.maximum(result.times - at, 0.0)
    return float(np.abs(result.velocity("cart.centre")[:, 0] - exact).max())


def rows(error: Callable[[str, float, bool, float], float]) -> Iterator[str]:
    """A table of Markdown: schemes and times down, steps across, jumps known and unknown."""
    steps = " | ".join(f"{h:.0e} s" for h in STEPS)
    yield f"| | at | {steps} | unknown: {steps} |"
    yield "|---" * (2 + 2 * len(STEPS)) + "|"
    for scheme, at in product(SCHEMES, (AT_END, INSIDE)):
        found = [error(scheme, at, announced, h) for announced in (True, False) for h in STEPS]
        yield f"| {scheme} | {at:g} | " + " | ".join(f"{e:.1e}" for e in found) + " |"


def main() -> None:
    for title, error in (
        ("Load: error of the displacement over the largest", load_error),
        ("Drive: error of the velocity of the cart, m/s", drive_error),
    ):
        print(f"{title}\n", *rows(error), "", sep="\n", flush=True)


if __name__ == "__main__":
    main()
