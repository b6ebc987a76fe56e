"""Statics show how far the load has grown, on terminals alone."""

import io
import sys

import pytest

import fem_lie as fl
from fem_lie.solve import load_bar


class Terminal(io.StringIO):
    def isatty(self):
        return True


SOLVERS = {
    "load steps": lambda scene: fl.statics(scene, load_steps=4),
    "arc length": lambda scene: fl.follow_loads(scene, levels=[0.5, 1.0]),
}


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_bar_ends_at_the_whole_load(solver, stream, monkeypatch):
    monkeypatch.setattr(sys, "stderr", stream())
    monkeypatch.setattr(load_bar, "_DELAY", 0.0)
    monkeypatch.setattr(load_bar, "_INTERVAL", 0.0)
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.01, fl.Material(E=2e11, nu=0.3, density=7800.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))
    scene.add(fl.Clamp(beam.start))
    scene.add(fl.PointLoad(beam.end, force=(0, 0, 10.0)))
    SOLVERS[solver](scene)
    written = sys.stderr.getvalue()
    if stream is Terminal:
        assert "load:" in written and "100%" in written
    else:
        assert written == ""
