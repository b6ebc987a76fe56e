"""Geometry that tests draw by gmsh itself."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def empty_model() -> Iterator[Any]:
    """gmsh with an empty model, silent, which ends afterwards."""
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        gmsh.model.add("drawn")
        yield gmsh
    finally:
        gmsh.finalize()
