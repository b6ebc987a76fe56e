"""Who is near whom among many segments, and where they overlap: seconds per segment and per pair.

Fibres of 50 segments with a random direction each, as many as there are, in a box in which each
segment has about one other near it. A new list is that of all cells; the narrow phase looks for the
parts that overlap, as it does in each step.
"""

from __future__ import annotations

from time import process_time

import numpy as np

import fem_lie as fl
from fem_lie.contact.sides.detection import near
from fem_lie.contact.sides.surfaces import Piece
from fem_lie.contact.sides.two_sides import Lines

SEGMENTS, RADIUS, LENGTH = 50, 0.1, 1.0
LEAST = 1000
"""Pairs by which one of them can be timed."""


def fibres(count: int, seed: int) -> np.ndarray:
    """Ends of segments, shape (count, 2, 3)."""
    rng = np.random.default_rng(seed)
    lines = count // SEGMENTS
    along = rng.normal(size=(lines, 1, 3))
    along *= LENGTH / np.linalg.norm(along, axis=2, keepdims=True)
    side = (2.2 * count) ** (1 / 3)
    start = rng.uniform(0, side, size=(lines, 1, 3))
    positions = start + along * np.arange(SEGMENTS + 1)[:, np.newaxis]
    return np.stack([positions[:, :-1], positions[:, 1:]], axis=2).reshape(-1, 2, 3)


def pieces(ends: np.ndarray, body: fl.RigidBody) -> list[Piece]:
    """Fixed to a body at the origin."""
    owners = (body, 0), (body, 0)
    along = [np.tile(b - a, (2, 1)) for a, b in ends]
    return [
        Piece(owners, each, tangents, LENGTH, LENGTH, RADIUS, (k + 1) % SEGMENTS != 0)
        for k, (each, tangents) in enumerate(zip(ends, along, strict=True))
    ]


def best(work, times: int = 3) -> float:
    """Seconds of the processor, the least of some."""
    found = []
    for _ in range(times):
        before = process_time()
        work()
        found.append(process_time() - before)
    return min(found)


def main() -> None:
    """Print a table."""
    print("segments   new list µs/segment   pairs per segment   narrow phase ns/pair   same order")
    for count in (1000, 10_000, 100_000, 1_000_000):
        ends = fibres(count, 0)
        middles, reach = ends.mean(axis=1), np.full(count, 0.5 * LENGTH + 1.5 * RADIUS)
        pairs = near(middles, reach)
        seconds = best(lambda X=middles, r=reach: near(X, r))
        order = np.random.default_rng(1).permutation(count)
        again = np.sort(order[near(middles[order], reach)], axis=1)
        same = np.array_equal(again[np.lexsort(again.T[::-1])], pairs)
        text = f"{count:8d} {1e6 * seconds / count:14.2f} {len(pairs) / count:18.2f}"
        print(f"{text} {narrow(ends):22} {same!s:>12}")


def narrow(ends: np.ndarray) -> str:
    """Nanoseconds per pair, of half of the fibres against the others."""
    half, bodies = len(ends) // 2, [fl.RigidBody(1.0, np.eye(3), (0, 0, 0)) for _ in range(2)]
    one, other = pieces(ends[:half], bodies[0]), pieces(ends[half:], bodies[1])
    sides = Lines(one, other, None, lambda body: np.array([bodies.index(body)]))
    H = np.concatenate([body.frames for body in bodies])
    sides.meet(H)
    if len(sides.near.now) < LEAST:
        return "-"
    seconds = best(lambda: sides.meet(H))
    return f"{1e9 * seconds / len(sides.near.now):.0f} ({len(sides.near.now)} pairs)"


if __name__ == "__main__":
    main()
