"""Which package may import which, and that no imports are circular.

Imports are read from the sources, including those within functions and those for type hints only.
"""

import ast
from functools import cache
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path

import pytest

import fem_lie

PACKAGE = Path(fem_lie.__file__).parent
MOST_FILES = 12
OUTSIDE = {
    "__init__",
    "__main__",
    "_arguments",
    "_arrays",
    "_blas",
    "_compat",
    "_ffcx_warnings",
    "_form_cache",
    "_form_structure",
    "_precompile",
    "_public_names",
    "_renamed",
    "_state",
    "_summary",
}

COMMON = {
    "_arguments",
    "_arrays",
    "_blas",
    "_compat",
    "_ffcx_warnings",
    "_form_cache",
    "_form_structure",
    "_jit",
    "_public_names",
    "_renamed",
    "_state",
    "_summary",
}
"""Modules that every package may import."""

MAY_IMPORT = {
    "lie": set(),
    "lie.node_types": {"lie"},
    "ranks": set(),
    "linear.condensed": {"ranks"},
    "linear.domains": {"ranks"},
    "linear": {"linear.domains", "linear.condensed"},
    "linear.spectra": {"linear", "ranks"},
    "mesh": {"lie"},
    "mesh.bicubic": {"mesh"},
    "sections": {"mesh"},
    "sections.distortion": {"sections"},
    "attachments": {"forms"},
    "forms.kernels": set(),
    "forms": {"forms.kernels", "lie.node_types"},
    "forms.problems": {"forms"},
    "forms.small_energy": {"forms"},
    "elements.beams": {"forms", "attachments"},
    "elements.shells": {"forms.small_energy", "mesh"},
    "elements.rods": {"elements.beams", "forms.small_energy"},
    "elements.solids": {"forms", "sections"},
    "elements.membranes": {"elements.solids"},
    "elements.gradients": {"elements.rods", "elements.thin_shells"},
    "elements.thin_shells": {"forms.small_energy", "mesh.bicubic"},
    "bodies": {"forms", "attachments", "sections"},
    "bodies.beams": {"bodies", "elements.beams", "sections"},
    "bodies.shells": {"bodies", "elements.shells", "sections"},
    "bodies.reduced": {"bodies"},
    "bodies.rods": {"bodies.beams", "elements.rods"},
    "bodies.solids": {"bodies.beams", "elements.solids", "mesh"},
    "bodies.membranes": {"bodies.beams", "bodies.shells", "elements.membranes"},
    "bodies.thin_shells": {"bodies.beams", "elements.thin_shells"},
    "bodies.cells": {"bodies.beams", "forms.small_energy"},
    "bodies.distorting": {"bodies.cells", "sections.distortion"},
    "bodies.forms": {"bodies.beams", "forms.problems"},
    "bodies.gradients": {"bodies.cells", "bodies.thin_shells", "elements.gradients"},
    "joints.equations": {"lie"},
    "joints": {"joints.equations", "bodies.beams"},
    "events": {"joints"},
    "contact.sides": {"bodies.beams", "forms.small_energy"},
    "contact.convex": {"contact.sides"},
    "contact.laws": {"contact.sides"},
    "contact.rings": {"contact.laws"},
    "contact.pairs": {"contact.rings", "contact.convex", "bodies.shells", "bodies.thin_shells"},
    "contact.mortar": {"contact.pairs", "bodies.solids", "joints"},
    "contact": {"contact.mortar"},
    "contact.cones": {"lie.node_types"},
    "contact.impact": {"contact", "contact.cones"},
    "pictures": {"bodies.beams", "ranks"},
    "pictures.page": {"pictures"},
    "scene": {
        "events",
        "contact",
        "pictures",
        "bodies.forms",
        "bodies.gradients",
        "bodies.membranes",
        "bodies.rods",
        "bodies.shells",
        "bodies.solids",
        "bodies.thin_shells",
        "ranks",
    },
    "parts": {"scene", "linear.domains"},
    "system.nodes": {"parts", "linear.spectra"},
    "system.constraint_sets": {"system.nodes", "linear.spectra"},
    "system.terms": {"system.constraint_sets"},
    "system": {"system.terms"},
    "system.equations": {"system"},
    "results.files": {"bodies", "pictures", "ranks"},
    "results": {"parts", "pictures.page", "results.files"},
    "results.stresses": {"results"},
    "results.vibrations": {"results"},
    "solve": {"system.equations", "results.stresses"},
    "solve.statics": {"solve"},
    "solve.stability": {"solve.statics", "solve.recording", "results.vibrations"},
    "solve.small_motions": {"solve.stability"},
    "solve.recording": {"solve"},
    "adaptivity.estimates": {"results.stresses"},
    "adaptivity": {"solve.stability", "adaptivity.estimates"},
    "adaptivity.following": {"adaptivity", "solve.alpha"},
    "reduction": {"adaptivity.following", "bodies.distorting", "bodies.reduced"},
    "solve.motion": {"solve.recording"},
    "solve.impacts": {"solve", "contact.impact"},
    "solve.alpha.step": {"solve.motion", "contact.impact"},
    "solve.alpha": {"solve.alpha.step", "solve.impacts"},
    "solve.conserving.midpoint": {"solve.motion"},
    "solve.conserving.vector_cells": {"solve.conserving.midpoint"},
    "solve.conserving.step": {"solve.conserving.vector_cells"},
    "solve.conserving.python_forces": {"solve.conserving.step"},
    "solve.conserving": {"solve.conserving.python_forces"},
    "solve.variational": {"solve.conserving.step", "solve.impacts"},
    "solve.explicit": {"solve.motion", "solve.impacts"},
    "solve.composed": {"solve.conserving", "solve.variational"},
    "solve.multirate": {"solve.conserving", "solve.explicit"},
    "solve.hamel": {"solve.conserving.midpoint"},
    "solve.trees": {"solve.motion"},
}
"""Packages and what each may import directly; imports are transitive."""

