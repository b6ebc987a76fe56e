"""When something in a scene jumps, as far as it says so."""

from __future__ import annotations

from fem_lie.joints.histories import declared
from fem_lie.scene import Scene
from fem_lie.solve.motion.step_control import SAME


def events(scene: Scene, duration: float) -> tuple[float, ...]:
    """Times within a run at which loads, drives or motions of a scene say that they jump."""
    moves: list[object] = [item.history for item in (*scene.joints, *scene.connections)]
    moves += [motion.motion for motion in scene.motions]
    times = declared((load.history for load in scene.loads), kinks=False)
    times += declared(moves, kinks=True)
    slack = SAME * duration
    return tuple(t for t in sorted(set(times)) if slack < t < duration - slack)
