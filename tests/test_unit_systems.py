"""The converter of units, and laws that hold in each system."""

import numpy as np
import pytest

from tests.unit_systems import METRES, MILLIMETRES, UNIT_SYSTEMS


def test_newtons_stay_newtons_in_millimetres_and_tonnes():
    assert MILLIMETRES.force(3.0) == pytest.approx(3.0)
    assert MILLIMETRES.stress(2e11) == pytest.approx(2e5)  # MPa
    assert MILLIMETRES.density(7800.0) == pytest.approx(7.8e-9)


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_there_and_back(u):
    x = np.arange(1.0, 7.0)
    for name in ("length", "force", "moment", "twist", "wrench", "inertia", "bending", "damping"):
        there = getattr(u, name)
        back = getattr(u.inverse, name)
        np.testing.assert_allclose(back(there(x)), x, rtol=1e-14)
        assert not np.shares_memory(there(x), x)
    matrix = np.add.outer(x, x)
    stiff = u.section_stiffness(matrix)
    np.testing.assert_allclose(stiff[0, 0], u.force(matrix[0, 0]))
    np.testing.assert_allclose(stiff[0, 4], u.moment(matrix[0, 4]))
    np.testing.assert_allclose(stiff[4, 4], u.bending(matrix[4, 4]))
    assert METRES.time(2.0) == 2.0
