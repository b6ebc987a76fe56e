"""A scheme of fourth order: seven parts of a step, each made by the energy-momentum scheme.

A composition says of which parts a step is made. A symmetric scheme of second order in parts γₖ h,
the same from either end, is of fourth order if Σ γₖ = 1 and Σ γₖ³ = 0. Six equal parts γ, three at
either end, and one of 1 − 6 γ that goes back: 6 γ³ + (1 − 6 γ)³ = 0. Parts may have two sizes, for
each of which there is a matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import fem_lie as fl

PART = 1.0 / (6.0 - 6.0 ** (1.0 / 3.0))


@dataclass(frozen=True)
class SevenParts(fl.schemes.Composition):
    """Three parts of 0.24 of a step, one of −0.43, and three again."""

    @property
    def parts(self) -> tuple[float, ...]:
        """Their sizes; their sum is one."""
        return PART, PART, PART, 1.0 - 6.0 * PART, PART, PART, PART


def end(steps: int) -> np.ndarray:
    """How a tumbling body has turned after one second."""
    body = fl.RigidBody(1.0, (0.1, 0.2, 0.28), name="body")
    body.add_velocity(omega=(2.0, 3.0, 1.0), about=body.point("centre"))
    scene = fl.Scene()
    scene.add(body)
    scheme = fl.schemes.Composed(composition=SevenParts())
    result = scheme.run(scene, duration=1.0, step=1.0 / steps)
    return result.rotation(body.point("centre"))[-1]


coarse, middle, fine = (end(steps) for steps in (10, 20, 40))
order = np.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine))
print(f"order {order:.2f}")
