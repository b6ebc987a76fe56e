"""Abilities of terms of bodies, transformed to the master nodes of their nodes."""

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
    """Viscous forces of a term on master nodes."""

    def __init__(self, term: Term, of: ViscousForces, nodes: AttachedNodes) -> None:
        """Store the term, its viscous forces and its nodes."""
        self._term, self._of, self._nodes, self.in_space = term, of, nodes, of.in_space

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the forces at twists ``v`` (≥ nodes that move, 6)."""
        nodes = self._nodes
        if nodes.direct:
            self._of.add_viscous_forces(H[nodes.where], v[nodes.where], out[nodes.where])
            return
        forces = np.zeros((len(nodes.master), 6))
        self._of.add_viscous_forces(nodes.frames(H), nodes.twists(v), forces)
        nodes.collect(forces, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Derivatives of the forces in twists, and in frames unless these are neglected."""
        nodes, pairs = self._nodes, self._term.pairs
        by_twists, by_frames = self._of.viscous_tangent(nodes.frames(H), nodes.twists(v))
        in_frames = None if by_frames is None else nodes.blocks(by_frames, pairs)
        return nodes.blocks(by_twists, pairs), in_frames

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """``None``: the matrix of the term is on other nodes."""
        return None


class AttachedStress(LinearisedStress):
    """Independent stress of a term on master nodes."""

    def __init__(self, of: LinearisedStress, nodes: AttachedNodes) -> None:
        """Store the stress and the nodes."""
        self._of, self._nodes = of, nodes

    @property
    def linearised_values(self) -> Array:
        """Values of the independent stress, flat."""
        return self._of.linearised_values

    def restore(self, values: Array) -> None:
        """Restore the values of :attr:`linearised_values`."""
        self._of.restore(values)

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the stress along the increment ``h`` (n, 6) from frames ``H``."""
        self._of.update_stress(self._nodes.frames(H), self._nodes.twists(h))

    def reset_stress(self, H: Array) -> None:
        """Have the values of frames ``H``."""
        self._of.reset_stress(self._nodes.frames(H))

    def clear_stress(self) -> None:
        """Set the stress to zero: a tangent without geometric stiffness."""
        self._of.clear_stress()


class AttachedUnknowns(LocalUnknowns):
    """Local unknowns of the cells of a term on master nodes."""

    def __init__(self, of: LocalUnknowns, nodes: AttachedNodes) -> None:
        """Store the unknowns and the nodes."""
        self._of, self._nodes = of, nodes

    def condense(self, H: Array) -> None:
        """Solve for them at frames ``H``."""
        self._of.condense(self._nodes.frames(H))


class AttachedPath(PathDependence):
    """Path dependence of a term on master nodes."""

    def __init__(self, of: PathDependence, nodes: AttachedNodes) -> None:
        """Store the path dependence and the nodes."""
        self._of, self._nodes, self.friction, self.key = of, nodes, of.friction, of.key

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept the state with frames ``H``."""
        before = None if start is None else self._nodes.frames(start)
        self._of.accept(self._nodes.frames(H), before)

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction."""
        return self._of.dissipated

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state, shape (k, 9)."""
        return self._of.friction_forces(self._nodes.frames(H), self._nodes.twists(v))


class AttachedPassage(PassageCheck):
    """Passage check of a term on master nodes."""

    def __init__(self, of: PassageCheck, nodes: AttachedNodes) -> None:
        """Store the check and the nodes."""
        self._of, self._nodes = of, nodes

    def check_passage(self, start: Array, end: Array) -> None:
        """Look whether surfaces went through each other."""
        self._of.check_passage(self._nodes.frames(start), self._nodes.frames(end))

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Record a step of a scheme that does not conserve energy."""
        nodes = self._nodes
        half = None if middle is None else nodes.frames(middle)
        self._of.watch(nodes.frames(start), nodes.frames(end), h, half)

    @property
    def watched(self) -> Array:
        """Record of steps of :meth:`watch`, flat."""
        return self._of.watched

    def watch_again(self, watched: Array) -> None:
        """Restore the record of :attr:`watched`."""
        self._of.watch_again(watched)


class AttachedStepForces(StepForces):
    """Forces of a term over a step, on nodes of bodies; frames ``H`` are those of master nodes."""

    def __init__(self, term: Term, of: StepForces, nodes: AttachedNodes) -> None:
        """Store the term, its forces over a step and its nodes."""
        self._term, self._of, self._nodes, self.steady = term, of, nodes, of.steady

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add the forces over a step to ``out`` and ``ground``."""
        return self._of.add_over_step(ends, out, ground)

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Twice the derivative of these in twists at the end, in frames ``H`` at the midpoint."""
        blocks = self._of.tangent_over_step(ends, self._nodes.frames(H))
        return self._nodes.blocks(blocks, self._term.pairs)

    def overlaps(self, H: Array) -> bool:
        """Whether there are forces at frames ``H``."""
        return self._of.overlaps(self._nodes.frames(H))

    def keep_gaps(self) -> None:
        """Keep what the last :meth:`overlaps` found."""
        self._of.keep_gaps()


class AttachedLowRank(LowRankTangent):
    """Low-rank tangent of a term on master nodes."""

    def __init__(self, of: LowRankTangent, nodes: AttachedNodes) -> None:
        """Store the tangent and the nodes."""
        self._of, self._nodes = of, nodes

    def stiff_rows(self, H: Array) -> StiffRows:
        """Few stiff rows that represent the tangent approximately, on master nodes."""
        found = self._of.stiff_rows(self._nodes.frames(H))
        nodes, rows = self._nodes.rows(found.nodes, found.rows)
        return StiffRows(nodes, rows, found.stiffness)


class AttachedGround(GroundForces):
    """Forces of a term on ground, from master nodes."""

    def __init__(self, of: GroundForces, nodes: AttachedNodes) -> None:
        """Store the forces and the nodes."""
        self._of, self._nodes = of, nodes

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add those on nodes, at twists ``v``, whose other side is ground."""
        forces = np.zeros((len(self._nodes.master), 6))
        self._of.add_of_ground(self._nodes.frames(H), self._nodes.twists(v), forces)
        self._nodes.collect(forces, out)
