"""Effectivity of error estimates on problems with known stress: cables, ANCF bodies, solids.

``tools/run python3 -m benchmarks.known_stresses [--case cable …]``

- ``cable``, ``ancf_beam``: a cantilever under a dead force at its tip, whose force is constant in
  space; ``M' = −(1 + N/EA) Q + N Q/GA`` is solved as a boundary-value problem to 1e-10.
- ``ancf_shell``, ``thin_shell``: a square plate between planes of symmetry under ``q cos πx cos
  πy``, on a mesh of curved lines: ``M₁₁ = M₂₂ = (1 + ν) q cos πx cos πy / 4π²`` and so on.
- ``solid``: a cube, clamped all around, under the body force of ``u ~ sin πx sin πy sin πz``, on
  skew cells.
- ``tube``: a thick Neo-Hookean tube in plane strain under pressure, inflated to 1.88 times its
  inner radius; ``P' + (P − P_θ)/R = 0`` is solved to 1e-10.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_bvp

import fem_lie as fl
from fem_lie._arrays import Array
from fem_lie.adaptivity.estimates.recovery import fields_of
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.shapes import rule, tabulated

RECOVERY = fl.adaptivity.RecoveryEstimate()


class Row(NamedTuple):
    """Errors on one mesh.

    Attributes:
        problem: Name of the problem and the element.
        cells: Number of cells along a side.
        error: True error over the norm of the stress.
        effectivity: Estimated over true error.
    """

    problem: str
    cells: int
    error: float
    effectivity: float


def _row(problem: str, cells: int, scene: fl.Scene, stress: Callable[[Any, Array], Array]) -> Row:
    """Errors, with the true stress (m, q, b) as a function of the body and the stress found."""
    result = fl.statics(scene, load_steps=4)
    (body,) = scene.bodies
    (fields,) = fields_of(result, body, scene)
    true = stress(body, fields.own)
    error = np.sqrt(fields.energy(true - fields.own).sum())
    found = fl.adaptivity.space_error(result, body, scene, estimate=RECOVERY)
    norm = np.sqrt(fields.energy(true).sum())
    return Row(problem, cells, float(error / norm), found.effectivity(float(error)))


# --- lines ----------------------------------------------------------------------------------------

LENGTH, EA, GA, EI = 2.0, 1e7, 5e6, 1e2
TIP = {"large bending": (0.0, 150.0), "tension and bending": (300.0, 40.0)}
LINES = {"cable": (fl.Cable, np.inf), "ancf_beam": (fl.AncfBeam, GA)}


def _cantilever(force: tuple[float, float], shear: float) -> Callable[[Array], Array]:
    """Axial force, shear force and moment (3, n) at arc lengths (n,), in the plane."""

    def forces(angle: Array) -> tuple[Array, Array]:
        c, s = np.cos(angle), np.sin(angle)
        return force[0] * c + force[1] * s, force[1] * c - force[0] * s

    def rates(_: Array, y: Array) -> Array:
        N, Q = forces(y[0])
        return np.array([y[1] / EI, -(1.0 + N / EA) * Q + N * Q / shear])

    s = np.linspace(0.0, LENGTH, 400)
    ends = lambda a, b: np.array([a[0], b[1]])  # noqa: E731
    solved = solve_bvp(rates, ends, s, np.zeros((2, len(s))), tol=1e-10, max_nodes=100_000)

    def resultants(at: Array) -> Array:
        angle, moment = solved.sol(at)
        return np.array([*forces(angle), moment])

    return resultants


def line(kind: str, problem: str, cells: int) -> Row:
    """A cantilever of one kind under one of the forces."""
    body, shear = LINES[kind]
    section = fl.Section.from_stiffness([EA, GA, GA, EI, EI, EI])
    scene = fl.Scene()
    own = scene.add(body.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=cells))
    own.clamp(own.point("start"))
    a, b = TIP[problem]
    scene.add(fl.PointLoad(own.point("end"), force=(a, 0.0, b)))
    exact = _cantilever((a, b), shear)

    def stress(_: Any, found: Array) -> Array:
        x, _ = np.polynomial.legendre.leggauss(found.shape[1])
        at = (np.arange(cells)[:, np.newaxis] + 0.5 * (1 + x)) * LENGTH / cells
        N, Q, M = exact(at.ravel()).reshape(3, *at.shape)
        true = np.zeros_like(found)
        # in the plane of x and z, moments are about −y
        true[..., 0], true[..., 2 if kind == "cable" else 4] = N, -M
        if kind == "ancf_beam":
            true[..., 2] = Q
        return true

    return _row(f"{kind}, {problem}", cells, scene, stress)


# --- plates ---------------------------------------------------------------------------------------

PLATE, PRESSURE = fl.ShellSection.layer(0.02, fl.Material(1e6, 0.3, 1.0)), 1e-5
PLATES = {"ancf_shell": fl.AncfShell, "thin_shell": fl.ThinShell}


def plate(kind: str, cells: int, skew: float = 0.1) -> Row:
    """A plate of one kind."""

    def position(a: float, b: float) -> tuple[float, float, float]:
        (s, t), (c, d) = np.sin(np.pi * np.array([a, b])), np.cos(np.pi * np.array([a, b]))
        return a + skew * s * d, b + skew * t * c, 0.0

    patch = fl.mesh.smooth_patch(position, (cells, cells))
    shell = PLATES[kind](patch, PLATE, along=(1, 0, 0))
    for k, normal in enumerate(np.eye(3)[:2]):
        for end in range(2):
            shell.symmetry(f"{'ab'[k]}={end}", normal)
    shell.roller("00", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)

    def load(x: Array) -> tuple[float, float, float]:
        return 0.0, 0.0, PRESSURE * float(np.cos(np.pi * x[:2]).prod())

    scene.add(fl.AreaLoad(shell, load))

    def stress(shell: Any, found: Array) -> Array:
        at, _ = hermite.gauss(round(found.shape[1] ** 0.5))
        table = type(shell.model).table(hermite.products(at, at))[:, 0]
        x = np.pi * np.einsum("ga,maj->mgj", table, shell.model.hermite_vectors())[..., :2]
        (c, d), (s, t) = np.moveaxis(np.cos(x), -1, 0), np.moveaxis(np.sin(x), -1, 0)
        q, nu = PRESSURE / (4 * np.pi**2), 0.3
        true = np.zeros_like(found)
        true[..., 3] = true[..., 4] = (1 + nu) * q * c * d
        true[..., 5] = -(1 - nu) * q * s * t
        if found.shape[2] > 6:
            true[..., 6] = -2 * np.pi * q * s * d
            true[..., 7] = -2 * np.pi * q * c * t
        # moments bend towards the normal or away from it, by convention
        return np.asarray(true * np.sign((true * found)[..., 3].sum()))

    return _row(kind, cells, scene, stress)


# --- solids ---------------------------------------------------------------------------------------

E, NU, SMALL, DIRECTION = 1.0, 0.3, 1e-6, np.array([1.0, 0.5, -0.7])
LAME, SHEAR = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
PAIRS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)


def _positions(solid: fl.Solid) -> Array:
    """Unloaded positions of the points of the estimate, shape (m, q, 3)."""
    model = solid.model
    points, _ = rule(model.mesh.cell, 2 * model.degree + 1)
    shapes = tabulated(model.mesh.cell, model.degree, points)[0]
    return np.asarray(shapes @ model.positions[model.connectivity])


def solid(cell: str, degree: int, cells: int) -> Row:
    """A cube of cells of one kind."""

    def position(a: float, b: float, c: float) -> tuple[float, float, float]:
        s, t, u = np.sin(np.pi * np.array([a, b, c]))
        return a + 0.05 * s * u * (b - 0.3), b + 0.1 * t * (c - 0.4), c + 0.07 * u * a

    mesh = fl.mesh.parametric_volume(position, (cells,) * 3, cell=cell)
    cube = fl.Solid(mesh, fl.sections.SaintVenantKirchhoff(E, NU), degree=degree)
    for face in ("a=0", "a=1", "b=0", "b=1", "c=0", "c=1"):
        cube.clamp(face)
    scene = fl.Scene()
    scene.add(cube)

    def load(x: Array) -> Array:
        s, c = np.sin(np.pi * x), np.cos(np.pi * x)
        H = -np.eye(3) * s.prod()
        for i, j, k in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            H[i, j] = H[j, i] = c[i] * c[j] * s[k]
        force = (LAME + SHEAR) * H @ DIRECTION + SHEAR * np.trace(H) * DIRECTION
        return np.asarray(-SMALL * np.pi**2 * force)

    scene.add(fl.loads.BulkLoad(cube, load))

    def stress(solid: Any, _: Array) -> Array:
        x = np.pi * _positions(solid)
        s, c = np.sin(x), np.cos(x)
        slopes = [c[..., i] * np.delete(s, i, axis=-1).prod(axis=-1) for i in range(3)]
        G = SMALL * np.pi * np.einsum("i,jmq->mqij", DIRECTION, np.array(slopes))
        strain = 0.5 * (G + G.swapaxes(-1, -2))
        trace = np.trace(strain, axis1=-2, axis2=-1)[..., np.newaxis, np.newaxis]
        true = LAME * trace * np.eye(3) + 2 * SHEAR * strain
        return np.stack([true[..., i, j] for i, j in PAIRS], axis=-1)

    return _row(f"{cell} {degree}, cube", cells, scene, stress)


INNER, OUTER, INFLATION = 1.0, 2.0, 0.2


def _nominal(a: Array, b: Array) -> Array:
    """Nominal stress along the stretch ``a``, with ``b`` at right angles and 1 along the tube."""
    return SHEAR * (a - 1 / a) + LAME * np.log(a * b) / a


def _inflated() -> Callable[[Array], Array]:
    """Stretches along the radius and around (2, …) at unloaded radii, of plane strain."""

    def rates(R: Array, y: Array) -> Array:
        r, a = y
        b = r / R
        slope = SHEAR * (1 + 1 / a**2) + LAME * (1 - np.log(a * b)) / a**2
        balance = (_nominal(a, b) - _nominal(b, a)) / R + LAME / (a * b) * (a - b) / R
        return np.array([a, -balance / slope])

    def ends(y: Array, z: Array) -> Array:
        inner = _nominal(y[1], y[0] / INNER) + INFLATION * y[0] / INNER
        return np.array([inner, _nominal(z[1], z[0] / OUTER)])

    R = np.linspace(INNER, OUTER, 200)
    solved = solve_bvp(rates, ends, R, np.array([R, np.ones_like(R)]), tol=1e-10)

    def stretches(radius: Array) -> Array:
        r, a = solved.sol(radius)
        return np.array([a, r / radius])

    return stretches


def tube(cells: int) -> Row:
    """A quarter of the tube."""

    def position(r: float, angle: float, c: float) -> tuple[float, float, float]:
        radius, turn = INNER + (OUTER - INNER) * r, 0.5 * np.pi * angle
        return radius * np.cos(turn), radius * np.sin(turn), 0.1 * c

    mesh = fl.mesh.parametric_volume(position, (cells, 8 * cells // 5, 1))
    rubber = fl.Solid(mesh, fl.sections.NeoHooke(E, NU))
    for face, normal in zip(("b=1", "b=0", "c=0", "c=1"), np.eye(3)[[0, 1, 2, 2]], strict=True):
        rubber.roller(face, normal)
    scene = fl.Scene()
    scene.add(rubber)
    scene.add(fl.loads.FacePressure(rubber, "a=0", INFLATION))
    exact = _inflated()

    def stress(solid: Any, found: Array) -> Array:
        x = _positions(solid)
        radius = np.hypot(x[..., 0], x[..., 1])
        c, s = x[..., 0] / radius, x[..., 1] / radius
        # straight edges of cells are within the inner radius
        a, b = exact(np.clip(radius, INNER, OUTER))
        along, around = _nominal(a, b) / a, _nominal(b, a) / b
        true = np.zeros_like(found)
        true[..., 0] = along * c * c + around * s * s
        true[..., 1] = along * s * s + around * c * c
        true[..., 2] = LAME * np.log(a * b)
        true[..., 3] = (along - around) * c * s
        return true

    return _row("hexahedron 1, tube", cells, scene, stress)


# --- tables ---------------------------------------------------------------------------------------

SOLIDS = {
    ("hexahedron", 1): (4, 8, 12),
    ("hexahedron", 2): (2, 4, 6),
    ("tetrahedron", 1): (4, 8, 12),
    ("tetrahedron", 2): (2, 4, 6),
}
CASES = (*LINES, *PLATES, "solid", "tube")


def rows(case: str) -> Iterator[Row]:
    """All rows of a case."""
    if case in LINES:
        yield from (line(case, problem, n) for problem in TIP for n in (4, 8, 16, 32))
    elif case in PLATES:
        yield from (plate(case, n) for n in (4, 8, 16))
    elif case == "solid":
        yield from (solid(*kind, n) for kind, counts in SOLIDS.items() for n in counts)
    else:
        yield from (tube(n) for n in (5, 10, 20))


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", nargs="+", choices=CASES, default=CASES, metavar="CASE")
    print("| problem | cells | true error | effectivity |\n| --- | --- | --- | --- |")
    for case in parser.parse_args().case:
        for row in rows(case):
            print(
                f"| {row.problem} | {row.cells} | {100 * row.error:.3g} % | {row.effectivity:.2f} |"
            )


if __name__ == "__main__":
    main()
