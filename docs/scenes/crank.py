"""A crank drives a flexible rod and a slider: three joints, one drive."""

from math import pi

import fem_lie as fl

steel = fl.Material(E=2e9, nu=0.3, density=7800.0)
rod = fl.Beam.straight((0.2, 0, 0), (1, 0, 0), fl.Section.circle(0.01, steel), cells=4)
crank = fl.RigidBody(0.5, (1e-3, 2e-3, 2e-3), position=(0.1, 0, 0))
slider = fl.RigidBody(0.2, (1e-4, 1e-4, 1e-4), position=(1, 0, 0))
scene = fl.Scene()
for body in (crank, rod, slider):
    scene.add(body)
motor = scene.add(
    fl.joints.Revolute(fl.ground(), crank.point("centre"), at=(0, 0, 0), axis=(0, 0, 1))
)
scene.add(fl.joints.Spherical(crank.point("centre"), rod.point("start"), at=(0.2, 0, 0)))
scene.add(fl.joints.Revolute(rod.point("end"), slider.point("centre"), axis=(0, 0, 1)))
scene.add(fl.joints.Prismatic(fl.ground(), slider.point("centre"), axis=(1, 0, 0)))
scene.add(fl.joints.Drive(motor.angle, lambda t: pi * t**2))
result = fl.GeneralisedAlpha().run(scene, duration=2.0, step=2e-3, save_every=10)
result.picture("crank.png")
result.page("crank.html")
