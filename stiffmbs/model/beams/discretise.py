"""Nodes and elements of a beam."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np

from ...errors import prefixed
from .axis import Arc, Piece, frame, upward
from .division import AUTOMATIC, Divided, Elements
from .interpolation import Group, group_sizes
from .rigid_motion import adjoint, logarithm, tangent
from .section import Material, Numbers, Section
from .stiffness import bowing, element_stiffness, inverse

LARGEST_ROTATION = 3.0
"""Largest rotation between the ends of an unloaded element, rad."""
SAME = 1e-12
"""Tolerance of the places of stations, relative to the length."""
PLACES = 10
"""Decimals of fractions of the length at which nodes of two divisions coincide."""
HEIGHT_IN_PLANE: Final = [0, 2, 1, 3, 5, 4]
"""Components of strain with axes 2 and 3 of the section exchanged."""
Z = np.array([0.0, 0.0, 1.0])


@dataclass
class Node:
    """Rigid node of a beam."""

    name: str  # after the beam's name and a dot
    s: float  # distance from the start, m
    point: np.ndarray  # m
    axes: np.ndarray  # rotation matrix of the section's axes; at a corner those of the piece before it
    share: float = 0.0  # length of the beam that is lumped at the node, m
    mass: float = 0.0  # kg
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))  # in the node's axes, kg m^2
    radius: float = 0.0  # distance of the surface from the axis, m; 0 if it depends on the direction
    section: Section | None = None  # None for a beam of given stiffnesses

    def lump(self, share: float, mass: float, inertia: np.ndarray, axes: np.ndarray) -> None:
        """Add the mass of a length of the beam whose inertia per length, shape (3, 3), is given along its axes."""
        R = self.axes.T @ axes
        self.share += share
        self.mass += share * mass
        self.inertia = self.inertia + share * R @ inertia @ R.T


@dataclass(frozen=True)
class Element:
    """Elastic element: one between two nodes, or a section at an inner point of a group of nodes."""

    nodes: list[Node]
    # rotation matrix of the element's axes at its first node against the node's axes, other than the identity after a
    # corner
    turned: np.ndarray
    length: float  # length of the beam represented by the element, m
    unloaded: np.ndarray  # strain without load, shape (6,)
    stiffness: np.ndarray  # shape (6, 6)
    # factors of the stretch by both shears; of elements between two nodes
    bowing: np.ndarray = field(default_factory=lambda: np.zeros(2))
    shear_centre: tuple[float, float] = (0.0, 0.0)  # from the axis along axes 2 and 3, m; of elements between two nodes
    wagner: tuple[float, float] = (0.0, 0.0)  # curvatures by torsion, per kappa_1^2/2, m; of elements between two nodes
    stretch: float = 0.0  # mean stretch of the fibres by torsion, per kappa_1^2/2, m^2
    reference: int = 0  # place of the reference node
    # shapes, slopes: values and derivatives of the nodes' polynomials at the section; empty between two nodes
    shapes: np.ndarray = field(default_factory=lambda: np.zeros(0))
    slopes: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class Span:
    """Part of a beam with the nodes of one group of elements."""

    start: float  # m along the axis
    end: float
    first: int  # number of its first node
    group: Group

    def shares(self, first: float, last: float) -> tuple[np.ndarray, np.ndarray]:
        """Return places in the part between two places, m along the axis, and the length of each for each of its nodes.

        The places are the nodes if the part is the whole span, and Gauss points within the part otherwise.
        """
        length, lower, upper = self.end - self.start, max(self.start, first), min(self.end, last)
        if upper - lower >= length * (1 - SAME):
            return self.start + length * self.group.nodes, length * np.diag(self.group.weights)
        places, weights = self.group.quadrature((lower - self.start) / length, (upper - self.start) / length)
        return self.start + length * places, length * weights


@dataclass(frozen=True)
class Line:
    """Nodes and elements of a beam, in order, and the division into the latter."""

    nodes: list[Node]
    elements: list[Element]
    divided: Divided
    spans: list[Span]

    def shares(self, first: float, last: float) -> list[dict[float, float]]:
        """Return the lengths at each node, by the places of their loads, of the part between two places, m along the axis."""
        found: list[dict[float, float]] = [{} for _ in self.nodes]
        for span in self.spans:
            if span.start < last and first < span.end:
                places, lengths = span.shares(first, last)
                for own, of_node in zip(found[span.first :], lengths.T.tolist(), strict=False):
                    for place, length in zip(places.tolist(), of_node, strict=True):
                        if length:
                            own[place] = own.get(place, 0.0) + length
        return found


class Constants(NamedTuple):
    """Constants of the cross section at a place of a beam."""

    stiffness: np.ndarray  # shape (6, 6)
    mass: float  # per length, kg/m
    inertia: np.ndarray  # shape (3, 3): per length, kg m
    shear_centre: tuple[float, float] = (0.0, 0.0)  # from the axis along axes 2 and 3, m
    wagner: tuple[float, float] = (0.0, 0.0)  # curvatures by torsion, per kappa_1^2/2, m
    stretch: float = 0.0  # mean stretch of the fibres by torsion, per kappa_1^2/2, m^2


def _constants(beam: Any, share: float) -> Constants:
    """Return the constants at a fraction of the length; ValueError if the section of a planar beam is not symmetric.

    The fibres of a section are stretched by torsion (Wagner). A beam of given stiffnesses has none: it is the line of
    Reissner and Simo, and its published solutions are those without this stretch.
    """
    if beam.section is not None:
        section: Section = _between(beam.section, beam.section_end, share)
        material: Material = beam.material
        of = section.properties(material.nu)
        if beam.dimensions == 2 and (why := of.leaves_plane()):
            raise ValueError(f"section: {why}")
        K, density = of.stiffness(material.E, material.G), material.density
        y, z = of.shear_centre
        stretch = (of.I2 + of.I3) / of.A + y**2 + z**2
        return Constants(K, density * of.A, of.inertia(density), of.shear_centre, of.wagner, stretch)
    given, inertia = beam.stiffness, beam.inertia_per_length
    if len(given) != 6:
        EA, GA, EI = given
        given, inertia = (EA, GA, GA, EI, EI, EI), (2 * inertia, inertia, inertia)
    return Constants(np.diag(given), beam.mass_per_length, np.diag(inertia))


def _between(start: Section, end: Section | None, share: float) -> Section:
    """Return the section at a fraction of the length, with linearly interpolated numbers."""
    if end is None:
        return start
    if isinstance(start, Numbers) and isinstance(end, Numbers):
        start, end = start.complete(), end.complete()
    numbers: dict[str, object] = {
        name: (1 - share) * a + share * getattr(end, name)
        for name in type(start).model_fields
        if isinstance(a := getattr(start, name), float) and getattr(end, name) is not None
    }
    if isinstance(start, Numbers) and isinstance(end, Numbers):
        for name in ("shear_centre", "wagner"):
            pairs = zip(getattr(start, name), getattr(end, name), strict=True)
            numbers[name] = tuple((1 - share) * a + share * b for a, b in pairs)
    return start.model_copy(update=numbers)


def discretise(beam: Any) -> Line:
    """Return the nodes and elements of a beam.

    The elements are distributed over the smooth intervals between ends, corners and stations by length, at least one in
    each. With spectral interpolation, groups of up to four of them share polynomials (`Group`). In the plane the height
    of a section is in the plane, so axes 2 and 3 change places. ValueError if a station is beyond the beam, or an
    element turns by more than half a turn.
    """
    pieces, planar = beam.pieces(), beam.dimensions == 2
    total = sum(piece.length for piece in pieces)

    def constants(s: float) -> Constants:
        return _constants(beam, s / total)

    nodes: list[Node] = []
    elements: list[Element] = []
    spans: list[Span] = []
    intervals = list(_intervals(pieces, beam.stations, total))
    wanted: Elements = beam.elements
    counts = wanted.counts or _counts([b - a for _, _, a, b in intervals], wanted.number)
    if len(counts) != len(intervals):
        raise ValueError(f"elements: found {len(counts)} numbers, expected {len(intervals)}, one for each interval")
    for (piece, first, a, b), count in zip(intervals, counts, strict=True):
        up = Z if planar else upward(piece) if beam.up is None else np.array(beam.up, dtype=float)
        add = _Interval(piece, first, constants, up, planar, nodes, elements, spans)
        if beam.interpolation == "pairs":
            add.group(a, b, Group.of_pairs(count))
            continue
        for start, end, size in group_sizes(a, b, count, _turn(piece)):
            add.group(start, end, Group.of(size))
    names = {**wanted.names, **{name: s / total for name, s in beam.stations.items()}}
    at = {round(share, PLACES): name for name, share in names.items()}
    plain = "between" if wanted.names else "node"
    for k, node in enumerate(nodes):
        node.name = at.get(round(node.s / total, PLACES), f"{plain}{k}")
        if beam.section is not None:
            node.section = _between(beam.section, beam.section_end, node.s / total)
            node.radius = node.section.radius(planar)
    nodes[0].name, nodes[-1].name = "start", "end"
    tolerance = AUTOMATIC * total if wanted.tolerance == 0 else wanted.tolerance
    divided = Divided(total, tuple(counts), tolerance, {node.name: node.s / total for node in nodes})
    return Line(nodes, elements, divided, spans)


def _intervals(
    pieces: list[Piece], stations: dict[str, float], total: float
) -> Iterator[tuple[Piece, float, float, float]]:
    """Yield each smooth interval: its piece, where that starts, and both ends of the interval, m along the axis."""
    for name, s in stations.items():
        if s >= total * (1 - SAME):
            raise ValueError(f"stations.{name}: found {s:g} m, expected less than the length of {total:g} m")
    first = 0.0
    for piece in pieces:
        last = first + piece.length
        inside = sorted(s for s in stations.values() if first + SAME * total < s < last - SAME * total)
        for a, b in pairwise([first, *dict.fromkeys(inside), last]):
            yield piece, first, a, b
        first = last


def _counts(lengths: list[float], wanted: int) -> list[int]:
    """Distribute a number of elements over lengths, at least one each; the total is at least the wanted one."""
    counts = [1] * len(lengths)
    while sum(counts) < wanted:
        coarsest = max(range(len(lengths)), key=lambda k: lengths[k] / counts[k])
        counts[coarsest] += 1
    return counts


def _turn(piece: Piece) -> float:
    """Return the curvature of the axis, rad/m."""
    return piece.angle / piece.length if isinstance(piece, Arc) else 0.0


@dataclass(frozen=True)
class _Interval:
    """Smooth interval of a beam, whose nodes and elements are added to those of the beam."""

    piece: Piece
    first: float
    constants: Callable[[float], Constants]
    up: np.ndarray
    planar: bool
    nodes: list[Node]
    elements: list[Element]
    spans: list[Span]

    def group(self, start: float, end: float, group: Group) -> None:
        """Add the nodes and elements of a group of elements between two places, m along the axis."""
        where = start + (end - start) * group.nodes
        poses = [self._pose(s) for s in where]
        if not self.nodes:
            self.nodes.append(Node("", float(where[0]), *poses[0]))
        self.nodes.extend(Node("", float(s), *pose) for s, pose in zip(where[1:], poses[1:], strict=True))
        own = self.nodes[-len(where) :]
        self.spans.append(Span(start, end, len(self.nodes) - len(where), group))
        for node, s, (_, axes), weight in zip(own, where, poses, group.weights, strict=True):
            of = self.constants(float(s))
            node.lump(float(weight) * (end - start), of.mass, self._inertia(of), axes)
        turned = own[0].axes.T @ poses[0][1]
        ends = [self.constants(s) for s in (start, end)]
        if group.sections and any(any((*of.shear_centre, *of.wagner)) for of in ends):
            raise ValueError(
                "interpolation: found spectral and a section with its shear centre off the centroid or with Wagner's coefficients, "
                "expected pairs for it"
            )
        if not group.sections:
            for k, pair in enumerate(pairwise(where)):
                axes = turned if k == 0 else np.eye(3)
                self.elements.append(self._single(own[k : k + 2], axes, pair, _screw(poses[k], poses[k + 1])))
            return
        relative = [_screw(poses[group.reference], pose) for pose in poses]
        compliances = group.compliances(lambda share: np.linalg.inv(self._stiffness(start + share * (end - start))))
        for (place, weight, shapes, slopes), compliance in zip(group.sections, compliances, strict=True):
            screw, slope = shapes @ relative, slopes @ relative / (end - start)
            strain = tangent(adjoint(screw)) @ slope
            unloaded = np.where(np.abs(strain) < 1e-13 * np.linalg.norm(strain), 0.0, strain)
            length, slopes = float(weight) * (end - start), slopes / (end - start)
            at, K = group.reference, inverse(compliance)
            stretch = 0.0 if self.planar else self.constants(start + float(place) * (end - start)).stretch
            element = Element(
                own, turned, length, unloaded, K, stretch=stretch, reference=at, shapes=shapes, slopes=slopes
            )
            self.elements.append(element)

    def _single(
        self, nodes: list[Node], turned: np.ndarray, ends: tuple[float, float], screw: np.ndarray
    ) -> Element:  # fmt: skip
        start, end = ends
        length = float(np.linalg.norm(screw[:3]))
        if np.linalg.norm(screw[3:]) > LARGEST_ROTATION or length < (end - start) / 2:
            raise ValueError("elements: found an element that turns by half a turn, expected more elements")
        unloaded = np.where(np.abs(screw) < 1e-14 * length, 0.0, screw) / length
        K = element_stiffness(unloaded, length, lambda share: self._stiffness(start + share * (end - start)))
        middle = (start + end) / 2
        of = self.constants(middle)
        if self.planar:
            return Element(nodes, turned, length, unloaded, K, bowing(K, self._stiffness(middle), (0.0, 0.0)))
        bow = bowing(K, self._stiffness(middle), of.shear_centre)
        return Element(nodes, turned, length, unloaded, K, bow, of.shear_centre, of.wagner, of.stretch)

    def _pose(self, s: float) -> tuple[np.ndarray, np.ndarray]:
        point, along = self.piece.at(s - self.first)
        with prefixed("up: ", ValueError, ValueError):
            return point, frame(along, self.up)

    def _stiffness(self, s: float) -> np.ndarray:
        K = self.constants(s).stiffness
        return K[np.ix_(HEIGHT_IN_PLANE, HEIGHT_IN_PLANE)] if self.planar else K

    def _inertia(self, of: Constants) -> np.ndarray:
        axes = HEIGHT_IN_PLANE[:3]
        return of.inertia[np.ix_(axes, axes)] if self.planar else of.inertia


def _screw(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    (a, A), (b, B) = one, other
    return logarithm(A.T @ (b - a), A.T @ B)
