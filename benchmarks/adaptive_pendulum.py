"""A pendulum with a soft end that is hit: meshes and steps that follow it, and equal ones.

``tools/run python3 -m benchmarks.adaptive_pendulum [--tolerance 0.1] [--share 0.5]``

An arm of one metre swings about a hinge, its last twentieth four thousand times softer; after half
a second a smooth push at its tip bends that, and errors are taken before the push is over. They are
against many elements and steps: of the stress in the energy norm, over its largest norm in that
run, as the tolerance is; and of the position of the tip, over the length.
"""

from __future__ import annotations

import argparse

import numpy as np

import fem_lie as fl

DURATION, EVERY, BEGINS, LASTS, FORCE = 0.6, 0.05, 0.5, 0.13, 5.0
SOFT = 0.95  # where the soft end begins
MATERIAL = fl.Material(E=2e9, nu=0.3, density=1500.0)
ARM, END = fl.Section.rectangle(0.02, 0.02, MATERIAL), fl.Section.rectangle(0.02, 0.00125, MATERIAL)
PLACES = (np.arange(16000) + 0.5) / 16000
FINE = 640, 2400


def line(cells: int) -> fl.mesh.LineMesh:
    """Equal elements, downwards."""
    return fl.mesh.straight_line((0, 0, 0), (0, 0, -1), cells)


def first(arm: int = 4) -> fl.mesh.LineMesh:
    """So many elements for the arm, one for its soft end."""

    def position(s: float) -> np.ndarray:
        s *= arm + 1
        return np.array([0.0, 0.0, -(SOFT * s / arm if s < arm else SOFT + (1 - SOFT) * (s - arm))])

    return fl.mesh.curve(position, arm + 1)


def push(time: float) -> float:
    """One smooth push, that is not over at the end."""
    return float(np.sin(np.pi * (time - BEGINS) / LASTS) ** 2) if time > BEGINS else 0.0


def pendulum(mesh: fl.mesh.LineMesh) -> fl.Scene:
    """Hinged at its start, about y."""
    scene = fl.Scene(gravity=(0, 0, -9.81))

    def section(arc: float) -> fl.Section:
        return END if arc > SOFT else ARM

    arm = scene.add(fl.Beam(mesh, section, name="arm"))
    arm.add_velocity(omega=(0, -1, 0), about=(0, 0, 0))
    scene.add(fl.joints.Revolute(fl.ground(), arm.point("start"), axis=(0, 1, 0), name="hinge"))
    scene.add(fl.PointLoad(arm.point("end"), force=(FORCE, 0, 0), history=push))
    return scene


def stress(scene: fl.Scene, result: fl.Result) -> np.ndarray:
    """Strains at positions along the line times the roots of the stiffness, at the end, (k, 6)."""
    (body,) = scene.bodies
    assert isinstance(body, fl.Beam)
    frames = result.frames[-1][result.info.body("arm").nodes]
    start, end = body.model.elements[:, :2].T

    def rates(H: np.ndarray) -> np.ndarray:
        return fl.lie.se3_relative(H[start], H[end]) / body.model.lengths[:, np.newaxis]

    strain = rates(frames) - rates(body.frames)
    roots = np.sqrt(np.diagonal(body.model.stiffness, axis1=1, axis2=2))
    order = np.argsort(-body.frames[start, 0, 2])
    edges = np.sort(-body.frames[:, 0, 2])
    return (strain * roots)[order[np.searchsorted(edges, PLACES) - 1]]


def uniform(cells: int, steps: int) -> tuple[fl.Scene, fl.Result]:
    """Equal elements, equal steps."""
    scene = pendulum(line(cells))
    scheme = fl.GeneralisedAlpha()
    result = scheme.run(
        scene, duration=DURATION, step=DURATION / steps, save_every=max(1, steps // 100)
    )
    return scene, result


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tolerance", type=float, default=0.1)
    parser.add_argument("--share", type=float, default=0.5)
    given = parser.parse_args()
    scene, result = uniform(*FINE)
    true, tip = stress(scene, result), result.position("arm.end")[-1]
    norm = np.sqrt(2.0 * result.elastic.max())

    def report(way: str, scene: fl.Scene, result: fl.Result, work: int) -> None:
        gap = stress(scene, result) - true
        error = np.sqrt((gap**2).sum() / len(PLACES)) / norm
        away = np.linalg.norm(result.position("arm.end")[-1] - tip)
        print(f"| {way} | {100 * error:.3g} % | {100 * away:.2g} % | {work} |", flush=True)

    print("| mesh | error of the stress | of the tip | element steps |\n| --- | --- | --- | --- |")
    found = fl.adaptivity.adapt_motion(
        pendulum,
        first(),
        duration=DURATION,
        every=EVERY,
        tolerance=given.tolerance,
        size=1.0,
        space_fraction=given.share,
        least=float(norm),
    )
    last, cells = found.segments[-1], found.cells
    way = f"{cells.min()} … {cells.max()} elements, {found.steps.sum()} steps"
    report(way, last.scene, last.result, found.element_steps)
    for cells, steps in ((160, 100), (200, 100), (240, 100), (240, 150)):
        report(f"{cells} equal elements, {steps} steps", *uniform(cells, steps), cells * steps)


if __name__ == "__main__":
    main()
