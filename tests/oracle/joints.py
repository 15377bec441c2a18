"""Constraint equations of joints between two markers, in the order of the rows that the package documents."""

from __future__ import annotations

from functools import partial

from .geometry import arctan2


def angle(i, j, poses):
    """Return the angle of i against j about j's z, up to full turns."""
    a, b = i.turned(poses), j.turned(poses)
    return arctan2(a[:, 0] @ b[:, 1], a[:, 0] @ b[:, 0])


def displacement(axis, i, j, poses):
    """Return the displacement of i from j along an axis of j."""
    return (i.at(poses) - j.at(poses)) @ j.turned(poses)[:, axis]


def _coincide(i, j, poses):
    return [*(i.at(poses) - j.at(poses))]


def _align(i, j, poses):
    z = j.turned(poses)[:, 2]
    return [i.turned(poses)[:, 0] @ z, i.turned(poses)[:, 1] @ z]


def _orient(i, j, poses):
    a, b = i.turned(poses), j.turned(poses)
    return [a[:, 0] @ b[:, 1], a[:, 1] @ b[:, 2], a[:, 2] @ b[:, 0]]


def _along(*axes):
    return lambda i, j, poses: [displacement(axis, i, j, poses) for axis in axes]


def _rod(length, i, j, poses):
    d = i.at(poses) - j.at(poses)
    return [(d @ d - length**2) / (2 * length)]


def _across(i, j, poses):
    return [i.turned(poses)[:, 2] @ j.turned(poses)[:, 2]]


def _angle(i, j, poses):
    return [angle(i, j, poses)]


def _in_plane(i, j, poses):
    return _coincide(i, j, poses)[:2]


PLANE = {
    "revolute": (_in_plane,),
    "prismatic": (_along(1), _angle),
    "fixed": (_in_plane, _angle),
    "point_on_line": (_along(1),),
}
SPACE = {
    "revolute": (_coincide, _align),
    "prismatic": (_along(0, 1), _orient),
    "cylindrical": (_along(0, 1), _align),
    "spherical": (_coincide,),
    "universal": (_coincide, _across),
    "fixed": (_coincide, _orient),
    "planar": (_along(2), _align),
    "parallel": (_align,),
    "perpendicular": (_across,),
    "orientation": (_orient,),
    "point_on_line": (_along(0, 1),),
    "point_on_plane": (_along(2),),
}


def equations(kind, in_space, length=None):
    """Return the functions (i, j, poses) of a joint's residuals; KeyError for a kind that is not here."""
    if kind == "distance":
        return (partial(_rod, length),)
    if kind == "revolute_spherical" and in_space:
        return partial(_rod, length), _along(2)
    return (SPACE if in_space else PLANE)[kind]
