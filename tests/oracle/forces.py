"""Wrenches of force elements, in ground axes: each yields (body, place, force, torque)."""

from __future__ import annotations

import numpy as np

from .geometry import cross, rotation_vector


def line(i, j, pull, poses, u):
    """Yield a tension between two points; `pull` is a function of length and rate."""
    a, b = i.at(poses), j.at(poses)
    length = np.sqrt((a - b) @ (a - b))
    along = (a - b) / length
    force = -pull(length, along @ (i.velocity(poses, u) - j.velocity(poses, u))) * along
    yield i.body, a, force, np.zeros(3)
    yield j.body, b, -force, np.zeros(3)


def at_one_place(i, j, force, torque, poses):
    """Yield a force and torque on i at its point, and the opposite on j's body at the same place."""
    yield i.body, i.at(poses), force, torque
    if j is not None:
        yield j.body, i.at(poses), -force, -torque


def bushing(i, j, stiffness, damping, preload, in_ground, in_space, poses, u):
    """Yield the wrench of a linear bushing of six components."""
    axes = j.turned(poses)
    own = np.eye(3) if in_ground else axes
    d = i.at(poses) - j.at(poses)
    turn = axes.T @ i.turned(poses)
    theta = rotation_vector(turn)
    spin = u[i.body, 3:] - u[j.body, 3:]
    other = j.velocity(poses, u, None if in_ground else i.at(poses))
    rate = i.velocity(poses, u) - other
    if not in_space and not in_ground:
        rate = i.velocity(poses, u) - j.velocity(poses, u, i.at(poses))
    s = np.concatenate([own.T @ d, theta])
    v = np.concatenate([own.T @ rate, axes.T @ spin])
    elastic = preload - stiffness @ s
    viscous = -damping @ v
    force = own @ (elastic + viscous)[:3]
    torque = axes @ (_conjugate(theta) @ elastic[3:] + viscous[3:])
    if in_ground:
        yield i.body, i.at(poses), force, torque
        yield j.body, j.at(poses), -force, -torque
        return
    yield from at_one_place(i, j, force, torque, poses)


def _conjugate(theta):
    """Return the matrix from the moment that does work on the rotation vector to the torque in j's axes: theta' = G w, torque = G^T m."""
    angle = np.linalg.norm(theta)
    k = np.array([[0, -theta[2], theta[1]], [theta[2], 0, -theta[0]], [-theta[1], theta[0], 0]])
    second = 1 / 12 if angle < 1e-3 else (1 - angle / 2 / np.tan(angle / 2)) / angle**2
    return (np.eye(3) - k / 2 + second * k @ k).T


def moment(wrenches, poses, count):
    """Sum wrenches to forces on the centres of mass and torques about them, shape (bodies, 6)."""
    total = np.zeros((count, 6))
    for body, place, force, torque in wrenches:
        total[body, :3] += force
        total[body, 3:] += torque + cross(place - poses.r[body], force)
    return total
