"""Force laws along coordinates: functions of users in Python or compiled, and laws of the package.

All of them are C callbacks, which compiled loops over joints call by their addresses
(:mod:`fem_lie.joints.equations.laws`).
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeAlias, overload

import numba
import numpy as np
import numpy.typing as npt
from numba.core.errors import NumbaError
from scipy.interpolate import PchipInterpolator

from fem_lie._arrays import Array, number, shown
from fem_lie._jit import callback, compiled, uncounted
from fem_lie._jit.stack import vector_at
from fem_lie.joints.equations.laws import (
    BY_COORDINATE,
    BY_RATE,
    COORDINATE,
    FORCE,
    OF_DERIVATIVES,
    OF_FORCE,
    OF_POTENTIAL,
    POTENTIAL,
    RATE,
    SIGNATURE,
    SIZE,
    TIME,
)

Force: TypeAlias = Callable[[float, float, float], float]
"""Force as a function of time, coordinate and rate."""

Derivatives: TypeAlias = Callable[[float, float, float], tuple[float, float]]
"""Derivatives of a force in coordinate and rate, as a function of time, coordinate and rate."""

Potential: TypeAlias = Callable[[float], float]
"""Potential as a function of the coordinate, whose derivative is the force."""

_STEP, _COMPILED_STEP = 1e-20, 1e-9
"""Imaginary steps of derivatives. In compiled code ``z**3`` is ``exp(3 log z)``, whose imaginary
part has the round-off of the whole value."""

_GIVE = "give derivatives=, a function of (t, q, rate) that returns ∂F/∂q and ∂F/∂rate"

_Numbers: TypeAlias = Any
"""Pointer to doubles."""

_PROTOTYPE = ctypes.CFUNCTYPE(
    None, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double), ctypes.c_int64
)


class ForceLawError(RuntimeError):
    """A force law of the user failed, or did not return a number; the message says where."""


class Law(ABC):
    """Force along a coordinate as a function of time, coordinate and rate.

    A positive force opposes an increase of the coordinate, like that of a spring.

    Attributes:
        has_potential: Whether the force is the derivative of a potential, and so a function of the
            coordinate only.
        data: Numbers of which the callback gets the address.
    """

    has_potential: bool = False
    data: Array = np.empty(0)

    @property
    @abstractmethod
    def address(self) -> int:
        """Address of the callback."""

    def failure(self) -> Exception | None:
        """Error of the function since the last call of this method, or ``None``."""
        return None

    def record(self, t: float, q: float, rate: float, order: int) -> Array:
        """Record of a call, see :mod:`fem_lie.joints.equations.laws`, shape (7,).

        Args:
            t: Time.
            q: Coordinate.
            rate: Rate of the coordinate.
            order: What is computed.

        Raises:
            ForceLawError: The function failed.
        """
        out, data = np.zeros(SIZE), np.ascontiguousarray(self.data, dtype=np.float64)
        out[[TIME, COORDINATE, RATE]] = t, q, rate
        pointer = ctypes.POINTER(ctypes.c_double)
        given = (array.ctypes.data_as(pointer) for array in (out, data))
        _PROTOTYPE(self.address)(*given, order)
        if error := self.failure():
            raise ForceLawError(_where(error, t, q, rate)) from error
        return out

    def __call__(self, t: float, q: float, rate: float) -> float:
        """Force at time ``t``, coordinate ``q`` and its rate."""
        return float(self.record(t, q, rate, OF_FORCE)[FORCE])

    def derivatives(self, t: float, q: float, rate: float) -> tuple[float, float]:
        """Derivatives of the force in the coordinate and in its rate.

        Args:
            t: Time.
            q: Coordinate.
            rate: Rate of the coordinate.
        """
        by_coordinate, by_rate = self.record(t, q, rate, OF_DERIVATIVES)[[BY_COORDINATE, BY_RATE]]
        return float(by_coordinate), float(by_rate)

    def potential(self, q: float) -> float:
        """Potential at coordinate ``q``; 0 if there is none.

        Args:
            q: Coordinate.
        """
        return float(self.record(0.0, q, 0.0, OF_POTENTIAL)[POTENTIAL])


def _where(error: Exception, t: float, q: float, rate: float) -> str:
    what = f"{type(error).__name__}: {error}"
    return f"{what} (at time {t:g}, coordinate {q:g}, rate {rate:g})"


class PythonLaw(Law):
    """Law of Python functions; compiled loops call the interpreter."""

    def __init__(
        self, force: Force, derivatives: Derivatives | None, potential: Potential | None
    ) -> None:
        """Create the callback.

        Args:
            force: The force.
            derivatives: Its derivatives; default: by complex steps.
            potential: Its potential, if it has one.
        """
        self._force, self._potential = force, potential
        self._derivatives = self._complex_steps if derivatives is None else derivatives
        self.has_potential = potential is not None
        self._error: Exception | None = None
        self._entrance = _PROTOTYPE(self._call)
        self._orders = self._set_force, self._set_derivatives, self._set_potential

    @cached_property
    def address(self) -> int:
        """Address of the callback."""
        found = ctypes.cast(self._entrance, ctypes.c_void_p).value
        assert found is not None
        return found

    def failure(self) -> Exception | None:
        """First error of the functions since the last call of this method."""
        error, self._error = self._error, None
        return error

    def _call(self, record: _Numbers, data: _Numbers, order: int) -> None:
        """Compute what ``order`` asks for; after an error the results are NaN."""
        try:
            if self._error is None:
                self._orders[order](record)
                return
        except Exception as error:  # errors cannot pass through compiled code
            self._error = error
        for k in FORCE, BY_COORDINATE, BY_RATE, POTENTIAL:
            record[k] = np.nan

    def _set_force(self, record: _Numbers) -> None:
        value: Any = self._force(record[TIME], record[COORDINATE], record[RATE])
        if not isinstance(value, float):
            value = number(value, "value of the law")
        if value - value != 0.0:
            raise ValueError(f"expected a finite value of the law, got {value}")
        record[FORCE] = value

    def _set_derivatives(self, record: _Numbers) -> None:
        given: Any = self._derivatives(record[TIME], record[COORDINATE], record[RATE])
        try:
            by_coordinate, by_rate = given
        except (TypeError, ValueError):
            raise TypeError(
                f"derivatives must return two numbers, ∂F/∂q and ∂F/∂rate, got {shown(given)}"
            ) from None
        record[BY_COORDINATE] = number(by_coordinate, "derivative of the law in the coordinate")
        record[BY_RATE] = number(by_rate, "derivative of the law in the rate")

    def _set_potential(self, record: _Numbers) -> None:
        given = 0.0 if self._potential is None else self._potential(record[COORDINATE])
        record[POTENTIAL] = number(given, "potential of the law")

    def _complex_steps(self, t: float, q: float, rate: float) -> tuple[float, float]:
        force: Any = self._force
        try:
            along = force(t, complex(q, _STEP), complex(rate)), force(t, q, complex(rate, _STEP))
        except TypeError as error:
            raise TypeError(
                f"the law cannot be differentiated by complex numbers ({error}): {_GIVE}, or use "
                "functions of numpy that take complex numbers"
            ) from error
        by_coordinate, by_rate = (float(np.imag(value)) / _STEP for value in along)
        return by_coordinate, by_rate


class CompiledLaw(Law):
    """Law of functions that numba compiles: :func:`compiled_law` makes it."""

    def __init__(
        self, force: Force, derivatives: Derivatives | None, potential: Potential | None
    ) -> None:
        """Compile the functions.

        Args:
            force: The force.
            derivatives: Its derivatives; default: by complex steps.
            potential: Its potential, if it has one.

        Raises:
            TypeError: numba cannot compile a function.
        """
        self.has_potential, self.__name__ = potential is not None, _name(force)
        of_force = _compiled(force)
        by = _complex_steps(of_force) if derivatives is None else _compiled(derivatives)
        of_potential = _without_potential if potential is None else _compiled(potential)
        advice = "" if derivatives is not None else f", by complex numbers; {_GIVE}"
        numbers = numba.types.Float | numba.types.Integer | numba.types.Boolean
        scalar = "a number", lambda kind: isinstance(kind, numbers)
        pair = (
            "two numbers",
            lambda kind: isinstance(kind, numba.types.BaseTuple) and len(kind) == 2,
        )
        self._try(of_force, 3, "the law", *scalar)
        self._try(by, 3, f"derivatives of the law{advice}", *pair)
        if potential is not None:
            self._try(of_potential, 1, "the potential", *scalar)
        self._made = _callback(of_force, by, of_potential)

    def _try(
        self, function: Any, count: int, what: str, expected: str, fits: Callable[[Any], bool]
    ) -> None:
        """Compile a function of ``count`` numbers; refuse it if the type of its result is wrong."""
        try:
            function.compile((numba.float64,) * count)
        except (NumbaError, NotImplementedError) as error:
            reason = str(error).strip().splitlines()[0]
            raise TypeError(
                f"compiled_law({self.__name__}): numba cannot compile {what} ({reason})"
            ) from error
        given = function.nopython_signatures[0].return_type
        if not fits(given):
            raise TypeError(
                f"compiled_law({self.__name__}): {what} must return {expected}, got {given}"
            )

    @property
    def address(self) -> int:
        """Address of the callback."""
        return int(self._made.address)


def _name(function: object) -> str:
    return str(getattr(function, "__name__", type(function).__name__))


def _compiled(function: Any) -> Any:
    """The function compiled by numba, if it is not already."""
    return function if hasattr(function, "py_func") else numba.njit(function)


@compiled
def _without_potential(q: float) -> float:
    return 0.0


def _complex_steps(force: Any) -> Any:
    step = _COMPILED_STEP

    @numba.njit
    def derivatives(t: float, q: float, rate: float) -> tuple[float, float]:
        by_coordinate = force(t, complex(q, step), complex(rate, 0.0))
        by_rate = force(t, complex(q, 0.0), complex(rate, step))
        return by_coordinate.imag / step, by_rate.imag / step

    return derivatives


def _callback(force: Any, derivatives: Any, potential: Any) -> Any:
    @numba.cfunc(SIGNATURE)
    def call(address: Any, data: Any, order: int) -> None:
        record = numba.carray(address, SIZE)
        t, q, rate = record[TIME], record[COORDINATE], record[RATE]
        if order == OF_FORCE:
            record[FORCE] = force(t, q, rate)
        elif order == OF_DERIVATIVES:
            record[BY_COORDINATE], record[BY_RATE] = derivatives(t, q, rate)
        else:
            record[POTENTIAL] = potential(q)

    return call


@overload
def compiled_law(force: Force) -> CompiledLaw: ...


@overload
def compiled_law(
    *, derivatives: Derivatives | None = None, potential: Potential | None = None
) -> Callable[[Force], CompiledLaw]: ...


def compiled_law(
    force: Force | None = None,
    *,
    derivatives: Derivatives | None = None,
    potential: Potential | None = None,
) -> CompiledLaw | Callable[[Force], CompiledLaw]:
    """Compile a force law by numba, so that time steps do not call the Python interpreter.

    Use it as a decorator, with or without arguments. A law that can be evaluated with complex
    numbers needs no derivatives.

    Args:
        force: Force as a function of time, coordinate and rate.
        derivatives: Its derivatives in coordinate and rate, a function of the same arguments.
        potential: Its potential as a function of the coordinate.

    Raises:
        TypeError: An argument is not a function, or numba cannot compile it.

    Example:
        >>> @fl.loads.compiled_law
        ... def duffing(t, q, rate):
        ...     return 10.0 * q + 40.0 * q**3 + 0.1 * rate
        >>> duffing(0.0, 0.5, 0.0)
        10.0
    """
    given = {"law": force, "derivatives": derivatives, "potential": potential}
    for name, function in given.items():
        if function is not None and not callable(function):
            raise TypeError(f"compiled_law: {name} must be a function, got {shown(function)}")

    def made(force: Force) -> CompiledLaw:
        return CompiledLaw(force, derivatives, potential)

    return made if force is None else made(force)


def checked(law: Law, label: str, start: float, scale: float) -> None:
    """Raise an error if a law does not give numbers, or contradicts its derivatives or potential.

    Args:
        law: The law.
        label: Name in messages.
        start: Coordinate at the start, where it is evaluated.
        scale: Size of small changes of the coordinate is relative to it.

    Raises:
        ForceLawError: The law cannot be evaluated.
        ValueError: A value is not finite, or the values contradict each other.
    """
    try:
        force, derivatives = law(0.0, start, 0.0), law.derivatives(0.0, start, 0.0)
    except ForceLawError as error:
        raise ForceLawError(f"{label}: {error}") from error.__cause__
    if not np.isfinite([force, *derivatives]).all():
        values = [force, *derivatives]
        raise ValueError(f"{label}: expected finite values of the law at the start, got {values}")
    if law.has_potential:
        _check_potential(law, label, start, scale)
    for k, name in enumerate(("q", "rate")):
        given, unit = derivatives[k], scale if k == 0 else 1.0
        far, near = (_mismatch(law, start, k, given, h * unit) for h in (1e-6, 1e-7))
        # the error of differences falls with their step, a wrong derivative stays
        if abs(near) > 0.5 * abs(far):
            raise ValueError(
                f"{label}: expected ∂F/∂{name} = {given + near:.6g} from differences of the law at "
                f"the start, got {given:g}. Complex numbers do not differentiate abs "
                f"and comparisons: {_GIVE}"
            )


def _mismatch(law: Law, start: float, k: int, derivative: float, h: float) -> float:
    """One-sided difference minus a derivative; zero if it is between both, but for round-off.

    ``k`` is 0 for the derivative in the coordinate, 1 for that in the rate.
    """
    step, force = np.eye(2)[k] * h, law(0.0, start, 0.0)
    ahead, behind = (law(0.0, start + s * step[0], s * step[1]) for s in (1.0, -1.0))
    slopes = sorted(((ahead - force) / h, (force - behind) / h))
    away = min(slopes[1] - derivative, 0.0) + max(slopes[0] - derivative, 0.0)
    allowed = 1e-4 * max(map(abs, (*slopes, derivative))) + 1e-8 * abs(force) / h
    return away if abs(away) > allowed else 0.0


def _check_potential(law: Law, label: str, start: float, scale: float) -> None:
    force, h = law(0.0, start, 0.0), 1e-5 * scale
    if any(law(t, start, rate) != force for t, rate in ((1.0, 0.0), (0.0, 1.0))):
        raise ValueError(
            f"{label}: a law with a potential must depend on the coordinate only, not on the time "
            "or the rate"
        )
    ends = [(law(0.0, q, 0.0), law.potential(q)) for q in (start - h, start + h)]
    slope = (ends[1][1] - ends[0][1]) / (2.0 * h)
    near = 1e-4 * max(abs(ends[0][0]), abs(ends[1][0])) + 1e-8 * abs(ends[0][1]) / h
    if not abs(slope - force) <= near + abs(ends[1][0] - ends[0][0]):
        raise ValueError(
            f"{label}: expected a potential whose derivative is the force {force:g} at the start, "
            f"got {slope:g}"
        )


def sampled(law: Law, start: float, scale: float) -> Array:
    """Values of a law near the start: by these, checkpoints recognise it.

    Args:
        law: The law.
        start: Coordinate at the start.
        scale: Size of the changes of the coordinate.
    """
    points = [
        (t, start + scale * x, y) for t in (0.0, 1.0) for x in (-0.1, 0.0, 0.1) for y in (0.0, 1.0)
    ]
    values = np.full(len(points), np.nan)
    for k, point in enumerate(points):
        try:
            values[k] = law(*point)
        except ForceLawError:
            continue  # outside of its domain
    return values


# --- laws of the package ---


class _Tabulated(Law):
    """Law with a potential whose callback reads data."""

    has_potential = True


class SpringTable(_Tabulated):
    """Spring from a table of forces: a monotone cubic between the points, straight lines outside.

    The curve goes through all points, has a continuous slope, and rises or falls only where the
    table does (Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238). It has a potential, so that
    conserving schemes take it.

    Example:
        >>> table = fl.loads.SpringTable((-1.0, 0.0, 1.0, 2.0), (-5.0, 0.0, 5.0, 30.0))
        >>> table(0.0, 1.0, 0.0)
        5.0
    """

    def __init__(self, coordinates: npt.ArrayLike, forces: npt.ArrayLike) -> None:
        """Interpolate the points.

        Args:
            coordinates: Increasing values of the coordinate, at least two.
            forces: Force at each of them.

        Raises:
            ValueError: The arrays have different lengths, or the coordinates do not increase.
        """
        q, f = (np.atleast_1d(np.asarray(a, dtype=np.float64)) for a in (coordinates, forces))
        if q.ndim != 1 or q.shape != f.shape or len(q) < 2:
            raise ValueError(
                f"SpringTable: expected as many forces as coordinates, at least two, got shapes "
                f"{q.shape} and {f.shape}"
            )
        if not (np.isfinite(q).all() and np.isfinite(f).all() and (np.diff(q) > 0.0).all()):
            raise ValueError(
                f"SpringTable: expected finite forces at increasing coordinates, got {q.tolist()} "
                f"and {f.tolist()}"
            )
        slopes = PchipInterpolator(q, f).derivative()(q)
        h = np.diff(q)
        work = h * (f[:-1] + f[1:]) / 2.0 + h**2 * (slopes[:-1] - slopes[1:]) / 12.0
        potentials = np.append(0.0, np.cumsum(work))
        potentials -= potentials.min()
        self.data = np.concatenate([[len(q)], q, f, slopes, potentials])

    @property
    def address(self) -> int:
        """Address of the callback."""
        return _table.address


class TensionOnly(_Tabulated):
    """Spring that only pulls: force ``k (q − q₀)`` where ``q > q₀``, zero otherwise.

    Along the length of a :class:`~fem_lie.joints.Distance` it is a slack cable.

    Example:
        >>> fl.loads.TensionOnly(100.0, rest=2.0)(0.0, 1.5, 0.0)
        0.0
    """

    _sign = 1.0

    def __init__(self, stiffness: float, rest: float) -> None:
        """Store the numbers.

        Args:
            stiffness: ``k``.
            rest: ``q₀``.

        Raises:
            ValueError: The stiffness is not positive, or a number is not finite.
        """
        name = type(self).__name__
        k = number(stiffness, f"{name}: stiffness")
        if not k > 0.0:
            raise ValueError(f"{name}: expected stiffness > 0, got {stiffness}")
        self.data = np.array([k, number(rest, f"{name}: rest"), self._sign])

    @property
    def address(self) -> int:
        """Address of the callback."""
        return _one_sided.address


class CompressionOnly(TensionOnly):
    """Spring that only pushes: force ``k (q − q₀)`` where ``q < q₀``, zero otherwise.

    Example:
        >>> fl.loads.CompressionOnly(100.0, rest=2.0)(0.0, 1.5, 0.0)
        -50.0
    """

    _sign = -1.0


@callback(SIGNATURE)
def _one_sided(address: Any, data: Any, order: int) -> None:
    out = vector_at(address, SIZE)
    k, elongation = data[0], out[COORDINATE] - data[1]
    if data[2] * elongation <= 0.0:
        k, elongation = 0.0, 0.0
    out[FORCE] = k * elongation
    out[BY_COORDINATE], out[BY_RATE] = k, 0.0
    out[POTENTIAL] = 0.5 * k * elongation**2


@uncounted
def _interpolate(out: Array, table: Array, n: int) -> None:
    """Set force, derivatives and potential of a table: coordinates, forces, slopes, potentials."""
    q, i = out[COORDINATE], 0
    out[BY_RATE] = 0.0
    outer = 0 if q < table[0] else n - 1
    if q < table[0] or q >= table[n - 1]:
        d, f, m = q - table[outer], table[n + outer], table[2 * n + outer]
        out[FORCE], out[BY_COORDINATE] = f + m * d, m
        out[POTENTIAL] = table[3 * n + outer] + d * (f + 0.5 * m * d)
        return
    last = n - 1
    while last - i > 1:
        middle = (i + last) // 2
        if q < table[middle]:
            last = middle
        else:
            i = middle
    h, f, m = table[i + 1] - table[i], table[n + i], table[2 * n + i]
    rise, end, s = (table[n + i + 1] - f) / h, table[2 * n + i + 1], q - table[i]
    b, c = (3.0 * rise - 2.0 * m - end) / h, (m + end - 2.0 * rise) / (h * h)
    out[FORCE] = f + s * (m + s * (b + s * c))
    out[BY_COORDINATE] = m + s * (2.0 * b + 3.0 * s * c)
    out[POTENTIAL] = table[3 * n + i] + s * (f + s * (m / 2.0 + s * (b / 3.0 + s * c / 4.0)))


@callback(SIGNATURE)
def _table(address: Any, data: Any, order: int) -> None:
    n = int(data[0])
    _interpolate(vector_at(address, SIZE), vector_at(data, 4 * n + 1)[1:], n)
