"""The pieces of benchmarks/peers.py, without the peers: scenes in numbers are ours, and so on."""

import json
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem_lie as fl
from benchmarks import everyday, peers, scale
from benchmarks.everyday_rows.plate import plate
from benchmarks.everyday_rows.row import Outcome, Unavailable
from benchmarks.everyday_rows.row import Row as EverydayRow
from benchmarks.peer_scenes import (
    contacts,
    descriptions,
    environment,
    ours,
    processes,
    report,
    rigid_peers,
)
from benchmarks.peer_scenes.comparisons import COMPARISONS
from benchmarks.peer_scenes.report import Row
from demos.double_pendulum import pendulum
from demos.free_rigid_body import SPIN, spinning
from demos.hemisphere import pinched, quarter
from demos.rod_in_box import rod_in_box
from demos.rollup import cantilever
from fem_lie import _blas
from fem_lie._jit import progress
from fem_lie.solve import progress_bars


def assert_same_beam(given, beam, **tolerance):
    points_at, frames = np.array(given["places"]), np.array(given["frames"])
    np.testing.assert_allclose(points_at, beam.frames[:, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(frames, beam.frames[:, 1:].transpose(0, 2, 1), rtol=0, atol=1e-9)
    np.testing.assert_allclose(beam.model.lengths, given["element_length"], rtol=1e-12)
    np.testing.assert_allclose(
        beam.model.stiffness, [np.diag(given["stiffness"])] * len(beam.model.lengths)
    )


@pytest.mark.parametrize("case", [1, 2, 3])
def test_double_pendulum_is_that_of_the_demo(case):
    given, (scene, *beams) = descriptions.double_pendulum(case, 4), pendulum(case, 4)
    for described, beam in zip(given["beams"], beams, strict=True):
        assert_same_beam(described, beam)
        mass_matrix = fl.sections.director_mass_matrix(described["mass"], described["inertia"])
        np.testing.assert_allclose(beam.model.density, [mass_matrix] * 4, rtol=1e-12, atol=1e-18)
        R = np.array(described["frames"])
        along = np.einsum("nji,nj->ni", R, described["velocities"])
        turning = R.transpose(0, 2, 1) @ described["spin"]
        np.testing.assert_allclose(beam.velocities, np.hstack([along, turning]), atol=1e-12)
    assert len(given["joints"]) == len(scene.joints)
    assert ("axis" in given["joints"][1]) == isinstance(scene.joints[1], fl.joints.Revolute)


def test_arc_and_cantilever_are_those_of_the_demos():
    assert_same_beam(descriptions.bend(5)["beams"][0], ours.arc(5, fl.elements.GeodesicBeam())[1])
    assert_same_beam(descriptions.roll(5, 1e6)["beams"][0], cantilever(5, 1e6)[1])


@pytest.mark.parametrize(
    ("given", "scene"),
    [
        (descriptions.chain(3), scale.chain(3)),
        (descriptions.spinning(), spinning(SPIN[np.newaxis])),
    ],
    ids=["chain", "free body"],
)
def test_rigid_bodies_are_ours(given, scene):
    for described, body in zip(given["bodies"], scene.bodies, strict=True):
        np.testing.assert_allclose(body.frames[0, 0], described["centre"], atol=1e-15)
        np.testing.assert_array_equal(body.frames[0, 1:], np.eye(3))
        mass_matrix = fl.sections.director_mass_matrix(described["mass"], described["inertia"])
        np.testing.assert_allclose(body.model.mass_matrix, mass_matrix, rtol=1e-12, atol=1e-18)
        np.testing.assert_allclose(body.velocities[0, 3:], described["spin"], atol=1e-15)
    assert len(given["joints"]) == len(scene.joints)
    np.testing.assert_array_equal(scene.gravity, given["gravity"])


@pytest.mark.parametrize(
    ("given", "mesh"),
    [
        (descriptions.pinched(0.04, 4), quarter(4)),
        (descriptions.plate(4), plate(4).bodies[0].model.mesh),
    ],
    ids=["hemisphere", "plate"],
)
def test_shells_have_the_nodes_and_cells_of_ours(given, mesh):
    positions = np.array(given["positions"])
    assert len(positions) == len(mesh.points)
    distances = np.linalg.norm(positions[:, np.newaxis] - mesh.points, axis=2)
    ours_of = distances.argmin(axis=1)
    size = np.ptp(positions, axis=0).max()
    assert distances.min(axis=1).max() < 1e-13 * size
    cells = {frozenset(ours_of[cell]) for cell in given["cells"]}
    assert cells == {frozenset(cell) for cell in mesh.cells}
    corners = positions[np.array(given["cells"])]
    edges = np.roll(corners, -1, axis=1) - corners
    turns = np.cross(edges, np.roll(edges, -1, axis=1))
    assert (turns @ np.cross(edges[:, 0], edges[:, 1])[:, :, np.newaxis] > 0).all()


def test_hemisphere_is_supported_and_pulled_as_ours_is():
    given = descriptions.pinched(0.04, 4)
    positions = np.array(given["positions"])
    np.testing.assert_allclose(positions[[0, 4]], [(10, 0, 0), (0, 10, 0)], atol=1e-12)
    for node, components in given["supports"][:-1]:  # the normal of a plane of symmetry
        assert positions[node, components[0]] == pytest.approx(0.0, abs=1e-12)
    (shell,) = (scene := pinched(0.04, quarter(4))).bodies
    for (node, force), load in zip(given["loads"], scene.loads, strict=True):
        at = shell.frames[load.point.node, 0]
        np.testing.assert_allclose(positions[node], at, atol=1e-12)
        np.testing.assert_allclose(force, load.force, rtol=1e-12)


def test_plate_is_clamped_and_loaded_as_ours_is():
    given = descriptions.plate(4)
    positions = np.array(given["positions"])
    for nodes, x in ((given["supports"], 0.0), (given["loads"], 1.0)):
        np.testing.assert_array_equal(sorted(positions[[n for n, _ in nodes], 1]), np.arange(5) / 4)
        np.testing.assert_array_equal(positions[[n for n, _ in nodes], 0], x)
    assert all(components == [0, 1, 2, 3, 4, 5] for _, components in given["supports"])
    force = sum(np.array(force) for _, force in given["loads"])
    moment = sum(np.cross(positions[node], force) for node, force in given["loads"])
    (load,) = plate(4).loads
    np.testing.assert_allclose(force, load.force, rtol=1e-12)  # over an edge of 1 m
    np.testing.assert_allclose(moment, np.cross((1.0, 0.5, 0.0), load.force), rtol=1e-12)


@pytest.mark.parametrize("comparison", COMPARISONS.values(), ids=lambda c: c.key)
def test_requests_are_lines_and_errors_are_distances(comparison):
    assert comparison.methods[0].code == "ours"
    assert comparison.base in comparison.resolutions
    for method in comparison.methods:
        asked = comparison.request(method, comparison.base)
        assert json.loads(json.dumps(asked)) == asked
    assert comparison.error(list(comparison.reference)) == 0.0
    beside = np.array(comparison.reference)
    beside[0] += 1e-3
    size = comparison.reference[0] if len(comparison.reference) == 2 else comparison.size
    assert comparison.error(beside.tolist()) == pytest.approx(1e-3 / size)


@pytest.mark.parametrize(("key", "elements", "error"), [("bend", 4, 2e-4), ("rollup", 8, 1e-10)])
def test_we_answer_as_the_demos_do(key, elements, error):
    comparison = COMPARISONS[key]
    answer = ours.answer(comparison.request(comparison.methods[0], elements))
    assert comparison.error(answer["place"]) < error
    assert answer["seconds"] > 0
    assert answer["unknowns"] == 6 * (elements + 1)


def test_seconds_are_those_of_the_processor(monkeypatch):
    for module in (progress_bars, progress):  # put back at the end
        monkeypatch.setattr(module, "perf_counter", module.perf_counter)
    ours.use_processor_time()
    watch = progress_bars.Stopwatch()
    time.sleep(0.2)
    assert watch.seconds < 0.1
    end = time.process_time() + 0.05
    while time.process_time() < end:
        pass
    assert watch.seconds >= 0.05


# --- trees and contacts ---------------------------------------------------------------------------


def request_of(key, step, method=None):
    comparison = COMPARISONS[key]
    return comparison.request(comparison.methods[0] if method is None else method, step)


@pytest.mark.parametrize("key", ["sliding_ball", "bouncing_ball", "block"])
def test_closed_forms_of_contacts_are_limits_of_our_steps(key):
    comparison = COMPARISONS[key]
    error = [comparison.error(ours.answer(request_of(key, h))["place"]) for h in (1e-2, 1e-3)]
    assert error[1] < 1e-6
    assert error[1] < 0.05 * error[0] or error[0] < 1e-14  # second order, or exact


@pytest.mark.parametrize(
    ("end", "scene"),
    [
        (contacts.thrown_end, contacts.thrown()),
        (contacts.dropped_end, contacts.dropped()),
        (contacts.block_end, contacts.block()),
    ],
    ids=["thrown", "dropped", "block"],
)
def test_closed_forms_begin_as_described(end, scene):
    (body,) = scene["bodies"]
    np.testing.assert_allclose(end(0.0), body["centre"], atol=1e-15)
    np.testing.assert_allclose((end(1e-7) - end(0.0)) / 1e-7, body["velocity"], atol=1e-6)


def test_thrown_ball_keeps_its_angular_momentum_about_the_floor():
    # friction acts in the floor: v + 2/5 r ω × e does not change, and is 7/5 v when the ball rolls
    late = (contacts.thrown_end(2.0) - contacts.thrown_end(1.0)) / 1.0
    spun = contacts.BALL * np.cross(contacts.SPUN, (0, 0, 1))
    np.testing.assert_allclose(late, (np.array(contacts.THROWN) + 0.4 * spun) / 1.4, atol=1e-14)


def test_dropped_ball_rises_to_the_square_of_its_restitution():
    first = np.sqrt(2 * contacts.DROP / contacts.GRAVITY)
    times = np.linspace(first, first * (1 + 2 * contacts.REBOUND), 2001)
    heights = np.array([contacts.dropped_end(t)[2] for t in times]) - contacts.BALL
    assert heights.max() == pytest.approx(contacts.REBOUND**2 * contacts.DROP)
    np.testing.assert_allclose(heights[[0, -1]], 0.0, atol=1e-12)


def test_block_loses_to_friction_what_it_had():
    scene = contacts.block()
    (gx, _, gz), mu, v = scene["gravity"], scene["friction"], contacts.PUSHED
    way = contacts.block_end(10.0)[0]
    assert v**2 / 2 + gx * way == pytest.approx(-mu * gz * way)
    assert gx < -mu * gz  # friction holds it there


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8, 0.95])
@pytest.mark.parametrize("pulls", [False, True])
def test_spring_and_damper_rebound_with_the_restitution(restitution, pulls):
    ratio = contacts.pulling_damping_ratio if pulls else contacts.damping_ratio
    zeta = ratio(restitution)

    def force(t, y):  # or overlap, to which it lasts if it pulls
        return y[0] if pulls and t > 0 else y[0] + 2 * zeta * y[1]

    force.terminal, force.direction = True, -1
    motion = {"t_span": (0, 9), "y0": (0, 1), "events": force, "rtol": 1e-10, "atol": 1e-12}
    found = solve_ivp(lambda t, y: (y[1], -y[0] - 2 * zeta * y[1]), **motion)
    assert -found.y[1, -1] == pytest.approx(restitution, rel=1e-6)


