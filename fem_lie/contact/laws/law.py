"""Contact laws, and the base classes of laws and of terms of contact forces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import InitVar, dataclass, field, replace
from typing import ClassVar, NamedTuple

from fem_lie._arrays import Array, Indices, number, positive
from fem_lie.contact.laws.anchors import CoulombLaw
from fem_lie.contact.laws.energy import PenaltyConstants
from fem_lie.forms.abilities import ContactState
from fem_lie.forms.term import Term


class ContactTerm(Term, ContactState):
    """Contact forces of one contact by penalty.

    Attributes:
        ignores: Whether pairs that overlap at the start are ignored until they separate.
        key: Number that identifies the contact in results, see :meth:`.Contact.key`.
    """

    ignores: bool = False
    key: int = 0

    @property
    def of_contact(self) -> ContactState:
        """State of the contact."""
        return self

    def contact_state(self, numbers: Indices) -> dict[str, Array]:
        """History variables, and the record of steps; see the base class."""
        stress, passage, found = self.stress_update, self.passage, dict[str, Array]()
        if stress is not None:
            found["history"] = self._renumbered(stress.linearised_values.copy(), numbers)
        if passage is not None:
            found["watched"] = passage.watched
        return found

    def restore_contact(self, kept: Mapping[str, Array], nodes: Indices) -> None:
        """Restore the state of :meth:`contact_state`."""
        stress, passage = self.stress_update, self.passage
        if stress is not None:
            stress.restore(self._renumbered(kept["history"], nodes))
        if passage is not None:
            passage.watch_again(kept["watched"])

    def _renumbered(self, values: Array, numbers: Indices) -> Array:
        """History variables with other numbers of nodes; default: they name no nodes.

        Args:
            values: Values of :attr:`.LinearisedStress.linearised_values`.
            numbers: New number of each node, shape (n,).
        """
        return values

    @abstractmethod
    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept the state with frames ``H`` at the end of a step from ``start``."""

    @abstractmethod
    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Pairs of points in contact, with their gaps and forces.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
            v: Twists of all nodes, shape (n, 6).

        Returns:
            Pairs of points (k, 2), gaps (k,), closest points of the first surface (k, 3), and
            contact forces on it without friction (k, 3), in global components.
        """


class FrictionConstants(NamedTuple):
    """Constants of friction with one tangential spring per node.

    Attributes:
        μ: Coefficient of friction.
        k: Stiffness of the tangential springs, force per length of the line and slip, N/m².
    """

    μ: float
    k: float


class ContactLaw(ABC):
    """Base class of contact laws.

    Attributes:
        friction: Coefficient of friction μ.
        impulsive: Whether the law has impulses at the ends of steps, instead of forces.
        static: Whether the law is for equilibria only.
    """

    friction: float
    impulsive: ClassVar[bool]
    static: ClassVar[bool] = False

    @property
    def path_dependent(self) -> bool:
        """Whether forces depend on the path; default: they do not."""
        return False

    @property
    def largest_stiffness(self) -> float:
        """Stiffness of the stiffest spring, normal or tangential; default: there are none."""
        return 0.0

    def penalty(self, label: str) -> Penalty:
        """The law, if it is a penalty.

        Args:
            label: Label of the contact for messages.

        Raises:
            ValueError: It is not; this is the default.
        """
        raise ValueError(
            f"{label}: {type(self).__name__} is for GeneralisedAlpha, Variational and Explicit "
            "with constant steps; give Penalty elsewhere"
        )

    def impact(self, label: str) -> Impact:
        """The law, if it has impulses.

        Args:
            label: Label of the contact for messages.

        Raises:
            ValueError: It has not; this is the default.
        """
        raise ValueError(f"{label}: expected Impact, got {type(self).__name__}")

    def with_stiffness(self, choose: Callable[[], float]) -> ContactLaw:
        """The law with a stiffness, if it needs one and has none; default: the law itself.

        Args:
            choose: Computes the stiffness.
        """
        return self


@dataclass(frozen=True)
class Penalty(ContactLaw):
    """Contact law with a force proportional to the overlap: energy ``½ k g²`` at a gap ``g < 0``.

    The force is ``p = max(0, −k g − c ġ)``; it is never tensile. The law is for statics, for
    :class:`~fem_lie.GeneralisedAlpha` and, without damping, for conserving schemes. A body of mass
    m that hits a fixed one at a speed v penetrates by ``v √(m/k)`` and is in contact for
    ``π √(m/k)``. Steps have to resolve this duration in schemes that do not conserve energy: ten
    steps keep the energy error at 1 %, and :class:`~fem_lie.contact.UnresolvedContactWarning`
    reports larger errors. Along lines, stiffness, damping and force are per length of the first
    line.

    Attributes:
        stiffness: k, force per length. Default: by the softest beam or shell element of both
            bodies, a fifth of EA/ℓ or E ℓ; the contact then has this value and logs it.
        damping: c, force per velocity; ``2 √(k m)`` is critical for a mass m. It acts along the
            tangential springs, too, within the limit of friction.
        ramp: Overlap over which the damping grows from zero to c. Without it the force is
            discontinuous where surfaces meet, and Newton's method fails if c is large.
        friction: Coefficient of friction μ: the tangential force is at most μ times the normal
            force, with its damping. Below this limit tangential springs hold, whose state is kept
            from step to step.
        holding: Stiffness of the tangential springs; default: k. Springs that are as soft as the
            contact stick at the beginning of an impact even where rigid bodies slip; with a
            hundred times k impacts are as those of :class:`Impact`.
        restitution: An error that names ``damping``: a penalty has no restitution.
    """

    stiffness: float | None = None
    damping: float = 0.0
    ramp: float = 0.0
    friction: float = 0.0
    holding: float | None = None
    restitution: InitVar[None] = None

    impulsive: ClassVar[bool] = False

    def __post_init__(self, restitution: None) -> None:
        """Raise ``TypeError`` or ``ValueError`` for wrong types or values out of range."""
        if restitution is not None:
            raise ValueError(
                "Penalty: restitution: a penalty has damping, not restitution; give damping, or "
                "Impact(restitution=...)"
            )
        if self.stiffness is not None:
            positive(self.stiffness, "Penalty: stiffness")
        if number(self.damping, "Penalty: damping") < 0.0:
            raise ValueError(f"Penalty: damping must not be negative, got {self.damping}")
        if number(self.ramp, "Penalty: ramp") < 0.0:
            raise ValueError(f"Penalty: ramp must not be negative, got {self.ramp}")
        if number(self.friction, "Penalty: friction") < 0.0:
            raise ValueError(f"Penalty: friction must not be negative, got {self.friction}")
        if self.holding is not None:
            positive(self.holding, "Penalty: holding")

    @property
    def path_dependent(self) -> bool:
        """Whether forces depend on the path, by friction."""
        return self.friction > 0.0

    def penalty(self, label: str) -> Penalty:
        """The law itself."""
        return self

    def with_stiffness(self, choose: Callable[[], float]) -> Penalty:
        """The law with the given stiffness, or else the chosen one."""
        return self if self.stiffness is not None else replace(self, stiffness=choose())

    @property
    def k(self) -> float:
        """The stiffness of the law of a contact.

        Raises:
            ValueError: The stiffness is neither given nor chosen by a contact yet.
        """
        if self.stiffness is None:
            raise ValueError("Penalty: stiffness is chosen by the Contact that has it")
        return self.stiffness

    @property
    def largest_stiffness(self) -> float:
        """Stiffness of the stiffest spring; see :attr:`k` for errors."""
        return max(self.k, self.coulomb.holding) if self.friction > 0.0 else self.k

    @property
    def normal(self) -> PenaltyConstants:
        """Stiffness and damping as constants; see :attr:`k` for errors."""
        return PenaltyConstants(float(self.k), float(self.damping), float(self.ramp))

    @property
    def coulomb(self) -> CoulombLaw:
        """All constants of friction; see :attr:`k` for errors."""
        holding = self.k if self.holding is None else self.holding
        return CoulombLaw(self.normal, float(self.friction), float(holding))


@dataclass(frozen=True)
class MortarLaw(ContactLaw):
    """Base class of contact laws along lines with one pressure per node of a line.

    Attributes:
        stiffness: k, N/m².
    """

    stiffness: float | None = None

    impulsive: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for wrong types or values out of range."""
        if self.stiffness is not None:
            positive(self.stiffness, f"{type(self).__name__}: stiffness")

    @property
    def coulomb(self) -> FrictionConstants | None:
        """Constants of friction; default: none."""
        return None

    def with_stiffness(self, choose: Callable[[], float]) -> MortarLaw:
        """The law with the given stiffness, or else the chosen one."""
        return self if self.stiffness is not None else replace(self, stiffness=choose())

    @property
    def k(self) -> float:
        """The stiffness of the law of a contact.

        Raises:
            ValueError: The stiffness is neither given nor chosen by a contact yet.
        """
        if self.stiffness is None:
            raise ValueError(f"{type(self).__name__}: stiffness is chosen by its Contact")
        return self.stiffness

    @property
    def largest_stiffness(self) -> float:
        """Stiffness of the stiffest spring; see :attr:`k` for errors."""
        return self.k if self.coulomb is None else max(self.k, self.coulomb.k)


