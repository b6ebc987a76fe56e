# %% [markdown]
# # A beam, from a straight line to a full circle
#
# A moment at the tip of a cantilever bends it to an arc: `κ = M/EI`, and a full circle at
# `M = 2π EI/L`. Elements with a constant strain along a geodesic are exact in it.

# %%
from math import pi

import numpy as np

import fem_lie as fl

LENGTH = 10.0
strip = fl.Section.rectangle(0.1, 1.0, fl.Material(E=1.2e6, nu=0.0, density=1200.0))


def rolled(turns: float, cells: int = 8, load_steps: int = 6) -> fl.StaticResult:
    """A cantilever under the moment of so many turns."""
    beam = fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), strip, cells=cells, name="beam")
    moment = turns * 2 * pi * strip.stiffness[5, 5] / LENGTH
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, moment)))
    return fl.statics(scene, load_steps=load_steps)


result = rolled(1.0)
gap = np.linalg.norm(result.position("beam.end")[-1])
print(f"tip {gap:.0e} from the clamp; iterations {np.diff(result.iterations, prepend=0)}")
assert gap < 1e-9

# %% [markdown]
# Three iterations in each step, for stress is carried from iterate to iterate: Newton's method does
# not notice that stretching is ten thousand times stiffer than bending.
#
# **Exercise 1.** Half a turn: where is the tip, in closed form?
#
# **Exercise 2.** How many load steps does a full circle need?

# %% [markdown]
# ## Solutions

# %%
tip = rolled(0.5).position("beam.end")[-1]
print(tip, 2 * LENGTH / pi)  # half a circle of radius L/π: (0, 2L/π, 0)
assert np.allclose(tip, (0, 2 * LENGTH / pi, 0), atol=1e-8)

# %%
for steps in (6, 4, 3):
    print(steps, rolled(1.0, load_steps=steps).total_iterations)
