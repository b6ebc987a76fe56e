"""How even the force is as a bent plate is moved far across the cells of a flat one.

    python -m benchmarks.sliding_plate [--mesh 10 20 40 80] [--over 5]

A plate that is bent to an arc of radius 1 m lies upside down on a flat one, both 0.02 m thick, with
an overlap of a hundredth of that, and is moved over some cells of it, aslant to their edges. Points
are on the bent plate, or on the flat one. The force, over its mean, should not change. Its
part along the plate, which has no friction, should be none.
"""

from __future__ import annotations

import argparse

import numpy as np

import fem_lie as fl

THICK, OVERLAP, RADIUS, ARC = 0.02, 0.01, 1.0, 0.4
LAYER = fl.ShellSection.layer(THICK, fl.Material(1e9, 0.3, 1000.0))


def flat(mesh: int) -> fl.Shell:
    """Two metres long, with cells across the direction of motion that are as wide as long."""
    surface = fl.mesh.parametric_surface(
        lambda a, b: np.array([2 * a - 1, 0.4 * b, 0.0]), (2 * mesh, 4)
    )
    return fl.Shell(surface, LAYER)


def arc(mesh: int, x: float, cell: str) -> fl.Shell:
    """Bent about an axis along the flat plate's edges, shifted to ``x``."""
    middle = THICK * (1 - OVERLAP) + RADIUS

    def position(a: float, b: float) -> np.ndarray:
        φ = ARC * (a - 0.5)
        return np.array([x + RADIUS * np.sin(φ), 0.1 + 0.2 * b, middle - RADIUS * np.cos(φ)])

    return fl.Shell(fl.mesh.parametric_surface(position, (mesh, 2), cell=cell), LAYER)


def force(contact: fl.contact.Contact) -> np.ndarray:
    """On the first plate in the beginning."""
    bodies = contact.bodies
    first = np.cumsum([0, *(len(body.frames) for body in bodies)])
    numbers = {b: np.arange(len(b.frames)) + k for b, k in zip(bodies, first, strict=False)}
    H = np.concatenate([body.frames for body in bodies])
    _, _, _, found = contact.term(numbers.__getitem__).touching(H, np.zeros((len(H), 6)))
    return found.sum(axis=0)


def slide(mesh: int, over: int, cell: str, points_on_arc: bool, gauss: int) -> tuple[float, float]:
    """Largest change of the force, and of its part along, over the mean force."""
    found, lower = [], flat(mesh)
    for x in np.linspace(0.0, over / mesh, 12 * over + 1):
        upper = fl.contact.ShellSurface(arc(mesh, x, cell), gauss=gauss)
        sides = (
            (upper, fl.contact.ShellSurface(lower))
            if points_on_arc
            else (fl.contact.ShellSurface(lower, gauss=gauss), upper)
        )
        found.append(force(fl.contact.Contact(*sides, fl.contact.Penalty(1e9))))
    forces = np.array(found)
    mean = np.abs(forces[:, 2]).mean()
    return float(np.ptp(forces[:, 2]) / mean), float(np.abs(forces[:, 0]).max() / mean)


def main() -> None:
    """A row for each mesh."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", nargs="+", type=int, default=[10, 20, 40, 80])
    parser.add_argument("--over", type=int, default=5, help="cells")
    given = parser.parse_args()
    for cell in ("quadrilateral", "triangle"):
        for on_arc in (True, False):
            for gauss in (2, 4):
                where = "bent" if on_arc else "flat"
                for mesh in given.mesh:
                    size, along = slide(mesh, given.over, cell, on_arc, gauss)
                    print(
                        f"{cell:13s} {gauss} points, on the {where} plate, {mesh:3d} cells per "
                        f"metre: force changes by {size:.1e}, along {along:.1e}",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
