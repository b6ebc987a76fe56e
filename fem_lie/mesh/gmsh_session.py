"""One session of gmsh: models that are open or in files, named groups and points in them."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from fem_lie._arrays import Indices

_log = logging.getLogger(__name__)

_ENTITIES = {
    1: ("curves", "surfaces and volumes"),
    2: ("surfaces", "volumes"),
    3: ("volumes", "bodies"),
}


@contextmanager
def opened(
    path: str | os.PathLike[str], parameters: Mapping[str, float] | None
) -> Iterator[tuple[Any, Path]]:
    """Gmsh with a file in a model of its own, which is removed afterwards; and the file."""
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"no mesh file {str(file)!r}")
    with session() as gmsh:
        if parameters:
            _check_parameters(gmsh, file, parameters)
        with model(gmsh):
            _merge(gmsh, file, parameters or {})
            yield gmsh, file


@contextmanager
def session() -> Iterator[Any]:
    """gmsh, started if it was not, silent, and left as it was."""
    import gmsh

    own = not gmsh.isInitialized()
    if own:
        # without its handler, gmsh leaves Ctrl-C to Python
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    terminal = gmsh.option.getNumber("General.Terminal")
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield gmsh
    finally:
        if own:
            gmsh.finalize()
        else:
            gmsh.option.setNumber("General.Terminal", terminal)


@contextmanager
def model(gmsh: Any) -> Iterator[None]:
    """A model of its own; the user's parameters and current model come back afterwards."""
    current, onelab = gmsh.model.getCurrent(), gmsh.onelab.get()
    gmsh.onelab.clear()
    gmsh.model.add("fem_lie")
    try:
        yield
    finally:
        gmsh.model.remove()
        gmsh.parser.clear()
        gmsh.onelab.clear()
        gmsh.onelab.set(onelab)
        if current:
            gmsh.model.setCurrent(current)


def _merge(gmsh: Any, file: Path, parameters: Mapping[str, float]) -> None:
    gmsh.parser.clear()
    for name, value in parameters.items():
        gmsh.parser.setNumber(name, [float(value)])
    # "open" would forget the numbers
    logged(gmsh, file, lambda: gmsh.merge(str(file)))


def logged(gmsh: Any, file: Path, call: Any) -> None:
    """Turn what gmsh only logs as an error into an exception."""
    gmsh.logger.start()
    try:
        call()
        errors = [line for line in gmsh.logger.get() if line.startswith("Error")]
    except Exception as error:
        # gmsh raises nothing more special
        errors = [str(error)]
    finally:
        gmsh.logger.stop()
    if errors:
        raise ValueError(f"gmsh cannot read {str(file)!r}: " + "; ".join(errors))


def _check_parameters(gmsh: Any, file: Path, parameters: Mapping[str, float]) -> None:
    with model(gmsh):
        _merge(gmsh, file, {})
        known = set(gmsh.parser.getNames())
    for name in parameters:
        if name not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise ValueError(f"{str(file)!r} has no parameter {name!r}; it has: {listed}")
    with model(gmsh):
        _merge(gmsh, file, parameters)
        for name, value in parameters.items():
            if gmsh.parser.getNumber(name)[0] != float(value):
                raise ValueError(
                    f"{str(file)!r} sets {name!r} itself; let it stand in DefineConstant[...]"
                )


def physical(gmsh: Any, dim: int) -> dict[str, list[int]]:
    """Entities of each physical group; a group without a name is called by its number."""
    return {
        gmsh.model.getPhysicalName(dim, tag) or str(tag): list(
            gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
        )
        for _, tag in gmsh.model.getPhysicalGroups(dim)
    }


def chosen_entities(gmsh: Any, dim: int, what: str) -> list[int]:
    """Entities in physical groups, or all if there are none; what is left out goes to the log.

    Raises:
        ValueError: There is no physical group of them, and they are borders of something else.
    """
    every = {tag for _, tag in gmsh.model.getEntities(dim)}
    grouped = {tag for entities in physical(gmsh, dim).values() for tag in entities}
    above = sum(len(gmsh.model.getEntities(d)) for d in range(dim + 1, 4))
    mine, others = _ENTITIES[dim]
    if above and not grouped:
        raise ValueError(
            f"{what} has {above} {others} and no physical group of {mine}: which of their edges or "
            f"faces are meant? Put those {mine} into a physical group"
        )
    left = every - grouped if grouped else set()
    if above or left:
        _log.info(
            "%s: the %d %s of physical groups are taken; %d other %s and %d %s are left out",
            *(what, len(grouped), mine, len(left), mine, above, others),
        )
    return sorted(grouped or every)


def named_points(gmsh: Any, used: Indices) -> dict[str, Indices]:
    """Points with cells in each physical group of points."""
    named = {}
    for name, entities in physical(gmsh, 0).items():
        tags = np.concatenate([gmsh.model.mesh.getNodes(0, tag)[0] for tag in entities])
        named[name] = np.flatnonzero(np.isin(used, tags))
    return {name: points for name, points in named.items() if len(points)}
