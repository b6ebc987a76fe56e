"""Splines refined at large rotation: the pinched hemisphere, cells cut by the estimate and equal.

``tools/run python3 -m benchmarks.spline_hemisphere [--thickness 0.04] [--most 3500]``

That of ``demos/hemisphere.py``, from 4×4 cells, whose surface is kept: the estimated error in the
energy norm under the whole load, and those of both deflections against the references.
"""

from __future__ import annotations

import argparse

import fem_lie as fl
from demos import hemisphere


def main() -> None:
    """A table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--thickness", type=float, choices=sorted(hemisphere.CASES), default=0.04)
    parser.add_argument("--most", type=int, default=3500)
    given = parser.parse_args()
    _, outward, inward = hemisphere.CASES[given.thickness]
    print("| | cells | unknowns | estimated error | deflections outward, inward |")
    for way, part in (("equal cells", 1.0), ("cut by the estimate", 0.5)):
        mesh = fl.mesh.spline_mesh(fl.mesh.smooth_patch(hemisphere.position, (4, 4)))
        while True:
            scene = hemisphere.pinched(given.thickness, mesh)
            unknowns = 6 * len(scene.bodies[0].frames)
            if unknowns > given.most:
                break
            result = fl.follow_loads(scene)
            found = fl.adaptivity.space_error(result, scene.bodies[0], scene)
            a = float(result.position("hemisphere.00")[-1, 0] - hemisphere.RADIUS)
            b = float(hemisphere.RADIUS - result.position("hemisphere.10")[-1, 1])
            print(
                f"| {way} | {len(mesh.cells)} | {unknowns} | {100 * found.relative:.2g} % | "
                f"{100 * (a / outward - 1):.2f}, {100 * (b / inward - 1):.2f} % |",
                flush=True,
            )
            mesh = fl.adaptivity.refine(mesh, found.worst(part))


if __name__ == "__main__":
    main()
