"""Statics, paths, buckling and adaptivity show how far they are, on terminals alone."""

import io
import sys

import pytest
from tqdm import tqdm

import fem_lie as fl

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)


class Terminal(io.StringIO):
    def isatty(self):
        return True


def cantilever(force=(0, 0, 10.0), lines=None):
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.01, STEEL)
    if lines is None:
        lines = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 2)
    beam = scene.add(fl.Beam(lines, section))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    return scene


def adapt():
    def arch(lines):
        return cantilever(lines=lines)

    fl.adaptivity.adapt(arch, fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 2), tolerance=0.05)


# what is solved, and what the bar says of it in the end
SOLVERS = {
    "load steps": (lambda: fl.statics(cantilever(), load_steps=4), ["load:", "100%"]),
    "arc length": (
        lambda: fl.follow_loads(cantilever(), levels=[0.5, 1.0]),
        ["load:", "100%"],
    ),
    "path": (
        lambda: fl.follow_path(cantilever(), resolution=0.2),
        ["path:", "load factor 1, 0 negative pivots"],
    ),
    "buckling": (
        lambda: fl.buckling(cantilever(force=(-1.0, 0, 0)), count=1),
        ["buckling:", "load factors and modes", "5/5"],
    ),
    "adaptivity": (adapt, ["adaptivity:", "unknowns, error", "expected 0.05"]),
}


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_bar_says_how_far_a_solution_is(solver, stream, monkeypatch):
    monkeypatch.setattr(sys, "stderr", stream())
    begin = tqdm.__init__

    def at_once(bar, *given, **options):
        begin(bar, *given, **options | {"delay": 0.0, "mininterval": 0.0})

    monkeypatch.setattr(tqdm, "__init__", at_once)
    solve, said = SOLVERS[solver]
    solve()
    written = sys.stderr.getvalue()
    if stream is Terminal:
        assert all(text in written for text in said), written
    else:
        assert written == ""
