"""A row of dominoes as a mechanism of one degree of freedom between collisions.

Each turns about its lower front edge. Its upper front edge leans on the back of the next one, which
has tilted by φ where it has tilted by θ::

    h sin(θ − φ) = (s + d) cos φ − d

(J. M. J. van Leeuwen, Am. J. Phys. 78 (2010) 721), without friction. All that lean on each other
move with the tilt of the foremost. Where that meets the next one, which stands, nothing bounces:
the momentum along the new motion is that of before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Row(NamedTuple):
    """Equal dominoes.

    Attributes:
        height: h.
        thickness: d.
        spacing: s, from the front of one to the back of the next.
        gravity: g.
    """

    height: float
    thickness: float
    spacing: float
    gravity: float

    @property
    def inertia(self) -> float:
        """About the lower front edge, for a mass of one."""
        return (self.height**2 + self.thickness**2) / 3

    def behind(self, tilt: float) -> tuple[float, float]:
        """Tilt of the domino that leans on one with this tilt, and its derivative."""
        h, d, p = self.height, self.thickness, self.spacing + self.thickness
        lean = (p * np.cos(tilt) - d) / h
        return tilt + np.arcsin(lean), 1.0 - p * np.sin(tilt) / h / np.sqrt(1.0 - lean**2)

    def chain(self, tilt: float, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Tilts of so many dominoes, the foremost first, and their derivatives in its tilt."""
        tilts, slopes = [tilt], [1.0]
        for _ in range(count - 1):
            behind, slope = self.behind(tilts[-1])
            tilts.append(behind)
            slopes.append(slopes[-1] * slope)
        return np.array(tilts), np.array(slopes)

    def energy(self, tilt: float, rate: float, count: int) -> float:
        """Of so many dominoes with these tilt and rate of the foremost."""
        tilts, slopes = self.chain(tilt, count)
        heights = 0.5 * (self.height * np.cos(tilts) + self.thickness * np.sin(tilts))
        kinetic = 0.5 * self.inertia * (slopes @ slopes) * rate**2
        return float(kinetic + self.gravity * heights.sum())

    def times(self, rate: float, count: int) -> np.ndarray:
        """When each but the first is hit, if the first one is pushed from upright with a rate."""
        hits = np.arcsin(self.spacing / self.height)
        found, time = [], 0.0
        for moving in range(1, count):
            total = self.energy(0.0, rate, moving)

            def speed(tilt: float, moving: int = moving, total: float = total) -> float:
                _, slopes = self.chain(tilt, moving)
                left = total - self.energy(tilt, 0.0, moving)
                return float(np.sqrt(2 * left / (self.inertia * (slopes @ slopes))))

            way = solve_ivp(
                lambda tilt, _: [1.0 / speed(tilt)], (0.0, hits), [0.0], rtol=1e-10, atol=1e-12
            )
            time += float(way.y[0, -1])
            found.append(time)
            _, before = self.chain(hits, moving)
            _, after = self.chain(0.0, moving + 1)
            rate = speed(hits) * float(before @ after[1:] / (after @ after))
        return np.array(found)
