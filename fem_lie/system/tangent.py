"""Tangent matrix of a scene as a sum of contributions in blocks on one pattern of node pairs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from functools import cached_property
from typing import TypeAlias

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.abilities import Ends, ViscousForces
from fem_lie.forms.term import Pairs, Term, add_at
from fem_lie.lie.motions import add_turnings
from fem_lie.lie.node_types import floating_tangents, inertia
from fem_lie.lie.node_types.floating import Floating
from fem_lie.lie.node_types.inertia import Inertia, PlainEnds, PlainMotion
from fem_lie.linear.domains.division import Division
from fem_lie.linear.low_rank import LowRank, LowRankCorrection
from fem_lie.linear.saddle_point import KKT, flexibility
from fem_lie.system.constraint_sets.averages import Averages
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.constraints import Connections
from fem_lie.system.domains import Domain, division_of
from fem_lie.system.nodes.fixed_axes import Supports
from fem_lie.system.nodes.sums import load_tangent, to_inertial
from fem_lie.system.parts import Parts, Sharing, Vectors, map_rows
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.time_state import Plan, TimeState

TermSelection: TypeAlias = Callable[[Term], bool]
"""Whether a term is included."""

ViscositySelection: TypeAlias = Callable[[Term, ViscousForces], bool]
"""Whether the viscous forces of a term are included."""


def every(_: Term) -> bool:
    """Include all terms."""
    return True


def _all(_: Term, __: ViscousForces) -> bool:
    """Include all viscous forces."""
    return True


def whole(term: Term) -> bool:
    """Include terms that cannot be separate low-rank corrections."""
    return term.low_rank is None


class Tangent:
    """Tangent matrix: a sum of contributions to ``A`` and ``K``, filled into the KKT matrix.

    Attributes:
        kkt: The saddle-point (KKT) matrix.
        supports: Nodes with unknowns along axes fixed in space.
        vectors: Grouping of constraints into vectors.
        parts: ``A``, derivatives in corrections of the nodal increments, and ``K``, derivatives in
            the twists ``h`` of the nodal frames, blocks of ``kkt``.
        friction_columns: Derivatives of friction in multipliers, one row of six per incidence.
        domain: Subdomain of this rank, if the scene is divided.
    """

    domain: Domain | None = None
    _share: Array | None = None
    _given: Array | None = None

    def __init__(
        self,
        mass: Inertia,
        bodies: Floating,
        terms: Terms,
        connections: Connections,
        held: Flags,
        axes: Array,
        kinds: Indices,
        *,
        redundant: bool,
        switched: bool,
        sharing: Sharing,
        units: Array,
        length: float,
    ) -> None:
        """Build the sparsity pattern.

        Args:
            mass: Mass matrix of the master nodes.
            bodies: Further inertia of bodies that deform within their frames.
            terms: All terms with a stiffness.
            connections: All joints.
            held: Unknowns of the nodes that are zero, shape (n, 6).
            axes: Fixed axes of the supports, see
                :class:`~fem_lie.system.nodes.fixed_axes.Supports`.
            kinds: Types of the nodes.
            redundant: Whether constraints may be redundant.
            switched: Whether constraints may be inactive.
            sharing: Pairs of nodes that share the blocks of ``A`` and ``K``.
            units: Unit of each unknown of the nodes, shape (6 n,).
            length: Length of the model.
        """
        self._mass, self._terms, self._connections = mass, terms, connections
        self._bodies = bodies
        self._incidences, self.vectors = connections.incidences, Vectors(connections.joined)
        self._held, self._count, self._kinds, self._sharing = held, len(held), kinds, sharing
        self._splits = self._averaged = any(each.means for each in connections.sets)
        pairs, angular = self._pairs(), connections.angular
        self.kkt = KKT(
            pairs,
            self._incidences,
            held,
            units=units,
            length=length,
            angular=angular,
            redundant=redundant,
            switched=switched,
        )
        self.kkt.divisible = self
        self.supports = Supports(axes, self._incidences.nodes)
        self._settle()

    def _pairs(self) -> list[Pairs]:
        """Node pairs of inertia, of all terms, and of constraint sets."""
        mass = self._mass
        own = np.repeat(np.arange(self._count), np.diff(mass.indptr)), mass.indices
        sets = self._connections.sets
        others = ((r.ravel(), c.ravel()) for r, c in map(self._pairs_of, sets))
        return [own, self._bodies.pairs, *self._terms.pairs, *others]

    def _pairs_of(self, one: ConstraintSet) -> Pairs:
        """Node pairs of a constraint set, of any shape."""
        return one.sparse if self._splits else one.pairs

    def _settle(self) -> None:
        """Find the positions of all contributions in the current pattern."""
        block_index, diagonal = self.kkt.block_index, np.arange(self._count)
        own, floating, *coupled = self._pairs()
        self._versions = self._terms.versions
        self.parts = Parts(self._kinds, self.kkt.indices, self._sharing)
        in_K = self.parts.index_in_K
        self._mass_index, self._bodies_index = (
            (at, in_K(at)) for at in (block_index(*own), block_index(*floating))
        )
        self._diagonal = block_index(diagonal, diagonal)
        indices = (block_index(*pair) for pair in coupled)
        self._of_terms = [
            (term, in_K(at), at if term.viscosity else at[:0])
            for term, at in zip(self._terms, indices, strict=False)
        ]
        sets = self._connections.sets
        of_sets = (block_index(*self._pairs_of(each)) for each in sets)
        self._sets = [(each, in_K(at), at) for each, at in zip(sets, of_sets, strict=True)]
        self._averages = Averages(sets) if self._splits else Averages([])
        self._nodes = np.concatenate([self._incidences.nodes, self._averages.nodes])
        self._rows = np.zeros((len(self._nodes), 6))
        self.friction_columns = np.zeros_like(self._rows)
        self.supports.find_constraints(self._nodes)
        self.supports.find(self.kkt.indptr, self.kkt.indices)
        self._filled = False  # whether the KKT contains A

    @property
    def A(self) -> Array:
        """Blocks ``A`` of :attr:`parts`."""
        return self.parts.A

    def separate_blocks(self) -> None:
        """Store all blocks of ``K`` separately from ``A``, from the next matrix on."""
        self._sharing = Sharing.NONE
        if not self.parts.separate:
            self._settle()
            if self.domain is not None:
                self._others = np.zeros_like(self.parts.blocks)

    def jacobian(self, H: Array) -> sp.csr_matrix:
        """Constraint Jacobian ``B = ∂Φ/∂h`` in twists of the nodes, without held ones, (m, 6 n)."""
        rows, incidences = self._constraints(H), self._incidences
        self.supports.rotate_constraints(H, rows)
        rows = rows[: len(incidences.nodes)]
        rows[self._held[incidences.nodes]] = 0.0
        if self.kkt.inactive.any():
            rows[self.kkt.inactive[incidences.rows]] = 0.0
        found = copy(self._no_jacobian)  # scipy takes ten times as long to compose one anew
        found.data = rows.ravel()
        return found

    @cached_property
    def _no_jacobian(self) -> sp.csr_matrix:
        """The constraint Jacobian with all entries zero."""
        ptr, nodes = self._incidences
        columns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()
        shape = (len(ptr) - 1, 6 * self._count)
        return sp.csr_matrix((np.zeros(len(columns)), columns, 6 * ptr), shape=shape)

    def _constraints(self, H: Array) -> Array:
        """Constraint Jacobian, one row of six per incidence, then zeros for mean coordinates."""
        rows = np.empty_like(self._rows)
        self._put_constraints(H, rows)
        return rows

    def _put_constraints(self, H: Array, rows: Array) -> None:
        """Set ``rows`` to that."""
        n = len(self._incidences.nodes)
        self._connections.jacobian(H, rows[:n])
        rows[n:] = 0.0

    # --- domains ---

    def division(self, count: int) -> Division:
        """Division into subdomains, see :func:`~fem_lie.system.domains.division_of`."""
        self._couple()
        own, floating, *_ = self._pairs()
        return division_of(self.kkt, self._terms, [own, floating], count)

    def divide(self, division: Division, rank: int) -> None:
        """Select the subdomain of a rank, see :class:`~fem_lie.system.domains.Domain`."""
        self._couple()
        self.domain = Domain(self.kkt, self._terms, division, rank)
        self.kkt.divide(self.domain.part)
        self._others = np.zeros_like(self.parts.blocks)

    @contextmanager
    def of_domain(self, scale: Array) -> Iterator[None]:
        """Context that fills the matrix of the subdomain with this scale of constraints."""
        assert self.domain is not None
        parts, whole = self.parts, self.parts.blocks
        parts.blocks = self._others
        self._share, self._given = self.domain.share, scale
        self.domain.only_own(True)
        try:
            with self.kkt.of_part():
                yield
        finally:
            self.domain.only_own(False)
            self._others, parts.blocks = parts.blocks, whole
            self._share = self._given = None

    @contextmanager
    def _divided(self, *, really: bool = True) -> Iterator[None]:
        """Context of contributions that all subdomains share; the subdomain takes its fraction."""
        if self._share is None or not really:
            yield
            return
        parts, blocks = self.parts, self.parts.blocks
        parts.blocks = np.zeros_like(blocks)
        yield
        parts.blocks, added = blocks, parts.blocks
        parts.add_share(self._share, added)

    def _divides(self, term: Term) -> bool:
        return self.domain is not None and not self.domain.has_cells(term)

    # --- scale ---

    def constraint_scale(self, H: Array, spread: Array | None = None) -> Array:
        """Scale factors ``1/(B diag(S)⁻¹ Bᵀ)`` of constraints with the ``S`` in ``A``, shape (m,).

        With ``σ B`` as constraint block the matrix is about as well conditioned as ``S``: for ``S →
        M/(βh²)`` this is the index 3 scaling of Bottasso, Bauchau & Cardona. ``spread``: see
        :meth:`~fem_lie.system.parts.Vectors.scales`.
        """
        if self._given is not None:
            return self._given
        diagonal = np.abs(self.A[self._diagonal].diagonal(axis1=1, axis2=2))
        rows, incidences = self._constraints(H), self._incidences
        self.supports.rotate_constraints(H, rows)
        rows[self._held[self._nodes]] = 0.0
        return self.vectors.scales(incidences, rows, diagonal, self.kkt.free_units, spread)

    # --- parts ---

    def clear(self) -> None:
        """Set all blocks to zero, with the current node pairs of terms."""
        self._couple()
        self.parts.clear()
        self.friction_columns[:] = 0.0
        self._averages.clear()
        self._filled = False

    def _couple(self) -> None:
        """Update the pattern to the current pairs of terms and treatment of attachments."""
        splits = self._averaged and self.kkt.splits
        splits &= self._sharing is not Sharing.NONE
        if self._versions == self._terms.versions and self._splits == splits:
            return
        if self.domain is not None:
            raise ValueError("subdomains need constant pairs of nodes, got others: contact?")
        self._splits = splits
        self.kkt.couple(self._pairs())
        self._settle()

    def restore_pattern(self, indptr: Indices, indices: Indices) -> None:
        """Restore an earlier pattern of ``kkt``; :meth:`clear` returns to the current one."""
        if np.array_equal(indptr, self.kkt.indptr) and np.array_equal(indices, self.kkt.indices):
            return
        self.kkt.couple([(np.repeat(np.arange(self._count), np.diff(indptr)), indices)])
        self.parts = Parts(self._kinds, indices, self._sharing)
        self._versions, self._filled = (), False

    def add_inertia(
        self,
        state: TimeState,
        kinds: Indices,
        loads: tuple[Array, Array] | None,
        factors: tuple[float, float],
        ends: PlainEnds | None = None,
    ) -> None:
        """Add derivatives of inertia and nodal loads.

        Args:
            state: The state.
            kinds: Types of the nodes.
            loads: Forces on (x, d₁, d₂, d₃) from the residual, and moments fixed in space, whose
                components change as nodes rotate; ``None``: they are taken as constant.
            factors: ∂a/∂d and ∂v/∂d.
            ends: Ends of a step for changes of its momenta, in the place of inertia at the state.
        """
        (H, v, a, _), n = state, self._count
        # inertia does not contribute at rest, as in statics
        with self._divided():
            if any(factors) or v.any() or a.any():
                self._add_rates((H, v[:n], a[:n]), kinds, factors, ends)
            if loads is not None:
                diagonal = self.parts.index_in_K(self._diagonal)
                load_tangent(kinds, H, *loads, diagonal, self.parts.blocks)

    def add_mass(self, H: Array, kinds: Indices, factor: float) -> None:
        """Add the mass matrix times a factor to ``A``, and the stiffness of weight to ``K``."""
        still = np.zeros((self._count, 6))
        with self._divided():
            self._add_rates((H, still, still), kinds, (factor, 0.0))

    def _add_rates(
        self,
        motion: PlainMotion,
        kinds: Indices,
        factors: tuple[float, float],
        ends: PlainEnds | None = None,
    ) -> None:
        """Add derivatives of inertia at frames, velocities and their rates."""
        parts, mass = (self.parts.blocks, self.parts.blocks), self._mass.plain
        if ends is None:
            inertia.tangents(motion, kinds, mass, self._mass_index, factors, parts)
        else:
            in_A, factor = self._mass_index[0], factors[0]
            inertia.momentum_tangents(ends, kinds, mass, in_A, factor, parts[0])
        if len(self._bodies_index[0]):
            bodies, index = self._bodies.plain, self._bodies_index
            floating_tangents.tangents(motion, kinds, bodies, index, factors, parts)

    def add_terms(
        self,
        H: Array,
        kept: Sequence[Array],
        selected: TermSelection = every,
        ends: Ends | None = None,
    ) -> None:
        """Add the stiffness of terms, with their independent stress, to ``K``.

        Args:
            H: Frames.
            kept: Forces of terms, see :meth:`~fem_lie.system.terms.all_terms.Terms.add_forces`.
            selected: Selection of terms.
            ends: Ends of a step, for terms with forces over a step; default: all terms at ``H``.
        """
        for (term, index, _), forces in zip(self._of_terms, kept, strict=True):
            with self._divided(really=self._divides(term)):
                if ends is not None and term.over_step is not None:
                    blocks = term.over_step.tangent_over_step(ends, H)
                    add_at(self.parts.blocks, index, blocks)
                elif selected(term):
                    term.add_tangent(H, forces, index, self.parts.blocks)

    def set_correction(self, H: Array) -> None:
        """Set the low-rank correction of the KKT matrix: stiff rows of terms.

        Supports along fixed axes are not transformed.
        """
        low_rank = [term.low_rank for term, *_ in self._of_terms]
        found = [each.stiff_rows(H) for each in low_rank if each is not None]
        moves = [(f.nodes >= 0) & (f.nodes < self._count) for f in found]
        some = [which.any(axis=1) for which in moves]
        nodes = np.concatenate([f.nodes[which] for f, which in zip(found, moves, strict=True)])
        if not len(nodes):
            self.kkt.correction = None
            return
        left = np.concatenate([f.rows[which] for f, which in zip(found, moves, strict=True)])
        counts = np.concatenate([m[s].sum(axis=1) for m, s in zip(moves, some, strict=True)])
        k = np.concatenate([f.stiffness[s] for f, s in zip(found, some, strict=True)])
        left[self._held[nodes]] = 0.0
        unknowns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()
        first = 6 * np.append(0, np.cumsum(counts))
        self.kkt.correction = LowRankCorrection(first, unknowns, left.ravel(), left.ravel(), k)

    def alone(self, H: Array, term: Term) -> sp.csr_matrix:
        """Matrix of one term, along the axes of supports, shape (6 n, 6 n)."""
        kept = term.workspace()
        term.add_forces(H, np.zeros((self._count, 6)), kept)
        self.clear()
        (index,) = (index for other, index, _ in self._of_terms if other is term)
        term.add_tangent(H, kept, index, self.parts.blocks)
        self.parts.add_K()
        self.supports.rotate_blocks(H, self.A)
        found = sp.bsr_matrix((self.A, self.kkt.indices, self.kkt.indptr)).tocsr()
        self.parts.release()
        return found

    def add_geometric(self, H: Array, multipliers: Array) -> None:
        """Add the geometric stiffness of joints with these multipliers, and of terms, to ``K``.

        That of joints includes springs, drives and gears.
        """
        for each, index, _ in self._sets:
            each.geometric(H, multipliers, index, self.parts.blocks)
        self._averages.take(H, multipliers)
        for term, index, _ in self._of_terms:
            blocks = None if term.within_joints else term.geometric(H)
            if blocks is not None:
                with self._divided():
                    add_at(self.parts.blocks, index, blocks)

    def add_viscosity(
        self,
        H: Array,
        v: Array,
        factor: float,
        selected: Callable[[Term, ViscousForces], bool] = _all,
    ) -> None:
        """Add derivatives of viscous forces in twists, times ``factor``, to ``A``.

        Derivatives in frames are added to ``K``.

        Args:
            H: Frames.
            v: Twists.
            factor: ∂v/∂d.
            selected: Selection of terms.
        """
        for term, in_K, in_A in self._of_terms:
            viscosity = term.viscosity
            if viscosity is not None and selected(term, viscosity):
                by_twists, by_frames = viscosity.viscous_tangent(H, v)
                with self._divided(really=self._divides(term)):
                    add_at(self.parts.blocks, in_A, factor * by_twists)
                    if by_frames is not None:
                        add_at(self.parts.blocks, in_K, by_frames)

    def add_friction(self, H: Array, v: Array, multipliers: Array, factor: float) -> None:
        """Add derivatives of friction in joints in twists, times ``factor``, to ``A``.

        Those in multipliers are added to the constraint block until :meth:`clear`.

        Args:
            H: Frames.
            v: Twists.
            multipliers: Lagrange multipliers, at which the normal forces are.
            factor: ∂v/∂d.
        """
        for each, _, in_A in self._sets:
            each.add_friction(H, v, multipliers, in_A, factor, self.parts.blocks)
            each.add_friction_columns(H, v, multipliers, self.friction_columns)

    def add_turnings(self, forces: Array, nodes: Flags) -> None:
        """Add derivatives of forces that rotate with nodes to ``K``.

        See :func:`~fem_lie.lie.motions.add_turnings`.
        """
        with self._divided():
            diagonal = self.parts.index_in_K(self._diagonal)
            add_turnings(forces, 1.0, diagonal, nodes, self.parts.blocks)

    # --- sum ---

    def fill(self, blocks: Array, H: Array, scale: Array) -> None:
        """Fill the KKT matrix with blocks and the constraints at ``H`` times ``scale``."""
        self._put_constraints(H, self._rows)
        self._averages.put(self._rows)
        if self.supports:
            blocks = blocks.copy()
            self.supports.rotate_blocks(H, blocks)
            self.supports.rotate_constraints(H, self._rows)
        self._fill(blocks, self._rows, scale)
        self._filled = False

    def _fill(self, blocks: Array, columns: Array, scale: Array) -> None:
        """Fill the KKT matrix and its low-rank part."""
        n = len(self._incidences.nodes)
        self.kkt.low_rank = self._low_rank(blocks, columns[n:], self._rows[n:])
        self.kkt.fill(blocks, columns[:n], self._rows[:n], scale)

    def _low_rank(self, blocks: Array, left: Array, right: Array) -> LowRank | None:
        """Low-rank part of averaging attachments, or ``None``."""
        if len(left) == 0:
            return None
        diagonal = np.abs(blocks[self._diagonal]).diagonal(axis1=1, axis2=2)
        soft = flexibility(diagonal, self.kkt.free_units)
        return self._averages.low_rank(left, right, soft, self._held)

    def refill_constraints(self, H: Array, plan: Plan) -> Array:
        """Fill the matrix of the last :meth:`fill_increments` with new constraints."""
        ahead = H if plan.joint_frames is None else plan.joint_frames
        scale = self.constraint_scale(ahead, plan.spread) if plan.scale is None else plan.scale
        self._put_constraints(ahead, self._rows)
        columns, count = self._rows + self.friction_columns, len(self._incidences.nodes)
        if self.supports:
            self.supports.rotate_constraints(ahead, columns)
            self.supports.rotate_constraints(ahead, self._rows)
        self.kkt.fill(self.A, columns[:count], self._rows[:count], scale, anew=not self._filled)
        self._filled = True
        return scale

    def fill_increments(self, H: Array, kinds: Indices, plan: Plan) -> Array:
        """Fill the KKT matrix with ``A + K`` and the constraints, derivatives in twists.

        Along twists of the moved nodes the stiffness of conservative forces and the constraints are
        symmetric; corrections of increments, ``δd = T⁻¹(d) h``, are computed after each solution.
        ``A``, inertia and damping, is symmetric in increments but for gyroscopic terms. Therefore
        ``A T⁻¹(d)`` is used if these are in the matrix, and else ``A``.

        Args:
            H: Frames of the state.
            kinds: Types of the nodes.
            plan: Contents of the matrix.

        Returns:
            The scale of the constraints in it, (m,).
        """
        ahead = H if plan.joint_frames is None else plan.joint_frames
        self._put_constraints(ahead, self._rows)
        columns, nodes = self._rows.copy(), self._nodes
        if plan.forces_at is not None:
            self._put_constraints(plan.forces_at, columns)
        columns += self.friction_columns
        for rows in (columns, self._rows):
            self._averages.put(rows)
        if plan.motions is not None:
            self.parts.refer_to_unknowns(plan.motions)
        for rows, maps in ((self._rows, plan.end_motions), (columns, plan.start_forces)):
            if maps is not None:
                map_rows(rows, maps, nodes)
        if plan.matrix_terms.gyroscopic and plan.d.any():
            self.parts.refer_to_twists(kinds, plan.d)
        self.parts.add_K()
        if self.supports:
            self.supports.rotate_blocks(ahead, self.A)
            self.supports.rotate_constraints(ahead, columns)
            self.supports.rotate_constraints(ahead, self._rows)
        if plan.inertial:
            pattern = self.kkt.indptr, self.kkt.indices
            to_inertial(kinds, self.A, columns, self._rows, ahead, nodes, *pattern)
        scale = self.constraint_scale(ahead, plan.spread) if plan.scale is None else plan.scale
        self._fill(self.A, columns, scale)
        self.parts.release()
        self._filled = True
        return scale
