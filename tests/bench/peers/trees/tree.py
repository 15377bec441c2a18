"""Links on hinges in space as plain numbers: what a user of any tool starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

GROUND = -1


@dataclass(frozen=True)
class Link:
    """A body on a hinge; its axes are those of ground at the start, where all hinges are at zero.

    Attributes
    ----------
    parent : int
        Number of the link that carries the hinge; -1 is ground.
    axis : ndarray, shape (3,)
        Of the hinge, a unit vector.
    hinge, centre : ndarrays, shape (3,)
        A point of the hinge, and the centre of mass, at the start in ground axes, m.
    mass : float
        kg; 0 for a link between two hinges through one point.
    inertia : ndarray, shape (3, 3)
        About the centre of mass, kg m^2.
    damping : float
        Of the hinge, N m s/rad.
    rate : float
        Of the hinge at the start, rad/s.
    """

    parent: int
    axis: np.ndarray
    hinge: np.ndarray
    centre: np.ndarray
    mass: float
    inertia: np.ndarray
    damping: float = 0.0
    rate: float = 0.0


@dataclass(frozen=True)
class Tree:
    """Links, each after its parent.

    Attributes
    ----------
    links : tuple of Link
    gravity : ndarray, shape (3,)
    times : ndarray
        Of output, evenly spaced, s.
    """

    links: tuple[Link, ...]
    gravity: np.ndarray
    times: np.ndarray

    @property
    def damping(self) -> np.ndarray:
        """Of all hinges, N m s/rad."""
        return np.array([link.damping for link in self.links])

    @property
    def rates(self) -> np.ndarray:
        """Of all hinges at the start, rad/s."""
        return np.array([link.rate for link in self.links])

    def from_parent(self, k: int) -> np.ndarray:
        """From the hinge of a link's parent, or from the origin, to its own hinge at the start, m."""
        link = self.links[k]
        before = np.zeros(3) if link.parent == GROUND else self.links[link.parent].hinge
        return np.asarray(link.hinge - before)

    def motion_at_start(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Angular velocities of all links, rad/s, and the velocities of their hinges, m/s, at the start in ground axes."""
        omega: list[np.ndarray] = []
        velocity: list[np.ndarray] = []
        for k, link in enumerate(self.links):
            at_rest = link.parent == GROUND
            before = np.zeros(3) if at_rest else omega[link.parent]
            omega.append(before + link.rate * link.axis)
            velocity.append(np.zeros(3) if at_rest else velocity[link.parent] + np.cross(before, self.from_parent(k)))
        return omega, velocity

    def places(self, angles: np.ndarray) -> np.ndarray:
        """Centres of mass of all links that have a mass, rows of (x1 y1 z1 x2 ...), from rows of hinge angles."""
        turned: list[np.ndarray] = []
        hinges: list[np.ndarray] = []
        centres = []
        for k, link in enumerate(self.links):
            frame, origin = (
                (turned[link.parent], hinges[link.parent]) if link.parent != GROUND else (np.eye(3)[None], 0.0)
            )
            turned.append(frame @ rotations(link.axis, angles[:, k]))
            hinges.append(origin + frame @ self.from_parent(k))
            if link.mass:
                centres.append(hinges[k] + turned[k] @ (link.centre - link.hinge))
        return np.concatenate(centres, axis=1)


def rotations(axis: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Rotation matrices about an axis by angles, shape (n, 3, 3): Rodrigues' formula."""
    x, y, z = axis
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.eye(3) + sine * across + (1 - cosine) * (across @ across)
