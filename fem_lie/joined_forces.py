"""Section forces along beams without the jumps that loads and inertia make by acting on nodes."""

from __future__ import annotations

import numpy as np

from fem_lie._jit import Array, Indices
from fem_lie.beam import Beam
from fem_lie.bodies import Point
from fem_lie.loads import PointLoad
from fem_lie.scene import Scene


def single_forces(scene: Scene, beam: Beam) -> Indices:
    """Nodes of a beam at which something other than loads along the line may act.

    Those of joints, springs, links, supports and point loads, and of kinks and branches.
    """
    points: list[Point] = [load.point for load in scene.loads if isinstance(load, PointLoad)]
    points += [clamp.point for clamp in scene.clamps]
    points += [motion.point for motion in scene.motions]
    for link in scene.links:
        points += [link.a, link.b]
    for connection in (*scene.joints, *scene.connections):
        points += [point for tie in connection.ties() for point in (tie.a, tie.b)]
        points += [point for tie in connection.velocity_ties() for point in (tie.a, tie.b)]
    nodes = [point.node for point in points if point.body is beam]
    following = np.flatnonzero(beam.leaders != np.arange(len(beam.leaders)))
    return np.unique([*nodes, *following, *beam.leaders[following]]).astype(np.int64)


def without_jumps(elements: Indices, lengths: Array, ends: Array, single: Indices) -> Array:
    """Values at the ends of elements that go on without a jump, shape (T, m, 2, 6).

    What acts along the line is, in part, at the nodes. The jump at a node between two elements
    belongs to both by their lengths. At the other end of an element that has no such neighbour, its
    value is wrong by as much in the opposite direction. So values are of second order everywhere,
    and change nothing where nothing jumps.

    Args:
        elements: Nodes of each element, shape (m, k).
        lengths: Of the elements, shape (m,).
        ends: Shape (T, m, 2, 6).
        single: Nodes at which values may jump.
    """
    count = elements.max() + 1
    meeting = np.bincount(elements[:, :2].ravel(), minlength=count) == 2
    meeting[single] = False
    after = np.full(count, -1)
    after[elements[:, 0]] = np.arange(len(elements))
    # two elements that share a frame meet head to tail
    before = np.flatnonzero(meeting[elements[:, 1]] & (after[elements[:, 1]] >= 0))
    behind = after[elements[before, 1]]
    share = (lengths[before] / (lengths[before] + lengths[behind]))[:, np.newaxis]
    jump = ends[:, before, 1] - ends[:, behind, 0]
    found = ends.copy()
    found[:, before, 1] -= share * jump
    found[:, behind, 0] += (1.0 - share) * jump
    free_start, free_end = np.ones((2, len(elements)), dtype=bool)
    free_start[behind] = free_end[before] = False
    at_start, at_end = free_start[before], free_end[behind]
    found[:, before[at_start], 0] += (share * jump)[:, at_start]
    found[:, behind[at_end], 1] -= ((1.0 - share) * jump)[:, at_end]
    return found
