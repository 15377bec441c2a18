"""Rotation of spatial bodies: gyroscopic torques and kinematics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ....reading.marker import MarkerReference
from ....reading.units import si
from ...element import Expr, Force, Symbolic
from ..body import Body


class GyroscopicTorque(Force):
    """Gyroscopic torque -n x (I w) in a body's principal axes; created by the model, hence without a kind.

    The body's quaternion follows n = w. Euler's equations of motion, I w' + w x (I w) = T; Haug, Computer Aided
    Kinematics and Dynamics of Mechanical Systems (1989), eq. 11.1.11. If the quaternion does not follow the body's spin
    (`stiffmbs.presolve.spinning_bodies`), n is the component of w normal to the spin axis, as in Euler's modified
    equations; Meirovitch, Methods of Analytical Dynamics (1970), sec. 4.6. The power is zero.

    The body's kinematics, p' = Z(p) n, belong to this element, too.
    """

    kind = ""
    turns = True
    spin_conditions = {"i": "body"}

    i: MarkerReference
    moments: tuple[si.Inertia, si.Inertia, si.Inertia]

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        (a, b, c), (p, q, r) = e.moments, e.i.body.u[3:6]
        x, y, z = e.i.body.followed
        return [(z * b * q - y * c * r, p), (x * c * r - z * a * p, q), (y * a * p - x * b * q, r)]


def turnings(bodies: Mapping[str, Body]) -> Iterator[tuple[str, GyroscopicTorque]]:
    """Yield the gyroscopic torques of bodies by the bodies' names."""
    for name, body in bodies.items():
        at = MarkerReference.model_construct(body=name)
        yield name, GyroscopicTorque.model_construct(type=GyroscopicTorque.kind, i=at, moments=body.principal_moments())
