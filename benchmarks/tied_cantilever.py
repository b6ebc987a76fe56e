"""Cantilever of two tied halves with different meshes against one body: sag over cells.

``tools/run python3 -m benchmarks.tied_cantilever``
"""

from __future__ import annotations

import fem_lie as fl

STEEL = fl.sections.SaintVenantKirchhoff(E=2.1e11, nu=0.3, density=7800.0)
FORCE = (0.0, 0.0, -1e5)  # N/m² on the end face


def sag(parts: list[tuple[tuple[int, int, int], float]], degree: int) -> float:
    """Sag of the upper edge of the end of a beam of 1 m, from meshes and lengths of its parts."""
    scene, before, at = fl.Scene(), None, 0.0
    for cells, length in parts:
        body = fl.Solid.brick(
            (length, 0.1, 0.1), STEEL, cells=cells, origin=(at, 0, 0), degree=degree
        )
        scene.add(body)
        if before is None:
            body.clamp("a=0")
        else:
            scene.add(fl.joints.Tie(body, "a=0", before, "a=1"))
        before, at = body, at + length
    assert before is not None
    scene.add(fl.loads.FaceLoad(before, "a=1", force=FORCE))
    return -float(fl.statics(scene).displacement(before.point("111"))[-1, 2])


def main() -> None:
    """Print sags and their differences from a fine mesh of one body."""
    exact = sag([((24, 6, 6), 1.0)], 2)
    print(f"one body, 24×6×6 quadratic cells: {1e3 * exact:.6f} mm")
    for degree, finest in ((1, 3), (2, 2)):
        for k in range(1, finest + 1):
            n = 2 ** (k - 1)
            one = sag([((8 * n, 2 * n, 2 * n), 1.0)], degree)
            tied = sag([((4 * n, 2 * n, 2 * n), 0.5), ((6 * n, 3 * n, 3 * n), 0.5)], degree)
            errors = " ".join(f"{100 * (each / exact - 1):+9.4f} %" for each in (one, tied))
            print(f"degree {degree}, {8 * n:2d}×{2 * n}×{2 * n} cells: one, tied: {errors}")


if __name__ == "__main__":
    main()
