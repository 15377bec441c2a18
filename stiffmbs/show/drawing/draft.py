"""Tools of symbols: places on bodies, and a sheet that takes shapes at them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...reading.marker import GROUND
from . import solids
from .scene_graph import Anchor, Line, Link, Part, Role, Solid


@dataclass(frozen=True, eq=False)
class Site:
    """Marker on its body."""

    body: str
    point: np.ndarray  # shape (3,): position relative to the body's centre of mass, m
    axes: np.ndarray  # shape (3, 3): columns are the marker's axes in the body's
    in_ground: np.ndarray  # shape (3,): position in the initial drawing, in ground axes
    turned: np.ndarray  # shape (3, 3): the marker's axes in the initial drawing

    @property
    def anchor(self) -> Anchor:
        """Its point on the body."""
        return Anchor(self.body, self.point)

    @property
    def on_ground(self) -> bool:
        """True if its body is ground."""
        return self.body == GROUND

    def at(self, shift: Sequence[float] | np.ndarray) -> Site:
        """Return the site at another point, given in the marker's axes."""
        step = np.asarray(shift, dtype=float)
        point, in_ground = self.point + self.axes @ step, self.in_ground + self.turned @ step
        return Site(self.body, point, self.axes, in_ground, self.turned)

    def with_axes(self, axes: np.ndarray) -> Site:
        """Return the site with other axes, whose columns are given in the marker's."""
        return Site(self.body, self.point, self.axes @ axes, self.in_ground, self.turned @ axes)

    def along_ground(self) -> Site:
        """Return the site with the ground's axes in the initial drawing."""
        return self.with_axes(self.turned.T)


@dataclass
class Draft:
    """Sheet for the symbols of one element."""

    owner: str
    element: Any
    u: float  # unit of symbols, m
    size: float  # size of the mechanism, m
    # i, j: the element's markers, or those of the joint that it refers to
    i: Site | None
    j: Site | None
    joints: dict[str, tuple[Any, Site | None, Site | None]]  # all joints by name, with their sites
    front: float  # distance of planar symbols in front of bodies, m; zero in space
    down: np.ndarray  # shape (3,): direction of the ground below its supports
    colors: dict[str, str]  # colors of bodies
    parts: list[Part] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)

    def put(self, site: Site, role: Role, *shapes: Solid | Line, color: str = "") -> None:
        """Draw shapes given in the axes of a site."""
        found = tuple(solids.moved(s, site.point, site.axes) for s in shapes if isinstance(s, Solid))
        lines = tuple(solids.moved_line(s, site.point, site.axes) for s in shapes if isinstance(s, Line))
        self.parts.append(Part(self.owner, role, site.body, found, lines, color))

    def stretch(
        self, i: Site, j: Site, role: Role, *profiles: object, width: float = 1.0, dashed: bool = False
    ) -> None:
        """Draw profiles from one site to another."""
        shapes = tuple(np.array(profile, dtype=float) for profile in profiles)
        self.links.append(Link(self.owner, role, i.anchor, j.anchor, shapes, width, dashed))

    def grounded(self) -> Site | None:
        """Return the marker on ground, if any."""
        return next((site for site in (self.i, self.j) if site is not None and site.on_ground), None)

    def joint_site(self, field_name: str) -> Site | None:
        """Return marker i of the joint that a field of the element names."""
        return self.joints.get(getattr(self.element, field_name).joint, (None, None, None))[1]


Symbol = Callable[[Draft], None]
"""Function that draws an element."""
Piece = Callable[[Draft, Site, Site], object]
"""Function that draws a part of a symbol, from the first and the second marker of an element."""


def at_first(*pieces: Piece) -> Symbol:
    """Return a symbol of pieces that is drawn if the element has a first marker; the second is then the first, too."""

    def symbol(draft: Draft) -> None:
        if draft.i is not None:
            for piece in pieces:
                piece(draft, draft.i, draft.j or draft.i)

    return symbol


def at_both(*pieces: Piece) -> Symbol:
    """Return a symbol of pieces that is drawn if the element has two markers."""
    drawn = at_first(*pieces)
    return lambda draft: None if draft.j is None else drawn(draft)


def at_other(piece: Piece) -> Piece:
    """Return a piece with the markers exchanged."""
    return lambda d, i, j: piece(d, j, i)


def at_each(piece: Piece) -> Piece:
    """Return a piece that is drawn at both markers."""
    return lambda d, i, j: (piece(d, i, j), piece(d, j, i))
