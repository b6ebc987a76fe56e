"""Which terms a scene has."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fem_lie._arrays import Indices
from fem_lie.contact.contact import Contact
from fem_lie.forms.term import Term
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.nodes.numbering import Numbering
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.terms.followed import Followed
from fem_lie.system.terms.mass_damping import MassDamping
from fem_lie.system.terms.springs import Dampers, Springs


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
        damping: That goes with mass, of the leaders.
        kinds: Of the nodes that lead.
        moving: Whether there are velocities.
    """
    attachment, everywhere = numbering.attachment, slice(0, numbering.total)
    found: list[Term] = []
    for where, assembly in numbering.assemblies:
        found += [Followed(term, where, attachment) for term in (assembly, *assembly.beside)]
    found += [Followed(term, everywhere, attachment) for term in loads]
    nodes = numbering.nodes.__getitem__
    found += [Followed(each.term(nodes), everywhere, attachment) for each in contacts]
    of_all = numbering.count, sum(each.m for each in joints)
    found += [Springs(each, *of_all) for each in joints if each.springs[:, 0].any()]
    if moving:
        found += [Dampers(each, *of_all) for each in joints if each.springs[:, 1].any()]
    if moving and len(damping.blocks):
        found.append(MassDamping(damping, kinds))
    return Terms(found, numbering.count, moving=moving)
