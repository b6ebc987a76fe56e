"""The interface of the equations for solvers: a list of methods and objects, and nothing else.

Names are read from the sources. A name that is used but not in the list fails, and so does an
unused one in the list: the list is all that an author of a scheme has to know of the equations.
"""

import ast
from pathlib import Path

import pytest

import fem_lie as fl

SOLVE = Path(fl.__file__).parent / "solve"

RECORDS = {
    "arrays",
    "info",
    "last",
    "matrix",
    "part",
    "history_variables",
    "scene",
    "shared",
    "start",
    "supports",
    "unknowns",
}
"""What stays the same object."""

VERBS = {
    "time": {"prescribed"},
    "forces": {"check_laws", "residual"},
    "matrix": {"constraints", "fill", "linear_state"},
    "what is reported of a state": {"energy_balance", "of_bodies", "report"},
    "what they are like": {"contents", "small_motions"},
}

VIEWS = {
    "constraints": {"contradiction", "jacobian", "rates", "rigid_motions", "values"},
    "history_variables": {
        "accept",
        "activity",
        "acts",
        "update_stress",
        "check_passage",
        "factor",
        "move_reference_angles",
        "saved_state",
        "restore",
        "rotate_axes",
        "scale",
        "switch",
        "friction_forces",
        "turns",
        "unchanged",
        "watch",
        "with_matrix",
    },
    "prescribed": {
        "accelerations",
        "act",
        "frames",
        "limited",
        "loads",
        "target_rates",
        "targets",
        "velocities",
    },
    "report": {
        "check_rotations",
        "elastic",
        "frames",
        "kinetic",
        "joints",
        "reactions",
        "rotation_hint",
        "twists",
    },
}
"""What can be asked of the constraints at a position, what is remembered, of a time, of a state."""

IMPORTED = {f"equations.{name}" for name in ("Equations", "TimeState", "LinearState", "Plan")} | {
    "small_motions.SmallMotions"
}

COMPILED = {
    "nodes.numbering.expand_motion",
    "nodes.element_rotations.most_strained",
    "nodes.element_rotations.nearest",
    "nodes.fixed_axes.wrenches",
    "nodes.masses.Loads",
    "nodes.sums.report_rates",
    "nodes.sums.residual",
    "outer_forces.look_and_sum_up",
    "outer_forces.look_at",
}
"""What compiled steps and rows of results call, without the way through Python."""


def sources():
    return [ast.parse(file.read_text(encoding="utf-8")) for file in sorted(SOLVE.rglob("*.py"))]


def imported() -> set[str]:
    found = set()
    for tree in sources():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                package, _, inside = node.module.partition("fem_lie.system")
                if package == "" and node.module.startswith("fem_lie.system"):
                    found |= {f"{inside}.{alias.name}".lstrip(".") for alias in node.names}
    return found


def used() -> set[str]:
    """Attributes of variables called equations."""
    found = set()
    for tree in sources():
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute):
                owner = node.value
                name = owner.id if isinstance(owner, ast.Name) else getattr(owner, "attr", "")
                if name in ("equations", "_equations"):
                    found.add(node.attr)
    return found


def test_solvers_import_the_interface_and_compiled_sums_alone():
    assert imported() == IMPORTED | COMPILED


def test_solvers_use_these_names_of_equations_and_no_others():
    listed = RECORDS.union(*VERBS.values())
    assert used() - {"__init__"} == listed


@pytest.mark.parametrize("verb", sorted(set().union(*VERBS.values())))
def test_every_verb_says_what_it_does(verb):
    assert getattr(fl.extend.Equations, verb).__doc__


def view_of(name: str) -> type:
    """Class of what the equations of a scene return."""
    scene = fl.Scene()
    scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0)))
    equations = fl.extend.Equations(scene, dynamics=True)
    H = equations.start.frames
    given = {"constraints": (H,), "prescribed": (0.0,), "report": (H,)}
    found = getattr(equations, name)
    return type(found(*given[name]) if name in given else found)


@pytest.mark.parametrize("name", VIEWS)
def test_views_have_these_names_and_no_others(name):
    view = view_of(name)
    assert {each for each in vars(view) if not each.startswith("_")} == VIEWS[name]
    assert all(getattr(view, each).__doc__ for each in VIEWS[name])


def test_the_list_does_not_grow_in_silence():
    """There were 166 paths and names before; views must not grow instead.

    ``check_laws`` came with force laws of users, whose errors compiled loops cannot raise,
    ``switch`` and ``kinetic`` with events, ``acts`` and ``factor`` with events that do not happen
    if their actions change nothing, ``scale`` with controllers, ``look_at`` with quadratures of
    work within a step, ``SmallMotions`` with several analyses that share the result of
    ``small_motions``, ``friction_forces`` with friction in results, ``activity`` with files of
    divided scenes, ``of_bodies`` with initial velocities that solvers give to bodies, ``last`` with
    drives and motions that are defined during the run only.
    """
    names = len(RECORDS.union(*VERBS.values()) | IMPORTED | COMPILED)
    assert names <= 36
    assert names + sum(map(len, VIEWS.values())) <= 74
