"""Summary of a scene for logs, results and errors."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Indices
from fem_lie.bodies.catalogue import JointInfo, SceneInfo, SupportInfo
from fem_lie.lie.node_types import POSITION_GRADIENT, on_r3
from fem_lie.system.constraints import Connections
from fem_lie.system.nodes.numbering import Numbering
from fem_lie.system.terms.all_terms import Terms


def in_one_line(
    numbering: Numbering, terms: Terms, kinds: Indices, m: int, *, time_dependent: bool
) -> str:
    """Summary in one line for the log.

    Args:
        numbering: Numbering of the nodes.
        terms: All terms.
        kinds: Types of the master nodes.
        m: Number of constraints.
        time_dependent: Whether loads or motions depend on time.
    """
    total, n = numbering.total, numbering.count
    flat, others = int(on_r3(kinds).sum()), int((kinds >= POSITION_GRADIENT).sum())
    shells = [
        (body, drills)
        for body, drills in numbering.has_drilling.items()
        if body.model.separates_director
    ]
    parts = [
        f"{total} nodes, {total - n} of them rigidly attached, {m} constraints",
        f"{n - flat - others} nodes on SE(3), {flat} on R³×SO(3), all with three rotations; "
        f"{others} with vector coordinates",
        f"shells without drilling rotations: {[b.label for b, drills in shells if not drills]}, "
        f"with them: {[b.label for b, drills in shells if drills]}",
        "terms: " + (", ".join(dict.fromkeys(term.label for term in terms)) or "none"),
        "viscous: " + (", ".join(terms.viscous_labels) or "none"),
        f"loads or motions in time: {'yes' if time_dependent else 'no'}",
    ]
    return "; ".join(parts)


def catalogue(
    numbering: Numbering,
    joints: tuple[JointInfo, ...],
    supported: Indices,
    mass: float,
    strained: tuple[str, ...],
) -> SceneInfo:
    """Bodies and joints in the numbering of all nodes, for results.

    Args:
        numbering: Numbering of the nodes.
        joints: Joints in the numbering of all nodes.
        supported: Master nodes that clamps and bodies support.
        mass: Mass of all bodies.
        strained: Names of the bodies with loads that are stress-free strains.
    """
    master_map = numbering.master_map
    nodes: Indices = np.flatnonzero(np.isin(master_map.master, supported))
    rows = np.searchsorted(supported, master_map.master[nodes])
    supports = SupportInfo(master_map.masters[supported], nodes, rows)
    return SceneInfo(numbering.bodies(), joints, mass, supports, strained)


def refuse(redundant: Indices, connections: Connections) -> None:
    """Raise ``ValueError`` with the joints of redundant constraints if there are any."""
    if not len(redundant):
        return
    labels = [item.label for item in connections.items]
    sizes, excess = (
        np.bincount(owner, minlength=len(labels))
        for owner in (connections.owner, connections.owner[redundant])
    )
    names = "; ".join(labels[int(k)] for k in dict.fromkeys(connections.owner[redundant]))
    # a joint all of whose constraints are redundant can only be removed
    whole = [label for label, n, k in zip(labels, sizes, excess, strict=True) if 0 < n == k]
    advice = [f"Remove {'; '.join(whole)}: the others suffice"] if whole else []
    if ((excess > 0) & (excess < sizes)).any():
        advice.append(
            "Replace a joint by one with fewer constraints (e.g. Spherical instead of Revolute) or "
            "remove it"
        )
    raise ValueError(
        f"{len(redundant)} of {len(connections.owner)} constraints are redundant, they follow "
        f"from the other joints and clamps: {names}. {'. '.join(advice)}, or see "
        "Scene(redundant=...)"
    )
