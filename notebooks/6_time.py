# %% [markdown]
# # Time integration: order, conservation
#
# A body that tumbles about no axis of its own, without forces: energy and angular momentum stay.

# %%
import numpy as np

import fem_lie as fl


def tumbling() -> tuple[fl.Scene, fl.RigidBody]:
    """Three different moments of inertia, a turn about none of their axes."""
    body = fl.RigidBody(1.0, (0.1, 0.2, 0.28), name="body")
    body.add_velocity(omega=(2.0, 3.0, 1.0), about=body.point("centre"))
    scene = fl.Scene()
    scene.add(body)
    return scene, body


def end(scheme, steps: int) -> np.ndarray:
    """Its rotation after a second."""
    scene, body = tumbling()
    return scheme.run(scene, duration=1.0, step=1.0 / steps).rotation(body.point("centre"))[-1]


def order(scheme, steps: int) -> float:
    """From three steps, each half of the one before."""
    a, b, c = (end(scheme, n * steps) for n in (1, 2, 4))
    return float(np.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c)))


for scheme in (fl.GeneralisedAlpha(radius=0.9), fl.EnergyMomentum(), fl.schemes.Composed()):
    result = scheme.run(tumbling()[0], duration=1.0, step=0.02)
    found = order(scheme, 20)
    print(f"{type(scheme).__name__}: order {found:.2f}, energy {result.energy_error:.0e}")

# %% [markdown]
# **Exercise 1.** Does what generalised-α loses of the energy depend on the step, and how?
#
# **Exercise 2.** And in the long run: how do the errors of the energy grow with the time, in
# ten and in a hundred times as many steps?

# %% [markdown]
# ## Solutions

# %%
losses = []
for step in (0.02, 0.01):
    scheme = fl.GeneralisedAlpha(radius=0.9)
    losses.append(scheme.run(tumbling()[0], duration=1.0, step=step).energy_error)
print(losses, losses[0] / losses[1])
assert losses[1] < losses[0]

# %%
for scheme in (fl.GeneralisedAlpha(radius=0.9), fl.EnergyMomentum()):
    runs = [scheme.run(tumbling()[0], duration=t, step=0.02) for t in (1.0, 10.0, 100.0)]
    errors = [run.energy_error for run in runs]
    print(type(scheme).__name__, [f"{error:.0e}" for error in errors])
assert errors[-1] < 1e-10  # round-off alone, eleven orders below the other
