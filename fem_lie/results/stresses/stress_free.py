"""Stress-free strains of shells and solids in states of a result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import States
from fem_lie.scene import Scene
from fem_lie.scene.load import strains_of
from fem_lie.scene.scene import require_scene


def strains_in(
    result: States, body: Shell | Solid, states: Sequence[int], scene: Scene | None
) -> Sequence[Array | None]:
    """Stress-free strains of a body in some states, each (m, s) or none.

    Args:
        result: A result of a scene with the body.
        body: The shell or solid.
        states: Numbers of the states.
        scene: The scene that was solved; needed if the body has such strains there.

    Raises:
        ValueError: It has, and no scene is given.
    """
    if scene is None:
        require_no_strains(result, body, "stresses need scene=...")
        return [None] * len(states)
    require_scene(scene)
    rows = np.array(states, dtype=np.int64)
    times: Array
    factors: Array
    if isinstance(result, Result):
        times, factors = result.times[rows], np.ones(len(rows))
    else:
        times = cast(StaticResult, result).factors[rows]
        factors = times.copy()
    return list(strains_of(scene.loads, body, times, factors))


def require_no_strains(result: States, body: Shell | Solid, otherwise: str) -> None:
    """Raise ``ValueError`` if a body has loads that are stress-free strains.

    Args:
        result: A result of the scene with these loads.
        body: The shell or solid.
        otherwise: What is needed, or impossible, then, for the message.
    """
    if body.name in result.info.strained:
        raise ValueError(
            f"{otherwise}: {body.label} has stress-free strains in the scene of this result "
            "(Temperature, Eigenstrain, PreStress)"
        )
