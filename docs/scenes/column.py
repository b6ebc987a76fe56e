"""A clamped column buckles: the lowest of three modes."""

import fem_lie as fl

section = fl.Section.rectangle(0.02, 0.03, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
column = fl.Beam.straight((0, 0, 0), (0, 0, 2), section, cells=12)
scene = fl.Scene()
scene.add(column)
scene.add(fl.Clamp(column.point("start")))
scene.add(fl.PointLoad(column.point("end"), force=(0, 0, -1.0)))
modes = fl.buckling(scene, 3)
modes.picture("column.png")
modes.page(1, "column.html")