def test_rod_in_a_box_is_that_of_the_demo():
    request = request_of("rod_in_box", 1e-3) | {"duration": 0.5}
    scene, rod, _ = rod_in_box("spheres", fl.contact.Impact(request["friction"]))
    plan = {"duration": 0.5, "step": 1e-3, "progress": False}
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, **plan)
    expected = result.position(rod.point(request["probe"]["at"]))[-1]
    np.testing.assert_allclose(ours.answer(request)["place"], expected, atol=1e-6)


@pytest.mark.parametrize("way", ["Munthe-Kaas", "generalised-α"])
def test_trees_are_computed_by_the_method_that_is_named(way):
    (method,) = (m for m in COMPARISONS["chain30"].methods if m.label == f"fem_lie, {way}")
    answer = ours.answer(request_of("chain30", 1e-3, method) | {"duration": 0.05})
    assert answer["steps"] == 50
    assert (answer["matrices"] == 0) == (way == "Munthe-Kaas")


def test_mujoco_has_the_bodies_where_they_are():
    scene = descriptions.chain(4) | {"step": 1e-3, "way": "RK4"}
    scene["bodies"].append(contacts.body(1.0, [1.0, 1.0, 1.0], (5.0, 0.0, 2.0)))
    root = ElementTree.fromstring(rigid_peers.text_of(scene))

    def centres(body, base):
        own = base + np.array(body.get("pos").split(), dtype=float)
        yield own + np.array(body.find("inertial").get("pos").split(), dtype=float)
        for child in body.findall("body"):
            yield from centres(child, own)

    found = [c for body in root.find("worldbody").findall("body") for c in centres(body, 0.0)]
    np.testing.assert_allclose(found, [body["centre"] for body in scene["bodies"]], atol=1e-15)
    kinds = [joint.get("type") for joint in root.iter("joint")]
    assert kinds == ["ball"] * 4 + ["free"]


