r"""Explicit steps on the group: no equations are solved, and steps are as small as the cells ask.

Inertia is lumped: each node has its own, and momenta are its own (:mod:`.nodes`). A step is::

    p ← p − ½ h f(H),    H ← H moved for h with the constant momenta p,    p ← p − ½ h f(H)

with forces ``f`` without inertia. Places and slopes move by central differences; frames turn as
free rigid bodies turn by the discrete mechanics of Moser & Veselov, exactly on the group, about
their mass centres. It is the variational scheme of the trapezoidal rule (Verlet; Marsden & West,
Acta Numerica 10 (2001) 357): symmetric, symplectic, of second order; momentum and angular momentum
are exact, energy goes up and down and does not drift. Damping in proportion to mass multiplies
momenta by ``exp(−½ h α)`` before and after nodes are moved, which is exact without forces.

Steps are stable up to ``2/ω`` of the largest frequency, of which cells give an upper bound at the
start (:mod:`.stable`); larger ones are refused. Joints are kept closed by multipliers on the
block-diagonal inertia (:mod:`.joints`); they make no frequency larger. Without them forces, and all
else in a step, are one compiled loop; only loads that change in time, pressure and contact come
back to Python.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie.joints.equations.table import joint_table
from fem_lie.lie.motions import Group
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.explicit.run import ExplicitRun, limit_of
from fem_lie.solve.explicit.stable import masses_of, node_name, refuse_floating
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class Explicit(Integrator):
    """Explicit steps; :meth:`run` makes constant ones, :meth:`stable_step` tells how large.

    For nets, impacts and waves: where steps have to be as small as the time in which a wave passes
    an element anyway. It supports all nodes but those of reduced-order bodies, damping in
    proportion to mass, supports, joints, springs, loads and contact by penalty. Joints take small
    equations of their own in each step (:mod:`.joints`), and steps are made from Python then.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.Explicit().run(scene, duration=1.0, step=0.01)
        >>> bool(result.angular_momentum_error < 1e-12)
        True
    """

    def stable_step(self, scene: Scene) -> float:
        """The largest step at which the scene is stable at its start, infinite without stiffness.

        Raises:
            ValueError: The scheme cannot make steps of the scene, or there is no such step.
        """
        require_scene(scene)
        equations = self._equations(scene)
        return limit_of(equations, masses_of(equations)).step

    def _equations(self, scene: Scene) -> Equations:
        equations = Equations(scene, dynamics=True, group=Group.R3xSO3, without_coupling=True)
        _refuse(equations)
        return equations

    def _integration(self, equations: Equations, step: float) -> ExplicitRun:
        masses = masses_of(equations)
        limit = limit_of(equations, masses)
        if not step <= limit.step:
            where = node_name(equations, limit.node)
            raise ValueError(
                f"Explicit: wanted a stable step, at most {limit.step:.4g} for the cells around "
                f"{where}, got {step:g}"
            )
        return ExplicitRun(equations, step, masses, limit)


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` for what the scheme cannot do."""
    refuse_floating(equations)
    unknowns, tables = equations.unknowns, equations.tables
    dampers = bool(np.any(joint_table(tables.joints).springs[:, 1] != 0.0))
    reasons = {
        "velocity constraints (KnifeEdge, RollingDisc), whose motion makes no action stationary": (
            unknowns.of_velocities > 0
        ),
        "drives": unknowns.driven,
        "redundant constraints": unknowns.may_be_redundant,
        "prescribed motions": len(equations.start.frames) > unknowns.moving + 1,
        "supports along axes fixed in space (Shell.guide)": bool(equations.supports),
        "damping by strain rates and dampers": dampers
        or any(
            term.viscosity is not None and term.viscosity.rates is None for term in tables.terms
        ),
        "strains that change in time": unknowns.strains_change,
        "friction of penalties": any(term.has_friction for term in tables.terms),
    }
    refuse("Explicit", reasons)
