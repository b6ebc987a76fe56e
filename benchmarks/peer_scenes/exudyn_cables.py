"""A cable of Exudyn (``ObjectANCFCable``): imports nothing but what its own environment has.

Standard input is JSON: position and slope of all nodes as they lie, the rates of both, lengths
of the elements, ``EA``, ``EI``, mass per length, gravity, pinned nodes, nodes and times asked for,
and the step. Standard output is JSON: their positions, shape (times, nodes, 3).
"""

from __future__ import annotations

import json
import sys
from itertools import pairwise
from typing import Any

# must be said before the import
sys.exudynFast = True  # type: ignore[attr-defined]
import exudyn as exu  # noqa: E402
import exudyn.itemInterface as item  # noqa: E402
import numpy as np  # noqa: E402


def build(mbs: Any, request: dict[str, Any]) -> list[Any]:
    """Add the cable; its sensors."""
    ground = mbs.AddNode(item.NodePointGround())
    fixed = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    nodes = [
        mbs.AddNode(item.NodePointSlope1(referenceCoordinates=rows, initialVelocities=rates))
        for rows, rates in zip(request["rows"], request["rates"], strict=True)
    ]
    for ends, length in zip(pairwise(nodes), request["lengths"], strict=True):
        cable = item.ObjectANCFCable(
            nodeNumbers=list(ends),
            physicsLength=length,
            physicsMassPerLength=request["mass"],
            physicsBendingStiffness=request["EI"],
            physicsAxialStiffness=request["EA"],
        )
        body = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=mbs.AddObject(cable)))
        mbs.AddLoad(item.LoadMassProportional(markerNumber=body, loadVector=request["gravity"]))
    for node in request["pinned"]:
        for k in range(3):
            held = item.MarkerNodeCoordinate(nodeNumber=nodes[node], coordinate=k)
            mbs.AddObject(item.CoordinateConstraint(markerNumbers=[fixed, mbs.AddMarker(held)]))
    return [
        mbs.AddSensor(
            item.SensorNode(
                nodeNumber=nodes[k],
                storeInternal=True,
                outputVariableType=exu.OutputVariableType.Position,
            )
        )
        for k in request["asked"]
    ]


def main() -> None:
    """Answer."""
    request = json.loads(sys.stdin.read())
    mbs = exu.SystemContainer().AddSystem()
    sensors = build(mbs, request)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = request["step"]
    settings.parallel.numberOfThreads = 1
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    motion = settings.timeIntegration
    motion.verboseMode = 0
    motion.endTime = request["times"][-1]
    motion.numberOfSteps = round(motion.endTime / request["step"])
    motion.generalizedAlpha.spectralRadius = request["radius"]
    motion.newton.useModifiedNewton = True
    motion.newton.relativeTolerance = 1e-6
    mbs.SolveDynamic(settings)
    rows = np.rint(np.array(request["times"]) / request["step"]).astype(int)
    found = np.stack([mbs.GetSensorStoredData(k)[rows, 1:] for k in sensors], axis=1)
    print(json.dumps(found.tolist()))


if __name__ == "__main__":
    main()
