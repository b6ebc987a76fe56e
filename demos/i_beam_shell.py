"""An I-beam made of shells: two flanges and a web that branches off them, and an end plate.

The mid-surfaces come from gmsh (``meshes/i_beam.geo``), four-node quadrilaterals. Where the web
meets a flange three cells share an edge: the flange goes on smoothly through it, the web has nodes
of its own there, which follow those of the flange. A rotation that tilts the director of the one is
the drilling of the other, so all nodes have six parameters. The end is welded to a rigid plate, a
rigid body to which all nodes of the end are linked; the loads act on its centre.

Four cases, each compared with a beam that this script computes, too:

* across the flanges (strong axis) and along them (weak axis, through 6 % of the length): the beam
  has the I as its section, with shear. The shells count the pieces of the web within the flanges
  twice, which makes them 1.3 % stiffer about the strong axis.
* a torque: both ends are kept from warping, and most of it goes into bending of the flanges. The
  angle of V. Z. Vlasov, *Thin-walled elastic beams* (1961), with GJ of the section and
  ``I_w = t b³ h²/24``: ``θ = T/GJ (ℓ − 2/k tanh(kℓ/2))``, ``k² = GJ/EI_w``. Free to warp
  it would be six times as large.
* twice as long, it tips over under a force across its flanges (``fl.buckling``). With the distance
  x from the force and the weak stiffness ``EI_z`` of the flanges

      EI_w θ'''' − GJ θ'' = (P x)²/EI_z θ,   θ' = θ''' = 0 at the plate, θ = θ' = 0 at the clamp

  (S. P. Timoshenko & J. M. Gere, *Theory of elastic stability* (1961), ch. 6). On a path the load
  would be higher by the bending before, see lateral_torsional.py; linear buckling has none.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run
from reference.i_beam import (
    FLANGE,
    HEIGHT,
    LENGTH,
    LONG,
    STEEL,
    TORQUE,
    WEB,
    WIDTH,
    tipping_load,
    vlasov,
)

import fem_lie as fl
from fem_lie import lie

HERE = Path(__file__).parent
FORCES = {"strong": (0.0, 0.0, 1e4), "weak": (0.0, 1e4, 0.0)}


def of_shells(along: int, length: float, force: tuple[float, ...], torque: float = 0.0) -> fl.Scene:
    """Cantilever of shells with a rigid plate at its end."""
    mesh = fl.mesh.read_gmsh_surface(
        fl.mesh.run_gmsh_script(
            HERE.parent / "meshes" / "i_beam.geo", {"along": along, "length": length}
        )
    )
    thickness = {"flanges": FLANGE, "web": WEB}
    layers = {name: fl.ShellSection.layer(t, STEEL) for name, t in thickness.items()}
    scene = fl.Scene()
    beam = scene.add(fl.Shell(mesh, layers, name="beam"))
    beam.clamp("root")
    inertia = np.array([HEIGHT**2 + WIDTH**2, HEIGHT**2, WIDTH**2]) / 12
    plate = scene.add(fl.RigidBody(1.0, inertia, position=(length, 0, 0), name="plate"))
    ends = {p.node: p for name in ("top end", "bottom end", "web end") for p in beam.points(name)}
    for point in ends.values():
        scene.add(fl.joints.RigidLink(plate.point("centre"), point))
    scene.add(fl.PointLoad(plate.point("centre"), force=force, moment=(torque, 0, 0)))
    return scene


def of_beam(shape: fl.sections.SectionShape, force: tuple[float, ...]) -> fl.StaticResult:
    """The same as one line."""
    scene = fl.Scene()
    beam = fl.Beam.straight(
        (0, 0, 0), (LENGTH, 0, 0), shape.section(STEEL), up=(0, 0, 1), cells=20, name="beam"
    )
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    return fl.follow_loads(scene)


def main(along: int = 40, pictures: bool = True) -> dict[str, Any]:
    shape = fl.sections.SectionShape.i_section(WIDTH, HEIGHT + FLANGE, WEB, FLANGE)
    record: dict[str, Any] = {"along": along}
    for name, force in FORCES.items():
        result = fl.follow_loads(of_shells(along, LENGTH, force))
        line = of_beam(shape, force)
        moved = result.position("plate.centre")[-1] - [LENGTH, 0, 0]
        wanted = line.position("beam.end")[-1] - [LENGTH, 0, 0]
        record[f"deflection_{name}"] = float(np.linalg.norm(moved))
        record[f"deflection_{name}_beam"] = float(np.linalg.norm(wanted))
        record[f"iterations_{name}"] = result.total_iterations
    twisted = fl.follow_loads(of_shells(along, LENGTH, (0.0, 0.0, 0.0), TORQUE))
    record["twist"] = float(lie.so3_log(twisted.rotation("plate.centre")[-1])[0])
    record["twist_beam"] = vlasov(shape)
    modes = fl.buckling(of_shells(along, LONG, (0.0, 0.0, -1.0)), 1)
    record["buckling_load"] = float(modes.factors[0])
    record["buckling_load_beam"] = tipping_load(shape)
    for name in ("deflection_strong", "deflection_weak", "twist", "buckling_load"):
        record[f"error_{name}"] = record[name] / record[f"{name}_beam"] - 1.0
    if pictures:
        far = fl.follow_loads(of_shells(along, LENGTH, FORCES["weak"], 20 * TORQUE))
        path = in_results("i_beam_shell.png")
        far.picture(path, title="I-beam of shells, pushed along its flanges and twisted")
        mode = in_results("i_beam_shell_buckling.png")
        modes.picture(mode, amplitude=0.05 * LONG, title="I-beam of shells that tips over")
    return record


if __name__ == "__main__":
    run(main, show=True)
