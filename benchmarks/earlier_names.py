"""Names of now for a package from before 91266dbc, so that scenes of now run with it, too."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np


def give_names(fl: ModuleType) -> None:
    """Add the names of :class:`fem_lie.extend.Body` that a package does not have yet.

    See ``CHANGELOG.md`` for the table of names.
    """
    if hasattr(fl.extend.Body, "point"):
        return
    extend = ModuleType("fem_lie.extend")
    extend.COLOURS = import_module("fem_lie.pictures.diagrams").COLOURS  # type: ignore[attr-defined]
    sys.modules["fem_lie.extend"] = extend
    fl.extend.Body.point = _point
    rigid = fl.extend.Body.add_velocity

    def add_velocity(
        body: Any, linear: Any = (0, 0, 0), omega: Any = (0, 0, 0), about: Any = None
    ) -> None:
        centre = (0, 0, 0) if about is None else getattr(about, "position", about)
        rigid(body, *(np.asarray(each, dtype=float) for each in (linear, omega, centre)))

    fl.extend.Body.add_velocity = add_velocity
    fl.extend.Body.set_group = fl.extend.Body.on
    fl.extend.Body.nodes = lambda body, where: body.nodes_of(where)
    for cls in (fl.Shell, fl.Solid, fl.ThinShell):
        cls.roller = cls.guide


def _point(body: Any, where: Any, tolerance: float | None = None, **options: Any) -> Any:
    """A point by its name, the number of its node, or its position."""
    if isinstance(where, int):
        return body.node(where)
    if isinstance(where, str):
        if options:
            return body.grip(where, *options.values())
        return getattr(body, where, None) or body[where]
    return body.nearest(where) if hasattr(body, "nearest") else body.at(where)
