"""Both nets of antenna_scene.py and their ties: where cables run, and their forces."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import fem_lie as fl

RADIUS, HEIGHT, DEPTH = 2.0, 0.6, 0.2
RINGS = np.array([1.0, 0.75, 0.5, 0.25])
CORD = fl.Section.circle(5e-4, fl.Material(E=1e8, nu=0.3, density=1400.0))


@dataclass
class Cables:
    """Of both nets, and their ties.

    Attributes:
        knots: Places, shape (8 bays, 3): rims first, then ring by ring, in front before behind.
        ends: Numbers of the knots at both ends of each, shape (21 bays, 2).
        forces: In each, shape (21 bays,).
    """

    knots: np.ndarray
    ends: np.ndarray
    forces: np.ndarray


def cables(bays: int, pull: float) -> Cables:
    """In equilibrium but for the rims."""
    radii = RADIUS * RINGS[:, np.newaxis]
    turn = 2.0 * np.pi * (np.arange(bays) + 0.5 * np.arange(4)[:, np.newaxis]) / bays
    height = (0.5 * HEIGHT - DEPTH * (1.0 - RINGS**2))[:, np.newaxis]
    sides = [
        np.stack([radii * np.cos(turn), radii * np.sin(turn), z + 0.0 * turn], axis=-1)
        for z in (height, -height)
    ]
    knots = np.stack(sides, axis=1)  # ring, side, bay, component
    number = np.arange(8 * bays).reshape(4, 2, bays)
    pairs: list[tuple[np.ndarray, np.ndarray]] = []
    for outer, inner in pairwise(number):
        after = np.roll(outer, -1, axis=1)
        pairs.append((np.stack([outer, after]), np.stack([inner, inner])))
        pairs.append((inner, np.roll(inner, -1, axis=1)))
        pairs.append((inner[0], inner[1]))
    kinds = [np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs]
    density = densities(knots.reshape(-1, 3), kinds, number[1:, 0, 0], pull / bays)
    ends = np.concatenate(kinds)
    lengths = np.linalg.norm(np.diff(knots.reshape(-1, 3)[ends], axis=1)[:, 0], axis=1)
    forces = lengths * np.repeat(density, [len(kind) for kind in kinds])
    return Cables(knots.reshape(-1, 3), ends, forces)


def densities(
    knots: np.ndarray, kinds: list[np.ndarray], of_rings: np.ndarray, pull: float
) -> np.ndarray:
    """Force over length of each kind: rings and ties balance one knot of each ring."""
    unit = np.zeros((3, 2, len(kinds)))  # what a density of one does there, outwards and upwards
    for kind, ends in enumerate(kinds):
        for ring, knot in enumerate(of_rings):
            x = knots[knot]
            others = np.concatenate([ends[ends[:, 0] == knot, 1], ends[ends[:, 1] == knot, 0]])
            force = (knots[others] - x).sum(axis=0)
            unit[ring, :, kind] = force[:2] @ x[:2] / np.hypot(*x[:2]), force[2]
    found = np.zeros(len(kinds))
    middle = 0.5 * RADIUS * (RINGS[1:] + RINGS[:-1])
    # two cables inwards from each knot, as long as rings are apart
    found[::3] = 0.5 * pull * 2.0 * np.pi * middle / (RADIUS * -np.diff(RINGS))
    sought = np.setdiff1d(np.arange(len(kinds)), np.arange(0, len(kinds), 3))
    rows = unit.reshape(6, -1)
    found[sought] = np.linalg.solve(rows[:, sought], -rows @ found)
    return found


def nets(laid: Cables, cells: int, slack: float) -> fl.Net:
    """All cables, of so many elements each; the first nodes are the knots.

    Raises:
        ValueError: Some would be slack.
    """
    strains = laid.forces / CORD.stiffness[0, 0]
    if not strains.min() > 1.5 * slack:
        raise ValueError(
            f"some cable is stretched by {strains.min():.2g} and would be slack: "
            f"give more bays, or a slack below {slack:g}"
        )
    inner = np.linspace(0.0, 1.0, cells + 1)[1:-1, np.newaxis]
    first, last = laid.knots[laid.ends.T]
    within = first[:, np.newaxis] + inner * (last - first)[:, np.newaxis]
    numbers = len(laid.knots) + np.arange(within[..., 0].size).reshape(len(within), -1)
    lines = np.concatenate([laid.ends[:, :1], numbers, laid.ends[:, 1:]], axis=1)
    positions = np.concatenate([laid.knots, within.reshape(-1, 3)])
    element = fl.elements.DiscreteCable(slack=slack)
    return fl.Net(
        positions, lines.tolist(), CORD, stretch=1.0 + strains, formulation=element, name="net"
    )
