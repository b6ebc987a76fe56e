"""A cantilever rolls up to a circle: a moment at its tip, in six load steps."""

from math import pi

import fem_lie as fl

strip = fl.Section.rectangle(0.1, 1.0, fl.Material(E=1.2e6, nu=0.0, density=1200.0))
beam = fl.Beam.straight((0, 0, 0), (10, 0, 0), strip, cells=8)
moment = 2 * pi * strip.stiffness[5, 5] / 10
scene = fl.Scene()
scene.add(beam)
scene.add(fl.Clamp(beam.point("start")))
scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, moment)))
result = fl.statics(scene, load_steps=6)
result.picture("rollup.png")
result.page("rollup.html")
