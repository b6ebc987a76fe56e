r"""Bodies with steps of their own, coupled by multipliers that take no energy.

Stiff or fine bodies make several steps in a whole one, the others one; each is a step of
energy-momentum by itself. Joints between them hold at the ends of whole steps, by multipliers that
act over a whole step: their forces on ``q = (x, d₁, d₂, d₃)`` of the nodes stay the same in it, so
that their work is a product of two increments over the whole step, and that of both sides together
is zero (:mod:`fem_lie.solve.multirate.interface`). As all bodies keep their energy but for this
work, the energy of all is kept. Within whole steps the two sides of such a joint move apart by the
order of the whole step squared; momentum is exact, angular momentum is not: the steps of a body do
not have the same mean places as the whole one. The scheme is symmetric, of second order.

Multipliers are found by trying whole steps, from what the last two were, with the response of the
joints to them, which is found once by trying each, and with what the last tries tell
(:mod:`fem_lie.solve.multirate.mixing`).

Steps are said to the scheme, as all that concerns time; a scene says what there is. Sources of the
idea: Prakash & Hjelmstad, IJNME 61 (2004) 2183; Mahjoubi, Gravouil, Combescure & Greffet, CMAME 198
(2009) 1069; Leyendecker & Ober-Blöbaum, in Multibody Dynamics (2013) 97 (constraints at the ends of
whole steps alone).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from fem_lie._arrays import instance, whole
from fem_lie.bodies.body import Body
from fem_lie.scene import Scene
from fem_lie.solve.conserving.energy_momentum import EnergyDecaying, EnergyMomentum
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.multirate.run import MultiRateRun
from fem_lie.solve.multirate.split import domains, rows_of
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class MultiRate(Integrator):
    """Options of the scheme; :meth:`run` integrates with constant whole steps.

    Bodies of different steps may be joined by joints; links, springs, drives and contact between
    them are refused, and so are drives, prescribed motions and strains that change. Loads that
    change act as they are in the middle of the steps of their body. ``result.iterations`` are the
    whole steps that were tried; the first column of ``result.balance`` has the work of loads, and
    that of multipliers between bodies of different steps, which is round-off.

    Attributes:
        steps: How many steps each of these bodies makes in a whole one; all others make one.
        scheme: Of which steps are made; its policy decides for each size of steps.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> coarse = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4))
        >>> fine = scene.add(fl.Beam.straight((1, 0, 0), (1.2, 0, 0), tube, cells=4))
        >>> _ = scene.add(fl.Fixed(coarse.point("end"), fine.point("start")))
        >>> scheme = fl.MultiRate({fine: 5})
        >>> result = scheme.run(scene, duration=5e-4, step=1e-4)
        >>> bool(result.energy_error < 1e-11)
        True
    """

    _wanted_step: ClassVar[str] = (
        "makes whole steps of one size: wanted it as a number and nothing that jumps (or use "
        "EnergyMomentum)"
    )

    steps: Mapping[Body, int]
    scheme: EnergyMomentum = field(default_factory=EnergyMomentum)

    def __post_init__(self) -> None:
        """Check the options."""
        instance(self.steps, Mapping, "MultiRate: steps", "a mapping such as {body: 10}")
        for body, count in self.steps.items():
            instance(body, Body, "MultiRate: steps", "bodies")
            whole(count, f"MultiRate: steps of {body.label}")
        instance(self.scheme, EnergyMomentum, "MultiRate: scheme", "EnergyMomentum()")
        if isinstance(self.scheme, EnergyDecaying):
            raise ValueError(
                "MultiRate couples steps that keep energy: wanted EnergyMomentum(), got "
                f"{self.scheme}"
            )

    def _equations(self, scene: Scene) -> Equations:
        strange = [body.label for body in self.steps if body not in scene.bodies]
        if strange:
            known = ", ".join(body.label for body in scene.bodies)
            raise ValueError(
                f"MultiRate: {strange[0]} has steps of its own and is not in the scene; wanted "
                f"bodies among {known}"
            )
        domains(scene, self.steps)
        equations = self.scheme.equations(scene)
        unknowns = equations.unknowns
        refuse(
            "MultiRate",
            {
                "drives, prescribed motions and strains that change in time": (
                    unknowns.driven
                    or len(equations.start.frames) > unknowns.moving + 1
                    or unknowns.strains_change
                ),
            },
            "EnergyMomentum",
        )
        return equations

    def _integration(self, equations: Equations, step: float) -> MultiRateRun:
        scenes, joints = domains(equations.scene, self.steps)
        parts = {count: self.scheme.equations(scene) for count, scene in scenes.items()}
        between = self.scheme.equations(joints)
        for part in (*parts.values(), between):
            _check_alike(part, equations)
        pairs = between.tables.pairs_of_all
        drilling = ", ".join(between.unknowns.drilling)
        reasons = {
            "joints between bodies with steps of their own on shells with six parameters "
            f"({drilling}), whose drilling has no inertia": bool(drilling and between.unknowns.m),
            "joints on points that are not nodes between bodies with steps of their own": (
                pairs is not None and pairs.grips.count > 0
            ),
        }
        refuse("MultiRate", reasons, "EnergyMomentum")
        return MultiRateRun(self.scheme.told(), equations, step, parts, between)


def _check_alike(part: Equations, whole: Equations) -> None:
    """Raise ``ValueError`` where nodes turn or not by what is between bodies of different steps."""
    rows = rows_of(part, whole)
    if (part.unknowns.kinds != whole.unknowns.kinds[rows]).any():
        raise ValueError(
            "MultiRate: nodes of a shell turn about their third directors because of a joint with "
            "a body of other steps; give both steps of one size"
        )
