"""Small numerical kernels, whose degenerate cases no input of users reaches one by one."""

import numpy as np

import fem_lie as fl
from fem_lie.mesh.shapes import turn, turned_round
from fem_lie.results.stresses.nodal_values import planes
from fem_lie.sections.warping import WarpingFields

STEEL = fl.Material(2.1e11, 0.3, 7850.0)


def test_cells_with_two_common_edges_are_turned_once():
    """Two quadrilaterals around the corner 4 that they share with both neighbours of it.

    DOLFINx 0.9 cannot make a mesh of them.
    """
    cells = np.array([[0, 1, 3, 4], [5, 3, 1, 4]])
    for second in ([5, 3, 1, 4], [5, 1, 3, 4]):
        cells[1] = second
        turned = turned_round(cells, "quadrilateral")
        ways = []  # along the edge from 1 to 4 one goes on, and the other comes back
        for cell in turn(cells, "quadrilateral", turned):
            around = [cell[k] for k in (0, 1, 3, 2)]
            at = around.index(1)
            ways.append(around[(at + 1) % 4] == 4)
        assert sorted(ways) == [False, True] and not turned[0]


def test_motion_by_poissons_ratio_is_no_shear():
    """What Love's solution leaves open, a rigid motion of the section, does not change Γ."""
    mesh = fl.sections.SectionShape.l_section(0.1, 0.15, 0.012).mesh
    size = np.ptp(mesh.points)
    fields = WarpingFields(mesh, mesh.points / size, [STEEL], 3)
    torsion = fields.torsion()
    y, z = fields.r
    a = np.array([y * y, y * z])
    strain = fields.shear_strain(y, a, torsion)
    moved = a + np.array([0.3 - 0.7 * z, -0.2 + 0.7 * y])
    np.testing.assert_allclose(fields.shear_strain(y, moved, torsion), strain, rtol=1e-9)


def test_values_at_edges_are_those_of_planes():
    """Exact for what is linear; along a line, or with one point, flat across."""
    rng = np.random.default_rng(2)
    positions, slope = rng.normal(size=(9, 2)), np.array([[2.0, -1.0], [0.5, 3.0]])
    positions[5:8] = np.outer([1.0, 2.0, 4.0], [1.0, 0.0])
    which = np.array([0, 0, 0, 0, 0, 1, 1, 1, 2])
    values = positions @ slope.T + [1.0, 7.0]
    found = planes(which, positions, values, 3)
    np.testing.assert_allclose(found, [[1, 7], [1, 7], values[8]], atol=1e-12)
