"""What the solution on subdomains took."""

from __future__ import annotations

from typing import NamedTuple


class Subdomains(NamedTuple):
    """Of a run or a search for equilibrium, one subdomain on each rank.

    Attributes:
        number: Of subdomains.
        interface: Unknowns that several of them have.
        made: How often matrix and preconditioner were made, also for a new border alone.
        solutions: Systems of equations solved.
        iterations: Of the Krylov method in all of these.
    """

    number: int
    interface: int
    made: int
    solutions: int
    iterations: int

    @property
    def per_solution(self) -> float:
        """Iterations of a solution, in the mean."""
        return self.iterations / max(self.solutions, 1)
