"""Meshes for one number: a critical load, a frequency, a deflection, each to a given accuracy.

The arch of deep_arch.py, hinged at one end and clamped at the other, carries no more than a limit
load. There the tangent is singular; its null vector is the dual solution, and the load at which
that happens is wrong by what the recovered stress misses in the balance along it.

A square plate with a round hole, clamped around, swings. The square of a frequency is too large by
the energy that its mode misses. A quarter is solved, in triangles; new points of its edge at the
hole lie on the circle. The mode is smooth, and nearly all triangles are cut.

An L-shaped frame has a corner that is a hundred times as stiff as its arms. Its tip sinks under a
force; the elements of the corner need no cutting, and get none.

Each is one call of `fl.adaptivity.adapt`. Reference: the same with a smaller tolerance, corrected
by its estimate.
"""

from __future__ import annotations

from typing import Any

from command_line import in_results, run
from goal_problems import CASES, Case

import fem_lie as fl

FINER = 1 / 16
"""Tolerance of the reference over the tolerance."""


def refined(case: Case, tolerance: float) -> fl.adaptivity.Adapted[Any]:
    """One call."""
    return fl.adaptivity.adapt(
        case.build,
        case.mesh(),
        tolerance=tolerance,
        goal=case.goal,
        part=case.part,
        onto=case.onto,
    )


def main(case: str = "arch", tolerance: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    if case not in CASES:
        raise ValueError(f"case must be one of {', '.join(CASES)}, got {case!r}")
    found = refined(CASES[case], tolerance)
    reference = refined(CASES[case], FINER * tolerance).value
    error = reference - found.error.value
    if pictures:
        found.error.picture(in_results(f"adaptive_goals_{case}.png"))
    return {
        "case": case,
        "value": found.error.value,
        "reference": reference,
        "error": error / reference,
        "effectivity": float(found.calibration[-1]) * found.error.estimate / error,
        "calibration": float(found.calibration[-1]),
        "unknowns": int(found.unknowns[-1]),
        "meshes": len(found.meshes),
    }


if __name__ == "__main__":
    run(main, show=True)
