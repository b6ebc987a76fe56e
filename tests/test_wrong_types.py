"""Arguments of another kind than wanted: the message names what was given and what is wanted."""

import inspect
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl

NAN, INF = float("nan"), float("inf")
MATERIAL = fl.Material(1e9, 0.3, 1000.0)
SECTION = fl.Section.circle(0.01, MATERIAL)
LAYER = fl.ShellSection.layer(0.01, MATERIAL)
LINE = fl.mesh.LineMesh.from_cells([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1), (1, 2)])
SURFACE = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2))

BEAM = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="bar")
BODY = fl.RigidBody(1.0, (1, 1, 1), (1, 0, 0), name="mass")
START, END, CENTRE = BEAM.point("start"), BEAM.point("end"), BODY.point("centre")
SHELL = fl.Shell(SURFACE, LAYER, name="plate")
JOINT = fl.joints.Revolute(END, CENTRE, name="hinge")
PIN = fl.joints.Cylindrical(START, fl.ground(), name="pin")


def scene() -> fl.Scene:
    made = fl.Scene()
    for item in (BEAM, BODY, SHELL, JOINT, PIN):
        made.add(item)
    return made


WRONG = {
    "point": [(0, 0, 1), np.zeros(3), "tip", None, 3, BEAM, JOINT.angle],
    "coordinate": [JOINT, "angle", None, 3, END],
    "beam": [END, "bar", None, BODY, SHELL],
    "beam or a shell": [END, "bar", None, BODY],
    "shell": [SHELL.point("00"), "plate", None, BODY, BEAM],
    "number": ["three", None, (1, 2), object(), NAN, INF, 1j],
    "optional number": ["three", (1, 2), object(), NAN, INF, 1j],
    "optional whole": [1.5, "two", 0, -1, (1, 2), 2**63],
    "vector": ["up", (1, 2), (1, 2, 3, 4), (0, NAN, 1), object(), [[1, 2, 3]], ("a", "b", "c")],
    "array": ["up", (1, 2), object(), [[1, 2], [3]], [[[1]]], NAN],
    "function or nothing": [3.0, "f", (1, 2), BEAM],
    "function": [3.0, "f", None, BEAM],
    "flag": ["no", None, 2, (1,)],
    "name": [3, None, BEAM],
    "group": [3, BEAM, ["all"], "missing"],
    "whole": [1.5, "two", None, 0, -1, (1, 2), 2**63],
    "whole or nothing": [1.5, "two", 0, -1, (1, 2), 2**63],
    "scene": [BEAM, None, "scene", []],
    "result": [BEAM, None, "result", 3],
    "modes": [None, "first", 3],
    "levels": ["up", object(), NAN, 1.0, (2, 1), (-1,), [], (1, NAN), None],
    "pair": [3, "ab", None, (1, 2, 3), (0, 1), (1.5, 2)],
    "material": ["steel", None, 3, SECTION],
    "section": ["round", None, 3, MATERIAL, LAYER, {}],
    "shell section": ["round", None, 3, MATERIAL, SECTION, {}],
    "line mesh": [SURFACE, None, "mesh", [(0, 0, 0), (1, 0, 0)]],
    "surface mesh": [LINE, None, "mesh", [(0, 0, 0), (1, 0, 0)]],
    "formulation": ["geodesic", 2, fl.elements.GeodesicBeam],
    "damping": [0.1, "much", (1, 2)],
    "choices": [True, "all", {}],
    "group of motions": ["SE3", 7, None],
}
HELD = fl.Scene()
HELD.add(SHORT := fl.Beam.straight((0, 0, 0), (0, 0, 1), SECTION, cells=2, name="short"))
HELD.add(fl.Clamp(SHORT.point("start")))
HELD.add(fl.PointLoad(SHORT.point("end"), (0, 0, -1e-6)))
BENT = fl.statics(HELD)
MODES = fl.buckling(HELD, 1)
FIELD = fl.stability.FieldImperfection(lambda x: 0 * x)
F = lambda t: t  # noqa: E731
STILL = START.frame.copy()

