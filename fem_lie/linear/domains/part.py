"""A rank's part of the matrix of a scene: what its own cells and constraints make of it."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.ranks.subdomains import Subdomains


class Part:
    """Which unknowns a domain has, and the values of its matrix.

    Attributes:
        inside: Unknowns that no other domain has, multipliers included.
        interface: The others.
        interfaces: Those of all domains, ``size`` in number.
        at: Place of this domain's among these.
        held: Unknowns of the scene that are no unknowns.
        values: In the pattern of the whole matrix; of unknowns of others they mean nothing.
        motions: Rigid ones, each of all interfaces' unknowns.
        made: How often it was factorised; ``solutions`` with it took ``iterations``.
    """

    def __init__(self, own: Flags, shared: Flags, multipliers: Flags, held: Flags) -> None:
        """Find the numbers.

        Args:
            own: Which nodes the domain has, shape (n,).
            shared: Which nodes several domains have.
            multipliers: Which are the domain's, shape (m,).
            held: Which unknowns of nodes are none, shape (n, 6).
        """
        free = ~held
        inside = (own & ~shared)[:, np.newaxis] & free
        of_nodes, of_constraints = inside.ravel(), multipliers
        self.inside: Indices = np.flatnonzero(np.append(of_nodes, of_constraints))
        self.interface: Indices = np.flatnonzero((own & shared)[:, np.newaxis] & free)
        self.interfaces: Indices = np.flatnonzero(shared[:, np.newaxis] & free)
        self.size = len(self.interfaces)
        self.at: Indices = np.searchsorted(self.interfaces, self.interface)
        self.held: Indices = np.flatnonzero(held)
        self.values: Array = np.empty(0)
        self.motions: Sequence[Array] = ()
        self.made = self.solutions = self.iterations = 0

    @property
    def told(self) -> Subdomains:
        """For results."""
        counts = self.made, self.solutions, self.iterations
        return Subdomains(MPI.COMM_WORLD.size, self.size, *counts)
