"""Base classes of loads, and their histories.

A load history is a factor as a function of time (in statics: of the load factor between 0 and 1).
Without a history a load is constant in dynamics and proportional to the load factor in statics. A
history that jumps should declare its jumps (:class:`~fem_lie.loads.PiecewiseLinear`,
:class:`~fem_lie.loads.PiecewiseSmooth`): time steps then end at them.

In local frames a follower load is constant and has no load stiffness; a force fixed in space is a
constant force on ``q = (x, d₁, d₂, d₃)``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Array,
    Indices,
    at_time,
    flag,
    history,
    instance,
    text,
    vector,
    vectors_at,
)
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.forms.term import Term

History = Callable[[float], float]
Field: TypeAlias = npt.ArrayLike | Callable[[Array], npt.ArrayLike]
"""Three components, or a function of the position in the unloaded configuration, shape (3,)."""


def amplitudes(histories: Mapping[int, History], times: npt.ArrayLike) -> Array:
    """Factors of k loads at ``times`` (T,), shape (T, k); keys are the numbers of the loads.

    Raises:
        ValueError: A factor is not finite; the message names the load and the time.
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


def at_points(force: Field, positions: Array, what: str) -> Array:
    """Values of a force per area or volume at points of the unloaded configuration, both (m, g, 3).

    Raises:
        ValueError: A value does not have three finite components.
    """
    if not callable(force):
        return np.broadcast_to(vector(force, 3, what), positions.shape)
    return vectors_at(force, positions.reshape(-1, 3), 3, what).reshape(positions.shape)


class Sum(Protocol):
    """Receives the contributions of loads to the equations, at amplitude one."""

    def nodes(self, body: Body) -> Indices:
        """Numbers of a body's nodes in the numbering that terms of this sum use.

        Args:
            body: A body of the scene.
        """

    def add_nodal(self, body: Body, force: Array, on_directors: Array, *, following: bool) -> None:
        """Add nodal forces.

        Args:
            body: The loaded body.
            force: Force and moment at each node, shape (n, 6).
            on_directors: Additional forces on the directors d₁, d₂, d₃ of each node, shape (n, 3,
                3).
            following: Whether components refer to the nodal frames instead of global axes.
        """

    def add_strain(self, body: Body, strain: Array) -> None:
        """Add a stress-free strain of each cell of a body.

        Args:
            body: A body of the scene.
            strain: Strain of each cell, shape (m, s), as of :meth:`StrainLoad.strains`.
        """

    def add_term(self, term: Term) -> None:
        """Add a term that has a load stiffness.

        Args:
            term: The term.
        """


class Carrier(NamedTuple):
    """The argument of a load that is the loaded body.

    Attributes:
        field: Name of the argument.
        types: Admissible classes.
        expected: Description of the classes, for messages.
    """

    field: str
    types: Any
    expected: str

    def elsewhere(self, loads: str) -> Carrier:
        """The same, with the loads of other bodies in messages.

        Args:
            loads: Such as ``"on solids: FaceLoad"``.
        """
        return self._replace(expected=f"{self.expected} ({loads})")


class Load(ABC):
    """Base class of all loads.

    A subclass is a frozen dataclass. It names the argument that is its body (:attr:`carrier`) and
    its vector arguments (:attr:`components`), and adds its contribution to the equations
    (:meth:`contribute`). This class checks types, the history, the components and the group of
    cells.

    Attributes:
        carrier: The argument that is the loaded body.
        components: Number of finite components of each vector argument.
        divisible: Whether it is a sum over cells of its body, so that parts of the body carry their
            parts of it.
        history: Factor as a function of time, or ``None``.
        cells: Name of the loaded group of cells; default: all cells.
    """

    carrier: ClassVar[Carrier]
    divisible: ClassVar[bool] = False
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
        """Name of the loaded point or body, for messages."""
        return self.body.label

    def check(self) -> None:
        """Raise ``ValueError`` if a component is not finite or there is no such group of cells."""
        for name, count in self.components.items():
            what, value = (
                f"{name} of the {type(self).__name__} on {self.where}",
                getattr(self, name),
            )
            if callable(value):
                raise ValueError(
                    f"{what} must be constant numbers, got a function; expected its variation in "
                    "time as history="
                )
            vector(value, count, what)
        if self.cells is not None:
            self.body.model.cells_of(self.cells)

    @abstractmethod
    def contribute(self, to: Sum) -> None:
        """Add the contribution of the load to the equations.

        Args:
            to: Sum of all loads, to which this one is added.
        """


