"""Imperfections: scenes with geometric imperfections of bodies, without stress.

Positions are displaced, and directors rotate with the surface, or the line, through them. Supported
nodes of a body stay in place.
"""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, instance, number, numbers, positive, whole
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.results.mode_shapes import BucklingModes
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene

_STEP = 1e-5  # over the size of the body: step of difference quotients of a field
_WAVES = 64


class Imperfection(ABC):
    """Displacement of the nodes of bodies, and the corresponding rotation."""

    @abstractmethod
    def of(self, body: Body) -> tuple[Array, Array]:
        """Displacements and rotation vectors of the nodes, global components, both (n, 3).

        Args:
            body: The body whose nodes are displaced.
        """


@dataclass(frozen=True, eq=False)
class ModeImperfection(Imperfection):
    """Imperfection in the shape of a buckling mode.

    Attributes:
        modes: Buckling modes of the perfect scene.
        mode: Number of the mode, counted from 1.
        amplitude: Largest displacement; its sign matters if the structure has no symmetry.
        angle: Largest rotation, rad, instead, for a mode of rotations only.

    Raises:
        ValueError: There is no such mode, or it does not have the given one of amplitude and angle.
    """

    modes: BucklingModes
    mode: int
    amplitude: float | None = None
    angle: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        """Check that the mode has what is given."""
        instance(self.modes, BucklingModes, "ModeImperfection: modes", "what fl.buckling returns")
        instance(self.mode, int | np.integer, "ModeImperfection: mode", "a whole number")
        for name in ("amplitude", "angle"):
            if getattr(self, name) is not None:
                number(getattr(self, name), f"ModeImperfection: {name}")
        self.modes.shape(self.mode)
        turns = bool(self.modes.rotation_only[self.mode - 1])
        wanted, other = (self.angle, self.amplitude) if turns else (self.amplitude, self.angle)
        if wanted is None or other is not None or not np.isfinite(wanted):
            has = "only turns: give angle=" if turns else "has displacements: give amplitude="
            raise ValueError(
                f"mode {self.mode} {has} a finite number and nothing else, got "
                f"amplitude={self.amplitude!r}, angle={self.angle!r}"
            )

    def of(self, body: Body) -> tuple[Array, Array]:
        """The mode, times its amplitude or angle.

        Args:
            body: The body whose nodes are displaced.

        Raises:
            ValueError: The mode belongs to other bodies.
        """
        nodes = nodes_in(self.modes.info, body, "the modes")
        size = self.amplitude if self.angle is None else self.angle
        assert size is not None
        directors = self.modes.frames[nodes, 1:]
        moved = size * self.modes.shape(self.mode)[nodes].reshape(-1, 2, 3)
        u, theta = np.einsum("nij,nki->knj", directors, moved)
        return u, theta


