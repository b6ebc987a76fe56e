"""Errors for arguments that do not exist: they name the one that is meant, and those there are."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import cache, wraps
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])

MEANT = {
    "dt": ("step",),
    "h": ("step",),
    "time_step": ("step",),
    "t_end": ("duration",),
    "end_time": ("duration",),
    "time": ("duration", "history"),
    "rho_inf": ("radius",),
    "rho": ("radius", "density"),
    "young": ("E",),
    "poisson": ("nu",),
    "elements": ("cells",),
    "n": ("cells", "count", "modes"),
    "steps": ("load_steps", "step"),
    "f": ("force",),
    "value": ("force", "pressure"),
    "torque": ("moment",),
    "function": ("history",),
    "amplitude": ("history",),
    "follower": ("following",),
    "k": ("stiffness",),
    "d": ("damping",),
    "mu": ("friction",),
    "r": ("radius",),
    "g": ("gravity",),
    "material": ("section",),
    "thickness": ("section",),
    "diameter": ("radius",),
    "direction": ("axis", "normal"),
    "angle": ("function", "motion", "history"),
    "tol": ("tolerance",),
    "maxiter": ("max_iterations",),
}
"""Arguments of other codes, in lower case, and what they are called here."""


ELSEWHERE = {
    "velocity": "use its method add_velocity()",
    "omega": "use its method add_velocity(omega=…)",
    "dt": "the time step is the argument step= of run()",
    "step": "the time step is the argument step= of run()",
    "gravity": "gravity is that of the scene: Scene(gravity=…)",
    "loads": "add loads to the scene: scene.add(load)",
    "supports": "add supports to the scene: scene.add(Clamp(point))",
}
"""What is no argument of the constructor or function that is called, and where it is given."""


def unknown_argument(what: str, given: str, known: Iterable[str]) -> TypeError:
    """The error for a keyword argument that does not exist.

    Args:
        what: Name of the function or class.
        given: Name of the argument.
        known: Names of the arguments that exist.
    """
    names = list(known)
    meant = [name for name in MEANT.get(given.lower(), ()) if name in names]
    meant = meant or get_close_matches(given, names, n=1, cutoff=0.7)
    hint = f"expected {' or '.join(meant)}=" if meant else ELSEWHERE.get(given.lower(), "")
    have = ", ".join(names) or "none"
    return TypeError(f"{what} has no argument {given!r}{hint and f'; {hint}'} (it has {have})")


@cache
def _arguments(function: Callable[..., Any]) -> tuple[tuple[str, ...], bool]:
    """Names of the arguments of a function without ``self``, and whether it takes any others."""
    found = inspect.signature(function).parameters.values()
    names = tuple(p.name for p in found if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY))
    return names[names[:1] in (("self",), ("cls",)) :], any(p.kind is p.VAR_KEYWORD for p in found)


def check_arguments(what: str, function: Callable[..., Any], given: Iterable[str]) -> None:
    """Raise ``TypeError`` if a function lacks one of the given keyword arguments.

    Args:
        what: Name in the message.
        function: The function.
        given: Names of the keyword arguments of a call.

    Raises:
        TypeError: An argument does not exist; the message names the one that is probably meant.
    """
    names, any_others = _arguments(function)
    for name in given:
        if name not in names and not any_others:
            raise unknown_argument(what, name, names)


class Explained:
    """Base of classes whose constructor names the argument that a caller probably means."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Any:
        """Check the names of keyword arguments before ``__init__`` sees them."""
        if kwargs:
            check_arguments(cls.__name__, cls.__init__, kwargs)
        return super().__new__(cls)


# a class without a constructor has no arguments, whatever ``__new__`` takes
cast(Any, Explained.__new__).__signature__ = inspect.Signature(
    [inspect.Parameter("cls", inspect.Parameter.POSITIONAL_ONLY)]
)


def explained(function: Function) -> Function:
    """A function whose error for an unknown argument names the one that is probably meant."""
    parameters = inspect.signature(function).parameters.values()
    positional = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    by_name = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY]

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        check_arguments(function.__qualname__, function, kwargs)
        if len(args) > len(positional):
            first = ", ".join(name for name in positional if name not in ("self", "cls"))
            raise TypeError(
                f"{function.__qualname__} takes {first} by position, "
                f"and by name {', '.join(f'{name}=' for name in by_name) or 'nothing'}; "
                f"got {len(args) - len(positional)} more values"
            )
        return function(*args, **kwargs)

    return cast(Function, call)
