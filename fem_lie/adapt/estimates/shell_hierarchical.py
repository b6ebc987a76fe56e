"""Hierarchical errors of shells: each cell as four of its kind, with those nodes that are new."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse.linalg
from scipy.sparse import bsr_matrix

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.adapt.estimates.cut.cut_shells import Cut, areas_of, on_new_nodes, shapes_of_parts
from fem_lie.adapt.estimates.estimate import ElementErrors
from fem_lie.bodies.shells.assembly import ShellAssembly
from fem_lie.bodies.shells.placing import frames_with
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.shapes import tabulated
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.nodal_values import extrapolation, unit
from fem_lie.results.stresses.shell_stress import ShellStress, integration
from fem_lie.scene import Scene

_FIVE = 5
_ITERATIONS = 6
_SETTLED = 1e-4  # of the first correction
_NOTHING = 1e-11  # of the model, or rad
_FINER = 4.0 / 3.0  # the square of the whole error, over the part that halved cells have less


def shell_hierarchical(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the balance of all nodes that are new when each cell is cut in four.

    Nodes of the mesh stay, new ones go to where forces balance with what acts on them (R. E. Bank &
    R. K. Smith, SIAM J. Numer. Anal. 30 (1993) 921): one sparse system for all of them. What acts
    on them is taken from the forces on the nodes that there are, per area within and per length at
    borders, and a single force stays with its node. An element of first order loses half of its
    error so, and ``η² = 4/3 ∫ (σ_fine − σ)·D⁻¹(σ_fine − σ)``.

    Raises:
        ValueError: The cells have nodes besides their corners; the shell is not in that result, or
            there is no such step.
    """
    if shell.mesh.degree != 1:
        raise ValueError(
            f"hierarchical errors are for cells of degree 1, those of {shell.label} are of degree "
            f"{shell.mesh.degree}: take Recovery()"
        )
    nodes, cut = nodes_in(result.info, shell), Cut.of(shell)
    return [_errors(cut, result.frames[step][nodes]) for step in steps]


def _errors(cut: Cut, frames: Array) -> ElementErrors:
    shell = cut.shell
    fine, stress = ShellStress.of(cut.fine), ShellStress.of(shell)
    own, moved = stress(frames), _settled(cut, frames)
    rule, _ = integration(shell)
    inside = _at_parts(shell, rule) @ own[:, np.newaxis]  # (m, 4, g, 8)
    missed = fine(moved).reshape(inside.shape) - inside

    def energy(values: Array) -> Array:
        return np.asarray(np.einsum("m...gi,mij,m...gj->m...g", values, stress.compliance, values))

    areas = areas_of(cut.fine).reshape(inside.shape[:3])
    squares = _FINER * (energy(missed) * areas).sum(axis=(1, 2))
    return ElementErrors(squares, float((energy(own) * areas_of(shell)).sum()))


def _at_parts(shell: Shell, rule: Array) -> Array:
    """From values at the points of integration to those of each part, shape (4, g, g)."""
    mesh = shell.own_mesh
    corners = extrapolation(mesh, rule)
    places = tabulated(mesh.cell, 1, rule)[0]
    return np.asarray(places @ shapes_of_parts(mesh.cell) @ corners)


# --- balance of the new nodes ---


def _settled(cut: Cut, frames: Array) -> Array:
    """Frames of all nodes of the fine shell, new ones where forces balance: Newton's method."""
    H, n = _between(cut, frames), len(frames)
    assembly = ShellAssembly([cut.fine])
    acting = on_new_nodes(cut, frames)
    free = n + np.flatnonzero(~cut.held)
    lengths, first = np.repeat([cut.shell.size, 1.0], 3), 0.0
    for _ in range(_ITERATIONS):
        K, r = _balance(assembly, H)
        rows = (6 * free[:, np.newaxis] + np.arange(_FIVE)).ravel()
        wrench = _local(H[free], acting[free - n])[:, :_FIVE]
        rest = r[free, :_FIVE] - wrench
        solve = scipy.sparse.linalg.splu(K[rows][:, rows].tocsc(), permc_spec="MMD_AT_PLUS_A")
        step = np.zeros((len(free), 6))
        step[:, :_FIVE] = -solve.solve(rest.ravel()).reshape(-1, _FIVE)
        H[free] = lie.se3_retract(H[free], step)
        size = float(np.abs(step / lengths).max(initial=0.0))
        first = first or size
        if size <= max(_SETTLED * first, _NOTHING):
            return H
    raise RuntimeError(
        f"the nodes that are new in {cut.shell.label} did not settle in {_ITERATIONS} rounds: the "
        f"last correction is {size / first:.1e} of the first"
    )


def _balance(assembly: ShellAssembly, H: Array) -> tuple[bsr_matrix, Array]:
    """Tangent and forces (N, 6) at frames, as the nodes of the shell are numbered."""
    order = assembly.order
    rows = np.empty_like(H)
    rows[order] = H
    assembly.reset_stress(rows)
    forces, kept = assembly.room(), assembly.room()
    assembly.add_forces(rows, forces, kept)
    blocks = assembly.tangent(rows, kept)
    N = len(H)
    K = bsr_matrix((blocks, assembly.indices, assembly.indptr), shape=(6 * N, 6 * N)).tocsr()
    own = (6 * order[:, np.newaxis] + np.arange(6)).ravel()
    return K[own][:, own], forces[order]


def _between(cut: Cut, frames: Array) -> Array:
    """Frames of all nodes, new ones as a bent edge has them between its ends.

    Edges whose directors turn towards each other bulge, so that none of them is sheared.
    """
    shell = cut.shell
    a, b = frames[cut.ends[:, 0]], frames[cut.ends[:, 1]]
    places, directors = _bulged(a, b)
    unloaded, _ = _bulged(shell.frames[cut.ends[:, 0]], shell.frames[cut.ends[:, 1]])
    n, edges = len(frames), len(cut.ends)
    x0, up = cut.fine.frames[n : n + edges, 0], directors
    height = (
        places
        - np.einsum("ej,ej->e", unloaded - x0, cut.fine.frames[n : n + edges, 3])[:, np.newaxis]
        * up
    )
    found = [frames, frames_with(height, up)]
    if len(cut.fine.frames) > n + edges:
        corners = frames[shell.own_mesh.cells]
        ends = frames[cut.ends, 0].mean(axis=1)
        bulge = (height - ends)[cut.sides].sum(axis=1) / 2.0
        found.append(
            frames_with(corners[:, :, 0].mean(axis=1) + bulge, unit(corners[:, :, 3].sum(axis=1)))
        )
    return np.concatenate(found)


def _bulged(a: Array, b: Array) -> tuple[Array, Array]:
    """Places and directors in the middle of edges between frames."""
    up, along = unit(a[:, 3] + b[:, 3]), b[:, 0] - a[:, 0]
    turn = np.einsum("ej,ej->e", b[:, 3] - a[:, 3], along) / 8.0
    return 0.5 * (a[:, 0] + b[:, 0]) + turn[:, np.newaxis] * up, up


def _local(H: Array, wrench: Array) -> Array:
    pair = wrench.reshape(-1, 2, 3)
    return np.asarray(np.einsum("npj,nij->npi", pair, H[:, 1:]).reshape(-1, 6))
