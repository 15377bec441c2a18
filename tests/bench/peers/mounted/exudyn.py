"""Exudyn: rigid bodies in absolute coordinates with its connectors, by explicit fixed steps and by generalised-alpha."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...contestant import Contestant, Solve
from ..exudyn import EXPLICIT_PARTS, IMPLICIT_PARTS, WITHOUT, marching
from ..exudyn.module import module, recorded
from .mounted import GROUND, Mounted, Shaken, Shown

PER_BODY = 6
"""Displacement of the centre of mass, and the angles of turns about x, y and z one after the other, which stay small here."""


def contestants(given: Shaken) -> Iterator[Contestant]:
    """Runge-Kutta methods of orders 4 and 6, and the implicit method."""
    m, kinds = given.mounted, module().DynamicSolverType
    spacing = float(m.times[1] - m.times[0])
    methods = (("RK44", kinds.RK44, EXPLICIT_PARTS), ("RK67", kinds.RK67, EXPLICIT_PARTS),
               ("generalised-alpha", kinds.GeneralizedAlpha, IMPLICIT_PARTS))  # fmt: skip
    for name, method, parts in methods:

        def at(step: float, method: object = method) -> Solve:
            return marching(Solids(m, given.shown), method, m.times, step, WITHOUT)

        yield Contestant(f"Exudyn {name}", True, at, "step", tuple(spacing / part for part in parts))


class Solids:
    """Bodies on bushings and struts, built of Exudyn's items."""

    def __init__(self, mounted: Mounted, shown: Shown) -> None:
        self._exu, self._m, self._shown = module(), mounted, shown
        self.container = self._exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        from exudyn import itemInterface as items

        self._items = items
        self._objects = {GROUND: self.mbs.AddObject(items.ObjectGround())}
        nodes = [self._add_body(k) for k in range(len(mounted.solids))]
        for mount in mounted.mounts:
            ends = [self._marker(body, mount.point) for body in (mount.j, mount.i)]
            law = {"stiffness": mount.stiffness.tolist(), "damping": mount.damping.tolist()}
            self.mbs.AddObject(items.ObjectConnectorCartesianSpringDamper(markerNumbers=ends, **law))
        for strut in mounted.struts:
            ends = [self._marker(strut.i, strut.end), self._marker(strut.j, strut.other)]
            law = {"stiffness": strut.stiffness, "damping": strut.damping}
            length = float(np.linalg.norm(strut.end - strut.other))
            self.mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=ends, referenceLength=length, **law))
        self._function = self._add_shaker()  # Exudyn does not keep it alive
        kinds = self._exu.OutputVariableType
        self._sensors = [
            [recorded(self.mbs, node, kind) for kind in (kinds.Coordinates, kinds.Coordinates_t)] for node in nodes
        ]
        self.mbs.Assemble()

    def _add_body(self, k: int) -> int:
        solid, items = self._m.solids[k], self._items
        node = int(
            self.mbs.AddNode(items.NodeRigidBodyRxyz(referenceCoordinates=[*solid.centre.tolist(), 0.0, 0.0, 0.0]))
        )
        body = items.ObjectRigidBody(
            mass=solid.mass, inertia=[*solid.moments.tolist(), 0.0, 0.0, 0.0], nodeNumber=node
        )  # fmt: skip
        self._objects[k] = self.mbs.AddObject(body)
        return node

    def _marker(self, body: int, point: np.ndarray) -> int:
        place = self._m.arm(body, point).tolist()
        return int(
            self.mbs.AddMarker(self._items.MarkerBodyPosition(bodyNumber=self._objects[body], localPosition=place))
        )

    def _add_shaker(self) -> Any:
        """The load in compiled symbols."""
        from exudyn.advancedUtilities import CreateSymbolicUserFunction

        m, symbols = self._m, self._exu.symbolic

        def push(_: Any, t: Any, at_rest: Any) -> list[Any]:
            return [0, 0, m.amplitude * symbols.sin(m.rate * t)]

        function = CreateSymbolicUserFunction(self.mbs, push, "loadVectorUserFunction", itemTypeName="LoadForceVector")
        marker = self._marker(m.shaken, m.solids[m.shaken].centre)
        self.mbs.AddLoad(self._items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=function))
        return function

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and what is compared at them."""
        found = [[np.asarray(self.mbs.GetSensorStoredData(sensor)) for sensor in pair] for pair in self._sensors]
        t = found[0][0][:, 0]
        q, u = (np.stack([pair[k][:, 1:] for pair in found], axis=1) for k in (0, 1))
        x = q[..., :3] + np.array([solid.centre for solid in self._m.solids])
        return t, self._shown(x, _parameters(q[..., 3:]), u[..., :3], _spins(q[..., 3:], u[..., 3:]))


def _parameters(angles: np.ndarray) -> np.ndarray:
    """Euler parameters of turns about x, then the new y, then the new z."""
    (ca, cb, cc), (sa, sb, sc) = (np.moveaxis(part(angles / 2), -1, 0) for part in (np.cos, np.sin))
    return np.stack(
        [
            ca * cb * cc - sa * sb * sc, sa * cb * cc + ca * sb * sc, ca * sb * cc - sa * cb * sc,
            ca * cb * sc + sa * sb * cc,
        ],
        axis=-1,
    )  # fmt: skip


def _spins(angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Angular velocities in body axes."""
    (_, cb, cc), (_, sb, sc) = (np.moveaxis(part(angles), -1, 0) for part in (np.cos, np.sin))
    a, b, c = np.moveaxis(rates, -1, 0)
    return np.stack([cb * cc * a + sc * b, -cb * sc * a + cc * b, sb * a + c], axis=-1)
