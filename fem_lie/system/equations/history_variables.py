"""History variables of the equations: independent stress, turns of joints, convected axes."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.forms.term import Term
from fem_lie.joints.connection import Connection, LostBranchError
from fem_lie.lie.node_types import Written
from fem_lie.linear.low_rank import LowRank
from fem_lie.parts.part_scene import ScenePart, whole_scene
from fem_lie.scene.load import Load
from fem_lie.system.constraint_sets.constraint_set import HistoryKey
from fem_lie.system.system import System
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.terms.contact_states import ContactStates

_PART = "low rank."  # prefix of names in a checkpoint


class Activity(NamedTuple):
    """What events, limits and controllers have changed; empty if they cannot.

    Attributes:
        of_constraints: Whether each constraint of the part acts, and the constant part of its
            target, by name, shape (m,).
        of_items: Whether each item of the scene that may be inactive acts, and the factor of each
            one that has any, by name.
    """

    of_constraints: dict[str, Array]
    of_items: dict[str, Array]


class HistoryVariables:
    """History variables, which neither states nor the time determine; the solver updates them.

    Attributes:
        contacts: State of the contacts.

    Activity and factors are known of all items of a scene, of which a part may have few.
    """

    def __init__(self, system: System, terms: Terms, part: ScenePart | None) -> None:
        """Store the system.

        Args:
            system: The equations.
            terms: Terms with history variables.
            part: What this rank has of a divided scene; ``None``: all.
        """
        self._system, self._terms, self._connections = system, terms, system.connections
        self.contacts = ContactStates(terms, system.scene, system.numbering, part)
        whole = whole_scene(system.scene, part)
        self._items: Mapping[Any, Any] | None = None if part is None else part.items
        self._switched, scaled = whole.switched, whole.scaled
        # drives that hold a start have targets of their own
        self._retargeted = bool(self._switched) or whole.began.state is not None
        self._acting = np.array([item.active for item in self._switched], dtype=np.float64)
        self._scaled, self._factors = list(scaled), np.array(list(scaled.values()))
        for item, factor in scaled.items():
            self.scale(item, factor)

    def update_stress(self, H: Array, h: Array | None = None) -> None:
        """Update the independent stress along the increment ``h`` (6 n,) made from frames ``H``.

        Without an increment: reset it to the stress at these frames.
        """
        if h is None:
            self._terms.reset_stress(H)
        else:
            self._terms.update_stress(H, h)

    def unchanged(self) -> AbstractContextManager[None]:
        """Context in which evaluating states does not change the history variables of elements."""
        return self._terms.unchanged()

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept a state: joints count their turns, and friction updates its slip.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            start: Frames at the start of the step, if there was a step.

        Raises:
            LostBranchError: A bushing is rotated by almost half a turn, or something slid off its
                beam.
        """
        with self._system.shared.errors(LostBranchError):
            self._connections.accept(H)
            self._terms.accept(H, start)

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Update joint angles along the increment ``h`` (6 n,) made from frames ``H``."""
        self._connections.move_reference_angles(H, h.reshape(-1, 6))

    def check_passage(self, start: Array, end: Array) -> None:
        """Check whether surfaces pass through each other in a step that is not yet accepted.

        Args:
            start: Frames of all nodes, ground and prescribed motions at its start.
            end: Frames at its end.

        Raises:
            PassedThroughError: They do.
        """
        with self._system.shared.errors(PassedThroughError):
            self._terms.check_passage(start, end)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None = None) -> None:
        """Record an accepted step of a scheme that does not conserve energy.

        Args:
            start: Frames of all nodes, ground and prescribed motions at its start.
            end: Frames at its end.
            h: Step size.
            middle: Frames at which forces act in the step; default: at both ends.
        """
        self._terms.watch(start, end, h, middle)

    def rotate_axes(
        self, H: Array, motion: Array | None = None, written: Written | None = None
    ) -> None:
        """Rotate convected nodal axes, and transform the components of motions to them.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            motion: Velocities, accelerations and so on, shape (k, n, 6); default: none.
            written: Representation of these components.
        """
        for axes in self._system.convected:
            if motion is None or written is None:
                axes.rotate(H)
            else:
                axes.rotate_motion(H, motion, self._system.kinds, written)

    def switch(self, item: Connection, H: Array, *, active: bool) -> None:
        """Activate or deactivate the constraints of a joint, drive or gear, on all ranks.

        Args:
            item: An item of the scene that may be inactive.
            H: Frames of all nodes, ground and prescribed motions.
            active: Whether its constraints act from now on.

        Raises:
            ValueError: They are to act, and the state contradicts them.
        """
        with self._system.shared.errors(ValueError):
            own = self._own(item)
            if own is not None:
                self._connections.switch(own, H, active=active)
        self._acting[self._switched.index(item)] = active

    def _own(self, item: Load | Connection) -> Any:
        """What the part of this rank has of an item; ``None`` if it has nothing."""
        return item if self._items is None else self._items.get(item)

    def acts(self, item: Connection) -> bool:
        """Whether the constraints of a joint, drive or gear act.

        Args:
            item: An item of the scene that may be inactive.
        """
        return bool(self._acting[self._switched.index(item)])

    def factor(self, item: Load | Connection) -> float:
        """Current factor of a load, spring or force law.

        Args:
            item: An item that the scene names as scaled.
        """
        return float(self._factors[self._scaled.index(item)])

    def scale(self, item: Load | Connection, factor: float) -> None:
        """Set the factor of a load, spring or force law.

        Args:
            item: An item that the scene names as scaled.
            factor: The factor.
        """
        self._factors[self._scaled.index(item)] = factor
        own = self._own(item)
        if isinstance(own, Connection):
            self._connections.scale_spring(own, factor)
        elif own is not None:
            self._system.load_cases.scale(own, factor)

    def friction_forces(self, H: Array, v: Array) -> Array | None:
        """Friction forces of contacts in the accepted state ``H`` with twists ``v``, shape (k, 10).

        See :meth:`~fem_lie.system.terms.all_terms.Terms.friction_forces`. ``None`` if no contact
        of the part has friction.
        """
        if not self._terms.has_friction:
            return None
        return self._terms.friction_forces(H, v)

    def saved_state(self) -> dict[str, Array]:
        """State of the history variables."""
        kept = {f"stress.{k}": part for k, part in enumerate(self._terms.linearised_values())}
        kept["joints"] = self._connections.history_variables
        kept |= self.activity.of_constraints | self.activity.of_items
        kept |= {f"watched.{k}": part for k, part in enumerate(self._terms.watched())}
        return kept | self.contacts.saved_state()

    @property
    def activity(self) -> Activity:
        """Which constraints act, and factors."""
        of_items = {"acting": self._acting.copy()} if self._switched else {}
        of_items |= {"factors": self._factors.copy()} if self._scaled else {}
        return Activity(self._connections.activity if self._retargeted else {}, of_items)

    @activity.setter
    def activity(self, kept: Activity) -> None:
        if self._retargeted:
            self._connections.activity = kept.of_constraints
        if self._switched:
            self._acting[:] = kept.of_items["acting"]
        for item, factor in zip(self._scaled, kept.of_items.get("factors", ()), strict=True):
            self.scale(item, float(factor))

    @property
    def turns(self) -> Mapping[HistoryKey, float]:
        """Full turns of joint angles, and arc lengths on beams, by joint and coordinate."""
        return self._connections.keyed_history_variables

    @turns.setter
    def turns(self, turns: Mapping[HistoryKey, float]) -> None:
        self._connections.history_variables = self._connections.history_from(turns)

    @property
    def with_matrix(self) -> WithMatrix:
        """History variables and the matrix as one state."""
        return WithMatrix(self, self._system, self._terms)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`."""
        self._connections.history_variables = kept["joints"]
        own = ({name: kept[name] for name in each} for each in self.activity)
        self.activity = Activity(*own)
        count = sum(name.startswith("stress.") for name in kept)
        self._terms.restore([kept[f"stress.{k}"] for k in range(count)])
        watched = sum(name.startswith("watched.") for name in kept)
        self._terms.watch_again([kept[f"watched.{k}"] for k in range(watched)])
        self.contacts.restore(kept)


