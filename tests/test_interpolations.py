"""Studies of interpolations, and of the tangent over the mesh."""

import pytest

from studies import interpolations, tangent_over_mesh

LAWS = {
    "cardan_angles": {"orthonormal"},
    "rotation_vectors": {"orthonormal", "tensorial"},
    "directors": {"objective", "tensorial", "intrinsic"},
    "directors_polar": {"orthonormal", "objective", "tensorial"},
    "relative_rotation": {"orthonormal", "objective", "tensorial"},
    "relative_motion": {"orthonormal", "objective", "tensorial", "intrinsic"},
}


def test_laws_of_interpolations():
    """Each holds to round-off, or is violated by a tenth and more."""
    record = interpolations.main()
    for name, laws in LAWS.items():
        found = {law: record[name][law] for law in LAWS["relative_motion"]}
        assert {law for law, value in found.items() if value < 1e-13} == laws
        assert all(value > 0.1 for law, value in found.items() if law not in laws)
    assert record["relative_motion"]["error"] < 1e-14
    assert record["relative_rotation"]["order"] == pytest.approx(2.0, abs=0.05)
    assert record["incremental_rotation_vectors"]["path_dependence"] > 0.1


@pytest.mark.parametrize("name", ["geodesic_beam", "director_beam_2"])
def test_the_tangent_tends_to_a_constant(name):
    """With 1/n in the nodes' axes, and not at all along fixed ones."""
    make = tangent_over_mesh.BODIES[name]
    coarse, fine = (tangent_over_mesh.compared(make, cells) for cells in (8, 16))
    assert fine["local"] / coarse["local"] == pytest.approx(0.5, abs=0.02)
    assert fine["local"] < 0.1
    assert fine["fixed"] > 0.5
    # whatever the mesh, an arch is not a straight strip
    assert fine["rate_long"] > 1.0
