"""The double pendulum of demos/double_pendulum.py with every policy for the iteration matrix.

Time per step is the best of several runs, on one core, with all results kept. The tip's error is
the distance to a run with half the step and a new matrix in every iteration. With a matrix that is
never renewed a run ends when the joints have turned too far.

Then case 1 with steps that do not resolve the vibrations of the bars (axial period 1e-4 s).
"""

from __future__ import annotations

import numpy as np

import fem_lie as fl
from demos.double_pendulum import POLICIES, STEP, pendulum
from fem_lie.solve.motion.policies import RefactorisationPolicy

RUNS = 3
DURATION = {1: 0.2, 2: 0.02, 3: 0.2}


def run(case: int, policy: RefactorisationPolicy, step: float) -> tuple[fl.Result, bool]:
    """Results, and whether they reach the end."""
    scheme = fl.GeneralisedAlpha(radius=0.8, policy=policy)
    try:
        scene = pendulum(case)[0]
        return scheme.run(scene, step=step, duration=DURATION[case], progress=False), True
    except fl.ConvergenceError as error:
        return error.result, False


def main() -> None:
    print("                          iterations  factor-   relative errors of  error of")
    print("case  policy     ms/step    per step  isations  energy   ang. mom.  tip [m]")
    for case, step in STEP.items():
        reference = run(case, fl.schemes.EveryIteration(), step / 2)[0].position("bar II.end")[-1]
        for name, policy in POLICIES.items():
            result, whole = min((run(case, policy, step) for _ in range(RUNS)), key=_seconds)
            steps = len(result.times) - 1
            gap = np.linalg.norm(result.position("bar II.end")[-1] - reference)
            print(
                f"{case:4}  {name:10} {1e3 * result.seconds / steps:7.3f}"
                f" {result.iterations[-1] / steps:11.2f} {result.factorisations:9}"
                f"  {result.energy_error:.1e}  {result.angular_momentum_error:.1e}"
                f"    {f'{gap:.1e}' if whole else f'ends at {result.times[-1]:.3f} s'}"
            )


def larger_steps() -> None:
    scheme = fl.GeneralisedAlpha(radius=0.8)
    print("\nstep [s]   tip [m]   energy  iterations per step")
    end = None
    for step in (2.5e-5, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2):
        result = scheme.run(pendulum(1)[0], step=step, duration=1.0, progress=False)
        position = result.position("bar II.end")[-1]
        end = position if end is None else end
        count = result.iterations[-1] / (len(result.times) - 1)
        gap = np.linalg.norm(position - end)
        print(f"{step:8.1e}  {gap:.1e}  {result.energy_error:.1e}  {count:10.2f}")


def _seconds(pair: tuple[fl.Result, bool]) -> float:
    return pair[0].seconds


if __name__ == "__main__":
    main()
    larger_steps()
