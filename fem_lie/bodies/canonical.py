"""Canonical bytes of bodies, joints and loads, equal in all processes: for fingerprints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.model import BodyModel

_OF_A_BODY = (
    "frames",
    "start_frames",
    "velocities",
    "masters",
    "elements",
    "connectivity",
    "lengths",
    "stiffness",
    "density",
    "mass_matrix",
    "damping",
    "axes",
    "formulation",
    "group",
    "held",
    "supports",
    "contents",
)
"""Attributes of a body, if it has them, on which the equations depend."""


class CanonicalBytes:
    """Bytes of values, objects and arrays that are equal in all processes.

    Functions have no bytes: their values are compared elsewhere.
    """

    def __init__(self, bodies: Iterable[Body]) -> None:
        """Bodies are represented by their numbers in this order."""
        self._number = {body.model: number for number, body in enumerate(bodies, start=1)}

    def of(self, value: Any) -> bytes:
        """Bytes of a value; numbers are exact."""
        if isinstance(value, np.ndarray):
            if value.size <= 6:
                return repr(value.tolist()).encode()
            return b"%r %r " % (value.shape, value.dtype.str) + value.tobytes()
        if isinstance(value, Body):
            return self.of(value.model)
        if isinstance(value, BodyModel):
            return b"body %d" % self._number[value]
        if isinstance(value, Point):
            if value.body is None:
                return b"ground" if value.place is None else b"ground" + self.of(value.place)
            where = (
                value.node
                if value.attachment is None
                else (value.attachment.nodes, value.attachment.data)
            )
            return self.of((value.body, where))
        if isinstance(value, Enum):
            return str(value).encode()
        if value is None or isinstance(value, bool | int | float | str | np.generic):
            return repr(value).encode()
        if isinstance(value, list | tuple | range):
            return b"(" + b", ".join(map(self.of, value)) + b")"
        if isinstance(value, dict):
            return self.of(list(value.items()))
        return self._of_object(value)

    def _of_object(self, value: Any) -> bytes:
        if isinstance(value, type):
            return value.__qualname__.encode()
        if callable(value):
            return b"function"
        return type(value).__qualname__.encode() + self.of(attributes(value))


def attributes(value: Any) -> list[tuple[str, Any]]:
    """Names and values of the fields of a record, or of all attributes of another object."""
    names = (
        [f.name for f in fields(value)]
        if is_dataclass(value)
        else sorted(getattr(value, "__dict__", ()))
    )
    return [(name, getattr(value, name)) for name in names]


def data_of_body(body: Body) -> list[tuple[str, Any]]:
    """Names and values of the data of a body on which the equations depend."""
    return data_of_model(body.model)


def data_of_model(model: BodyModel) -> list[tuple[str, Any]]:
    """Names and values of the data of a model on which the equations depend."""
    return [(name, getattr(model, name)) for name in _OF_A_BODY if hasattr(model, name)]
