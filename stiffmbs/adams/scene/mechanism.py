"""Parts and markers as bodies and markers of a scene: names, axes and initial poses.

A body's origin and axes are those of its centre-of-mass marker, to which Adams' requests, moments of inertia and
initial angular velocities refer. The part's own axes do not occur in the scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...elements.spatial.massless import MASSLESS
from ...elements.spatial.number_format import plain
from ...reading.files.yaml_text import Content
from ...reading.marker import GROUND
from ..functions.function import Function
from ..statements.bodies import Marker, Part
from ..statements.constraints import Primitive
from ..statements.dataset import Dataset
from ..statements.declared import Numbered
from ..statements.elastic import Beam, Elastic, SpringDamper
from ..statements.forces import SingleForce
from ..statements.geometry import IDENTITY, Frame

ORIGIN = Frame(np.zeros(3), IDENTITY)


@dataclass(frozen=True)
class Place:
    """Marker of the scene."""

    body: str  # the body that carries it, or ground
    name: str  # its name on that body
    on_body: Frame  # in the body's axes
    initial: Frame  # in ground axes, at the start

    @property
    def reference(self) -> str:
        """Reference in the scene."""
        return f"{self.body}.{self.name}" if self.name else self.body


class Mechanism:
    """Parts and markers of a dataset by number.

    Raises
    ------
    DatasetFault
        If there are several ground parts, a marker is on a missing part, or a mass or CM marker is invalid.
    """

    def __init__(self, dataset: Dataset) -> None:
        self.dataset = dataset
        self.further: dict[str, Place] = {}  # auxiliary markers by reference; see `tip`
        # Splines, variables and states (motions integrated from functions without a formula of the integral) used by
        # functions so far, and inputs set by another program or a sensor, all in the dataset's units.
        self.tables: dict[str, dict[str, object]] = {}
        self.variables: dict[str, str] = {}
        self.inputs: dict[str, float] = {}
        self.states: dict[str, Content] = {}
        # Smallest non-zero mass of the parts, kg.
        self.least = min((part.mass for part in dataset.parts if part.mass > 0), default=0.0)
        self.parts = {(part.keyword, part.ident): part for part in dataset.parts}
        for key, part in self.parts.items():
            if not part.ground and part.mass == 0:  # Adams allows none where joints make it irrelevant
                self.parts[key] = replace(part, mass=MASSLESS * self.least)
        grounds = [part for part in dataset.parts if part.ground]
        if len(grounds) > 1:
            raise grounds[1].fault(f"found a second GROUND, expected one ({grounds[0].label})")
        for marker in dataset.markers.values():
            if marker.owner not in self.parts:
                kind, ident = marker.owner
                raise marker.fault(f"found {kind} = {ident}, expected the number of a {kind} of the dataset")
        for part in self.moving:
            self._check(part)

    def _check(self, part: Part) -> None:
        if not part.mass > 0:
            found = f"MASS = {plain(part.mass)!r} kg" if part.mass else "no part with a MASS"
            raise part.fault(f"found {found}, expected a mass above zero")
        if part.center is None and part.mass >= self.least:
            raise part.fault("found no CM, expected the marker at its centre of mass")
        for name, ident in (("CM", part.center), ("IM", part.inertia_marker)):
            marker = self.dataset.markers.get(ident) if ident is not None else None
            if ident is not None and (marker is None or self.part_of(marker) is not part):
                raise part.fault(f"found {name} = {ident}, expected a marker of this part")

    def tip(self, place: Place, axis: str = "z") -> str:
        """Return the reference of a marker 1 m along an axis of another one.

        Formulas use it to measure that axis: ``dx(tip, marker, other)`` is its component along the x axis of the other.
        """
        return self.moved(place, f"{place.name}_{axis}", place.initial.axes[:, "xyz".index(axis)]).reference

    def moved(self, place: Place, name: str, offset: np.ndarray) -> Place:
        """Add a marker: another one translated on its body by a vector in ground axes (m) at the start."""
        seen = place.initial.axes.T @ offset
        found = Place(
            place.body, name, *(Frame(seen, IDENTITY).within(frame) for frame in (place.on_body, place.initial))
        )
        self.further[found.reference] = found
        return found

    @cached_property
    def moving(self) -> tuple[Part, ...]:
        """All parts except ground."""
        return tuple(part for part in self.parts.values() if not part.ground)

    @cached_property
    def moves_at_start(self) -> bool:
        """True if any part states a velocity."""
        return any(part.velocity is not None or part.omega is not None for part in self.moving)

    def part_of(self, marker: Marker) -> Part:
        """Return the part that carries a marker."""
        return self.parts[marker.owner]

    def center(self, part: Part) -> Frame:
        """Return a part's centre-of-mass marker in the part's axes; the origin if it has none."""
        if part.center is None:
            return ORIGIN
        return self.dataset.markers[part.center].frame

    def notes(self) -> Iterator[str]:
        """Yield one sentence for each ignored or replaced property of parts."""
        weightless = [part.label for part in self.moving if part.mass < self.least]
        if weightless:
            yield (
                f"{', '.join(weightless)} {'have' if len(weightless) > 1 else 'has'} no MASS, set to {MASSLESS:g} times that of "
                "the lightest part"
            )
        exact = [part.label for part in self.moving if part.exact]
        if exact:
            yield f"EXACT of {', '.join(exact)} is left out: assembly may move any part"

    def place(self, ident: int, user: Numbered | Function, name: str = "I") -> Place:
        """Return a marker that a statement refers to. Raises DatasetFault if there is no such marker."""
        marker = self.dataset.markers.get(ident)
        if marker is None:
            raise user.fault(f"found {name} = {ident}, expected the number of a marker")
        return self.placed(marker)

    def ends(self, user: Primitive | SingleForce | SpringDamper | Elastic | Beam) -> tuple[Place, Place]:
        """Return markers I and J of a joint or a force."""
        return self.place(user.i, user, "I"), self.place(user.j, user, "J")

    def placed(self, marker: Marker) -> Place:
        """Return a marker on its body and in ground axes; a floating marker is placed at the body's origin."""
        part = self.part_of(marker)
        center = self.center(part)
        if part.ground:
            on_ground = marker.frame.within(part.frame)
            return Place(GROUND, marker.name, on_ground, on_ground)
        on_body = ORIGIN if marker.floating else marker.frame.seen_from(center)
        return Place(part.name, marker.name, on_body, on_body.within(center.within(part.frame)))
