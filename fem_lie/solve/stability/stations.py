"""States of a path in the numbering of the whole scene, for any number of ranks.

A rank of a divided scene has the state of its part. Its station in a result has the frames of all
nodes and all multipliers instead; what else a path needs is computed again where it starts there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem_lie.parts.part_scene import undivided
from fem_lie.results.gathering import Gathering
from fem_lie.results.path import EquilibriumState, Station
from fem_lie.solve.recording.whole_state import MovingState, is_whole, own, whole
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.path_step import Walker

_BALANCE = 15  # numbers of an energy balance, which a path does not have


def whole_station(model: StableEquilibrium, station: Station) -> Station:
    """A state of the whole scene, the same on all ranks.

    Args:
        model: The scene or its part.
        station: State of that; returned if it is that of the whole scene.
    """
    equations, gathering = model.equations, model.whole.gathering
    if gathering is None:
        return station
    n = equations.unknowns.moving
    moving = MovingState(
        station.state.frames[:n],
        np.empty((0, n, 6)),
        station.state.multipliers[np.newaxis],
        np.zeros(_BALANCE),
    )
    kept = whole(gathering, equations, moving)
    none = np.empty((0, 3))
    state = EquilibriumState(np.empty((0, 4, 3)), np.empty(0), equations.shared.comm.bcast(kept))
    return replace(station, state=state, positions=none, velocity=none, response=np.empty(0))


def own_station(walker: Walker, station: Station) -> Station:
    """A state of a path as one of the scene or of its part on this rank.

    Args:
        walker: Computes the tangent of the path there.
        station: State of this scene, from a result.

    Raises:
        ValueError: It is that of another scene, or one of an undivided scene on several ranks.
    """
    model, kept = walker.model, station.state.saved
    equations, part = model.equations, model.equations.part
    if not is_whole(kept):
        if part is not None:
            raise ValueError(
                "expected a state of a path of the scene on several ranks, got one of one rank: "
                "start there on one rank, or leave the scene undivided by PETSc's options"
            )
        nodes = len(model.positions())
        if len(station.positions) != nodes:
            raise ValueError(
                f"start=... must be a state of this scene with {nodes} nodes, got "
                f"{len(station.positions)}"
            )
        return station
    of_scene = undivided(equations.scene) if part is None else part
    found = own(Gathering(equations.info, of_scene), equations, kept)
    model.place(found.frames, found.multipliers[0])
    again = walker.start(station.factor, station.sign)
    return replace(again, iterations=station.iterations, test=station.test)
