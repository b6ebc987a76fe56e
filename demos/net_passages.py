"""Whether threads of net_capture.py went through each other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from net_contacts import THREAD
from scipy.spatial import cKDTree

import fem_lie as fl

CHORDS = 4
"""Number of chords of each element."""


def chords(result: fl.Result, bodies: list[fl.Net]) -> tuple[np.ndarray, np.ndarray]:
    """Ends of chords of all threads in each state, (states, 2, m, 3), and nodes of their cells."""
    s = np.linspace(0.0, 1.0, CHORDS + 1)
    r = 1.0 - s
    by = np.stack([(1 + 2 * s) * r * r, s * s * (3 - 2 * s), s * r * r, -s * s * r])
    ends, nodes = [], []
    for body in bodies:
        own = result.info.body(body.label).nodes
        for piece in fl.contact.Line(body, THREAD).pieces():
            at = own[[node for _, node in piece.owners]]
            path = np.einsum("ak,ks,naj->nsj", piece.weights, by, result.frames[:, at, 0])
            ends.append(np.stack([path[:, :-1], path[:, 1:]], axis=1))
            cell = own[[owner[1] for owner in piece.ends if owner is not None]]
            nodes += CHORDS * [cell]
    return np.concatenate(ends, axis=2), np.array(nodes)


def passages(result: fl.Result, bodies: list[fl.Net]) -> int:
    """How often chords of threads that share no node went through each other between states.

    Four points on straight paths are in a plane when the volume between them, a cubic in time, has
    a zero. Chords went through each other if they cross then.
    """
    ends, nodes = chords(result, bodies)
    moved = np.linalg.norm(np.diff(ends, axis=0), axis=3).max()
    reach = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=2).max() + 2.0 * moved
    turned = []
    for before, after in pairwise(ends):
        i, j = cKDTree(before.mean(axis=0)).query_pairs(reach, output_type="ndarray").T
        apart = (nodes[i][:, :, np.newaxis] != nodes[j][:, np.newaxis]).all(axis=(1, 2))
        pair = np.stack([i[apart], j[apart]])
        steps = before[:, pair], after[:, pair]
        first, last = (volume(*steps, np.full(len(pair[0]), t))[0] for t in (0.0, 1.0))
        turned.append([step[:, :, first * last < 0.0] for step in steps])
    before, after = (np.concatenate(each, axis=2) for each in zip(*turned, strict=True))
    low, high = np.zeros(before.shape[2]), np.ones(before.shape[2])
    first = volume(before, after, low)[0]
    for _ in range(50):
        middle = 0.5 * (low + high)
        same = volume(before, after, middle)[0] * first > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return int(volume(before, after, high)[1].sum())


def volume(before: np.ndarray, after: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Volume between two chords at fractions of a step, and whether they cross, seen across both.

    ``before`` and ``after`` have the ends of both chords of each pair, shape (2, 2, m, 3).
    """
    at = (1.0 - t)[:, np.newaxis] * before + t[:, np.newaxis] * after
    (a, b), d = at[1] - at[0], at[0, 1] - at[0, 0]
    n = np.cross(a, b)
    size = np.maximum((n * n).sum(axis=1), 1e-300)
    s, r = (np.einsum("ej,ej->e", np.cross(d, each), n) / size for each in (b, a))
    return (n * d).sum(axis=1), (s > 0.0) & (s < 1.0) & (r > 0.0) & (r < 1.0)
