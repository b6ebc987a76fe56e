"""States that a path has passed: it must not come along them once more."""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array

_AGAINST = 0.9  # cosine between the twists of a step and one backwards


_KNOWN = 3  # steps in a row along known states


_NEAR = 0.05  # of the distance from where the path turned


class Passed:
    """States that a path has passed, and whether it comes along them once more.

    Beyond a limit point a path goes down, too, and where it snaps back most nodes go back; but it
    parts from the way up. A step runs back if its end lies on the chord of a step that was made
    upwards at this load factor, seen from where the path turned, and its twists are against those
    of that step.
    """

    def __init__(self, places: Array) -> None:
        """Begin with positions (n, 3) at load factor 0."""
        self._factors, self._places = [0.0], [places]
        self._twists: list[Array] = []
        self._count = 0

    def again(self, factor: float, places: Array, twist: Array) -> bool:
        """Keep the end of a step; whether it and the one before ran back."""
        factors = np.array(self._factors)
        back = factor < factors[-1] and self._against(factor, places, twist, factors)
        self._count = self._count + 1 if back else 0
        self._factors.append(factor)
        self._places.append(places)
        self._twists.append(twist)
        return self._count >= _KNOWN

    def _against(self, factor: float, places: Array, twist: Array, factors: Array) -> bool:
        """Whether a step to here goes against one that was made upwards."""
        near = _NEAR * rms(places - self._places[int(factors.argmax())])
        upwards = (factors[:-1] <= factor) & (factor < factors[1:])
        for k in np.flatnonzero(upwards):
            chord = self._places[k + 1] - self._places[k]
            part = (factor - factors[k]) / (factors[k + 1] - factors[k])
            beside = rms(self._places[k] + part * chord - places) < near
            if beside and cosine(twist, self._twists[k]) < -_AGAINST:
                return True
        return False


def cosine(a: Array, b: Array) -> float:
    """Of the angle between two vectors of any shape."""
    return float(np.sum(a * b) / sqrt(float(np.sum(a * a)) * float(np.sum(b * b))))


def rms(u: Array) -> float:
    """Root of the mean square of vectors, shape (n, 3)."""
    return float(np.sqrt(np.sum(u * u) / len(u)))
