"""Interfaces of a flexible body: nodes that move with a marker, rigidly or on average."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .finite_elements import DISPLACEMENTS, PRECISION, FiniteElements, rigid_motions

AVERAGE, POINT, RIGID = "average", "point", "rigid"


@dataclass(frozen=True, eq=False)
class Interface:
    """Nodes that a marker holds."""

    name: str
    # ``rigid``: the nodes move as a rigid body with the marker (RBE2). ``average``: the marker takes the mean
    # displacement and rotation of the nodes (RBE3). ``point``: one node, without a rotation.
    kind: str
    nodes: np.ndarray  # of int
    point: np.ndarray  # shape (3,): reference point, m
    weights: np.ndarray | None = None  # of the nodes of an average, shape (nodes,); equal by default

    @property
    def size(self) -> int:
        """Number of its coordinates: three displacements, and three rotations unless it is a point."""
        return 3 if self.kind == POINT else 6

    @property
    def turns_nodes(self) -> bool:
        """True if it holds the rotations of nodes that have them, not their displacements alone."""
        return self.kind == RIGID

    def entries(self, model: FiniteElements) -> np.ndarray:
        """Return the places of the components that it holds among those of the body."""
        return model.entries(self.nodes) if self.turns_nodes else model.displacements(self.nodes)

    def rigid(self, model: FiniteElements) -> np.ndarray:
        """Return the components of its nodes that it holds by its coordinates, shape (entries, size)."""
        components = model.components if self.turns_nodes else DISPLACEMENTS
        return rigid_motions(model.nodes[self.nodes] - self.point, components)[:, : self.size]

    def mean(self, model: FiniteElements) -> np.ndarray:
        """Return its coordinates by the components that it holds in the sense of least squares (RBE3)."""
        if self.weights is None:
            return np.linalg.pinv(self.rigid(model))
        weighted = self.rigid(model).T * np.repeat(self.weights, 3)
        return np.linalg.solve(weighted @ self.rigid(model), weighted)


def check_interfaces(interfaces: list[Interface], model: FiniteElements) -> None:
    """Refuse interfaces without nodes, of nodes on one line, and rigid interfaces that share nodes.

    Raises InputError.
    """
    owner: dict[int, str] = {}
    for interface in interfaces:
        name, nodes = interface.name, interface.nodes
        if len(nodes) == 0:
            raise InputError(
                f"interfaces.{name}: found no node in its selection, expected three or more, or one with type: point"
            )
        if interface.kind == POINT:
            if len(nodes) > 1:
                raise InputError(f"interfaces.{name}: found {len(nodes)} nodes, expected one for type: point")
        elif interface.kind == AVERAGE or not model.turns(nodes):
            extent = np.linalg.svd(model.nodes[nodes] - model.nodes[nodes].mean(axis=0), compute_uv=False)
            if len(nodes) < 3 or extent[1] <= PRECISION * extent[0]:
                count = f"{len(nodes)} node{'s' if len(nodes) > 1 else ''}{' on one line' if len(nodes) > 1 else ''}"
                also = " or type: rigid" if model.turns(nodes) else ""
                raise InputError(
                    f"interfaces.{name}: found {count}, expected three or more that are not on one line, "
                    f"or one with type: point{also}"
                )
        for node in nodes.tolist():
            if node in owner:
                raise InputError(
                    f"interfaces.{name}: found node {node} of interface '{owner[node]}' too, expected it in one interface"
                )
            owner[node] = name
