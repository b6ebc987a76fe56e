"""All differences between versions: DOLFINx 0.9 is the target, the tests also pass with 0.11.

If a branch is only for 0.9 (or 0.10), a comment says with which version it can go.
"""

from __future__ import annotations

import gc
import inspect
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import cffi
import dolfinx
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.fem import IntegralType, petsc
from dolfinx.fem.forms import form_cpp_class
from dolfinx.mesh import GhostMode
from ffcx.ir.analysis.valuenumbering import ValueNumberer
from ufl.core.expr import Expr

from fem_lie._form_structure import Structure

VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])
# 0.9 has no option for more than two cells at a facet: a branching mesh is cut there in parallel.
# Always true when 0.9 goes.
BRANCHING_IN_PARALLEL = VERSION >= (0, 10)


def custom_form(
    spaces: Sequence[fem.FunctionSpace],
    kernel: int,
    kind: IntegralType,
    entities: npt.NDArray[np.int32],
    coefficients: Sequence[fem.Function],
    constants: Sequence[fem.Constant],
    mesh: dolfinx.mesh.Mesh,
) -> fem.Form:
    """A DOLFINx form over ``entities`` whose cell tensor the function at ``kernel`` computes."""
    active = np.arange(len(coefficients), dtype=np.int8)
    arguments: list[Any] = [
        [V._cpp_object for V in spaces],
        # 0 is the integral's number: 0.11 counts from 0, 0.9 takes any
        {kind: [(0, kernel, entities, active)]},
        [f._cpp_object for f in coefficients],
        [c._cpp_object for c in constants],
        False,
        [] if VERSION >= (0, 10) else {},  # maps to other meshes; always a list when 0.9 goes
        mesh._cpp_object,
    ]
    return fem.Form(form_cpp_class(np.float64)(*arguments))


def form_with_library(
    form: ufl.Form, of_form: Structure, ufcx_form: Any, module: Any, code: Any
) -> fem.Form:
    """A form over whole meshes whose library FFCx has compiled and Python has loaded before.

    Args:
        form: The form; its integrals have no subdomain data.
        of_form: Its functions.
        ufcx_form: FFCx's form in the library.
        module: The library.
        code: Its source.
    """
    address = int(module.ffi.cast("uintptr_t", module.ffi.addressof(ufcx_form)))
    given = coefficients_of(ufcx_form, of_form.coefficients)
    arguments: list[Any] = [
        [address] if VERSION >= (0, 10) else address,  # always a list when 0.9 goes
        [each.ufl_function_space()._cpp_object for each in of_form.arguments],
        [each._cpp_object for each in given],
        [each._cpp_object for each in of_form.constants],
        {getattr(IntegralType, each.integral_type()): [] for each in form.integrals()},
        [] if VERSION >= (0, 10) else {},  # maps to other meshes; always a list when 0.9 goes
        form.integrals()[0].ufl_domain().ufl_cargo(),
    ]
    return fem.Form(form_cpp_class(np.float64)(*arguments), ufcx_form, code, module)


def coefficients_of(made: Any, given: Sequence[Any]) -> list[Any]:
    """Which of the given functions FFCx's form or expression reads, in its order."""
    return [given[made.original_coefficient_positions[i]] for i in range(made.num_coefficients)]


def expression_template(made: fem.Expression) -> fem.Expression:
    """A compiled expression without its functions and its mesh, for :func:`expression_from`."""
    found = copy(made)
    found._cpp_object = found._ufl_expression = None
    return found


def expression_from(
    made: fem.Expression,
    value: Expr,
    coefficients: Sequence[fem.Function],
    constants: Sequence[fem.Constant],
) -> fem.Expression:
    """A compiled expression without arguments, of these functions and constants.

    Args:
        made: See :func:`expression_template`.
        value: The expression.
        coefficients: Functions in the order of FFCx's expression.
        constants: Constants in its order.
    """
    found, of_c = copy(made), cffi.FFI()
    found._ufl_expression = value
    found._cpp_object = dolfinx.cpp.fem.create_expression_float64(
        int(of_c.cast("uintptr_t", of_c.addressof(made.ufcx_expression))),
        [each._cpp_object for each in coefficients],
        [each._cpp_object for each in constants],
        None,
    )
    return found


