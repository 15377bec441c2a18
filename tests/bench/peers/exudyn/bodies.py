"""A mechanism as Exudyn's planar rigid bodies in absolute coordinates, with its joints and connectors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...by_hand import half_car
from ..mechanism import GROUND, Mechanism, Place
from .module import module, recorded


class Bodies:
    """A mechanism built of Exudyn's planar items."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._exu, self._m = module(), mechanism
        self.container = self._exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        from exudyn import itemInterface as items

        self._items = items
        ground = self.mbs.AddObject(items.ObjectGround())
        self._objects = {GROUND: ground}
        self._nodes: list[int] = []
        self._functions: list[Any] = []  # Exudyn does not keep them alive
        for k in range(mechanism.n // 3):
            self._add_body(k)
        self._add_joints()
        self._add_forces()
        self._sensors = [recorded(self.mbs, node) for node in self._nodes]
        self.mbs.Assemble()

    def _add_body(self, k: int) -> None:
        items, mbs, m = self._items, self.mbs, self._m
        node = mbs.AddNode(items.NodeRigidBody2D(initialCoordinates=m.start[3 * k : 3 * k + 3].tolist()))
        body = items.ObjectRigidBody2D(mass=m.mass[3 * k], inertia=m.mass[3 * k + 2], nodeNumber=node)
        self._nodes.append(node)
        self._objects[k] = mbs.AddObject(body)
        if m.gravity:
            marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=self._objects[k]))
            mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, m.gravity, 0]))

    def _point(self, place: Place) -> int:
        return self.mbs.AddMarker(
            self._items.MarkerBodyPosition(bodyNumber=self._objects[place.body], localPosition=[place.a, place.b, 0])
        )

    def _frame(self, place: Place) -> int:
        return self.mbs.AddMarker(
            self._items.MarkerBodyRigid(bodyNumber=self._objects[place.body], localPosition=[place.a, place.b, 0])
        )

    def _add_joints(self) -> None:
        items, mbs = self._items, self.mbs
        for i, j in self._m.pins:
            mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=[self._point(i), self._point(j)]))
        for body in self._m.on_x_axis:
            markers = [self._frame(Place(GROUND, 0, 0)), self._frame(Place(body, 0, 0))]
            mbs.AddObject(items.ObjectJointPrismatic2D(markerNumbers=markers))

    def _add_forces(self) -> None:
        items, mbs, m = self._items, self.mbs, self._m
        for s in m.springs:
            ends = [self._point(s.i), self._point(s.j)]
            law = {"referenceLength": s.free, "stiffness": s.stiffness, "damping": s.damping, "force": -s.load}
            mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=ends, **law))
        for c in m.cushions:
            k, d = [*c.stiffness[:2], 0.0], [*c.damping[:2], 0.0]
            offset = [p / s for p, s in zip(c.preload[:2], c.stiffness[:2], strict=True)]
            ends = [self._point(c.j), self._point(c.i)]
            mbs.AddObject(
                items.ObjectConnectorCartesianSpringDamper(
                    markerNumbers=ends, stiffness=k, damping=d, offset=[*offset, 0.0]
                )
            )
            turns = [self._turn(c.j.body), self._turn(c.i.body)]
            law = {"stiffness": c.stiffness[2], "damping": c.damping[2]}
            mbs.AddObject(items.ObjectConnectorCoordinateSpringDamper(markerNumbers=turns, **law))
        for body, torque in m.torques:
            mbs.AddLoad(items.LoadTorqueVector(markerNumber=self._frame(Place(body, 0, 0)), loadVector=[0, 0, torque]))
        for t in m.tyres:
            self._add_tyre(t.wheel, t.load, t.behind)

    def _turn(self, body: int) -> int:
        return self.mbs.AddMarker(self._items.MarkerNodeCoordinate(nodeNumber=self._nodes[body], coordinate=2))

    def _add_tyre(self, wheel: Place, load: float, behind: float) -> None:
        """Spring and damper to the ground, and the road's part of their force as a load in compiled symbols."""
        from exudyn.advancedUtilities import CreateSymbolicUserFunction

        items, mbs, exu, marker = self._items, self.mbs, self._exu, self._point(wheel)
        law = {"stiffness": [0.0, half_car.TYRE, 0.0], "damping": [0.0, half_car.TYRE_RATE, 0.0]}
        ends = [self._point(Place(GROUND, wheel.a, 0.30)), marker]
        mbs.AddObject(items.ObjectConnectorCartesianSpringDamper(markerNumbers=ends, **law))
        symbols, V = exu.symbolic, half_car.SPEED

        def force(_: Any, t: Any, at_rest: Any) -> list[Any]:
            road = math.pi * symbols.min(symbols.max(V * t - behind, 0.0), 2.0)
            rise, rate = 0.05 * (1 - symbols.cos(road)), 0.05 * math.pi * V * symbols.sin(road)
            return [0, load + half_car.TYRE * rise + half_car.TYRE_RATE * rate, 0]

        function = CreateSymbolicUserFunction(mbs, force, "loadVectorUserFunction", itemTypeName="LoadForceVector")
        self._functions.append(function)
        mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=function))

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and the coordinates of all bodies at them."""
        found = [np.asarray(self.mbs.GetSensorStoredData(sensor)) for sensor in self._sensors]
        return found[0][:, 0], np.concatenate([rows[:, 1:4] for rows in found], axis=1)
