# %% [markdown]
# # Buckling
#
# A clamped column under a load at its tip gives way at Euler's load, `π² EI/(4 L²)`.

# %%
from math import pi

import fem_lie as fl

LENGTH = 2.0
section = fl.Section.rectangle(0.02, 0.03, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
weak = min(section.stiffness[4, 4], section.stiffness[5, 5])
EULER = pi**2 * weak / (4 * LENGTH**2)


def column(cells: int) -> fl.Scene:
    """Clamped below, with the load 1 N on top."""
    body = fl.Beam.straight((0, 0, 0), (0, 0, LENGTH), section, cells=cells, name="column")
    scene = fl.Scene()
    scene.add(body)
    scene.add(fl.Clamp(body.start))
    scene.add(fl.PointLoad(body.end, force=(0, 0, -1.0)))
    return scene


modes = fl.buckling(column(16), 2)
print(modes.factors, EULER)
assert abs(modes.factors[0] / EULER - 1) < 2e-3

# %% [markdown]
# **Exercise 1.** The second load is that of the other axis. Check it.
#
# **Exercise 2.** Of which order is the error in the size of elements?

# %% [markdown]
# ## Solutions

# %%
strong = max(section.stiffness[4, 4], section.stiffness[5, 5])
print(modes.factors[1] / modes.factors[0], strong / weak)
assert abs(modes.factors[1] / modes.factors[0] * weak / strong - 1) < 5e-3

# %%
finest = fl.buckling(column(64), 1).factors[0]
errors = [abs(fl.buckling(column(cells), 1).factors[0] / finest - 1) for cells in (4, 8)]
print(errors, errors[0] / errors[1])
