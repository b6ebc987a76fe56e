"""A rope swings down from a pin: positions and slopes, no rotations."""

import fem_lie as fl

rubber = fl.Material(E=1e7, nu=0.3, density=1000.0)
rope = fl.Cable.straight((0, 0, 0), (2, 0, 0), fl.Section.circle(0.02, rubber), cells=12)
rope.pin(rope.point("start"))
scene = fl.Scene(gravity=(0, 0, -9.81))
scene.add(rope)
result = fl.GeneralisedAlpha().run(scene, duration=1.2, step=2e-3, save_every=10)
result.picture("cable.png")
result.page("cable.html")
