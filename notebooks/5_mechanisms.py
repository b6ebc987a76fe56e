# %% [markdown]
# # Multibody: joints, drives, joint forces
#
# A wheel on an axle is driven; the drive's moment is what the wheel's inertia asks for.

# %%
import numpy as np

import fem_lie as fl

INERTIA = 0.2


def driven(angle) -> fl.Result:
    """A wheel on a motor."""
    wheel = fl.RigidBody(2.0, (0.1, 0.1, INERTIA), name="wheel")
    scene = fl.Scene()
    scene.add(wheel)
    axle = scene.add(fl.Revolute(fl.ground(), wheel.centre, axis=(0, 0, 1), name="axle"))
    scene.add(fl.Drive(axle.angle, angle, name="motor"))
    return fl.GeneralisedAlpha().run(scene, duration=1.0, step=5e-3)


result = driven(lambda t: 0.5 * 3.0 * t**2)
turned = result.rotation("wheel.centre")[-1]
print(np.arctan2(turned[1, 0], turned[0, 0]), 1.5)
assert abs(np.arctan2(turned[1, 0], turned[0, 0]) - 1.5) < 1e-6

# %% [markdown]
# **Exercise.** What energy has the wheel at the end?

# %% [markdown]
# ## Solution

# %%
energy = result.total_energy[-1]
print(energy, 0.5 * INERTIA * 3.0**2)
assert abs(energy / (0.5 * INERTIA * 3.0**2) - 1) < 1e-3
