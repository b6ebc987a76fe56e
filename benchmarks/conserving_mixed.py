"""Energy-momentum on scenes of frames and positions: beams, shells, bodies, cables, nets, solids.

    RUN -m benchmarks.conserving_mixed [--steps 10000] [--only "beam and cable"] [--order]

Prints a table of what the balances lack, how well joints hold, iterations, matrices and time per
step. With --order each scene moves for 48 steps with three sizes of steps, and the table has the
errors of positions and of joint forces at the end against steps of a quarter of the smallest.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np

import fem_lie as fl
from benchmarks.conserving_any import DOWN, ROPE, block
from fem_lie.mesh.curves import straight_line

BAR = fl.Section.from_stiffness([2e3, 1e3, 1e3, 0.5, 0.4, 0.6], mass=1.0, rotary=(2e-3, 1e-3))
SOFT = fl.Section.from_stiffness([200.0] * 3 + [0.02] * 3, mass=0.5)


def beam_and_cable() -> fl.Scene:
    """They fly and turn, a cable on the end of a beam."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=4))
    cable = scene.add(fl.Cable.straight((1, 0, 0), (2, 0, 0), ROPE, cells=4))
    scene.add(fl.joints.Spherical(beam.point("end"), cable.point("start")))
    for body in (beam, cable):
        body.add_velocity(omega=(0.3, 2.0, 3.0), about=(0.5, 0, 0))
    return scene


def crane() -> fl.Scene:
    """A clamped beam in gravity, a cable from its end, and a weight on that."""
    scene = fl.Scene(gravity=DOWN)
    jib = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=4))
    scene.add(fl.Clamp(jib.point("start")))
    rope = scene.add(fl.Cable.straight((1, 0, 0), (1.4, 0, 0.2), ROPE, cells=3))
    weight = scene.add(fl.RigidBody(0.5, (1e-3, 2e-3, 3e-3), position=(1.4, 0.1, 0.2)))
    scene.add(fl.joints.Spherical(jib.point("end"), rope.point("start")))
    scene.add(fl.joints.Spherical(rope.point("end"), weight.point((1.4, 0.0, 0.2))))
    return scene


def solid_hub() -> fl.Scene:
    """A brick that flies and turns, with a beam on either side, and a cable with a weight."""
    scene, hub = fl.Scene(), block(0.0)
    left = fl.Beam.straight((0, 0.1, 0.05), (-0.5, 0.1, 0.05), BAR, cells=2)
    right = fl.Beam.straight((0.5, 0.1, 0.05), (1.0, 0.1, 0.05), BAR, cells=2)
    rope = fl.Cable.straight((0.25, 0.2, 0.05), (0.25, 0.6, 0.05), ROPE, cells=3)
    weight = fl.RigidBody(0.2, (1e-3,) * 3, position=(0.25, 0.6, 0.05))
    for body in (hub, left, right, rope, weight):
        scene.add(body)
        body.add_velocity(omega=(0.4, 0.2, 4.0), about=(0.25, 0.1, 0.05))
    scene.add(fl.joints.Fixed(hub.point("a=0"), left.point("start")))
    scene.add(fl.joints.Fixed(hub.point("a=1"), right.point("start")))
    scene.add(fl.joints.Spherical(hub.point("b=1"), rope.point("start")))
    scene.add(fl.joints.Spherical(rope.point("end"), weight.point("centre")))
    return scene


def shell_and_cable() -> fl.Scene:
    """A shell that turns, and a cable without bending on one of its corners."""
    scene = fl.Scene()
    layer = fl.ShellSection.layer(0.02, fl.Material(2e4, 0.3, 50.0))
    sheet = scene.add(
        fl.Shell(fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * a), (3, 2)), layer)
    )
    corner = sheet.points("a=1")[-1]
    end = corner.position + np.array([0.6, 0.0, 0.0])
    shape = straight_line(corner.position, end, 6)
    cable = scene.add(fl.Cable(shape, SOFT, formulation=fl.elements.DiscreteCable()))
    scene.add(fl.joints.Spherical(corner, cable.point("start")))
    for body in (sheet, cable):
        body.add_velocity(omega=(2.0, 1.0, 3.0), about=(0.5, 0.2, 0))
    return scene


