"""Plates of positions and all three slopes: cost, matrices in own and in fixed axes, conservation.

``python -m benchmarks.ancf_shell``: what the residual and the matrix of a cell cost, beside those
of a thin shell; matrices that ``Automatic`` makes of a sheet that swings from an edge and of one
that tumbles freely, by generalised-alpha in own axes and in fixed ones, of plates and of thin
shells with or without couplings. ``--modulus E``: a stiffer sheet, which bends and does not whip.
``--conserving N``: N steps of energy-momentum of the second.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time

import numpy as np

import fem_lie as fl

CELLS, TURNS = 4, 5
MODULUS = 1e6
Made = Callable[[float], fl.AncfShell | fl.ThinShell]


def layer(modulus: float) -> fl.ShellSection:
    return fl.ShellSection.layer(0.02, fl.Material(modulus, 0.3, 100.0))


def bent(a: float, b: float) -> np.ndarray:
    """A sheet, a little curved."""
    return np.array([a, b, 0.1 * np.cos(2 * a) + 0.05 * b * b])


def plate(modulus: float = MODULUS, cells: int = CELLS) -> fl.AncfShell:
    return fl.AncfShell(fl.mesh.smooth_patch(bent, (cells, cells)), layer(modulus))


def thin(modulus: float = MODULUS, cells: int = CELLS) -> fl.ThinShell:
    return fl.ThinShell(fl.mesh.smooth_patch(bent, (cells, cells)), layer(modulus))


def sewn(modulus: float = MODULUS) -> fl.ThinShell:
    """Of two patches with other parameters along their coupling."""
    patches = {
        "left": fl.mesh.smooth_patch(lambda a, b: bent(0.5 * a, b), (2, 4)),
        "right": fl.mesh.smooth_patch(
            lambda a, b: bent(0.5 + 0.5 * a, 0.7 * b + 0.3 * b * b), (2, 4)
        ),
    }
    return fl.ThinShell(
        patches, layer(modulus), couplings=[fl.mesh.PatchCoupling("left.a=1", "right.a=0")]
    )


def swinging(make: Made, modulus: float) -> fl.Scene:
    """Hinged along one edge, or that of its first patch, and let go."""
    shell, scene = make(modulus), fl.Scene(gravity=(0, 0, -9.81))
    scene.add(shell)
    shell.hinge("left.a=0" if make is sewn else "a=0")
    return scene


def tumbling(make: Made, modulus: float) -> fl.Scene:
    """Free, turning about an axis that is none of its own."""
    shell, scene = make(modulus), fl.Scene()
    scene.add(shell)
    shell.add_velocity((0.2, 0.1, 0.0), omega=(3.0, 4.0, 2.0), about=(0, 0, 0))
    return scene


def seconds(call: Callable[[], object]) -> float:
    """Least of several calls, by the processor."""
    call()
    found = []
    for _ in range(TURNS):
        start = process_time()
        call()
        found.append(process_time() - start)
    return min(found)


def cost(name: str, shell: fl.AncfShell | fl.ThinShell) -> None:
    """Of 40 × 40 cells."""
    assembly = shell.model.assemble([shell.model])
    H, out = shell.frames.copy(), np.zeros(6 * len(shell.frames))
    assembly.reset_stress(H)
    calls = {
        "forces": lambda: assembly.add_forces(H, out),
        "matrix": lambda: assembly.tangent(H, H),
    }
    for what, call in calls.items():
        print(f"{name}: {what} {1e6 * seconds(call) / 1600:.2f} µs per cell", flush=True)


def conserved(steps: int) -> None:
    result = fl.EnergyMomentum().run(tumbling(plate, MODULUS), duration=1e-3 * steps, step=1e-3)
    kept = result.total_energy, result.angular_momentum, result.momentum
    errors = [np.abs(values - values[0]).max() / np.abs(values[0]).max() for values in kept]
    print("energy, angular momentum, momentum: {:.1e} {:.1e} {:.1e}".format(*errors), end=", ")
    print(f"{result.k_updates} matrices, {int(result.iterations[-1]) / steps:.1f} iterations")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--modulus", type=float, default=MODULUS)
    parser.add_argument("--conserving", type=int, default=0)
    options = parser.parse_args()
    if options.conserving:
        return conserved(options.conserving)
    cost("plate", plate(cells=40))
    cost("thin shell", thin(cells=40))
    print("scene     body, axes             matrices  iterations per step  distance", flush=True)
    kinds: dict[str, Made] = {"plate": plate, "thin": thin, "sewn": sewn}
    for scene_name, scene_of in (("swinging", swinging), ("tumbling", tumbling)):
        for name, make in kinds.items():
            first = None
            for axes in (fl.schemes.MatrixFrame.INERTIAL, fl.schemes.MatrixFrame.LOCAL):
                scheme = fl.GeneralisedAlpha(radius=0.8, matrix_frame=axes)
                scene = scene_of(make, options.modulus)
                try:
                    result = scheme.run(scene, duration=1e-3 * options.steps, step=1e-3)
                except fl.ConvergenceError as error:
                    print(f"{scene_name:9} {name}, {axes.name}: {error}", flush=True)
                    continue
                positions = result.frames[:, :, 0]
                first = positions if first is None else first
                gap = np.abs(positions - first).max()
                mean = int(result.iterations[-1]) / options.steps
                label = f"{name}, {axes.name.lower()}"
                print(f"{scene_name:9} {label:22} {result.k_updates:7} {mean:20.1f}  {gap:8.1e}")


if __name__ == "__main__":
    main()
