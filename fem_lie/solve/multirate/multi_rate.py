"""Multi-rate scheme: steps for each body, implicit or explicit, and a run of it.

Stiff or finely meshed bodies make several steps in a whole step, the others one; each is a step of
the energy-momentum scheme or of the explicit one. Joints between them hold at the ends of whole
steps, by multipliers that act over a whole step: their forces on ``q = (x, d₁, d₂, d₃)`` of the
nodes are constant in it, so that their work is a product of two increments over the whole step, and
the sum over both sides is zero (:mod:`fem_lie.solve.multirate.domain`). As the energy of each body
changes by this work only, none is created or lost between them: the total energy is conserved, or
as good as explicit steps conserve it. Within whole steps the two sides of such a joint separate by
the order of the whole step squared: only their mean velocities over it are equal. Momentum is
exact; angular momentum is not, because the mean positions of the steps of a body differ from those
of the whole step. The scheme is symmetric, of second order.

Multipliers are found by repeating whole steps. The first guess uses the last two steps; the next
ones use the response of the joints, which is computed once by a step for each multiplier, and
Anderson acceleration (:mod:`fem_lie.solve.multirate.coupling`).

Step sizes are options of the scheme, like everything about time integration; the scene describes
the model. Related work: Gravouil & Combescure, IJNME 50 (2001) 199 (equal velocities at the small
steps; energy is lost); Prakash & Hjelmstad, IJNME 61 (2004) 2183 (equal velocities at the ends of
whole steps; none is); Mahjoubi, Gravouil, Combescure & Greffet, CMAME 198 (2009) 1069; Leyendecker
& Ober-Blöbaum, in Multibody Dynamics (2013) 97 (constraints at the ends of whole steps only).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np

from fem_lie._arrays import Array, instance, whole
from fem_lie._state import attributes
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import MassMatrix
from fem_lie.lie.motions import Group
from fem_lie.linear.direct import DirectSolver
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.solve.conserving.energy_momentum import EnergyMomentum
from fem_lie.solve.conserving.midpoint.products import product_numbers
from fem_lie.solve.conserving.python_forces.forces import joints_of
from fem_lie.solve.conserving.run_state import PREFIX, Options
from fem_lie.solve.explicit.explicit import Explicit
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.multirate.conserving import ConservingDomain
from fem_lie.solve.multirate.coupling import Coupling
from fem_lie.solve.multirate.domain import Domain, domains, rows_of
from fem_lie.solve.multirate.explicit import ExplicitDomain
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.system.equations import Equations, TimeState

_DOMAINS: dict[type, Callable[..., Domain]] = {
    EnergyMomentum: ConservingDomain,
    Explicit: ExplicitDomain,
}
"""Schemes of bodies, and their domains."""


class Sort(NamedTuple):
    """Steps of a body.

    Attributes:
        steps: Their number in a whole step.
        scheme: Their scheme.
    """

    steps: int
    scheme: EnergyMomentum | Explicit

    @property
    def lumps(self) -> bool:
        """Whether their mass matrix is lumped."""
        return isinstance(self.scheme, Explicit)


class MultiRateRun(DividedIntegration[History]):
    """Run of the multi-rate scheme."""

    STATE = attributes("_coupling", "_made", "_domains")

    def __init__(
        self,
        options: Options,
        equations: Equations,
        step: float,
        parts: Mapping[Sort, Equations],
        between: Equations,
    ) -> None:
        """Set up without computing anything.

        Args:
            options: Options of whole steps.
            equations: Equations of the whole scene.
            step: Size of whole steps.
            parts: Equations of the bodies with each sort of steps.
            between: Equations of all bodies and the joints between domains.
        """
        super().__init__(options.policy, equations, step)
        self.equations_state = equations.history_variables
        self.options = options
        self._domains = tuple(
            _DOMAINS[type(sort.scheme)](
                sort.scheme, part, step, sort.steps, rows_of(part, equations)
            )
            for sort, part in parts.items()
        )
        bodies = equations.arrays.floating
        self._products = [
            product_numbers(part.arrays.floating, domain.rows, bodies)
            for part, domain in zip(parts.values(), self._domains, strict=True)
        ]
        self._coupling = Coupling(between, equations, self._domains)
        self.H = equations.start.frames.copy()
        self._filled, self._r = ResultRow(equations), np.empty(equations.unknowns.size)
        self._solver: DirectSolver | None = None
        self._made, self._joints = 0, joints_of(equations)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """Create the history of results."""
        return History(self.equations.info, plan, progress, store)

    def start(self) -> None:
        """Compute the initial states of all domains."""
        check_velocities(self.equations, self.h)
        for domain in self._domains:
            domain.start()

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        for domain in self._domains:
            self.H[domain.rows] = domain.now
        return self.H

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._made

    def _advance(self, history: History) -> bool:
        done = self._cover()
        self._made += done
        return done

    def attempt(self, start: float, end: float) -> bool:
        """Make a whole step; return whether it converged."""
        return self._coupling.step(start, self.options.max_iterations)

    def resize(self, time: float, size: float) -> None:
        """Start whole steps of another size."""
        self._coupling.resize(self.part_size)

    def _failure(self, steps: int) -> str:
        text = (
            f"step {self.index + 1} of {steps} (h = {self.h:g}) failed: joints between bodies with "
            f"steps of their own were left open by {self._coupling.left:.2g} of the model, or a "
            "step of a body did not converge; a smaller step may help"
        )
        return self._nor_in_parts(text)

    # --- results ---

    def _record(self, history: History) -> bool:
        wanted = history.wants(self.index)
        if wanted:
            self._keep_row(history)
        if self.index:
            history.update_if_due(self.index, self._coupling.tries)
        return wanted

    def _result(self, history: History) -> Result:
        factorisations = sum(domain.matrices for domain in self._domains)
        self.division.report(self.index)
        divided = self.division.divided
        return history.result(factorisations, history.seconds, divided=divided)

    def _keep_row(self, history: History) -> None:
        equations, row = self.equations, history.row
        n, m = equations.unknowns.moving, equations.unknowns.m
        rows = n + sum(map(len, self._products))
        held, H, V = len(equations.unknowns.supported) > 0, self.frames, np.empty((rows, 4, 3))
        v = equations.start.velocities.copy()
        rates: Array = np.zeros((n, 6))
        multipliers: Array = np.zeros(m)
        if equations.unknowns.time_dependent:
            equations.prescribed(self.index * self.h).act()
        for domain, products in zip(self._domains, self._products, strict=True):
            own = len(domain.rows)
            V[domain.rows], V[n + products] = domain.rates[:own], domain.rates[own:]
            v[domain.rows] = domain.twists
        if Record.FORCES in history.filled and (held or m):
            rates, multipliers = self._end_forces(H, v)
        balance = np.sum([domain.so_far for domain in self._domains], axis=0)
        self._filled.by_both(history, H, (V, v[:n]), multipliers, balance)
        if Record.FORCES in history.filled and held:
            report = equations.report(H, v, rates, multipliers, linearised=False)
            history.reactions[row] = report.reactions
        if Record.ENERGIES in history.filled:
            if self._joints is not None:
                history.elastic[row] = self._joints.energy(H)
            history.elastic[row] += sum(domain.stored for domain in self._domains)
        history.keep(np.array([self.index]), np.array([self._coupling.tries]))

    def _end_forces(self, H: Array, v: Array) -> tuple[Array, Array]:
        """Accelerations and multipliers of the equations of motion, with a matrix of their own."""
        equations = self.equations
        if self._solver is None:
            self._solver = DirectSolver(equations.matrix, PREFIX)
        n, ones = equations.unknowns.moving, np.ones(equations.unknowns.m)
        still = np.zeros((n, 6))
        # internal unknowns of elements are those of the domains, not yet set in these equations
        equations.residual(TimeState(H, v, still, 0.0 * ones), ones, self._r)
        time, size = self.index * self.h, self.h / max(d.count for d in self._domains)
        return accelerations(equations, self._solver, H, v, time, size, sweeps=2)


@dataclass(frozen=True)
class MultiRate(Integrator):
    """Multi-rate scheme; :meth:`run` integrates with constant whole steps.

    Bodies with different steps may be connected by joints. Links, springs, drives and contact
    between them raise an error, and so do drives, prescribed motions and time-dependent initial
    strains. Time-dependent loads are evaluated at the midpoints of the steps of their body, of
    explicit ones at their ends. ``result.iterations`` are the tried whole steps; the first column
    of ``result.balance`` contains the work of loads, and that of multipliers between bodies with
    different steps, which is round-off.

    Attributes:
        steps: Number of steps of each of these bodies in a whole step; all others make one.
        scheme: Scheme of the steps; its policy decides for each size of steps.
        schemes: Scheme of the steps of each of these bodies, ``EnergyMomentum`` or ``Explicit``;
            that of all others is ``scheme``. Explicit steps have lumped inertia.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> coarse = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4))
        >>> fine = scene.add(fl.Beam.straight((1, 0, 0), (1.2, 0, 0), tube, cells=4))
        >>> _ = scene.add(fl.joints.Fixed(coarse.point("end"), fine.point("start")))
        >>> scheme = fl.schemes.MultiRate({fine: 5})
        >>> result = scheme.run(scene, duration=5e-4, step=1e-4)
        >>> bool(result.energy_error < 1e-11)
        True
        >>> mixed = fl.schemes.MultiRate({fine: 50}, schemes={fine: fl.Explicit()})
        >>> result = mixed.run(scene, duration=5e-4, step=1e-4)
        >>> bool(result.energy_error < 1e-3)
        True
    """

    _wanted_step: ClassVar[str] = (
        "makes whole steps of one size: expected it as a number and a scene without "
        "discontinuities (or use EnergyMomentum)"
    )

    steps: Mapping[Body, int]
    scheme: EnergyMomentum = field(default_factory=EnergyMomentum)
    schemes: Mapping[Body, EnergyMomentum | Explicit] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the options."""
        instance(self.steps, Mapping, "MultiRate: steps", "a mapping such as {body: 10}")
        for body, count in self.steps.items():
            instance(body, Body, "MultiRate: steps", "bodies")
            whole(count, f"MultiRate: steps of {body.label}")
        instance(self.scheme, EnergyMomentum, "MultiRate: scheme", "EnergyMomentum()")
        _check_coupled(self.scheme, "MultiRate: scheme")
        expected = "a mapping such as {body: Explicit()}"
        instance(self.schemes, Mapping, "MultiRate: schemes", expected)
        for body, scheme in self.schemes.items():
            instance(body, Body, "MultiRate: schemes", "bodies")
            _check_coupled(scheme, f"MultiRate: scheme of {body.label}")

    def _sorts(self, scene: Scene) -> dict[Body, Sort]:
        """Steps of each body, the largest ones first."""
        given = (*self.steps, *self.schemes)
        strange = [body.label for body in given if body not in scene.bodies]
        if strange:
            known = ", ".join(body.label for body in scene.bodies)
            raise ValueError(
                f"MultiRate: {strange[0]} has steps of its own and is not in the scene; expected "
                f"bodies among {known}"
            )
        found = {
            body: Sort(self.steps.get(body, 1), self.schemes.get(body, self.scheme))
            for body in scene.bodies
        }
        return dict(sorted(found.items(), key=lambda of: of[1].steps))

    def _equations(self, scene: Scene) -> Equations:
        sorts = self._sorts(scene)
        domains(scene, sorts)
        equations = Equations(
            scene,
            dynamics=True,
            group=Group.R3xSO3,
            mass=MassMatrix.WITH_DRILLING,
            lumped=[body for body, sort in sorts.items() if sort.lumps],
        )
        unknowns = equations.unknowns
        refuse(
            "MultiRate",
            {
                "drives, prescribed motions and strains that change in time": (
                    unknowns.driven
                    or len(equations.start.frames) > unknowns.moving + 1
                    or unknowns.strains_change
                ),
                "redundant constraints": unknowns.may_be_redundant,
            },
            "EnergyMomentum",
        )
        return equations

    def _integration(self, equations: Equations, step: float) -> MultiRateRun:
        scenes, joints = domains(equations.scene, self._sorts(equations.scene))
        parts = {sort: sort.scheme.equations(scene) for sort, scene in scenes.items()}
        between = self.scheme.equations(joints)
        for part in (*parts.values(), between):
            _check_alike(part, equations)
        pairs = between.arrays.pairs_of_all
        reasons = {
            "joints on points that are not nodes between bodies with steps of their own": (
                pairs is not None and pairs.attachments.count > 0
            ),
        }
        refuse("MultiRate", reasons, "EnergyMomentum")
        return MultiRateRun(self.scheme.options(), equations, step, parts, between)


def _check_coupled(scheme: object, name: str) -> None:
    """Raise ``ValueError`` for a scheme whose steps have no domain."""
    if type(scheme) not in _DOMAINS:
        raise ValueError(
            f"{name}: MultiRate couples steps that conserve energy, and explicit ones: expected "
            f"EnergyMomentum() or, among schemes, Explicit(), got {scheme}"
        )


def _check_alike(part: Equations, whole: Equations) -> None:
    """Raise ``ValueError`` if drilling rotations depend on joints between domains."""
    rows = rows_of(part, whole)
    labels = {body.label for body in part.scene.bodies}
    drilling = labels.intersection(whole.unknowns.drilling) != set(part.unknowns.drilling)
    if drilling or (part.unknowns.kinds != whole.unknowns.kinds[rows]).any():
        raise ValueError(
            "MultiRate: nodes of a shell turn about their third directors because of a joint with "
            "a body of other steps; give both steps of one size, or the shell drilling=True"
        )
