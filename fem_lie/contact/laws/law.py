"""Contact laws, and what every term of contact forces has."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import InitVar, dataclass

from fem_lie._arrays import Array, Indices, number, positive
from fem_lie.contact.friction.anchors import CoulombLaw
from fem_lie.forms.term import Term


class ContactTerm(Term):
    """Forces of a contact by penalty.

    Attributes:
        ignores: Whether pairs that overlap at the start are ignored until they part.
    """

    ignores: bool = False

    @abstractmethod
    def accept(self, H: Array) -> None:
        """Accept the state with frames ``H``."""

    @abstractmethod
    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Pairs of points that touch, and how.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
            v: Their twists, shape (n, 6).

        Returns:
            Pairs of points (k, 2), gaps (k,), closest points of the first surface (k, 3), and
            forces on it (k, 3), global components.
        """


@dataclass(frozen=True)
class Penalty:
    """Surfaces push each other apart where they overlap: ``½ k g²`` at a gap ``g < 0``.

    The force is ``p = max(0, −k g − c ġ)``: it never pulls. It is for statics, for
    :class:`~fem_lie.GeneralisedAlpha` and, without damping, for conserving schemes. A body of
    mass m that meets a fixed one at a speed v goes in by ``v √(m/k)``, and is in contact for
    ``π √(m/k)``, which steps have to resolve where nothing conserves energy: ten steps keep it to
    1 %, and :class:`~fem_lie.UnresolvedContactWarning` says where too few change it. Along lines
    all is per length of the first one.

    Attributes:
        stiffness: k, force per length; default: a fifth of that of the softest element of beams
            and shells behind the surfaces, which the contact then has and logs.
        damping: c, force per speed; ``2 √(k m)`` is critical for a mass m.
        ramp: Overlap over which damping grows from nothing to c. Without it the force jumps where
            surfaces meet, which Newton's method does not survive where c is large.
        friction: μ: the largest force across the normal over ``k`` times the overlap. Until that
            is reached springs hold, which are carried from step to step. Lines have none in
            conserving schemes.
        holding: Their stiffness; default: k.
        restitution: None: a penalty has damping.
    """

    stiffness: float | None = None
    damping: float = 0.0
    ramp: float = 0.0
    friction: float = 0.0
    holding: float | None = None
    restitution: InitVar[None] = None

    def __post_init__(self, restitution: None) -> None:
        """Raise ``TypeError`` or ``ValueError`` for numbers that are none, or out of range."""
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
    def k(self) -> float:
        """The stiffness, of a law that a contact has.

        Raises:
            ValueError: None was given or chosen.
        """
        if self.stiffness is None:
            raise ValueError("Penalty: stiffness is chosen by the Contact that has it")
        return self.stiffness

    @property
    def coulomb(self) -> CoulombLaw:
        """Stiffness and friction as constants; see :attr:`k` for errors."""
        holding = self.k if self.holding is None else self.holding
        return CoulombLaw(float(self.k), float(self.friction), float(holding))


@dataclass(frozen=True)
class Impact:
    """Rigid surfaces: they never overlap, rub by Coulomb's law and bounce by Newton's.

    It is for :class:`~fem_lie.GeneralisedAlpha` and :class:`~fem_lie.Variational` with constant
    steps, and for rigid bodies, beams and shells whose nodes are frames, in joints or not. Steps
    need not resolve impacts.
    Of several impacts at once restitution is a law, not physics.

    Attributes:
        friction: μ: the largest force across the normal over that along it.
        restitution: e, in [0, 1]: velocity after an impact over that before, along the normal.
    """

    friction: float = 0.0
    restitution: float = 0.0

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for numbers that are none, or out of range."""
        if number(self.friction, "Impact: friction") < 0.0:
            raise ValueError(f"Impact: friction must not be negative, got {self.friction}")
        if not 0.0 <= number(self.restitution, "Impact: restitution") <= 1.0:
            raise ValueError(f"Impact: restitution must be in [0, 1], got {self.restitution}")
