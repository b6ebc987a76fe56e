"""What equations remember beside a state: carried stress, turns of joints, axes that follow."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.node_types import Written
from fem_lie.linear.low_rank import LowRank
from fem_lie.system.system import System
from fem_lie.system.terms.all_terms import Terms

_PART = "low rank."  # of names in a checkpoint


class Memory:
    """What neither states nor the time tell; the solver says when it goes on."""

    def __init__(self, system: System, terms: Terms) -> None:
        """Of a system.

        Args:
            system: The equations.
            terms: Those that carry something.
        """
        self._system, self._terms, self._connections = system, terms, system.connections

    def carry(self, H: Array, h: Array | None = None) -> None:
        """Carry the stress on along the increment ``h`` (6 n,) made from frames ``H``.

        Without an increment: begin at these frames with the true one.
        """
        if h is None:
            self._terms.reset_stress(H)
        else:
            self._terms.carry(H, h)

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Give springs the forces that they have at the end of ``h`` (6 n,), at frames ``H``.

        To first order, by rest values that are changed; with ``h`` zero these are the scene's own.
        """
        for each in self._connections.sets:
            each.stretch_springs(H, h.reshape(-1, 6))

    def unchanged(self) -> AbstractContextManager[None]:
        """Context in which looking at states does not change what elements carry."""
        return self._terms.unchanged()

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Go on from here: joints count their turns, and what rubs its slips.

        Args:
            H: Frames of all rows.
            start: Those at the start of the step, with which it is looked whether surfaces went
                through each other.

        Raises:
            PassedThroughError: They did; all is as it was.
            ValueError: Something slid off its beam.
        """
        if start is not None:
            self._terms.check_passage(start, H)
        self._connections.accept(H)
        self._terms.accept(H)

    def follow(self, H: Array, h: Array) -> None:
        """Let joints count their angles along the increment ``h`` (6 n,) made from frames ``H``."""
        self._connections.follow(H, h.reshape(-1, 6))

    def check_passage(self, start: Array, end: Array) -> None:
        """Look whether surfaces go through each other in a step that is not yet accepted.

        Args:
            start: Frames of all rows at its start.
            end: At its end.

        Raises:
            PassedThroughError: They do.
        """
        self._terms.check_passage(start, end)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None = None) -> None:
        """Note an accepted step of a scheme that does not conserve energy by itself.

        Args:
            start: Frames of all rows at its start.
            end: At its end.
            h: Its size.
            middle: Where forces act in the step; default: at both ends.
        """
        self._terms.watch(start, end, h, middle)

    def rotate_axes(
        self, H: Array, motion: Array | None = None, written: Written | None = None
    ) -> None:
        """Turn axes that follow a mid-surface or what is around them, and what is written in them.

        Args:
            H: Frames of all rows.
            motion: Velocities, accelerations and the like, shape (k, n, 6); default: none.
            written: How these are written.
        """
        for carried in self._system.carried:
            if motion is None or written is None:
                carried.turn(H)
            else:
                carried.turn_motion(H, motion, self._system.kinds, written)

    def memory(self) -> dict[str, Array]:
        """All that what comes depends on but the state, the time and the matrix."""
        kept = {f"carried.{k}": part for k, part in enumerate(self._terms.carried())}
        kept["joints"] = self._connections.memory
        return kept | {f"watched.{k}": part for k, part in enumerate(self._terms.watched())}

    @property
    def with_matrix(self) -> WithMatrix:
        """All of it, and the matrix."""
        return WithMatrix(self, self._system, self._terms)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        self._connections.memory = kept["joints"]
        count = sum(name.startswith("carried.") for name in kept)
        self._terms.restore([kept[f"carried.{k}"] for k in range(count)])
        watched = sum(name.startswith("watched.") for name in kept)
        self._terms.watch_again([kept[f"watched.{k}"] for k in range(watched)])


@dataclass(frozen=True)
class WithMatrix:
    """The memory of equations, their matrix, and what that was made of, as one state.

    Attributes:
        of: The memory alone.
        system: The equations.
        terms: Those that know what is near.
    """

    of: Memory
    system: System
    terms: Terms

    def memory(self) -> dict[str, Array]:
        """All of it."""
        kkt = self.system.kkt
        kept = self.of.memory() | {"matrix": kkt.csr[0], "blocks": self.system.tangent.A}
        kept |= {"row pointers": kkt.indptr, "columns": kkt.indices}
        if kkt.low_rank is not None:
            kept |= {_PART + name: array for name, array in kkt.low_rank._asdict().items()}
        return kept | {f"seen.{k}": term.seen.copy() for k, term in enumerate(self.terms)}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called.

        Raises:
            ValueError: There are subdomains now, whose matrices are in no file.
        """
        kkt, tangent = self.system.kkt, self.system.tangent
        if kkt.part is not None:
            raise ValueError(
                "a run goes on without subdomains, whose matrices no file has: leave PETSc's "
                "option domains out, got it set"
            )
        self.of.restore(kept)
        for k, term in enumerate(self.terms):
            term.see_again(kept[f"seen.{k}"])
        pattern = kept["row pointers"], kept["columns"]
        tangent.restore_pattern(*(part.astype(np.int64) for part in pattern))
        tangent.A[:] = kept["blocks"]
        found: dict[str, Any] = {
            name: kept[_PART + name] for name in LowRank._fields if _PART + name in kept
        }
        kkt.low_rank = LowRank(**found) if found else None
        kkt.restore(kept["matrix"])
