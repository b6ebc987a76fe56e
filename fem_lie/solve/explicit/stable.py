"""Lumped inertia of nodes, and the largest stable step of explicit schemes.

With the stiffness ``K`` as a sum over cells of ``k`` nodes, and ``x·K_e x ≤ k Σ_i x_i·K_e,ii x_i``
for each cell with a positive semidefinite stiffness, no squared frequency exceeds the largest
eigenvalue of::

    M_i⁻¹ Σ_e k K_e,ii

over all nodes, with the sum over the cells around a node. For equal bars in a row, and nets of
them, this is the largest frequency itself. Steps are stable up to ``2/ω``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.term import Term
from fem_lie.lie.node_types import MIXED_DERIVATIVE, POSITION, POSITION_GRADIENT
from fem_lie.solve.explicit.nodes import AXIAL, DIRECTOR, FRAME, STILL, STRAIGHT, Masses
from fem_lie.solve.motion.integrator import refuse
from fem_lie.system.equations import Equations

_NODES = 2
"""Column of packed forms with the number of nodes of a cell."""
_FEW, _MANY = 2, 4
"""Number of nodes of springs and contacts, and default for other cells."""
_NEGLIGIBLE = 1e-10
_WITHOUT = 0, 0, 0, 1, 2
"""Number of axes about which a node that moves in each way needs no rotary inertia."""


class StableStep(NamedTuple):
    """Largest stable step.

    Attributes:
        step: Its size.
        node: Node whose surrounding cells are the stiffest for their mass; −1 on a rank without it.
    """

    step: float
    node: int


def masses_of(equations: Equations) -> Masses:
    """Lumped inertia of the nodes; ``ValueError`` names unsupported ones."""
    kinds, held = equations.unknowns.kinds, equations.unknowns.held
    G = _of_all_ranks(equations, equations.arrays.inertia.blocks)
    n = len(kinds)
    m, s, E = G[:, 0, 0], G[:, 0, 1:], G[:, 1:, 1:]
    straight, still = kinds >= POSITION_GRADIENT, held.all(axis=1)
    weights = np.where(straight[:, np.newaxis], _of_vectors(kinds, G), 1.0)
    weights[~straight, 0], weights[kinds == POSITION, 1] = m[~straight], 1.0
    centre = np.where(straight[:, np.newaxis], 0.0, s / np.where(m > 0, m, 1.0)[:, np.newaxis])
    about = E - np.einsum("n,na,nb->nab", m, centre, centre)
    J = np.trace(about, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3) - about
    J[straight] = 0.0
    director = ~straight & held[:, 5] & ~held[:, 3] & ~held[:, 4]
    J[director, 2], J[director, :, 2] = 0.0, 0.0
    axial = ~straight & held[:, 4] & held[:, 5] & ~held[:, 3]
    J[axial, 1:], J[axial, :, 1:] = 0.0, 0.0
    turning = np.where(director, DIRECTOR, np.where(axial, AXIAL, FRAME))
    ways = np.where(straight, STRAIGHT, turning)
    ways[still] = STILL
    with equations.shared.errors(ValueError):
        _check_masses(equations, ways, weights, J)
    inverse, free = np.zeros_like(J), _turns(ways, held)
    whole = free & (ways == FRAME)
    inverse[whole] = np.linalg.inv(J[whole])
    inverse[director, 0, 0] = inverse[director, 1, 1] = 1.0 / J[director, 0, 0]
    inverse[axial, 0, 0] = 1.0 / J[axial, 0, 0]
    ones = np.zeros((n, 2)) + np.where(ways[:, np.newaxis] == STILL, 1.0, weights)
    known = equations.arrays
    first, second = known.edges.T
    edges = np.ascontiguousarray(np.column_stack([known.master[first], known.master[second]]))
    ends = np.ascontiguousarray(known.offset[second, 0])
    centre = np.ascontiguousarray(centre)
    return Masses(kinds, ways.astype(np.int64), ones, centre, J, inverse, edges, ends)


def _of_all_ranks(equations: Equations, blocks: Array) -> Array:
    """Blocks of nodes (n, 4, 4), with those of all ranks added at shared nodes."""
    found = np.zeros((len(equations.unknowns.kinds), 4, 4))
    found[: len(blocks)] = blocks
    equations.shared.sum(found)
    return found


def _of_vectors(kinds: Indices, G: Array) -> Array:
    """Diagonal of blocks (n, 4, 4) in the rows of both coordinate vectors, (n, 2)."""
    diagonal = G.diagonal(axis1=1, axis2=2)
    return np.where((kinds >= MIXED_DERIVATIVE)[:, np.newaxis], diagonal[:, 1:3], diagonal[:, :2])


def damping_rates(equations: Equations, masses: Masses) -> Array:
    """Decay rates of the momenta of each node by mass damping, (n, 2); (0, 2) without.

    Raises:
        ValueError: Damping of a frame is not proportional to its inertia.
    """
    D, inertia = equations.arrays.damping, equations.arrays.inertia
    if not equations.shared.any(len(D.indptr) > 0):
        return np.zeros((0, 2))
    n, (D_own, G) = len(masses.kinds), (_of_all_ranks(equations, of.blocks) for of in (D, inertia))
    rates = np.zeros((n, 2))
    straight = masses.ways == STRAIGHT
    damped, mass = (_of_vectors(masses.kinds, blocks) for blocks in (D_own, G))
    np.divide(damped, mass, out=rates, where=mass > 0.0)
    frames = np.isin(masses.ways, (FRAME, DIRECTOR, AXIAL))
    rates[frames, 1] = rates[frames, 0]
    wrong = np.abs(D_own - rates[:, :1, np.newaxis] * G).max(axis=(1, 2))
    mixed = frames & (wrong > _NEGLIGIBLE * np.abs(D_own).max(axis=(1, 2)))
    with equations.shared.errors(ValueError):
        if mixed.any():
            raise ValueError(
                "Explicit: damping in proportion to mass must be the same all around a node with "
                f"a frame, but it differs around {_node_names(equations, mixed)}: use "
                "GeneralisedAlpha"
            )
    rates[~(straight | frames)] = 0.0
    return rates


def _turns(ways: Array, held: Flags) -> Flags:
    """Which nodes are frames that rotate."""
    whole = (ways == FRAME) & ~held[:, 3:].all(axis=1)
    return np.asarray(whole | np.isin(ways, (DIRECTOR, AXIAL)))


def _check_masses(equations: Equations, ways: Array, weights: Array, J: Array) -> None:
    """Raise ``ValueError`` for nodes without inertia, and for frames that are partly fixed."""
    held, free = equations.unknowns.held, _turns(ways, equations.unknowns.held)
    light = (weights[:, 0] <= 0) & (ways != STILL)
    light |= (weights[:, 1] <= 0) & (ways == STRAIGHT)
    moments = np.linalg.eigvalsh(J)
    least = moments[np.arange(len(ways)), np.array(_WITHOUT)[ways]]
    light |= free & ~(least > _NEGLIGIBLE * moments[:, 2])
    if light.any():
        raise ValueError(
            "no explicit step is stable where a node has no mass or no rotary inertia of its own: "
            f"{_node_names(equations, light)}; give sections a density and rotary inertia, or use "
            "GeneralisedAlpha"
        )
    partly = np.isin(ways, (FRAME, AXIAL)) & free & ~held[:, :3].all(axis=1)
    partly &= np.where(ways == FRAME, held.any(axis=1), held[:, :3].any(axis=1))
    partly |= (ways == FRAME) & free & held[:, 3:].any(axis=1)
    if partly.any():
        raise ValueError(
            "explicit steps: a frame may be fixed as a whole, in its rotation or in its position, "
            f"but {_node_names(equations, partly)} is fixed in part: use GeneralisedAlpha"
        )


def _node_names(equations: Equations, chosen: Flags) -> str:
    """Name of the first of some nodes."""
    node = int(equations.unknowns.masters[int(np.flatnonzero(chosen)[0])])
    return node_name(equations, node)


def node_name(equations: Equations, node: int) -> str:
    """Name of a node in messages."""
    for body, nodes in equations.unknowns.bodies.items():
        index = np.flatnonzero(nodes == node)
        if len(index):
            return f"node {int(index[0])} of {body.label}"
    return f"node {node}"


def stable_step(equations: Equations, masses: Masses, H: Array) -> StableStep:
    """Largest stable step at frames ``H``; infinite if there is no stiffness.

    Args:
        equations: Equations of the scene, with lumped inertia.
        masses: Lumped inertia of its nodes.
        H: Frames of all nodes, ground and prescribed motions.
    """
    values = squared_frequencies(equations, masses, stiffness_at_nodes(equations, H))
    own = float(values.max(initial=0.0))
    largest = equations.shared.largest(own)
    step = 2.0 / np.sqrt(largest) if largest > 0.0 else np.inf
    here = own == largest and len(values) > 0
    node = int(equations.unknowns.masters[int(values.argmax())]) if here else -1
    return StableStep(float(step), node)


def squared_frequencies(equations: Equations, masses: Masses, K: Array) -> Array:
    """Largest eigenvalue of ``M⁻¹ K`` of each node, (n,).

    Args:
        equations: Equations of the scene, with lumped inertia.
        masses: Lumped inertia of its nodes.
        K: See :func:`stiffness_at_nodes`, (n, 6, 6).
    """
    held, K = equations.unknowns.held | (masses.ways == STILL)[:, np.newaxis], K.copy()
    K[held], K.swapaxes(1, 2)[held] = 0.0, 0.0
    M = in_axes(masses)
    M[held], M.swapaxes(1, 2)[held] = 0.0, 0.0
    M[:, np.arange(6), np.arange(6)] += held
    return np.asarray(np.linalg.eigvals(np.linalg.solve(M, K)).real.max(axis=1))


def stiffness_at_nodes(equations: Equations, H: Array) -> Array:
    """Stiffness ``Σ_e k K_e,ii`` of all terms at each node, symmetric, along its axes, (n, 6, 6).

    Args:
        equations: Equations of the scene.
        H: Frames of all nodes, ground and prescribed motions.
    """
    n = equations.unknowns.moving
    K = np.zeros((n, 6, 6))
    for term in equations.arrays.terms:
        rows, columns = term.pairs
        kept = term.workspace()
        term.add_forces(H, np.zeros((n, 6)), kept)
        blocks, own = term.tangent(H, kept), rows == columns
        np.add.at(K, rows[own], _cell_size(term) * blocks[own])
    equations.shared.sum(K)
    return np.asarray(0.5 * (K + K.swapaxes(1, 2)))


def in_axes(masses: Masses) -> Array:
    """Mass matrices on twists in the axes of the nodes, shape (n, 6, 6)."""
    straight = masses.ways == STRAIGHT
    M = np.zeros((len(masses.kinds), 6, 6))
    rows = np.repeat(np.where(straight[:, np.newaxis], masses.masses, masses.masses[:, :1]), 3, 1)
    M[:, np.arange(6), np.arange(6)] = rows
    x, y, z = masses.centre.T
    o = np.zeros_like(x)
    hat = np.array([[o, -z, y], [z, o, -x], [-y, x, o]]).transpose(2, 0, 1)
    m = masses.masses[:, 0, np.newaxis, np.newaxis]
    about = masses.turning - m * hat @ hat
    M[~straight, 3:, :3], M[~straight, :3, 3:] = (m * hat)[~straight], -(m * hat)[~straight]
    M[~straight, 3:, 3:] = about[~straight]
    return M


def _cell_size(term: Term) -> int:
    """Number of nodes of its cells."""
    arrays = None
    if term.tables is not None:
        arrays = term.tables[0]
    elif term.attached_cells is not None:
        arrays = term.attached_cells.arrays
    if arrays is not None:
        return int(arrays.rows[:, _NODES].max(initial=1))
    return _MANY if term.of_bodies else _FEW


def refuse_floating(scheme: str, equations: Equations) -> None:
    """Raise ``ValueError`` for reduced-order bodies, whose mass cannot be lumped.

    Args:
        scheme: Name of the scheme in the message.
        equations: Equations of the scene.
    """
    floating = equations.unknowns.floating
    names = ", ".join(floating)
    refuse(
        scheme,
        {
            f"reduced-order bodies ({names}), whose inertia couples all of their nodes, so that "
            "none has a mass of its own": bool(floating)
        },
        "Variational, EnergyMomentum or GeneralisedAlpha",
    )
