"""Virtual work of a user on nodes of a scene, times an amplitude that may change."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.assembly import Assembly
from fem_lie.forms.term import Pairs, Term


class VirtualWork(Term):
    """Virtual work on the nodes of a body of forms, times an amplitude, with its load stiffness."""

    label, load, of_bodies, turning = "virtual work", True, True, True

    def __init__(self, work: Assembly, nodes: Indices) -> None:
        """Number the nodes.

        Args:
            work: Forces on the nodes of the body.
            nodes: Their numbers in the scene, shape (count,).
        """
        self._work, self._nodes = work, nodes
        rows, columns = work.pairs
        self._coupled: Pairs = nodes[rows], nodes[columns]

    @property
    def pairs(self) -> Pairs:
        """Pairs of nodes of a cell."""
        return self._coupled

    @property
    def contents(self) -> tuple[Any, ...]:
        """Numbers of the nodes, and what the forces depend on."""
        return self._nodes, self._work.contents

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces to ``out``."""
        forces = np.zeros((len(self._nodes), 6))
        self._work.add_forces(H[self._nodes], forces)
        out[self._nodes] += self.amplitude * forces

    def tangent(self, H: Array, kept: Array) -> Array:
        """Load stiffness, shape (pairs, 6, 6)."""
        return self.amplitude * self._work.tangent(H[self._nodes], kept)
