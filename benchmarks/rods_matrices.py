"""How often lines and nets need a new matrix: fixed axes against axes that turn with the nodes.

Each scene is run by generalised-alpha with the policy ``Automatic``, the same step and tolerance:

- fixed: equations in axes fixed in space, ``MatrixFrame.INERTIAL``
- own: in the nodes' axes, which go along with tangents by the smallest rotation; those of positions
  stay as they are, and rods have those of their frames and edges
- following, of what has no frames: in axes from which the mean rotation of the body has been taken
  out, ``convect_axes()``

Besides matrices and iterations it prints the largest distance of any node at any time from the
first of the runs, over the size of the body: they have the same error.

    python benchmarks/rods_matrices.py [--steps 10000] [--scene NAME]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np

import fem_lie as fl

CableBody = fl.Cable | fl.Net | fl.Rod


def section(EI: float) -> fl.Section:
    return fl.Section.from_stiffness([1e4] * 3 + [EI] * 3, mass=1.0)


def swinging(EI: float) -> tuple[fl.Scene, CableBody, float]:
    """Dropped from the horizontal, a little bent."""
    cable = fl.Cable.curve(lambda s: (s, 0, 1e-2 * s * s), section(EI), cells=20)
    cable.pin(cable.point("start"))
    return falling(cable), cable, 1e-3


def whirling() -> tuple[fl.Scene, CableBody, float]:
    """A rope between two hands, 10 rad/s."""
    cable = fl.Cable.curve(lambda s: (s, 2 * s * (1 - s), 0), section(1e-1), cells=20)
    cable.pin(cable.point("start"), cable.point("end"))
    cable.add_velocity(omega=(10.0, 0, 0), about=(0.0, 0, 0))
    return falling(cable), cable, 1e-3


def tumbling() -> tuple[fl.Scene, CableBody, float]:
    """A free bent rod."""
    cable = fl.Cable.curve(lambda s: (s, 0.5 * s * s, 0.2 * s**3), section(1.0), cells=20)
    cable.add_velocity(omega=(3.0, 4.0, 2.0), about=cable.point(10))
    scene = fl.Scene()
    scene.add(cable)
    return scene, cable, 1e-3


def rod(
    held: bool, formulation: fl.elements.BeamFormulation | None
) -> tuple[fl.Scene, fl.Rod, float]:
    """With EI = GJ = 1: dropped from the horizontal, a little bent, or free, bent and turning.

    Without a formulation it is laid along a spline, whose parameter is not arc length.
    """
    own = fl.Section.from_stiffness([1e4] * 3 + [1.0] * 3, mass=1.0, polar=1e-3)
    bow = (1e-2, 0.0) if held else (0.5, 0.2)
    if formulation is None:
        u = np.linspace(0, 1, 21)
        s, rate = 0.6 * u + 0.4 * u * u, 0.6 + 0.8 * u
        positions = np.stack([s, bow[1] * s**3, bow[0] * s * s], axis=1)
        slopes = np.stack([rate, 3 * bow[1] * s * s * rate, 2 * bow[0] * s * rate], axis=1)
        body = fl.Rod(fl.mesh.Spline.checked(u, positions, slopes).mesh(), own)
    else:
        body = fl.Rod.curve(
            lambda s: (s, bow[1] * s**3, bow[0] * s * s), own, cells=20, formulation=formulation
        )
    if held:
        scene = falling(body)
        scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
        return scene, body, 1e-3
    body.add_velocity(omega=(3.0, 4.0, 2.0), about=body.point(10))
    scene = fl.Scene()
    scene.add(body)
    return scene, body, 1e-3


def net(held: bool) -> tuple[fl.Scene, CableBody, float]:
    """Of 8 by 8 meshes: hung by two corners from the horizontal, or free and turning."""
    n = 9
    s = np.linspace(0, 1, n)
    x, y = np.meshgrid(s, s, indexing="ij")
    number = np.arange(n * n).reshape(n, n)
    points = np.column_stack([x.ravel(), y.ravel(), 0.1 * x.ravel() * y.ravel()])
    body = fl.Net(points, [*number.tolist(), *number.T.tolist()], section(1e-2))
    if held:
        body.pin(body.point(0), body.point(n - 1))
        return falling(body), body, 1e-3
    body.add_velocity(omega=(3.0, 1.0, 2.0), about=body.point(n * n // 2))
    return falling(body), body, 1e-3


def falling(body: CableBody) -> fl.Scene:
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    return scene


SCENES: dict[str, Callable[[], tuple[fl.Scene, CableBody, float]]] = {
    "swinging, EI = 1": lambda: swinging(1.0),
    "swinging, EI = 0.01": lambda: swinging(1e-2),
    "whirling": whirling,
    "tumbling": tumbling,
    "rod, swinging": lambda: rod(True, fl.elements.KirchhoffRod()),
    "rod, tumbling": lambda: rod(False, fl.elements.KirchhoffRod()),
    "spline rod, swinging": lambda: rod(True, None),
    "spline rod, tumbling": lambda: rod(False, None),
    "edges, swinging": lambda: rod(True, fl.elements.DiscreteRod()),
    "edges, tumbling": lambda: rod(False, fl.elements.DiscreteRod()),
    "net, thrown": lambda: net(False),
    "net, hung": lambda: net(True),
}


def run(name: str, axes: str, steps: int) -> fl.Result:
    scene, body, step = SCENES[name]()
    if axes == "following":
        assert not isinstance(body, fl.Rod)
        body.convect_axes()
    components = (
        fl.schemes.MatrixFrame.INERTIAL if axes == "fixed" else fl.schemes.MatrixFrame.LOCAL
    )
    scheme = fl.GeneralisedAlpha(radius=0.8, matrix_frame=components)
    return scheme.run(scene, duration=steps * step, step=step)


def conserved(steps: int) -> None:
    """The rod along a spline that tumbles, by energy-momentum."""
    scene, _, step = rod(False, None)
    result = fl.EnergyMomentum().run(scene, duration=steps * step, step=step)
    kept = result.total_energy, result.angular_momentum
    errors = [np.abs(values - values[0]).max() / np.abs(values[0]).max() for values in kept]
    print("energy, angular momentum: {:.1e} {:.1e}".format(*errors), end=", ")
    print(f"{result.k_updates} matrices, {int(result.iterations[-1]) / steps:.1f} iterations")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--scene", choices=[*SCENES, "all"], default="all")
    parser.add_argument("--conserving", type=int, default=0)
    options = parser.parse_args()
    if options.conserving:
        return conserved(options.conserving)
    names = list(SCENES) if options.scene == "all" else [options.scene]
    print("scene                axes       matrices  iterations per step  distance", flush=True)
    for name in names:
        first = None
        for axes in ("fixed", "own", "following"):
            if axes == "following" and name.startswith(("rod", "spline rod", "edges")):
                continue
            try:
                result = run(name, axes, options.steps)
            except fl.ConvergenceError as error:
                print(f"{name:20} {axes:10} {error}"[:150], flush=True)
                continue
            first = result.frames[:, :, 0] if first is None else first
            gap = np.abs(result.frames[:, :, 0] - first).max()
            per_step = int(result.iterations[-1]) / options.steps
            print(
                f"{name:20} {axes:10} {result.k_updates:8} {per_step:20.1f}  {gap:8.1e}", flush=True
            )


if __name__ == "__main__":
    main()
