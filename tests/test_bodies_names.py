"""Bodies show users few names; what the assembly sees of them is documented name by name."""

import inspect

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.extend import Body, BodyModel
from tests.own_elements import random_body
from tests.own_form_body import own_beam
from tests.test_packages import import_all

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
TUBE = fl.Section.circle(0.01, STEEL)
LINE = (0, 0, 0), (1, 0, 0)
PLATE = fl.ShellSection.layer(0.01, STEEL)

OF_ALL = {
    *("name", "label", "frames", "velocities", "set_group", "add_velocity"),
    *("point", "points", "nodes", "model"),
}
"""Names of all bodies."""

MOST = 16
"""Largest number of names of a body, with its supports and constructors."""


def flat(a, b):
    return np.array([a, b, 0.0])


def reduced():
    full = fl.Scene()
    beam = full.add(fl.Beam.straight(*LINE, TUBE, cells=2))
    return fl.reduction.reduced_order_body(full, [beam.point("start"), beam.point("end")], 1)


def distorting():
    shape = fl.sections.SectionShape.rectangle(0.1, 0.1)
    section = fl.sections.Distortion(shape.mesh, fl.Material(E=1e9, nu=0.3, density=1000.0))
    return fl.reduction.DistortingBeam.straight(*LINE, section, cells=2)


BODIES = {
    fl.RigidBody: lambda: fl.RigidBody(1.0, (1, 1, 1)),
    fl.Beam: lambda: fl.Beam.straight(*LINE, TUBE, cells=2),
    fl.Rod: lambda: fl.Rod.straight(*LINE, TUBE, cells=2),
    fl.Cable: lambda: fl.Cable.straight(*LINE, TUBE, cells=2),
    fl.Net: lambda: fl.Net([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [[0, 1, 2]], TUBE),
    fl.SplineCable: lambda: fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), TUBE, cells=4),
    fl.AncfBeam: lambda: fl.AncfBeam.straight(*LINE, TUBE, cells=2),
    fl.Shell: lambda: fl.Shell(fl.mesh.parametric_surface(flat, (1, 1)), PLATE),
    fl.Membrane: lambda: fl.Membrane(fl.mesh.parametric_surface(flat, (1, 1)), PLATE),
    fl.ThinShell: lambda: fl.ThinShell(fl.mesh.smooth_patch(flat, (1, 1)), PLATE),
    fl.AncfShell: lambda: fl.AncfShell(fl.mesh.smooth_patch(flat, (1, 1)), PLATE),
    fl.Solid: lambda: fl.Solid.brick((1, 1, 1), fl.sections.NeoHooke(1e6, 0.3), cells=(1, 1, 1)),
    fl.reduction.DistortingBeam: distorting,
    fl.reduction.ReducedOrderBody: reduced,
    fl.extend.ElementBody: lambda: random_body("derived vectors"),
    fl.extend.FormBody: lambda: own_beam("viscous", "moment"),
}
"""All bodies of the package, each with a function that makes one."""

OF_ITS_KIND = {
    fl.RigidBody: {"box", "ball", "cylinder"},
    fl.Beam: {"straight", "polyline", "curve", "point_in_cell"},
    fl.Rod: {"straight", "polyline", "curve", "point_in_cell"},
    fl.Cable: {"straight", "curve", "clamp", "pin", "convect_axes"},
    fl.Net: {"clamp", "pin", "convect_axes"},
    fl.SplineCable: {"of", "through", "circle", "clamp", "pin", "convect_axes"},
    fl.AncfBeam: {"straight", "curve", "clamp", "pin", "point_in_cell"},
    fl.Shell: {"clamp", "hinge", "roller", "symmetry", "guided", "parts"},
    fl.Membrane: {"clamp", "roller", "parts"},
    fl.ThinShell: {"clamp", "hinge", "roller", "symmetry", "guided", "point_in_cell"},
    fl.AncfShell: {"clamp", "hinge", "roller", "symmetry", "guided", "point_in_cell"},
    fl.Solid: {"brick", "clamp", "roller"},
    fl.reduction.DistortingBeam: {
        *("straight", "curve", "hold_shape", "hold_warping", "section_point", "amplitudes")
    },
    fl.reduction.ReducedOrderBody: set(),
    fl.extend.ElementBody: {"clamp"},
    fl.extend.FormBody: set(),
}
"""Constructors, supports and points of each class, beyond :data:`OF_ALL`."""


def subclasses(cls):
    return {cls}.union(*(subclasses(each) for each in cls.__subclasses__()))


def public(thing):
    return {name for name in dir(thing) if not name.startswith("_")}


def test_all_public_bodies_are_in_the_list():
    spaces = [fl, fl.extend, fl.reduction]
    found = {getattr(space, name) for space in spaces for name in space.__all__}
    found = {cls for cls in found if inspect.isclass(cls) and issubclass(cls, Body)}
    assert found - {Body} == set(BODIES) == set(OF_ITS_KIND)


@pytest.mark.parametrize("cls", BODIES, ids=lambda cls: cls.__name__)
def test_a_body_shows_what_users_need(cls):
    body = BODIES[cls]()
    assert public(body) == OF_ALL | OF_ITS_KIND[cls]  # of the object, attributes included
    assert len(public(body)) <= MOST


@pytest.mark.parametrize("cls", BODIES, ids=lambda cls: cls.__name__)
def test_what_assembly_sees_is_documented(cls):
    model = BODIES[cls]().model
    documents = "\n".join(each.__doc__ or "" for each in type(model).__mro__)
    missing = [
        name
        for name in public(model)
        if f" {name}: " not in documents and not documented(type(model), name)
    ]
    assert missing == []


def documented(cls, name):
    """Whether a class has a method or property of this name with a docstring."""
    found = inspect.getattr_static(cls, name, None)
    descriptor = callable(found) or hasattr(found, "__get__")
    return descriptor and bool(inspect.getdoc(getattr(cls, name)))


import_all()
# in one order in all processes that share the tests
MODELS = sorted(
    (cls for cls in subclasses(BodyModel) if cls.__module__.startswith("fem_lie.")),
    key=lambda cls: cls.__qualname__,
)


@pytest.mark.parametrize("cls", MODELS, ids=lambda cls: cls.__name__)
def test_models_are_no_bodies(cls):
    assert not issubclass(cls, Body)
    assert not public(cls) & {"clamp", "pin", "hinge", "symmetry", "roller", "add_velocity"}
