"""A serial chain as Exudyn's kinematic tree: minimal coordinates, the angles of links being relative."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..mechanism import GROUND, Mechanism
from .module import module, recorded


@dataclass(frozen=True)
class Chain:
    """Links in a row; a link's frame is at its joint, turned as its body.

    Attributes
    ----------
    offsets, centres : ndarrays, shape (n, 2)
        Of each joint in the frame of the link before, and of each centre of mass in the link's own frame.
    start : ndarray, shape (n,)
        Joint coordinates: angle relative to the link before, or place along the x axis.
    slides : bool
        Whether the first link slides along the x axis.
    """

    offsets: np.ndarray
    centres: np.ndarray
    start: np.ndarray
    slides: bool


def chain_of(m: Mechanism) -> Chain | None:
    """The mechanism as a chain, each body pinned to the one before; nothing where it is none."""
    count, slides = m.n // 3, m.on_x_axis == (0,)
    hinges = [sorted(pin, key=lambda place: place.body) for pin in m.pins]
    first = [GROUND, *range(count - 1)][slides:]
    if [(i.body, j.body) for i, j in hinges] != [(body, body + 1) for body in first]:
        return None
    offsets, centres = np.zeros((count, 2)), np.zeros((count, 2))
    for before, own in hinges:
        parent = centres[before.body] if before.body != GROUND else 0.0
        offsets[own.body] = np.array([before.a, before.b]) + parent
        centres[own.body] = -own.a, -own.b
    angles = m.start[2::3]
    start = np.diff(angles, prepend=0.0)
    if slides:
        start[0] = m.start[0]
    return Chain(offsets, centres, start, slides)


class Tree:
    """A chain built as a kinematic tree; a spring between the sliding link and ground acts along the x axis."""

    def __init__(self, m: Mechanism, chain: Chain) -> None:
        exu, self._chain, n = module(), chain, len(chain.start)
        from exudyn import itemInterface as items

        self.container = exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        zero = [0.0] * n
        node = self.mbs.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=zero, initialCoordinates=chain.start.tolist(), initialCoordinates_t=zero,
                numberOfODE2Coordinates=n,
            )
        )  # fmt: skip
        kinds = [exu.JointType.RevoluteZ] * n
        stiffness = zero.copy()
        if chain.slides:
            kinds[0] = exu.JointType.PrismaticX
            stiffness[0] = sum(spring.stiffness for spring in m.springs)
        self.mbs.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node, gravity=[0.0, m.gravity, 0.0], jointTypes=kinds, linkParents=list(range(-1, n - 1)),
                jointTransformations=exu.Matrix3DList([np.eye(3)] * n), jointOffsets=_spatial(chain.offsets),
                linkInertiasCOM=exu.Matrix3DList([np.diag([0.0, 0.0, inertia]) for inertia in m.mass[2::3]]),
                linkCOMs=_spatial(chain.centres), linkMasses=m.mass[::3].tolist(),
                jointPControlVector=stiffness, jointDControlVector=zero, jointPositionOffsetVector=zero,
                jointVelocityOffsetVector=zero,
            )
        )  # fmt: skip
        self._sensor = recorded(self.mbs, node)
        self.mbs.Assemble()

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and the coordinates of all bodies at them."""
        found = np.asarray(self.mbs.GetSensorStoredData(self._sensor))
        return found[:, 0], places(self._chain, found[:, 1:])


def places(chain: Chain, y: np.ndarray) -> np.ndarray:
    """Coordinates of all bodies, rows of (x1 y1 phi1 x2 ...), from rows of joint coordinates."""
    turns, origin = y.copy(), np.zeros((len(y), 1), dtype=complex)
    if chain.slides:
        turns[:, 0] = 0.0
        origin[:, 0] = y[:, 0]
    phi = np.cumsum(turns, axis=1)
    before = np.concatenate([np.zeros((len(y), 1)), phi[:, :-1]], axis=1)
    offsets, centres = chain.offsets @ (1, 1j), chain.centres @ (1, 1j)
    z = origin + np.cumsum(offsets * np.exp(1j * before), axis=1) + centres * np.exp(1j * phi)
    return np.stack([z.real, z.imag, phi], axis=2).reshape(len(y), -1)


def _spatial(rows: np.ndarray) -> object:
    return module().Vector3DList([[x, y, 0.0] for x, y in rows])
