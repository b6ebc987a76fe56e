"""Errors for arguments that do not exist: they name the one that is meant, and those there are."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import wraps
from types import FunctionType
from typing import Any, Protocol, runtime_checkable

MEANT = {
    "dt": ("step",),
    "h": ("step",),
    "time_step": ("step",),
    "t_end": ("duration",),
    "end_time": ("duration",),
    "time": ("duration", "history"),
    "times": ("at", "states", "save_at"),
    "output_every": ("save_every",),
    "save": ("save_every", "save_at"),
    "filename": ("path", "file"),
    "rho_inf": ("radius",),
    "spectral_radius": ("radius",),
    "rho": ("radius", "density"),
    "young": ("E",),
    "poisson": ("nu",),
    "elements": ("cells",),
    "n": ("cells", "count", "modes"),
    "nev": ("count",),
    "modes": ("count",),
    "n_modes": ("count",),
    "num_modes": ("count",),
    "prestress": ("at",),
    "steps": ("load_steps", "step", "resolution"),
    "increments": ("load_steps",),
    "arc_length": ("resolution",),
    "max_load": ("until",),
    "f": ("force",),
    "value": ("force", "pressure"),
    "m": ("mass", "moment"),
    "torque": ("moment",),
    "function": ("history",),
    "amplitude": ("history",),
    "follower": ("following",),
    "scale": ("magnified",),
    "color": ("colours",),
    "colors": ("colours",),
    "fps": ("seconds",),
    "k": ("stiffness",),
    "d": ("damping",),
    "alpha": ("mass", "radius"),
    "beta": ("stiffness", "radius"),
    "gamma": ("radius",),
    "length": ("rest",),
    "rest_length": ("rest",),
    "mu": ("friction", "coefficient"),
    "e": ("restitution",),
    "r": ("radius",),
    "g": ("gravity",),
    "i": ("inertia",),
    "com": ("position",),
    "origin": ("position",),
    "center": ("position", "point"),
    "at": ("point", "position"),
    "normal": ("axis", "up"),
    "location": ("at",),
    "anchor": ("at",),
    "material": ("section",),
    "thickness": ("section",),
    "diameter": ("radius",),
    "orientation": ("up", "rotation"),
    "direction": ("axis", "normal", "along"),
    "axis": ("along", "normal"),
    "angle": ("function", "motion", "history"),
    "tol": ("tolerance",),
    "maxiter": ("max_iterations",),
}
"""Arguments of other codes, in lower case, and what they are called here."""

CONVERTED = {
    ("diameter", "radius"): "half the diameter",
    ("axis", "along"): "the vector from the middle to an end",
    ("alpha", "radius"): "(1 - α) / (1 + α)",
    ("beta", "radius"): "β and γ follow from it",
    ("gamma", "radius"): "β and γ follow from it",
    ("steps", "resolution"): "one over the number of steps",
    ("arc_length", "resolution"): "the largest step over the ranges of load and displacement",
    ("fps", "seconds"): "how long the page plays",
}
"""Arguments whose values differ from those of the argument that is meant, and by what."""

_HELD = "fl.joints.InPlane(fl.ground(), point, axis=…) holds one displacement"
_ADAPTIVE = "for steps of variable size pass step=fl.schemes.AdaptiveStep(tolerance)"
_START = "to start from another state use fl.adaptivity.transfer(result, its_scene, scene)"

ELSEWHERE = {
    "velocity": "use its method add_velocity()",
    "omega": "use its method add_velocity(omega=…)",
    "dt": "the time step is the argument step= of run()",
    "step": "the time step is the argument step= of run()",
    "adaptive": _ADAPTIVE,
    "rtol": _ADAPTIVE,
    "atol": _ADAPTIVE,
    "initial": _START,
    "initial_state": _START,
    "nonlinear": "rotations and displacements are finite in every solver",
    "gravity": "gravity is that of the scene: Scene(gravity=…)",
    "loads": "add loads to the scene: scene.add(load)",
    "supports": "add supports to the scene: scene.add(Clamp(point))",
    "limits": "add fl.joints.Limit(coordinate, lower, upper) to the scene",
    "friction": "it belongs to a contact law, or to fl.joints.JointFriction(joint, …)",
    "Clamp.dofs": _HELD,
    "Clamp.components": _HELD,
    "Damping.ratio": "mass=2 ζ ω or stiffness=2 ζ / ω, for a ratio ζ at the angular frequency ω",
    "PointLoad.frame": "following=True takes components along the axes of the point",
    "ShellSection.material": "use fl.ShellSection.layer(thickness, material)",
}
"""What is no argument of a constructor or function, of any or of the one named before the dot, and
where it is given."""


@runtime_checkable
class _Compiled(Protocol):
    """A compiled function, which explains calls from Python with wrong arguments itself."""

    def explain_calls(self, explanation: Callable[..., TypeError]) -> None:
        """Let it explain calls from now on."""


def explained_function(thing: Any, namespace: str) -> Any:
    """A public function that explains calls with wrong arguments; anything else as it is.

    A Python function stays as it is inside the package, which calls it without a check.

    Args:
        thing: The function, or another object of a public name.
        namespace: Name of the module that offers it.
    """
    if isinstance(thing, FunctionType):
        explained = _explained(thing)
        explained.__module__ = namespace  # where pickle finds it
        return explained
    if isinstance(thing, _Compiled):
        thing.explain_calls(explanation)
    return thing


_explained_classes: set[type] = set()


def explain_class(cls: type) -> None:
    """Let the constructors and public methods of a class explain calls with wrong arguments.

    Args:
        cls: The class; its base classes in the package are explained as well.
    """
    for each in cls.__mro__:
        if each.__module__.startswith("fem_lie.") and each not in _explained_classes:
            _explained_classes.add(each)
            for name, method in [*_explained_methods(each)]:
                setattr(each, name, method)


def _explained_methods(cls: type) -> Iterator[tuple[str, Any]]:
    """Constructor and public methods that a class defines, as :func:`_explained`."""
    fields = getattr(cls, "__dataclass_fields__", {})  # their defaults may be functions
    for name, method in vars(cls).items():
        hidden = name.startswith("_") and name not in ("__init__", "__new__", "__call__")
        if hidden or name in fields:
            continue
        if isinstance(method, classmethod):
            yield name, classmethod(_explained(method.__func__, bound=True))
        elif isinstance(method, staticmethod):
            if isinstance(method.__func__, FunctionType):
                yield name, staticmethod(_explained(method.__func__, bound=name == "__new__"))
        elif isinstance(method, FunctionType):
            yield name, _explained(method, bound=True)


def _explained(function: Callable[..., Any], *, bound: bool = False) -> Any:
    """A function that explains calls with wrong arguments.

    Args:
        function: The function.
        bound: The first argument is an object or its class.
    """

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except TypeError:
            if _takes(function, args, kwargs):
                raise  # an error of the function, not of the call
            if bound:
                raise explanation(_name(function, args[0]), function, args, kwargs, 1) from None
            raise explanation(function.__name__, function, args, kwargs) from None

    return call


def _takes(function: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]) -> bool:
    """Whether a function, below its decorators, has all parameters that a call passes."""
    try:
        inspect.signature(function).bind(*args, **kwargs)
    except TypeError:
        return False
    return True


def _name(function: Callable[..., Any], owner: Any) -> str:
    """Name of a method or constructor, for messages."""
    cls = owner if isinstance(owner, type) else type(owner)
    constructor = function.__name__ in ("__init__", "__new__")
    return cls.__name__ if constructor else f"{cls.__name__}.{function.__name__}"


def explanation(
    what: str,
    function: Callable[..., Any],
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    bound: int = 0,
) -> TypeError:
    """The error for a call with wrong arguments.

    Args:
        what: Name of the function or class.
        function: The function.
        args: Values that the call passed by position.
        kwargs: Values that the call passed by name.
        bound: Number of arguments that the caller did not pass, such as ``self``.
    """
    parameters = [*inspect.signature(function).parameters.values()][bound:]
    named = [p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    first = [p.name for p in named if p.kind is p.POSITIONAL_OR_KEYWORD]
    known = [p.name for p in named]
    shown = _listed(f"*{p.name}" if p.kind is p.VAR_POSITIONAL else p.name for p in parameters)
    passed = args[bound:]
    for name in kwargs:
        if name not in known:
            hint = _hint(what, name, known)
            return TypeError(f"{what} has no argument {name!r}{hint} (it has {shown})")
    if len(passed) > len(first):
        rest = ", ".join(f"{p.name}=" for p in named if p.kind is p.KEYWORD_ONLY)
        return TypeError(
            f"{what} takes {', '.join(first) or 'nothing'} by position, "
            f"and by name {rest or 'nothing'}; got {len(passed) - len(first)} more values"
        )
    given = {*first[: len(passed)], *kwargs}
    missing = [p.name for p in named if p.default is p.empty and p.name not in given]
    if missing:
        return TypeError(f"{what}: expected {_listed(missing)} as well (it has {shown})")
    twice = [name for name in first[: len(passed)] if name in kwargs]
    return TypeError(f"{what}: got {_listed(twice)} twice, by position and by name")


def _hint(what: str, given: str, known: Sequence[str]) -> str:
    """The argument that is probably meant by another name, or where its value is given."""
    lower = given.lower()
    meant = [name for name in MEANT.get(lower, ()) if name in known]
    elsewhere = ELSEWHERE.get(f"{what}.{lower}", ELSEWHERE.get(lower, ""))
    if not meant and not elsewhere:
        meant = get_close_matches(given, known, n=1, cutoff=0.7)
    if meant:
        return f"; expected {' or '.join(_with_unit(lower, name) for name in meant)}"
    return f"; {elsewhere}" if elsewhere else ""


def _with_unit(given: str, meant: str) -> str:
    """The argument that is meant, and how its value follows from the given one."""
    conversion = CONVERTED.get((given, meant), "")
    return f"{meant}={conversion and f' ({conversion})'}"


def _listed(names: Iterable[str]) -> str:
    return ", ".join(names) or "none"
