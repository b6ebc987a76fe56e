"""What a term on nodes of bodies has beside its forces, seen from the master nodes."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.abilities import (
    Done,
    Ends,
    GroundForces,
    LinearisedStress,
    LocalUnknowns,
    LowRankTangent,
    PassageCheck,
    PathDependence,
    StepForces,
    StiffRows,
    ViscousForces,
)
from fem_lie.forms.term import Term
from fem_lie.system.terms.attached_nodes import AttachedNodes


class AttachedViscosity(ViscousForces):
    """Viscous forces of a term."""

    def __init__(self, term: Term, of: ViscousForces, nodes: AttachedNodes) -> None:
        """Keep the term, its viscous forces and its nodes."""
        self._term, self._of, self._nodes, self.in_space = term, of, nodes, of.in_space

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        nodes = self._nodes
        if nodes.direct:
            self._of.add_viscous_forces(H[nodes.where], v[nodes.where], out[nodes.where])
            return
        forces = np.zeros((len(nodes.master), 6))
        self._of.add_viscous_forces(nodes.frames(H), nodes.twists(v), forces)
        nodes.collect(forces, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """See the base class."""
        nodes, pairs = self._nodes, self._term.pairs
        by_twists, by_frames = self._of.viscous_tangent(nodes.frames(H), nodes.twists(v))
        in_frames = None if by_frames is None else nodes.blocks(by_frames, pairs)
        return nodes.blocks(by_twists, pairs), in_frames

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """None: the matrix would be that of other nodes."""
        return None


class AttachedStress(LinearisedStress):
    """Stress of a term."""

    def __init__(self, of: LinearisedStress, nodes: AttachedNodes) -> None:
        """Keep the stress and its nodes."""
        self._of, self._nodes = of, nodes

    @property
    def carried(self) -> Array:
        """See the base class."""
        return self._of.carried

    def restore(self, carried: Array) -> None:
        """See the base class."""
        self._of.restore(carried)

    def carry(self, H: Array, h: Array) -> None:
        """See the base class."""
        self._of.carry(self._nodes.frames(H), self._nodes.twists(h))

    def reset_stress(self, H: Array) -> None:
        """See the base class."""
        self._of.reset_stress(self._nodes.frames(H))

    def clear_stress(self) -> None:
        """See the base class."""
        self._of.clear_stress()


class AttachedUnknowns(LocalUnknowns):
    """Unknowns of the cells of a term."""

    def __init__(self, of: LocalUnknowns, nodes: AttachedNodes) -> None:
        """Keep them and their nodes."""
        self._of, self._nodes = of, nodes

    def condense(self, H: Array) -> None:
        """See the base class."""
        self._of.condense(self._nodes.frames(H))


class AttachedPath(PathDependence):
    """What a term knows of accepted states."""

    def __init__(self, of: PathDependence, nodes: AttachedNodes) -> None:
        """Keep it and its nodes."""
        self._of, self._nodes, self.friction = of, nodes, of.friction

    def accept(self, H: Array) -> None:
        """See the base class."""
        self._of.accept(self._nodes.frames(H))


class AttachedPassage(PassageCheck):
    """Checks of the steps of a term."""

    def __init__(self, of: PassageCheck, nodes: AttachedNodes) -> None:
        """Keep them and their nodes."""
        self._of, self._nodes = of, nodes

    def check_passage(self, start: Array, end: Array) -> None:
        """See the base class."""
        self._of.check_passage(self._nodes.frames(start), self._nodes.frames(end))

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """See the base class."""
        nodes = self._nodes
        half = None if middle is None else nodes.frames(middle)
        self._of.watch(nodes.frames(start), nodes.frames(end), h, half)

    @property
    def watched(self) -> Array:
        """See the base class."""
        return self._of.watched

    def watch_again(self, watched: Array) -> None:
        """See the base class."""
        self._of.watch_again(watched)


class AttachedStepForces(StepForces):
    """Forces of a term over a step: on nodes of bodies; frames ``H`` are those of master nodes."""

    def __init__(self, term: Term, of: StepForces, nodes: AttachedNodes) -> None:
        """Keep the term, its forces over a step and its nodes."""
        self._term, self._of, self._nodes, self.steady = term, of, nodes, of.steady

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """See the base class."""
        return self._of.add_over_step(ends, out, ground)

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """See the base class."""
        blocks = self._of.tangent_over_step(ends, self._nodes.frames(H))
        return self._nodes.blocks(blocks, self._term.pairs)

    def overlaps(self, H: Array) -> bool:
        """See the base class."""
        return self._of.overlaps(self._nodes.frames(H))


class AttachedLowRank(LowRankTangent):
    """Few rows of a term's tangent."""

    def __init__(self, of: LowRankTangent, nodes: AttachedNodes) -> None:
        """Keep them and their nodes."""
        self._of, self._nodes = of, nodes

    def stiff_rows(self, H: Array) -> StiffRows:
        """See the base class."""
        found = self._of.stiff_rows(self._nodes.frames(H))
        nodes, rows = self._nodes.rows(found.nodes, found.rows)
        return StiffRows(nodes, rows, found.stiffness)


class AttachedGround(GroundForces):
    """Forces of a term whose other side is ground."""

    def __init__(self, of: GroundForces, nodes: AttachedNodes) -> None:
        """Keep them and their nodes."""
        self._of, self._nodes = of, nodes

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        forces = np.zeros((len(self._nodes.master), 6))
        self._of.add_of_ground(self._nodes.frames(H), self._nodes.twists(v), forces)
        self._nodes.collect(forces, out)
