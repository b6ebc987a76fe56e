"""Public names, whose modules are imported when a name is first used (PEP 562).

:mod:`fem_lie` and its namespaces import what they offer for type checkers only::

    if TYPE_CHECKING:
        from fem_lie.joints.joint import Joint
    else:
        __getattr__, __dir__ = public_names(__name__)

These imports, read from the source, are also what a name stands for at run time: each name is
written once. Public functions and classes explain calls with wrong arguments (:mod:`._arguments`)
from the moment they are imported.
"""

from __future__ import annotations

import ast
import importlib.util
import sys
from collections.abc import Callable
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from fem_lie._arguments import explain_class, explained_function
from fem_lie._renamed import MEANT, RENAMED

_NEAR = 0.75  # ratio of equal letters from which a name is meant

PACKAGE = __name__.partition(".")[0]


class Origin(NamedTuple):
    """Where a public name is defined.

    Attributes:
        module: Name of the module.
        name: Name in this module; ``None``: the module itself.
    """

    module: str
    name: str | None


@cache
def origins(namespace: str) -> dict[str, Origin]:
    """Origins of the public names of a namespace, read from its source.

    Args:
        namespace: Name of the module, ``fem_lie`` or a namespace in it.
    """
    spec = importlib.util.find_spec(namespace)
    assert spec is not None and spec.origin is not None
    with open(spec.origin, encoding="utf-8") as source:
        tree = ast.parse(source.read())
    found: dict[str, Origin] = {}
    for block in tree.body:
        for statement in getattr(block, "body", ()):
            if isinstance(statement, ast.ImportFrom) and statement.module is not None:
                for each in statement.names:
                    found[each.asname or each.name] = Origin(statement.module, each.name)
            elif isinstance(statement, ast.Import):
                for each in statement.names:
                    found[each.asname or each.name] = Origin(each.name, None)
    return found


@cache
def namespaces() -> dict[str, str]:
    """Names of all modules with public names, by what users write: ``fl``, ``fl.joints``."""
    inner = {
        f"fl.{name}": origin.module
        for name, origin in origins(PACKAGE).items()
        if origin.name is None
    }
    return {"fl": PACKAGE} | inner


def public_names(namespace: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """``__getattr__`` and ``__dir__`` of a namespace.

    Args:
        namespace: Name of the module, ``fem_lie`` or a namespace in it.
    """

    def load(name: str) -> Any:
        """Import a public name; errors for other names say where they are."""
        if name not in origins(namespace):
            raise unknown_name(namespace, name)
        return _loaded(namespace, name)

    def names() -> list[str]:
        """Public names, imported or not, and what every module has."""
        every = {name for name in vars(sys.modules[namespace]) if name.startswith("__")}
        return sorted(every | set(origins(namespace)))

    return load, names


def _loaded(namespace: str, name: str) -> Any:
    """Object of a public name, which its namespace has from now on."""
    origin = origins(namespace)[name]
    thing: Any = import_module(origin.module)
    if origin.name is not None:
        thing = explained_function(getattr(thing, origin.name), namespace)
    _explain_imported_classes()
    setattr(sys.modules[namespace], name, thing)
    return thing


@cache
def _unexplained() -> set[Origin]:
    """Origins of the public names that have not been imported so far."""
    return {
        origin
        for namespace in namespaces().values()
        for origin in origins(namespace).values()
        if origin.name is not None
    }


def _explain_imported_classes() -> None:
    """Let all public classes explain wrong arguments, also those that others import.

    A result, for example, is an object of a public class that a script need not name.
    """
    for origin in [*_unexplained()]:
        imported = vars(sys.modules.get(origin.module, object))
        if origin.name in imported:  # not so yet where its module is being imported
            _unexplained().discard(origin)
            if isinstance(thing := imported[origin.name], type):
                explain_class(thing)


def unknown_name(namespace: str, name: str) -> AttributeError:
    """The error for a name that a namespace does not have: it says where the name is.

    Args:
        namespace: Name of the module.
        name: The name.
    """
    message = f"{namespace} has no {name!r}"
    if name in RENAMED:
        message += f"; it is {RENAMED[name]} now (fl is fem_lie)"
    elif found := _similar(name):
        message += f"; expected {' or '.join(found)} (fl is fem_lie)"
    return AttributeError(message, name=name, obj=sys.modules[namespace])


def _similar(name: str) -> list[str]:
    """Where a name is, or what stands for it: as it is written, in other letters, or nearly so."""
    known: dict[str, list[str]] = {each: [meant] for each, meant in MEANT.items()}
    for each, module in namespaces().items():
        for there in origins(module):
            known.setdefault(there, []).append(f"{each}.{there}")
    if name in known:
        return known[name]
    letters: dict[str, list[str]] = {}
    for each, found in known.items():
        letters.setdefault(_letters(each), []).extend(found)
    nearest = get_close_matches(_letters(name), letters, n=1, cutoff=_NEAR)
    return list(dict.fromkeys(letters[nearest[0]])) if nearest else []


def _letters(name: str) -> str:
    return name.replace("_", "").lower()
