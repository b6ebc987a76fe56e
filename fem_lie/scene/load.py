"""Loads and supports: what a scene adds to points and bodies.

A load history is a function of time (in statics: of the load factor between 0 and 1). Without one a
load is constant in dynamics and proportional to the load factor in statics. One that jumps should
say so (:class:`~fem_lie.Table`, :class:`~fem_lie.Jumps`): steps in time then end there.

In local frames a following load is constant and has no load stiffness at all; a force fixed in
space is a constant force on ``q = (x, d₁, d₂, d₃)``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, at_time, flag, history, instance, text, vector
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.forms.term import Term

History = Callable[[float], float]
Field: TypeAlias = npt.ArrayLike | Callable[[Array], npt.ArrayLike]
"""Three components, or a function of the unloaded place, shape (3,), that gives them."""


def amplitudes(histories: Mapping[int, History], times: npt.ArrayLike) -> Array:
    """Factors at ``times`` (T,), shape (T, k), of k loads; keys are their numbers in the scene.

    Raises:
        ValueError: One of them is not finite; the message names load and time.
    """
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    if not histories:
        return np.zeros((len(at), 0))
    named = [(given, f"the history of load {k + 1}") for k, given in histories.items()]
    values = [[at_time(given, time, what) for given, what in named] for time in map(float, at)]
    factors = np.array(values, dtype=np.float64).reshape(len(at), len(histories))
    if not np.isfinite(factors).all():
        t, k = np.argwhere(~np.isfinite(factors))[0]
        raise ValueError(
            f"the history of load {list(histories)[k] + 1} is {factors[t, k]} at time {at[t]:g}"
        )
    return factors


def at_places(force: Field, places: Array, what: str) -> Array:
    """A force per area or volume at unloaded places (m, g, 3), checked.

    Raises:
        ValueError: It has not three finite components.
    """
    if not callable(force):
        return np.broadcast_to(vector(force, 3, what), places.shape)
    values = [vector(force(x), 3, f"{what} at {x}") for x in places.reshape(-1, 3)]
    return np.array(values).reshape(places.shape)


class Sum(Protocol):
    """Of what loads contribute to the equations, at amplitude one."""

    def nodes(self, body: Body) -> Indices:
        """Numbers of a body's nodes, as a term of this sum takes them."""

    def add_nodal(self, body: Body, force: Array, levers: Array, *, following: bool) -> None:
        """Forces on nodes.

        Args:
            body: Whose.
            force: Force and moment at each node, shape (n, 6).
            levers: Force on the directors of each node beside, shape (n, 3, 3).
            following: Whether components are those in the nodes' frames.
        """

    def add_strain(self, body: Body, strain: Array) -> None:
        """A strain (Γ, κ) without stress of each cell of a body, shape (m, 6)."""

    def add_term(self, term: Term) -> None:
        """What has a matrix."""


class Carrier(NamedTuple):
    """Which argument of a load is the body that carries it.

    Attributes:
        field: Name of the argument.
        types: Classes of such bodies.
        expected: These in words, for messages.
    """

    field: str
    types: Any
    expected: str


class Load(ABC):
    """What all loads have in common; use one of the subclasses.

    A subclass is a frozen dataclass that names the argument that is its body (:attr:`carrier`) and
    its arguments of three or other numbers of components (:attr:`components`), and adds what it is
    in the equations (:meth:`contribute`). Types, the time function, components and the group of
    cells are checked here.

    Attributes:
        carrier: The argument that is the body.
        components: How many finite components each of these arguments has.
        history: Factor as a function of time, or ``None``.
        cells: Name of the group of cells that are loaded; default: all, or none in particular.
    """

    carrier: ClassVar[Carrier]
    components: ClassVar[Mapping[str, int]] = MappingProxyType({})
    history: History | None
    cells: str | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another type than expected."""
        history(self.history, f"{type(self).__name__}: history")
        field, types, expected = self.carrier
        instance(getattr(self, field), types, f"{type(self).__name__}: {field}", expected)
        if self.cells is not None:
            text(self.cells, f"{type(self).__name__}: cells")

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        return cast(Body, getattr(self, self.carrier.field))

    @property
    def where(self) -> str:
        """What is loaded, for messages."""
        return self.body.label

    def check(self) -> None:
        """Raise ``ValueError`` if components are not finite or the body has no such cells."""
        for name, count in self.components.items():
            what = f"{name} of the {type(self).__name__} on {self.where}"
            vector(getattr(self, name), count, what)
        if self.cells is not None:
            self.body.cells_of(self.cells)

    @abstractmethod
    def contribute(self, to: Sum) -> None:
        """Add what it is in the equations."""


class NodalLoad(Load):
    """Forces and moments on nodes.

    Attributes:
        following: Whether the load turns with the nodes' frames.
    """

    following: bool

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        super().__post_init__()
        flag(self.following, f"{type(self).__name__}: following")

    def contribute(self, to: Sum) -> None:
        """Forces on nodes."""
        to.add_nodal(self.body, self.nodal(), self.on_directors(), following=self.following)

    @abstractmethod
    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""

    def on_directors(self) -> Array:
        """Force on the directors of each node beside, as ``force`` and on d₁, d₂, d₃, (n, 3, 3)."""
        return np.zeros((len(self.body.frames), 3, 3))


class StrainLoad(Load):
    """A strain that a beam would have without stress.

    Attributes:
        beam: What is strained.
        cells: Name of a group of cells; default: all.
    """

    carrier = Carrier("beam", Beam, "a Beam")
    beam: Beam

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another kind than wanted.

        Raises:
            ValueError: The beam's elements do not bend within.
        """
        super().__post_init__()
        self.beam.formulation.require_bends(f"a strain ({type(self).__name__})")

    def contribute(self, to: Sum) -> None:
        """A strain."""
        to.add_strain(self.beam, self.strains())

    @abstractmethod
    def strains(self) -> Array:
        """Strain (Γ, κ) of each cell of the body, shape (m, 6)."""

    def _in_cells(self, strain: npt.ArrayLike) -> Array:
        """The strain, (6,) or (m, 6), in the loaded cells, zero elsewhere."""
        values, cells = np.zeros((len(self.beam.stiffness), 6)), self.beam.cells_of(self.cells)
        given = np.asarray(strain, dtype=np.float64)
        values[cells] = np.broadcast_to(given, values.shape)[cells]
        return values


def histories(loads: Sequence[Load]) -> dict[int, History]:
    """Those of the loads that have one, by the loads' numbers."""
    return {k: load.history for k, load in enumerate(loads) if load.history is not None}