def integration_entities(form: fem.Form, kind: IntegralType) -> npt.NDArray[np.int32]:
    """Cells, or pairs (cell, local facet) in one row, of all integrals of a kind in ``form``.

    In 0.9 integrals have ids of their own, in 0.11 they are counted from 0.
    """
    cpp_form = form._cpp_object
    if hasattr(cpp_form, "integral_ids"):  # can go with 0.9
        numbers = cpp_form.integral_ids(kind)
    else:
        numbers = range(cpp_form.num_integrals(kind, 0))
    rows = [cpp_form.domains(kind, number).reshape(-1) for number in numbers]
    return np.concatenate([np.empty(0, dtype=np.int32), *rows])


def packed_constants(form: fem.Form) -> npt.NDArray[np.float64]:
    """Values of all constants of a form, in a row."""
    return dolfinx.cpp.fem.pack_constants(form._cpp_object)


def packed_coefficients(form: fem.Form) -> npt.NDArray[np.float64]:
    """Values of all coefficients of a form with one integral, a row for each of its cells."""
    (values,) = dolfinx.cpp.fem.pack_coefficients(form._cpp_object).values()
    return np.asarray(values, dtype=np.float64)


def first_column(form: fem.Form, coefficient: fem.Function | None) -> int:
    """First column of a coefficient in the packed ones; their end if the form does not have it."""
    column = 0
    for each in form._cpp_object.coefficients:
        if coefficient is not None and each is coefficient._cpp_object:
            break
        dofmap = each.function_space.dofmap
        column += dofmap.map().shape[1] * dofmap.bs
    return column


def coefficients_from(form: fem.Form, column: int) -> list[Any]:
    """DOLFINx's coefficients of a form whose packed values start at a column or after it."""
    found, at = [], 0
    for each in form._cpp_object.coefficients:
        if at >= column:
            found.append(each)
        dofmap = each.function_space.dofmap
        at += dofmap.map().shape[1] * dofmap.bs
    return found


def has_plain_values(coefficient: Any) -> bool:
    """Whether packed values are those of the dofs, whatever the orientation of a cell."""
    return not coefficient.function_space.element.needs_dof_transformations


def values_and_dofs(coefficient: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """Values of one of DOLFINx's coefficients, a row for each dof, and the dofs of each cell.

    Both are views.
    """
    dofmap = coefficient.function_space.dofmap
    return coefficient.x.array.reshape(-1, dofmap.bs), dofmap.map()


def is_on_space(bc: fem.DirichletBC, space: fem.FunctionSpace) -> bool:
    """Whether a support is one of the unknowns of a space itself, not of an equal space."""
    return bool(bc.function_space == space._cpp_object)


def create_vector(form: fem.Form) -> PETSc.Vec:
    """PETSc vector for a linear form.

    0.9 takes the form, later versions its function space. The branch can go with 0.9.
    """
    return petsc.create_vector(form.function_spaces[0] if VERSION >= (0, 10) else form)


def geometry_dofmap(mesh: dolfinx.mesh.Mesh) -> npt.NDArray[np.int32]:
    """Geometry nodes of the local cells, shape ``(num_cells, nodes)``.

    0.11 has one array per type of cell and deprecates the old name. Can go with 0.10.
    """
    geometry = mesh.geometry
    return geometry.dofmaps[0] if VERSION >= (0, 11) else geometry.dofmap


def kinds_of_cells(mesh: dolfinx.mesh.Mesh) -> list[str]:
    """Names of the cell types of a mesh, several for a mixed topology."""
    topology = mesh.topology._cpp_object if hasattr(mesh.topology, "_cpp_object") else mesh.topology
    return [kind.name for kind in topology.entity_types[mesh.topology.dim]]


def cell_name(domain: ufl.Mesh) -> str:
    """Name of the cells of ``domain``: a method up to UFL 2025.2, a property since.

    Can go with 0.10.
    """
    name = domain.ufl_cell().cellname
    return str(name() if callable(name) else name)


def create_line_mesh(
    points: npt.NDArray[np.float64], cells: npt.NDArray[np.int64]
) -> dolfinx.mesh.Mesh:
    """Line mesh in space on this process, from points ``(n, 3)`` and cells ``(m, 2 or 3)``.

    The call is by keyword: two arguments were swapped in 0.10.

    Raises:
        RuntimeError: The mesh was cut.
    """
    valence = np.bincount(cells[:, :2].ravel())
    element = basix.ufl.element("Lagrange", "interval", cells.shape[1] - 1, shape=(3,))
    options: dict[str, Any] = {}
    if BRANCHING_IN_PARALLEL:
        options["max_facet_to_cell_links"] = max(2, int(valence.max()))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=points, e=element, **options)
    expected, found = np.count_nonzero(valence), mesh.topology.index_map(0).size_global
    if found != expected:
        raise RuntimeError(
            f"DOLFINx cut the line mesh: {found} vertices instead of {expected}; use one process"
        )
    return mesh


