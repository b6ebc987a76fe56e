"""Section forces along beams without the jumps that loads and inertia make by acting on nodes."""

from __future__ import annotations

import numpy as np

from fem_lie._lines import Array, Indices
from fem_lie.beam import Beam
from fem_lie.bodies import Point
from fem_lie.joints import Sliding
from fem_lie.loads import PointLoad
from fem_lie.scene import Scene


def single_forces(scene: Scene, beam: Beam) -> Indices:
    """Nodes of a beam at which something other than loads along the line may act.

    Those of joints, springs, links, supports and point loads, and of kinks and branches; all of
    them if something slides along it.
    """
    sliding = [item for item in (*scene.joints, *scene.connections) if isinstance(item, Sliding)]
    if any(item.beam is beam for item in sliding):
        return np.arange(len(beam.frames))
    points: list[Point] = [load.point for load in scene.loads if isinstance(load, PointLoad)]
    points += [clamp.point for clamp in scene.clamps]
    points += [motion.point for motion in scene.motions]
    points += [item.b for item in sliding]
    for link in scene.links:
        points += [link.a, link.b]
    for connection in (*scene.joints, *scene.connections):
        points += [point for tie in connection.ties() for point in (tie.a, tie.b)]
        points += [point for tie in connection.velocity_ties() for point in (tie.a, tie.b)]
    nodes = [point.node for point in points if point.body is beam]
    following = np.flatnonzero(beam.leaders != np.arange(len(beam.leaders)))
    return np.unique([*nodes, *following, *beam.leaders[following]]).astype(np.int64)


def without_jumps(beam: Beam, ends: Array, single: Indices) -> Array:
    """Values at the ends of elements that go on without a jump, shape (T, m, 2, 6).

    What acts along the line is, in part, at the nodes. The jump at a node between two elements
    belongs to both by their lengths; at the other end of an element that has no such neighbour, its
    value is wrong by as much in the opposite direction. Moments of elements with a bowed axis are
    right in the mean: a load ``−ΔV/ℓ`` makes them quadratic, and adds ``ℓ ΔV/12`` at both ends.

    So values are of second order everywhere, exact for a constant load on a straight line, and as
    they were where nothing jumps.

    Args:
        beam: The beam.
        ends: Shape (T, m, 2, 6).
        single: Nodes at which values may jump.
    """
    before, behind = _neighbours(beam.elements, single)
    lengths, found = beam.lengths, ends.copy()
    share = (lengths[before] / (lengths[before] + lengths[behind]))[:, np.newaxis]
    jump = ends[:, before, 1] - ends[:, behind, 0]
    left, right = share * jump, (1.0 - share) * jump
    found[:, before, 1] -= left
    found[:, behind, 0] += right
    free_start, free_end = np.ones((2, len(lengths)), dtype=bool)
    free_start[behind] = free_end[before] = False
    at_start, at_end = free_start[before], free_end[behind]
    found[:, before[at_start], 0] += left[:, at_start]
    found[:, behind[at_end], 1] -= right[:, at_end]
    if beam.formulation.bows:
        moved = (found - ends)[..., 1:3]
        change = lengths[:, np.newaxis] * (moved[:, :, 1] - moved[:, :, 0]) / 12
        found[..., 4] += change[..., np.newaxis, 1]
        found[..., 5] -= change[..., np.newaxis, 0]
    return found


def _neighbours(elements: Indices, single: Indices) -> tuple[Indices, Indices]:
    """Pairs of elements that go on from one to the next: two at a node, head to tail."""
    count = elements.max() + 1
    meeting = np.bincount(elements[:, :2].ravel(), minlength=count) == 2
    meeting[single] = False
    after = np.full(count, -1)
    after[elements[:, 0]] = np.arange(len(elements))
    node = elements[:, 1]
    before = np.flatnonzero(meeting[node] & (after[node] >= 0))
    return before, after[node[before]]
