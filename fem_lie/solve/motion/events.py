"""When something in a scene jumps, as far as it says so."""

from __future__ import annotations

from fem_lie.joints.histories import declared
from fem_lie.scene import Scene
from fem_lie.solve.motion.step_control import SAME


def events(scene: Scene, duration: float) -> tuple[float, ...]:
    """When loads, drives or motions say that they jump in a run, from its beginning on."""
    moves: list[object] = [item.history for item in (*scene.joints, *scene.connections)]
    moves += [motion.motion for motion in scene.motions]
    times = declared((load.history for load in scene.loads), kinks=False)
    times += declared(moves, kinks=True)
    slack, began = SAME * duration, scene.began.time
    return tuple(t - began for t in sorted(set(times)) if slack < t - began < duration - slack)
