"""A beam on a turning hub: frequencies over the angular velocity, and how it gets up to speed.

Centrifugal force stretches a beam that turns, and a stretched beam is stiffer. Across the plane of
rotation (flap) and within it (lag) a slender beam vibrates as

    EI w'''' - (N w')' = rho A (omega^2 + s W^2) w,    N = rho A W^2 (L^2 - x^2) / 2,

with W the angular velocity of the hub, s = 0 for flap and 1 for lag: the lag frequencies follow
from those of a flap by omega^2 - W^2. The reference is a Chebyshev collocation of this equation;
A. D. Wright, C. E. Smith, R. W. Thresher & J. L. C. Wang (J. Appl. Mech. 49 (1982) 197) give the
same figures by power series. Here nothing of the kind is derived: the beam is clamped to the hub,
`vibrations(scene, spin=...)` finds its equilibrium in the turning frame and linearises there, with
all centrifugal and Coriolis forces.

The second part turns the hub in T = 15 s from rest to W = 6 rad/s,

    angle(t) = W/T (t^2/2 + (T/2 pi)^2 (cos(2 pi t/T) - 1)),    then W (t - T/2),

as T. R. Kane, R. R. Ryan & A. K. Banerjee (J. Guid. Control Dyn. 10 (1987) 139) and J. C. Simo & L.
Vu-Quoc (J. Appl. Mech. 53 (1986) 855) did: L = 10, EA = 2.8e7, GA = 1e7, EI = 1.4e4, rho A = 1.2,
rho I = 6e-4. The tip lags behind by some 0.6 and comes back, because the beam stiffens; theories
that miss this let it diverge. In the end it is longer by L (tan k/k - 1), k = W L sqrt(rho A/EA).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie import lie
from fem_lie.pictures.diagrams import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
Array = npt.NDArray[np.float64]

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)
LENGTH, WIDTH, HEIGHT = 10.0, 0.02, 0.04
SPIN, RISE = 6.0, 15.0

Scheme = fl.GeneralisedAlpha | fl.EnergyMomentum
SCHEMES: dict[str, Scheme] = {
    "generalised-alpha": fl.GeneralisedAlpha(),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
}


def flapping(speed: float, count: int, degree: int = 40) -> Array:
    """Flap frequencies for EI = rho A = L = 1 and W = speed, by Chebyshev collocation.

    L. N. Trefethen, *Spectral Methods in MATLAB* (2000), ch. 6 and 14.
    """
    x = np.cos(np.pi * np.arange(degree + 1) / degree)
    c = np.r_[2, np.ones(degree - 1), 2] * (-1.0) ** np.arange(degree + 1)
    gaps = x[:, np.newaxis] - x + np.eye(degree + 1)
    D = np.outer(c, 1 / c) / gaps
    D = 2 * (D - np.diag(D.sum(axis=1)))  # of s = (x + 1)/2; the tip comes first
    tension = 0.5 * speed**2 * (1 - (0.5 * (x + 1)) ** 2)
    A = np.linalg.matrix_power(D, 4) - D @ (tension[:, np.newaxis] * D)
    edges = np.array([0, 1, degree - 1, degree])
    inner = np.arange(2, degree - 1)
    ends = np.array([np.eye(degree + 1)[-1], D[-1], (D @ D)[0], (D @ D @ D)[0]])
    follow = -np.linalg.solve(ends[:, edges], ends[:, inner])
    squares = np.linalg.eigvals(A[np.ix_(inner, inner)] + A[np.ix_(inner, edges)] @ follow)
    real = squares.real[np.abs(squares.imag) < 1e-6 * np.abs(squares)]
    return np.asarray(np.sqrt(np.sort(real)[:count]))


def blade(elements: int) -> tuple[fl.Scene, fl.Beam]:
    """A slender steel beam along x, clamped at the origin."""
    scene = fl.Scene()
    section = fl.Section.rectangle(WIDTH, HEIGHT, STEEL)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=elements))
    scene.add(fl.Clamp(beam.start))
    return scene, beam


def campbell(elements: int, speeds: Array) -> tuple[Array, Array, fl.Modes]:
    """First six frequencies at each speed over the first lag frequency scale, and references."""
    scene, beam = blade(elements)
    D, mass = np.diag(beam.stiffness[0]), beam.density[0, 0, 0]
    flap, lag = (np.sqrt(D[k] / mass) / LENGTH**2 for k in (4, 5))
    found, expected = [], []
    for speed in speeds:
        spin = speed * lag
        modes = fl.vibrations(scene, 6, spin=(0, 0, spin))
        within = np.sqrt((lag * flapping(speed, 6)) ** 2 - spin**2)
        both = np.concatenate([flap * flapping(spin / flap, 6), within])
        found.append(modes.frequencies / lag)
        expected.append(np.sort(both)[:6] / lag)
    return np.array(found), np.array(expected), modes


def angle(time: float) -> float:
    """Of the hub."""
    if time > RISE:
        return SPIN * (time - RISE / 2)
    wave = 2 * np.pi / RISE
    return float(SPIN / RISE * (time**2 / 2 + (np.cos(wave * time) - 1) / wave**2))


def spin_up(elements: int, step: float, duration: float, scheme: Scheme) -> tuple[Array, Array]:
    """Times, and place of the tip less its first one in axes that turn with the hub, (T, 3)."""
    EA, GA, EI, rho_A, rho_I = 2.8e7, 1e7, 1.4e4, 1.2, 6e-4
    stiffness = [EA, GA, GA, EI, EI, EI]
    section = fl.Section.from_stiffness(stiffness, mass=rho_A, rotary=(rho_I, rho_I))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=elements))

    def hub(time: float) -> Array:
        return lie.se3_compose(
            lie.frame(np.zeros(3), lie.so3_exp([0.0, 0, angle(time)])), beam.frames[0]
        )

    scene.add(fl.PrescribedMotion(beam.start, hub))
    result = scheme.run(scene, duration=duration, step=step)
    turn = lie.so3_exp([[0.0, 0, angle(t)] for t in result.times])
    tip = np.einsum("tji,tj->ti", turn, result.position(beam.end))
    return result.times, tip - tip[0]


def main(
    elements: int = 16,
    fastest: float = 10.0,
    step: float = 0.025,
    duration: float = 20.0,
    pictures: bool = True,
) -> dict[str, Any]:
    speeds = np.linspace(0.0, fastest, 6)
    found, expected, modes = campbell(elements, speeds)
    print("frequencies over sqrt(EI/(rho A L^4)) of lag; W likewise\n    W   ", end="")
    print("  ".join(f"  mode {k}" for k in range(1, 7)), "  largest error")
    for speed, row, exact in zip(speeds, found, expected, strict=True):
        values = "  ".join(f"{value:8.4f}" for value in row)
        print(f"{speed:5.1f}  {values}   {np.abs(row / exact - 1).max():.1e}")
    found_tips = {
        name: spin_up(elements, step, duration, scheme) for name, scheme in SCHEMES.items()
    }
    times, tip = found_tips["generalised-alpha"]
    k = SPIN * LENGTH * np.sqrt(1.2 / 2.8e7)
    after = times > RISE + 1e-9
    record: dict[str, Any] = {
        "elements": elements,
        "fastest": fastest,
        "frequency_error": float(np.abs(found / expected - 1).max()),
        **{f"frequency_{k}": float(value) for k, value in enumerate(found[-1], start=1)},
        "largest_lag": float(-tip[:, 1].min()),
        "time_of_largest_lag": float(times[tip[:, 1].argmin()]),
        "final_swing": float(np.abs(tip[after, 1]).max()) if after.any() else 0.0,
        "extensions": {
            name: float(places[later > RISE + 1e-9, 0].mean()) if duration > RISE else 0.0
            for name, (later, places) in found_tips.items()
        },
        "extension_exact": float(LENGTH * (np.tan(k) / k - 1)),
    }
    print(
        f"\nspin-up: the tip lags by {record['largest_lag']:.4f} at "
        f"{record['time_of_largest_lag']:.2f} s and swings by {record['final_swing']:.1e} after "
        f"{RISE:g} s;\nextension then, closed form {record['extension_exact']:.4e}"
    )
    for name, extension in record["extensions"].items():
        print(f"    {name:18} {extension:.4e}")
    if pictures:
        draw(speeds, found, modes, times, tip)
    return record


def draw(speeds: Array, found: Array, modes: fl.Modes, times: Array, tip: Array) -> None:
    """Campbell diagram, path of the tip, and the third mode at the highest speed."""
    RESULTS.mkdir(exist_ok=True)
    figure = Figure(figsize=(9.0, 4.0), dpi=150, layout="constrained")
    left, right = figure.subplots(1, 2)
    fine = np.linspace(speeds[0], speeds[-1], 60)
    ratio = HEIGHT / WIDTH  # of flap to lag
    lag = np.array([np.sqrt(flapping(w, 4) ** 2 - w**2) for w in fine])
    flap = np.array([ratio * flapping(w / ratio, 4) for w in fine])
    left.plot(fine, lag, color=COLOURS[0])
    left.plot(fine, flap, color=COLOURS[1])
    left.plot(speeds, found, "o", color="black", markersize=4)
    left.plot([], [], color=COLOURS[0], label="lag, collocation")
    left.plot([], [], color=COLOURS[1], label="flap, collocation")
    left.plot([], [], "o", color="black", markersize=4, label="vibrations()")
    left.plot(fine, fine, ":", color="#777777", label="once per turn")
    left.set(xlabel="angular velocity", ylabel="frequency", title="Campbell diagram")
    left.set_ylim(0.0, 1.08 * found.max())
    left.legend(frameon=False, loc="center left", bbox_to_anchor=(0.0, 0.7))
    right.plot(times, tip[:, 1], color=COLOURS[0])
    right.set(xlabel="time [s]", ylabel="tip across the hub's axis [m]", title="Spin-up")
    for axes in (left, right):
        axes.grid(color="#DDDDDD", linewidth=0.6)
    diagram, motion = RESULTS / "rotating_beam.png", RESULTS / "rotating_beam_mode.gif"
    figure.savefig(diagram)
    modes.animate(motion, 3)
    print(f"pictures: {diagram}, {motion}")


if __name__ == "__main__":
    from command_line import run

    run(main)
