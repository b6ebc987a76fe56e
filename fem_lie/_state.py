"""State of a run by the names of its attributes: copying, restoring and writing.

A class names in ``STATE`` the attributes that determine the next steps; those of its base classes
are included. An attribute is an array, a number, a record, a tuple or list of arrays, or an object
with a state of its own, whose names follow after a dot; ``None`` has no state.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, ClassVar, Protocol, cast

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.records import Fields, fields_of


class HasState(Protocol):
    """An object whose state can be saved and restored."""

    def saved_state(self) -> dict[str, Array]:
        """State that determines the next steps, as arrays by name."""

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`."""


def attributes(*names: str) -> tuple[str, ...]:
    """Names for ``STATE``, typed so that subclasses may have any number of them.

    Args:
        names: Names of attributes.
    """
    return names


class Stateful:
    """An object whose state is the attributes named in ``STATE``."""

    STATE: ClassVar[tuple[str, ...]] = ()
    _of_all: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Collect the names of base classes, which come first."""
        super().__init_subclass__()
        bases = reversed(cls.__mro__)
        cls._of_all = tuple(name for base in bases for name in vars(base).get("STATE", ()))

    def saved_state(self) -> dict[str, Array]:
        """State that determines the next steps, as arrays by name."""
        return saved(self, self._of_all)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`.

        Args:
            kept: State that was copied before.
        """
        put_back(self, self._of_all, kept)


def saved(owner: object, names: Iterable[str]) -> dict[str, Array]:
    """Copies of attributes by name; ``s.H`` is an attribute of an attribute."""
    found: dict[str, Array] = {}
    for name in names:
        _add(found, name, getattr(*_holder(owner, name)))
    return found


class ChangingArrays:
    """Arrays and records that make up a state which is copied in every step.

    Copying these is faster than :func:`saved`; the arrays must stay the same objects.
    """

    def __init__(self, owner: object, names: Iterable[str]) -> None:
        """Find them by the names that :func:`saved` uses; a record is one array."""
        self._arrays = _arrays_of(owner, names)

    def saved_state(self) -> dict[str, Array]:
        """Copies by name."""
        return {name: array.copy() for name, array in self._arrays.items()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`."""
        for name, array in self._arrays.items():
            array[...] = kept[name]


def _arrays_of(owner: object, names: Iterable[str]) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for name in names:
        value = getattr(*_holder(owner, name))
        if isinstance(value, Stateful):
            own = _arrays_of(value, value._of_all)
            found |= {f"{name}.{part}": array for part, array in own.items()}
        elif isinstance(value, tuple | list):
            found |= {f"{name}.{part}": _block(array) for part, array in _items(value)}
        else:
            found[name] = _block(value)
    return found


def _block(value: Any) -> Array:
    """An array, or the memory of a record, all fields at once, in words of eight bytes."""
    return np.frombuffer(cast(Any, value), np.int64) if isinstance(value, Fields) else value


def put_back(owner: object, names: Iterable[str], kept: Mapping[str, Array]) -> None:
    """Restore attributes from :func:`saved`; arrays of equal shape are overwritten in place."""
    for name in names:
        holder, last = _holder(owner, name)
        value = getattr(holder, last)
        if not _in_place(name, value, kept):
            given = kept[name]
            setattr(
                holder, last, given.copy() if isinstance(value, np.ndarray) else type(value)(given)
            )


def _holder(owner: object, name: str) -> tuple[object, str]:
    if "." not in name:
        return owner, name
    path, last = name.rsplit(".", 1)
    for part in path.split("."):
        owner = getattr(owner, part)
    return owner, last


def _add(found: dict[str, Array], name: str, value: Any) -> None:
    if isinstance(value, Fields):
        found |= {f"{name}.{part}": array.copy() for part, array in fields_of(value).items()}
    elif isinstance(value, np.ndarray):
        found[name] = value.copy()
    elif isinstance(value, tuple | list):
        for part, item in _items(value):
            _add(found, f"{name}.{part}", item)
    elif isinstance(value, bool | int | float):
        found[name] = np.array(value)
    elif value is not None:
        found |= {f"{name}.{part}": array for part, array in value.saved_state().items()}


def _in_place(name: str, value: Any, kept: Mapping[str, Array]) -> bool:
    """Restore a value in place, if possible; return whether it was."""
    if isinstance(value, Fields):
        return all(
            [_in_place(f"{name}.{part}", own, kept) for part, own in fields_of(value).items()]
        )
    if isinstance(value, np.ndarray):
        if value.shape != kept[name].shape:
            return False
        value[...] = kept[name]
        return True
    if value is None:
        return True
    if isinstance(value, tuple | list):
        return all([_in_place(f"{name}.{part}", item, kept) for part, item in _items(value)])
    if isinstance(value, bool | int | float):
        return False
    value.restore(part_of(kept, name))
    return True


def _items(values: tuple[Any, ...] | list[Any]) -> Iterator[tuple[str, Any]]:
    """Items by name of the fields of a record, or by number."""
    names = getattr(values, "_fields", range(len(values)))
    return ((str(name), value) for name, value in zip(names, values, strict=True))


def part_of(kept: Mapping[str, Array], name: str) -> dict[str, Array]:
    """State of the attribute of this name, by names of its own."""
    front = f"{name}."
    return {n.removeprefix(front): array for n, array in kept.items() if n.startswith(front)}
