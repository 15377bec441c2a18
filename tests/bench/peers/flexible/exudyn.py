"""Exudyn: ANCF cables and geometrically exact beams in the plane, and the reduced-order floating frame, by generalised-alpha."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from ...contestant import Contestant, Solve
from ..exudyn import Built, marching
from ..exudyn.module import module
from .tasks import GRAVITY, HungBeam, HungBody

PARTS = tuple(round(10 * 2 ** (k / 2)) for k in range(17))
"""Steps from one output time to the next."""
ELEMENTS = {
    "ANCF cable": (8, 0.5), "ANCF cable, more elements": (16, 0.5), "exact beam": (10, 1.0), "exact beam, more elements": (20, 1.0)
}  # fmt: skip
"""Elements with the loosest steps, and their power of the number of steps.

An exact beam has errors of second order in the step and in the elements, a cable of fourth order in the elements.
"""
NEWTON = (1e-6, 1e-8)
"""Relative and absolute tolerance of Newton's iteration; tighter ones make it fail with many elements."""


def contestants(task: HungBeam | HungBody) -> Iterator[Contestant]:
    """The kinds of elements for a beam, or the reduced body."""
    steps = tuple(float(task.times[1] - task.times[0]) / part for part in PARTS)
    if isinstance(task, HungBody):
        yield _contestant("Exudyn floating frame", task.times, steps, lambda _: Reduced(task))
        return
    for name, (loosest, power) in ELEMENTS.items():

        def build(step: float, name: str = name, loosest: int = loosest, power: float = power) -> Built:
            return Beam(task, name.startswith("ANCF"), round(loosest * (steps[0] / step) ** power))

        yield _contestant(f"Exudyn {name}", task.times, steps, build)


def _contestant(name: str, times: np.ndarray, steps: tuple[float, ...], build: Callable[[float], Built]) -> Contestant:
    def at(step: float) -> Solve:
        return marching(build(step), module().DynamicSolverType.GeneralizedAlpha, times, step, NEWTON, modified=True)

    return Contestant(name, True, at, "step", steps)


class _Recorded:
    """A system and the position of one marker over time."""

    def __init__(self) -> None:
        from exudyn import itemInterface as items

        self._exu, self._items = module(), items
        self.container = self._exu.SystemContainer()
        self.mbs = self.container.AddSystem()

    def _record(self, marker: int) -> None:
        kind = self._exu.OutputVariableType.Position
        sensor = self._items.SensorMarker(
            markerNumber=marker, storeInternal=True, writeToFile=False, outputVariableType=kind
        )
        self._sensor = self.mbs.AddSensor(sensor)
        self.mbs.Assemble()

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and x and y, or x and z."""
        found = np.asarray(self.mbs.GetSensorStoredData(self._sensor))
        return found[:, 0], found[:, [1, 2 + self._up]]

    _up = 0


class Beam(_Recorded):
    """A beam of cables or of exact elements with two nodes."""

    def __init__(self, task: HungBeam, cable: bool, n: int) -> None:
        super().__init__()
        nodes, objects = (self._cables if cable else self._beams)(task, n)
        for each in objects:
            marker = self.mbs.AddMarker(self._items.MarkerBodyMass(bodyNumber=each))
            self.mbs.AddLoad(self._items.LoadMassProportional(markerNumber=marker, loadVector=[0, -GRAVITY, 0]))
        slope = 3 if cable else 2  # of a cable the slope across x, of a beam the angle
        ground = self.mbs.AddMarker(
            self._items.MarkerNodeCoordinate(nodeNumber=self.mbs.AddNode(self._items.NodePointGround()), coordinate=0)
        )
        for held in (0, 1, *([slope] if task.clamped else [])):
            own = self.mbs.AddMarker(self._items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=held))
            self.mbs.AddObject(self._items.CoordinateConstraint(markerNumbers=[ground, own]))
        self._record(self.mbs.AddMarker(self._items.MarkerNodePosition(nodeNumber=nodes[-1])))

    def _cables(self, task: HungBeam, n: int) -> tuple[list[int], list[int]]:
        items, (EA, _, EI) = self._items, task.stiffness
        nodes = [
            self.mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[k / n, 0.0, 1.0, 0.0])) for k in range(n + 1)
        ]
        law = {"massPerLength": task.mass[0], "bendingStiffness": EI, "axialStiffness": EA}
        return nodes, [
            self.mbs.AddObject(items.ObjectANCFCable2D(nodeNumbers=nodes[k : k + 2], length=1 / n, **law))
            for k in range(n)
        ]

    def _beams(self, task: HungBeam, n: int) -> tuple[list[int], list[int]]:
        items, (EA, GA, EI), (mass, inertia) = self._items, task.stiffness, task.mass
        nodes = [self.mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[k / n, 0.0, 0.0])) for k in range(n + 1)]
        law = {
            "massPerLength": mass, "crossSectionInertia": inertia, "bendingStiffness": EI,
            "axialStiffness": EA, "shearStiffness": GA,
        }  # fmt: skip
        return nodes, [
            self.mbs.AddObject(items.ObjectBeamGeometricallyExact2D(nodeNumbers=nodes[k : k + 2], length=1 / n, **law))
            for k in range(n)
        ]


class Reduced(_Recorded):
    """`ObjectFFRFreducedOrder` with the modes of this package, so that both solve the same equations."""

    _up = 1

    def __init__(self, task: HungBody) -> None:
        from exudyn import FEM

        super().__init__()
        items, model = self._items, task.model
        given = FEM.FEMinterface()
        given.nodes = {"Position": np.array(model.nodes)}
        given.massMatrix, given.stiffnessMatrix = csr_matrix(model.mass), csr_matrix(model.stiffness)
        given.modeBasis = {"matrix": np.array(task.modes), "type": "NodalModes"}
        reduced = FEM.ObjectFFRFreducedOrderInterface(given)
        made: dict[str, Any] = reduced.AddObjectFFRFreducedOrder(
            self.mbs, positionRef=[0, 0, 0], gravity=[0, 0, -GRAVITY], stiffnessProportionalDamping=task.damping
        )
        hinge, end = (
            self.mbs.AddMarker(
                items.MarkerSuperElementRigid(
                    bodyNumber=made["oFFRFreducedOrder"], meshNodeNumbers=nodes.tolist(),
                    weightingFactors=[1 / len(nodes)] * len(nodes),
                )
            )
            for nodes in task.ends
        )  # fmt: skip
        ground = self.mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=self.mbs.AddObject(items.ObjectGround())))
        self.mbs.AddObject(items.GenericJoint(markerNumbers=[ground, hinge], constrainedAxes=[1, 1, 1, 1, 0, 1]))
        self._record(end)
