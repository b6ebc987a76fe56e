"""Tests, demos, studies and what the how-to pages show use public names alone.

Public are :mod:`fem_lie` itself and its namespaces, such as :mod:`fem_lie.joints`: who moves a file
inside the package, or renames what is in it, need change no test of public behaviour. Tests of
linear algebra, of compiled kernels and of the machine code look at these directly.
"""

import ast
from pathlib import Path
from types import ModuleType

import pytest

import fem_lie as fl

ROOT = Path(__file__).parents[1]
FOLDERS = "tests", "demos", "studies", "docs/how_to"
NAMESPACES = [name for name in fl.__all__ if isinstance(getattr(fl, name), ModuleType)]
PUBLIC = {
    "fem_lie": {*fl.__all__},
    **{f"fem_lie.{name}": {*getattr(fl, name).__all__} for name in NAMESPACES},
}

LINEAR_ALGEBRA = {
    "tests/test_schur.py",
    "tests/test_choice.py",
    "tests/test_condensed.py",
    "tests/test_domains.py",
    "tests/test_equilibrium_solvers.py",
    "tests/test_kkt.py",
    "tests/test_low_rank.py",
    "tests/test_memory.py",
    "tests/test_redundant.py",
    "tests/test_rotors.py",
    "tests/test_scales.py",
    "tests/test_secants.py",
    "tests/test_vibrations.py",
}
MACHINE_CODE = {
    "tests/test_jit.py",
    "tests/test_main.py",
    "tests/test_peers.py",
    "tests/test_renamed.py",
}
KERNELS = {
    "tests/models.py",
    "tests/shell_models.py",
    "tests/test_cell_sums.py",
    "tests/test_conserving_kernels.py",
    "tests/test_constraint_sets.py",
    "tests/test_detection.py",
    "tests/test_elements.py",
    "tests/test_free_bodies.py",
    "tests/test_attachment_frames.py",
    "tests/test_impacts.py",
    "tests/test_inertia.py",
    "tests/test_joints.py",
    "tests/test_node_types.py",
    "tests/test_lie.py",
    "tests/test_records.py",
    "tests/test_reduction_kernels.py",
    "tests/test_shapes.py",
    "tests/test_shell_elements.py",
    "tests/test_sliding.py",
    "tests/test_small_energy.py",
    "tests/test_small_kernels.py",
    "tests/test_step_loops.py",
    "tests/test_terms.py",
}
INSIDE = LINEAR_ALGEBRA | MACHINE_CODE | KERNELS
FILES = {
    path.relative_to(ROOT).as_posix(): path
    for folder in FOLDERS
    for path in sorted((ROOT / folder).rglob("*.py"))
}


def inner_names(path: Path) -> list[str]:
    """What a file takes from inside the package: imports, and the system behind equations."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
            found += [m for m in modules if m.startswith("fem_lie.") and m not in PUBLIC]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "fem_lie":
            known = PUBLIC.get(node.module or "", set())
            taken = [alias.name for alias in node.names if alias.name not in known]
            found += [f"{node.module}.{name}" for name in taken]
        elif isinstance(node, ast.Attribute) and node.attr == "system":
            found.append(f"line {node.lineno}: .system")
    return found


@pytest.mark.parametrize("file", sorted(FILES.keys() - INSIDE))
def test_a_file_uses_public_names_alone(file):
    assert inner_names(FILES[file]) == [], "expected names of fem_lie or one of its namespaces"


@pytest.mark.parametrize("file", sorted(INSIDE))
def test_a_file_is_in_the_lists_because_it_looks_inside(file):
    assert inner_names(FILES[file]), "take it from the lists"


def test_the_lists_do_not_grow():
    assert len(INSIDE) <= 40


def test_names_inside_are_noticed(tmp_path):
    file = tmp_path / "one.py"
    file.write_text(
        "import fem_lie as fl\nimport fem_lie.solve\nfrom fem_lie import lie, _jit, Beam\n"
        "from fem_lie.lie import exp_se3\nfrom fem_lie.lie.node_types import move\n"
        "x = fl.extend.Equations.system\n",
        encoding="utf-8",
    )
    assert sorted(inner_names(file)) == [
        "fem_lie._jit",
        "fem_lie.lie.node_types.move",
        "fem_lie.solve",
        "line 6: .system",
    ]