def check_branches(mesh: dolfinx.mesh.Mesh) -> None:
    """Refuse a mesh that was cut where it branches, or may have been, on several ranks.

    A mesh that was cut has two nodes made of one node of the input. With 0.9 it depends on the
    partition whether a branching line mesh is cut, so all of them are refused.

    Raises:
        ValueError: It was cut, or branches with 0.9; on every rank.
    """
    if mesh.comm.size == 1:
        return
    geometry = mesh.geometry
    owned = geometry.input_global_indices[: geometry.index_map().size_local]
    # each rank counts the nodes of its residue class, so none has all of them
    ranks = range(mesh.comm.size)
    nodes = np.concatenate(mesh.comm.alltoall([owned[owned % len(ranks) == r] for r in ranks]))
    cut = mesh.comm.allreduce(len(nodes) - len(np.unique(nodes)))
    if cut > 0:
        total = geometry.index_map().size_global
        option = "create it with max_facet_to_cell_links" if BRANCHING_IN_PARALLEL else "use one"
        raise ValueError(
            f"DOLFINx {dolfinx.__version__} cut the mesh on {mesh.comm.size} processes: {cut} of "
            f"its nodes are two, got {total} instead of {total - cut}; {option}"
        )
    if BRANCHING_IN_PARALLEL or mesh.topology.dim != 1:
        return
    owned = mesh.topology.index_map(1).size_local
    vertices = mesh.topology.connectivity(1, 0).array[: 2 * owned]
    index_map = mesh.topology.index_map(0)
    valence = la.vector(index_map, 1, dtype=np.int64)
    valence.array[:] = np.bincount(vertices, minlength=len(valence.array))
    valence.scatter_reverse(la.InsertMode.add)
    largest = int(valence.array[: index_map.size_local].max(initial=0))
    largest = mesh.comm.allreduce(largest, MPI.MAX)
    if largest > 2:
        raise ValueError(
            f"{largest} cells meet at a vertex: DOLFINx {dolfinx.__version__} cuts branching line "
            f"meshes on several processes, got {mesh.comm.size}; use one, or DOLFINx 0.10 or later"
        )


def geometry_degree(mesh: dolfinx.mesh.Mesh) -> int:
    """Degree of the map of the cells.

    From 0.11 on there is one map for each kind of cells. The branch can go with 0.10.
    """
    geometry = mesh.geometry
    return int((geometry.cmaps[0] if VERSION >= (0, 11) else geometry.cmap).degree)


def ghost_options(mode: GhostMode = GhostMode.shared_facet) -> dict[str, Any]:
    """Options of ``dolfinx.mesh.create_mesh``: by default processes copy neighbouring cells.

    From 0.10 on a partitioner needs the number of cells that meet at a facet. The branch can go
    with 0.9.
    """
    limit = (2,) if VERSION >= (0, 10) else ()
    return {"partitioner": dolfinx.mesh.create_cell_partitioner(mode, *limit)}


