# %% [markdown]
# # Locking, and mixed shells
#
# A quarter of a pinched hemisphere, whose radius is 250 times its thickness: it bends almost
# without
# stretching. An element that cannot do so is too stiff, it *locks*. The same mesh with a plain
# displacement element (shear is assumed, membrane is not) and with a Hellinger-Reissner field:

# %%
import fem_lie as fl
from demos.hemisphere import CASES, RADIUS, pinched, quarter

THICKNESS = 0.04
_, OUTWARD, INWARD = CASES[THICKNESS]


def deflection(mesh: int, formulation: fl.elements.ShellFormulation) -> tuple[float, int]:
    """Inward, over its reference, and linear solutions."""
    scene = pinched(THICKNESS, quarter(mesh), formulation)
    result = fl.follow_loads(scene)
    inward = RADIUS - result.position("hemisphere.10")[-1][1]
    return inward / INWARD, result.total_iterations


mixed, plain = fl.elements.HellingerReissner(), fl.elements.DisplacementBased()
for cells in (4, 8):
    for name, formulation in (("mixed", mixed), ("plain", plain)):
        ratio, solutions = deflection(cells, formulation)
        print(f"{cells} x {cells} {name}: {ratio:.3f} of the reference, {solutions} solutions")

# %% [markdown]
# **Exercise 1.** How fine a mesh does the mixed one need for 2 %?
#
# **Exercise 2.** And what does MITC4+, whose membrane strains are assumed, do for the plain one?

# %% [markdown]
# ## Solutions

# %%
for cells in (12, 16):
    print(cells, deflection(cells, mixed)[0])
assert abs(deflection(16, mixed)[0] - 1) < 0.02

# %%
ratio, solutions = deflection(8, fl.elements.DisplacementBased(fl.elements.MITC4_PLUS))
print(f"MITC4+: {ratio:.3f}, {solutions} solutions")
