"""What impulses of contacts did in a step: energy, work, and what ground gave."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import uncounted
from fem_lie.contact.impact.records import FRICTION, GROUND, IMPACT, Masses, Work
from fem_lie.contact.impact.sweeps import along
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import cross, dot, load, load_row, plus, rotate_back, scaled


@uncounted
def energy(masses: Masses, H: Array, v: Array) -> float:
    """Kinetic, and that of constant forces."""
    total = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        total += 0.5 * masses.mass[body] * dot(u, u)
        for i in range(3):
            for j in range(3):
                total += 0.5 * ω[i] * masses.J[body, i, j] * ω[j]
        total -= dot(load(masses.force[body], 0), load_row(H[body], 0))
    return total


@uncounted
def note_works(w: Work, k: int, v: Array, told: Array) -> None:
    """Work of normal impulses and of friction, by the mean velocities of their rows."""
    problem = w.cones
    told[IMPACT], told[FRICTION] = 0.0, 0.0
    for i in range(k):
        for j in range(3):
            mean = along(problem.rows[i], problem.bodies[i], v, j)
            mean = 0.5 * (mean + along(problem.rows[i], problem.bodies[i], w.v, j))
            told[IMPACT if j == 0 else FRICTION] += mean * problem.r[i, j]


@uncounted
def note_ground(masses: Masses, w: Work, k: int, told: Array) -> None:
    """Impulses of ground on bodies, and their moments about the origin."""
    problem = w.cones
    told[GROUND:] = 0.0
    for i in range(k):
        side = 0 if problem.bodies[i, 1] < 0 else 1
        if problem.bodies[i, 1 - side] >= 0:
            continue
        body, impulse, turning = problem.bodies[i, side], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(3):
            given = problem.pushes[i, side, j]
            impulse = plus(impulse, scaled(problem.r[i, j] * masses.mass[body], load(given, 0)))
            turning = plus(turning, scaled(problem.r[i, j], load(given, 3)))
        J, H = masses.J[body], w.H[1, body]
        local = rotate_back(load_row(J, 0), load_row(J, 1), load_row(J, 2), turning)
        moment = plus(cross(load_row(H, 0), impulse), global_components(H, local))
        for j in range(3):
            told[GROUND + j] += impulse[j]
            told[GROUND + 3 + j] += moment[j]
