"""Gears: two parts on one carrier with tooth contact at a carrier marker, along its z axis.

The teeth have equal displacement along that axis. Their force acts on both parts at the contact point and loads the
bearings. The constraint is the difference of both displacements relative to the carrier. It includes coordinates that
the joints hold, whose contributions remain zero but carry part of the reaction.  MSC Adams/Solver, GEAR statement.
"""

from __future__ import annotations

import ast

import numpy as np

from ..functions.trees import difference, measured, number, product, times, total
from ..statements.constraints import ROTATIONAL, Joint
from ..statements.declared import Numbered
from ..statements.geometry import ROUNDING
from .mechanism import Mechanism, Place
from .relations import SORTS, coupled_joint, initial_displacement


def gears(mechanism: Mechanism) -> dict[str, object]:
    """Return the scene's gears by name.

    Raises DatasetFault if a joint is not on the carrier, or does not let the teeth move.
    """
    return {
        gear.name: meshed(gear, gear.joints, mechanism.place(gear.contact, gear, "CV"), mechanism)
        for gear in mechanism.dataset.gears.values()
    }


def meshed(user: Numbered, joints: tuple[int, int], contact: Place, mechanism: Mechanism) -> dict[str, object]:
    """Return the tooth constraint of two parts that mesh at a carrier marker; reported on the first joint's part.

    Raises DatasetFault as `gears`.
    """
    one, other = (_Wheel(user, ident, contact, mechanism) for ident in joints)
    gap = [one.displacement(), times(other.displacement(), -1.0)]
    initial = one.initial() - other.initial()
    return {
        "type": "equation",
        "i": one.own.reference,
        "j": other.own.reference,
        "zero": ast.unparse(total([*gap, number(-initial)] if initial else gap)),
    }


class _Wheel:
    """Gear relative to its carrier: `own` is the joint marker on the gear, `seat` that on the carrier.

    A tooth at r from `own` has the velocity v + w x r; along the contact's z axis v z + w (r x z), in axes of `seat`.
    """

    def __init__(self, user: Numbered, ident: int, contact: Place, mechanism: Mechanism) -> None:
        joint = coupled_joint(user, ident, mechanism)
        i, j = mechanism.ends(joint)
        if contact.body not in (i.body, j.body):
            raise user.fault(
                f"found the marker CV on {contact.body}, expected it on the carrier, one of the parts of {joint.label}"
            )
        self.own, self.seat = (i, j) if contact.body == j.body else (j, i)
        self._contact, self._mechanism = contact, mechanism
        self._along = self.seat.initial.axes.T @ contact.initial.axes[:, 2]
        self._arm = self.seat.initial.axes.T @ (contact.initial.point - self.own.initial.point)
        self._massless = ROUNDING * float(np.linalg.norm(self._arm))
        self._slides = SORTS.get(joint.kind) != ROTATIONAL
        self._check(user, joint)

    def _check(self, user: Numbered, joint: Joint) -> None:
        turning = float(np.cross(self._arm, self._along)[2]) if joint.kind != "TRANSLATIONAL" else 0.0
        sliding = float(self._along[2]) if self._slides else 0.0
        if abs(turning) <= self._massless and abs(sliding) <= ROUNDING:
            raise user.fault(
                f"found the z axis of the marker CV normal to the motion that {joint.label} allows there, expected it along the "
                "motion of the teeth"
            )

    def displacement(self) -> ast.expr:
        """Return the tooth displacement along the contact's z axis, to first order in coordinates held by the joint."""
        own, seat, contact = self.own.reference, self.seat.reference, self._contact.reference
        levers = self._levers()
        terms = [product(levers[2], measured("az", own, seat, ""))] if levers[2] is not None else []
        if levers[0] is not None or levers[1] is not None:
            tip = self._mechanism.tip(self.own)
            tilts = times(measured("dy", tip, own, seat), -1.0), measured("dx", tip, own, seat)
            terms += [product(lever, tilt) for lever, tilt in zip(levers[:2], tilts, strict=True) if lever is not None]
        return total([measured("dz", own, seat, contact), *terms])

    def _levers(self) -> tuple[ast.expr | None, ...]:
        """Return the components of r x z, None for zeros; sliding changes r along the joint's z axis."""
        lever, (a, b, _) = np.cross(self._arm, self._along), self._along
        if not self._slides:
            return tuple(number(part) if abs(part) > self._massless else None for part in lever)
        slid = difference(
            measured("dz", self._contact.reference, self.own.reference, self.seat.reference), number(self._arm[2])
        )
        changed = [
            times(slid, change) if abs(part) <= self._massless else total([number(part), times(slid, change)])
            for part, change in ((lever[0], -b), (lever[1], a))
        ]
        return (*changed, number(lever[2]) if abs(lever[2]) > self._massless else None)

    def initial(self) -> float:
        """Return the displacement at the initial pose."""
        slid = self.own.initial.point - self.seat.initial.point
        levers = np.cross(self._arm, self._along)
        angle = initial_displacement(ROTATIONAL, self.own, self.seat)
        return float(slid @ self._contact.initial.axes[:, 2] + levers[2] * angle)
