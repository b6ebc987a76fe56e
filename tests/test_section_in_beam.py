"""Sections of any shape in beams: where a force must act, or it twists."""

import pytest

import fem_lie as fl

STEEL = fl.Material(210e9, 0.3, 7850.0)
CHANNEL = fl.sections.SectionShape.channel(0.1, 0.2, web=0.0085, flange=0.011)


def tip_of(section: fl.Section, load_at=None) -> tuple[float, float]:
    """Twist and deflection of a cantilever by a small force along e₃, at its axis or elsewhere."""
    length, force = 2.0, 1.0
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=4, up=(0, 0, 1)))
    scene.add(fl.Clamp(beam.point("start")))
    point = beam.point("end")
    if load_at is not None:
        plate = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), (length, *load_at)))
        scene.add(fl.joints.RigidLink(beam.point("end"), plate.point("centre")))
        point = plate.point("centre")
    scene.add(fl.PointLoad(point, force=(0, 0, force)))
    result = fl.statics(scene)
    R, moved = result.rotation(beam.point("end"))[-1], result.position(point)[-1]
    return R[2, 1], moved[2] - point.position[2]


def test_a_channel_twists_unless_loaded_at_its_shear_centre():
    """Off by e the force twists by e F L/GJ; at the shear centre it bends as Timoshenko says."""
    w, length = CHANNEL.warping(STEEL), 2.0
    p = w.properties
    arm = p.centroid[0] - p.shear_centre[0]
    twist = arm * length / (p.G * p.torsion_constant)
    bend = length**3 / (3.0 * p.E * p.second_moments[1, 1])
    bend += length / (p.G * p.area * p.shear_factors[1, 1])
    assert arm > 0.05
    # nonlinear terms are squares of an angle of 1e-5
    turned, _ = tip_of(w.section())
    assert turned == pytest.approx(twist, rel=1e-4)
    straight = [
        tip_of(w.section(), load_at=(-arm, 0.0)),
        tip_of(w.section(at=p.shear_centre)),
    ]
    for turned, moved in straight:
        assert abs(turned) <= 1e-6 * twist
        assert moved == pytest.approx(bend, rel=1e-4)


def test_refinement_is_kept():
    fine, coarse = (
        fl.sections.SectionShape.rectangle(1.0, 1.0).refined(4.0),
        fl.sections.SectionShape.rectangle(1.0, 1.0),
    )
    cells = {shape: len(shape.moved(1.0, 0.0).mesh.cells) for shape in (fine, coarse)}
    assert cells[fine] > 4 * cells[coarse]
    together = fl.sections.SectionShape.joined({"fine": fine, "coarse": coarse.moved(1.0, 0.0)})
    assert len(together.mesh.cells) > cells[fine]