def submesh(
    mesh: dolfinx.mesh.Mesh, cells: npt.NDArray[np.int64]
) -> tuple[dolfinx.mesh.Mesh, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Mesh of some cells, and the number of each of its cells and nodes in ``mesh``.

    From DOLFINx 0.10 on the cells are an entity map.
    """
    found = dolfinx.mesh.create_submesh(mesh, mesh.topology.dim, cells.astype(np.int32))
    numbers, nodes = found[1], found[3]
    if not isinstance(numbers, np.ndarray):
        own = found[0].topology.index_map(mesh.topology.dim).size_local
        numbers = numbers.sub_topology_to_topology(np.arange(own, dtype=np.int32), inverse=False)
    return found[0], numbers.astype(np.int64), nodes.astype(np.int64)


def create_surface_mesh(
    points: npt.NDArray[np.float64], cells: npt.NDArray[np.int64], cell: str, degree: int
) -> dolfinx.mesh.Mesh:
    """Surface or volume mesh on this process, from points ``(n, gdim)`` and cells.

    Cells are in DOLFINx's order. The call is by keyword: two arguments were swapped in 0.10.
    """
    element = basix.ufl.element("Lagrange", cell, degree, shape=(points.shape[1],))
    return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=points, e=element)


def refined(
    mesh: dolfinx.mesh.Mesh, cells: npt.NDArray[np.int32]
) -> tuple[dolfinx.mesh.Mesh, npt.NDArray[np.int32]]:
    """Mesh of simplices with some cells refined, and the parent of each of its cells.

    DOLFINx returns parents in the order of creation of the cells, before renumbering.
    """
    topology, dim = mesh.topology, mesh.topology.dim
    topology.create_entities(1)
    topology.create_connectivity(dim, 1)
    topology.create_connectivity(1, dim)
    edges = dolfinx.mesh.compute_incident_entities(topology, cells, dim, 1)
    option = dolfinx.mesh.RefinementOption.parent_cell
    fine, parents, _ = dolfinx.mesh.refine(mesh, edges, option=option)
    return fine, parents[fine.topology.original_cell_index]


def gmsh_order(cell: str, nodes: int) -> npt.NDArray[np.int64]:
    """Positions of DOLFINx's nodes of a cell in gmsh's order, shape (nodes,)."""
    kind = dolfinx.cpp.mesh.to_type(cell)
    return np.asarray(dolfinx.cpp.io.perm_gmsh(kind, nodes), dtype=np.int64)


def is_made_of(
    mesh: dolfinx.mesh.Mesh, points: npt.NDArray[np.float64], cells: npt.NDArray[np.int64]
) -> bool:
    """Whether a mesh has these points (n, 3) and cells (m, k), in its own numbering."""
    return np.array_equal(mesh.geometry.x, points) and np.array_equal(geometry_dofmap(mesh), cells)


def drawn_surface(grid: Any, subdivision: int) -> Any:
    """Surface of a pyvista grid, with curved cells subdivided.

    From pyvista 0.47 on the filter warns unless an algorithm is chosen; before, there was no
    choice. Can go with older versions.
    """
    selectable = "algorithm" in inspect.signature(grid.extract_surface).parameters
    options = {"algorithm": "dataset_surface"} if selectable else {}
    return grid.extract_surface(nonlinear_subdivision=subdivision, **options)


@contextmanager
def indexed_expressions() -> Iterator[None]:
    """Context in which FFCx looks up the number of an expression in its index of them.

    Otherwise it compares each expression of a form with all others, which takes three quarters of
    its time for a form of 10⁴ of them (FFCx 0.9 to 0.11). Can go with these.
    """
    if VERSION > (0, 11):
        yield
        return
    of_list = ValueNumberer.get_node_symbols

    def of_index(self: ValueNumberer, expression: Expr) -> list[int]:
        return self.V_symbols[self.G.e2i[expression]]

    ValueNumberer.get_node_symbols = of_index
    try:
        yield
    finally:
        ValueNumberer.get_node_symbols = of_list


@contextmanager
def errors_of_callbacks() -> Iterator[None]:
    """Context in which PETSc may call functions in Python that raise.

    PETSc for Python describes an error on its way through PETSc by Python objects, while the error
    is pending. A collection of garbage at that moment drops it, and the process ends with a
    segmentation fault (petsc4py 3.22). So there is none in this context.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


@contextmanager
def slepc_errors() -> Iterator[None]:
    """Raise errors of SLEPc as ``PETSc.Error``, as petsc4py does.

    slepc4py 3.25.1, with DOLFINx 0.11, hides it as the cause of a ``SystemError``; 3.22 does not.
    Can go when the newest slepc4py raises ``PETSc.Error`` again and 3.25 is no longer in use.
    """
    try:
        yield
    except SystemError as error:
        if isinstance(error.__cause__, PETSc.Error):
            raise error.__cause__ from None
        raise
