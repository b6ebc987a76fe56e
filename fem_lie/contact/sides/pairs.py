"""The pairs of places of a contact that are near each other, as long as they are."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.detection import moved_by, near, near_between
from fem_lie.contact.sides.kinematics import count_blocks, gaps, places
from fem_lie.contact.sides.table import Side

_SKIN = 0.5
"""Part of the mean radius of balls."""


class NearPairs:
    """Pairs of places that may touch, in increasing order.

    Attributes:
        now: First and second place, shape (m, 2).
        blocks: First and second node of all blocks of a matrix that they have.
        first: Where the blocks of each pair begin, shape (m,).
        version: Of these; another number means others.
        fixed: Whether all pairs are in the list.
        patience: How far places may move until the list is made anew.
    """

    def __init__(
        self, a: Side, b: Side, *, flat: bool, same: bool, left_out: Indices | None = None
    ) -> None:
        """Find out which pairs there may be.

        Args:
            a: First side.
            b: Second side.
            flat: Whether that are planes.
            same: Whether both sides are the same.
            left_out: Pairs of places that never touch, shape (m, 2); default: none.
        """
        none = np.empty((0, 2), dtype=np.int64) if left_out is None else left_out
        self._left_out = np.sort(none[:, 0] * len(b.radii) + none[:, 1])
        self._a, self._b, self._same, self.version = a, b, same, 0
        self._flat = flat
        self._ignored: Indices = np.empty(0, dtype=np.int64)
        hollow = bool((b.radii < 0.0).any())
        self.fixed = flat or hollow
        count = len(a.radii) if same else len(a.radii) + len(b.radii)
        self._at, self._before = np.empty((count, 3)), np.full((count, 3), np.inf)
        radii = a.radii if same else np.concatenate([a.radii, b.radii])
        self._skin = _SKIN * float(radii.mean())
        self._reach, self.patience = radii + self._skin, 0.5 * self._skin
        self._set(self._all() if self.fixed else np.empty((0, 2), dtype=np.int64))

    def _all(self) -> Indices:
        """Pairs of others than the same frame, but for those that are ignored."""
        found = np.argwhere(self._a.owners[:, np.newaxis] != self._b.owners)
        pairs = np.array(found, dtype=np.int64).reshape(-1, 2)
        return np.ascontiguousarray(pairs[~np.isin(self._keys(pairs), self._ignored)])

    def _keys(self, pairs: Indices) -> Indices:
        return np.asarray(pairs[:, 0] * len(self._b.radii) + pairs[:, 1])

    @property
    def ignores(self) -> bool:
        """Whether there are pairs that are left out until they part."""
        return len(self._ignored) > 0

    def ignore(self, H: Array) -> None:
        """Leave pairs out that overlap at frames ``H``, until :meth:`part` finds them apart."""
        self.update(H)
        g, _ = gaps(H, self._a, self._b, self.now, self._flat)
        self._ignored = self._keys(self.now[g < 0.0])
        self._again()

    def part(self, H: Array) -> None:
        """Take those in again that are apart at frames ``H``."""
        if not self.ignores:
            return
        pairs = np.stack(np.divmod(self._ignored, len(self._b.radii)), axis=1)
        g, _ = gaps(H, self._a, self._b, pairs, self._flat)
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
        """Make the list that of frames ``H`` if places have moved too far since it was made."""
        if not self.fixed and self._moved(H) > self.patience:
            self._look(self._at)

    def cover(self, start: Array, end: Array) -> None:
        """Make the list have all that touch at either end of a step."""
        self.update(start)
        if not self.fixed and (moved := self._moved(end)) > self._skin:
            self._widen(2.0 * moved)
            self._moved(start)
            self._look(self._at)

    @property
    def skin(self) -> float:
        """What is added to radii in the list."""
        return self._skin

    def widen(self, skin: float) -> None:
        """Look further from the next list on, which is made next time; never less far."""
        if not self.fixed and skin > self._skin:
            self._widen(skin)
            self._before[:] = np.inf

    def _widen(self, skin: float) -> None:
        self._reach += skin - self._skin
        self._skin, self.patience = skin, 0.5 * skin

    def _moved(self, H: Array) -> float:
        """How far places have moved since the list was made."""
        self._set_places(H, self._at)
        return moved_by(self._at, self._before)

    def _set_places(self, H: Array, out: Array) -> None:
        """Places of the first side, then those of the second, (n, 3)."""
        n = len(self._a.radii)
        places(H, self._a, out[:n])
        if not self._same:
            places(H, self._b, out[n:])

    @property
    def seen(self) -> Array:
        """Places of the list, how far it looked, and who is ignored, shape (·, 3)."""
        ignored = np.zeros((len(self._ignored), 3))
        ignored[:, 0] = self._ignored
        if self.fixed:
            return ignored
        return np.vstack([self._before, [self._skin, 0.0, 0.0], ignored])

    def see_again(self, seen: Array) -> None:
        """Have the list again that there was when that was :attr:`seen`."""
        n = 0 if self.fixed else len(self._before)
        self._ignored = seen[n if self.fixed else n + 1 :, 0].astype(np.int64)
        if self.fixed:
            self._again()
        else:
            self._widen(float(seen[n, 0]))
            self._look(seen[:n])

    def in_step(
        self, start: Array, end: Array
    ) -> tuple[tuple[Array, Array], tuple[Array, Array], Indices]:
        """Places at both ends of a step, and which of them may have met on straight ways.

        Args:
            start: Frames at the start of the step.
            end: At its end.

        Returns:
            Places of both sides at the start, shapes (n, 3) and (m, 3), at the end, and pairs.
        """
        X = np.empty((2, *self._at.shape))
        for at, H in zip(X, (start, end), strict=True):
            self._set_places(H, at)
        ways = X[1] - X[0]
        # what moves alike never meets
        ways -= ways.mean(axis=0)
        far = np.linalg.norm(ways, axis=1)
        pairs = self.now
        if not 2.0 * far.max(initial=0.0) <= self.patience:
            pairs = self.within(0.5 * (X[0] + X[1]), self._reach - self._skin + 0.5 * far)
        n = len(self._a.radii)
        before, after = ((at[:n], at if self._same else at[n:]) for at in X)
        return before, after, pairs

    def _look(self, at: Array) -> None:
        """Make the list for places."""
        if not np.isfinite(at).all():
            return
        self._before[:] = at
        pairs = self.within(self._before, self._reach)
        if not np.array_equal(pairs, self.now):
            self._set(pairs)
            self.version += 1

    def within(self, at: Array, reach: Array) -> Indices:
        """Pairs of places near each other, of the same frame left out, shape (m, 2).

        Args:
            at: Places of the first side, then those of the second, shape (n, 3).
            reach: Of each, shape (n,).
        """
        n = len(self._a.radii)
        if self._same:
            pairs = near(at, reach)
        else:
            pairs = near_between(at, reach, n) - np.array([0, n])
        apart = self._a.owners[pairs[:, 0]] != self._b.owners[pairs[:, 1]]
        if len(self._left_out):
            keys = pairs[:, 0] * len(self._b.radii) + pairs[:, 1]
            at = np.minimum(np.searchsorted(self._left_out, keys), len(self._left_out) - 1)
            apart &= self._left_out[at] != keys
        if self.ignores:
            apart &= ~np.isin(self._keys(pairs), self._ignored)
        return np.ascontiguousarray(pairs[apart])


class SlotPairs(NearPairs):
    """First and second places that belong together, one by one: slots of contact manifolds."""

    def __init__(self, a: Side, b: Side, *, flat: bool, same: bool) -> None:
        """As the base class; all are always in the list."""
        super().__init__(a, b, flat=True, same=False)

    def _all(self) -> Indices:
        return np.repeat(np.arange(len(self._a.radii)), 2).reshape(-1, 2)
