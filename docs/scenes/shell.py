"""A thin strip is bent to half a circle by a moment along its edge: a shell, without locking."""

from math import pi

import numpy as np

import fem_lie as fl

section = fl.ShellSection.layer(0.1, fl.Material(E=1.2e6, nu=0.0, density=1.0))
mesh = fl.mesh.parametric_surface(lambda u, v: np.array([12 * u, v, 0.0]), (16, 2))
strip = fl.Shell(mesh, section, name="strip")
strip.clamp("a=0")
moment = pi * section.stiffness[3, 3] / 12
scene = fl.Scene()
scene.add(strip)
scene.add(fl.loads.EdgeLoad(strip, "a=1", moment=(0, -moment, 0)))
result = fl.follow_loads(scene)
result.picture("shell.png")
result.page("shell.html")