@dataclass(frozen=True)
class MortarPenalty(MortarLaw):
    """Contact law along lines with a penalty on mean gaps: one pressure per node of a line.

    The first of two surfaces is a :class:`~fem_lie.contact.Line`. The pressure is linear between
    its nodes and proportional to the mean overlap near each node. Products of shape functions of
    both lines are integrated exactly, so that an even pressure is transmitted exactly between
    meshes that do not match. Without damping; for statics and, in dynamics, for
    :class:`~fem_lie.GeneralisedAlpha` and, without friction, :class:`~fem_lie.schemes.Variational`
    and :class:`~fem_lie.Explicit`.

    A pressure acts on the mean gap near a node. For lines that cross at large angles use
    :class:`~fem_lie.contact.Penalty`.

    Attributes:
        stiffness: k, force per length of the first line and overlap, N/m². Default: as for
            :class:`~fem_lie.contact.Penalty`.
        friction: Coefficient of friction μ. Each pressure has one tangential spring, on the mean
            slip near its node, whose traction is at most μ times the pressure.
        holding: Stiffness of the tangential springs, N/m²; default: k.
    """

    friction: float = 0.0
    holding: float | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for wrong types or values out of range."""
        super().__post_init__()
        if number(self.friction, "MortarPenalty: friction") < 0.0:
            raise ValueError(f"MortarPenalty: friction must not be negative, got {self.friction}")
        if self.holding is not None:
            positive(self.holding, "MortarPenalty: holding")

    @property
    def path_dependent(self) -> bool:
        """Whether forces depend on the path, by friction."""
        return self.friction > 0.0

    @property
    def coulomb(self) -> FrictionConstants | None:
        """Constants of friction, if there is any; see :attr:`k` for errors."""
        if not self.friction > 0.0:
            return None
        return FrictionConstants(self.friction, self.k if self.holding is None else self.holding)


@dataclass(frozen=True)
class Mortar(MortarLaw):
    """Contact law along lines with Lagrange multipliers: one pressure per node of a line.

    Mean gaps near the nodes of the first line are zero where there is a pressure, and pressures are
    not negative. Weighted gaps are those of :class:`~fem_lie.contact.MortarPenalty`, which has
    friction, too. Equilibria do not depend on the stiffness: the larger it is, the fewer iterations
    does Newton's method take. The law is for statics. In dynamics a multiplier of the last step
    would do work in the next one.

    Attributes:
        stiffness: k of the augmented Lagrangian, N/m². Default: as for
            :class:`~fem_lie.contact.Penalty`.
    """

    friction: float = field(default=0.0, init=False)

    static: ClassVar[bool] = True

    @property
    def path_dependent(self) -> bool:
        """True: multipliers are those of the last accepted state."""
        return True


@dataclass(frozen=True)
class Impact(ContactLaw):
    """Contact law of rigid surfaces: no penetration, Coulomb friction, Newton's restitution.

    The law is for :class:`~fem_lie.GeneralisedAlpha`, :class:`~fem_lie.schemes.Variational` and
    :class:`~fem_lie.Explicit` with constant steps, and for bodies whose nodes are frames (rigid
    bodies, beams, shells) or positions (nets, membranes, solids), with or without joints. Nodes
    without rotations take no moment: friction acts at their centre. Steps need not resolve the
    duration of impacts. If several impacts occur at once, restitution is a modelling assumption,
    not physics.

    Attributes:
        friction: Coefficient of friction μ: largest ratio of the tangential to the normal force.
        restitution: Coefficient of restitution e, in [0, 1]: ratio of the normal velocities after
            and before an impact.
    """

    friction: float = 0.0
    restitution: float = 0.0

    impulsive: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for wrong types or values out of range."""
        if number(self.friction, "Impact: friction") < 0.0:
            raise ValueError(f"Impact: friction must not be negative, got {self.friction}")
        if not 0.0 <= number(self.restitution, "Impact: restitution") <= 1.0:
            raise ValueError(f"Impact: restitution must be in [0, 1], got {self.restitution}")

    def impact(self, label: str) -> Impact:
        """The law itself."""
        return self
