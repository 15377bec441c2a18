"""Gears: two parts on one carrier whose teeth meet at a marker of the carrier and push along its z axis.

The teeth move alike along that axis; what their force does to either part is that of a force at the contact, which the
bearings feel.  So the equation is the difference of both parts' displacement there, as their carrier sees it, and it
contains what the joints hold besides what they leave free: that part of it stays zero, but has its share of the
reaction.  MSC Adams/Solver, GEAR statement.
"""

from __future__ import annotations

import ast
from typing import Any

import numpy as np

from ..functions.trees import difference, measured, number, product, times, total
from ..statements.constraints import ROTATIONAL, Joint, Numbered
from .coordinates import SORTS, initial_displacement
from .mechanism import Mechanism, Place
from .relations import coupled_joint

HELD = 1e-9
"""How small the motion of the teeth that a joint allows is taken for none: of its arm, or of 1."""


def gears(mechanism: Mechanism) -> dict[str, Any]:
    """The scene's gears by name.

    Raises
    ------
    DatasetFault
        When a joint does not join the carrier, or does not let the teeth move.
    """
    return {
        gear.name: meshed(gear, gear.joints, mechanism.place(gear.contact, gear, "CV"), mechanism)
        for gear in mechanism.dataset.gears.values()
    }


def meshed(user: Numbered, joints: tuple[int, int], contact: Place, mechanism: Mechanism) -> dict[str, Any]:
    """The equation of the teeth of two parts that meet at a marker of the carrier, reported on the part of the first joint.

    Raises
    ------
    DatasetFault
        As `gears`.
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
    """A part with teeth, seen from the carrier: `own` is its marker of the joint, `seat` that of the carrier.

    The teeth at r from `own` move by v + w x r, along the contact's z axis by v z + w (r x z), in the axes of `seat`.
    """

    def __init__(self, user: Numbered, ident: int, contact: Place, mechanism: Mechanism) -> None:
        joint = coupled_joint(user, ident, mechanism)
        i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
        if contact.body not in (i.body, j.body):
            raise user.fault(
                f"found the marker CV on {contact.body}, expected it on the carrier, which {joint.label} joins too"
            )
        self.own, self.seat = (i, j) if contact.body == j.body else (j, i)
        self._contact, self._mechanism = contact, mechanism
        self._along = self.seat.initial.axes.T @ contact.initial.axes[:, 2]
        self._arm = self.seat.initial.axes.T @ (contact.initial.point - self.own.initial.point)
        self._massless = HELD * float(np.linalg.norm(self._arm))
        self._slides = SORTS.get(joint.kind) != ROTATIONAL
        self._check(user, joint)

    def _check(self, user: Numbered, joint: Joint) -> None:
        turning = float(np.cross(self._arm, self._along)[2]) if joint.kind != "TRANSLATIONAL" else 0.0
        sliding = float(self._along[2]) if self._slides else 0.0
        if abs(turning) <= self._massless and abs(sliding) <= HELD:
            raise user.fault(
                f"found the z axis of the marker CV across the motion that {joint.label} allows there, expected it along the "
                "motion of the teeth"
            )

    def displacement(self) -> ast.expr:
        """The teeth's way along the contact's z axis, to first order in what the joint holds."""
        own, seat, contact = self.own.reference, self.seat.reference, self._contact.reference
        levers = self._levers()
        terms = [product(levers[2], measured("az", own, seat, ""))] if levers[2] is not None else []
        if levers[0] is not None or levers[1] is not None:
            tip = self._mechanism.tip(self.own)
            tilts = times(measured("dy", tip, own, seat), -1.0), measured("dx", tip, own, seat)
            terms += [product(lever, tilt) for lever, tilt in zip(levers[:2], tilts, strict=True) if lever is not None]
        return total([measured("dz", own, seat, contact), *terms])

    def _levers(self) -> tuple[ast.expr | None, ...]:
        """Components of r x z, None for those that are zero; sliding changes r along the z axis of the joint."""
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
        """The displacement at the initial pose."""
        slid = self.own.initial.point - self.seat.initial.point
        levers = np.cross(self._arm, self._along)
        angle = initial_displacement(ROTATIONAL, self.own, self.seat)
        return float(slid @ self._contact.initial.axes[:, 2] + levers[2] * angle)
