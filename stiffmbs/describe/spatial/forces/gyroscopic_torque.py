"""Turning: what a body's rotation in space adds to its equations of motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from ...element import Force, Symbolic
from ...marker import MarkerReference
from ...units import si
from ..body import Body


class GyroscopicTorque(Force):
    """The gyroscopic torque -w x (I w) in a body's principal axes; made by the model (hence without a kind).

    Euler's equations of motion, I w' + w x (I w) = T; Haug, Computer Aided Kinematics and Dynamics of Mechanical
    Systems (1989), eq. 11.1.11.  Its power is zero.

    The body's kinematics, p' = Z(p) w, belong to this element too.
    """

    kind: ClassVar[str] = ""
    turns: ClassVar[bool] = True

    i: MarkerReference
    moments: tuple[si.Inertia, si.Inertia, si.Inertia]

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """The three torques on the body's own angular velocities."""
        (a, b, c), (p, q, r) = e.moments, e.i.body.u[3:6]
        return [((b - c) * q * r, p), ((c - a) * r * p, q), ((a - b) * p * q, r)]


def turnings(bodies: Mapping[str, Body]) -> Iterator[tuple[str, GyroscopicTorque]]:
    """The gyroscopic torques of bodies by the bodies' names."""
    for name, body in bodies.items():
        yield name, GyroscopicTorque(i=MarkerReference(body=name), moments=body.principal_moments())
