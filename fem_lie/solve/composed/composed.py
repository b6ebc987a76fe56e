r"""Fourth-order schemes composed of sub-steps of a second-order scheme, with its conservation laws.

Each step is composed of sub-steps of another scheme, some of which go back in time
(:mod:`fem_lie.solve.composed.parts`). Invariants that each sub-step conserves to round-off (energy,
momentum and angular momentum) are conserved, whatever the sizes and signs; joints hold at the end
of each. Configurations and velocities are of fourth order, and so are joint forces and reactions,
which are those of the equations of motion at the ends of steps; but forces of drives and prescribed
motions are of second order, because their accelerations are differences over a step.

Sub-steps of the variational scheme conserve its momenta, and an energy that does not drift, with
errors of fourth order. Work and impulses are integrated by the trapezoidal rule over whole steps,
which needs two factorisations per step if external loads act.

Each size of sub-steps has a matrix of its own; both are frozen.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fem_lie._arrays import instance
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.scene import Scene
from fem_lie.solve.composed.momentum_parts import MomentumRun
from fem_lie.solve.composed.parts import Composition, FiveStages
from fem_lie.solve.composed.run import ComposedRun
from fem_lie.solve.conserving.energy_momentum import EnergyDecaying, EnergyMomentum
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.variational.variational import Variational
from fem_lie.system.equations import Equations

_SYMMETRIC = EnergyMomentum, Variational
_MOST_SIZES = 2
_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class Composed(Integrator):
    """Options of the scheme; :meth:`run` integrates with constant steps.

    Functions of time of loads, drives and motions are evaluated back in time, too; they must
    be smooth. With :class:`~fem_lie.schemes.TripleJump` they are evaluated before the start of the
    run and after its end. Scenes with dissipation raise an error: backwards it would add energy.

    Joint forces and reactions need a factorisation for each recorded state.

    Attributes:
        scheme: Scheme of the sub-steps; it must be symmetric, as ``EnergyMomentum()`` and
            ``Variational()`` are. Its policy decides for each size of sub-steps.
        composition: Sizes of the sub-steps: :class:`~fem_lie.schemes.FiveStages`,
            :class:`~fem_lie.schemes.NineStages` or :class:`~fem_lie.schemes.TripleJump`.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.schemes.Composed().run(scene, duration=1.0, step=0.05)
        >>> bool(result.energy_error < 1e-12)
        True
    """

    _wanted_step: ClassVar[str] = (
        "makes constant steps over smooth functions of time: expected the step size as a "
        "number and a scene without discontinuities (or use EnergyMomentum)"
    )

    scheme: Integrator = field(default_factory=EnergyMomentum)
    composition: Composition = field(default_factory=FiveStages)

    def __post_init__(self) -> None:
        """Check the options."""
        instance(self.scheme, Integrator, "scheme", "a scheme such as EnergyMomentum()")
        kind = "a Composition such as FiveStages()"
        instance(self.composition, Composition, "composition", kind)
        if not isinstance(self.scheme, _SYMMETRIC) or isinstance(self.scheme, EnergyDecaying):
            raise ValueError(
                "only a symmetric scheme can be composed, EnergyMomentum() or Variational(): what "
                f"another one loses it would gain in sub-steps back in time; got {self.scheme}"
            )
        _check_parts(self.composition)

    def _equations(self, scene: Scene) -> Equations:
        assert isinstance(self.scheme, _SYMMETRIC)
        equations = self.scheme.equations(scene)
        _refuse(equations)
        return equations

    def _integration(self, equations: Equations, step: float) -> Integration[Any]:
        how = self.composition
        if isinstance(self.scheme, Variational):
            return MomentumRun(self.scheme.options(), equations, step, how.parts)
        assert isinstance(self.scheme, EnergyMomentum)
        return ComposedRun(self.scheme.options(), equations, step, how.halves)


def _check_parts(composition: Composition) -> None:
    """Raise ``ValueError`` for sub-steps that do not compose a step of fourth order."""
    parts = np.array(composition.parts, dtype=np.float64)
    fourth = len(parts) > 0 and abs(parts.sum() - 1.0) + abs((parts**3).sum()) < _ROUND_OFF
    if not (fourth and np.allclose(parts, parts[::-1], rtol=0.0, atol=_ROUND_OFF)):
        raise ValueError(
            f"parts of {composition} must be the same from either end, with the sum 1 and cubes "
            f"whose sum is 0; got {parts.tolist()}"
        )
    sizes = np.unique(np.round(parts, 12))
    if len(sizes) > _MOST_SIZES:
        raise ValueError(
            f"parts of {composition} must have {_MOST_SIZES} sizes at most, each of which keeps "
            f"a matrix; got {sizes.tolist()}"
        )


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` for scenes that cannot be integrated back in time."""
    arrays, unknowns = equations.arrays, equations.unknowns
    pairs = arrays.pairs_of_all
    of_all = [arrays.joints, *([] if pairs is None else [pairs.joints])]
    dampers = np.concatenate([joint_arrays(joints).springs[:, 1] for joints in of_all])
    reasons = {
        "damping of materials": any(term.viscosity is not None for _, term in arrays.assemblies),
        "damping in proportion to mass": len(arrays.damping.indptr) > 0,
        "dampers in connections": bool(np.any(dampers != 0.0)),
    }
    refuse(
        "Composed",
        {
            "contacts by penalty": any(term.over_step is not None for term in arrays.terms),
            "strains that change in time (Temperature, Eigenstrain with a history)": (
                unknowns.strains_change
            ),
        },
        "EnergyMomentum or GeneralisedAlpha",
    )
    for what, given in reasons.items():
        if given:
            raise ValueError(
                f"Some sub-steps of Composed go back in time, where {what} would add energy: "
                "expected a scene without, or EnergyMomentum or GeneralisedAlpha"
            )
