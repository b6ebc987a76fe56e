"""A flexible double pendulum: two thin bars with hinges fall from rest."""

import fem_lie as fl

bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
scene = fl.Scene(gravity=(0, 0, -9.81))
upper = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=4))
lower = scene.add(fl.Beam.straight((1, 0, 0), (2, 0, 0), bar, cells=4))
scene.add(fl.joints.Revolute(fl.ground(), upper.point("start"), axis=(0, 1, 0)))
scene.add(fl.joints.Revolute(upper.point("end"), lower.point("start"), axis=(0, 1, 0)))
result = fl.GeneralisedAlpha().run(scene, duration=1.5, step=2e-3, save_every=10)
result.picture("pendulum.png")
result.page("pendulum.html")
