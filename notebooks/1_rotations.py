# %% [markdown]
# # Rotations and SE(3)
#
# A frame `H = (R, x)` is stored as four rows: position and three directors. An increment
# `d = (u, θ)` acts from the right, `H ← H exp(d)`: its components are along the frame's own axes.

# %%
import numpy as np

from fem_lie import lie

H = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
quarter = np.array([1.0, 0, 0, 0, 0, np.pi / 2])
for _ in range(4):
    H = lie.se3_retract(H, quarter)
print(H.round(12))

# %% [markdown]
# Four quarters of a turn, each with the same increment, lead back to where it began: a constant
# increment is an arc of a circle (of a helix, in general), not a straight line.
#
# What two frames are to each other does not change when both move:

# %%
random = np.random.default_rng(1)
A, B, P = (lie.se3_exp(random.normal(size=6)) for _ in range(3))
relative = lie.se3_relative(A, B)
moved = lie.se3_relative(lie.se3_compose(P, A), lie.se3_compose(P, B))
print(np.abs(relative - moved).max())
assert np.allclose(relative, moved)

# %% [markdown]
# That is all that strain of a beam is: `log(A⁻¹B)/L`.
#
# **Exercise 1.** Which increment leads from `H` to a frame 1 further along x that is turned by 90°
# about z? Is its translation (1, 0, 0)?
#
# **Exercise 2.** Show that increments do not commute, and by how much for small ones.

# %% [markdown]
# ## Solutions

# %%
start = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
end = np.array([(1.0, 0, 0), (0, 1, 0), (-1, 0, 0), (0, 0, 1)])
d = lie.se3_relative(start, end)
print(d.round(4))  # no: it goes along an arc, (π/4, −π/4, 0)
assert np.allclose(d[:3], (np.pi / 4, -np.pi / 4, 0))

# %%
a, b = random.normal(size=(2, 6))
for size in (1e-1, 1e-2, 1e-3):
    one = lie.se3_compose(lie.se3_exp(size * a), lie.se3_exp(size * b))
    other = lie.se3_compose(lie.se3_exp(size * b), lie.se3_exp(size * a))
    print(f"{size:g}: {np.abs(one - other).max():.1e}")  # of second order: the bracket [a, b]
assert np.abs(one - other).max() < 1e-4
