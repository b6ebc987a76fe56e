"""Bodies on distributed meshes of DOLFINx: ``mpirun -n 2 parallel_meshes.py OUT``."""

import sys

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)


def located(mesh, dim, *places):
    """Tags 1, 2, … of the entities at places."""
    tdim = mesh.topology.dim
    mesh.topology.create_connectivity(dim, tdim)
    if dim < tdim:
        found = [dolfinx.mesh.locate_entities_boundary(mesh, dim, at) for at in places]
    else:
        found = [dolfinx.mesh.locate_entities(mesh, dim, at) for at in places]
    entities = np.concatenate(found)
    values = np.repeat(np.arange(1, len(found) + 1), [len(each) for each in found])
    order = np.argsort(entities)
    kinds = values[order].astype(np.int32)
    return dolfinx.mesh.meshtags(mesh, dim, entities[order].astype(np.int32), kinds)


def deflection(body, load, point, *supports):
    """Displacement of a point of a body under a load."""
    scene = fl.Scene()
    for item in (body, load, *supports):
        scene.add(item)
    return fl.statics(scene).displacement(point)[-1]


def beam(comm):
    """A frame of three bars that meet in a point, one of them stiffer."""
    t = np.linspace(0, 1, 7)[1:, np.newaxis]
    ends = np.array([[1.0, 0, 0], [0, 1.0, 0], [-1.0, 0.2, 0]])
    points = np.concatenate([np.zeros((1, 3)), *(t * end for end in ends)])
    cells = np.concatenate(
        [[[0, 6 * k + 1], *([6 * k + j, 6 * k + j + 1] for j in range(1, 6))] for k in range(3)]
    )
    own = slice(None) if comm.rank == 0 else slice(0, 0)
    mesh = dolfinx.mesh.create_mesh(
        comm,
        cells=cells[own].astype(np.int64),
        x=points[own],
        e=basix.ufl.element("Lagrange", "interval", 1, shape=(3,)),
    )
    kinds = located(
        mesh, 1, lambda x: abs(x[0]) < 1e-9, lambda x: abs(x[1]) < 0.3 * abs(x[0]) + 1e-9
    )
    vertices = located(
        mesh, 0, lambda x: x[0] > 0.99, lambda x: x[1] > 0.99, lambda x: x[0] < -0.99
    )
    names = {"east": 1, "north": 2, "west": 3}
    read = fl.mesh.lines_from_dolfinx(
        mesh, kinds, vertices, groups={"stiff": 1, "soft": 2}, named_points=names
    )
    sections = {
        "stiff": fl.Section.rectangle(0.03, 0.03, STEEL),
        "soft": fl.Section.rectangle(0.02, 0.02, STEEL),
    }
    body = fl.Beam(read, sections)
    load = fl.PointLoad(body.point("north"), force=(0, 0, 10.0))
    clamps = [fl.Clamp(body.point(name)) for name in ("east", "west")]
    return deflection(body, load, body.point("north"), *clamps)


def shell(comm):
    """A strip, clamped along a side, with two thicknesses."""
    flat = dolfinx.mesh.create_rectangle(
        MPI.COMM_SELF, ((0, 0), (1, 0.4)), (8, 3), dolfinx.mesh.CellType.quadrilateral
    )
    own = slice(None) if comm.rank == 0 else slice(0, 0)
    corners = dolfinx.mesh.entities_to_geometry(flat, 2, np.arange(24, dtype=np.int32))
    mesh = dolfinx.mesh.create_mesh(
        comm,
        cells=corners[own].astype(np.int64),
        x=flat.geometry.x[own],
        e=basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(3,)),
    )
    halves = located(mesh, 2, lambda x: x[0] < 0.51, lambda x: x[0] > 0.49)
    edges = located(mesh, 1, lambda x: x[0] < 1e-9, lambda x: x[0] > 1 - 1e-9)
    corner = located(mesh, 0, lambda x: (x[0] > 0.99) & (x[1] > 0.39))
    read = fl.mesh.surface_from_dolfinx(
        mesh,
        halves,
        edges,
        corner,
        groups={"thick": 1, "thin": 2},
        curves={"root": 1, "tip": 2},
        named_points={"corner": 1},
    )
    layers = {
        "thick": fl.ShellSection.layer(0.01, STEEL),
        "thin": fl.ShellSection.layer(0.006, STEEL),
    }
    body = fl.Shell(read, layers)
    body.clamp("root")
    normal = np.sign(read.normals[..., 2].mean())
    load = fl.loads.EdgeLoad(body, "tip", force=(0, 5.0, 20.0 * abs(normal)))
    return deflection(body, load, body.point("corner"))


