"""The demos of buckling give the numbers that they print; coarser and shorter than they run."""

import importlib
from types import ModuleType

import pytest

import fem_lie as fl


def demo(name: str) -> ModuleType:
    return importlib.import_module(f"demos.{name}")


def test_deep_arch_has_the_limit_loads_of_the_shooting_method():
    record = demo("deep_arch").main(pictures=False)
    assert abs(record["limit_error"]) <= 3e-3
    assert abs(record["lower_limit_error"]) <= 3e-3
    assert record["negative_pivots"] == [0, 1, 1, 0]
    assert record["bifurcation_loads"] == []


def test_round_arch_leaves_its_plane_first():
    record = demo("deep_arch").main(elements=20, round=True, pictures=False)
    assert record["bifurcation_loads"][0] == pytest.approx(244.0, rel=0.01)
    assert record["negative_pivots"] == [1, 2, 2, 1]


@pytest.mark.parametrize("thickness", [6.35, 12.7])
def test_hinged_roof_snaps(thickness):
    record = demo("hinged_roof").main(thickness=thickness, mesh=8, pictures=False)
    # 16 cells: within 0.5 %
    assert abs(record["limit_error"]) <= 0.025
    assert abs(record["lower_limit_error"]) <= 0.03
    assert record["negative_pivots"] == [0, 1, 1, 0]
    assert record["snap_back"] is (thickness == 6.35)


def test_euler_columns_buckle_at_eulers_loads_both_ways():
    record = demo("euler_column").main(pictures=False)
    assert record["max_error"] <= 1e-3
    for ends in ("fixed-free", "pinned-pinned", "fixed-pinned", "fixed-fixed"):
        found = record[ends]
        assert found["critical_load"] == pytest.approx(found["linear_buckling"], rel=1e-3)
        assert found["negative_pivots"] == (0, 1)
        low, high = found["bracket"]
        assert abs(high - low) <= 1e-6 * low
        if ends != "fixed-pinned":
            assert abs(found["deflection_error"]) <= 1e-3
    assert record["fixed-pinned"]["branch_limit"] == pytest.approx(1.14, abs=0.01)


@pytest.mark.parametrize(("mesh", "bound"), [("24x16", 0.01), ("36x24", 0.005)])
def test_pulled_cylinder_arrives_in_a_few_steps(mesh, bound):
    record = demo("pulled_cylinder").main(mesh=mesh, pictures=False)
    assert record["max_error"] <= bound
    assert record["iterations"] <= 40


@pytest.mark.parametrize("resolution", [0.05, 0.16, 0.3])
def test_pulled_cylinder_snaps_within_one_step(resolution):
    """Its load falls by half a per cent only, and both turns may lie between two states."""
    module = demo("pulled_cylinder")
    # a cell beside the force turns by 82 degrees
    with pytest.warns(fl.schemes.CoarseElementsWarning):
        path = fl.follow_path(module.cylinder(12, 8), 0.6, resolution=resolution)
    upper, lower = path.limits
    assert (upper.negative_pivots, lower.negative_pivots) == ((0, 1), (1, 0))
    # 16x12 … 48x32: 0.3-0.65 % lower, the more the coarser
    assert 0.003 <= 1 - lower.factor / upper.factor <= 0.012
    assert upper.factor == pytest.approx(0.4923, rel=1e-3)


def test_strips_and_profiles_tip_over():
    record = demo("lateral_torsional").main(mesh=16, pictures=False)
    assert record["max_error"] <= 1e-3
    for name in ("strip", "I-beam", "plate"):
        assert record[name]["negative_pivots"] == (0, 1)
        assert record[name]["kind"] == "bifurcation"
    assert abs(record["strip"]["difference"]) <= 1e-3
    assert record["I-beam"]["path"] == pytest.approx(record["expected_raise"], rel=5e-3)


def test_compressed_cylinder_bears_the_classical_load_if_perfect():
    module = demo("compressed_cylinder")
    for ratio in (100.0, 1000.0):
        modes = fl.buckling(module.cell(1 / ratio, 8), 2)
        assert abs(modes.factors[0] - 1.0) <= 0.03
    t = 0.01
    out_of_shape = fl.stability.apply_imperfections(module.cell(t, 6), module.rings(t, 0.1 * t))
    path = fl.follow_path(out_of_shape, fl.stability.PathEnds(critical_points=1))
    assert path.critical[0].factor == pytest.approx(module.koiter(0.1), rel=0.1)


