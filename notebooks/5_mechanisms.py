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
    axle = scene.add(
        fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1), name="axle")
    )
    scene.add(fl.joints.Drive(axle.angle, angle, name="motor"))
    return fl.GeneralisedAlpha().run(scene, duration=1.0, step=5e-3)


result = driven(lambda t: 0.5 * 3.0 * t**2)
turned = result.rotation("wheel.centre")[-1]
print(np.arctan2(turned[1, 0], turned[0, 0]), 1.5)
assert abs(np.arctan2(turned[1, 0], turned[0, 0]) - 1.5) < 1e-6

# %% [markdown]
# **Exercise 1.** What energy has the wheel at the end?
#
# **Exercise 2.** A rigid bar falls from the horizontal about one end. Which force does its joint
# bear when it passes the lowest position?

# %% [markdown]
# ## Solutions

# %%
energy = result.total_energy[-1]
print(energy, 0.5 * INERTIA * 3.0**2)
assert abs(energy / (0.5 * INERTIA * 3.0**2) - 1) < 1e-3

# %%
mass, length, g = 2.0, 1.0, 9.81
J = mass * length**2 / 12
bar = fl.RigidBody(mass, (1e-6, J, J), position=(length / 2, 0, 0), name="bar")
scene = fl.Scene(gravity=(0, 0, -g))
scene.add(bar)
hinge = scene.add(
    fl.joints.Revolute(fl.ground(), bar.point("centre"), at=(0, 0, 0), axis=(0, 1, 0), name="hinge")
)
fall = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=0.8, step=1e-3)
lowest = int(fall.position("bar.centre")[:, 2].argmin())
force = np.linalg.norm(fall.joint_force(hinge)[lowest, :3])
print(force, 2.5 * mass * g)  # the weight, and m ω² l/2 with ω² = 3 g/l
assert abs(force / (2.5 * mass * g) - 1) < 1e-3