@dataclass(frozen=True)
class WithMatrix:
    """History variables of equations, their matrix, and its contributions as one state.

    Attributes:
        of: The history variables.
        system: The equations.
        terms: Terms with pairs in contact.
    """

    of: HistoryVariables
    system: System
    terms: Terms

    def saved_state(self) -> dict[str, Array]:
        """State of all of these."""
        kkt = self.system.kkt
        kept = self.of.saved_state() | {"matrix": kkt.csr[0], "blocks": self.system.tangent.A}
        kept |= {"row pointers": kkt.indptr, "columns": kkt.indices}
        if self.system.connections.has_friction:
            kept["friction"] = self.system.tangent.friction_columns
        if kkt.low_rank is not None:
            kept |= {_PART + name: array for name, array in kkt.low_rank._asdict().items()}
        positions = {f"pairs.{k}": term.pair_positions.copy() for k, term in self._others}
        return kept | positions | self.of.contacts.pairs

    @property
    def _others(self) -> list[tuple[int, Term]]:
        """Numbers of the terms that are no contacts, and these."""
        return [(k, term) for k, term in enumerate(self.terms) if term.of_contact is None]

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`.

        Raises:
            ValueError: There are subdomains, whose matrices are not in checkpoints.
        """
        kkt, tangent = self.system.kkt, self.system.tangent
        if kkt.part is not None:
            raise ValueError(
                "a run restarts without subdomains, whose matrices no file has: expected PETSc's "
                "option domains unset, got it set"
            )
        self.of.restore(kept)
        for k, term in self._others:
            term.restore_pairs(kept[f"pairs.{k}"])
        self.of.contacts.restore_pairs(kept)
        pattern = kept["row pointers"], kept["columns"]
        tangent.restore_pattern(*(part.astype(np.int64) for part in pattern))
        tangent.A[:] = kept["blocks"]
        if "friction" in kept:
            tangent.friction_columns[:] = kept["friction"]
        found: dict[str, Any] = {
            name: kept[_PART + name] for name in LowRank._fields if _PART + name in kept
        }
        kkt.low_rank = LowRank(**found) if found else None
        kkt.restore(kept["matrix"])
