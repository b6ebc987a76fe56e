"""What of a scene conserving steps of nodes of any kind see, and what they refuse."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Indices
from fem_lie.forms.cell_forms import FormTable, each_cell, joined
from fem_lie.forms.cells import Cells
from fem_lie.forms.term import Term
from fem_lie.lie.kinds import SLOPE
from fem_lie.solve.conserving.rows.halves import CellTable
from fem_lie.solve.conserving.rows.measure import measure_cells
from fem_lie.solve.conserving.straight.records import Model
from fem_lie.solve.motion.integrator import WITHOUT_FRAMES, refuse
from fem_lie.system.equations import Equations


def is_straight(equations: Equations) -> bool:
    """Whether there are nodes that are no frames."""
    return bool((equations.unknowns.kinds >= SLOPE).any())


def check(equations: Equations) -> None:
    """Refuse what steps of nodes that are no frames do not have yet.

    Raises:
        ValueError: Says what there is.
    """
    unknowns = equations.unknowns
    pairs = equations.tables.pairs_of_all
    apart = [term.label for term in equations.tables.terms if not _is_known(term, unknowns.kinds)]
    reasons = {
        "velocity constraints, joints that slide or roll, or joints between the nodes of a Beam": (
            pairs is None
        ),
        "joints that need the rotation of a cable's end or of a node without axes "
        "(Revolute, Fixed; Spherical away from the node)": pairs is not None and pairs.loose,
        "nodes that are rigidly attached to others": unknowns.moving < unknowns.total,
        "strains that change in time": unknowns.strains_change,
        ", ".join(dict.fromkeys(apart)): bool(apart),
    }
    refuse(f"a conserving scheme, where there are {WITHOUT_FRAMES},", reasons)


def _is_known(term: Term, kinds: Indices) -> bool:
    """Whether steps have the forces of a term, as cells of nodes of one sort or in other sums."""
    if term.rates is not None or term.within_joints:
        return True
    if term.secant:
        return True
    if (kinds[term.pairs[0]] < SLOPE).all():
        return term.conserved and not term.load
    if term.tables is None or term.settles:
        return False
    return bool((kinds[term.tables[0].nodes] >= SLOPE).all())


def viscous_terms(equations: Equations) -> list[Term]:
    """Those whose damping goes with strain rates."""
    known = equations.tables.terms
    return [t for t in known if t.viscous and t.rates is None and not t.within_joints]


def cells_of_frames(equations: Equations) -> Cells:
    """Those of bodies whose nodes are frames."""
    kinds = equations.unknowns.kinds
    parts = equations.tables.assemblies
    return Cells([(where, term) for where, term in parts if kinds[where.start] < SLOPE])


def model_of(equations: Equations, framed: Cells, loss: float) -> Model:
    """What steps see of a scene, with its cells of frames; ``loss``: χ of dissipation."""
    known, unknowns = equations.tables, equations.unknowns
    return Model(
        cells=_cells(equations),
        framed=framed.table,
        kinds=known.kinds,
        arms=np.where(unknowns.lengths, 1.0, unknowns.length),
        inertia=known.inertia,
        turning=known.turning,
        held=unknowns.held,
        supported=known.supported,
        dead=known.loads.dead.copy(),
        conservative=known.conservative,
        following=known.loads.following.copy(),
        moment=known.loads.moment.copy(),
        damping=known.damping,
        loss=loss,
        learning=1.0 - loss,
    )


def _cells(equations: Equations) -> CellTable:
    """Of all terms on nodes that are no frames, measured at the start."""
    kinds = equations.tables.kinds
    tables = [term.tables for term in equations.tables.terms]
    parts = [both for both in tables if both is not None]
    parts = [both for both in parts if (kinds[both[0].nodes] >= SLOPE).all()]
    forces, energy = (
        each_cell(FormTable(*joined([both[k] for both in parts], [0] * len(parts))))
        for k in range(2)
    )
    places, count = len(forces.nodes), len(forces.calls)
    cells = CellTable(
        np.stack([forces.calls, energy.calls], axis=1),
        forces.first,
        forces.nodes,
        equations.tables.kinds[forces.nodes],
        np.zeros((places, 2)),
        np.zeros(count, dtype=np.int64),
        np.zeros(count),
    )
    start = equations.start.frames
    measure_cells(cells, equations.unknowns.lengths, start, np.zeros_like(start))
    return cells
