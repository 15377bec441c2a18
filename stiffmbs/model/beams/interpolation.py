"""Groups of elements of a beam with a common interpolation: Legendre spectral elements.

The nodes of a group are Gauss-Lobatto points, whose weights lump the mass, and its sections are Gauss points. With p
elements in a group, the error of smooth motion is of order 2 p. Patera, A spectral element method for fluid dynamics, J.
Comput. Phys. 54 (1984) 468-488; Wang, Sprague, Jonkman, Johnson, BeamDyn, Wind Energy 20 (2017) 1439-1462.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import cast

import numpy as np
from numpy.polynomial import legendre

from .stiffness import node_weights

LARGEST = 4
"""Largest number of elements in a group."""
QUADRATURE = 8
"""Number of Gauss points for the moments of a compliance."""
LARGEST_TURN = 2.5
"""Largest rotation between the ends of an unloaded group of several elements, rad."""


@dataclass(frozen=True)
class Group:
    """Nodes and sections of a group of elements, at fractions of its length."""

    # nodes, weights: shape (p + 1,): Gauss-Lobatto points and weights
    nodes: np.ndarray
    weights: np.ndarray
    # Gauss points and weights, with the values of the nodes' polynomials and their derivatives; none for p < 3
    sections: tuple[tuple[float, float, np.ndarray, np.ndarray], ...]

    def compliances(self, at: Callable[[float], np.ndarray]) -> np.ndarray:
        """Return the compliance of each section, so that they have the same moments along the axis as those of the beam.

        `at` returns the compliance, shape (m, m), at a fraction of the length. The deflection of a tapered cantilever
        under an end load then has no error from three elements on.
        """
        points, weights = legendre.leggauss(QUADRATURE)
        values = np.array([at((1 + x) / 2) for x in points])
        places = np.array([2 * place - 1 for place, *_ in self.sections])
        basis = legendre.legvander(points, len(places) - 1) @ np.linalg.inv(legendre.legvander(places, len(places) - 1))
        own = np.array([2 * weight for _, weight, *_ in self.sections])
        found = np.tensordot((basis * weights[:, None]).T, values, 1) / own[:, None, None]
        if np.linalg.eigvalsh(found).min() > 0:
            return cast(np.ndarray, found)
        return np.array([at((1 + x) / 2) for x in places])

    def quadrature(self, lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
        """Return Gauss points between two fractions of the length, and the weight of each for each node.

        The weights, shape (points, p + 1), are times the nodes' shapes: the polynomials of a spectral group, and linear
        between the nodes of others.
        """
        places, weights = [], []
        for k, nodes in self.polynomials():
            inside = np.clip((lower, upper), nodes[0], nodes[-1])
            if inside[0] < inside[1]:
                at, own = _of_polynomials(nodes, *inside)
                places.append(at)
                weights.append(np.pad(own, ((0, 0), (k, len(self.nodes) - k - len(nodes)))))
        return np.concatenate(places), np.concatenate(weights)

    def polynomials(self) -> Iterator[tuple[int, np.ndarray]]:
        """Yield the parts with common polynomials: the number of the first node and the nodes of each."""
        if self.sections:
            yield 0, self.nodes
            return
        for k in range(len(self.nodes) - 1):
            yield k, self.nodes[k : k + 2]

    @property
    def reference(self) -> int:
        """Place of the node to which displacements are relative: in the middle, or before it."""
        return (len(self.nodes) - 1) // 2

    @classmethod
    @cache
    def of(cls, p: int) -> Group:
        """Return the group of p elements; one or two of them are single elements, exact for small deformations."""
        top = np.eye(p + 1)[p]
        x = np.array([-1.0, *np.sort(legendre.legroots(legendre.legder(top)).real), 1.0])
        weights = 1 / (p * (p + 1) * legendre.legval(x, top) ** 2)
        inverse = np.linalg.inv(legendre.legvander(x, p))
        points, of_points = legendre.leggauss(p)
        derivatives = np.stack([legendre.legval(points, legendre.legder(row)) for row in np.eye(p + 1)], axis=-1)
        values, slopes = legendre.legvander(points, p) @ inverse, 2 * derivatives @ inverse
        sections = zip((1 + points) / 2, of_points / 2, values, slopes, strict=True)
        return cls((1 + x) / 2, weights, tuple(sections) if p > 2 else ())

    @classmethod
    def of_pairs(cls, count: int) -> Group:
        """Return elements between two nodes each, exact for small deformations, with equidistant nodes."""
        return cls(np.linspace(0, 1, count + 1), node_weights(count) / count, ())


def shapes(nodes: np.ndarray) -> np.ndarray:
    """Return the coefficients of the polynomials that are 1 at one of the nodes and 0 at others, a column for each, highest power first."""
    return np.linalg.inv(np.vander(nodes, len(nodes)))


def _of_polynomials(nodes: np.ndarray, lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss points between two places, and their weights times the polynomials that are 1 at one of the nodes."""
    points, weights = legendre.leggauss(len(nodes))
    places = lower + (upper - lower) * (1 + points) / 2
    values = np.vander(places, len(nodes)) @ shapes(nodes)
    return places, (upper - lower) / 2 * weights[:, None] * values


def group_sizes(start: float, end: float, count: int, turn: float) -> Iterator[tuple[float, float, int]]:
    """Yield the ends and the number of elements of each group in an interval.

    The ends are m along the axis, whose curvature is `turn`, rad/m; `count` is the number of elements.
    """
    spacing = (end - start) / count
    angle = turn * spacing
    largest = next((size for size in range(LARGEST, 1, -1) if angle * size <= LARGEST_TURN), 1)
    at = start
    sizes = divided(count, largest)
    for k, size in enumerate(sizes):
        to = end if k == len(sizes) - 1 else at + size * spacing
        yield at, to, size
        at = to


def divided(count: int, largest: int) -> list[int]:
    """Return a number of elements as a sum of groups of at most the largest size, few of them smaller than three."""
    if largest > 1:
        for smaller in range(count // (largest - 1) + 1):
            rest = count - smaller * (largest - 1)
            if rest >= 0 and rest % largest == 0:
                return [largest] * (rest // largest) + [largest - 1] * smaller
        return divided(count, largest - 1)
    return [1] * count
