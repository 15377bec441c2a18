"""A joint and a force of the plane, made of the public names alone."""

from typing import ClassVar

import sympy as sp
from pydantic import Field

import stiffmbs
from stiffmbs import Marker, si


class Ring(stiffmbs.Joint):
    """A point on a ring: the point of marker i stays at a distance from that of marker j, on a circle about it."""

    kind = "ring"
    equations = ("distance",)

    i: Marker = Field(description="marker of the first body")
    j: Marker = Field(description="the centre")
    radius: si.PositiveLength = Field(description="m")

    @staticmethod
    def position(e):
        d = e.i.point - e.j.point
        return [d.dot(d) - e.radius**2]


class Bumper(stiffmbs.Force):
    """A stop between two points: pushes them apart where they are nearer than `gap`, and damps them there."""

    kind = "bumper"
    forms: ClassVar = ({}, {"damping": 1})

    i: Marker = Field(description="marker of the first body")
    j: Marker = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(description="N/m")
    gap: si.PositiveLength = Field(description="m")
    damping: si.Damping = Field(0.0, description="N s/m")

    @staticmethod
    def efforts(e):
        length = e.distance(e.i.point, e.j.point)
        depth = sp.Max(e.gap - length, 0)
        damped = sp.Piecewise((-e.damping * e.rate(length), length < e.gap), (0, True))
        return [(e.stiffness * depth + damped, length)]

    @staticmethod
    def potential(e):
        return e.stiffness * sp.Max(e.gap - e.distance(e.i.point, e.j.point), 0) ** 2 / 2