CASES: dict[str, tuple] = {
    "Material": (fl.Material, dict(E=(1.0, "number"), nu=(0.3, "number"), density=(1.0, "number"))),
    "Section.rectangle": (
        fl.Section.rectangle,
        dict(width=(1.0, "number"), height=(1.0, "number"), material=(MATERIAL, "material")),
    ),
    "Section.circle": (
        fl.Section.circle, dict(radius=(1.0, "number"), material=(MATERIAL, "material"))
    ),
    "Section.offset": (SECTION.offset, dict(y=(1.0, "number"), z=(1.0, "number"))),
    "Section.rotated": (SECTION.rotated, dict(angle=(1.0, "number"))),
    "ShellSection.layer": (
        fl.ShellSection.layer, dict(thickness=(0.1, "number"), material=(MATERIAL, "material"))
    ),
    "ShellSection": (
        fl.ShellSection,
        dict(
            stiffness=(np.eye(8), "array"), inertia=(np.eye(2), "array"),
            thickness=(0.1, "number"),
        ),
    ),
    "Ply": (
        fl.sections.Ply,
        dict(thickness=(0.1, "number"), material=(MATERIAL, "material"), angle=(3.0, "number")),
    ),
    "RigidBody": (
        fl.RigidBody,
        dict(
            mass=(1.0, "number"), inertia=((1, 1, 1), "array"), position=((0, 0, 0), "vector"),
            rotation=(np.eye(3), "array"),
            name=("a", "name"),
        ),
    ),
    "Beam": (
        fl.Beam,
        dict(
            mesh=(LINE, "line mesh"), section=(SECTION, "section"), up=((0, 0, 1), "vector"),
            formulation=(fl.elements.GeodesicBeam(), "formulation"),
            damping=(fl.sections.Damping(), "damping"), rotary_inertia=(True, "flag"),
            name=("a", "name"),
        ),
    ),
    "Beam.straight": (
        fl.Beam.straight,
        dict(
            start=((0, 0, 0), "vector"), end=((1, 0, 0), "vector"), section=(SECTION, "section"),
            cells=(2, "whole"),
        ),
    ),
    "Beam.polyline": (
        fl.Beam.polyline,
        dict(
            points=([(0, 0, 0), (1, 0, 0)], "array"), section=(SECTION, "section"),
            cells=(2, "whole"),
        ),
    ),
    "Beam.curve": (
        fl.Beam.curve,
        dict(
            function=(lambda s: (s, 0, 0), "function"), section=(SECTION, "section"),
            cells=(2, "whole"),
        ),
    ),
    "Damping": (fl.sections.Damping, dict(mass=(0.1, "number"), stiffness=(0.1, "array"))),
    "surface": (
        fl.mesh.parametric_surface, dict(function=(lambda a, b: (a, b, 0), "function"), cells=((2,
        2), "pair"))
    ),
    "Shell": (
        fl.Shell,
        dict(
            mesh=(SURFACE, "surface mesh"), section=(LAYER, "shell section"),
            director=(lambda x: (0, 0, 1), "function or nothing"), along=((1, 0, 0), "vector"),
            formulation=(fl.elements.DisplacementBased(), "formulation"), kink_angle=(0.5,
            "number"), name=("a", "name"),
        ),
    ),
    "Scene": (
        fl.Scene,
        dict(gravity=((0, 0, 1), "vector"), matrix_terms=(fl.schemes.MatrixTerms(), "choices")),
    ),
    "Revolute": (
        fl.joints.Revolute,
        dict(
            a=(END, "point"), b=(CENTRE, "point"), at=((1, 0, 0), "vector"),
            axis=((0, 0, 1), "vector"), name=("a", "name"),
        ),
    ),
    "Screw": (
        fl.joints.Screw, dict(a=(END, "point"), b=(CENTRE, "point"), pitch=(1.0, "number"))
    ),
    "Universal": (
        fl.joints.Universal,
        dict(a=(END, "point"), b=(CENTRE, "point"), second=((1, 0, 0), "vector")),
    ),
    "Distance": (
        fl.joints.Distance,
        dict(a=(START, "point"), b=(CENTRE, "point"), to=((1, 1, 1), "vector")),
    ),
    "RollingDisc": (
        fl.joints.RollingDisc,
        dict(
            a=(fl.ground(), "point"), b=(CENTRE, "point"), radius=(1.0, "number"),
            axis=((0, 1, 0), "vector"), normal=((0, 0, 1), "vector"),
        ),
    ),
    "RigidLink": (fl.joints.RigidLink, dict(a=(END, "point"), b=(CENTRE, "point"))),
    "Collar": (
        fl.joints.Collar,
        dict(
            beam=(BEAM, "beam"), b=(CENTRE, "point"), at=((0.5, 0, 0), "vector"),
            travel=(None, "function or nothing"), name=("a", "name"),
        ),
    ),
    "Spring": (
        fl.joints.Spring,
        dict(
            coordinate=(JOINT.angle, "coordinate"), stiffness=(1.0, "number"),
            damping=(0.0, "number"), name=("a", "name"),
        ),
    ),
    "Drive": (
        fl.joints.Drive,
        dict(
            coordinate=(JOINT.angle, "coordinate"), function=(F, "function or nothing"),
            name=("a", "name"),
        ),
    ),
    "Gear": (
        fl.joints.Gear,
        dict(
            first=(JOINT.angle, "coordinate"), second=(PIN.angle, "coordinate"),
            ratio=(2.0, "number"), name=("a", "name"),
        ),
    ),
    "PointLoad": (
        fl.PointLoad,
        dict(
            point=(END, "point"), force=((0, 0, 1), "vector"), moment=((0, 0, 1), "vector"),
            following=(True, "flag"), history=(F, "function or nothing"),
        ),
    ),
    "LineLoad": (
        fl.LineLoad,
        dict(
            beam=(BEAM, "beam"), force=((0, 0, 1), "vector"), moment=((0, 0, 1), "vector"),
            cells=(None, "group"), following=(True, "flag"), history=(F, "function or nothing"),
        ),
    ),
    "PressureLoad": (
        fl.loads.PressureLoad,
        dict(
            beam=(BEAM, "beam"), pressure=(1.0, "number"), direction=((0, 0, 1), "vector"),
            cells=(None, "group"), history=(F, "function or nothing"),
        ),
    ),
    "Temperature": (
        fl.loads.Temperature,
        dict(loaded=(BEAM, "beam or a shell"), rise=(1.0, "number"), expansion=(1e-5, "number")),
    ),
    "Eigenstrain": (
        fl.loads.Eigenstrain,
        dict(loaded=(BEAM, "beam or a shell"), strain=(np.zeros(6), "vector")),
    ),
    "PreStress": (
        fl.loads.PreStress,
        dict(loaded=(BEAM, "beam or a shell"), resultant=(np.zeros(6), "vector")),
    ),
    "EdgeLoad": (
        fl.loads.EdgeLoad,
        dict(
            shell=(SHELL, "shell"), curve=("a=1", "group"), force=((0, 0, 1), "vector"),
            history=(F, "function or nothing"), following=(True, "flag"),
        ),
    ),
    "AreaLoad": (
        fl.AreaLoad,
        dict(
            shell=(SHELL, "shell"), force=((0, 0, 1), "vector"), cells=(None, "group"),
            history=(F, "function or nothing"),
        ),
    ),
    "SurfacePressure": (
        fl.loads.SurfacePressure,
        dict(
            shell=(SHELL, "shell"), pressure=(1.0, "number"), gradient=((0, 0, 1), "vector"),
            cells=(None, "group"), history=(F, "function or nothing"),
        ),
    ),
    "statics": (
        fl.statics,
        dict(
            scene=(HELD, "scene"), levels=((1.0,), "levels"), load_steps=(1, "optional whole"),
            spin=((0, 0, 0), "vector"),
        ),
    ),
    "set_group": (
        lambda group: fl.RigidBody(1.0, (1, 1, 1)).set_group(group),
        dict(group=(fl.lie.Group.SE3, "group of motions")),
    ),
    "Newton": (
        fl.schemes.Newton, dict(tolerance=(1e-10, "number"), max_iterations=(9, "whole")),
    ),
    "PathEnds": (
        fl.stability.PathEnds,
        dict(
            factor=(0.1, "optional number"), steps=(5, "whole"),
            critical_points=(1, "optional whole"),
        ),
    ),
    "vibrations": (fl.vibrations, dict(scene=(HELD, "scene"), count=(1, "whole or nothing"))),
    "buckling": (fl.buckling, dict(scene=(HELD, "scene"), count=(1, "whole or nothing"))),
    "follow_loads": (fl.follow_loads, dict(scene=(HELD, "scene"), levels=((1.0,), "levels"))),
    "follow_path": (
        fl.follow_path,
        dict(
            scene=(HELD, "scene"), until=(0.1, "optional number"), resolution=(0.5, "number"),
        ),
    ),
    "run": (
        fl.GeneralisedAlpha().run,
        dict(
            scene=(HELD, "scene"), duration=(0.01, "number"), step=(0.01, "number"),
            save_every=(1, "whole"),
        ),
    ),
    "section_forces": (
        fl.post.section_forces,
        dict(result=(BENT, "result"), beam=(SHORT, "beam"), scene=(HELD, "scene")),
    ),
    "ModeImperfection": (
        fl.stability.ModeImperfection,
        dict(modes=(MODES, "modes"), mode=(1, "whole"), amplitude=(1e-3, "number")),
    ),
    "RandomImperfection": (
        partial(fl.stability.RandomImperfection, seed=1),
        dict(amplitude=(0.1, "number"), wavelength=(1.0, "number")),
    ),
    "apply_imperfections": (
        lambda scene: fl.stability.apply_imperfections(scene, FIELD),
        dict(scene=(HELD, "scene")),
    ),
    "Clamp": (fl.Clamp, dict(point=(START, "point"))),
    "PrescribedMotion": (
        fl.PrescribedMotion,
        dict(point=(START, "point"), motion=(lambda t: STILL, "function")),
    ),
    "GeneralisedAlpha": (
        fl.GeneralisedAlpha,
        dict(radius=(0.8, "number"), tolerance=(1e-8, "number"), max_iterations=(9, "whole")),
    ),
    "EnergyMomentum": (
        fl.EnergyMomentum, dict(tolerance=(1e-8, "number"), max_iterations=(9, "whole"))
    ),
    "EnergyDecaying": (fl.EnergyDecaying, dict(radius=(0.8, "number"), tolerance=(0, "number"))),
    "AdaptiveStep": (fl.schemes.AdaptiveStep, dict(tolerance=(1e-3, "number"))),
    "SymmetricStep": (
        fl.schemes.SymmetricStep, dict(distance=(1e-3, "number"), largest=(1e-3, "number"))
    ),
    "DisplacementControl": (
        fl.stability.DisplacementControl,
        dict(point=(END, "point"), direction=((0, 0, 1), "vector"), to=(1.0, "number")),
    ),
    "add_velocity": (
        BODY.add_velocity,
        dict(
            velocity=((0, 0, 1), "vector"), omega=((0, 0, 1), "vector"),
            about=((0, 0, 1), "vector"),
        ),
    ),
    "point": (BEAM.point, dict(where=(1, "whole"), tolerance=(1.0, "number"))),
    "points": (BEAM.points, dict(where=("end", "group"))),
    "Spherical": (fl.joints.Spherical, dict(a=(END, "point"), b=(CENTRE, "point"))),
}  # fmt: skip