class NodalLoad(Load):
    """Base class of loads that are nodal forces and moments.

    Attributes:
        following: Whether the load rotates with the nodal frames (follower load).
    """

    following: bool

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        super().__post_init__()
        flag(self.following, f"{type(self).__name__}: following")

    def contribute(self, to: Sum) -> None:
        """Add the nodal forces.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        to.add_nodal(self.body, self.nodal(), self.on_directors(), following=self.following)

    @abstractmethod
    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""

    def on_directors(self) -> Array:
        """Additional forces on d₁, d₂, d₃ of each node, in the axes of the force, (n, 3, 3)."""
        return np.zeros((len(self.body.frames), 3, 3))


class StrainLoad(Load):
    """Base class of loads that are a stress-free strain of a beam, a shell or a solid.

    Attributes:
        loaded: The beam, shell or solid.
        cells: Name of a group of cells; default: all.
    """

    carrier = Carrier("loaded", Beam | Shell | Solid, "a Beam, a Shell or a Solid")
    divisible = True
    loaded: Beam | Shell | Solid

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type.

        Raises:
            ValueError: The elements of the body do not take stress-free strains.
        """
        super().__post_init__()
        self.loaded.model.require_eigenstrain(f"a strain ({type(self).__name__})")

    def contribute(self, to: Sum) -> None:
        """Add the strain.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        to.add_strain(self.loaded, self.strains())

    @abstractmethod
    def strains(self) -> Array:
        """Stress-free strain of each cell of the body.

        Its shape is (m, 6) for the (Γ, κ) of a beam and the strains of a solid, and (m, 8) for
        those of a shell.
        """

    def _in_cells(self, strain: npt.ArrayLike) -> Array:
        """The strain, (s,) or (m, s), in the loaded cells and zero in the others, shape (m, s)."""
        model = self.loaded.model
        given = np.asarray(strain, dtype=np.float64)
        values, cells = np.zeros(model.strains_shape), model.cells_of(self.cells)
        values[cells] = np.broadcast_to(given, values.shape)[cells]
        return values

    def _components(self, name: str) -> Array:
        """A vector argument with a component for each strain of the body, shape (s,)."""
        what = f"{name} of the {type(self).__name__} on {self.where}"
        return vector(getattr(self, name), self.loaded.model.strains_shape[1], what)


def strained_bodies(loads: Sequence[Load]) -> tuple[str, ...]:
    """Names of the bodies with loads that are stress-free strains, in alphabetical order.

    Args:
        loads: Loads of a scene.
    """
    return tuple(sorted({load.body.name for load in loads if isinstance(load, StrainLoad)}))


def strains_of(
    loads: Sequence[Load], body: Beam | Shell | Solid, times: Array, factors: Array
) -> Array:
    """Stress-free strains of the cells of a body by all loads, shape (T, m, s).

    Args:
        loads: Loads of the scene.
        body: The body, with m cells.
        times: Times at which histories are evaluated, shape (T,).
        factors: Factors of loads without history, shape (T,).
    """
    total = np.zeros((len(times), *body.model.strains_shape))
    for number, load in enumerate(loads):
        if isinstance(load, StrainLoad) and load.body is body:
            given = load.history
            amplitude = factors if given is None else amplitudes({number: given}, times)[:, 0]
            total += amplitude[:, np.newaxis, np.newaxis] * load.strains()
    return total


def histories(loads: Sequence[Load]) -> dict[int, History]:
    """Histories of the loads that have one, by the number of the load."""
    return {k: load.history for k, load in enumerate(loads) if load.history is not None}
