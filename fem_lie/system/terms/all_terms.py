"""The terms of a scene, and their sum."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.contact import Contact
from fem_lie.forms.abilities import FRICTION_COLUMNS
from fem_lie.forms.cell_forms import FormArrays, add_forces, energy_of, joined, of_some_cells
from fem_lie.forms.term import AttachedForms, Pairs, Term
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.nodes.numbering import Numbering
from fem_lie.system.terms.attached import AttachedTerm, on_master_nodes
from fem_lie.system.terms.near import AttachedCells, NearTerms
from fem_lie.system.terms.springs import Dampers, MassDamping, Springs


class Terms:
    """Terms on the master nodes; all terms that are sums over cells are one compiled sum.

    Attributes:
        tables: Cells with forces and cells with energy, for
            :func:`~fem_lie.forms.cell_forms.add_forces`.
        attached_cells: All cells with rigidly attached nodes.
        viscous: Whether any term has forces that depend on twists and are in no other sum.
        viscous_labels: Labels of terms with such forces.
        loads: Terms that are loads.
        all_in_tables: Whether all forces are in the tables, in :attr:`attached_cells` or in the
            sum over joints.
        energy_in_tables: Whether all energy is in the tables.
    """

    def __init__(self, terms: Sequence[Term], count: int, *, moving: bool) -> None:
        """Sort the terms by how they are summed.

        Args:
            terms: Terms in the order of summation.
            count: Number of moving nodes.
            moving: Whether there are twists.
        """
        self._terms, self._size, self._moving = tuple(terms), 6 * count, moving
        tables = [term.tables for term in self._terms]
        parts = [both for both in tables if both is not None]
        self.tables: list[tuple[Indices, Indices]] = [
            joined([both[k] for both in parts], [0] * len(parts)) for k in range(2)
        ]
        self._apart = [
            (k, term)
            for k, term in enumerate(self._terms)
            if tables[k] is None and not term.within_joints
        ]
        self._by_themselves = [(k, term) for k, term in self._apart if term.attached_cells is None]
        self.attached_cells = _attached_cells([term.attached_cells for _, term in self._apart])
        self._with_energy = [t for t, both in zip(self._terms, tables, strict=True) if both is None]
        viscous = [(t, t.viscosity) for t in self._terms if moving and t.viscosity is not None]
        self._viscous = [viscosity for t, viscosity in viscous if not t.within_joints]
        self.viscous_labels = tuple(dict.fromkeys(t.label for t, _ in viscous))
        self._stresses = [t.stress_update for t in self._terms if t.stress_update is not None]
        without = [t for t in self._terms if t.of_contact is None]
        self._of_bodies = [t.stress_update for t in without if t.stress_update is not None]
        self._paths = [t.path for t in self._terms if t.path is not None]
        self._passages = [t.passage for t in self._terms if t.passage is not None]
        self._watched = [t.passage for t in without if t.passage is not None]
        self._local = [t.local for t in self._terms if t.local is not None]
        self.all_in_tables = not self._by_themselves
        within = [term.within_joints or term.load for term in self._with_energy]
        self.energy_in_tables = all(within)
        self.viscous = bool(self._viscous)
        self.loads = tuple(t for t in self._terms if t.load)

    def __iter__(self) -> Iterator[Term]:
        """Iterate over the terms."""
        return iter(self._terms)

    def chosen(self, selected: Callable[[Term], bool]) -> Terms:
        """Selection of terms."""
        some = [term for term in self._terms if selected(term)]
        return Terms(some, self._size // 6, moving=self._moving)

    @property
    def versions(self) -> tuple[int, ...]:
        """Versions of the node pairs of all terms."""
        return tuple(term.version for term in self._terms)

    @property
    def pairs(self) -> list[Pairs]:
        """Node pairs of all terms."""
        return [term.pairs for term in self._terms]

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """Mass-proportional damping matrix of the term that has one, or ``None``."""
        viscous = [term.viscosity for term in self._terms if term.viscosity is not None]
        found = [each.rates for each in viscous if each.rates is not None]
        assert len(found) <= 1
        return found[0] if found else None

    # --- forces ---

    def workspace(self) -> list[Array]:
        """Arrays for the forces that tangents need."""
        return [term.workspace() for term in self._terms]

    def add_forces(self, H: Array, r: Array, kept: Sequence[Array] | None = None) -> None:
        """Add all forces that depend on frames, except those in the sum over joints, to ``r``.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            r: Shape (≥ 6 count,).
            kept: Arrays of :meth:`workspace`, overwritten; default: forces are not stored.

        Raises:
            ValueError: ``r`` is too short, and compiled sums would write beyond it.
        """
        if r.ndim != 1 or len(r) < self._size:
            raise ValueError(
                f"forces of terms go into an array of shape ({self._size},) or longer, "
                f"got one of shape {r.shape}"
            )
        add_forces(H, self.tables[0], r)
        self.attached_cells.add_forces(H, r)
        self.add_others(H, r, kept)

    def add_others(self, H: Array, r: Array, kept: Sequence[Array] | None = None) -> None:
        """:meth:`add_forces` without those of :attr:`tables` and of :attr:`attached_cells`."""
        nodal = r[: self._size].reshape(-1, 6)
        for k, term in self._by_themselves:
            term.add_forces(H, nodal, None if kept is None else kept[k])

    def near(self, nodes: Flags) -> NearTerms | None:
        """Forces of :meth:`add_forces` on some nodes only, if that is less work, or ``None``.

        Args:
            nodes: Whether a node is needed, shape (count,).
        """
        others = [term.near(nodes) for _, term in self._apart]
        known = [other for other in others if other is not None]
        if len(known) < len(others):
            return None
        return NearTerms(of_some_cells(FormArrays(*self.tables[0]), nodes), known)

    def add_viscous_forces(self, H: Array, v: Array, r: Array) -> None:
        """Add forces that depend on twists, except those in the sum over joints."""
        nodal = r[: self._size].reshape(-1, 6)
        for viscosity in self._viscous:
            viscosity.add_viscous_forces(H, v, nodal)

    def of_loads(self, H: Array) -> Array:
        """Forces of all load terms on the nodes, shape (count, 6)."""
        found = np.zeros((self._size // 6, 6))
        for term in self.loads:
            term.add_forces(H, found)
        return -found

    def energy(self, H: Array) -> float:
        """Stored energy."""
        total = float(energy_of(H, self.tables[1]))
        for term in self._with_energy:
            total += term.energy(H)
        return total

    # --- what states do not say ---

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the independent stress along the increment ``h`` (6 count,) from frames ``H``."""
        for each in self._stresses:
            each.update_stress(H, h.reshape(-1, 6))

    def check_passage(self, start: Array, end: Array) -> None:
        """Check whether surfaces passed through each other in a step between frames."""
        for each in self._passages:
            each.check_passage(start, end)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Record a step of a scheme that does not conserve energy."""
        for each in self._passages:
            each.watch(start, end, h, middle)

    def watched(self) -> list[Array]:
        """Records of steps, term by term, without those of contacts."""
        return [each.watched for each in self._watched]

    def watch_again(self, watched: Sequence[Array]) -> None:
        """Restore the records of :meth:`watched`."""
        for passage, values in zip(self._watched, watched, strict=True):
            passage.watch_again(values)

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept frames ``H`` as the state from which the next step starts.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            start: Frames at the start of the step, if there was a step.
        """
        for each in self._paths:
            each.accept(H, start)

    @property
    def has_friction(self) -> bool:
        """Whether any forces depend on the motion since the last accepted state."""
        return any(each.friction for each in self._paths)

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction in all accepted steps."""
        return sum(each.dissipated for each in self._paths)

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state with ``H``, twists ``v``, shape (k, 10).

        The key of the contact, then the columns of
        :meth:`~fem_lie.forms.abilities.PathDependence.friction_forces`.
        """
        found = [np.empty((0, 1 + FRICTION_COLUMNS))]
        for each in self._paths:
            forces = each.friction_forces(H, v)
            found.append(np.column_stack([np.full(len(forces), float(each.key)), forces]))
        return np.concatenate(found)

    def linearised_values(self) -> list[Array]:
        """Copies of the history variables of the terms, without those of contacts."""
        return [each.linearised_values.copy() for each in self._of_bodies]

    def restore(self, stresses: Sequence[Array]) -> None:
        """Restore the copies of :meth:`linearised_values`."""
        for each, values in zip(self._of_bodies, stresses, strict=True):
            each.restore(values)

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Context at whose end the history variables are restored, to evaluate a state.

        Those of contacts change only where states are accepted.
        """
        stresses = self.linearised_values()
        try:
            yield
        finally:
            self.restore(stresses)

    def clear_stress(self) -> None:
        """Set the independent stress to zero: a tangent without geometric stiffness."""
        for each in self._stresses:
            each.clear_stress()

    def condense(self, H: Array) -> None:
        """Solve for local unknowns of cells at frames ``H``."""
        for each in self._local:
            each.condense(H)

    def reset_stress(self, H: Array) -> None:
        """Reset the independent stress to that at frames ``H``."""
        for each in self._stresses:
            each.reset_stress(H)


def _attached_cells(parts: Sequence[AttachedForms | None]) -> AttachedCells:
    """Cells with attached nodes of all terms in one record."""
    some = [part for part in parts if part is not None]
    first = [sum(len(part.master) for part in some[:k]) for k in range(len(some))]
    arrays = FormArrays(*joined([part.arrays for part in some], first))
    master: Indices = np.concatenate([np.empty(0, np.int64), *(part.master for part in some)])
    offset = np.concatenate([np.empty((0, 4, 3)), *(part.offset for part in some)])
    return AttachedCells(arrays, master, offset)


def terms_of(
    numbering: Numbering,
    loads: Iterable[Term],
    contacts: Iterable[Contact],
    joints: Sequence[ConstraintSet],
    damping: Inertia,
    kinds: Indices,
    *,
    moving: bool,
) -> Terms:
    """Terms of elements, of loads with a stiffness, and between bodies, in this order.

    Args:
        numbering: Numbering of the nodes, with the assembled elements.
        loads: Load terms on all nodes.
        contacts: Contacts between bodies, and with ground.
        joints: Sets of constraints, with springs and dampers.
        damping: Mass-proportional damping of the master nodes.
        kinds: Types of the master nodes.
        moving: Whether there are velocities.
    """
    master_map, everywhere = numbering.master_map, slice(0, numbering.total)
    found: list[Term] = []
    for where, assembly in numbering.assemblies:
        found += [
            on_master_nodes(term, where, master_map) for term in (assembly, *assembly.further_terms)
        ]
    found += [AttachedTerm(term, everywhere, master_map) for term in loads]
    nodes = numbering.nodes.__getitem__
    found += [AttachedTerm(each.term(nodes), everywhere, master_map) for each in contacts]
    of_all = numbering.count, sum(each.m for each in joints)
    found += [Springs(each, *of_all) for each in joints if each.springs[:, 0].any()]
    if moving:
        found += [Dampers(each, *of_all) for each in joints if each.springs[:, 1].any()]
    if moving and len(damping.blocks):
        found.append(MassDamping(damping, kinds))
    return Terms(found, numbering.count, moving=moving)
