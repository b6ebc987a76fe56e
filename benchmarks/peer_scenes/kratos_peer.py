"""Answers requests with runs of Kratos; imports nothing but what its own environment has.

A request is a line of JSON: a description of a shell by nodes, cells, supports, loads and probes
(``descriptions``), a ``way``, which is an element, and ``load_steps``. The answer is another one:
displacements of the probes, seconds of the processor in the solver alone, steps, iterations,
unknowns, and the settings that it arrived with.

The solver is put together as ``structural_mechanics_static_solver`` of Kratos does by default:
block builder, Newton-Raphson to 1e-4 of the residual, reactions, the fastest direct linear solver
that is there. Equal load steps may take up to 30 iterations instead of its 10, which lets them be
larger; where they do not arrive there are twice as many.
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

# Kratos greets on the standard output, from compiled code
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)

import KratosMultiphysics as Kratos  # noqa: E402
import KratosMultiphysics.LinearSolversApplication  # noqa: E402
import KratosMultiphysics.StructuralMechanicsApplication as Structural  # noqa: E402
from KratosMultiphysics import python_linear_solver_factory  # noqa: E402

Record = dict[str, Any]
DOFS = {
    "DISPLACEMENT_X": "REACTION_X",
    "DISPLACEMENT_Y": "REACTION_Y",
    "DISPLACEMENT_Z": "REACTION_Z",
    "ROTATION_X": "REACTION_MOMENT_X",
    "ROTATION_Y": "REACTION_MOMENT_Y",
    "ROTATION_Z": "REACTION_MOMENT_Z",
}
ELEMENTS = {"thin quadrilateral": "ShellThinElementCorotational3D4N"}
ITERATIONS, MOST_DOUBLINGS = 30, 3
arrived: dict[str, int] = {}  # how many load steps have let a scene arrive


def main() -> None:
    """Answer until the input ends."""
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    say({"ready": f"Kratos {Kratos.KratosGlobals.Kernel.Version()}"})
    for text in sys.stdin:
        say(answer(json.loads(text)))


def say(record: Record) -> None:
    """Write a line."""
    answers.write(json.dumps(record) + "\n")
    answers.flush()


def answer(request: Record) -> Record:
    """The first run that arrives."""
    key = json.dumps(request)
    doubled = [request["load_steps"] * 2**k for k in range(MOST_DOUBLINGS + 1)]
    for steps in [arrived[key]] if key in arrived else doubled:
        model = Kratos.Model()
        part = shell(model, request)
        found = solve(part, request, steps)
        if found is not None:
            arrived[key] = steps
            return found | {"settings": f"{steps} load steps", "unknowns": 6 * len(part.Nodes)}
    return {"failed": f"does not converge in {doubled[-1]} load steps"}


def shell(model: Any, request: Record) -> Any:
    """The shell with its supports and loads; numbers of nodes and cells count from one."""
    part = model.CreateModelPart("shell")
    part.SetBufferSize(2)
    for name in ("DISPLACEMENT", "REACTION", "ROTATION", "REACTION_MOMENT", "VOLUME_ACCELERATION"):
        part.AddNodalSolutionStepVariable(getattr(Kratos, name))
    part.AddNodalSolutionStepVariable(Structural.POINT_LOAD)
    section = part.GetProperties()[1]
    section.SetValue(Kratos.YOUNG_MODULUS, request["young"])
    section.SetValue(Kratos.POISSON_RATIO, request["poisson"])
    section.SetValue(Kratos.THICKNESS, request["thickness"])
    section.SetValue(Kratos.DENSITY, 1.0)
    section.SetValue(Kratos.CONSTITUTIVE_LAW, Structural.LinearElasticPlaneStress2DLaw())
    for number, position in enumerate(request["positions"], start=1):
        part.CreateNewNode(number, *position)
    for dof, reaction in DOFS.items():
        Kratos.VariableUtils().AddDof(getattr(Kratos, dof), getattr(Kratos, reaction), part)
    for number, corners in enumerate(request["cells"], start=1):
        nodes = [1 + node for node in corners]
        part.CreateNewElement(ELEMENTS[request["way"]], number, nodes, section)
    names = list(DOFS)
    for node, components in request["supports"]:
        for component in components:
            part.Nodes[1 + node].Fix(getattr(Kratos, names[component]))
    for number, (node, _) in enumerate(request["loads"], start=1):
        part.CreateNewCondition("PointLoadCondition3D1N", number, [1 + node], section)
    return part


def solve(part: Any, request: Record, steps: int) -> Record | None:
    """Displacements of the probes and counts, or None where it does not converge."""
    loads = [(part.Nodes[1 + node], force) for node, force in request["loads"]]
    linear = python_linear_solver_factory.CreateFastestAvailableDirectLinearSolver()
    strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
        part,
        Structural.StructuralMechanicsStaticScheme(Kratos.Parameters("{}")),
        Structural.ResidualDisplacementAndOtherDoFCriteria(1e-4, 1e-9, "ROTATION"),
        Kratos.ResidualBasedBlockBuilderAndSolver(linear),
        ITERATIONS,
        True,  # reactions
        False,  # the same unknowns in all steps
        True,  # the mesh moves
    )
    strategy.SetEchoLevel(0)
    strategy.Check()
    strategy.Initialize()
    iterations, start = 0, time.process_time()
    for step in range(1, steps + 1):
        part.CloneTimeStep(step / steps)
        part.ProcessInfo[Kratos.STEP] = step
        for node, force in loads:
            now = [step / steps * component for component in force]
            node.SetSolutionStepValue(Structural.POINT_LOAD, 0, now)
        strategy.InitializeSolutionStep()
        strategy.Predict()
        if not strategy.SolveSolutionStep():
            return None
        iterations += part.ProcessInfo[Kratos.NL_ITERATION_NUMBER]
        strategy.FinalizeSolutionStep()
    seconds = time.process_time() - start
    probes = [along(part.Nodes[1 + node], direction) for node, direction in request["probe"]]
    counts = {"steps": steps, "iterations": iterations, "matrices": iterations}
    return {"place": probes, "seconds": seconds} | counts


def along(node: Any, direction: list[float]) -> float:
    """The displacement of a node in a direction."""
    displacement = node.GetSolutionStepValue(Kratos.DISPLACEMENT)
    return sum(u * d for u, d in zip(displacement, direction, strict=True))


if __name__ == "__main__":
    main()
