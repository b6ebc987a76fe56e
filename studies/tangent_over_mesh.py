"""The tangent of bodies in local frames tends to a constant as their mesh becomes finer.

A strip of length 1, initially straight, is bent to an arc of 180 degrees without stretch, shear and
twist. In the axes of the nodes an element sees only the relative motion of its own nodes, by an
angle of ``π/n`` with n cells. Its tangent differs from that of the straight strip by a part that
falls with 1/n; in fixed axes it rotates with the strip, whatever the mesh. ``local`` and ``fixed``
are Frobenius norms of the difference over that of the straight tangent.

``rate`` is the spectral radius of ``1 − S₀⁻¹S₁`` in local axes, the convergence rate on the arc
with the frozen matrix ``S = 4 M/h² + K`` of the straight strip. It does not fall: stretch and
bending are coupled in an arch, whatever the mesh, and solutions see the soft motions of a matrix,
while norms see the stiff ones. A frozen matrix therefore serves as long as steps resolve the
motions whose stiffness changes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp

import fem_lie as fl
from demos.command_line import run

LENGTH, WIDTH, THICKNESS = 1.0, 0.1, 0.02
MATERIAL = fl.Material(E=1e9, nu=0.3, density=1000.0)
ANGLE = np.pi
COUNTS = (8, 16, 32, 64)
STEPS = {"rate_long": 1e-3, "rate_short": 1e-5}


def beam(formulation: fl.elements.BeamFormulation) -> Callable[[int], fl.Beam]:
    """Straight beams of one element type."""
    section = fl.Section.rectangle(WIDTH, THICKNESS, MATERIAL)
    ends = (0, 0, 0), (LENGTH, 0, 0)
    return lambda cells: fl.Beam.straight(
        *ends, section, cells=cells, up=(0, 0, 1), formulation=formulation
    )


def shell(formulation: Any) -> Callable[[int], fl.Shell]:
    """Flat strips of shells of one element type."""
    layer = fl.ShellSection.layer(THICKNESS, MATERIAL)
    return lambda cells: fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (LENGTH * a, WIDTH * b, 0), (cells, 1)),
        layer,
        formulation=formulation,
    )


BODIES: dict[str, Callable[[int], fl.extend.Body]] = {
    "geodesic_beam": beam(fl.elements.GeodesicBeam()),
    "director_beam": beam(fl.elements.DirectorBeam()),
    "director_beam_2": beam(fl.elements.DirectorBeam(2)),
    "shell": shell(fl.elements.HellingerReissner()),
    "geodesic_shell": shell(fl.elements.GeodesicShell()),
}


def bent(frames: np.ndarray, angle: float) -> np.ndarray:
    """Frames of a strip along the first axis, shape (n, 4, 3), bent about the second one."""
    if angle == 0.0:
        return frames.copy()
    radius, θ = LENGTH / angle, angle * frames[:, 0, 0] / LENGTH
    c, s, none = np.cos(θ), np.sin(θ), np.zeros_like(θ)
    R = np.stack([[c, none, -s], [none, none + 1, none], [s, none, c]]).transpose(2, 0, 1)
    out = np.einsum("nij,nkj->nki", R, frames)
    out[:, 0] = np.stack([radius * s, frames[:, 0, 1], radius * (1 - c)], axis=1)
    return out


class Strip:
    """Matrices of a strip bent by an angle, of all unknowns; zero where these are held."""

    def __init__(self, make: Callable[[int], fl.extend.Body], cells: int, angle: float) -> None:
        """Bend the strip."""
        scene = fl.Scene()
        scene.add(make(cells))
        self.equations = fl.extend.Equations(scene, dynamics=True)
        n, start = self.equations.unknowns.moving, self.equations.start.frames
        self.still, self.frames = np.zeros((n, 6)), start.copy()
        self.frames[:n] = bent(start[:n], angle)
        self.free = ~self.equations.matrix.held.ravel()
        # from the nodes' axes to those of the start
        axes = np.einsum("nkj,nlj->nkl", self.frames[:n, 1:], start[:n, 1:])
        self.to_fixed = sp.block_diag([R.T for R in axes for _ in range(2)])

    def matrix(self, mass: float = 0.0) -> sp.csr_matrix:
        """Tangent stiffness, with the mass matrix times a factor."""
        state = fl.extend.TimeState(self.frames, self.still, self.still, np.zeros(0))
        plan = fl.extend.Plan(self.still, mass=mass, stressed=self.frames)
        self.equations.fill(state, None, plan)
        values, columns, pointers = self.equations.matrix.csr
        mask = sp.diags(self.free.astype(float))
        return (mask @ sp.csr_matrix((values, columns, pointers)) @ mask).tocsr()

    def solved(self, step: float) -> np.ndarray:
        """Matrix of a time step, of the free unknowns, dense."""
        return self.matrix(4.0 / step**2)[self.free][:, self.free].toarray()


def _norm(K: sp.csr_matrix) -> float:
    """Frobenius norm."""
    return float(np.sqrt(K.multiply(K).sum()))


def compared(make: Callable[[int], fl.extend.Body], cells: int) -> dict[str, float]:
    """Change of the tangent from the straight strip to the arc."""
    straight, arc = (Strip(make, cells, angle) for angle in (0.0, ANGLE))
    K0, K1 = straight.matrix(), arc.matrix()
    size, fixed = _norm(K0), arc.to_fixed @ K1 @ arc.to_fixed.T
    row = {
        "local": _norm(K1 - K0) / size,
        "fixed": _norm(fixed - K0) / size,
    }
    for name, step in STEPS.items():
        S0, S1 = straight.solved(step), arc.solved(step)
        row[name] = float(np.abs(np.linalg.eigvals(np.linalg.solve(S0, S1 - S0))).max())
    return row


def main() -> dict[str, Any]:
    """Changes by body and number of cells."""
    return {
        name: {
            f"{what}_{cells}": value
            for cells in COUNTS
            for what, value in compared(make, cells).items()
        }
        for name, make in BODIES.items()
    }


if __name__ == "__main__":
    run(main, show=True)
