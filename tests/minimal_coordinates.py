"""Lagrange's equations in minimal coordinates: a second way to the motion of open chains, without any constraint.

Nothing here is shared with the package: numpy and scipy alone. Derivatives are taken by the complex step (Squire and
Trapp, SIAM Review 40, 1998), which is exact to rounding, so all functions take complex coordinates too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

TINY = 1e-30
"""Complex step; its square is lost in rounding."""


def cross(a, b):
    """Vector product of two 3-vectors (`numpy.cross` takes ten times as long)."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def turned(axis, angle):
    """Rotation matrix about a unit axis (Rodrigues' formula)."""
    x, y, z = axis
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * (across @ across)


@dataclass(frozen=True)
class Link:
    """A body that turns about an axis of the body it hangs on.

    In the pose q = 0 the axes of all links are those of the ground.

    Attributes
    ----------
    axis : unit vector of the hinge.
    offset : from the parent's hinge to this hinge (m).
    center : from this hinge to the centre of mass (m).
    mass : kg.
    inertia : (3, 3) tensor about the centre of mass (kg m^2).
    parent : index of the parent, -1 for the ground.
    """

    axis: tuple
    offset: tuple = (0, 0, 0)
    center: tuple = (0, 0, 0)
    mass: float = 0.0
    inertia: np.ndarray | float = 0.0
    parent: int = -1


@dataclass(frozen=True)
class Pose:
    """Where a link is: its hinge, its rotation matrix, its centre, and both geometric Jacobians (3, n)."""

    hinge: np.ndarray
    turn: np.ndarray
    center: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray


def poses(links, q) -> list[Pose]:
    """Poses of all links at the hinge angles q; parents stand before children."""
    found: list[Pose] = []
    for k, link in enumerate(links):
        up = found[link.parent] if link.parent >= 0 else None
        turn = up.turn if up else np.eye(3)
        hinge = (up.hinge if up else 0) + turn @ np.array(link.offset, float)
        axis = turn @ np.array(link.axis, float)
        turn = turn @ turned(link.axis, q[k])
        center = hinge + turn @ np.array(link.center, float)
        axes, feet, above, j = {k: axis}, {k: hinge}, up, link.parent
        while above is not None:
            axes[j], feet[j] = above.rotation[:, j], above.hinge
            j = links[j].parent
            above = found[j] if j >= 0 else None
        translation = np.zeros((3, len(links)), turn.dtype)
        rotation = np.zeros((3, len(links)), turn.dtype)
        for i in axes:
            rotation[:, i] = axes[i]
            translation[:, i] = cross(axes[i], center - feet[i])
        found.append(Pose(hinge, turn, center, translation, rotation))
    return found


def mass_matrix(links, at):
    """Mass matrix (n, n) of a tree of links at the given poses."""
    total = 0
    for link, pose in zip(links, at, strict=True):
        inertia = pose.turn @ (link.inertia * np.eye(3) if np.isscalar(link.inertia) else link.inertia) @ pose.turn.T
        total = total + link.mass * pose.translation.T @ pose.translation + pose.rotation.T @ inertia @ pose.rotation
    return total


def potential(links, at, gravity):
    """Potential energy of the weights (J)."""
    return -sum(link.mass * (np.array(gravity) @ pose.center) for link, pose in zip(links, at, strict=True))


def slope(function, q, direction):
    """Derivative of a function along a direction, by the complex step."""
    return np.imag(function(q + 1j * TINY * np.asarray(direction))) / TINY


def accelerations(inertia, energy, q, u, force=0.0):
    """Second derivatives of minimal coordinates, by Lagrange's equations.

    Parameters
    ----------
    inertia, energy : mass matrix (n, n) and potential energy as functions of q.
    q, u : (n,) coordinates and their rates.
    force : (n,) generalised force beyond the potential's.
    """
    n = len(q)
    slopes = [slope(inertia, q, direction) for direction in np.eye(n)]
    moving = sum(rate * change for rate, change in zip(u, slopes, strict=True))
    kinetic = np.array([u @ change @ u / 2 for change in slopes])
    pull = np.array([slope(energy, q, direction) for direction in np.eye(n)])
    return np.linalg.solve(inertia(q), force + kinetic - pull - moving @ u)


def motion(links, t, q, u, gravity=(0, 0, -9.81), rtol=1e-12):
    """Motion of a tree of links from (q, u) under gravity: hinge angles and rates, (n, len(t)) each.

    DOP853; energy is kept to some 100 rtol.
    """

    def inertia(q):
        return mass_matrix(links, poses(links, q))

    def energy(q):
        return potential(links, poses(links, q), gravity)

    def rates(_, y):
        q, u = np.split(y, 2)
        return np.concatenate([u, accelerations(inertia, energy, q, u)])

    found = solve_ivp(rates, (0, t[-1]), np.concatenate([q, u]), "DOP853", t_eval=t, rtol=rtol, atol=rtol)
    return np.split(found.y, 2)


def energies(links, q, u, gravity=(0, 0, -9.81)):
    """Total energy (J) over time, for the shapes `motion` returns."""
    found = []
    for angles, rates in zip(q.T, u.T, strict=True):
        at = poses(links, angles)
        found.append(rates @ mass_matrix(links, at) @ rates / 2 + potential(links, at, gravity))
    return np.array(found)
