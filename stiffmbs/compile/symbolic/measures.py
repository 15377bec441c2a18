"""Measures between two markers, named as in Adams."""

from __future__ import annotations

from typing import Any

import sympy as sp

from .element import SymbolicElement


def measure(name: str, e: SymbolicElement, markers: list[Any]) -> sp.Expr:
    """Return a measure of marker a relative to marker b, optionally in the axes of a third marker.

    Displacements dx dy dz dm, their rates vx vy vz vr and the speed vm; continuous angles ax ay az about b's axes;
    angular velocities wx wy wz wm. Planar models have a subset.
    """
    a, b, *along = markers
    d = a.point - b.point
    match name:
        case "dm":
            return e.distance(a.point, b.point)
        case "vr":
            return e.rate(e.distance(a.point, b.point))
        case "vm":
            return e.distance(e.rate(d), 0 * d)
        case "ax" | "ay" | "az":
            return a.angle_about(name[1], b, e)
        case "wm":
            return e.distance(a.omega, b.omega)
    axes = along[0].axes if along else [sp.eye(len(d))[:, k] for k in range(len(d))]
    match name[0]:
        case "d":
            return d.dot(axes["xyz".index(name[1])])
        case "v":
            return e.rate(d).dot(axes["xyz".index(name[1])])
    return (a.omega - b.omega).dot(axes["xyz".index(name[1])]) if len(d) == 3 else e.rate(a.angle_about("z", b, e))


def own_coordinate(name: str, marker: Any) -> sp.Expr:
    """Return a component of a body's quaternion or angular velocity in the body's own axes, those of `marker`."""
    if name[0] == "w":
        return marker.own_omega["xyz".index(name[1])]
    return marker.quaternion[int(name[1])]
