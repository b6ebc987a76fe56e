"""List of the pairs of points of a contact that are near each other, with updates."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.detection import moved_by, near, near_between
from fem_lie.contact.sides.kinematics import count_blocks, gaps, positions
from fem_lie.contact.sides.table import ROUND, Side

_MARGIN = 0.5
"""Initial margin of the list relative to the mean radius of balls."""


class NearPairs:
    """Pairs of points that may touch, in increasing order.

    Attributes:
        now: Indices of the first and second points, shape (m, 2).
        blocks: First and second node of all matrix blocks of the pairs.
        first: First block of each pair, shape (m,).
        version: Version of the list; it changes with the list.
        fixed: Whether the list always has all pairs.
        patience: Largest displacement of points before the list has to be updated.
    """

    def __init__(
        self, a: Side, b: Side, *, kind: int, same: bool, left_out: Indices | None = None
    ) -> None:
        """Find the pairs that are possible.

        Args:
            a: First side.
            b: Second side.
            kind: Kind of the pairs; those with balls are near each other, of others all pairs are.
            same: Whether both sides are the same.
            left_out: Pairs of points that never touch, shape (m, 2); default: none.
        """
        none = np.empty((0, 2), dtype=np.int64) if left_out is None else left_out
        self._left_out = np.sort(none[:, 0] * len(b.radii) + none[:, 1])
        self._a, self._b, self._same, self.version = a, b, same, 0
        self._kind = kind
        self._ignored: Indices = np.empty(0, dtype=np.int64)
        hollow = bool((b.radii < 0.0).any())
        self.fixed = kind != ROUND or hollow
        count = len(a.radii) if same else len(a.radii) + len(b.radii)
        self._at, self._before = np.empty((count, 3)), np.full((count, 3), np.inf)
        radii = a.radii if same else np.concatenate([a.radii, b.radii])
        self._margin = _MARGIN * float(radii.mean())
        self._reach, self.patience = radii + self._margin, 0.5 * self._margin
        self._set(self._all() if self.fixed else np.empty((0, 2), dtype=np.int64))

    def _all(self) -> Indices:
        """All pairs on different frames, except for ignored ones."""
        found = np.argwhere(self._a.owners[:, np.newaxis] != self._b.owners)
        pairs = np.array(found, dtype=np.int64).reshape(-1, 2)
        return np.ascontiguousarray(pairs[~np.isin(self._keys(pairs), self._ignored)])

    def _keys(self, pairs: Indices) -> Indices:
        return np.asarray(pairs[:, 0] * len(self._b.radii) + pairs[:, 1])

    @property
    def ignores(self) -> bool:
        """Whether pairs are ignored until they separate."""
        return len(self._ignored) > 0

    def ignore(self, H: Array) -> None:
        """Ignore pairs that overlap at frames ``H``, until :meth:`part` finds them separate."""
        self.update(H)
        g, _ = gaps(H, self._a, self._b, self.now, self._kind)
        self._ignored = self._keys(self.now[g < 0.0])
        self._again()

    def part(self, H: Array) -> None:
        """No longer ignore pairs that have separated at frames ``H``."""
        if not self.ignores:
            return
        pairs = np.stack(np.divmod(self._ignored, len(self._b.radii)), axis=1)
        g, _ = gaps(H, self._a, self._b, pairs, self._kind)
        if (g >= 0.0).any():
            self._ignored = self._ignored[g < 0.0]
            self._again()

    def _again(self) -> None:
        if self.fixed:
            self._set(self._all())
            self.version += 1
        else:
            self._look(self._before)

    def _set(self, pairs: Indices) -> None:
        self.now = pairs
        none = np.empty(0, dtype=np.int64)
        count = count_blocks(self._a, self._b, pairs, none, none)
        self.blocks = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
        count_blocks(self._a, self._b, pairs, *self.blocks)
        moving = (self._a.nodes >= 0).sum(axis=1), (self._b.nodes >= 0).sum(axis=1)
        each = (moving[0][pairs[:, 0]] + moving[1][pairs[:, 1]]) ** 2
        self.first = np.cumsum(each) - each

    def update(self, H: Array) -> None:
        """Update the list for frames ``H`` if points have moved too far since its last update."""
        if not self.fixed and self._moved(H) > self.patience:
            self._look(self._at)

    def cover(self, start: Array, end: Array) -> None:
        """Make the list contain all pairs in contact at either end of a step."""
        self.update(start)
        if not self.fixed and (moved := self._moved(end)) > self._margin:
            self._widen(2.0 * moved)
            self._moved(start)
            self._look(self._at)

    @property
    def margin(self) -> float:
        """Distance that is added to radii in the list."""
        return self._margin

    def widen(self, margin: float) -> None:
        """Increase the margin; the list of pairs is updated when it is next needed."""
        if not self.fixed and margin > self._margin:
            self._widen(margin)
            self._before[:] = np.inf

    def _widen(self, margin: float) -> None:
        self._reach += margin - self._margin
        self._margin, self.patience = margin, 0.5 * margin

    def _moved(self, H: Array) -> float:
        """Largest displacement of points since the last update of the list."""
        self._set_positions(H, self._at)
        return moved_by(self._at, self._before)

    def _set_positions(self, H: Array, out: Array) -> None:
        """Points of the first side, then those of the second, shape (n, 3)."""
        n = len(self._a.radii)
        positions(H, self._a, out[:n])
        if not self._same:
            positions(H, self._b, out[n:])

    @property
    def pair_positions(self) -> Array:
        """State: positions at the last update, margin, and ignored pairs, shape (·, 3)."""
        ignored = np.zeros((len(self._ignored), 3))
        ignored[:, 0] = self._ignored
        if self.fixed:
            return ignored
        return np.vstack([self._before, [self._margin, 0.0, 0.0], ignored])

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the list from its state :attr:`pair_positions`."""
        n = 0 if self.fixed else len(self._before)
        self._ignored = pair_positions[n if self.fixed else n + 1 :, 0].astype(np.int64)
        if self.fixed:
            self._again()
        else:
            self._widen(float(pair_positions[n, 0]))
            self._look(pair_positions[:n])

    def in_step(
        self, start: Array, end: Array
    ) -> tuple[tuple[Array, Array], tuple[Array, Array], Indices]:
        """Points at both ends of a step, and the pairs that may have met on straight paths.

        Args:
            start: Frames at the start of the step.
            end: Frames at the end of the step.

        Returns:
            Points of both sides at the start, shapes (n, 3) and (m, 3), at the end, and pairs.
        """
        X = np.empty((2, *self._at.shape))
        for at, H in zip(X, (start, end), strict=True):
            self._set_positions(H, at)
        ways = X[1] - X[0]
        # points that move together never meet
        ways -= ways.mean(axis=0)
        far = np.linalg.norm(ways, axis=1)
        pairs = self.now
        if not 2.0 * far.max(initial=0.0) <= self.patience:
            pairs = self.within(0.5 * (X[0] + X[1]), self._reach - self._margin + 0.5 * far)
        n = len(self._a.radii)
        before, after = ((at[:n], at if self._same else at[n:]) for at in X)
        return before, after, pairs

    def _look(self, at: Array) -> None:
        """Make the list for these positions."""
        if not np.isfinite(at).all():
            return
        self._before[:] = at
        pairs = self.within(self._before, self._reach)
        if not np.array_equal(pairs, self.now):
            self._set(pairs)
            self.version += 1

    def within(self, at: Array, reach: Array) -> Indices:
        """Pairs of points near each other, without those on the same frame, shape (m, 2).

        Args:
            at: Points of the first side, then those of the second, shape (n, 3).
            reach: Reach of each point, shape (n,).
        """
        n = len(self._a.radii)
        if self._same:
            pairs = near(at, reach)
        else:
            pairs = near_between(at, reach, n) - np.array([0, n])
        separation = self._a.owners[pairs[:, 0]] != self._b.owners[pairs[:, 1]]
        if len(self._left_out):
            keys = pairs[:, 0] * len(self._b.radii) + pairs[:, 1]
            at = np.minimum(np.searchsorted(self._left_out, keys), len(self._left_out) - 1)
            separation &= self._left_out[at] != keys
        if self.ignores:
            separation &= ~np.isin(self._keys(pairs), self._ignored)
        return np.ascontiguousarray(pairs[separation])


class SlotPairs(NearPairs):
    """Pairs of corresponding points: the slots of contact manifolds."""

    def _all(self) -> Indices:
        return np.repeat(np.arange(len(self._a.radii)), 2).reshape(-1, 2)