# --- tables and plots -----------------------------------------------------------------------------

ROWS = [
    Row("chain", "ours", "fem_lie, generalised-α", 1e-3, 1e-5, 0.2, 500, 1000, 3, 252, "defaults"),
    Row(
        "chain",
        "exudyn",
        "Exudyn, modified Newton",
        1e-3,
        1.04e-5,
        0.6,
        500,
        2000,
        9,
        252,
        "defaults",
    ),
    Row(
        "chain",
        "exudyn",
        "Exudyn, modified Newton",
        2e-4,
        4e-7,
        3.0,
        2500,
        9000,
        9,
        252,
        "defaults",
    ),
    Row("bend", "ours", "fem_lie, geodesic", 8, 1e-5, 0.01, 3, 12, 12, 54, "3 load steps"),
]


def test_table_has_the_base_resolution_and_ratios():
    lines = report.table(ROWS).splitlines()
    assert len(lines) == 2 + 3
    chain, theirs, bend = (line.split(" | ") for line in lines[2:])
    assert chain[5:7] == ["0.4", "1"]
    assert theirs[5:8] == ["1.2", "3", "4"]
    assert bend[5:8] == ["10", "1", "12"]


def test_what_an_error_costs_is_interpolated_between_runs_that_are_worth_it():
    first, _, _, _ = ROWS
    runs = [first, first._replace(error=1e-6, seconds=2.0), first._replace(error=5e-5, seconds=1.0)]
    assert report.seconds_at(1e-3, runs) == pytest.approx(0.2)
    assert report.seconds_at(10**-5.5, runs) == pytest.approx(0.2 * 10**0.5)
    assert report.seconds_at(0.99e-6, runs) == pytest.approx(2.0)
    assert report.seconds_at(1e-7, runs) == np.inf