PROGRAMS = ("__main__",), ("_precompile",)
NAMESPACES = {(f"{name}",) for name in ("extend", "loads", "post", "schemes", "stability")} | {
    (name, "__init__")
    for name in ("adaptivity", "contact", "elements", "joints", "mesh", "reduction", "sections")
}


def modules():
    """Source files by module name; an ``__init__`` has the name of its package."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts in PROGRAMS or parts in NAMESPACES:
            continue  # programs and names for users, which no package imports
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


def import_all():
    """Import all modules, which public names import only when they are used."""
    for module in MODULES:
        import_module(f"{PACKAGE.name}.{module}".rstrip("."))


def package_of(module):
    """Package of a module; a module at the top level is a package of its own."""
    return module if module in MAY_IMPORT else module.rpartition(".")[0] or module


def imports_of(module):
    """Modules of ``fem_lie`` that a module imports, also within functions and for type hints."""
    found = set()
    for node in ast.walk(ast.parse(MODULES[module].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: expected absolute imports"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            package, _, inside = name.partition(".")
            if package == PACKAGE.name:
                found.add(inside if inside in MODULES else inside.rpartition(".")[0])
    return found - {""}


@cache
def all_imports():
    """Modules that each module imports, read when they are asked for."""
    return {module: imports_of(module) for module in MODULES}


def allowed(package):
    """All packages that a package may import, directly or not."""
    found, left = {package} | COMMON, [package]
    while left:
        for lower in MAY_IMPORT[left.pop()] - found:
            found.add(lower)
            left.append(lower)
    return found


def test_all_packages_are_in_the_table():
    packages = {package_of(module) for module in MODULES if module} - COMMON
    assert packages == set(MAY_IMPORT)


def test_modules_at_the_top_level():
    namespaces = {name[0] for name in NAMESPACES if len(name) == 1}
    assert {path.stem for path in PACKAGE.glob("*.py")} == OUTSIDE | namespaces


def test_no_package_imports_a_public_namespace():
    found = {
        f"{module} imports {other}"
        for module, others in all_imports().items()
        for other in others
        if module and (other, "__init__") in NAMESPACES
    }
    assert not found


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_no_arrow_up(package):
    up = {
        f"{module} imports {other}"
        for module, others in all_imports().items()
        for other in others
        if module and package_of(module) == package and package_of(other) not in allowed(package)
    }
    assert not up


@pytest.mark.parametrize("package", sorted(COMMON))
def test_common_modules_import_only_each_other(package):
    inside = [module for module in MODULES if package_of(module) == package]
    assert inside
    assert {package_of(other) for module in inside for other in all_imports()[module]} <= COMMON


def calls_of_cpp_layer(path):
    """Names of DOLFINx's C++ layer that a file uses: it differs between versions."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    used = [node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            package = getattr(node, "module", None) or ""
            used += [f"{package}.{alias.name}" for alias in node.names]
    return [name for name in used if {"_cpp_object", "cpp"} & {*name.split(".")}]


def test_only_compat_calls_the_cpp_layer_of_dolfinx():
    users = {path.stem for path in PACKAGE.rglob("*.py") if calls_of_cpp_layer(path)}
    assert users == {"_compat"}


def test_no_circle_of_files():
    try:
        TopologicalSorter(all_imports()).prepare()
    except CycleError as error:
        pytest.fail(" → ".join(reversed(error.args[1])))


def test_no_circle_of_packages():
    packages = {package: set() for package in MAY_IMPORT}
    for module, others in all_imports().items():
        if module and package_of(module) not in COMMON:
            own = package_of(module)
            packages[own] |= {package_of(other) for other in others} - {own}
    try:
        TopologicalSorter(packages).prepare()
    except CycleError as error:
        pytest.fail(" → ".join(reversed(error.args[1])))


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_are_small(package):
    files = PACKAGE.joinpath(*package.split(".")).glob("*.py")
    assert len([path for path in files if path.stem != "__init__"]) <= MOST_FILES
