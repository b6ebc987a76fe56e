"""Sessions of gmsh: models that are open or in files, named groups and points.

gmsh treats a file that it does not recognise as a script, and a script can run any command of the
system. Therefore the first bytes determine the type of a file here, and gmsh never has to guess.
"""

from __future__ import annotations

import logging
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
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
_MESH = b"$MeshFormat"
_CAD = {
    "step": re.compile(rb"\s*ISO-10303-21"),
    "brep": re.compile(rb"\s*(DBRep_DrawableShape|CASCADE Topology)"),
    "iges": re.compile(rb"[^\r\n]{72}S *0*1\s"),
}
"""First bytes of CAD files, by gmsh's name of their format."""
_BEGINNING = 100  # bytes, beyond the first line of an IGES file


@dataclass(frozen=True)
class GmshScript:
    """Script of gmsh (``.geo``), which the function that reads it runs.

    Attributes:
        path: Script file.
        parameters: Numbers that replace those of ``DefineConstant`` in the script.
    """

    path: Path
    parameters: Mapping[str, float] = field(default_factory=dict)


def run_gmsh_script(
    path: str | os.PathLike[str], parameters: Mapping[str, float] | None = None
) -> GmshScript:
    """Model of a gmsh script (``.geo``), for a function that reads a model.

    ``fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script("frame.geo", {"cells": 4}))`` runs the script
    and meshes its curves. A script can run any command of the system: run only those that you
    trust.

    Args:
        path: Script file.
        parameters: Numbers that replace those of ``DefineConstant`` in the script.

    Raises:
        FileNotFoundError: There is no such file.
    """
    return GmshScript(_existing(path), dict(parameters or {}))


@contextmanager
def opened(source: str | os.PathLike[str] | GmshScript) -> Iterator[tuple[Any, Path]]:
    """Session of gmsh with a file in a temporary model, and the path of the file.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither a gmsh mesh nor CAD, gmsh cannot read it, or a script has no
            such parameter.
    """
    if isinstance(source, GmshScript):
        with session() as gmsh:
            _check_parameters(gmsh, source)
            with model(gmsh):
                _run(gmsh, source)
                yield gmsh, source.path
    else:
        file = _existing(source)
        form = _format(file)
        with session() as gmsh, model(gmsh):
            _read(gmsh, file, form)
            yield gmsh, file


def _existing(path: str | os.PathLike[str]) -> Path:
    if not (file := Path(path)).is_file():
        raise FileNotFoundError(f"no mesh file {str(file)!r}")
    return file


def _format(file: Path) -> str:
    """File format by the first bytes: ``msh``, or gmsh's name of a CAD format."""
    with file.open("rb") as opened_file:
        beginning = opened_file.read(_BEGINNING)
    if beginning.startswith(_MESH):
        return "msh"
    for name, pattern in _CAD.items():
        if pattern.match(beginning):
            return name
    raise ValueError(
        f"{str(file)!r} is neither a mesh of gmsh, which begins with {_MESH.decode()}, nor STEP, "
        f"IGES or BREP: it begins with {beginning[:20]!r}. If it is a script of gmsh (.geo) that "
        "you trust, for it can run any command, pass fl.mesh.run_gmsh_script(path) instead of the "
        "path"
    )


def _read(gmsh: Any, file: Path, form: str) -> None:
    """Read a mesh or CAD, never a script."""
    if form != "msh":
        shapes = gmsh.model.occ.importShapes
        logged(gmsh, file, lambda: shapes(str(file), highestDimOnly=False, format=form))
        gmsh.model.occ.synchronize()
        return
    # gmsh would look at the ending of the file's own name, and run a script "NAME.opt" beside it
    with tempfile.TemporaryDirectory() as folder:
        alias = Path(folder) / "mesh.msh"
        alias.symlink_to(file.resolve())
        logged(gmsh, file, lambda: gmsh.merge(str(alias)))


@contextmanager
def session() -> Iterator[Any]:
    """Session of gmsh without output, started if necessary; its state is restored."""
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
    """Temporary model; the user's parameters and current model are restored."""
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


def _run(gmsh: Any, script: GmshScript) -> None:
    gmsh.parser.clear()
    for name, value in script.parameters.items():
        gmsh.parser.setNumber(name, [float(value)])
    # "open" would discard the numbers
    logged(gmsh, script.path, lambda: gmsh.merge(str(script.path)))


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


def _check_parameters(gmsh: Any, script: GmshScript) -> None:
    file, parameters = script.path, script.parameters
    if not parameters:
        return
    with model(gmsh):
        _run(gmsh, GmshScript(file))
        known = set(gmsh.parser.getNames())
    for name in parameters:
        if name not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise ValueError(f"{str(file)!r} has no parameter {name!r}; it has: {listed}")
    with model(gmsh):
        _run(gmsh, script)
        for name, value in parameters.items():
            if gmsh.parser.getNumber(name)[0] != float(value):
                raise ValueError(
                    f"{str(file)!r} sets {name!r} itself; define it by DefineConstant[...]"
                )


def physical(gmsh: Any, dim: int) -> dict[str, list[int]]:
    """Entities of each physical group; a group without a name has its number as name."""
    return {
        gmsh.model.getPhysicalName(dim, tag) or str(tag): list(
            gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
        )
        for _, tag in gmsh.model.getPhysicalGroups(dim)
    }


def chosen_entities(gmsh: Any, dim: int, what: str) -> list[int]:
    """Entities in physical groups, or all if there are none; ignored entities are logged.

    Without groups, boundaries of entities of higher dimension do not count.

    Raises:
        ValueError: They have no physical group, and all are boundaries of other entities.
    """
    every = {tag for _, tag in gmsh.model.getEntities(dim)}
    grouped = {tag for entities in physical(gmsh, dim).values() for tag in entities}
    above = sum(len(gmsh.model.getEntities(d)) for d in range(dim + 1, 4))
    mine, others = _ENTITIES[dim]
    which = "of physical groups"
    if above and not grouped:
        grouped, which = _no_boundaries(gmsh, dim, every), "that bound none of higher dimension"
    if above and not grouped:
        raise ValueError(
            f"{what} has {above} {others} and no physical group of {mine}: which of their edges or "
            f"faces are meant? Put those {mine} into a physical group"
        )
    left = every - grouped if grouped else set()
    if above or left:
        _log.info(
            "%s: the %d %s %s are taken; %d other %s and %d %s are left out",
            *(what, len(grouped), mine, which, len(left), mine, above, others),
        )
    return sorted(grouped or every)


def _no_boundaries(gmsh: Any, dim: int, every: set[int]) -> set[int]:
    """Entities that bound no other, by topology and by the nodes of elements.

    Files of older formats have no topology, CAD that is not meshed yet no elements above.
    """
    above = [gmsh.model.mesh.getElements(d)[2] for d in range(dim + 1, 4)]
    used = np.concatenate([np.empty(0), *(nodes for each in above for nodes in each)])
    found = {tag: gmsh.model.mesh.getElements(dim, tag)[2] for tag in every}
    return {
        tag
        for tag, kinds in found.items()
        if not len(gmsh.model.getAdjacencies(dim, tag)[0])
        and any(not np.isin(nodes, used).all() for nodes in kinds)
    }


def named_points(gmsh: Any, used: Indices) -> dict[str, Indices]:
    """Points with cells in each physical group of points."""
    named = {}
    for name, entities in physical(gmsh, 0).items():
        tags = np.concatenate([gmsh.model.mesh.getNodes(0, tag)[0] for tag in entities])
        named[name] = np.flatnonzero(np.isin(used, tags))
    return {name: points for name, points in named.items() if len(points)}
