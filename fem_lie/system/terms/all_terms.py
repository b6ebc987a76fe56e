"""The terms of a scene, and their sum."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.contact import Contact
from fem_lie.forms.cell_forms import FormTable, add_cells, joined, of_some_cells
from fem_lie.forms.term import FollowingTable, Pairs, Term
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.nodes.numbering import Numbering
from fem_lie.system.terms.attached import AttachedTerm
from fem_lie.system.terms.near import AttachedCells, NearTerms
from fem_lie.system.terms.springs import Dampers, MassDamping, Springs


class Terms:
    """Terms on the nodes that lead; those that are sums over cells are one sum.

    Attributes:
        tables: Of forces and of energy of these, for
            :func:`~fem_lie.forms.cell_forms.add_cells`.
        following: All cells whose nodes follow others.
        viscous: Whether any has forces that depend on twists and that no other sum has.
        viscous_labels: What those are called that have such forces.
        loads: Those that act from outside.
        all_in_tables: Whether the forces of all are in the tables, in :attr:`following` or in the
            sum over joints.
        energy_in_tables: Whether the energy of all is.
    """

    def __init__(self, terms: Sequence[Term], count: int, *, moving: bool) -> None:
        """Find out which can be summed how.

        Args:
            terms: In the order in which they are summed up.
            count: Nodes that may move.
            moving: Whether they do, so that there are twists.
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
        self._by_themselves = [(k, term) for k, term in self._apart if term.following is None]
        self.following = _following([term.following for _, term in self._apart])
        self._with_energy = [t for t, both in zip(self._terms, tables, strict=True) if both is None]
        viscous = [(t, t.viscosity) for t in self._terms if moving and t.viscosity is not None]
        self._viscous = [viscosity for t, viscosity in viscous if not t.within_joints]
        self.viscous_labels = tuple(dict.fromkeys(t.label for t, _ in viscous))
        self._energy = np.zeros(1)
        self._stresses = [t.stress_update for t in self._terms if t.stress_update is not None]
        self._paths = [t.path for t in self._terms if t.path is not None]
        self._passages = [t.passage for t in self._terms if t.passage is not None]
        self._local = [t.local for t in self._terms if t.local is not None]
        self.all_in_tables = not self._by_themselves
        within = [term.within_joints or term.load for term in self._with_energy]
        self.energy_in_tables = all(within)
        self.viscous = bool(self._viscous)
        self.loads = tuple(t for t in self._terms if t.load)

    def __iter__(self) -> Iterator[Term]:
        """One after the other."""
        return iter(self._terms)

    def chosen(self, wanted: Callable[[Term], bool]) -> Terms:
        """Some of them."""
        some = [term for term in self._terms if wanted(term)]
        return Terms(some, self._size // 6, moving=self._moving)

    @property
    def versions(self) -> tuple[int, ...]:
        """Of the patterns of all."""
        return tuple(term.version for term in self._terms)

    @property
    def pairs(self) -> list[Pairs]:
        """Of all."""
        return [term.pairs for term in self._terms]

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """Of the one that has them, see :attr:`~fem_lie.forms.term.Term.rates`."""
        viscous = [term.viscosity for term in self._terms if term.viscosity is not None]
        found = [each.rates for each in viscous if each.rates is not None]
        assert len(found) <= 1
        return found[0] if found else None

    # --- forces ---

    def room(self) -> list[Array]:
        """For those of the forces that tangents take."""
        return [term.room() for term in self._terms]

    def add_forces(self, H: Array, r: Array, kept: Sequence[Array] | None = None) -> None:
        """Add all that depend on frames, but for those in the sum over joints, to ``r``.

        Args:
            H: Frames of all rows.
            r: Shape (≥ 6 count,).
            kept: See :meth:`room`, overwritten; default: nothing is kept.

        Raises:
            ValueError: ``r`` has another shape, beyond which compiled sums would write.
        """
        if r.ndim != 1 or len(r) < self._size:
            raise ValueError(
                f"forces of terms go into an array of shape ({self._size},) or longer, "
                f"got one of shape {r.shape}"
            )
        add_cells(H, self.tables[0], 6, r)
        self.following.add_forces(H, r)
        self.add_others(H, r, kept)

    def add_others(self, H: Array, r: Array, kept: Sequence[Array] | None = None) -> None:
        """:meth:`add_forces` without those of :attr:`tables` and of :attr:`following`."""
        nodal = r[: self._size].reshape(-1, 6)
        for k, term in self._by_themselves:
            term.add_forces(H, nodal, None if kept is None else kept[k])

    def near(self, nodes: Flags) -> NearTerms | None:
        """The forces of :meth:`add_forces` on some nodes alone, if that is less work.

        Args:
            nodes: Which, shape (count,).
        """
        others = [term.near(nodes) for _, term in self._apart]
        known = [other for other in others if other is not None]
        if len(known) < len(others):
            return None
        return NearTerms(of_some_cells(FormTable(*self.tables[0]), nodes), known)

    def add_viscous_forces(self, H: Array, v: Array, r: Array) -> None:
        """Add those that depend on twists, with the same exception."""
        nodal = r[: self._size].reshape(-1, 6)
        for viscosity in self._viscous:
            viscosity.add_viscous_forces(H, v, nodal)

    def of_loads(self, H: Array) -> Array:
        """Forces of all loads, as they act on the nodes, shape (count, 6)."""
        found = np.zeros((self._size // 6, 6))
        for term in self.loads:
            term.add_forces(H, found)
        return -found

    def energy(self, H: Array) -> float:
        """Stored energy."""
        self._energy[0] = 0.0
        add_cells(H, self.tables[1], 0, self._energy)
        total = float(self._energy[0])
        for term in self._with_energy:
            total += term.energy(H)
        return total

    # --- what states do not say ---

    def carry(self, H: Array, h: Array) -> None:
        """Update all stresses along the increment ``h`` (6 count,) made from frames ``H``."""
        for each in self._stresses:
            each.carry(H, h.reshape(-1, 6))

    def check_passage(self, start: Array, end: Array) -> None:
        """Look whether surfaces went through each other in a step between frames."""
        for each in self._passages:
            each.check_passage(start, end)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Note a step of a scheme that does not conserve energy."""
        for each in self._passages:
            each.watch(start, end, h, middle)

    def watched(self) -> list[Array]:
        """What has been noted of steps, term by term."""
        return [each.watched for each in self._passages]

    def watch_again(self, watched: Sequence[Array]) -> None:
        """Have noted again what was :meth:`watched` once."""
        for passage, values in zip(self._passages, watched, strict=True):
            passage.watch_again(values)

    def accept(self, H: Array) -> None:
        """Go on from frames ``H``."""
        for each in self._paths:
            each.accept(H)

    def carried(self) -> list[Array]:
        """Copies of what each carries from iterate to iterate."""
        return [each.carried.copy() for each in self._stresses]

    def restore(self, carried: Sequence[Array]) -> None:
        """Carry again what was carried when it was copied."""
        for each, values in zip(self._stresses, carried, strict=True):
            each.restore(values)

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Carry in the end what was carried before: to look at a state changes nothing."""
        carried = self.carried()
        try:
            yield
        finally:
            self.restore(carried)

    def clear_stress(self) -> None:
        """Make all carried stresses zero: a tangent without geometric stiffness."""
        for each in self._stresses:
            each.clear_stress()

    def condense(self, H: Array) -> None:
        """Solve for unknowns of cells at frames ``H``."""
        for each in self._local:
            each.condense(H)

    def reset_stress(self, H: Array) -> None:
        """Make all carried stresses the true ones at frames ``H``."""
        for each in self._stresses:
            each.reset_stress(H)


def _following(parts: Sequence[FollowingTable | None]) -> AttachedCells:
    """All in one."""
    some = [part for part in parts if part is not None]
    first = [sum(len(part.master) for part in some[:k]) for k in range(len(some))]
    table = FormTable(*joined([part.table for part in some], first))
    master: Indices = np.concatenate([np.empty(0, np.int64), *(part.master for part in some)])
    offset = np.concatenate([np.empty((0, 4, 3)), *(part.offset for part in some)])
    return AttachedCells(table, master, offset)


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
    """Elements and what is on their nodes, loads with a matrix, then what acts between bodies.

    Args:
        numbering: Of the nodes, with the assembled elements.
        loads: On all nodes.
        contacts: Between bodies, and with ground.
        joints: Sets of constraints, with springs and dampers.
        damping: That goes with mass, of the master nodes.
        kinds: Of the nodes that lead.
        moving: Whether there are velocities.
    """
    master_map, everywhere = numbering.master_map, slice(0, numbering.total)
    found: list[Term] = []
    for where, assembly in numbering.assemblies:
        found += [AttachedTerm(term, where, master_map) for term in (assembly, *assembly.beside)]
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
