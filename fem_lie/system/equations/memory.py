"""What equations remember beside a state: carried stress, turns of joints, axes that follow."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.kinds import Written
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

    def turn_axes(
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

    def saved(self, *, matrix: bool = False) -> dict[str, Array]:
        """All that what comes depends on but the state and the time; ``matrix``: that, too."""
        saved = {f"carried.{k}": part for k, part in enumerate(self._terms.carried())}
        saved["joints"] = self._connections.memory
        saved |= {f"watched.{k}": part for k, part in enumerate(self._terms.watched())}
        if matrix:
            kkt = self._system.kkt
            saved |= {"matrix": kkt.csr[0], "blocks": self._system.tangent.A}
            saved |= {"row pointers": kkt.indptr, "columns": kkt.indices}
            if kkt.low_rank is not None:
                parts = kkt.low_rank._asdict()
                saved |= {_PART + name: array for name, array in parts.items()}
            saved |= {f"seen.{k}": term.seen.copy() for k, term in enumerate(self._terms)}
        return saved

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Be as when :meth:`saved` was called.

        Raises:
            ValueError: There is a matrix, and now subdomains, whose matrices were not saved.
        """
        if "matrix" in saved and self._system.kkt.part is not None:
            raise ValueError(
                "a run goes on without subdomains, whose matrices no file has: leave PETSc's "
                "option domains out, got it set"
            )
        self._connections.memory = saved["joints"]
        count = sum(name.startswith("carried.") for name in saved)
        self._terms.restore([saved[f"carried.{k}"] for k in range(count)])
        # checkpoints of earlier versions do not have it
        if watched := sum(name.startswith("watched.") for name in saved):
            self._terms.watch_again([saved[f"watched.{k}"] for k in range(watched)])
        if "matrix" in saved:
            for k, term in enumerate(self._terms):
                term.see_again(saved[f"seen.{k}"])
            pattern, kkt = (saved["row pointers"], saved["columns"]), self._system.kkt
            self._system.tangent.restore_pattern(*(part.astype(np.int64) for part in pattern))
            self._system.tangent.A[:] = saved["blocks"]
            found: dict[str, Any] = {
                name: saved[_PART + name] for name in LowRank._fields if _PART + name in saved
            }
            kkt.low_rank = LowRank(**found) if found else None
            kkt.restore(saved["matrix"])
