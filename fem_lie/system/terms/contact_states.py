"""State of the contacts of a scene or of a part, by their numbers in the scene.

A rank of a divided scene has some of the contacts, and numbers nodes of its own. Files have the
state of a contact under its number in the scene, with the numbers of the nodes of the scene: it is
the same on any number of ranks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import part_of
from fem_lie.forms.abilities import ContactState
from fem_lie.forms.term import Term
from fem_lie.parts.part_scene import ScenePart, scene_numbers, undivided
from fem_lie.scene import Scene
from fem_lie.system.nodes.numbering import Numbering

_PAIRS = "pairs"


def _named(number: int) -> str:
    """Name of a contact in a state."""
    return f"contact {number}"


class ContactStates:
    """State of contacts by their numbers in the scene."""

    def __init__(
        self, terms: Iterable[Term], scene: Scene, numbering: Numbering, part: ScenePart | None
    ) -> None:
        """Find the contacts among terms.

        Args:
            terms: All terms, those of contacts in the order of the scene.
            scene: The scene, or that of the part of this rank.
            numbering: Numbers of its nodes.
            part: What this rank has of a divided scene; ``None``: all.
        """
        pairs = ((term, term.of_contact) for term in terms)
        found = [(term, state) for term, state in pairs if state is not None]
        self._each: dict[int, tuple[Term, ContactState]] = {}
        self._numbers: Indices = np.empty(0, dtype=np.int64)
        if found:
            own = part or undivided(scene)
            self._each = dict(zip(map(int, own.contacts), found, strict=True))
            self._numbers = scene_numbers(own, numbering.nodes)

    def saved_state(self) -> dict[str, Array]:
        """State without the lists of pairs."""
        return {
            f"{_named(number)}.{name}": values
            for number, (_, state) in self._each.items()
            for name, values in state.contact_state(self._numbers).items()
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`."""
        if not self._each:
            return
        nodes: Indices = np.full(1 + int(self._numbers.max()), -1)
        nodes[self._numbers] = np.arange(len(self._numbers))
        for number, (_, state) in self._each.items():
            state.restore_contact(part_of(kept, _named(number)), nodes)

    @property
    def pairs(self) -> dict[str, Array]:
        """State of the lists of pairs of points that are near each other."""
        return {
            f"{_named(number)}.{_PAIRS}": term.pair_positions.copy()
            for number, (term, _) in self._each.items()
        }

    def restore_pairs(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :attr:`pairs`."""
        for number, (term, _) in self._each.items():
            term.restore_pairs(kept[f"{_named(number)}.{_PAIRS}"])
