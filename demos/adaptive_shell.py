"""Adaptive meshes of shells: an L-shaped plate, or a pinched cylinder.

Where a solution is singular, as at the corner of the plate, equal elements waste nearly all of
themselves. Both problems are in adaptive_problems.py.

The goal J, a deflection, has a dual solution z, the motion under a unit force at its point. What an
element adds to the error of J is the product of two errors of its stress, in the solution and in z
(R. Becker & R. Rannacher, Acta Numerica 10 (2001) 1), each estimated by the difference from a
stress that is averaged over the patch around each node, in local frames. Of the plate each mesh is
generated again, with triangles that have the same part of the sum each; of the cylinder the fewest
triangles with half of the sum are cut. The sum has a sign and corrects J.

Of the cylinder the estimate misses a part: flat cells are wrong in their stiffness, which no stress
shows. But from mesh to mesh J moves by more than was estimated, and by so much the next estimate is
multiplied.

The problem is solved on equal triangles as well, each cut in four, for comparison. Reference is
the corrected deflection of the finest of all meshes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from adaptive_problems import PROBLEMS, Problem
from command_line import in_results, run

import fem_lie as fl

MOST = 60_000
"""Unknowns; where equal triangles need more, their number is extrapolated."""
FINER = 0.25
"""Tolerance of the reference, over that which is asked for."""


def refined(
    problem: Problem, tolerance: float, equal: bool
) -> fl.adaptivity.Adapted[fl.mesh.SurfaceMesh]:
    """Meshes down to a tolerance, or as far as it goes."""
    try:
        return fl.adaptivity.adapt(
            problem.build,
            problem.equal() if equal else problem.mesh(),
            tolerance=tolerance,
            goal=problem.goal,
            solve=fl.statics,
            part=1.0 if equal else 0.5,
            fall=None if equal else problem.fall,
            most=MOST,
            onto=problem.onto,
        )
    except fl.ConvergenceError as error:
        return error.result


def unknowns_at(unknowns: np.ndarray, errors: np.ndarray, tolerance: float) -> float:
    """Where an error has this size, on the line through the two meshes beside it."""
    x, y = np.log(unknowns), np.log(errors)
    k = min(max(int((errors > tolerance).sum()), 1), len(x) - 1)
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return float(np.exp(x[k] + (np.log(tolerance) - y[k]) / slope))


def main(case: str = "l_plate", tolerance: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    if case not in PROBLEMS:
        raise ValueError(f"case must be one of {', '.join(PROBLEMS)}, got {case!r}")
    problem = PROBLEMS[case]
    found = refined(problem, tolerance, False)
    uniform = refined(problem, tolerance, True)
    reference = refined(problem, FINER * tolerance, False).value
    error = reference - found.error.value

    def true_unknowns(meshes: fl.adaptivity.Adapted[fl.mesh.SurfaceMesh]) -> float:
        errors = np.abs(reference - meshes.values) / abs(reference)
        return unknowns_at(meshes.unknowns, errors, tolerance)

    if pictures:
        found.error.picture(in_results(f"adaptive_shell_{case}.png"))
    return {
        "case": case,
        "value": found.error.value,
        "reference": reference,
        "estimate": found.error.estimate,
        "calibration": float(found.calibration[-1]),
        "error": error / reference,
        "effectivity": float(found.calibration[-1]) * found.error.estimate / error,
        "meshes": len(found.meshes),
        "unknowns": unknowns_at(found.unknowns, found.relative, tolerance),
        "unknowns_uniform": unknowns_at(uniform.unknowns, uniform.relative, tolerance),
        "unknowns_true": true_unknowns(found),
        "unknowns_true_uniform": true_unknowns(uniform),
    }


if __name__ == "__main__":
    run(main, show=True)