def curved_beam(comm):
    """Half a circle of three-node cells."""
    count = 8
    s = np.linspace(0, np.pi, 2 * count + 1)
    points = np.column_stack([np.cos(s), np.sin(s), np.zeros_like(s)])
    first = 2 * np.arange(count)[:, np.newaxis]
    own = slice(None) if comm.rank == 0 else slice(0, 0)
    mesh = dolfinx.mesh.create_mesh(
        comm,
        cells=(first + np.array([0, 2, 1]))[own],
        x=points[own],
        e=basix.ufl.element("Lagrange", "interval", 2, shape=(3,)),
    )
    top = located(mesh, 1, lambda x: x[1] > 0.69)
    ends = located(mesh, 0, lambda x: x[0] > 0.99, lambda x: x[0] < -0.99)
    read = fl.mesh.lines_from_dolfinx(
        mesh, top, ends, groups={"top": 1}, named_points={"east": 1, "west": 2}
    )
    section = fl.Section.rectangle(0.03, 0.02, STEEL)
    body = fl.Beam(read, section)
    load = fl.LineLoad(body, force=(0, -5.0, 8.0), cells="top")
    return deflection(body, load, body.point("west"), fl.Clamp(body.point("east")))


def curved_shell(comm):
    """A strip of a cylinder of nine-node cells, clamped along a side."""
    given = fl.mesh.parametric_surface(
        lambda a, b: (np.sin(a), 0.4 * b, np.cos(a)), (5, 2), degree=2
    )
    own = slice(None) if comm.rank == 0 else slice(0, 0)
    mesh = dolfinx.mesh.create_mesh(
        comm,
        cells=given.cells[own].astype(np.int64),
        x=given.points[own],
        e=basix.ufl.element("Lagrange", "quadrilateral", 2, shape=(3,)),
    )
    edges = located(mesh, 1, lambda x: x[0] < 1e-9, lambda x: x[0] > np.sin(1) - 1e-9)
    read = fl.mesh.surface_from_dolfinx(mesh, facet_tags=edges, curves={"root": 1, "tip": 2})
    body = fl.Shell(read, fl.ShellSection.layer(0.01, STEEL))
    body.clamp("root")
    load = fl.loads.EdgeLoad(body, "tip", force=(0, 0, 20.0))
    return deflection(body, load, body.point((np.sin(1), 0.4, np.cos(1))))


def solid(comm):
    """A block of curved cells, clamped at a face."""
    mesh = dolfinx.mesh.create_box(
        comm, ((0, 0, 0), (1, 1, 2)), (2, 2, 3), dolfinx.mesh.CellType.hexahedron
    )
    faces = located(mesh, 2, lambda x: x[2] < 1e-9, lambda x: x[2] > 2 - 1e-9)
    top = located(mesh, 0, lambda x: (x[0] > 0.99) & (x[1] > 0.99) & (x[2] > 1.99))
    read = fl.mesh.volume_from_dolfinx(
        mesh,
        facet_tags=faces,
        vertex_tags=top,
        faces={"foot": 1, "head": 2},
        named_points={"top": 1},
    )
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    body = fl.Solid(read, rubber, degree=2)
    body.clamp("foot")
    load = fl.loads.FaceLoad(body, "head", (1e4, 0, 0))
    return deflection(body, load, body.point("top"))


def plain(comm):
    """A block on a mesh without tags."""
    mesh = dolfinx.mesh.create_unit_cube(comm, 2, 2, 2)
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    body = fl.Solid(mesh, rubber, degree=2)
    return np.sort(body.frames[:, 0] @ [1.0, 10.0, 100.0])


BUILT = {
    "beam": beam,
    "shell": shell,
    "curved beam": curved_beam,
    "curved shell": curved_shell,
    "solid": solid,
    "plain": plain,
}


if __name__ == "__main__":
    found = {name: build(MPI.COMM_WORLD) for name, build in BUILT.items()}
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[1], **found)
