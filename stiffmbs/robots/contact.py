"""Contacts between the shapes of a robot, with their stiffness, damping and friction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Final

from ..elements.spatial.marker import ORIGIN
from ..elements.spatial.orientation import IDENTITY

PLANE, SPHERE, CAPSULE, BOX, CYLINDER, ELLIPSOID = "plane", "sphere", "capsule", "box", "cylinder", "ellipsoid"
PARTNERS: Mapping[str, tuple[str, ...]] = {
    PLANE: (SPHERE, CAPSULE, BOX, CYLINDER, ELLIPSOID),
    SPHERE: (SPHERE, CAPSULE, BOX, CYLINDER),
    CAPSULE: (CAPSULE,),
}
"""Kinds of shapes between which the package has contacts."""


@dataclass(frozen=True)
class Shape:
    """Shape on a link (None: the world).

    `kind`: one of the kinds above, or another one without contacts, such as a mesh. `size`: lengths, m. They are the
    radius of a sphere, radius and length of a cylinder, or of a capsule without its ends. Boxes have three full
    sizes, ellipsoids three semi-axes. `position`, `orientation`: its middle in the link's frame, m, and its axes as a
    quaternion. The axis of a cylinder or capsule, and the normal of a plane, is z.
    """

    name: str
    link: str | None
    kind: str
    size: tuple[float, ...] = ()
    position: tuple[float, ...] = ORIGIN
    orientation: tuple[float, ...] = IDENTITY

    @property
    def is_solid(self) -> bool:
        """True if all sizes are positive."""
        return all(length > 0 for length in self.size)


@dataclass(frozen=True)
class PerMass:
    """Linear spring and damper proportional to the effective mass. `stiffness`: 1/s^2. `damping`: 1/s."""

    stiffness: float
    damping: float

    def of(self, mass: float) -> tuple[float, float]:
        """Return the stiffness, N/m, and the damping, N s/m."""
        return mass * self.stiffness, mass * self.damping


@dataclass(frozen=True)
class Given:
    """Linear spring and damper, of at least the critical damping of the effective mass. In N/m and N s/m.

    Files for Gazebo give a small damping to contacts that do not rebound, as the simulator's steps damp them.
    """

    stiffness: float
    damping: float

    def of(self, mass: float) -> tuple[float, float]:
        """Return the stiffness, N/m, and the damping, N s/m."""
        return self.stiffness, max(self.damping, 2.0 * sqrt(self.stiffness * mass))


def impeded(frequency: float, damping: float, impedance: float) -> PerMass:
    """Return the spring and damper of a soft constraint of MuJoCo.

    The constraint's acceleration is a = (1 - d) a_0 - d (b v + k r) with the impedance d, and a_0 without it. Its force
    at rest is that of a spring of stiffness m w^2/(1 - d). The damping ratio, and so the rebound, is the constraint's.
    `frequency`: w of the constraint, 1/s. `damping`: twice the damping ratio times w, 1/s.
    """
    return PerMass(frequency**2 / (1.0 - impedance), damping / sqrt(1.0 - impedance))


USUAL: Final = impeded(frequency=1.0 / 0.02, damping=2.0 / 0.02, impedance=0.95)
"""Contact of files that state none: MuJoCo's default time constant, damping ratio and impedance."""


@dataclass(frozen=True)
class Contact:
    """Contact of two shapes.

    `friction`: coefficient of sliding friction. `margin`: distance of the surfaces at which the contact begins, m.
    """

    first: Shape
    second: Shape
    softness: PerMass | Given = USUAL
    friction: float = 1.0
    margin: float = 0.0


def are_partners(first: str, second: str) -> bool:
    """Return True if the package has contacts between two kinds of shapes."""
    return second in PARTNERS.get(first, ()) or first in PARTNERS.get(second, ())


def split(pairs: Iterable[tuple[Shape, Shape]]) -> tuple[list[tuple[Shape, Shape]], list[str]]:
    """Return the pairs between which the package has contacts, and a note on the others."""
    held, others = [], Counter[tuple[str, str]]()
    for first, second in pairs:
        if are_partners(first.kind, second.kind) and first.is_solid and second.is_solid:
            held.append((first, second))
        else:
            a, b = sorted((first.kind, second.kind))
            others[a, b] += 1
    return held, list(_note(others))


def _note(others: Counter[tuple[str, str]]) -> Iterator[str]:
    if others:
        words = (f"{count} of {a} and {b}" for (a, b), count in sorted(others.items()))
        yield f"contacts of these kinds of shapes are left out: {', '.join(words)}"
