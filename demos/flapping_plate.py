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

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from scipy.optimize import brentq

import fem_lie as fl
from fem_lie import lie
from fem_lie.pictures.diagrams import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
Array = npt.NDArray[np.float64]

LENGTH, CHORD, THICKNESS = 0.3, 0.15, 1e-3
E, DENSITY = 3e9, 1200.0
AREAL = DENSITY * THICKNESS
INERTIA = AREAL * LENGTH**3 / 3 + DENSITY * THICKNESS**3 * LENGTH / 12  # about the hinge, per chord
BENDING = E * THICKNESS**3 / 12  # per chord
ROOTS = [
    brentq(lambda b: np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b), s, s + 1.5)
    for s in np.pi * np.arange(1, 9) + 0.1
]
FIRST = ROOTS[0] ** 2 * np.sqrt(BENDING / AREAL) / LENGTH**2
BEAT = 0.15 * FIRST  # W


def moment(amplitude: float, time: float) -> float:
    """Per length of the root, about y: a positive amplitude lifts the tip."""
    return float(amplitude * INERTIA * BEAT**2 * np.sin(BEAT * time))


def sheet(cells: tuple[int, int], amplitude: float, nu: float) -> fl.Scene:
    """The hinged sheet with its drive."""
    wing = fl.Shell(
        fl.surface(lambda a, b: (LENGTH * a, CHORD * b, 0.0), cells),
        fl.ShellSection.layer(THICKNESS, fl.Material(E, nu, DENSITY)),
        name="wing",
    )
    wing.hinge("a=0")
    wing.turn((0.0, -amplitude * BEAT, 0.0), about=(0.0, 0.0, 0.0))
    scene = fl.Scene()
    scene.add(wing)
    drive = fl.EdgeLoad(wing, "a=0", moment=(0, 1, 0), history=lambda t: moment(amplitude, t))
    scene.add(drive)
    return scene


def flap(
    cells: tuple[int, int], amplitude: float, nu: float, step: float, periods: float, radius: float
) -> fl.Result:
    """Beat for some periods, in steps of a part of the period."""
    scene, h = sheet(cells, amplitude, nu), 2 * np.pi / BEAT * step
    duration = round(periods / step) * h
    return fl.GeneralisedAlpha(radius=radius).run(scene, duration=duration, step=h)


def work(result: fl.Result, scene: fl.Scene, amplitude: float) -> Array:
    """Of the moment, from the velocities of the root, by the trapezoidal rule, shape (T,)."""
    (wing,) = scene.bodies
    assert isinstance(wing, fl.Shell)
    edges, lengths = wing.edges("a=0")
    nodes = result.info.body("wing").nodes[edges]
    turning = np.einsum(
        "tekij,teki->tekj", result.frames[:, nodes, 1:], result.velocities[:, nodes, 3:]
    )
    rate = np.einsum("ek,tek->t", lengths, turning[..., 1])
    power = rate * np.array([moment(amplitude, t) for t in result.times])
    steps = 0.5 * (power[1:] + power[:-1]) * np.diff(result.times)
    return np.concatenate([[0.0], np.cumsum(steps)])


def beam_tip(amplitude: float, times: Array) -> Array:
    """Height of the tip for small amplitudes, closed form, shape (T,)."""
    m0 = amplitude * INERTIA * BEAT**2
    total = amplitude * LENGTH * np.sin(BEAT * times)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    x = 0.5 * (nodes + 1)
    for b in ROOTS:
        phi = np.sin(b * x) / np.sin(b) + np.sinh(b * x) / np.sinh(b)
        mass = AREAL * LENGTH * 0.5 * weights @ phi**2
        slope = b / LENGTH * (1 / np.sin(b) + 1 / np.sinh(b))
        w = b**2 * np.sqrt(BENDING / AREAL) / LENGTH**2
        shape = (np.sin(BEAT * times) - BEAT / w * np.sin(w * times)) / (w**2 - BEAT**2)
        total -= 2.0 * slope * m0 / mass * shape  # phi(L) = 2
    return total


