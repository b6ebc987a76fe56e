"""Which files gmsh reads: meshes and CAD; a script runs only where it is asked for by name."""

import gmsh
import numpy as np
import pytest

import fem_lie as fl
from tests.drawn import empty_model

READERS = {
    "read_gmsh": fl.mesh.read_gmsh_lines,
    "read_gmsh_surface": fl.mesh.read_gmsh_surface,
    "read_gmsh_volume": fl.mesh.read_gmsh_volume,
    "SectionMesh.from_gmsh": fl.sections.SectionMesh.from_gmsh,
    "read_curve": lambda path: fl.mesh.read_curve(path, 4),
}
LINE = 'Point(1)={0,0,0}; Point(2)={1,0,0}; Line(1)={1,2}; Physical Curve("a")={1};\n'
BEGINNINGS = ["", "\n$MeshFormat\n", "// $MeshFormat\n", "$mesh\n"]
NAMES = ["line.msh", "line.geo", "line.geo_unrolled", "line.Step", "line.pos", "line"]


def script(file, beginning=""):
    """A script that leaves a mark when it runs: the file, and the mark."""
    mark = file.with_name("executed")
    file.write_text(f'{beginning}SystemCall "touch {mark}";\n{LINE}')
    return file, mark


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("read", READERS)
def test_no_reader_runs_a_script(tmp_path, read, name):
    file, mark = script(tmp_path / name)
    with pytest.raises(
        ValueError, match=rf"{name}' is neither .*fl\.mesh\.run_gmsh_script\(path\)"
    ):
        READERS[read](file)
    assert not mark.exists()


@pytest.mark.parametrize("beginning", BEGINNINGS)
def test_only_the_first_bytes_make_a_mesh(tmp_path, beginning):
    file, mark = script(tmp_path / "line.msh", beginning)
    with pytest.raises(ValueError, match=r"is neither a mesh of gmsh"):
        fl.mesh.read_gmsh_lines(file)
    assert not mark.exists()


def test_a_script_after_the_beginning_of_a_mesh_does_not_run(tmp_path):
    file, mark = script(tmp_path / "line.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    with pytest.raises(ValueError, match=r"line\.msh"):
        fl.mesh.read_gmsh_lines(file)
    assert not mark.exists()


def line_in(file):
    """A line of length 1 in a file, whose ending says the format."""
    with empty_model() as session:
        ends = [session.model.occ.addPoint(x, 0, 0) for x in (0, 1)]
        session.model.occ.addLine(*ends)
        session.model.occ.synchronize()
        session.model.mesh.generate(1)
        session.write(str(file))
    return file


def test_options_beside_a_mesh_do_not_run(tmp_path):
    """gmsh runs ``NAME.opt`` with ``NAME``."""
    file = line_in(tmp_path / "line.msh")
    _, mark = script(tmp_path / "line.msh.opt")
    assert fl.mesh.read_gmsh_lines(file).points[:, 0].max() == 1
    assert not mark.exists()


@pytest.mark.parametrize("name", ["line.mesh of mine", "line.step", "line"])
def test_a_mesh_may_have_any_name(tmp_path, name):
    file = line_in(tmp_path / "line.msh").rename(tmp_path / name)
    assert fl.mesh.read_gmsh_lines(file).points[:, 0].max() == 1


@pytest.mark.parametrize("name", ["line", "line.STEP", "line.msh"])
@pytest.mark.parametrize("ending", ["step", "brep"])
def test_cad_is_known_by_its_content(tmp_path, ending, name):
    file = line_in(tmp_path / f"line.{ending}").rename(tmp_path / name)
    assert fl.mesh.read_curve(file, 4).positions[-1] == pytest.approx([1, 0, 0])
    assert np.ptp(fl.mesh.read_gmsh_lines(file).points[:, 0]) == pytest.approx(1)


def test_iges_is_known_by_its_content(tmp_path):
    with empty_model() as session:
        session.model.occ.addRectangle(0, 0, 0, 2, 1)
        session.model.occ.synchronize()
        session.write(str(tmp_path / "face.iges"))
    assert np.ptp(fl.mesh.read_gmsh_surface(tmp_path / "face.iges").points[:, 0]) == pytest.approx(
        2
    )


def test_a_script_runs_where_it_is_asked_for(tmp_path):
    file, mark = script(tmp_path / "line.geo")
    wanted = fl.mesh.run_gmsh_script(file)
    assert fl.mesh.read_gmsh_lines(wanted).points[:, 0].max() == 1
    assert mark.exists() and not gmsh.isInitialized()


def test_an_empty_file_is_named(tmp_path):
    (tmp_path / "line.msh").touch()
    with pytest.raises(ValueError, match=r"line\.msh' is neither .* it begins with b''"):
        fl.mesh.read_gmsh_lines(tmp_path / "line.msh")
