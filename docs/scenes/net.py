"""A net falls onto its four corners: explicit steps, nothing is solved."""

import numpy as np

import fem_lie as fl

n = np.arange(7)
points = np.array([(x / 6, y / 6, 0.0) for y in n for x in n])
cables = [*(list(n + 7 * k) for k in n), *(list(7 * n + k) for k in n)]
rope = fl.Section.circle(0.004, fl.Material(E=1e7, nu=0.3, density=1000.0))
net = fl.Net(points, cables, rope)
net.pin(*(net.point(corner) for corner in (0, 6, 42, 48)))
scene = fl.Scene(gravity=(0, 0, -9.81))
scene.add(net)
scheme = fl.Explicit()
step = 0.5 * scheme.stable_step(scene)
result = scheme.run(scene, duration=4000 * step, step=step, save_every=250)
result.picture("net.png", times=[result.times[-1]])
result.page("net.html")
