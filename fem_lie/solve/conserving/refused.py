"""What conserving schemes cannot do, said before any work."""

from __future__ import annotations

from fem_lie._arrays import Indices
from fem_lie.forms.term import Term
from fem_lie.lie.kinds import SLOPE
from fem_lie.solve.conserving.memory import has_vector_nodes
from fem_lie.solve.conserving.outside.forces import acts_in_the_middle
from fem_lie.solve.motion.integrator import refuse
from fem_lie.system.equations import Equations

_WITHOUT_FRAMES = (
    "nodes without frames (Cable, Net, ThinShell, AncfBeam, AncfShell, Solid, reduced-order bodies)"
)
"""Bodies with nodes that have no rotation of their own."""


def refuse_scene(equations: Equations) -> None:
    """Refuse scenes with something that has no forces over a step.

    Raises:
        ValueError: Says what there is.
    """
    unknowns, known = equations.unknowns, equations.tables
    vectors, drilling = has_vector_nodes(equations), ", ".join(unknowns.drilling)
    touched = bool(drilling) and any(term.over_step is not None for term in known.terms)
    apart = [
        f"{term.label} with damping" if term.viscosity is not None else term.label
        for term in known.terms
        if not _has_forces_over_steps(term, known.kinds)
    ]
    reasons = {
        "springs along coordinates of joints between the nodes of a Beam": (
            not vectors and unknowns.other_springs
        ),
        "supports along axes fixed in space (Shell.guide)": bool(equations.supports),
        "redundant constraints": unknowns.may_be_redundant,
        "velocity constraints (KnifeEdge, RollingDisc) beside shells with six parameters "
        f"({drilling}), whose drilling has no inertia": bool(drilling)
        and unknowns.of_velocities > 0,
        f"contacts by penalty beside shells with six parameters ({drilling})": touched,
        ", ".join(dict.fromkeys(apart)): bool(apart),
    }
    refuse("a conserving scheme", reasons)
    if vectors:
        _refuse_joints(equations)


def _refuse_joints(equations: Equations) -> None:
    """Refuse joints that scenes with nodes without frames do not have."""
    pairs = equations.tables.pairs_of_all
    reasons = {
        "velocity constraints, joints that slide or roll, or joints between the nodes of a Beam": (
            pairs is None
        ),
        "joints that need the rotation of a cable's end or of a node without axes "
        "(Revolute, Fixed; Spherical away from the node)": pairs is not None and pairs.loose,
    }
    refuse(f"a conserving scheme, where there are {_WITHOUT_FRAMES},", reasons)


def _has_forces_over_steps(term: Term, kinds: Indices) -> bool:
    """Whether steps have the forces of a term, as cells of nodes of one sort or in other sums."""
    viscosity = term.viscosity
    constant = viscosity is not None and viscosity.rates is not None
    if term.over_step or constant or term.within_joints or acts_in_the_middle(term):
        return True
    if term.within_frames:
        return True
    if (kinds[term.pairs[0]] < SLOPE).all():
        return term.conserved
    if term.tables is None or term.local is not None:
        return False
    return bool((kinds[term.tables[0].nodes] >= SLOPE).all())
