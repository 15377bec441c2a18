"""Exudyn's kinematic tree by its explicit fixed steps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...contestant import Contestant, Solve
from ..exudyn import EXPLICIT_PARTS, WITHOUT, marching
from ..exudyn.module import module, recorded
from .tree import GROUND, Tree


def contestants(tree: Tree) -> Iterator[Contestant]:
    """Runge-Kutta methods of orders 4 and 6."""
    spacing = float(tree.times[1] - tree.times[0])
    steps = tuple(spacing / part for part in EXPLICIT_PARTS)
    for name in ("RK44", "RK67"):
        method = getattr(module().DynamicSolverType, name)

        def at(step: float, method: object = method) -> Solve:
            return marching(Hinges(tree), method, tree.times, step, WITHOUT)

        yield Contestant(f"Exudyn {name}, tree", True, at, "step", steps)


class Hinges:
    """A tree built of Exudyn's items; the frame of a link has its z axis along the hinge."""

    def __init__(self, tree: Tree) -> None:
        exu, self._tree, n = module(), tree, len(tree.links)
        from exudyn import itemInterface as items

        frames = [_along(link.axis) for link in tree.links]
        before = [np.eye(3) if link.parent == GROUND else frames[link.parent] for link in tree.links]
        zero = [0.0] * n
        self.container = exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        node = self.mbs.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=zero, initialCoordinates=zero, initialCoordinates_t=tree.rates.tolist(),
                numberOfODE2Coordinates=n,
            )
        )  # fmt: skip
        self.mbs.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node, gravity=tree.gravity.tolist(), jointTypes=[exu.JointType.RevoluteZ] * n,
                linkParents=[link.parent for link in tree.links],
                jointTransformations=exu.Matrix3DList([A.T @ F for A, F in zip(before, frames, strict=True)]),
                jointOffsets=exu.Vector3DList([A.T @ tree.from_parent(k) for k, A in enumerate(before)]),
                linkInertiasCOM=exu.Matrix3DList([F.T @ link.inertia @ F for F, link in zip(frames, tree.links, strict=True)]),
                linkCOMs=exu.Vector3DList([F.T @ (link.centre - link.hinge) for F, link in zip(frames, tree.links, strict=True)]),
                linkMasses=[link.mass for link in tree.links],
                jointPControlVector=zero, jointDControlVector=tree.damping.tolist(), jointPositionOffsetVector=zero,
                jointVelocityOffsetVector=zero,
            )
        )  # fmt: skip
        self._sensor = recorded(self.mbs, node)
        self.mbs.Assemble()

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and the centres of mass at them."""
        found = np.asarray(self.mbs.GetSensorStoredData(self._sensor))
        return found[:, 0], self._tree.places(found[:, 1:])


def _along(axis: np.ndarray) -> np.ndarray:
    """A rotation matrix whose third column is a unit vector."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    x = np.cross(other, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])