def test_what_is_beaten_is_counted():
    assert report.beaten(ROWS).splitlines()[2:] == [
        "| Chain of 28 rigid bodies | Exudyn, modified Newton | 2 | 1 | 0.0002 |"
    ]


def test_rows_and_plots_are_written(tmp_path):
    written = report.draw(ROWS, tmp_path)
    assert [path.name for path in written] == ["peers_trees.png", "peers_statics.png"]
    assert all(path.stat().st_size > 5000 for path in written)
    report.write_csv(ROWS, tmp_path / "peers.csv")
    lines = (tmp_path / "peers.csv").read_text().splitlines()
    assert lines[0].split(",") == list(Row._fields)
    assert len(lines) == 1 + len(ROWS)


def test_a_run_is_read_as_it_was_written(tmp_path):
    run = report.Run("2030-01-31", "OpenBLAS 0.3.29", ROWS)
    run.write(tmp_path / "peers.json")
    assert report.Run.read(tmp_path / "peers.json") == run
    assert "2030-01-31" in run.heading
    assert "OpenBLAS 0.3.29" in run.heading


def test_a_run_names_date_and_blas_before_its_table(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(environment, "interpreters", lambda *_: {})
    monkeypatch.setattr(peers, "compare", lambda *_: iter(ROWS[:1]))
    run = peers.run(["chain"], True, 1, tmp_path / "peers.json")
    heading, _, title, *_ = capsys.readouterr().out.splitlines()
    assert heading == run.heading
    assert _blas.find().name in heading
    assert title.startswith("| scene |")
    assert run.rows == ROWS[:1]
    assert report.Run.read(tmp_path / "peers.json") == run


def test_everyday_rows_that_cannot_be_measured_say_why(capsys):
    def missing() -> Outcome:
        raise Unavailable("there is no peer")

    def there() -> Outcome:
        return Outcome("1 s", "2 s", met=True)

    rows = [EverydayRow("one", "≤ 1", missing), EverydayRow("two", "≤ 2", there)]
    everyday.print_table(rows)
    assert capsys.readouterr().out.splitlines()[-2:] == [
        "| one |  | there is no peer | ≤ 1 | not measured |",
        "| two | 1 s | 2 s | ≤ 2 | met |",
    ]


# --- processes ------------------------------------------------------------------------------------

PROGRAM = """
import json, sys, time
print("a greeting")
print('{"ready": ""}', flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    time.sleep(asked["sleep"])
    if asked["step"] < 1e-3:
        sys.exit(1)
    print(json.dumps({"place": [2.0, 0.0, -1.0], "seconds": asked["step"], "steps": 500,
                      "iterations": 9, "matrices": 1, "unknowns": 2, "settings": ""}), flush=True)
"""


@pytest.fixture
def program(tmp_path, monkeypatch):
    path = tmp_path / "program.py"
    path.write_text(PROGRAM)
    monkeypatch.setitem(processes.PROGRAMS, "exudyn", str(path))
    asked = processes.Asked("exudyn", Path(sys.executable), 5.0)
    yield asked
    asked.stop()


def test_a_program_is_asked_again_after_it_has_ended(program):
    assert program.ask({"sleep": 0, "step": 1.0})["seconds"] == 1.0
    assert "ended" in program.ask({"sleep": 0, "step": 0.0})["failed"]
    assert program.ask({"sleep": 0, "step": 1.0})["seconds"] == 1.0


def test_a_program_that_takes_too_long_is_stopped(program):
    program._limit = 0.2
    assert "0.2 s" in program.ask({"sleep": 60, "step": 1.0})["failed"]


def test_rows_of_the_methods_that_are_there(program, capsys):
    chain = COMPARISONS["chain"]
    asking = chain._replace(request=lambda method, step: {"sleep": 0, "step": step})
    rows = list(peers.compare(asking, {"exudyn": program}, (1e-3, 5e-4), 2))
    assert {row.label for row in rows} == {"Exudyn, modified Newton", "Exudyn, full Newton"}
    assert {row.resolution for row in rows} == {1e-3}
    assert "0.0005: Exudyn, full Newton: exudyn has ended" in capsys.readouterr().out


def test_peers_that_cannot_be_had_are_skipped_with_a_line(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "silent", lambda command: False)
    assert environment.interpreters("exudyn", "kratos") == {}
    skipped = [line for line in capsys.readouterr().out.splitlines() if "skipped" in line]
    assert [line.split()[0] for line in skipped] == ["exudyn", "kratos"]
    assert not list(tmp_path.rglob("python"))