def test_knock_down_by_a_mode_is_koiters():
    """One cell of one width; all of them by the demo itself."""
    module = importlib.import_module("studies.cylinder_knock_down")
    # the formula's own limit
    assert module.koiter_pattern(1e-3)[0] == pytest.approx(module.koiter(1e-3), rel=1e-3)
    theory, tau = module.koiter_pattern(0.5)
    found = module.knock_down(100.0, 5, 0.5, tau)
    assert found["amplitude_error"] <= 1e-10
    assert found["load"] == pytest.approx(theory, abs=0.015)


def test_located_load_is_where_the_smallest_eigenvalue_is_zero():
    """The root of a polynomial through its values at 7 to 12 states far from the bifurcation."""
    module = importlib.import_module("studies.cylinder_knock_down")
    _, tau = module.koiter_pattern(0.1)
    found = module.knock_down(500.0, 6, 0.1, tau)
    assert found["kind"] == "bifurcation"
    assert found["load"] == pytest.approx(0.58164370427, rel=5e-7)


@pytest.mark.parametrize(("ratio", "mesh"), [(100.0, 4), (1000.0, 5)])
def test_close_states_stay_on_the_path_between_two_bifurcations(ratio, mesh):
    """States this near to a bifurcation could converge to the crossing path, and add limits."""
    scene = demo("thin_cylinder").cell(1 / ratio, mesh)
    ends = fl.stability.PathEnds(1.1, critical_points=2)
    coarse = fl.follow_path(scene, ends)
    tight = fl.stability.ArcLength(tolerance=1e-11)
    fine = fl.follow_path(
        scene, ends, options=fl.stability.PathOptions(locate=1e-8, arc_length=tight)
    )
    for path in (coarse, fine):
        assert [point.negative_pivots for point in path.bifurcations] == [(0, 1), (1, 2)]
        assert not path.limits
    loads = [[point.factor for point in path.critical] for path in (coarse, fine)]
    assert loads[0] == pytest.approx(loads[1], rel=5e-7)
    assert fine.locating_iterations <= 3 * coarse.locating_iterations


def test_spherical_cap_snaps_where_its_meridian_does():
    record = demo("spherical_cap").main(mesh=10, pictures=False)
    assert abs(record["error"]) <= 5e-3
    assert record["shallow"] == pytest.approx(record["reference"], rel=5e-3)
    assert record["negative_pivots"] == [(0, 1), (1, 0)]


def test_meridian_of_a_shallow_cap_obeys_reissners_equations(monkeypatch):
    """What the shallow theory leaves out is of the order (H/a)^2: at 0.05 they differ by 3.4e-3."""
    module = demo("reference.spherical_cap")
    monkeypatch.setattr(module, "RISE", 0.01)
    monkeypatch.setattr(module, "RADIUS", (1 + 0.01**2) / 0.02)
    t = module.thickness_of(5.0)
    found, wanted = (module.largest(*f(t)) for f in (module.exact, module.reissner))
    assert found == pytest.approx(wanted, rel=1e-3)


def test_bistable_strip_rests_in_two_shapes():
    record = demo("bistable_strip").main(elements=24, pictures=False)
    assert record["stable_at_rest"]
    assert abs(record["rest_deviation"]) <= 0.01
    # the theory superposes modes of a straight strip
    for name in ("top", "bottom", "turning"):
        assert abs(record[f"{name}_deviation"]) <= 0.06
    assert -20.0 <= record["turning_bottom"] <= 0.0


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("deep_arch", {"variant": "soft"}),
        ("deep_arch", {"elements": 5}),
        ("hinged_roof", {"thickness": 1.0}),
        ("euler_column", {"elements": 3}),
        ("pulled_cylinder", {"mesh": "24"}),
        ("spherical_cap", {"number": 9.0}),
        ("bistable_strip", {"q": 2.0}),
    ],
)
def test_bad_options_are_refused(name, options):
    with pytest.raises(ValueError):
        demo(name).main(pictures=False, **options)
