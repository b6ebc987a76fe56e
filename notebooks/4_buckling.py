# %% [markdown]
# # Buckling: from a column to the knock-down factor of a shell
#
# A clamped column under a load at its tip gives way at Euler's load, `π² EI/(4 L²)`.

# %%
import tempfile
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np

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
    scene.add(fl.Clamp(body.point("start")))
    scene.add(fl.PointLoad(body.point("end"), force=(0, 0, -1.0)))
    return scene


modes = fl.buckling(column(16), 2)
print(modes.factors, EULER)
assert abs(modes.factors[0] / EULER - 1) < 2e-3

# %% [markdown]
# ## A shell from a gmsh file
#
# A thin cylinder under axial compression, R/t = 100, bears `0.605 E t²/R` per length if it is
# perfect. It buckles in rings and chequers; a cell of two half waves of the rings each way is
# enough, with planes of symmetry at its edges. Its geometry is a file for gmsh; the curves that are
# needed later have names.

# %%
PANEL = """
DefineConstant[ cells = {12}, width = {1}, length = {1} ];
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {Cos(width), Sin(width), 0};
Circle(1) = {2, 1, 3};
Transfinite Curve {1} = cells + 1;
up[] = Extrude {0, 0, length} { Curve{1}; Layers{cells}; Recombine; };
Physical Surface("wall") = {up[1]};
Physical Curve("bottom") = {1};
Physical Curve("top") = {up[0]};
Physical Curve("left") = {Abs(up[3])};
Physical Curve("right") = {Abs(up[2])};
"""
T, METAL = 0.01, fl.Material(E=1.0, nu=0.3, density=1.0)
HALF_WAVE = pi * sqrt(T) / (12 * (1 - METAL.nu**2)) ** 0.25
SIZE = 2 * HALF_WAVE
CLASSICAL = METAL.E * T**2 / sqrt(3 * (1 - METAL.nu**2))

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "panel.geo"
    file.write_text(PANEL)
    mesh = fl.mesh.read_gmsh_surface(fl.mesh.run_gmsh_script(file, {"width": SIZE, "length": SIZE}))


def outward(x: np.ndarray) -> np.ndarray:
    """Normal of the cylinder."""
    return np.array([x[0], x[1], 0.0]) / np.hypot(x[0], x[1])


def compressed() -> fl.Scene:
    """The cell under a rigid plate that presses with the classical load."""
    section = fl.ShellSection.layer(T, METAL)
    wall = fl.Shell(mesh, section, director=outward, name="wall")
    for point in wall.symmetry("top", (0, 0, 1)):
        wall.model.held[point.node, 0] = False  # along the axis, its e1, the plate moves it
    wall.symmetry("bottom", (0, 0, 1))
    wall.symmetry("left", (0, 1, 0))
    wall.symmetry("right", (-np.sin(SIZE), np.cos(SIZE), 0))
    scene = fl.Scene()
    scene.add(wall)
    plate = scene.add(fl.RigidBody(1.0, (1, 1, 1), (np.cos(SIZE / 2), np.sin(SIZE / 2), SIZE)))
    scene.add(fl.joints.Prismatic(fl.ground(), plate.point("centre"), axis=(0, 0, 1)))
    for point in wall.points("top"):
        scene.add(
            fl.joints.InPlane(plate.point("centre"), point, at=point.position, axis=(0, 0, 1))
        )
    scene.add(fl.PointLoad(plate.point("centre"), force=(0, 0, -CLASSICAL * SIZE)))
    return scene


perfect = compressed()
shapes = fl.buckling(perfect, 4)
print("perfect, over the classical load:", shapes.factors.round(3))
assert abs(shapes.factors[0] - 1) < 0.03

# %% [markdown]
# Many shapes at once: that is why so little of it is left. Now the shell is a tenth of its
# thickness out of shape, in rings, and its path is followed to its first critical point. What is
# borne then, over the classical load, is the *knock-down factor*. W. T. Koiter (1963) has in closed
# form `(1 − x)² = 3/2 √(3 (1 − ν²)) (d/t) x`.


# %%
def knock_down(amplitude: float) -> float:
    """With rings of this amplitude over the thickness, inward in the middle of the cell."""
    rings = fl.stability.FieldImperfection(
        lambda x: -amplitude * T * np.cos(pi * x[2] / HALF_WAVE) * outward(x)
    )
    path = fl.follow_path(
        fl.stability.apply_imperfections(perfect, rings), fl.stability.PathEnds(critical_points=1)
    )
    return path.critical[0].factor


def koiter(amplitude: float) -> float:
    """The smaller root."""
    b = 1 + 0.75 * sqrt(3 * (1 - METAL.nu**2)) * amplitude
    return b - sqrt(b**2 - 1)


print("knock-down factor with 0.1 t:", knock_down(0.1), koiter(0.1))
assert abs(knock_down(0.1) / koiter(0.1) - 1) < 0.1

# %% [markdown]
# **Exercise 1.** The second load is that of the other axis. Check it.
#
# **Exercise 2.** Of which order is the error in the size of elements?
#
# **Exercise 3.** Which amplitude of rings leaves what the rule of NASA SP-8007 lets a cylinder with
# R/t = 100 bear, `1 − 0.901 (1 − exp(−√(R/t)/16))`?

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

# %%
rule = 1 - 0.901 * (1 - exp(-sqrt(1 / T) / 16))
closed = (1 - rule) ** 2 / (1.5 * sqrt(3 * (1 - METAL.nu**2)) * rule)  # Koiter's, solved for d/t
print(f"rule {rule:.3f}; rings of {closed:.3f} t leave {knock_down(closed):.3f}")
assert abs(knock_down(closed) - rule) < 0.05
