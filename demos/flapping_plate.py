"""A plastic sheet flaps like a wing: hinged along its root, driven there by a moment.

Length 0.3 m, chord 0.15 m, thickness 1 mm, E = 3e9, nu = 0.38, 1200 kg/m3. The root may turn about
the hinge, its axis is y, and feels a moment per length m(t) = -m0 sin(W t). A rigid sheet that
starts with the angular velocity m0/(I W) would beat as A sin(W t), A = m0/(I W^2), with
I = rho t L^3/3 + rho t^3 L/12. This one is flexible: its first frequency, hinged at the root, is
W/0.15. It starts straight with that angular velocity; where the stroke turns, the moment bends it
by 40 % of all energy, and the root turns by 32 degrees where a rigid one would turn by 50.

The sheet is a Reissner-Mindlin shell of four-node quadrilaterals with Hellinger-Reissner stress,
five parameters at each node: position and director in the node's own frame. Inertia is that of
x + z t, rotary inertia included, and is constant in (x, t), so that frames that turn by any angle
bring no new terms. Integrator: generalised-alpha on SE(3) with a kept iteration matrix. A moment
about a fixed axis is no dead load: its components turn in the nodes' frames.

Three checks.

1. Energy: what the moment does, the integral of m times the angular velocity of the root, is the
   kinetic and elastic energy gained. Generalised-alpha does not conserve energy; it damps what
   moves faster than the steps, and the rest is of second order in the step.
2. Time: the same with half the step. The difference of the tips is three times the error of the
   finer one.
3. Small amplitude and nu = 0: a beam, hinged and free, that is driven from rest at the hinge. With
   phi_0 = x, and phi_n = sin(b x)/sin(b L) + sinh(b x)/sinh(b L) where tan(b L) = tanh(b L), its
   tip is the sum of phi_n(L) q_n,

       q_n'' + w_n^2 q_n = phi_n'(0) m(t) / (rho t integral of phi_n^2),

   in closed form (Euler-Bernoulli; shear and rotary inertia do not matter for so thin a sheet).
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from command_line import in_results, run
from diagrams import COLOURS, diagram
from records import of_motion
from reference import flapping_plate as given
from reference.flapping_plate import BEAT, LENGTH, beam_tip, energy_error

import fem_lie as fl
from fem_lie import lie


def sheet(cells: tuple[int, int], A: float, nu: float) -> fl.Scene:
    """The hinged sheet with its drive of amplitude ``A``."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (LENGTH * a, given.CHORD * b, 0.0), cells)
    section = fl.ShellSection.layer(given.THICKNESS, fl.Material(given.E, nu, given.DENSITY))
    wing = fl.Shell(mesh, section, name="wing")
    wing.hinge("a=0")
    wing.add_velocity(omega=(0.0, -A * BEAT, 0.0), about=(0.0, 0.0, 0.0))
    scene = fl.Scene()
    scene.add(wing)
    drive = partial(given.moment, A)
    scene.add(fl.loads.EdgeLoad(wing, "a=0", moment=(0, 1, 0), history=drive))
    return scene


def flap(cells: tuple[int, int], A: float, nu: float, step: float, periods: float) -> fl.Result:
    """Beat for some periods, in steps of a part of the period."""
    scene, h = sheet(cells, A, nu), 2 * np.pi / BEAT * step
    return fl.GeneralisedAlpha(radius=0.9).run(scene, duration=round(periods / step) * h, step=h)


def main(
    mesh: int = 16,
    amplitude: float = 50.0,
    step: float = 0.005,
    periods: float = 2.0,
    pictures: bool = True,
) -> dict[str, Any]:
    A, cells = np.radians(amplitude), (mesh, max(mesh // 2, 1))
    coarse = flap(cells, A, 0.38, step, periods)
    fine = flap(cells, A, 0.38, step / 2, periods)
    strip = flap((mesh, 1), 1e-3, 0.0, step, periods)
    away = fine.position("wing.10")[::2] - coarse.position("wing.10")
    tip = fine.position("wing.10")[:, 2]
    root = lie.so3_log(fine.rotation("wing.00"))[:, 1]  # the frame of the sheet is that of space
    small, closed = strip.position("wing.10")[:, 2], beam_tip(1e-3, strip.times)
    rigid = 1e-3 * LENGTH * np.sin(BEAT * strip.times)
    if pictures:
        draw(fine, root, strip, A)
    return {
        "mesh": mesh,
        "amplitude": amplitude,
        "frequency": BEAT / (2 * np.pi),
        "root_amplitude": float(np.degrees(np.abs(root).max())),
        "highest_tip": float(tip.max()),
        "lowest_tip": float(tip.min()),
        "time_difference": float(np.linalg.norm(away, axis=1).max() / LENGTH),
        "energy_error_coarse": energy_error(coarse, sheet(cells, A, 0.38), A),
        "energy_error": energy_error(fine, sheet(cells, A, 0.38), A),
        "greatest_energy": float((fine.kinetic + fine.elastic).max()),
        "greatest_elastic_energy": float(fine.elastic.max()),
        "beam_error": float(np.abs(small - closed).max() / np.abs(closed).max()),
        "beam_flexibility": float(np.abs(closed - rigid).max() / np.abs(closed).max()),
        **of_motion(fine, len(fine.times) - 1),
        "factorisations": fine.factorisations,
    }


def draw(result: fl.Result, root: np.ndarray, strip: fl.Result, amplitude: float) -> None:
    """The sheet at several times, and root, tip and small amplitudes over time."""
    beat = 2 * np.pi / BEAT
    moments, file = np.linspace(0.25, 0.75, 6) * beat, in_results("flapping_plate.png")
    result.picture(file, moments, trace=["wing.10"], title="Flapping plate")
    t, tip = result.times / beat, result.position("wing.10")
    rigid, times = amplitude * np.sin(BEAT * result.times), strip.times
    small, closed = strip.position("wing.10")[:, 2], beam_tip(1e-3, times)
    with diagram("flapping_plate_tip.png", panels=2) as (left, right):
        left.plot(t, np.degrees(rigid), ":", color="#777777", label="rigid sheet")
        left.plot(t, -np.degrees(root), color=COLOURS[0], label="root")
        across = np.degrees(np.arctan2(tip[:, 2], tip[:, 0]))
        left.plot(t, across, color=COLOURS[1], label="line from root to tip")
        left.set(xlabel="time [periods]", ylabel="angle [degrees]", title="Large strokes")
        left.set_ylim(-60.0, 110.0)
        right.plot(times / beat, 1e3 * small, color=COLOURS[0], label="shell")
        right.plot(times / beat, 1e3 * closed, "--", color="black", label="beam, closed form")
        right.set(xlabel="time [periods]", ylabel="tip [mm]", title="Small strokes")
        right.set_ylim(top=2e3 * np.abs(closed).max())


if __name__ == "__main__":
    run(main, show=True)
