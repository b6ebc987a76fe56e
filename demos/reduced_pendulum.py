"""A double pendulum of two reduced-order steel plates, against all unknowns of its shells.

Two plates, 0.5 m x 0.1 m x 15 mm, 20 x 4 shell cells each, hang from each other on hinges; their
ends are stiff edges. They are let go 30 degrees from the vertical, and the second hinge is askew,
so that the motion goes out of the plane and the plates twist. Full, they have 1260 unknowns.

Reduced, a plate moves with the frame H of its upper edge and deforms by Craig-Bampton shapes: six
of the lower edge, which is a node of its own, and with both edges held `modes` vibrations and the
answers to six accelerations of the whole plate,

    H_i = H H_i0 exp(Phi_i z),    z = (lower edge in H, amplitudes).

The answers to accelerations make moments right beside the stiff edges, where those of vibrations
converge slowly. Energy is that of e = z + z Q z / 2, so that weight and centrifugal force stiffen
bending. The inertia of rows (x, d_k) of all nodes is that of the full consistent matrix, projected
once, with gyroscopic and centrifugal forces. Both models are integrated by the same scheme in the
same steps. fem_lie.reduction.recover_full_motion makes the full fields of the reduced motion, of
which stress resultants and pictures are those of any shell.

The record has the number of coordinates, the largest distance of the lower hinge from that of the
full model over the length of both plates, the same of the free end, the largest error of bending
and twisting moments in 20 states over the largest moment, the same of stress on both surfaces,
times per step, what it takes to set the bodies up, and after how many steps that has paid.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from command_line import in_results, run
from diagrams import diagram
from shell_errors import stress_errors

import fem_lie as fl
from fem_lie.extend import Point
from fem_lie.mesh import parametric_surface as rectangle

LENGTH, WIDTH, THICKNESS, ANGLE = 0.5, 0.1, 15e-3, np.radians(30.0)
STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)


def plate(scene: fl.Scene, x: float, name: str) -> tuple[fl.Shell, Point, Point]:
    """A plate with stiff ends, and the middles of these."""
    mesh = rectangle(lambda a, b: (x + LENGTH * a, WIDTH * (b - 0.5), 0.0), (20, 4))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(THICKNESS, STEEL), name=name))
    ends = []
    for end in (x, x + LENGTH):
        edge = np.flatnonzero(np.abs(shell.frames[:, 0, 0] - end) < 1e-9)
        middle = edge[np.abs(shell.frames[edge, 0, 1]).argmin()]
        for node in edge[edge != middle]:
            scene.add(fl.joints.RigidLink(shell.point(middle), shell.point(node)))
        ends.append(shell.point(middle))
    return shell, *ends


def hinged(scene: fl.Scene, points: list[Point]) -> fl.Scene:
    """With both hinges, and weight."""
    scene.add(fl.joints.Revolute(fl.ground(), points[0], axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(points[1], points[2], axis=(0.2, 1, 0)))
    scene.gravity = 9.81 * np.array([np.cos(ANGLE), 0.0, -np.sin(ANGLE)])
    return scene


def reduced(x: float, name: str, modes: int) -> fl.reduction.ReducedOrderBody:
    """A plate as a reduced-order body."""
    part = fl.Scene()
    _, *ends = plate(part, x, name)
    return fl.reduction.reduced_order_body(part, ends, modes)


def main(
    modes: int = 6, duration: float = 10.0, step: float = 2e-3, pictures: bool = True
) -> dict[str, Any]:
    whole, few = fl.Scene(), fl.Scene()
    one, *first = plate(whole, 0.0, "one")
    two, *second = plate(whole, LENGTH, "two")
    hinged(whole, [*first, *second])
    start = perf_counter()
    links = [few.add(reduced(x, name, modes)) for x, name in ((0.0, "one"), (LENGTH, "two"))]
    setup = perf_counter() - start
    arrays = [a for m in links for a in (m.model.density, m.model.stiffness, m.model.quadratic)]
    hinged(few, [link.point(k) for link in links for k in range(2)])
    scheme, steps = fl.GeneralisedAlpha(radius=0.8), round(duration / step)
    scheme.run(few, duration=step, step=step)  # compiles
    fast = scheme.run(few, duration=duration, step=step)
    scheme.run(whole, duration=step, step=step)
    full = scheme.run(whole, duration=duration, step=step)
    found = fl.reduction.recover_full_motion(fast, *links)
    away = [
        np.linalg.norm(found.position(point) - full.position(point), axis=1) / (2 * LENGTH)
        for point in (first[1], second[1])
    ]
    looked = np.unique(np.linspace(0, steps, 21).astype(int))[1:]
    errors = [stress_errors(found, full, s, THICKNESS, looked) for s in (one, two)]
    moment, stress = np.max(errors, axis=0)
    if pictures:
        draw(found, full.times, away)
    return {
        "modes": len(links[0].model.stiffness),
        "motion_error": float(away[0].max()),
        "tip_error": float(away[1].max()),
        "moment_error": float(moment),
        "stress_error": float(stress),
        "speedup": full.seconds / fast.seconds,
        "setup_seconds": setup,
        "kilobytes": sum(array.nbytes for array in arrays) / 1024,
        "break_even_steps": setup / (full.seconds - fast.seconds) * steps,
        "energy_error": fast.energy_error,
    }


def draw(found: fl.Result, times: np.ndarray, away: list[np.ndarray]) -> None:
    """The motion expanded to all nodes, and what it misses over time."""
    moments, file = np.linspace(0.0, min(1.0, times[-1]), 5), in_results("reduced_pendulum.png")
    found.picture(file, moments, title="Reduced-order double pendulum")
    with diagram("reduced_pendulum_error.png") as axes:
        for name, error in zip(("hinge", "free end"), away, strict=True):
            axes.semilogy(times[1:], error[1:], label=name)
        axes.set(xlabel="time [s]", ylabel="error over the length")


if __name__ == "__main__":
    run(main, show=True)
