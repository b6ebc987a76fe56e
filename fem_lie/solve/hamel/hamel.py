"""Hamel's form: velocities in moving frames are the variables; the scheme, and a run of it.

The variables of a rigid body are the velocities ``ξ = (V, W)`` of the mass centre and the rotation
along its axes. A knife edge fixes a constant component of them, ``ξ = Z η``; the remaining
variables are ``η``. Over a step with the means ``ξ̄ = ½ (ξ₀ + ξ₁) = Z η̄``, ``R₁ = R₀ cay(h W̄)``
and ``R̄ = ½ (R₀ + R₁)``::

    Zᵀ [M (ξ₁ − ξ₀)/h − (m V̄ × W̄, J W̄ × W̄) − (m R̄ᵀ g, 0)] = 0,        x₁ = x₀ + h R̄ V̄

which are Hamel's equations: there are no multipliers, and the edge constraint holds at the ends and
in between. Multiplied by ``ξ̄``, they conserve kinetic energy and that of gravity to round-off. A
disc that rolls on a plane with the normal ``N`` has the velocity ``v̄ = c̄ × w̄`` due to its
rotation only, with the moment arm to the contact point ``c̄ = −ρ (N − γ̄ d̄)/σ̄``, where ``d̄`` and
``σ̄`` are means over the step of its axis and of ``σ = |N × d|``, and ``γ̄ = N·d̄``. This is a
discrete gradient: the disc stays on the plane to round-off, and the contact force does no work.
Within steps the disc does not slip; at their ends the reported velocities are those of rolling, and
their energy oscillates with the square of the step size without drift, because that of the steps is
conserved.

The schemes are symmetric, of second order. Sources: Ball & Zenkov, in Geometry, Mechanics, and
Dynamics (2015) 477; Shi, Berchenko-Kogan, Zenkov & Bloch, J. Nonlinear Sci. 27 (2017) 241.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes, put_back, saved
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, TOTAL
from fem_lie.bodies.rigid import RigidBody
from fem_lie.joints.joint import Joint
from fem_lie.joints.rolling import KnifeEdge, RollingDisc
from fem_lie.lie.motions import Group
from fem_lie.linear.direct import DirectSolver
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.solve.division import HALVINGS
from fem_lie.solve.hamel import step
from fem_lie.solve.hamel.step import Bodies
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.motion.policies import Automatic
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.rotations import Rotations, by_rates
from fem_lie.system.equations import Equations

PREFIX = "fem_lie_dynamics_"
_AT_A_TIME = 20_000
"""Steps times bodies after which the loop returns, so that it can be interrupted."""

_CHANGED = "H", "s", "impulses"
"""State that a step changes."""


class HamelRun(DividedIntegration[Recorder]):
    """Run of Hamel's scheme."""

    STATE = attributes("H", "s", "impulses", "_made")

    def __init__(self, equations: Equations, size: float, bodies: step.Bodies) -> None:
        """Set up without computing anything.

        Args:
            equations: Equations of the scene.
            size: Step size.
            bodies: Constants of the bodies.
        """
        super().__init__(Automatic(), equations, size)
        self._bodies, n = bodies, equations.unknowns.moving
        self.H, self.s = equations.start.frames.copy(), np.zeros((n, 6))
        self.impulses, self._made = np.zeros((2, 6)), 0
        self._solver: DirectSolver | None = None
        self._rotations = Rotations(by_rates)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        return Recorder(self.equations, plan, progress, store)

    def start(self) -> None:
        """Compute the initial velocities."""
        check_velocities(self.equations, self.h)
        self.s[:] = self.equations.start.velocities[: len(self.s)]
        rolls = self._bodies.radius > 0.0
        self.s[rolls, :3] = self._rolling[rolls]

    @property
    def _rolling(self) -> Array:
        """Velocities in space of mass centres of discs that do not slip, (n, 3)."""
        bodies, found = self._bodies, np.zeros((len(self.s), 3))
        step.rolling(self.H, self.s, bodies.disc, bodies.normal, bodies.radius, found)
        return found

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.H

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._made

    def _advance(self, history: Recorder) -> bool:
        most = max(1, _AT_A_TIME // len(self.s))
        last = min(history.next_stop(self._made), self._made + most)
        whole = not self.division.level and self._go(self.h, last - self._made)
        # steps before a failed one are repeated one by one
        made = whole or self._cover()
        history.count = self._made
        return made

    def _go(self, h: float, count: int) -> bool:
        """Make ``count`` steps of a size.

        Return whether all converged, otherwise the state is restored.
        """
        before = saved(self, _CHANGED)
        step.run(self.H, self.s, (*self._bodies,), h, count, self.impulses)
        if not np.isfinite(self.s).all():
            put_back(self, _CHANGED, before)
            return False
        self._made += count
        return True

    def attempt(self, start: float, end: float) -> bool:
        """Make a step; return whether it converged."""
        self._made = self.begun
        return self._go(self.part_size, 1)

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size; velocities do not depend on it."""

    def _failure(self, steps: int) -> str:
        return (
            f"step {self.index + 1} of {steps} (h = {self.h:g}) failed: velocities did not "
            f"converge, or a disc lies in its plane. Nor did it in {2**HALVINGS} sub-steps; a "
            "smaller step may help"
        )

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self._made)
        wanted = history.wants(self._made)
        if wanted:
            equations, n = self.equations, len(self.s)
            v = equations.start.velocities.copy()
            rates: Array = np.zeros((n, 6))
            rolls = self._bodies.radius > 0.0
            v[:n] = self.s
            v[:n][rolls, :3] = np.einsum("nai,ni->na", self.H[:n, 1:], self._rolling)[rolls]
            multipliers: Array = np.zeros(equations.unknowns.m)
            time = self._made * self.h
            if Record.FORCES in history.filled and len(multipliers):
                solver = self._solver or DirectSolver(equations.matrix, PREFIX)
                self._solver = solver
                rates, multipliers = accelerations(equations, solver, self.H, v, time, self.h)
            balance = np.zeros(TOTAL)
            balance[BY_LOADS:BY_REACTIONS], balance[BY_REACTIONS:] = self.impulses
            self._rotations.note_velocities(self.h, v[:n], equations.unknowns.kinds)
            history.fill(time, self.H, v[:n], rates, multipliers, balance)
        return wanted

    def _result(self, history: Recorder) -> Result:
        self._rotations.report()
        self.division.report(self.index)
        return history.result(0, history.seconds, divided=self.division.divided)


@dataclass(frozen=True)
class Hamel(Integrator):
    """Rigid bodies under gravity, each free, on a knife edge, or a disc that rolls on the ground.

    Velocity constraints (:class:`~fem_lie.joints.KnifeEdge`, :class:`~fem_lie.joints.RollingDisc`)
    are eliminated in the frames of the bodies, without multipliers; joint forces in results are
    those of the equations of motion. :meth:`run` makes constant steps.

    Example:
        >>> sledge = fl.RigidBody(1.5, (0.05, 0.05, 0.05))
        >>> sledge.add_velocity(omega=(0, 0, 2.0), about=(-0.3, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(sledge)
        >>> centre = sledge.point("centre")
        >>> blade = fl.joints.KnifeEdge(fl.ground(), centre, at=(-0.3, 0, 0), axis=(0, 1, 0))
        >>> _ = scene.add(blade)
        >>> result = fl.schemes.Hamel().run(scene, duration=1.0, step=0.01)
        >>> bool(result.energy_error < 1e-13)
        True
    """

    def _equations(self, scene: Scene) -> Equations:
        _refuse(scene)
        return Equations(scene, dynamics=True, group=Group.R3xSO3)

    def _integration(self, equations: Equations, step: float) -> HamelRun:
        return HamelRun(equations, step, _bodies(equations.scene))


def _refuse(scene: Scene) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    bound = [joint.b.body for joint in scene.joints]
    kinds = KnifeEdge | RollingDisc
    on_ground = all(isinstance(j, kinds) and j.a.is_ground for j in scene.joints)
    around = (scene.connections, scene.links, scene.contacts, scene.clamps, scene.motions)
    reasons = {
        "flexible bodies": not all(isinstance(b, RigidBody) for b in scene.bodies),
        "joints other than KnifeEdge and RollingDisc on the ground": not on_ground,
        "two of these joints on one body": len(set(bound)) < len(bound),
        "loads other than gravity": bool(scene.loads),
        "springs, drives, links, contacts, clamps and prescribed motions": any(around),
    }
    refuse("Hamel", reasons)


def _bodies(scene: Scene) -> Bodies:
    """Constants of all bodies of a scene, in their order."""
    n, z = len(scene.bodies), np.zeros
    found = Bodies(
        z(n), z((n, 3, 3)), z((n, 6, 6)), z((n, 6, 6)), z(n, dtype=np.int64), z(n), z((n, 2, 3)),
        z((n, 3)), scene.gravity.copy(),
    )  # fmt: skip
    joints: dict[object, Joint] = {joint.b.body: joint for joint in scene.joints}
    for i, body in enumerate(scene.bodies):
        assert isinstance(body, RigidBody)
        second = body.model.mass_matrix[1:, 1:]
        found.mass[i], found.turning[i] = (
            body.model.mass_matrix[0, 0],
            np.trace(second) * np.eye(3) - second,
        )
        joint, Z = joints.get(body), np.eye(6)
        if joint is not None:
            _, frame = joint.frames()
            x, R = body.frames[0, 0], body.frames[0, 1:].T
            offset, axis = R.T @ (frame[0] - x), R.T @ frame[3]
            if isinstance(joint, RollingDisc):
                plane, _ = joint.frames()
                found.radius[i], found.normal[i] = joint.radius, plane[3]
                found.disc[i] = offset, axis
            else:
                Z = _complement(np.concatenate([axis, np.cross(offset, axis)]))
        k = Z.shape[1]
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = found.mass[i] * np.eye(3), found.turning[i]
        found.columns[i], found.allowed[i, :, :k] = k, Z
        found.inverse[i, :k, :k] = np.linalg.inv(Z.T @ M @ Z)
    return found


def _complement(row: Array) -> Array:
    """Orthonormal columns perpendicular to a row, (6, 5)."""
    return np.asarray(np.linalg.svd(row[np.newaxis])[2][1:].T)
