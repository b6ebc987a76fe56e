"""How even the force is as a beam slides across 40 elements of another, at angles of 0.1° to 90°.

    python -m benchmarks.sliding_lines

Both are straight, the second is moved without changing its overlap; 321 positions for each angle.
"""

from __future__ import annotations

import numpy as np

import fem_lie as fl

RADIUS, CELL, ELEMENTS, DEEP = 0.01, 0.1, 40, 0.05
ANGLES = 0.1, 1, 5, 10, 20, 45, 90
SECTION = fl.Section.circle(RADIUS, fl.Material(1e9, 0.3, 1000.0))


def force(angle: float, x: float) -> np.ndarray:
    """On the first beam, with the second one crossing it at a position."""
    half = 0.5 * ELEMENTS * CELL + 4.0  # at the smallest angle they touch along 3.6 m to each side
    cells = round(2 * half / CELL)
    one = fl.Beam.straight((-half, 0, 0), (half, 0, 0), SECTION, cells=cells)
    middle = np.array([x, 0, 2 * RADIUS * (1 - DEEP)])
    along = 4.0 * np.array([np.cos(angle), np.sin(angle), 0.0])
    other = fl.Beam.straight(middle - along, middle + along, SECTION, cells=61)
    contact = fl.contact.Contact(
        fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS), fl.contact.Penalty(1e6)
    )
    H = np.concatenate([one.frames, other.frames])
    numbers = {one: np.arange(cells + 1), other: np.arange(62) + cells + 1}
    term = contact.term(numbers.__getitem__)
    return term.touching(H, np.zeros((len(H), 6)))[3].sum(axis=0)


def main() -> dict[float, float]:
    """Largest change of the force over its mean, for each angle in degrees."""
    positions = np.linspace(-0.5, 0.5, 321) * ELEMENTS * CELL
    found = {}
    for degrees in ANGLES:
        sizes = np.array([-force(np.radians(degrees), x)[2] for x in positions])
        found[degrees] = float(np.ptp(sizes) / sizes.mean())
        print(f"{degrees:5} degrees: {sizes.mean():10.4f} N, changes by {found[degrees]:.1e}")
    return found


if __name__ == "__main__":
    main()
