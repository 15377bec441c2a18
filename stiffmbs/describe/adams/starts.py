"""Initial conditions that joints state: refused where the parts are drawn and set in motion otherwise.

A scene starts its bodies as they are described; a joint's initial conditions can only repeat that.
"""

from __future__ import annotations

import numpy as np

from .bodies import Part, Vector
from .constraints import ROTATIONAL, Joint
from .geometry import IDENTITY
from .mechanism import Mechanism, Place

SAME = 1e-6
"""How far they may be apart, in m, rad, and per s."""


def check_starts(mechanism: Mechanism) -> None:
    """Compare the initial conditions of all joints with the parts' own.

    Raises
    ------
    DatasetFault
        Where they differ.
    """
    for joint in mechanism.dataset.joints.values():
        for sort, displacement, velocity in joint.start:
            found = _of_parts(mechanism, joint, sort)
            for name, stated, drawn in zip(("displacement", "velocity"), (displacement, velocity), found, strict=True):
                if abs(stated - drawn) > SAME * max(1.0, abs(drawn)):
                    raise joint.fault(
                        f"found the {sort.lower()} {name} {stated:.6g} at the start where the parts have {drawn:.6g} (in SI), "
                        "expected the same in their PART statements"
                    )


def drawn_displacement(sort: str, i: Place, j: Place) -> float:
    """The displacement of a joint as the parts are drawn, m or rad."""
    a, b = i.drawn, j.drawn
    if sort != ROTATIONAL:
        return float((a.point - b.point) @ b.axes[:, 2])
    x = a.axes[:, 0]
    return float(np.arctan2(x @ b.axes[:, 1], x @ b.axes[:, 0]))


def _of_parts(mechanism: Mechanism, joint: Joint, sort: str) -> tuple[float, float]:
    """A joint's displacement and velocity as its parts' statements have them."""
    i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
    (v, w), (V, W) = _rates(mechanism, joint.i, i), _rates(mechanism, joint.j, j)
    axis = j.drawn.axes[:, 2]
    if sort == ROTATIONAL:
        return drawn_displacement(sort, i, j), float((w - W) @ axis)
    apart = i.drawn.point - j.drawn.point
    return drawn_displacement(sort, i, j), float((v - V - np.cross(W, apart)) @ axis)


def _rates(mechanism: Mechanism, ident: int, place: Place) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and angular velocity of a marker at the start, in ground axes."""
    part = mechanism.part_of(mechanism.dataset.markers[ident])
    if part.ground:
        return np.zeros(3), np.zeros(3)
    drawn = mechanism.center(part).within(part.frame)
    velocity = in_ground(mechanism, part, part.velocity, part.velocity_marker, IDENTITY)
    omega = in_ground(mechanism, part, part.omega, part.omega_marker, drawn.axes)
    return velocity + np.cross(omega, place.drawn.point - drawn.point), omega


def in_ground(
    mechanism: Mechanism, part: Part, rates: Vector | None, marker: int | None, axes: np.ndarray
) -> np.ndarray:
    """Velocities that are given in a marker's axes (or in `axes`, without one) in ground axes; zero without any."""
    if rates is None:
        return np.zeros(3)
    return (axes if marker is None else mechanism.place(marker, part, "VM or WM").drawn.axes) @ np.array(rates)