def driven_body() -> fl.Scene:
    """A body on a motor, a cable to a beam on a hinge with a spring and a damper, in gravity."""
    scene = fl.Scene(gravity=DOWN)
    wheel = scene.add(fl.RigidBody(1.0, (0.02, 0.03, 0.02)))
    motor = scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 1, 0)))
    scene.add(fl.joints.Drive(motor.angle, lambda t: 2.0 * np.sin(3.0 * t) ** 2))
    rope = scene.add(fl.Cable.straight((0.2, 0, 0), (0.7, 0, 0), SOFT, cells=3))
    arm = scene.add(fl.Beam.straight((0.7, 0, 0), (1.2, 0, 0), BAR, cells=2))
    scene.add(fl.joints.Spherical(wheel.point((0.2, 0, 0)), rope.point("start")))
    scene.add(fl.joints.Spherical(rope.point("end"), arm.point("start")))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), arm.point("end"), axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(hinge.angle, 1.0, 0.02))
    arm.model.damping = fl.sections.Damping(mass=0.2, stiffness=1e-3)
    return scene


def thin_shell_on_beam() -> fl.Scene:
    """A thin shell on a hinge at the end of a beam, which turns about an axis on ground."""
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([a, 0.5 * b, 0.1 * np.sin(2 * a)]), (2, 2))
    layer = fl.ShellSection.layer(0.05, fl.Material(2e4, 0.3, 1.0))
    scene = fl.Scene(gravity=(0, 0, -1.0))
    arm = scene.add(fl.Beam.straight((-0.5, 0, 0), (0, 0, 0), BAR, cells=2))
    sheet = scene.add(fl.ThinShell(patch, layer))
    scene.add(fl.joints.Revolute(fl.ground(), arm.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(arm.point("end"), sheet.point(0), axis=(0, 1, 0)))
    return scene


def rod_and_cable() -> fl.Scene:
    """A bent rod without shear that twists as it turns, and a cable on its end."""
    scene = fl.Scene()
    rod = scene.add(fl.Rod.curve(lambda s: (s, 0.3 * s * s, 0.1 * s**3), BAR, cells=5))
    cable = scene.add(fl.Cable.straight((1, 0.3, 0.1), (1.5, 0.3, 0.1), ROPE, cells=3))
    scene.add(fl.joints.Spherical(rod.point("end"), cable.point("start")))
    for body in (rod, cable):
        body.add_velocity(omega=(4.0, 2.0, 3.0), about=(0.5, 0.1, 0))
    return scene


SCENES: dict[str, Callable[[], fl.Scene]] = {
    "beam and cable": beam_and_cable,
    "crane": crane,
    "rod with twist and cable": rod_and_cable,
    "solid hub, beams, cable, weight": solid_hub,
    "shell and cable": shell_and_cable,
    "wheel on a motor, cable, beam with damping": driven_body,
    "thin shell on a beam": thin_shell_on_beam,
}


def measured(name: str, steps: int, step: float) -> str:
    """One line of the table."""
    plan = {"duration": steps * step, "step": step, "save_every": max(steps // 200, 1)}
    made, ended = steps, ""
    try:
        result = fl.EnergyMomentum().run(SCENES[name](), **plan)
    except fl.ConvergenceError as error:
        result, ended = error.result, f" ended: {str(error).partition('.')[0]}"
        made = max(round(result.times[-1] / step), 1)
    return (
        f"| {name} | {made} | {result.balance_error:.1e} | {result.momentum_error:.1e} | "
        f"{result.angular_momentum_error:.1e} | {result.joint_violations.max():.0e} | "
        f"{result.iterations[-1] / made:.1f} | {result.factorisations} | "
        f"{1e3 * result.seconds / made:.2f} |{ended}"
    )


def orders(name: str, step: float) -> str:
    """Errors of positions and joint forces with steps of 4, 2 and 1 times ``step``."""
    plan = {"duration": 48 * step, "save_every": 10**6}
    sizes = 4.0 * step, 2.0 * step, step, 0.25 * step
    runs = [fl.EnergyMomentum().run(SCENES[name](), step=h, **plan) for h in sizes]
    numbers = []
    for reported in ([r.frames[-1, :, 0] for r in runs], [r.joint_forces[-1] for r in runs]):
        size = np.abs(reported[-1]).max()
        errors = np.array([np.abs(each - reported[-1]).max() for each in reported[:-1]]) / size
        rates = np.log2(errors[:-1] / errors[1:])
        numbers.append(f"{errors[-1]:.1e} | {rates[0]:.2f}, {rates[1]:.2f}")
    return f"| {name} | {' | '.join(numbers)} |"


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--step", type=float, default=1e-3)
    parser.add_argument("--only", choices=SCENES, action="append")
    parser.add_argument("--order", action="store_true")
    given = parser.parse_args()
    if given.order:
        print("| scene | positions | order | joint forces | order |\n|---|---|---|---|---|")
        for name in given.only or SCENES:
            print(orders(name, given.step), flush=True)
        return
    print("| scene | steps | energy | momentum | angular | joints | iterations | matrices | ms |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in given.only or SCENES:
        print(measured(name, given.steps, given.step), flush=True)


if __name__ == "__main__":
    main()
