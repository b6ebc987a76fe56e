"""Whirl: modes of a rotor in the rotating frame, as motions in the fixed one.

A rotor that is the same in all directions across its axis is at rest in the frame that rotates with
it, and so are bearings that are the same in all directions. A mode there is a circular motion
``y + i z = r exp(λ t)``, forward or backward, of the axis of the shaft: in the fixed frame ``r
exp((λ + i Ω) t)``. With ``s = σ + i ω``, ``ω ≥ 0``, the whirl frequency is ``Ω + ω`` if the mode
rotates forward in the rotating frame, and ``Ω − ω`` if it rotates backward. It is positive for
forward whirl in space.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg

from fem_lie._arrays import Array, direction, vector
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.results.vibrations.modes import Complex, Modes
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.scene.scene import require_scene
from fem_lie.solve.stability.equilibrium_state import small_motions
from fem_lie.solve.stability.vibrations import vibrations
from fem_lie.system.equations import Equations
from fem_lie.system.small_motions import SmallMotions

_ON_AXIS = 1e-9  # distance of nodes from the axis, over the length of the model
_EQUAL = 1e-5  # relative difference of eigenvalues whose vectors may be mixed
_STILL = 1e-9  # frequency in the rotating frame over the speed: synchronous
_ACROSS = 0.5  # part of the motion that is across the axis
_CIRCULAR = 1e-2
_APART = 1e-3  # relative difference of two speeds near a critical one
_FREE = 1e-7  # whirl frequency over the speed


class Shaft(NamedTuple):
    """A rotor and the axis on which all of its nodes are.

    Attributes:
        scene: The rotor and its bearings.
        axis: Unit vector along the axis, in the sense of the spin, shape (3,).
        about: A point on the axis, shape (3,).
        across: Two unit vectors across it, a right-handed triad with the axis, shape (2, 3).
        free: Number of degrees of freedom.
    """

    scene: Scene
    axis: Array
    about: Array
    across: Array
    free: int

    @classmethod
    def of(cls, scene: Scene, axis: npt.ArrayLike, about: npt.ArrayLike) -> Shaft:
        """Check a rotor.

        Args:
            scene: The rotor and its bearings.
            axis: Vector along its axis, of any length.
            about: A point on the axis.

        Raises:
            ValueError: Nodes are away from the axis, loads are fixed in space across it, or a
                damper acts between the rotor and ground.
        """
        require_scene(scene)
        axis, about = direction(axis, "axis"), vector(about, 3, "about")
        Rotation(axis, about).check(scene)
        positions = np.concatenate(
            [body.frames[:, 0] for body in scene.bodies] or [np.empty((0, 3))]
        )
        if not len(positions):
            raise ValueError("the scene has no body")
        away = np.linalg.norm(np.cross(positions - about, axis), axis=1)
        length = max(float(np.ptp(positions @ axis)), *(body.model.size for body in scene.bodies))
        if away.max() > _ON_AXIS * length:
            raise ValueError(
                f"a rotor has all nodes on its axis, got one at a distance of {away.max():.3g}: "
                "expected beams, rods and rigid bodies along the axis. For blades, "
                "fl.vibrations(scene, spin=...) has frequencies in the rotating frame"
            )
        for item in scene.connections:
            if np.any(getattr(item, "damping", 0.0)) and any(body is None for body in item.bodies):
                raise ValueError(
                    f"{item.label} damps the motion between the rotor and ground, which rotates "
                    "with the rotor here: expected damping of bodies, where Damping(mass=...) "
                    "opposes motion in space"
                )
        first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        first = first / np.linalg.norm(first)
        free = Equations(scene, dynamics=True).unknowns.degrees_of_freedom
        return cls(scene, axis, about, np.array([first, np.cross(axis, first)]), free)

    def modes(self, speed: float, count: int, prefix: str) -> Modes:
        """The slowest modes in the frame that rotates."""
        spin = speed * self.axis
        return vibrations(
            self.scene, count, spin=spin, about=self.about, petsc_options_prefix=prefix
        )

    def whirl(self, speed: float, pairs: int, prefix: str) -> tuple[Complex, Complex]:
        """Eigenvalues of the slowest forward and backward whirl in the fixed frame, (pairs,) each.

        Modes that are not computed are faster in the rotating frame, and so faster by at least the
        difference of that and the speed in the fixed one.

        Raises:
            ValueError: There are fewer, a mode is no circular motion, or the rotor moves freely
                across its axis.
        """
        count = min(4 * pairs + 4, self.free)
        while True:
            modes = self.modes(speed, count, prefix)
            complete = count == self.free
            # of equally fast modes at the end of the list, others may be missing
            last = float(np.abs(modes.eigenvalues[-1]))
            fastest = np.inf if complete else (1 - 2 * _EQUAL) * last
            found = self._in_space(modes, speed, fastest)
            known = found[np.abs(found.imag) <= fastest - abs(speed)]
            forward, backward = known[known.imag > 0], known[known.imag < 0]
            if min(len(forward), len(backward)) >= pairs:
                return forward[:pairs], backward[:pairs]
            if complete:
                raise ValueError(
                    f"pairs must be 1 … {min(len(forward), len(backward))}, the number of forward "
                    f"and backward whirl modes, got {pairs}"
                )
            count = min(2 * count, self.free)

    def synchronous(self, speed: float, prefix: str) -> float:
        """Critical speed near an estimate, without damping.

        There ``(K(Ω) + …) φ = 0`` in the rotating frame. Near it the eigenvalue is below round-off,
        while the zero of the quadratic form of its vector, nearly linear in ``Ω²``, is known.
        """
        ends = np.array([speed, (1.0 + _APART) * speed])
        states = [self._about(each) for each in ends]
        pencils = [state.pencil() for state in states]
        # with gyroscopic forces the zero would be defective
        static = replace(pencils[0], C=None)
        s, vectors, _ = smallest(static, min(4, self.free), states[0].rate, prefix)
        still = vectors[np.abs(s) <= np.sqrt(_APART) * speed]
        both = np.concatenate([still.real, still.imag])
        first, second = (float((both * pencil.stiffness(both)).sum()) for pencil in pencils)
        squares = ends**2
        return float(np.sqrt(squares[0] - first * (squares[1] - squares[0]) / (second - first)))

    def _about(self, speed: float) -> SmallMotions:
        """Linear equations in the frame that rotates."""
        rotation = Rotation(speed * self.axis, self.about)
        return small_motions(self.scene, None, rotation)[1]

    def _in_space(self, modes: Modes, speed: float, fastest: float) -> Complex:
        """Eigenvalues of modes below a rate in the fixed frame, ascending by ``|Im s|``."""
        found: list[complex] = []
        for s, vectors in _clusters(modes):
            if abs(s) > fastest:
                continue
            still = abs(s.imag) <= _STILL * abs(speed)
            for turns in self._turns(modes, vectors, still):
                found.append(s.real + 1j * (speed + turns * s.imag))
        values = np.array(found, dtype=np.complex128)
        values = values[np.argsort(np.abs(values.imag), kind="stable")]
        if len(values) and abs(values[0].imag) <= _FREE * abs(speed):
            raise ValueError("the rotor moves freely across its axis: expected bearings or a clamp")
        return values

    def _turns(self, modes: Modes, vectors: Complex, still: bool) -> list[int]:
        """Senses of rotation in the span of modes with equal eigenvalues, +1 is that of the spin.

        Motions along and about the axis have none. Motions that are still in the rotating frame
        turn with it: their vectors are real, and each whirl has one or two of them.
        """
        R = modes.frames[:, 1:]
        arms = (slice(3), 1.0), (slice(3, 6), modes.size)
        parts = [arm * np.einsum("kni,nij->knj", vectors[..., part], R) for part, arm in arms]
        moved = np.concatenate(parts, axis=1)
        y, z = np.einsum("knj,aj->akn", moved, self.across)
        forward, backward = _form(y + 1j * z) / 2, _form(y - 1j * z) / 2
        along = _form(moved @ self.axis)
        values, mixed = scipy.linalg.eigh(forward - backward, forward + backward + along)
        across = np.einsum("ik,ij,jk->k", mixed.conj(), forward + backward, mixed).real
        turning = values[across > _ACROSS]
        if still:
            return [0] * ((len(turning) + 1) // 2)
        if (np.abs(turning) < 1.0 - _CIRCULAR).any():
            raise ValueError(
                "a mode is no circular motion about the axis: the rotor, or its bearings, are not "
                "the same in all directions across it. Frequencies in the rotating frame: "
                "fl.vibrations(scene, spin=...)"
            )
        return [int(np.sign(value)) for value in turning]


def _form(amplitudes: Complex) -> Complex:
    """Hermitian form ``Σ āᵢ aⱼ`` of amplitudes at all nodes, (k, n), shape (k, k)."""
    return np.asarray(amplitudes.conj() @ amplitudes.T)


def _clusters(modes: Modes) -> list[tuple[complex, Complex]]:
    """Mean eigenvalue and vectors, (c, n, 6), of modes with nearly equal eigenvalues."""
    s, left, found = modes.eigenvalues, list(range(len(modes.eigenvalues))), []
    while left:
        first = s[left[0]]
        near = [k for k in left if abs(s[k] - first) <= _EQUAL * abs(first)]
        left = [k for k in left if k not in near]
        found.append((complex(s[near].mean()), modes.shapes[near]))
    return found
