"""Conversion of links to bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...elements.spatial.body import MOMENT_ROUNDING
from ...elements.spatial.massless import MASSLESS, breaks_triangle, filled, lacks_inertia, massless_moment
from ...elements.spatial.number_format import plain, vector
from ...elements.spatial.orientation import conjugate, rotated
from ..pose import Placed
from ..robot import Link, Robot, RobotFault
from .mechanism import Mechanism


class Masses:
    """Small mass and inertia for massless links: fractions of the robot's lightest mass, at its size."""

    def __init__(self, robot: Robot, mechanism: Mechanism) -> None:
        least = min((link.mass for link in robot.links if link.mass > 0), default=0.0)
        if least == 0:
            raise RobotFault("found no link with a mass, expected one at least")
        self.lightest = least
        self.mass = MASSLESS * least
        self.moment = massless_moment(least, [frame.position for _, frame in mechanism.bodies.values()])


def bodies(mechanism: Mechanism, masses: Masses) -> dict[str, Any]:
    """Return the bodies by name, with their markers."""
    found = {}
    for name, (link, frame) in mechanism.bodies.items():
        between = name in mechanism.between
        body = _between(link, masses) if between else _heavy(link, masses)
        markers = mechanism.markers.get(name)
        centre = (0.0, 0.0, 0.0) if between else link.center_of_mass
        found[name] = body | _motion(frame, centre) | ({"markers": markers} if markers else {})
    return found


def notes(mechanism: Mechanism) -> list[str]:
    """Return a note on inertias that no distribution of mass has."""
    own = {name: link for name, (link, _) in mechanism.bodies.items() if name not in mechanism.between}
    odd = [name for name, link in own.items() if breaks_triangle(link.inertia)]
    return (
        [f"the largest moment of inertia of {', '.join(odd)} is greater than the sum of the other two"] if odd else []
    )


def _between(link: Link, masses: Masses) -> dict[str, Any]:
    """Return a massless body between joints of a link: small fractions of the link's mass and inertia, if any."""
    c = np.array(link.center_of_mass)
    moment = float(np.linalg.eigvalsh(link.inertia)[-1] + link.mass * (c @ c)) * MASSLESS
    return {"mass": link.mass * MASSLESS or masses.mass, "inertia": [moment or masses.moment] * 3}


def _heavy(link: Link, masses: Masses) -> dict[str, Any]:
    tensor = link.inertia
    if not np.all(np.isfinite(tensor)):
        raise RobotFault(f"link {link.name}: found moments of inertia above 1e308 kg m^2, expected finite values")
    moments = np.linalg.eigvalsh(tensor)
    if moments[0] < -MOMENT_ROUNDING * max(moments[-1], masses.moment) or not np.all(np.isfinite(moments)):
        raise RobotFault(
            f"link {link.name}: found the principal moments of inertia {', '.join(f'{x:g}' for x in moments)} kg m^2, expected none below 0"
        )
    body: dict[str, Any] = {"mass": plain(link.mass or masses.mass)}
    if moments[0] < 0:  # rounding error
        axes = np.linalg.eigh(tensor)[1]
        tensor = (axes * np.maximum(moments, 0.0)) @ axes.T
    if moments[-1] <= MOMENT_ROUNDING * masses.moment:
        tensor = masses.moment * np.eye(3)
    elif lacks_inertia(tensor):
        tensor = filled(tensor, masses.moment)
    if breaks_triangle(tensor):
        body["any_moments"] = True
    diagonal = not np.any(tensor - np.diag(np.diag(tensor)))
    body["inertia"] = vector(np.diag(tensor)) if diagonal else [vector(row) for row in tensor]
    if any(link.center_of_mass):
        body["center_of_mass"] = vector(link.center_of_mass)
    return body


def _motion(frame: Placed, center_of_mass: tuple[float, ...]) -> dict[str, Any]:
    found: dict[str, Any] = {"position": vector(frame.position)}
    if frame.orientation != (1.0, 0.0, 0.0, 0.0):
        found["orientation"] = vector(frame.orientation)
    velocity, omega = (
        frame.velocity_at(frame.point(center_of_mass)),
        rotated(conjugate(frame.orientation), tuple(frame.omega)),
    )
    return found | {key: vector(rate) for key, rate in (("velocity", velocity), ("omega", omega)) if np.any(rate)}