@dataclass(frozen=True, eq=False)
class FieldImperfection(Imperfection):
    """Imperfection by a prescribed displacement field.

    Attributes:
        displacement: Function of the position, shape (3,), that returns a displacement, shape (3,).
            It is also called at positions near the nodes.
    """

    displacement: Callable[[Array], npt.ArrayLike]

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if it is not a function."""
        wanted = "a function of the position"
        instance(self.displacement, Callable, "FieldImperfection: displacement", wanted)

    def of(self, body: Body) -> tuple[Array, Array]:
        """The field at the nodes, and the rotation of the surface, or the line, by it.

        Args:
            body: The body whose nodes are displaced.

        Raises:
            ValueError: The field is not three finite numbers everywhere.
        """
        return _with_rotations(body, self._at)

    def _at(self, positions: Array, frames: Array) -> Array:
        what = "the field of an imperfection"
        values = numbers([self.displacement(x) for x in positions], what)
        if values.shape != positions.shape or not np.isfinite(values).all():
            raise ValueError(
                f"the field of an imperfection must be three finite numbers, got {values[0]}"
            )
        return values


@dataclass(frozen=True, eq=False)
class RandomImperfection(Imperfection):
    """Random imperfection: waves of one length with random directions and phases.

    Attributes:
        amplitude: 2.5 times the root mean square of the displacements.
        wavelength: Length of all waves.
        seed: Seed of the random numbers; equal seeds give equal imperfections.
        along: Unit direction as a function of the position, shape (3,); default: third directors.
    """

    amplitude: float
    wavelength: float
    seed: int
    along: Callable[[Array], npt.ArrayLike] | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        number(self.amplitude, "RandomImperfection: amplitude")
        positive(self.wavelength, "RandomImperfection: the wavelength")
        whole(self.seed, "RandomImperfection: seed", least=0)

    def of(self, body: Body) -> tuple[Array, Array]:
        """The sum of the waves along directors, or along given directions.

        Args:
            body: The body whose nodes are displaced.
        """
        # the same field for all bodies of a scene: about the maximum of this number of waves
        scale = self.amplitude / (2.5 * np.sqrt(0.5 * _WAVES))

        def waves(positions: Array, frames: Array) -> Array:
            across = frames[:, 3]
            if self.along is not None:
                across = np.array([self.along(x) for x in positions], dtype=np.float64)
            return np.asarray(scale * self._waves(positions)[:, np.newaxis] * across)

        return _with_rotations(body, waves)

    def _waves(self, positions: Array) -> Array:
        random = np.random.default_rng(self.seed)
        k = random.standard_normal((_WAVES, 3))
        k *= 2 * np.pi / self.wavelength / np.linalg.norm(k, axis=1)[:, np.newaxis]
        phases = random.uniform(0.0, 2 * np.pi, _WAVES)
        return np.asarray(np.cos(positions @ k.T + phases).sum(axis=1))


def apply_imperfections(scene: Scene, *imperfections: Imperfection) -> Scene:
    """A copy of a scene with imperfect bodies, as free of stress as before.

    Names are unchanged, so that points can be looked up by them; bodies, joints and loads are
    copies.

    Args:
        scene: The perfect scene, which is not changed.
        imperfections: Imperfections, of which the sum is applied.

    Raises:
        ValueError: No imperfection, or one that does not fit a body.
    """
    if not imperfections:
        raise ValueError("give at least one imperfection")
    require_scene(scene)
    for each in imperfections:
        instance(each, Imperfection, "an imperfection", "one such as ModeImperfection")
    other = copy.deepcopy(scene)
    for body in other.bodies:
        parts = [imperfection.of(body) for imperfection in imperfections]
        u, theta = np.sum(parts, axis=0)
        if u.any() or theta.any():
            body.model.require_frames("an imperfection")
        _deform(body, u, theta)
    return other


def _deform(body: Body, u: Array, theta: Array) -> None:
    """Displace the nodes of a body, and rotate their frames, except supported ones."""
    H, held = body.frames, body.model.held
    own = H[:, 1:].copy()
    fixed = np.isfinite(body.model.supports[:, 0, 0])
    own[fixed] = body.model.supports[fixed]
    u = np.einsum("nij,ni->nj", own, np.where(held[:, :3], 0.0, np.einsum("nij,nj->ni", own, u)))
    turn = np.where(held[:, 3:], 0.0, np.einsum("nij,nj->ni", H[:, 1:], theta))
    turned = lie.se3_retract(H, np.hstack([np.zeros_like(turn), turn]))
    turned[:, 0] += u
    attached = np.flatnonzero(body.model.masters != np.arange(len(H)))
    masters = body.model.masters[attached]
    relative = lie.se3_compose(lie.se3_inverse(H[masters]), H[attached])
    turned[attached] = lie.se3_compose(turned[masters], relative)
    body.frames[:] = turned
    if isinstance(body, Beam):
        a, b = turned[body.model.elements[:, 0]], turned[body.model.elements[:, 1]]
        body.model.lengths[:] = np.linalg.norm(lie.se3_relative(a, b)[:, :3], axis=1)


def _with_rotations(body: Body, field: Callable[[Array, Array], Array]) -> tuple[Array, Array]:
    """A field at the nodes, and the rotation of the surface, or the line, there."""
    x, step = body.frames[:, 0], _STEP * body.model.size
    u = field(x, body.frames)

    def slope(director: int) -> Array:
        along = step * body.frames[:, director]
        difference = field(x + along, body.frames) - field(x - along, body.frames)
        return np.asarray(body.frames[:, director] + difference / (2 * step))

    if len(body.model.faces):
        before, after = body.frames[:, 3], np.cross(slope(1), slope(2))
    else:
        before, after = body.frames[:, 1], slope(1)
    after = after / np.linalg.norm(after, axis=1)[:, np.newaxis]
    axis = np.cross(before, after)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, np.sum(before * after, axis=1))
    return u, axis * np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 1.0)[:, np.newaxis]
