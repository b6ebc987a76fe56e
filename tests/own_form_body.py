"""A body of users' forms: a beam of mixed elements with damping, and a load without energy."""

from mpi4py import MPI

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem

import fem_lie as fl
from tests import models


def own_beam(*names: str) -> fl.extend.FormBody:
    """A curved line with viscous or mixed elements, and a moment that has no energy."""
    mesh = models.line(MPI.COMM_SELF, 2, 3)
    q = fl.NodalFrames(mesh, degree=2)
    dx = ufl.dx(mesh, degree=3)
    e = ufl.as_vector([*models.director_energy(q).strain])
    s = fem.Function(fem.functionspace(mesh, basix.ufl.element("DG", "interval", 1, shape=(6,))))
    flexibility = fem.Constant(mesh, np.linalg.inv(models.D))
    mixed = ufl.inner(s, e) - ufl.inner(s, flexibility * s) / 2 - 0.01 * s[3] ** 4
    viscous = fl.extend.StrainEnergy(
        e, models.linear_law, dx, viscosity=fem.Constant(mesh, 0.1 * models.D)
    )
    moment = fem.Constant(mesh, (0.3, -0.2, 0.5))
    forms = {
        "viscous": lambda: fl.local_frame_forms(viscous, q),
        "mixed": lambda: fl.local_frame_forms(mixed * dx, q, local=s),
        "moment": lambda: fl.extend.dead_moment(moment, dx, q),
    }
    inertia = fl.extend.kinetic_energy(np.diag([2.0, 0.0, 0.1, 0.2]), ufl.dx(mesh, degree=4), q)
    problem = fl.FrameProblem([forms[name]() for name in names], q)
    return fl.extend.FormBody(problem, inertia=inertia)
