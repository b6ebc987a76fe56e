"""Answers requests with runs of Kratos; imports nothing but what its own environment has.

A request is a line of JSON: a description of a pinched hemisphere (``descriptions``), a
``way``, which is an element, and ``load_steps``. The answer is another one: both deflections,
seconds of the processor in the solver alone, steps, iterations, unknowns, and the settings that it
arrived with.

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
        part, ends = hemisphere(model, request)
        found = solve(part, ends, request["force"] / 2, steps)
        if found is not None:
            arrived[key] = steps
            return found | {"settings": f"{steps} load steps", "unknowns": 6 * len(part.Nodes)}
    return {"failed": f"does not converge in {doubled[-1]} load steps"}


def hemisphere(model: Any, request: Record) -> tuple[Any, tuple[Any, Any]]:
    """A quarter with its supports, and the two nodes that are pushed."""
    part = model.CreateModelPart("hemisphere")
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
    for number, place in enumerate(request["places"], start=1):
        part.CreateNewNode(number, *place)
    for dof, reaction in DOFS.items():
        Kratos.VariableUtils().AddDof(getattr(Kratos, dof), getattr(Kratos, reaction), part)
    n = request["cells"]
    row = n + 1
    for cell in range(n * n):
        first = 1 + cell % n + row * (cell // n)
        corners = [first, first + 1, first + 1 + row, first + row]
        part.CreateNewElement(ELEMENTS[request["way"]], cell + 1, corners, section)
    for k in range(row):
        fix(part.Nodes[1 + row * k], "DISPLACEMENT_Y", "ROTATION_X", "ROTATION_Z")
        fix(part.Nodes[row + row * k], "DISPLACEMENT_X", "ROTATION_Y", "ROTATION_Z")
    fix(part.Nodes[1], "DISPLACEMENT_Z")
    for number, node in enumerate((1, row), start=1):
        part.CreateNewCondition("PointLoadCondition3D1N", number, [node], section)
    return part, (part.Nodes[1], part.Nodes[row])


def fix(node: Any, *names: str) -> None:
    """Hold what is named."""
    for name in names:
        node.Fix(getattr(Kratos, name))


def solve(part: Any, ends: tuple[Any, Any], force: float, steps: int) -> Record | None:
    """Deflections and counts, or None where it does not converge."""
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
        now = force * step / steps
        ends[0].SetSolutionStepValue(Structural.POINT_LOAD, 0, [now, 0.0, 0.0])
        ends[1].SetSolutionStepValue(Structural.POINT_LOAD, 0, [0.0, -now, 0.0])
        strategy.InitializeSolutionStep()
        strategy.Predict()
        if not strategy.SolveSolutionStep():
            return None
        iterations += part.ProcessInfo[Kratos.NL_ITERATION_NUMBER]
        strategy.FinalizeSolutionStep()
    seconds = time.process_time() - start
    outward = ends[0].GetSolutionStepValue(Kratos.DISPLACEMENT_X)
    inward = -ends[1].GetSolutionStepValue(Kratos.DISPLACEMENT_Y)
    counts = {"steps": steps, "iterations": iterations, "matrices": iterations}
    return {"place": [outward, inward], "seconds": seconds} | counts


if __name__ == "__main__":
    main()
