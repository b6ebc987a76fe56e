"""Set-up of a run of a conserving scheme: the state, and the constant model of the scene."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.balances import TOTAL
from fem_lie.forms.assembly import BodyTerm
from fem_lie.forms.cell_forms import FormArrays, each_cell, joined
from fem_lie.forms.cells import Cells
from fem_lie.forms.term import Term
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.node_types.inertia import director_inertia
from fem_lie.solve.conserving.midpoint.end_forces import EndForces
from fem_lie.solve.conserving.midpoint.products import inertia_with_products, product_weights
from fem_lie.solve.conserving.midpoint.reduced_bodies import packed_bodies
from fem_lie.solve.conserving.step.records import (
    ADDRESSES,
    COMMON,
    FILTER,
    IncidencePositions,
    Incidences,
    Masters,
    Model,
    Scheme,
    Segments,
    Span,
    State,
    Step,
)
from fem_lie.solve.conserving.step.series import DENSE, WHOLE
from fem_lie.solve.conserving.vector_cells.cell_arrays import VectorCells
from fem_lie.solve.conserving.vector_cells.force_changes import measure_cells
from fem_lie.solve.convergence import unknown_scaling
from fem_lie.system.equations import Equations
from fem_lie.system.nodes.masses import Loads

_LIGHT = 1e-12
"""Moments of inertia below this fraction of the largest one of a node are treated as zero."""


def start_state(
    equations: Equations,
    cells: Cells,
    vector_cells: VectorCells,
    incidences: Incidences,
    *,
    dissipates: bool,
) -> State:
    """State at rest at the initial frames."""
    z = np.zeros
    n, m = equations.unknowns.moving, equations.unknowns.m
    p, bodies = products_of(equations)
    count = cells.count + len(vector_cells.sees) + bodies
    return State(
        H=equations.start.frames.copy(),
        rest=z((n, 4, 3)),
        V=z((n + p, 4, 3)),
        multipliers=z(m),
        gap=z(m),
        F=z((cells.incidences, 6)),
        W=z(count),
        account=z(count),
        w=z((n + p, 4, 3)),
        w_F=z((cells.incidences, 6)),
        filter_state=FILTER(),
        last_residual=z((n, 6)),
        balance=z(TOTAL),
        trend=z((n, 6)),
        earlier=z((2, m)),
        sizes=z(3),
        border=z((2, len(incidences.nodes), 6)),
        slow=z((2 if dissipates else 0, 6 * n + m)),
        share=z(2),
        probe=np.cos(np.arange(6 * n + m)),
        cell_forces=z((2, len(vector_cells.nodes) if dissipates else 0, 2, 3)),
        rates=z((2, n, 6)),
        within=z(p if dissipates else 0),
    )


def step_workspace(
    equations: Equations,
    cells: Cells,
    vector_cells: VectorCells,
    incidences: Incidences,
    *,
    dissipates: bool,
) -> Step:
    """Allocate the arrays of a step."""
    z, (p, bodies) = np.zeros, products_of(equations)
    count = cells.count + len(vector_cells.sees) + bodies
    unknowns, frames = equations.unknowns, equations.start.frames
    n, m, total = unknowns.moving, unknowns.m, unknowns.total
    between = np.stack([*[frames] * 3, z(frames.shape)])
    return Step(
        step=z((n, 6)),
        coordinates=between,
        V1=z((n + p, 4, 3)),
        F1=z((cells.incidences, 6)),
        W1=z(count),
        work=z(count),
        change=z(m),
        losses=z(TOTAL),
        start=z((total, 4, 3)),
        nodes=z((4, total, 4, 3)),
        exact=z((total, 4, 3)),
        steps=z((total, 6)),
        twists=z((total, 6)),
        on_nodes=z((total, 6)),
        forces=z((n, 6)),
        q=z((2, n + p, 4, 3)),
        F_viscous=z((cells.incidences, 6)),
        r=z((5, 6 * n + m)),
        multipliers=z(m),
        filtered=z((3, total, 6)),
        border=z((2, len(incidences.nodes), 6)),
        sums=z((3, 3, 3, 3)),
        own=z((3, n + p, 4, 3)),
        turnings=z((2, 3 if dissipates else 0, 6 * n)),
        gains=z(cells.count),
        cell_forces=z((3, len(vector_cells.nodes) if dissipates else 0, 2, 3)),
        changes=z((2, n if dissipates else 0, 6)),
        outer=z((n, 6)),
        moved=z((n + p, 4, 3)) if p else Span(*between).delta[:n],
        products=z((p, 4, 3)),
        within=z((3, p)),
        common=z(COMMON),
    )


def has_vector_nodes(equations: Equations) -> bool:
    """Whether there are nodes with vector coordinates, on any rank."""
    return equations.shared.any(bool((equations.unknowns.kinds >= POSITION_GRADIENT).any()))


def products_of(equations: Equations) -> tuple[int, int]:
    """Number of modal coordinates (each has products with inertia), and of reduced-order bodies."""
    sizes = equations.arrays.floating.sizes
    return int(sizes.sum()), len(sizes)


def assemblies_of_frames(equations: Equations) -> list[tuple[slice, BodyTerm]]:
    """Assemblies of bodies whose nodes are frames with inertia of their own."""
    known = equations.arrays
    kinds = known.kinds[known.master]
    return [
        (at, term)
        for at, term in known.assemblies
        if kinds[at.start] < POSITION_GRADIENT and not term.within_frames
    ]


def vector_cells_of(equations: Equations) -> VectorCells:
    """Cells of all terms on nodes with vector coordinates, with their initial metric."""
    kinds = equations.arrays.kinds
    tables = [term.tables for term in equations.arrays.terms if not term.load]
    parts = [both for both in tables if both is not None]
    parts = [both for both in parts if (kinds[both[0].nodes] >= POSITION_GRADIENT).all()]
    forces, energy = (
        each_cell(FormArrays(*joined([both[k] for both in parts], [0] * len(parts))))
        for k in range(2)
    )
    count = len(forces.calls)
    cells = VectorCells(
        np.stack([forces.calls, energy.calls], axis=1),
        forces.first,
        forces.nodes,
        kinds[forces.nodes],
        np.zeros((len(forces.nodes), 2)),
        np.zeros(count, dtype=np.int64),
        np.zeros(count),
    )
    start = equations.start.frames
    measure_cells(cells, equations.unknowns.lengths, start, np.zeros_like(start))
    return cells


def end_forces_of(equations: Equations) -> EndForces:
    """Terms whose forces over a step are secants."""
    known, shared = equations.arrays, equations.shared
    return EndForces(known.terms, known.master, known.offset, equations.unknowns.moving, shared)


def incidences_of(equations: Equations, current_jacobian: bool) -> Incidences:
    """Incidences of all constraints.

    None if the constraint block of the frozen matrix is used as it is.
    """
    border = equations.matrix.incidences
    nodes, rows = (
        (border.nodes, border.rows) if current_jacobian else (border.nodes[:0], border.rows[:0])
    )
    return Incidences(nodes, rows.astype(np.int64))


def model_of(
    equations: Equations,
    cells: Cells,
    vector_cells: VectorCells,
    scheme: Scheme,
    incidences: Incidences,
) -> Model:
    """Constant arrays of the scene for steps."""
    known, unknowns = equations.arrays, equations.unknowns
    n, m = unknowns.moving, unknowns.m
    loads = Loads(*(array.copy() for array in known.loads))
    mass = inertia_with_products(known.inertia, known.floating)
    weights = product_weights(mass, n, known.floating.numbers[:3])
    owned = equations.shared.owned
    count = cells.count + len(vector_cells.sees) + products_of(equations)[1]
    return Model(
        cells=cells.table,
        joints=known.joints,
        inertia=mass,
        damping=known.damping,
        masters=Masters(
            known.master,
            known.offset,
            n == unknowns.total and not len(known.edges),
            known.edges,
        ),
        held=unknowns.held.astype(np.int64),
        measure=unknown_scaling(unknowns),
        scale=np.ones(m),
        loads=loads._replace(dead=np.concatenate([loads.dead, weights])),
        conservative=np.concatenate([known.conservative, weights]),
        pressure=segments_of(known.terms),
        viscous=any(term.viscosity is not None for _, term in assemblies_of_frames(equations)),
        scheme=scheme,
        probes=known.probes,
        driven=np.zeros(m),
        supported=(known.supported & owned[:, np.newaxis]).astype(np.int64),
        incidences=incidences,
        ends=incidence_positions_of(incidences, n, unknowns.size),
        kinds=known.kinds,
        arms=np.where(unknowns.lengths, 1.0, unknowns.length),
        vector_cells=vector_cells,
        of_frames=_of_frames(equations),
        addresses=np.zeros(ADDRESSES, dtype=np.int64),
        bodies=packed_bodies(known.floating),
        light=rotations_without_inertia(equations),
        owned=owned.astype(np.int64),
        vectors=has_vector_nodes(equations),
        total=int(equations.shared.total(np.array(count))),
        signs=_signs(equations),
    )


def _signs(equations: Equations) -> Array:
    """Signs of a perturbation that is no rigid motion, (6 n + m,), equal at copies of a node."""
    n, m = equations.unknowns.moving, equations.unknowns.m
    alternate = (-1.0) ** np.arange(6)
    of_nodes = (-1.0) ** ((np.arange(n + 1) + 1) // 2)
    nodes = of_nodes[:n, np.newaxis] * alternate
    equations.shared.take_from_owners(nodes)
    return np.append(nodes, of_nodes[n] * (-1.0) ** np.arange(m))


def rotations_without_inertia(equations: Equations) -> Array:
    """Projectors on the rotations of frames that have no inertia, (n, 3, 3), or (0, 3, 3)."""
    unknowns, mass = equations.unknowns, equations.arrays.inertia
    E = director_inertia(mass, unknowns.moving)
    E[unknowns.kinds >= POSITION_GRADIENT] = 0.0
    equations.shared.sum(E)
    J = np.trace(E, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3) - E
    held = unknowns.held[:, 3:] | (unknowns.kinds >= POSITION_GRADIENT)[:, np.newaxis]
    # fixed rotations count as having inertia
    size = np.maximum(np.abs(J).max(axis=(1, 2)), 1.0 * ~J.any(axis=(1, 2)))
    J[:, np.arange(3), np.arange(3)] += size[:, np.newaxis] * held
    moments, axes = np.linalg.eigh(J)
    light = moments <= _LIGHT * size[:, np.newaxis]
    found = np.einsum("nij,nj,nkj->nik", axes, light, axes)
    return np.ascontiguousarray(found) if light.any() else np.zeros((0, 3, 3))


def _of_frames(equations: Equations) -> Array:
    """Norm weights of unknowns of frames and of constraints between frames only, else zero."""
    unknowns, vectors = equations.unknowns, equations.arrays.kinds >= POSITION_GRADIENT
    incidences, touched = equations.matrix.incidences, np.zeros(unknowns.m, dtype=bool)
    touched[incidences.rows[vectors[incidences.nodes]]] = True
    return np.where(np.append(np.repeat(vectors, 6), touched), 0.0, unknown_scaling(unknowns))


def incidence_positions_of(incidences: Incidences, n: int, size: int) -> IncidencePositions:
    """Positions of the incidences of ``n`` nodes in the dense inverse.

    None if there are too many.
    """
    nodes, at_node = np.unique(incidences.nodes, return_inverse=True)
    rows, at_row = np.unique(incidences.constraints, return_inverse=True)
    count = 6 * len(nodes) + len(rows)
    if count > DENSE:
        none = np.zeros(0, np.int64), np.zeros((2, 0), np.int64)
        return IncidencePositions(*none, np.zeros((0, 0)), np.zeros((0, size)))
    own = 6 * nodes[:, None] + np.arange(6)
    unknowns = np.concatenate([own.ravel(), 6 * n + rows]).astype(np.int64)
    at = np.stack([6 * at_node, 6 * len(nodes) + at_row]).astype(np.int64)
    columns = np.zeros((count if count * size <= WHOLE else 0, size))
    return IncidencePositions(unknowns, at, np.zeros((count, count)), columns)


def segments_of(terms: Iterable[Term]) -> Segments:
    """All line segments under pressure, with the current pressure."""
    found = [term.pieces for term in terms if term.pieces is not None]
    return Segments(
        np.concatenate([np.zeros((0, 2), dtype=np.int64), *(part.nodes for part in found)]),
        np.concatenate([np.zeros((0, 3)), *(part.across for part in found)]),
    )
