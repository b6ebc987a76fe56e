"""What is imported when: public names import their modules when they are first used."""

import subprocess
import sys
from inspect import ismodule
from pathlib import Path

import pytest

import fem_lie as fl

DRAWING = "matplotlib", "pyvista", "vtkmodules", "gmsh", "h5py", "PIL", "imageio", "pandas"
HEAVY = *DRAWING, "scipy", "numba", "slepc4py", "dolfinx"
NAMESPACES = [fl, *(each for name in fl.__all__ if ismodule(each := getattr(fl, name)))]


def imported_by(code: str) -> set[str]:
    """Names of the modules that a script imports."""
    command = [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return {*run.stdout.split()}


def own(modules: set[str]) -> set[str]:
    return {name for name in modules if name.partition(".")[0] == "fem_lie"}


def test_the_import_brings_nothing_heavy_and_nothing_of_the_package():
    modules = imported_by("import fem_lie")
    assert not modules & {*HEAVY}
    assert len(own(modules)) <= 6


def test_a_scene_imports_no_drawing_library_and_no_scheme():
    modules = imported_by("import fem_lie as fl; fl.Scene, fl.Beam, fl.Section, fl.post.Page")
    assert not modules & {*DRAWING}
    assert not {m for m in modules if m.startswith(("fem_lie.solve", "fem_lie.adaptivity"))}
    assert not {m for m in modules if m.startswith(("urllib.request", "http.client", "ssl"))}


def test_a_section_imports_no_body_and_a_scheme_no_other_one():
    modules = own(imported_by("import fem_lie as fl; fl.Section, fl.sections.Damping"))
    assert not {m for m in modules if m.startswith(("fem_lie.bodies", "fem_lie.scene"))}
    modules = own(imported_by("import fem_lie as fl; fl.GeneralisedAlpha"))
    assert "fem_lie.solve.alpha.generalised_alpha" in modules
    assert not {
        m for m in modules if m.startswith(("fem_lie.solve.explicit", "fem_lie.solve.hamel"))
    }


@pytest.mark.parametrize("namespace", NAMESPACES, ids=lambda module: module.__name__)
def test_the_imports_of_a_namespace_are_its_public_names(namespace):
    shown = {name for name in dir(namespace) if not name.startswith("_")}
    others = shown - {*namespace.__all__} - {"TYPE_CHECKING", "public_names"}
    assert shown >= {*namespace.__all__}
    assert [name for name in others if not ismodule(getattr(namespace, name))] == []


@pytest.mark.parametrize("namespace", NAMESPACES, ids=lambda module: module.__name__)
def test_no_public_name_is_that_of_a_module_in_the_same_folder(namespace):
    """Else the import of the module would set the name."""
    names = {name for name in namespace.__all__ if not ismodule(getattr(namespace, name))}
    folders = [Path(path) for path in getattr(namespace, "__path__", ())]
    assert not names & {path.stem for folder in folders for path in folder.iterdir()}


def test_names_of_another_order_of_imports_are_the_same_objects():
    code = (
        "import fem_lie.solve.statics.statics as inside, fem_lie.reduction.energy_sampling\n"
        "import fem_lie as fl, pickle\n"
        "from fem_lie.reduction import ecsw\n"
        "from fem_lie import statics, joints\n"
        "assert fl.statics is statics and statics.__wrapped__ is inside.statics\n"
        "assert fl.reduction.ecsw is ecsw and callable(ecsw)\n"
        "assert joints is fl.joints\n"
        "assert pickle.loads(pickle.dumps(ecsw)) is ecsw\n"
        "assert pickle.loads(pickle.dumps(fl.joints.Revolute)) is joints.Revolute\n"
    )
    imported_by(code)


def test_objects_of_classes_that_a_script_does_not_name_explain_wrong_arguments():
    code = (
        "import fem_lie as fl\n"
        "fl.statics\n"
        "from fem_lie.results.equilibrium import StaticResult\n"
        "try:\n"
        "    StaticResult(nonsense=1)\n"
        "except TypeError as error:\n"
        "    assert str(error).startswith('StaticResult has no argument'), error\n"
        "else:\n"
        "    raise AssertionError\n"
    )
    imported_by(code)


def test_a_compiled_function_that_was_called_before_explains_wrong_arguments():
    code = (
        "import numpy as np\n"
        "from fem_lie.lie.se3 import exp_se3\n"
        "exp_se3(np.zeros(6), np.empty((4, 3)))\n"
        "import fem_lie as fl\n"
        "try:\n"
        "    fl.lie.exp_se3(nonsense=1)\n"
        "except TypeError as error:\n"
        "    assert str(error).startswith('exp_se3 has no argument'), error\n"
        "else:\n"
        "    raise AssertionError\n"
    )
    imported_by(code)


def test_all_names_can_be_imported_with_a_star_and_helped_with():
    code = (
        "import contextlib, io, pydoc\n"
        "import fem_lie\n"
        "with contextlib.redirect_stdout(io.StringIO()) as text:\n"
        "    help('fem_lie.joints')\n"
        "assert 'class Revolute' in text.getvalue()\n"
        "from fem_lie import *\n"
        "assert Scene is fem_lie.Scene and joints.Revolute\n"
    )
    imported_by(code)