def _tries():
    for name, (_, arguments) in CASES.items():
        for argument, (_, kind) in arguments.items():
            for k, wrong in enumerate(WRONG[kind]):
                if _is_fine(name, argument, wrong):
                    continue
                yield pytest.param(name, argument, wrong, id=f"{name}-{argument}-{k}")


def _is_fine(name: str, argument: str, wrong: object) -> bool:
    """What this argument takes though others of its kind do not."""
    if argument in ("at", "to", "up", "along", "rotation", "director") and wrong is None:
        return True
    if (name, argument) in (("point", "tolerance"), ("add_velocity", "about")) and wrong is None:
        return True
    if (name, argument) == ("point", "where") and wrong in (0, -1):
        return True
    return (name, argument) == ("Beam", "up") and isinstance(wrong, dict)


def _check(made: object) -> None:
    """What a scene, or whoever takes it, checks."""
    if isinstance(made, fl.stability.DisplacementControl):
        made.check()
    elif isinstance(made, fl.schemes.AdaptiveStep | fl.schemes.SymmetricStep):
        made.check(1.0)
    elif hasattr(made, "check"):
        scene().add(made)


@pytest.mark.parametrize(("name", "argument", "wrong"), list(_tries()))
def test_the_message_names_what_was_given_and_what_is_wanted(name, argument, wrong):
    make, arguments = CASES[name]
    given = {key: value for key, (value, _) in arguments.items()} | {argument: wrong}
    with pytest.raises((TypeError, ValueError)) as caught:
        _check(make(**given))
    frame = inspect.getinnerframes(caught.tb)[-1]
    assert Path(frame.filename).is_relative_to(Path(fl.__file__).parent), frame
    # not by chance in numpy or in a comparison
    assert frame.code_context is not None and frame.code_context[0].strip().startswith("raise")


@pytest.mark.parametrize("name", CASES)
def test_the_right_ones_are_taken(name):
    make, arguments = CASES[name]
    _check(make(**{key: value for key, (value, _) in arguments.items()}))
