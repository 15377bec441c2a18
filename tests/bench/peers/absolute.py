"""Constraints and forces in absolute coordinates, in any tool's symbols."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

from ..by_hand import half_car
from .mechanism import GROUND, Mechanism, Place


@dataclass(frozen=True)
class Maths:
    """A tool's functions of its symbols."""

    sin: Any
    cos: Any
    sqrt: Any
    least: Any
    greatest: Any


def point(place: Place, q: Sequence[Any], maths: Maths) -> tuple[Any, Any]:
    """Where a point is."""
    if place.body == GROUND:
        return place.a, place.b
    x, y, phi = q[3 * place.body : 3 * place.body + 3]
    s, c = maths.sin(phi), maths.cos(phi)
    return x + place.a * c - place.b * s, y + place.a * s + place.b * c


def velocity(place: Place, q: Sequence[Any], u: Sequence[Any], maths: Maths) -> tuple[Any, Any]:
    """How fast a point moves."""
    if place.body == GROUND:
        return 0.0, 0.0
    k = 3 * place.body
    (x, y), w = point(place, q, maths), u[k + 2]
    return u[k] - (y - q[k + 1]) * w, u[k + 1] + (x - q[k]) * w


def constraints(m: Mechanism, q: Sequence[Any], maths: Maths) -> list[Any]:
    """C(q)."""
    rows = [value for body in m.on_x_axis for value in (q[3 * body + 1], q[3 * body + 2])]
    for i, j in m.pins:
        rows += [a - b for a, b in zip(point(i, q, maths), point(j, q, maths), strict=True)]
    return rows


def forces(m: Mechanism, t: Any, q: Sequence[Any], u: Sequence[Any], maths: Maths) -> list[Any]:
    """f(t, q, u), generalised forces in the order of the coordinates."""
    f: list[Any] = [mass * m.gravity if k % 3 == 1 else 0.0 for k, mass in enumerate(m.mass)]

    def push(place: Place, fx: Any, fy: Any) -> None:
        if place.body != GROUND:
            k, (x, y) = 3 * place.body, point(place, q, maths)
            f[k] += fx
            f[k + 1] += fy
            f[k + 2] += (x - q[k]) * fy - (y - q[k + 1]) * fx

    def between(i: Place, j: Place) -> tuple[Any, Any, Any, Any]:
        (x, y), (x0, y0) = point(i, q, maths), point(j, q, maths)
        (vx, vy), (vx0, vy0) = velocity(i, q, u, maths), velocity(j, q, u, maths)
        return x - x0, y - y0, vx - vx0, vy - vy0

    for s in m.springs:
        dx, dy, vx, vy = between(s.i, s.j)
        length = maths.sqrt(dx * dx + dy * dy)
        force = s.load - s.stiffness * (length - s.free) - s.damping * (dx * vx + dy * vy) / length
        push(s.i, force * dx / length, force * dy / length)
        push(s.j, -force * dx / length, -force * dy / length)
    for b in m.cushions:
        dx, dy, vx, vy = between(b.i, b.j)
        fx = b.preload[0] - b.stiffness[0] * dx - b.damping[0] * vx
        fy = b.preload[1] - b.stiffness[1] * dy - b.damping[1] * vy
        push(b.i, fx, fy)
        push(b.j, -fx, -fy)
        i, j = 3 * b.i.body + 2, 3 * b.j.body + 2
        turn = b.stiffness[2] * (q[i] - q[j]) + b.damping[2] * (u[i] - u[j])
        f[i] -= turn
        f[j] += turn
    for tyre in m.tyres:
        road = pi * maths.least(maths.greatest(half_car.SPEED * t - tyre.behind, 0.0), 2.0)
        rise = 0.05 * (1 - maths.cos(road)) - (point(tyre.wheel, q, maths)[1] - 0.30)
        rate = 0.05 * pi * half_car.SPEED * maths.sin(road) - velocity(tyre.wheel, q, u, maths)[1]
        push(tyre.wheel, 0.0, tyre.load + half_car.TYRE * rise + half_car.TYRE_RATE * rate)
    for body, torque in m.torques:
        f[3 * body + 2] += torque
    return f