def main(
    mesh: int = 16,
    amplitude: float = 50.0,
    step: float = 0.005,
    periods: float = 2.0,
    pictures: bool = True,
) -> dict[str, Any]:
    A, radius = np.radians(amplitude), 0.9
    cells = (mesh, max(mesh // 2, 1))
    coarse = flap(cells, A, 0.38, step, periods, radius)
    fine = flap(cells, A, 0.38, step / 2, periods, radius)
    tips = [result.position("wing.10") for result in (coarse, fine)]
    difference = np.linalg.norm(tips[0] - tips[1][::2], axis=1).max() / LENGTH
    scene = sheet(cells, A, 0.38)
    errors = []
    for result in (coarse, fine):
        energy = result.kinetic + result.elastic
        gained = work(result, scene, A)
        errors.append(float(np.abs(energy - energy[0] - gained).max() / energy.max()))
    root = lie.so3_log(fine.rotation("wing.00"))  # the frame of the sheet is that of space
    strip = flap((mesh, 1), 1e-3, 0.0, step, periods, radius)
    closed = beam_tip(1e-3, strip.times)
    beam_error = np.abs(strip.position("wing.10")[:, 2] - closed).max() / np.abs(closed).max()
    relative = np.abs(closed - 1e-3 * LENGTH * np.sin(BEAT * strip.times)).max()
    record: dict[str, Any] = {
        "mesh": mesh,
        "amplitude": amplitude,
        "frequency": BEAT / (2 * np.pi),
        "root_amplitude": float(np.degrees(np.abs(root[:, 1]).max())),
        "highest_tip": float(tips[1][:, 2].max()),
        "lowest_tip": float(tips[1][:, 2].min()),
        "time_difference": float(difference),
        "energy_error_coarse": errors[0],
        "energy_error": errors[1],
        "greatest_energy": float((fine.kinetic + fine.elastic).max()),
        "greatest_elastic_energy": float(fine.elastic.max()),
        "beam_error": float(beam_error),
        "beam_flexibility": float(relative / np.abs(closed).max()),
        "iterations_per_step": float(fine.iterations[-1] / (len(fine.times) - 1)),
        "factorisations": fine.factorisations,
        "seconds": fine.seconds,
    }
    print(
        "{frequency:.1f} Hz; the root beats to {root_amplitude:.1f} degrees, a rigid sheet to "
        "{amplitude:.1f}".format(**record)
    )
    print("tip between {lowest_tip:.4f} and {highest_tip:.4f} m".format(**record))
    print("tip with half the step: {time_difference:.1e} of the length".format(**record))
    print(
        "work of the moment and energy: {energy_error:.1e} of the greatest, "
        "{energy_error_coarse:.1e} with twice the step".format(**record)
    )
    print("small amplitude against the beam: {beam_error:.1e} of the largest".format(**record))
    print(
        "{iterations_per_step:.1f} iterations per step, {factorisations} factorisations, "
        "{seconds:.1f} s".format(**record)
    )
    if pictures:
        draw(fine, root[:, 1], strip.times, strip.position("wing.10")[:, 2], closed, A)
    return record


def draw(
    result: fl.Result, root: Array, times: Array, small: Array, closed: Array, amplitude: float
) -> None:
    """The sheet at several times, and root, tip and small amplitudes over time."""
    RESULTS.mkdir(exist_ok=True)
    picture, diagram = RESULTS / "flapping_plate.png", RESULTS / "flapping_plate_tip.png"
    beat = 2 * np.pi / BEAT
    moments = np.linspace(0.25, 0.75, 6) * beat
    result.picture(picture, moments, trace=["wing.10"], title="Flapping plate")
    figure = Figure(figsize=(9.0, 4.0), dpi=150, layout="constrained")
    left, right = figure.subplots(1, 2)
    t, tip = result.times / beat, result.position("wing.10")
    across = np.degrees(np.arctan2(tip[:, 2], tip[:, 0]))
    left.plot(t, np.degrees(amplitude * np.sin(BEAT * result.times)), ":", color="#777777")
    left.plot(t, -np.degrees(root), color=COLOURS[0])
    left.plot(t, across, color=COLOURS[1])
    left.legend(["rigid sheet", "root", "line from root to tip"], frameon=False, loc="upper right")
    left.set(xlabel="time [periods]", ylabel="angle [degrees]", title="Large strokes")
    left.set_ylim(-60.0, 110.0)
    right.plot(times / beat, 1e3 * small, color=COLOURS[0], label="shell")
    right.plot(times / beat, 1e3 * closed, "--", color="black", label="beam, closed form")
    right.set(xlabel="time [periods]", ylabel="tip [mm]", title="Small strokes")
    right.set_ylim(top=2e3 * np.abs(closed).max())
    right.legend(frameon=False, loc="upper right")
    for axes in (left, right):
        axes.grid(color="#DDDDDD", linewidth=0.6)
    figure.savefig(diagram)
    print(f"pictures: {picture}, {diagram}")


if __name__ == "__main__":
    from command_line import run

    run(main)
