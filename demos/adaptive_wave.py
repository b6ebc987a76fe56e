"""Adaptive meshes and steps for a travelling wave, with one tolerance.

A smooth push sends a wave into a free rod of twenty metres; it is half a metre long, and its shape
does not change as it runs. Elements are small where it is, and nowhere else: every 40 µs the mesh
is generated again from the recovered stress, and the state is transferred to it. The axial force is
known in closed form, `N = −F(t − x/c) + F(t − (2 L − x)/c)`.

At each change of the mesh momenta are kept to round-off. The tolerance τ is split between space and
time, `τ² = s τ² + (1 − s) τ²`. The uniform run has about the same error at the end.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from moving_meshes import (
    FORCE,
    LENGTH,
    MOTIONS,
    SPEED,
    STIFFNESS,
    draw,
    line,
    push,
    strains,
    uniform,
)

import fem_lie as fl

POINTS = 8000
"""Places at which strains are compared."""


def exact(positions: Any, time: float) -> Any:
    """Axial strain of the wave."""
    there, back = time - positions / SPEED, time - (2 * LENGTH - positions) / SPEED
    force = [FORCE * (push(b) - push(a)) for a, b in zip(there, back, strict=True)]
    return np.array(force) / STIFFNESS


def main(
    case: str = "wave",
    tolerance: float = 0.1,
    duration: float | None = None,
    compare: bool = True,
    pictures: bool = True,
) -> dict[str, Any]:
    if case not in MOTIONS:
        raise ValueError(f"case must be one of {', '.join(MOTIONS)}, got {case!r}")
    motion = MOTIONS[case]
    end = motion.duration if duration is None else duration
    positions = (np.arange(POINTS) + 0.5) / POINTS * motion.length
    found = fl.adaptivity.adapt_motion(
        motion.build,
        line(motion, motion.cells),
        duration=end,
        every=motion.every,
        tolerance=tolerance,
        size=motion.size,
        ahead=motion.ahead,
        space_fraction=0.6,
    )
    last = found.segments[-1]
    true = exact(positions, end)

    def error(scene: fl.Scene, result: fl.Result) -> float:
        gap = strains(scene, result, positions) - true
        return float(np.linalg.norm(gap) / np.linalg.norm(true))

    record = {
        "case": case,
        "tolerance": tolerance,
        "error": error(last.scene, last.result),
        "meshes": len(found.segments),
        "cells": [int(found.cells.min()), int(found.cells.max())],
        "steps": int(found.steps.sum()),
        "element_steps": found.element_steps,
        "momentum_error": found.momentum_error,
        "energy_change": found.energy_change / float(found.kinetic[-1] + found.elastic[-1]),
    }
    if compare:
        cells, steps = motion.uniform
        record["uniform_element_steps"] = cells * steps
        record["uniform_error"] = error(*uniform(motion, cells, steps, end))
        record["fewer"] = cells * steps / found.element_steps
    if pictures:
        draw(found, in_results(f"adaptive_wave_{case}.png"))
    return record


if __name__ == "__main__":
    run(main, show=True)
