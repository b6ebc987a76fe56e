"""Energy-momentum on cables, nets, thin shells and solids over many steps.

    RUN benchmarks/conserving_any.py [--steps 100000] [--only "swinging cable"] [--axes]

Prints a table of what the balances lack, iterations, matrices and time per step. With --axes each
scene moves twice, with a matrix along the nodes' own axes and with one along axes fixed in space,
which the same policy keeps: the table has the matrices and iterations of both, and the distance of
the runs. They solve the same equations to round-off; the axes are those of the iteration alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie.lie.node_types.node_type import axes
from fem_lie.linear.factors import solve
from fem_lie.mesh.curves import straight_line
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.step.records import Solution, Span
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations

DOWN = (0.0, 0.0, -9.81)
ROPE = fl.Section.from_stiffness([2e3] * 3 + [0.2] * 3, mass=1.0)
RUBBER = fl.sections.SaintVenantKirchhoff(1e4, 0.3, 1.0)


class FixedAxesRun(Run):
    """With unknowns along axes fixed in space: a matrix goes on acting in those it was made in."""

    def __init__(self, *given: Any) -> None:
        """Replace corrections where those that learn from each other would be improved."""
        super().__init__(*given)
        self._python_forces.learn(AlongAxes(self))

    def axes(self) -> np.ndarray:
        """Axes of both halves of all nodes, in the middle of the step, (n, 3, 3)."""
        rows = Span(*self.this.coordinates).mean[: self.moving]
        kinds = self.model.kinds[: self.moving]
        return np.array([axes(int(kind), H) for kind, H in zip(kinds, rows, strict=True)])

    def _factorise(self) -> None:
        super()._factorise()
        self._made_in = self.axes()

    def solved(self) -> np.ndarray:
        """The correction by the matrix along the axes in which it was made."""
        assert self._factors is not None
        # d_k of the matrix on d_j of now: both are orthonormal
        turn = np.einsum("nkx,njx->nkj", self._made_in, self.axes())
        given = np.einsum("nkj,naj->nak", turn, Solution(*self.this.r).residual.reshape(-1, 2, 3))
        y, x = np.empty((2, given.size))
        solve(self._factors.plain, given.ravel(), y, x)
        return np.einsum("nkj,nak->naj", turn, x.reshape(-1, 2, 3)).ravel()


class AlongAxes(Secants):
    """Corrections of such a run."""

    def __init__(self, run: FixedAxesRun) -> None:
        """Learn nothing."""
        super().__init__(1, np.zeros(6 * run.moving))
        self._run = run

    def improve(self, g: np.ndarray) -> None:
        """Replace a correction."""
        g[:] = self._run.solved()


class FixedAxes(fl.EnergyMomentum):
    """The scheme with such a run."""

    def _integration(self, equations: Equations, step: float) -> FixedAxesRun:
        return FixedAxesRun(self.options(), equations, step)


def swinging_cable() -> fl.Scene:
    """A cable of eight elements on a pin, let go from the side."""
    scene = fl.Scene(gravity=DOWN)
    cable = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), ROPE, cells=8))
    cable.pin(cable.point("start"))
    return scene


def whirling_rod() -> fl.Scene:
    """A discrete rod that flies and turns."""
    scene = fl.Scene()
    shape = straight_line((0, 0, 0), (1, 0, 0), 20)
    rod = scene.add(fl.Cable(shape, ROPE, formulation=fl.elements.DiscreteCable()))
    rod.add_velocity(omega=(0.5, 6.0, 9.0), about=(0.4, 0, 0))
    return scene


def falling_net() -> fl.Scene:
    """A net of 36 nodes that hangs by two corners and falls."""
    x, y = np.meshgrid(np.linspace(0, 1, 6), np.linspace(0, 1, 6), indexing="ij")
    grid = np.arange(36).reshape(6, 6)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(36)], axis=1)
    scene = fl.Scene(gravity=DOWN)
    net = scene.add(fl.Net(points, [*grid.tolist(), *grid.T.tolist()], ROPE))
    for corner in (0, 5):
        net.pin(net.point(corner))
    return scene


def flapping_plate() -> fl.Scene:
    """A thin plate that flies, turns and bends."""
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([a, 0.5 * b, 0.1 * np.sin(2 * a)]), (4, 2))
    layer = fl.ShellSection.layer(0.02, fl.Material(2e3, 0.3, 1.0))
    scene = fl.Scene()
    plate = scene.add(fl.ThinShell(patch, layer))
    plate.add_velocity(omega=(2.0, 1.0, 3.0), about=(0.5, 0.2, 0))
    return scene


def tumbling_brick() -> fl.Scene:
    """A soft brick that tumbles about its middle axis."""
    scene = fl.Scene()
    brick = scene.add(fl.Solid.brick((1.0, 0.4, 0.2), RUBBER, cells=(4, 2, 1)))
    brick.add_velocity(omega=(0.05, 6.0, 0.1), about=(0.5, 0.2, 0.1))
    return scene


def tumbling(material: fl.sections.SolidMaterial, cell: str, degree: int) -> Callable[[], fl.Scene]:
    """Soft bricks that tumble and wave, of other cells and materials."""

    def made() -> fl.Scene:
        scene = fl.Scene()
        size, cells = (1.0, 0.4, 0.2), (3, 1, 1)
        brick = fl.Solid.brick(size, material, cells=cells, cell=cell, degree=degree)
        brick.add_velocity(omega=(0.05, 6.0, 0.1), about=(0.5, 0.2, 0.1))
        brick.velocities[:, :3] += 0.3 * np.sin(2.0 * brick.frames[:, 0, [1, 0, 0]])
        scene.add(brick)
        return scene

    return made


def whirling_spline() -> fl.Scene:
    """A cable through points that flies and turns."""
    points = np.array([(0, 0, 0), (0.3, 0.05, 0), (0.6, 0, 0.05), (1, 0, 0)])
    scene = fl.Scene()
    cable = scene.add(fl.SplineCable.through(points, ROPE))
    cable.add_velocity(omega=(0.5, 6.0, 9.0), about=(0.4, 0, 0))
    return scene


def tumbling_beam() -> fl.Scene:
    """A beam of positions and slopes that flies, turns and bends."""
    stiff = fl.Section.from_stiffness([1e4, 4e3, 4e3, 1.0, 1.0, 1.0], mass=1.0, polar=1e-3)
    beam = fl.AncfBeam.curve(lambda s: (s, 0.5 * s * s, 0.2 * s**3), stiff, cells=6)
    beam.add_velocity(omega=(3.0, 4.0, 2.0), about=(0.4, 0.2, 0.0))
    scene = fl.Scene()
    scene.add(beam)
    return scene


def joined_cables() -> fl.Scene:
    """Two cables from a joint on ground, of which the second hangs from the first by another."""
    scene = fl.Scene(gravity=DOWN)
    first = scene.add(fl.Cable.straight((0, 0, 0), (0.5, 0, 0), ROPE, cells=4))
    second = scene.add(fl.Cable.straight((0.5, 0, 0), (1, 0, 0), ROPE, cells=4))
    scene.add(fl.joints.Spherical(fl.ground(), first.point("start")))
    scene.add(fl.joints.Spherical(first.point("end"), second.point("start")))
    return scene


def block(x: float) -> fl.Solid:
    """A soft brick that begins at x."""
    return fl.Solid.brick((0.5, 0.2, 0.1), RUBBER, cells=(2, 1, 1), origin=(x, 0, 0))


def hinged_bricks() -> fl.Scene:
    """Two bricks on a spring in a hinge between two faces, which fly and turn."""
    scene = fl.Scene()
    first, second = scene.add(block(0.0)), scene.add(block(0.5))
    hinge = fl.joints.Revolute(first.point("a=1"), second.point("a=0"), axis=(0, 1, 0.3))
    scene.add(hinge)
    scene.add(fl.joints.Spring(hinge.angle, 0.5))
    first.add_velocity(omega=(1.0, 3.0, 2.0), about=(0.2, 0, 0))
    second.add_velocity(omega=(1.0, 3.0, 2.0), about=(0.2, 0, 0))
    return scene


def driven_bricks() -> fl.Scene:
    """One brick turned by a motor, and one that hangs from it on a spring with a damper."""
    scene = fl.Scene(gravity=DOWN)
    first, second = scene.add(block(0.0)), scene.add(block(0.5))
    motor = fl.joints.Revolute(fl.ground(), first.point("a=0"), axis=(0, 1, 0))
    hinge = fl.joints.Revolute(first.point("a=1"), second.point("a=0"), axis=(0, 1, 0))
    for joint in (motor, hinge):
        scene.add(joint)
    scene.add(fl.joints.Drive(motor.angle, lambda t: 2.0 * np.sin(3.0 * t) ** 2))
    scene.add(fl.joints.Spring(hinge.angle, 0.5, 0.01))
    return scene


def rope_in_hand() -> fl.Scene:
    """A brick whose face is moved, and a cable from its other face."""
    scene = fl.Scene(gravity=DOWN)
    brick = scene.add(block(0.0))
    held = brick.point("a=0")
    position = held.position

    def motion(t: float) -> np.ndarray:
        c, s = np.cos(0.5 * np.sin(2.0 * t) ** 2), np.sin(0.5 * np.sin(2.0 * t) ** 2)
        x, y, z = position
        return np.array([(x, y, z + 0.1 * np.sin(t) ** 2), (c, 0, -s), (0, 1, 0), (s, 0, c)])

    scene.add(fl.PrescribedMotion(held, motion))
    rope = scene.add(fl.Cable.straight((0.5, 0.1, 0.05), (1, 0.1, 0.05), ROPE, cells=3))
    scene.add(fl.joints.Spherical(brick.point("a=1"), rope.point("start")))
    return scene


def towed_net() -> fl.Scene:
    """A net on a cable whose end glides in a plane, on a spring with a damper, and on a winch."""
    scene = fl.Scene(gravity=DOWN)
    soft = fl.Section.from_stiffness([200.0] * 3 + [0.02] * 3, mass=1.0)
    rope = scene.add(fl.Cable.straight((-0.5, 0, 0), (0, 0, 0), soft, cells=3))
    x, y = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 4), indexing="ij")
    grid = np.arange(16).reshape(4, 4)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(16)], axis=1)
    net = scene.add(fl.Net(points, [*grid.tolist(), *grid.T.tolist()], soft))
    scene.add(fl.joints.Spherical(rope.point("end"), net.point(0)))
    scene.add(fl.joints.InPlane(fl.ground(), rope.point("start"), axis=(1, 0, 1)))
    winch = scene.add(fl.joints.Distance(fl.ground(), net.point(15), at=(1, 1, 1)))
    scene.add(fl.joints.Drive(winch.length, lambda t: 1.0 + 0.2 * np.sin(4.0 * t) ** 2))
    beside = scene.add(fl.joints.Distance(rope.point("start"), net.point(12)))
    scene.add(fl.joints.Spring(beside.length, 20.0, 0.5))
    return scene


def hung_sheet() -> fl.Scene:
    """A thin shell, one corner of which turns about an axis, in a weak field."""
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([a, 0.5 * b, 0.1 * np.sin(2 * a)]), (3, 2))
    layer = fl.ShellSection.layer(0.05, fl.Material(2e4, 0.3, 1.0))
    scene = fl.Scene(gravity=(0, 0, -1.0))
    sheet = scene.add(fl.ThinShell(patch, layer))
    scene.add(fl.joints.Revolute(fl.ground(), sheet.point(0), axis=(0, 1, 0)))
    return scene


JOINED: dict[str, tuple[Callable[[], fl.Scene], float]] = {
    "two cables on joints": (joined_cables, 1e-3),
    "two bricks on a hinge with a spring": (hinged_bricks, 1e-3),
    "two bricks, motor, damper": (driven_bricks, 1e-3),
    "brick in hand, cable": (rope_in_hand, 1e-3),
    "net, cable, winch, damper": (towed_net, 1e-3),
    "thin shell on a hinge": (hung_sheet, 1e-3),
}
"""Scenes with joints, and the size of steps."""

SCENES: dict[str, tuple[Callable[[], fl.Scene], float]] = {
    "swinging cable": (swinging_cable, 1e-3),
    "whirling discrete rod": (whirling_rod, 1e-3),
    "falling net": (falling_net, 1e-3),
    "flapping thin plate": (flapping_plate, 1e-3),
    "tumbling brick": (tumbling_brick, 1e-3),
    "tumbling beam of slopes": (tumbling_beam, 1e-3),
    "whirling spline cable": (whirling_spline, 1e-3),
    "hexahedra of degree 2": (tumbling(RUBBER, "hexahedron", 2), 1e-3),
    "tetrahedra": (tumbling(RUBBER, "tetrahedron", 1), 1e-3),
    "neo-Hooke": (tumbling(fl.sections.NeoHooke(1e4, 0.3, 1.0), "hexahedron", 1), 1e-3),
    **JOINED,
}
"""With the size of steps."""


def measured(name: str, steps: int) -> str:
    """One line of the table."""
    scene, step = SCENES[name][0](), SCENES[name][1]
    made, ended = steps, ""
    try:
        result = fl.EnergyMomentum().run(
            scene, duration=steps * step, step=step, save_every=max(steps // 200, 1)
        )
    except fl.ConvergenceError as error:
        result, ended = error.result, f" ended: {str(error).partition('.')[0]}"
        made = round(result.times[-1] / step)
    each = max(made, 1)
    return (
        f"| {name} | {made} | {result.balance_error:.1e} | {result.momentum_error:.1e} | "
        f"{result.angular_momentum_error:.1e} | {result.iterations[-1] / each:.1f} | "
        f"{result.factorisations} | {1e3 * result.seconds / each:.2f} |{ended}"
    )


def compared(name: str, steps: int) -> str:
    """One line of the table of matrices."""
    made, step = SCENES[name]
    plan = {"duration": steps * step, "step": step, "save_every": max(steps // 200, 1)}
    own, fixed = (scheme.run(made(), **plan) for scheme in (fl.EnergyMomentum(), FixedAxes()))
    positions = [run.frames[:, :, 0] for run in (own, fixed)]
    apart = np.abs(positions[0] - positions[1]).max(axis=(1, 2))
    return (
        f"| {name} | {steps} | {own.factorisations} | {fixed.factorisations} | "
        f"{own.iterations[-1] / steps:.1f} | {fixed.iterations[-1] / steps:.1f} | "
        f"{apart[len(apart) // 10]:.0e} | {apart[-1]:.0e} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--only", choices=SCENES, action="append")
    parser.add_argument("--axes", action="store_true")
    given = parser.parse_args()
    if given.axes:
        print("| scene | steps | matrices, own axes | fixed | iterations, own | fixed | ", end="")
        print("apart after a tenth | at the end |\n|---|---|---|---|---|---|---|---|")
        for name in given.only or SCENES:
            print(compared(name, given.steps), flush=True)
        return
    print("| scene | steps | energy | momentum | angular | iterations | matrices | ms per step |")
    print("|---|---|---|---|---|---|---|---|")
    for name in given.only or SCENES:
        print(measured(name, given.steps), flush=True)


if __name__ == "__main__":
    main()
